"""The repository as the tests of the house see it: its pages, and the code blocks in them."""

import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = tuple(sorted([*ROOT.glob("*.md"), *ROOT.glob("notes/**/*.md"), *(p for p in ROOT.glob("docs/**/*.md") if "_build" not in p.parts)]))

_FENCE = re.compile(r"^(?P<indent> *)(?P<fence>```+|:::+) *(?P<info>[^\n`]*)\n(?P<text>.*?)^(?P=indent)(?P=fence) *$", re.M | re.S)


@dataclass(frozen=True)
class Block:
    """A fenced code block: where it stands and what it says."""

    page: Path
    language: str
    number: int  # counts the blocks of this language on this page, from 1
    line: int  # of its first line of text
    text: str

    def __str__(self):
        return f"{self.page.relative_to(ROOT).as_posix()}, {self.language} block {self.number}, line {self.line}"


def blocks(page, language):
    """The fenced blocks of one language on a page, in order."""
    text = page.read_text(encoding="utf-8")
    found = [m for m in _FENCE.finditer(text) if m["info"].strip() == language]
    return [
        Block(page, language, number, text.count("\n", 0, m.start("text")) + 1, textwrap.dedent(m["text"]))
        for number, m in enumerate(found, start=1)
    ]
