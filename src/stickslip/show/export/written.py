"""A friction law as source code: C99, or MATLAB, which Octave also runs. The files' texts are in ``templates``."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.basics.maths import LARGEST
from stickslip.engine.lines import literal
from stickslip.engine.portable import Language, body
from stickslip.engine.traced_law import TracedLaw
from stickslip.show.export.names import names_of_numbers

_SAME = {name: name for name in ("log", "sqrt", "sin", "cos", "atan", "tanh", "asinh")}


@dataclass(frozen=True)
class Files:
    """The differences between the languages, apart from their templates.

    Parameters
    ----------
    template : str
    language : Language
    number, state, memory : str
        Formats of the access to a number, with {} for its field, and to a state and a memory, with {} for the index.
    first : int
        First index of an array.
    limited : dict of str
        Functions with their arguments limited as in `stickslip.maths`.
    """

    template: str
    language: Language
    number: str
    state: str
    memory: str
    first: int
    limited: dict[str, str]

    def each(self, assignment: str, ends: Iterable[str], columns: int = 1) -> list[str]:
        """Assignments to the elements of a table, row by row: {0} is the expression, {1} and {2} are row and column."""
        cells = ((end, *divmod(i, columns)) for i, end in enumerate(ends))
        return ["    " + assignment.format(end, row + self.first, column + self.first) for end, row, column in cells]

    def used(self, text: str) -> dict[str, str]:
        """The limited functions that a text calls."""
        return {name: own for name, own in self.limited.items() if f"{self.language.functions[name]}(" in text}


C = Files(
    "law.h.jinja",
    Language(
        "const double {name} = {value};",
        "{held} > 0.0 ? {yes} : {no}",
        _SAME | {name: f"§_{name}_" for name in ("exp", "sinh", "cosh", "bell")},
    ),
    "p->{}",
    "s->z[{}]",
    "(double)s->mode[{}]",
    0,
    {
        "exp": f"exp(x > {LARGEST} ? {LARGEST} : x)",
        "sinh": f"sinh(x > {LARGEST} ? {LARGEST} : (x < -{LARGEST} ? -{LARGEST} : x))",
        "cosh": f"cosh(x > {LARGEST} ? {LARGEST} : (x < -{LARGEST} ? -{LARGEST} : x))",
        "bell": "1.0 / (cosh(x > 300.0 ? 300.0 : (x < -300.0 ? -300.0 : x)) * cosh(x > 300.0 ? 300.0 : (x < -300.0 ? -300.0 : x)))",
    },
)
MATLAB = Files(
    "law.m.jinja",
    Language(
        "{name} = {value};",
        "choose({held} > 0, {yes}, {no})",
        _SAME | {name: f"limited_{name}" for name in ("exp", "sinh", "cosh", "bell")},
    ),
    "p.{}",
    "s.z({})",
    "s.mode({})",
    1,
    {
        "exp": f"exp(min(x, {LARGEST}))",
        "sinh": f"sinh(max(min(x, {LARGEST}), -{LARGEST}))",
        "cosh": f"cosh(max(min(x, {LARGEST}), -{LARGEST}))",
        "bell": "1 / cosh(max(min(x, 300), -300))^2",
    },
)


def source_of(law: TracedLaw, name: str, files: Files, version: str) -> str:
    """The source file of a law in a language."""
    templates = _templates()
    names, table = names_of_numbers(law.numbers), law.slopes
    bind = {number: files.number.format(field) for number, field in names.items()} | {w: w for w in ("v", "load", "applied")}
    bind |= {z.name: files.state.format(i) for i, z in enumerate(law.z, files.first)}
    bind |= {mode.name: files.memory.format(i) for i, mode in enumerate(law.mode, files.first)}
    head = templates.get_template("head.jinja").render(law=law, name=name, version=version)
    text = templates.get_template(files.template).render(
        law=law,
        name=name,
        told=head.splitlines(),
        fields={names[number]: value for number, value in law.numbers.items()},
        slopes=[row[i] for i, row in enumerate(table)] if law.alone else [slope for row in table for slope in row],
        guards=[guard for guard, _, _ in law.switches],
        body=lambda roots: body(files.language, roots, bind),
        each=files.each,
        limited=files.used,
        literal=literal,
        unused=_unused,
    )
    return text.replace("§", name)


@functools.cache
def _templates() -> Any:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    folder = FileSystemLoader(Path(__file__).parent / "templates")
    return Environment(loader=folder, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True)


def _unused(takes: str, text: str) -> list[str]:
    """The arguments of a C function that its text does not use."""
    own = [part.split()[-1].lstrip("*") for part in takes.split(", ")]
    return [word for word in own if not re.search(rf"\b{word}\b", text)]
