"""Records as tables of names and values: TOML text, and the HTML that a notebook shows."""

from __future__ import annotations

import dataclasses
import html
import tomllib
from collections.abc import Sequence
from typing import Any

from stickslip.basics.constructors import arguments_of
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems, did_you_mean, is_one_of, other_words
from stickslip.basics.field_types import field_types
from stickslip.basics.fields import describe, is_array, is_record
from stickslip.basics.quantities import example_of, pretty_unit, with_unit
from stickslip.models.drives import DRIVES
from stickslip.models.friction import LAWS
from stickslip.models.tracks import TRACKS

PARTS: dict[str, dict[str, Any]] = {"drive": DRIVES, "friction": LAWS, "track": TRACKS}
#: What a field of any other name may hold, such as the motion of a stage.
EVERY: dict[str, Any] = {name: cls for kinds in PARTS.values() for name, cls in kinds.items()}


def _every(cls: type) -> dict[str, Any]:
    """The same for a class that names more kinds in `holds`."""
    return {**EVERY, **getattr(cls, "holds", {})}


def kinds_of(cls: type) -> dict[str, dict[str, Any]]:
    """The parts that a record of this class has, each with its kinds by name; a class adds its own in `part_kinds`."""
    known = {**PARTS, **getattr(cls, "part_kinds", {})}
    return {f.name: known[f.name] for f in dataclasses.fields(cls) if f.name in known}


def _required(cls: type) -> list[str]:
    """The fields that have no default."""
    return [f.name for f in dataclasses.fields(cls) if f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING]


def _kind_name(part: str, record: Any, kinds: dict[str, Any]) -> str:
    for name, cls in kinds.items():
        if type(record) is cls:
            return name
    raise InputError(
        "to_toml",
        [
            f"{part} is a {type(record).__name__}, which a study file cannot name; "
            f"allowed are {', '.join(kinds)}. Keep the robot in a Python file, in a function that returns it: a study file with the "
            f'line make = "{_file_of(record)}:rig" then runs the function rig with --allow-code'
        ],
    )


def _file_of(record: Any) -> str:
    """The Python file of a user's class, as far as its name tells."""
    module = type(record).__module__.rpartition(".")[2]
    return "mine.py" if module.startswith("__") else f"{module}.py"


def to_table(record: Any) -> dict[str, Any]:
    """A record as nested dicts of plain numbers, lists and strings."""
    table: dict[str, Any] = {}
    known = kinds_of(type(record))
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        if field.metadata.get("found"):  # by the record itself, from the others
            continue
        if field.name in known:
            several = isinstance(value, tuple)
            if several and not value:
                continue
            tables = [_table_of_part(field.name, part, known[field.name]) for part in (value if several else (value,))]
            table[field.name] = tables if several else tables[0]
        elif is_array(value):
            import numpy as np

            table[field.name] = np.asarray(value).tolist()
        elif is_record(value):
            table[field.name] = _table_of_part(field.name, value, _every(type(record)))
        elif value is not None:
            table[field.name] = [_plain(v) for v in value] if isinstance(value, tuple) else value
    return table | {name: _plain(getattr(record, name)) for name in getattr(record, "kept_in_files", ()) if name in vars(record)}


def _table_of_part(part: str, record: Any, kinds: dict[str, Any]) -> dict[str, Any]:
    """The table of one part; where there is one kind only it is not named."""
    kind = _kind_name(part, record, kinds)
    return {**({"kind": kind} if len(kinds) > 1 else {}), **to_table(record)}


def part_to_table(part: str, record: Any) -> dict[str, Any]:
    """A law, a drive or a track by itself, as the table that a robot's file has for its `part`.

    Examples
    --------
    >>> import stickslip as ss
    >>> part_to_table("friction", ss.Dahl(mu_plus=0.15, mu_minus=0.21, sigma0=4e5))
    {'kind': 'dahl', 'mu_plus': 0.15, 'mu_minus': 0.21, 'sigma0': 400000.0, 'exponent': 1.0}
    """
    return _table_of_part(part, record, PARTS[part])


def _plain(value: Numeric) -> Any:
    """A value of a tuple as a file keeps it."""
    if not is_array(value):
        return value
    import numpy as np

    return np.asarray(value).tolist()


