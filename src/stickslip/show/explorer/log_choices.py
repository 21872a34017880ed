"""What a page wants of a log: units, roles, machine, law and numbers, as they stand in the fields of its panel."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.errors import InputError, Problems

_MOST = 64  # entries of a table of choices
_LENGTH = 200  # letters of a name


@dataclass(frozen=True)
class Choices:
    """Arguments of `ss.fit` that a page has typed.

    Parameters
    ----------
    units, roles : dict of str -> str
    numbers : dict of str -> float
        [SI].
    machine, law : str or None
        None to have them proposed.
    asymmetric : bool
    """

    units: dict[str, str] = field(default_factory=dict)
    roles: dict[str, str] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)
    machine: str | None = None
    law: str | None = None
    asymmetric: bool = False


def choices_of(wish: Any) -> Choices:
    """The choices in what a page has sent; all errors at once.

    Examples
    --------
    >>> choices_of({"units": {"Weg": "mm"}, "numbers": {"load": 20}, "law": ""})
    Choices(units={'Weg': 'mm'}, roles={}, numbers={'load': 20.0}, machine=None, law=None, asymmetric=False)
    """
    problems = Problems("fit")
    if not isinstance(wish, dict):
        raise InputError("fit", ["the choices are not a JSON object"])
    tables: dict[str, dict[str, Any]] = {}
    for name, kinds in (("units", str), ("roles", str), ("numbers", (int, float))):
        table = wish.get(name, {})
        sound = isinstance(table, dict) and len(table) <= _MOST
        good = sound and all(len(key) <= _LENGTH and isinstance(v, kinds) and not isinstance(v, bool) for key, v in table.items())
        if not good:
            problems.add(f"{name} is not a table of at most {_MOST} names with {'numbers' if name == 'numbers' else 'words'}")
        tables[name] = table if good else {}
    words = {name: wish.get(name) or None for name in ("machine", "law")}
    for name, word in words.items():
        if not (word is None or (isinstance(word, str) and len(word) <= _LENGTH)):
            problems.add(f"{name} is not a word")
    problems.check()
    numbers = {name: float(value) for name, value in tables["numbers"].items()}
    return Choices(tables["units"], tables["roles"], numbers, words["machine"], words["law"], bool(wish.get("asymmetric")))
