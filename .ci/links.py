"""Links of the built documentation: every one within it leads to a page and a place that are there; the others are listed.

python .ci/links.py HTML_FOLDER [--online]       with --online each address outside is asked for
"""

import sys
import urllib.request
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Addresses that a page leads to, and places in it."""

    def __init__(self, path: Path):
        super().__init__()
        self.to, self.places = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        """Note what an element leads to and what it is called."""
        given = dict(attrs)
        self.places |= {given[name] for name in ("id", "name") if given.get(name)}
        self.to += [given[name] for name in ("href", "src") if given.get(name)]


def main(folder: str, online: bool = False) -> int:
    """Print what is broken and what lies outside; the number of broken links."""
    root = Path(folder).resolve()
    pages = {path: Page(path) for path in sorted(root.rglob("*.html"))}
    broken, outside = [], {}
    for path, page in pages.items():
        for address in page.to:
            parts = urlsplit(address)
            if parts.scheme in ("http", "https"):
                outside.setdefault(address, path.relative_to(root).as_posix())
            elif not parts.scheme and not leads_somewhere(path, parts, pages):
                broken.append(f"{path.relative_to(root)}: {address}")
    if online:
        broken += [f"{page}: {address}: {why}" for address, page in outside.items() if (why := asked(address))]
    print(f"{len(pages)} pages, {sum(len(p.to) for p in pages.values())} links, {len(outside)} of them outside")
    print(*(f"outside  {address}  ({page})" for address, page in sorted(outside.items())), sep="\n")
    print(*(f"BROKEN   {link}" for link in broken), sep="\n")
    return len(broken)


def leads_somewhere(path: Path, parts, pages: dict) -> bool:
    """Whether the file is there and has the place."""
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    target = target / "index.html" if target.is_dir() else target
    return target.exists() and (not parts.fragment or target not in pages or unquote(parts.fragment) in pages[target].places)


def asked(address: str) -> str:
    """Why an address does not answer; empty if it does."""
    try:
        with urllib.request.urlopen(urllib.request.Request(address, headers={"User-Agent": "link check"}), timeout=20):
            return ""
    except OSError as error:
        return str(error)


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1], "--online" in sys.argv), 1))