def to_toml(record: Any, name: str = "robot") -> str:
    """A robot (or, by its name, a mechanism) as TOML text."""
    import tomli_w

    kind = {"kind": record.kind} if getattr(record, "kind", "") else {}
    try:
        return tomli_w.dumps({name: {**kind, **to_table(record)}})
    except TypeError as error:  # a field holds a function, or an object of a user's own
        mistake = (
            f"{error}; a study file holds numbers, text and parts that it knows; write the function as a method of a class in a module"
        )
        raise InputError(type(record).__name__, [mistake]) from error


def document_of(text: str, what: str = "study file") -> dict[str, Any]:
    """The tables of a TOML text; `InputError` of `what` says why it cannot be read."""
    if not isinstance(text, str):
        raise InputError(what, [f"{type(text).__name__} given; allowed is TOML text; type for example robot.to_toml() to see some"])
    try:
        return tomllib.loads(text)
    except RecursionError:
        why = "its tables or lists are nested too deeply"
    except ValueError as error:  # what TOML does not allow, and integers of thousands of digits
        why = str(error)
    raise InputError(what, [f"not readable as TOML: {why}"])


def from_toml(cls: type, text: str, name: str = "robot") -> Any:
    """A robot or a mechanism (of class `cls`) from TOML text; all that is wrong with it is reported at once."""
    document = document_of(text)
    if not isinstance(document.get(name), dict):
        first = next((f for f in dataclasses.fields(cls) if field_types(cls)[f.name].holds == "number"), None)
        shown = f"{first.name} = {example_of(first.metadata)}" if first else f'kind = "{getattr(cls, "kind", "")}"'
        raise InputError("study file", [f"has no [{name}] table; begin with the line [{name}] and then {shown}"])
    return from_table(cls, document[name], name)


def from_table(cls: type, table: dict[str, Any], name: str = "robot") -> Any:
    """A robot or a mechanism (of class `cls`) from nested dicts."""
    problems, arguments = Problems("study file"), dict(table)
    own = getattr(cls, "kind", "")
    if own and arguments.pop("kind", own) != own:
        problems.add(f'{name}.kind = {table["kind"]!r}; {cls.__name__} reads kind = "{own}"')
    for part, kinds in kinds_of(cls).items():
        if _is_table(arguments.get(part)):
            arguments[part] = _parts(part, arguments[part], problems, f"{name}.{part}", kinds)
        elif part in arguments or part in _required(cls):
            problems.add(_missing(part, name, kinds))
            arguments.pop(part, None)
    for field in dataclasses.fields(cls):
        if field_types(cls)[field.name].holds == "numbers" and isinstance(arguments.get(field.name), list):  # a file has lists only
            arguments[field.name] = tuple(arguments[field.name])
        if isinstance(arguments.get(field.name), dict):
            arguments[field.name] = _part(field.name, dict(arguments[field.name]), problems, f"{name}.{field.name}", _every(cls))
    made = _build(cls, arguments, name, problems)
    problems.check()
    return made


def _is_table(given: Any) -> bool:
    """Whether a value of a file is a table, or an array of tables: several parts."""
    return isinstance(given, dict) or (isinstance(given, list) and bool(given) and all(isinstance(each, dict) for each in given))


def _parts(part: str, given: Any, problems: Problems, where: str, kinds: dict[str, Any]) -> Any:
    """The parts in a table, or an array of tables; None if one of them is wrong."""
    if isinstance(given, dict):
        return _part(part, dict(given), problems, where, kinds)
    first = next(iter(kinds))  # of several parts the kind may be left out
    made = [_part(part, {"kind": first, **each}, problems, f"{where}.{i}", kinds) for i, each in enumerate(given)]
    return None if None in made else tuple(made)


def _missing(part: str, where: str, kinds: dict[str, Any]) -> str:
    if len(kinds) == 1:
        return f"[[{where}.{part}]] is missing or no array of tables; type [[{where}.{part}]] once for each {next(iter(kinds))}"
    return f'[{where}.{part}] is missing or no table; type [{where}.{part}] and then kind = "{next(iter(kinds))}"'


