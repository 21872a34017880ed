"""The notation page binds every name to a symbol and a unit; it is complete, and says what the code says."""

import dataclasses
import inspect
import re

from house import ROOT
from rows import each_row
from stickslip.basics.field_types import field_types

PAGE = ROOT / "docs" / "notation.md"


def rows():
    """name in code -> cells of its rows, for every table that has that column."""
    found = {}
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if len(cells) == 5:
            for name in re.findall(r"`([\w.()]+)`", cells[1]):
                found.setdefault(name, []).append(cells)
    return found


def parts():
    """(prefix, class) of every record that a study file or `replace` can reach into."""
    import stickslip as ss
    from stickslip.drives import DRIVES
    from stickslip.friction import LAWS
    from stickslip.tracks import TRACKS

    yield "", ss.Robot
    for prefix, registry in (("drive.", DRIVES), ("friction.", LAWS), ("track.", TRACKS)):
        for cls in registry.values():
            yield prefix, cls


def test_every_variable_is_on_the_page_with_its_unit():
    from stickslip.variables import VARIABLES

    written = rows()
    for name, variable in VARIABLES.items():
        units = {cells[2].replace("–", "") for cells in written.get(name, [])}
        assert name in written, f"docs/notation.md has no row for `{name}`: add | symbol | `{name}` | {variable.unit} | ... |"
        assert variable.unit in units, f"`{name}` has unit {variable.unit!r} in variables.py and {units} on docs/notation.md"


def test_every_field_is_on_the_page():
    written = rows()
    missing = [
        f"{prefix}{field.name} ({cls.__name__})"
        for prefix, cls in parts()
        for field in dataclasses.fields(cls)
        if prefix + field.name not in written
    ]
    assert not missing, f"add to docs/notation.md: {', '.join(missing)}"


def test_the_page_says_of_every_number_what_its_field_says():
    written, wrong = rows(), []
    for prefix, cls in parts():
        for field in dataclasses.fields(cls):
            if field_types(cls)[field.name].holds in ("number", "numbers"):
                assert {"label", "unit"} <= set(field.metadata), f"{cls.__name__}.{field.name} says neither what it is nor its unit"
                cells = written.get(prefix + field.name)
                if cells is None:
                    continue  # told by the test above
                units = {unit.strip() for row in cells for unit in row[2].split(",")}
                symbol = bare(field.metadata.get("symbol", ""))
                if field.metadata["unit"] not in units or not any(symbol in bare(row[0]) for row in cells):
                    wrong.append(f"{prefix}{field.name} ({cls.__name__}): {symbol} [{field.metadata['unit']}]; the page has {cells}")
    assert not wrong, "\n".join(wrong)


def bare(symbol):
    """A symbol without what LaTeX needs for its indices."""
    return re.sub(r"[{} $]", "", symbol)


def test_every_argument_of_a_preset_is_on_the_page():
    from stickslip.presets import PRESETS

    written = rows()
    missing = [
        f"{name} ({preset})" for preset, make in PRESETS.items() for name in inspect.signature(make).parameters if name not in written
    ]
    assert not missing, f"add to docs/notation.md: {', '.join(missing)}"


@each_row("column", (3, 4), ids=("meaning", "equation"))
def test_no_row_is_left_half_written(column):
    empty = [name for name, found in rows().items() for cells in found if not cells[column]]
    assert not empty, f"docs/notation.md: fill in the rows of {', '.join(empty)}"
