"""Tables that come as values and not as text: JSON, data frames, mappings of arrays."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_of_heading
from stickslip.basics.unpacking import Allowance
from stickslip.records.json_pieces import in_pieces, of_lines
from stickslip.records.raw import Raw, RawColumn
from stickslip.records.rows_of_values import FORMS, ByName, array_of, by_column, labels_a_row, numbered, of_other_length, rows_of
from stickslip.records.stamps import STAMP_UNIT, nanoseconds
from stickslip.records.text_lines import TextLines, check_columns


# ---- JSON ----
def parse_json(text: str, allowance: Allowance) -> Raw:
    """The columns of a JSON table, in any of the forms in which tables are written."""
    _check_nesting(text)
    document = _loaded(text)
    units: dict[str, Any] = {}
    while isinstance(document, dict) and not isinstance(document, ByName):
        if _named_rows(document):
            document = list(document.values())
            break
        check_columns(len(document), "the JSON")
        if _named_columns(document):
            break
        units_given = document.get("units")
        units |= units_given if isinstance(units_given, dict) else {}
        if _is_split(document):
            document = _named(list(map(str, document["columns"])), document["data"])
            break
        inner = [value for value in document.values() if _is_table(value)]
        if len(inner) != 1:
            raise InputError("read", [f"the JSON holds {len(inner)} tables; allowed is one, alone or as one part of an object; {FORMS}"])
        document = inner[0]
    if isinstance(document, list):
        document = by_column(*rows_of(document))
    lists = {name: value for name, value in document.items() if _columnar(value)}
    check_columns(len(lists), "the JSON")
    if not lists:
        raise InputError("read", [f"the JSON holds no list of numbers; {FORMS}"])
    allowance.take(8.0 * sum(map(len, lists.values())), "its lists")
    raw = Raw("JSON", table=True)
    left = [name for name in document if name not in lists and name != "units"]
    if left:
        raw.notes.append(f"{', '.join(map(repr, left[:6]))} of the JSON are not lists of numbers and are left out")
    units_given = document.get("units")
    units |= units_given if isinstance(units_given, dict) else {}
    for name, values in lists.items():
        plain, unit = unit_of_heading(str(name))
        raw.columns.append(_column(plain, unit or _text(units.get(name)), _plain(values), raw.notes))
    return raw


_EMPTY = re.compile(r"\[\s*\]|\{\s*\}")
_MOST_EMPTY = 1000


def _check_nesting(text: str) -> None:
    """Refuse a text of brackets and of empty lists, which takes far more memory than it has letters and holds no table."""
    opened = text.count("[") + text.count("{")
    if opened > 1000 and sum(1 for _ in itertools.islice(_EMPTY.finditer(text), _MOST_EMPTY + 1)) > _MOST_EMPTY:
        raise InputError("read", [f"the JSON holds more than {_MOST_EMPTY} empty lists or objects; {FORMS}"])
    if opened > len(text) / 4 + 1000:
        raise InputError(
            "read", [f"the JSON opens {opened} lists or objects within {len(text)} characters: it is nested too deeply, or empty; {FORMS}"]
        )


def _loaded(text: str) -> Any:
    """The contents of the text: one value, or one on each line."""
    try:
        return in_pieces(text)
    except RecursionError:
        raise InputError("read", ["the JSON is nested too deeply; write one table"]) from None
    except InputError:
        raise
    except ValueError as error:
        try:
            return of_lines(TextLines.of_text(text)) or _broken(error)
        except (ValueError, RecursionError):
            return _broken(error)


def _broken(error: Exception) -> Any:
    raise InputError("read", [f"the file is JSON that is cut short or damaged: {str(error)[:120]}; export it again"]) from None


def _text(value: Any) -> str | None:
    return value if isinstance(value, str) and value else None


def _is_split(document: dict[str, Any]) -> bool:
    return isinstance(document.get("columns"), list) and isinstance(document.get("data"), (list, ByName))


def _named(names: list[str], rows: Any) -> dict[str, Any]:
    """The columns of rows that are lists, by other names."""
    if not isinstance(rows, ByName):
        return by_column(names, rows)
    if list(rows) != numbered(len(names)):
        raise of_other_length(len(names))
    return dict(zip(names, rows.values(), strict=True))


_SINGLE = {int, float, bool, str, type(None)}  # what JSON has beside lists and objects


def _columnar(value: Any) -> bool:
    """Whether a value is a list of numbers, or an object of them by row, as pandas writes columns."""
    if isinstance(value, dict) and not all(map(labels_a_row, value)):
        return False
    items = list(value.values()) if isinstance(value, dict) else value
    return isinstance(items, np.ndarray) or (isinstance(items, list) and len(items) > 0 and _SINGLE.issuperset(map(type, items)))


def _named_columns(document: dict[str, Any]) -> bool:
    lists = [_plain(value) for name, value in document.items() if name != "units" and _columnar(value)]
    return not _is_split(document) and any(any(map(is_plain_number, values)) for values in lists)


def _named_rows(document: dict[str, Any]) -> bool:
    return (
        bool(document)
        and all(map(labels_a_row, document))
        and all(isinstance(row, dict) and not isinstance(row, ByName) for row in document.values())
    )


def _is_table(value: Any) -> bool:
    if isinstance(value, dict):
        return isinstance(value, ByName) or _is_split(value) or _named_columns(value) or _named_rows(value)
    return isinstance(value, list) and bool(value) and isinstance(value[0], (dict, list))


def is_plain_number(value: Any) -> bool:
    """Whether a value is a number as JSON and spreadsheets have them."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _plain(value: Any) -> list[Any]:
    return list(value.values()) if isinstance(value, dict) else value