def _part(part: str, table: dict[str, Any], problems: Problems, where: str, kinds: dict[str, Any]) -> Any:
    kind = table.pop("kind", next(iter(kinds)) if len(kinds) == 1 else None)
    if kind is None:
        named = " or ".join(f'kind = "{name}"' for name in kinds)
        problems.add(f"{where}.kind is missing; type {named} under [{where}]")
        return None
    if not is_one_of(kind, kinds):
        problems.add(f"{where}.kind = {kind!r}; {did_you_mean(str(kind), kinds)}")
        return None
    known = {**PARTS, **kinds_of(kinds[kind])}
    for inner in [name for name in table if _is_table(table[name]) and (name in known or "kind" in table[name])]:
        others = known.get(inner) or _every(kinds[kind])  # a drive around a drive, the target of a controller
        table[inner] = _parts(inner, table[inner], problems, f"{where}.{inner}", others)
    return _build(kinds[kind], table, where, problems)


def _build(cls: type, arguments: dict[str, Any], where: str, problems: Problems) -> Any:
    """An instance from its arguments; every unknown, missing or bad one is noted."""
    fields, taken = {f.name: f for f in dataclasses.fields(cls)}, arguments_of(cls)
    for name in [n for n in arguments if n not in taken]:
        hint = other_words(name, arguments[name], taken, " = ") or did_you_mean(name, taken)
        problems.add(f"{where}.{name} is not known; {hint}")
        del arguments[name]
    kinds = kinds_of(cls)
    for name in [n for n, p in taken.items() if p.default is p.empty and n not in arguments and n not in kinds]:
        kind = field_types(cls)[name]
        if kind.optional:
            arguments[name] = None
            continue
        example = example_of(fields[name].metadata, kind.holds == "numbers").replace("(", "[").replace(")", "]")
        problems.add(f"{where}.{name} is missing; type for example {name} = {example}")
        arguments[name] = _read_back(example, (1.0,) if kind.holds == "numbers" else 1.0)
    lacking = [p for p in kinds if arguments.get(p, 0) is None or (p not in arguments and p in _required(cls))]
    for part in lacking:
        if "." in where and part not in arguments:  # a part of a part
            problems.add(_missing(part, where, kinds[part]))
    if problems.mistakes and any(len(kinds[part]) == 1 for part in lacking):  # nothing can stand for several parts
        return None
    try:
        made = cls(**{**arguments, **{p: _stand_in(cls, p, kinds[p]) for p in lacking}})  # so that the other fields are judged too
    except InputError as error:
        problems.mistakes += [f"{where}{'.' if sentence.startswith(tuple(taken)) else ': '}{sentence}" for sentence in error.problems]
        return None
    return None if lacking else made


def _read_back(example: str, otherwise: Any) -> Any:
    """The value of an example, so that the other fields can be judged beside it."""
    try:
        value = tomllib.loads(f"x = {example}")["x"]
    except tomllib.TOMLDecodeError:
        return otherwise
    return tuple(value) if isinstance(value, list) else value


def _stand_in(cls: Any, part: str, kinds: dict[str, Any]) -> Any:
    """Some part of this sort, for one that is missing."""
    if part in getattr(cls, "part_kinds", {}) and hasattr(cls, "example"):
        return getattr(cls.example(), part)
    kind = next(iter(kinds.values()))
    return kind.example() if hasattr(kind, "example") else kind()


def _html_rows(record: Any, prefix: str = "") -> list[str]:
    rows = []
    for field in dataclasses.fields(record):
        value, name = getattr(record, field.name), prefix + field.name
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            rows.append(f"<tr><th style='text-align:left'>{html.escape(name)}</th><td>{html.escape(type(value).__name__)}</td></tr>")
            rows += _html_rows(value, name + ".")
        elif field_types(type(record))[field.name].holds == "number" and value is not None:
            rows.append(f"<tr><td>{html.escape(name)}</td><td>{html.escape(_with_unit(value, field))}</td></tr>")
    return rows


def _with_unit(value: Numeric, field: dataclasses.Field[Any]) -> str:
    """A number, or many, as a table shows it."""
    unit = str(field.metadata.get("unit", "1"))
    shown = describe(value) if is_array(value) else str(value)
    return with_unit(value, unit) if isinstance(value, float) else shown if unit == "1" else f"{shown} {pretty_unit(unit)}"


def record_html(record: Any, notes: Sequence[str] = ()) -> str:
    """A record as a small HTML table, with remarks below it."""
    below = "".join(f"<p><small>{html.escape(note)}</small></p>" for note in notes)
    return f"<table><caption>{html.escape(type(record).__name__)}</caption>{''.join(_html_rows(record))}</table>{below}"
