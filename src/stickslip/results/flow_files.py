"""Flows in the files of their runs: what tells the flow that is given to `load` from another one."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.jsontext import as_plain
from stickslip.models.flow_contacts import ContactForces
from stickslip.results.flow_pieces import FlowPieces

#: What files said that they hold while runs of flows had a form of their own there.
BEFORE = "run of a flow"
_OF_RUN = ("periods", "settle", "rtol", "method", "status", "samples", "known_period")
_LOOKS, _NEAR = 16, 1e-6  # steps at which rates are compared, and how close they are for one flow
_TOLERATED = 1e-2  # the same of steps that hold a tolerance, whose polynomials are less close than their ends


def description_of(flow: Any, names: Sequence[str]) -> str:
    """The numbers, the names of the states and the modes of a flow, as text."""
    return json.dumps(as_plain({"numbers": flow.numbers, "names": names, "modes": list(map(repr, flow.modes))}))


def as_now(attrs: dict[str, Any], kept: dict[str, Any]) -> dict[str, Any]:
    """The attributes of a file in the form in which they are written now; before, those of a flow's run were one text of its pieces."""
    if attrs["stickslip_content"] != BEFORE:
        return attrs
    text = kept["run"]
    run = json.loads(str(text.item() if isinstance(text, np.ndarray) else text))
    words = {name: json.dumps(run[name]) for name in ("start", "provenance", "counts")}
    settings = {name: run[name] for name in _OF_RUN if run.get(name) is not None}
    return {**attrs, **settings, **words, "flow": json.dumps({name: run[name] for name in ("numbers", "names", "modes")})}


def flow_of(described: dict[str, Any], given: Sequence[Any], pieces: FlowPieces, method: str) -> Any:
    """The flow of a run that was solved by a method, among those that are given, with the numbers of the file.

    Raises
    ------
    InputError
        If none of them is the flow of the run.
    """
    flow = _like(described, given)
    if np.any(pieces.switch_modes >= len(flow.modes)) or pieces.end_mode >= len(flow.modes):
        raise ValueError("it has more modes than its flow")
    _check_rates(flow, pieces, _NEAR if method == "exact" else _TOLERATED)
    return flow


def _like(kept: dict[str, Any], given: Sequence[Any]) -> Any:
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
