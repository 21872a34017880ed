"""What a page wants of its logs: units, roles, machine, law and numbers, as they stand in the fields of its panel."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from typing import Any

from stickslip.basics.errors import InputError, Problems

_MOST = 64  # entries of a table of choices
_LENGTH = 200  # letters of a name
_FILES = 16  # logs that are fitted together


@dataclass(frozen=True)
class Choices:
    """Arguments of `ss.fit` that a page has typed.

    Parameters
    ----------
    units, roles : dict of str -> str
    numbers : dict of str -> float or str, or list of them
        [SI], or with a unit, such as "0.4 mm"; a list has one for each file.
    machine, law : str or None
        None to have them proposed.
    asymmetric : bool
    files : tuple of (str, int)
        Names of the files and how many bytes each has, where several come one behind the other.
    """

    units: dict[str, str] = field(default_factory=dict)
    roles: dict[str, str] = field(default_factory=dict)
    numbers: dict[str, float | str | list[float | str]] = field(default_factory=dict)
    machine: str | None = None
    law: str | None = None
    asymmetric: bool = False
    files: tuple[tuple[str, int], ...] = ()

    def of(self, names: Collection[str]) -> Choices:
        """The choices for a file with these columns: units and roles of columns that other files have are left out.

        Examples
        --------
        >>> Choices(units={"F": "N", "Kraft": "N"}).of(["t", "F"]).units
        {'F': 'N'}
        """
        units, roles = ({name: word for name, word in each.items() if name in names} for each in (self.units, self.roles))
        return replace(self, units=units, roles=roles)


def choices_of(wish: Any) -> Choices:
    """The choices in what a page has sent; all errors at once.

    Examples
    --------
    >>> choices_of({"units": {"Weg": "mm"}, "numbers": {"load": 20}, "law": ""})
    Choices(units={'Weg': 'mm'}, roles={}, numbers={'load': 20.0}, machine=None, law=None, asymmetric=False, files=())
    """
    problems = Problems("fit")
    if not isinstance(wish, dict):
        raise InputError("fit", ["the choices are not a JSON object"])
    tables: dict[str, dict[str, Any]] = {}
    for name, fits in (("units", _is_word), ("roles", _is_word), ("numbers", _is_number)):
        table = wish.get(name, {})
        sound = isinstance(table, dict) and len(table) <= _MOST
        good = sound and all(len(key) <= _LENGTH and fits(v) for key, v in table.items())
        if not good:
            problems.add(f"{name} is not a table of at most {_MOST} names with {'numbers' if name == 'numbers' else 'words'}")
        tables[name] = table if good else {}
    words = {name: wish.get(name) or None for name in ("machine", "law")}
    for name, word in words.items():
        if not (word is None or (isinstance(word, str) and len(word) <= _LENGTH)):
            problems.add(f"{name} is not a word")
    files = wish.get("files", [])
    if not (isinstance(files, list) and len(files) <= _FILES and all(map(_is_file, files))):
        problems.add(f"at most {_FILES} files are fitted together; join them, or fit them with stickslip fit FILE FILE")
    problems.check()
    numbers = {name: [*map(_plain, value)] if isinstance(value, list) else _plain(value) for name, value in tables["numbers"].items()}
    return Choices(
        tables["units"], tables["roles"], numbers, words["machine"], words["law"], bool(wish.get("asymmetric")),
        tuple((name, size) for name, size in files),
    )  # fmt: skip


def _is_word(value: Any) -> bool:
    return isinstance(value, str)


def _is_number(value: Any) -> bool:
    """Whether a value is a number, which may be text with a unit, or one for each file."""
    each = value if isinstance(value, list) and 0 < len(value) <= _FILES else [value]
    return all((isinstance(v, (int, float)) and not isinstance(v, bool)) or (isinstance(v, str) and len(v) <= _LENGTH) for v in each)


def _plain(value: float | str) -> float | str:
    return value if isinstance(value, str) else float(value)


def _is_file(entry: Any) -> bool:
    pair = isinstance(entry, list) and len(entry) == 2 and isinstance(entry[0], str) and len(entry[0]) <= _LENGTH
    return pair and isinstance(entry[1], int) and not isinstance(entry[1], bool) and entry[1] >= 0
