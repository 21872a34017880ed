"""What the files of all languages share: the law, the fields of its numbers, and how an expression finds what it depends on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from stickslip.engine.portable import Language, body
from stickslip.engine.symbols import Sym
from stickslip.engine.traced_law import TracedLaw
from stickslip.exporting.names import names_of_numbers

__all__ = ["Source"]


class Source:
    """The parts of a file, in the order in which they need one another; a language says how it names numbers, states and memories."""

    language: ClassVar[Language]
    number: ClassVar[str]  # with {}: the field
    state: ClassVar[str]  # with {}: which
    memory: ClassVar[str]
    first: ClassVar[int]  # index of the first

    def __init__(self, law: TracedLaw):
        self.law, fields = law, names_of_numbers(law.numbers)
        self.fields = {fields[name]: value for name, value in law.numbers.items()}
        self.bind = {name: self.number.format(field) for name, field in fields.items()} | {w: w for w in ("v", "load", "applied")}
        self.bind |= {z.name: self.state.format(i + self.first) for i, z in enumerate(law.z)}
        self.bind |= {mode.name: self.memory.format(i + self.first) for i, mode in enumerate(law.mode)}
        self.parts: list[str] = []

    @property
    def applied(self) -> str:
        """The last argument of a law that balances the other forces; nothing of others."""
        return ", applied" if self.law.law.needs_applied else ""

    def body(self, roots: Iterable[Sym]) -> tuple[list[str], list[str]]:
        """The lines that compute some expressions, and what then holds them."""
        return body(self.language, roots, self.bind)
