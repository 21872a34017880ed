"""A record as a CSV file that `read` takes back with no options."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import Problems, as_path
from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.records.channel import ROLES

if TYPE_CHECKING:
    from stickslip.records.record import Record


#: First line of a file whose numbers no sensor has seen; `read` looks for it.
SYNTHETIC = "# stickslip: synthetic record, computed and not measured"
#: A line with the role of a channel, where its name and unit do not tell it.
_ROLE = "# stickslip: the role of "


def save(rec: Record, path: str | Path) -> Path:
    """Write the channels to a CSV file that `ss.read` reads back without options: units in the headings, all digits.

    A synthetic record is labelled in its first line, and remains labelled when it is read. If the roles of the channels do not follow
    from names and units, lines before the table state them.

    Parameters
    ----------
    path : str or Path
        Ends in ``.csv``. An existing file is replaced in a single step at the end.

    Raises
    ------
    InputError
        The channels are not sampled at the same times, or the file cannot be written.

    Examples
    --------
    >>> import stickslip as ss
    >>> rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), noise=1e-4, seed=1)
    >>> again = ss.read(rec.save("rig.csv"))
    >>> again.synthetic, bool((again["velocity"].values == rec["velocity"].values).all())
    (True, True)
    """
    path, channels, problems = as_path(path, "record", "run.csv"), list(rec.channels.values()), Problems("record")
    if path.suffix.lower() != ".csv":
        problems.add(f"{str(path)!r} ends in {path.suffix or 'nothing'!r}; allowed is .csv; type for example rec.save('run.csv')")
    if not channels:
        problems.add("it has no channels; there is nothing to write")
    others = [c.name for c in channels if not adjacent(c, channels[0])]
    if others:
        problems.add(
            f"{', '.join(others)} and {channels[0].name} are not sampled at the same times, so they do not fit into one table; save them "
            "apart: rec.replace(channels={name: rec[name]}).save(...)"
        )
    problems.check()
    file, first = io.StringIO(), channels[0]
    if rec.synthetic:
        file.write(SYNTHETIC + "\n")
    file.writelines(_role_lines(channels))
    table = csv.writer(file, lineterminator="\n")
    table.writerow([_heading(first.axis_name or "axis", first.axis_unit), *(_heading(c.name, c.unit) for c in channels)])
    np.savetxt(file, np.column_stack([first.t, *(c.values for c in channels)]), delimiter=",", fmt="%.17g")
    return write_whole(path, file.getvalue(), unwritable("record"))


def _role_lines(channels: list[Any]) -> list[str]:
    """Lines that tell every role, if reading names and units would not find all of them again; without commas, which part columns."""
    from stickslip.records.raw import RawColumn
    from stickslip.records.roles import roles_of

    if roles_of([RawColumn(c.name, c.unit, c.values) for c in channels], {}) == {c.name: c.role for c in channels}:
        return []
    names = [json.dumps(c.name).replace(",", "\\u002c") for c in channels]
    return [f"{_ROLE}{name} is {c.role or 'not told'}\n" for name, c in zip(names, channels, strict=True)]


def roles_in(text: str) -> dict[str, str]:
    r"""The roles that lines before the table tell, by channel; "" for one that has none.

    Examples
    --------
    >>> roles_in('# stickslip: the role of "F1" is load\n# stickslip: the role of "a\\u002c b" is not told')
    {'F1': 'load', 'a, b': ''}
    """
    roles = {}
    for line in text.splitlines():
        name, _, role = line.removeprefix(_ROLE).rpartition(" is ")
        if line.startswith(_ROLE) and role in (*ROLES, "not told"):
            roles[_name(name)] = "" if role == "not told" else role
    return roles


def _name(text: str) -> str:
    try:
        return str(json.loads(text))
    except ValueError:  # somebody wrote the line by hand
        return text


def adjacent(a: Any, b: Any) -> bool:
    """Whether two channels are sampled at the same times, and so stand in one table."""
    return (a.axis_name, a.axis_unit) == (b.axis_name, b.axis_unit) and np.array_equal(a.t, b.t)


def _heading(name: str, unit: str | None) -> str:
    return name if unit is None else f"{name} [{unit}]"
