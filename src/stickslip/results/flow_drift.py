"""The mean rates at which the cyclic coordinates of a flow drift, over whole motion periods where the motion repeats."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import NoBodies
from stickslip.results import recurrence
from stickslip.results.recurrence import scales_of
from stickslip.results.steadiness import window_count

NO_BODIES = (
    "allowed is a run of a machine, and this one is that of a flow, which has states of its own and no bodies; type run[name] for a state, "
    "run.strobe for its strobe points"
)
LONGEST = 32  # periods after which a motion may repeat
SAME = 1e-8  # of its size: strobe points this close are one


def mean_rates(run: Any) -> dict[str, float]:
    """Mean rate of each cyclic coordinate of a run of a flow, by name: over the part after settling, or all of a run without a period.

    Examples
    --------
    >>> import stickslip as ss
    >>> flow = ss.SwitchingFlow(lambda t, y: (2.0 + y[1], -y[1]), states=("x", "v"), cyclic="x")
    >>> mean_rates(ss.solve(flow, start={"v": 0.0}, duration=3.0))
    {'x': 2.0}
    """
    cyclic = run.model.drifts
    if run.model.period is None:
        t, points = run.nodes[[0, -1]], np.vstack([run.pieces.coefficients[0, :, 0], run.state])
    else:
        t, points = run.strobe_times, run.strobe
        period = run.known_period or repeats_after(run.model, points, recurrence) if len(t) > 1 else 1
        count = window_count(len(t) - 1, int(run.settle), period) if len(t) > 1 else 0
        t, points = t[-1 - count :], points[-1 - count :]
    if len(t) < 2:
        return dict.fromkeys(cyclic.names, float("nan"))
    way = (points[-1] - points[0]) / (t[-1] - t[0])
    return {name: float(way[index]) for name, index in zip(cyclic.names, cyclic.places, strict=True)}


def drift_velocity(run: Any) -> float:
    """Mean rate of the first cyclic coordinate of a run of a flow; `NoBodies` of a flow without one, which has no displacement."""
    if not run.model.cyclic:
        raise NoBodies("mean_velocity", [f"{NO_BODIES}, or ss.SwitchingFlow(..., cyclic='x') to say which state is a displacement"])
    return next(iter(run.mean_rates.values()))


def repeats_after(flow: Any, points: Array, recurrence: Any) -> int:
    """After how many periods of the forcing strobe points (point, state) repeat; 0 if they do not. `recurrence` has the rules."""
    scales = np.full(points.shape[1], max(float(abs(flow.drifts.wrapped(points)).max()), 1e-300))
    points, scales = flow.drifts.embedded(points, scales) if flow.drifts else (points, scales)
    rows, last = np.column_stack([np.zeros(len(points)), points]), len(points) - 1
    return int(recurrence.period_number(rows, last, last, LONGEST, scales_of(scales), SAME, SAME)[0])
