"""Simulations on disk: text with the machine, its numbers, and all that a lane holds from one step to the next.

Nothing in a file is run. Of what the kernel reads only numbers come from it, and no number by which it finds its way.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, as_path
from stickslip.basics.jsontext import as_plain
from stickslip.basics.unpacking import Allowance
from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.results.storage import from_text
from stickslip.solvers.moments import Moment, first_moment, put, standing_of
from stickslip.solvers.request import versions

if TYPE_CHECKING:
    from stickslip.solvers.simulation import Simulation

#: Version of the file format; a reader refuses a newer one.
FORMAT = 1
_MOST_PERIODS = 2**53
_AGAIN = "save the simulation again"


def save(sim: Simulation, path: str | Path) -> Path:
    """Write a simulation to a file (.json); an existing file is replaced. Returns the path."""
    path = as_path(path, "save", "sim.json")
    if path.suffix.lower() != ".json":
        raise InputError("save", [f"{str(path)!r} ends in {path.suffix!r}; allowed is .json; type for example sim.save('sim.json')"])
    now, side = sim.now, sim.now.side
    table = {
        "stickslip_simulation": FORMAT, "versions": versions(), "machine": _machine_table(sim), "asked": now.case.asked,
        "numbers": {**now.case.numbers(), **{name: now.inputs[n] for name, n in now.case.names.items() if n in now.inputs}},
        "is_pushed": now.case.is_pushed, "t": now.t, "periods": side.periods, "time": side.time, "span": now.span,
        "status": now.status, "sentence": now.sentence,
        "state": [side.way, *side.states, *side.memory], "kernel": now.case.kernel_name, "lane": side.numbers(),
    }  # fmt: skip
    return write_whole(path, json.dumps(as_plain(table)), unwritable("save"))


def _machine_table(sim: Simulation) -> dict[str, Any]:
    """The machine as text, where a file can hold it, and by what it is known again."""
    machine = sim.machine
    try:
        text = machine.to_toml()
        text = text if from_text(text) == machine else None
    except Exception:  # what a flow, or a law or a machine of a user's own says: then it is given where the file is read
        text = None
    return {"class": type(machine).__name__, "toml": text, "made_with": sim.made_with}


def load(path: str | Path, machine: Any = None) -> Simulation:
    """The simulation that `save` wrote."""
    from stickslip.solvers.simulation import Simulation, case_of

    path = as_path(path, "load", "sim.json")
    table = _read(path)
    try:
        case = case_of(_machine_of(table, machine, path), **_asked(table))
        if machine is not None:
            _check_same(table, case, path)
        return Simulation(case, moment=_moment(table, case), made_with={k: float(v) for k, v in table["machine"]["made_with"].items()})
    except InputError:
        raise
    except Exception as error:  # a damaged file meets what we make of it at any place
        raise _damaged(path, f"{type(error).__name__}: {str(error)[:120]}") from None


def _read(path: Path) -> dict[str, Any]:
    give = "give the path of a file that sim.save(path) wrote"
    try:
        size = path.stat().st_size if path.is_file() else None
    except (OSError, ValueError):
        size = None
    if size is None:
        raise InputError("load", [f"there is no file {str(path)!r}; {give}"])
    Allowance("load", size).check_file()
    try:
        table = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError("load", [f"{str(path)!r} cannot be read ({error}); {give}"]) from None
    except (ValueError, RecursionError):
        table = None
    version = table.get("stickslip_simulation") if isinstance(table, dict) else None
    if not isinstance(version, int):
        raise InputError("load", [f"{str(path)!r} holds no simulation; {give}"])
    if version > FORMAT:
        why = f"has format {version}, this stickslip reads up to {FORMAT}; type pip install --upgrade stickslip"
        raise InputError("load", [f"{str(path)!r} {why}"])
    return table


def _damaged(path: Path, why: str) -> InputError:
    return InputError("load", [f"{str(path)!r} is damaged ({why}); {_AGAIN}"])


def _asked(table: dict[str, Any]) -> dict[str, Any]:
    """What `simulation` was asked for."""
    asked = table["asked"]
    return {"start": asked["start"], "rtol": float(asked["rtol"]), "method": str(asked["method"]), "mode": asked["mode"]}


def _machine_of(table: dict[str, Any], machine: Any, path: Path) -> Any:
    """The machine that was given, else that of the file."""
    kept = table["machine"]
    if machine is None:
        if not isinstance(kept["toml"], str):
            why = f"{str(path)!r} holds a simulation of a {kept['class']}, which no file can hold"
            raise InputError(
                "load",
                [f"{why}; type Simulation.load(path, machine=...) with the one that was given to ss.simulation"],
            )
        return from_text(kept["toml"])
    if type(machine).__name__ != kept["class"]:
        given = f"the machine given is a {type(machine).__name__}"
        raise InputError(
            "load", [f"{str(path)!r} holds a simulation of a {kept['class']}, and {given}; leave machine out, or give that one"]
        )
    return machine


def _check_same(table: dict[str, Any], case: Any, path: Path) -> None:
    """`InputError` for a machine other than the one with which the simulation was made."""
    made, own = table["machine"]["made_with"], case.numbers()
    differing = [name for name in {**made, **own} if made.get(name) != own.get(name)]
    if differing:
        name = differing[0]
        what = f"{name} = {own.get(name)!r} in the machine given, and {made.get(name)!r} in {str(path)!r}"
        more = f" (and {len(differing) - 1} more numbers)" if len(differing) > 1 else ""
        raise InputError("load", [f"{what}{more}; allowed is the machine that was given to ss.simulation"])


def _moment(table: dict[str, Any], case: Any) -> Moment:
    """Where the simulation stood."""
    names, numbers = case.names, {name: _finite(value) for name, value in table["numbers"].items()}
    if set(names) != set(numbers):
        raise ValueError("its numbers are not those of the machine")
    changed = {names[name]: value for name, value in numbers.items()}
    quick = {number: value for number, value in changed.items() if case.is_quick(number)}
    own = case.numbers()
    others = {names[name]: value for name, value in numbers.items() if names[name] not in quick and value != own[name]}
    case = (case.changed(others) if others else case).ready_for(quick if table["is_pushed"] is True else {})
    first = first_moment(case)
    side, span = first.side, _finite(table["span"])
    if not span > 0.0:
        raise ValueError("its span is not positive")
    row = case.row(span)
    put(quick, row, case)
    periods, time, t = int(table["periods"]), _finite(table["time"]), _finite(table["t"])
    if not 0 <= periods < _MOST_PERIODS or not 0.0 <= time <= (math.inf if case.period is None else 1.001 * case.period):
        raise ValueError("its time is not within a period")
    way, states, memory = np.split(_numbers(table["state"], 1 + len(side.states) + len(side.memory)), [1, 1 + len(side.states)])
    if table["kernel"] == case.kernel_name:
        side.take(_numbers(table["lane"], len(side.numbers())), row)
    else:  # that of another version: it goes on from the state
        side.begin_from(float(way[0]), states, memory, row, t)
    if not case.knows(side.memory):
        raise ValueError("its mode is not one of the flow")
    side.stand(periods, time)
    status = int(table["status"])
    moment = first._replace(inputs=quick, span=span, t=t, status=status, sentence=str(table["sentence"]))
    return standing_of(moment)


def _finite(value: Any) -> float:
    """A number of a file."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"{value!r} is not a finite number")
    return float(value)


def _numbers(values: Any, count: int) -> Array:
    """So many numbers of a file, which may be infinite or none."""
    if not isinstance(values, list) or len(values) != count or not all(isinstance(v, (int, float)) for v in values):
        raise ValueError(f"it has not the {count} numbers that a lane holds")
    return np.array(values, float)
