"""Runs of flows in files: their dense output, and what tells the flow that is given to `load` from another one."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.jsontext import as_plain
from stickslip.models.flow_contacts import ContactForces
from stickslip.results.flow_pieces import FlowPieces, ModeChange

if TYPE_CHECKING:
    from stickslip.results.flow_run import FlowRun

#: What a file of such a run says that it holds.
CONTENT = "run of a flow"
_ARRAYS = ("t", "mode", "coefficients", "passed", "end")
_OF_RUN = ("periods", "settle", "rtol", "method", "status", "samples", "start", "provenance", "counts")
_LOOKS, _NEAR = 16, 1e-6  # steps at which rates are compared, and how close they are for one flow
_TOLERATED = 1e-2  # the same of steps that hold a tolerance, whose polynomials are less close than their ends


def arrays_of(run: FlowRun) -> dict[str, Array]:
    """The dense output as arrays; modes by their places among those of the flow."""
    modes, pieces = list(run.model.modes), run.pieces
    arrays = {name: np.asarray(getattr(pieces, name)) for name in _ARRAYS}
    arrays["switch_times"] = np.array([switch.t for switch in pieces.switches], float)
    arrays["switch_modes"] = np.array([[modes.index(s.before), modes.index(s.after)] for s in pieces.switches], int).reshape(-1, 2)
    arrays["end_mode"] = np.array([modes.index(pieces.end_mode)])
    return {name: array for name, array in arrays.items() if array.size}


def description_of(run: FlowRun) -> str:
    """The numbers, the names and the modes of the flow, and the settings of the run, as text."""
    flow = run.model
    kept: dict[str, Any] = {name: getattr(run, name) for name in _OF_RUN}
    kept |= {} if run.known_period is None else {"known_period": run.known_period}
    kept |= {"numbers": flow.numbers, "names": run.names, "modes": list(map(repr, flow.modes))}
    return json.dumps(as_plain(kept))


def run_from(arrays: dict[str, Array], text: str, given: Sequence[Any]) -> dict[str, Any]:
    """The arguments of `FlowRun` from a file, with the flow among those that are given.

    Raises
    ------
    InputError
        If none of them is the flow of the run.
    """
    kept = json.loads(text)
    flow = _flow_of(kept, given)
    modes, (last,) = list(flow.modes), arrays["end_mode"]
    times, changes = arrays.get("switch_times", np.empty(0)), arrays.get("switch_modes", np.empty((0, 2), int))
    switches = [ModeChange(float(t), modes[before], modes[after]) for t, (before, after) in zip(times, changes, strict=True)]
    states = arrays["coefficients"].shape[1]
    passed = arrays.get("passed", np.empty((0, states)))
    pieces = FlowPieces(arrays["t"], arrays["mode"], arrays["coefficients"], passed, switches, arrays["end"], modes[int(last)])
    _check_rates(flow, pieces, _NEAR if kept["method"] == "exact" else _TOLERATED)
    return {"model": flow, "pieces": pieces, **{name: kept[name] for name in _OF_RUN}, "known_period": kept.get("known_period")}


def _flow_of(kept: dict[str, Any], given: Sequence[Any]) -> Any:
    """The first flow with the states, numbers and modes of the file, with the numbers of the file."""
    what = f"the file holds a run of a flow with the states {', '.join(kept['names'])}"
    for flow in given:
        numbers = getattr(flow, "numbers", None)
        if numbers is None or set(numbers) != set(kept["numbers"]):
            continue
        flow = flow.replace(kept["numbers"])
        if list(map(repr, flow.modes)) == kept["modes"] and flow.names(len(kept["names"])) == tuple(kept["names"]):
            return flow
    why = "none of those given has these states, numbers and modes" if given else "a file does not hold its functions, which are Python"
    raise InputError("load", [f"{what}, and {why}; type ss.load(path, machines=[flow]) with the flow, or xarray.open_dataset for columns"])


def _check_rates(flow: Any, pieces: FlowPieces, near: float) -> None:
    """`InputError` where the rates of a flow are not those of the run's polynomials."""
    for k in np.unique(np.linspace(0, len(pieces.mode) - 1, _LOOKS).astype(int)):
        length = float(pieces.t[k + 1] - pieces.t[k])
        c = pieces.coefficients[k].T
        y, rate = polyval(0.5, c), polyval(0.5, polyder(c)) / (length or 1.0)
        own = _rates(flow, int(pieces.mode[k]), float(pieces.t[k] + 0.5 * length), list(map(float, y)))
        if length and np.any(abs(own - rate) > near * (abs(rate) + np.max(abs(y)) / length)):
            t = float(pieces.t[k] + 0.5 * length)
            mistake = f"the flow given has the rates {own.tolist()} at t = {t:.9g}, and the run in the file has {rate.tolist()} there"
            raise InputError("load", [f"{mistake}; give the flow that was solved"])


def _rates(flow: Any, index: int, t: float, y: list[float]) -> Array:
    """The rates in a mode, by its place, as the flow's plain functions give them."""
    mode, sides = list(flow.labels.values())[index]
    plain = flow.plain
    rates = ContactForces(plain).rates(mode, sides, t, y) if flow.contacts else plain.fields[mode](t, y)
    return np.asarray(rates, float)