def _column(name: str, unit: str | None, values: list[Any], notes: list[str]) -> RawColumn:
    """Numbers, or timestamps as seconds since the first; what is neither is NaN, and said."""
    if (numbers := array_of(values)) is not None:
        return RawColumn(name, unit, numbers)
    texts = {x for x in values if isinstance(x, str)}
    known = {x: nanoseconds(x) for x in texts if ":" in x}
    stamps = [known.get(x) if isinstance(x, str) else None for x in values] if known else [None] * len(values)
    if values and sum(stamp is not None for stamp in stamps) > 0.5 * len(values):
        first = next(s for s in stamps if s is not None)
        notes.append(f"times are counted from the first timestamp, {next(x for x, s in zip(values, stamps, strict=True) if s is not None)}")
        return RawColumn(name, "s", np.array([np.nan if s is None else (s - first) * STAMP_UNIT for s in stamps]))
    known_numbers = {x: number_in(x) for x in texts}
    read = [known_numbers[x] if isinstance(x, str) else number_in(x) for x in values]
    strange = sum(x is None and value is not None for x, value in zip(read, values, strict=True))
    if strange:
        notes.append(f"{name}: {strange} values are not numbers and became NaN")
    return RawColumn(name, unit, np.array([np.nan if x is None else x for x in read], float))


def number_in(value: Any) -> float | None:
    """A value as a number, infinite where it has hundreds of digits; None if it is none."""
    try:
        return None if value is None or isinstance(value, bool) else float(value)
    except OverflowError:
        return np.inf if value > 0 else -np.inf
    except ValueError:
        return None


# ---- data frames ----
def is_frame(value: Any) -> bool:
    """Whether something has columns by name: a data frame, or a mapping of arrays."""
    return isinstance(value, Mapping) or (hasattr(value, "columns") and hasattr(value, "__getitem__"))


def raw_of_frame(frame: Any) -> Raw:
    """The columns of a data frame, of pandas or another library, or of a mapping; an index of times is a column too."""
    raw = Raw("data frame", table=True)
    names: Sequence[Any] = list(frame) if isinstance(frame, Mapping) else list(frame.columns)
    index = getattr(frame, "index", None)
    series = [(str(name), np.asarray(frame[name])) for name in names]
    if index is not None and not callable(index) and _says_times(index):
        series.insert(0, (str(index.name or "time"), np.asarray(index)))
    for name, values in series:
        if values.ndim != 1:
            raise InputError("read", [f"{name!r} has shape {values.shape}; allowed are columns of numbers"])
        plain, unit = unit_of_heading(name)
        raw.columns.append(_of_series(plain, unit, values, raw.notes))
    if not raw.columns or not len(raw.columns[0].values):
        raise InputError("read", ["the data frame holds no numbers"])
    return raw


def _says_times(index: Any) -> bool:
    """Whether an index is one of times, or has a name; a count of the rows is not a column."""
    return np.asarray(index).dtype.kind in "mM" or (index.name is not None and np.asarray(index).dtype.kind in "iuf")


def _of_series(name: str, unit: str | None, values: Array, notes: list[str]) -> RawColumn:
    if values.dtype.kind == "M":
        notes.append(f"times are counted from the first timestamp, {values[0]}")
        values = values - values[0]
    if values.dtype.kind == "m":
        whole = values.astype("timedelta64[ns]")
        return RawColumn(name, "s", np.where(np.isnat(whole), np.nan, whole.astype(np.int64) * STAMP_UNIT))
    if values.dtype.kind in "iuf":
        return RawColumn(name, unit, values.astype(float))
    return _column(name, unit, [x.item() if hasattr(x, "item") else x for x in values.tolist()], notes)
