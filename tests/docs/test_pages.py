"""What a newcomer meets first stays short, and every page is in reach of the sidebar."""

import re

from house import ROOT

DOCS = ROOT / "docs"
PAGES = {
    p.relative_to(DOCS).with_suffix("").as_posix(): p.read_text(encoding="utf-8") for p in DOCS.rglob("*.md") if "_build" not in p.parts
}


def listed(page):
    """The pages in the lists of a page, from docs/."""
    entries = [line.strip() for block in re.findall(r"```\{toctree\}\n(.*?)```", PAGES[page], re.S) for line in block.splitlines()]
    folder = (DOCS / page).parent
    return [(folder / e).resolve().relative_to(DOCS).as_posix() for e in entries if e and not e.startswith(":")]


def test_readme_is_read_in_two_minutes():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 60 and len(text.split()) <= 500


def test_the_sidebar_has_at_most_fifteen_entries_and_leads_to_every_page():
    assert len(listed("index")) <= 15
    reached, todo = {"index"}, ["index"]
    while todo:
        new = [page for page in listed(todo.pop()) if page not in reached]
        reached |= set(new)
        todo += [page for page in new if page in PAGES]
    assert reached == set(PAGES)


def test_the_pages_have_at_most_sixty_thousand_words_beside_their_code():
    fence = re.compile(r"^( *)(```+|:::+).*?^\1\2 *$", re.M | re.S)
    word = re.compile(r"\S*\w\S*")  # lines of tables and signs of operations are none
    assert sum(len(word.findall(fence.sub("", text))) for text in PAGES.values()) <= 60_000


def test_other_words_are_found_by_search():
    wanted = ("optimize", "servo", "hysteresis", "brake", "chatter")
    assert not [word for word in wanted if word not in PAGES["reference"]]
