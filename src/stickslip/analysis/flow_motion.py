"""The motion at the end of a run of a switching flow: whether it repeats, how far its states swing, and which modes it goes through."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.section_choice import cut_of, passages
from stickslip.basics.arguments import described_as
from stickslip.basics.contracts import Array
from stickslip.basics.notebook_display import Drawn
from stickslip.results.flow_pieces import extremes

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

_NEAR = 1e-6  # of the swing: states at two returns that differ by less are one
_STILL = 1e-9  # of a state's largest size in the run: what moves by less in the second half of a run stands still
_LONGEST = 16  # turns after which a motion may repeat


@described_as("what ss.motion returns of a flow; type ss.motion(run)")
@dataclass(frozen=True)
class FlowMotion(Drawn):
    """The motion that a flow ends in.

    Parameters
    ----------
    type : str
        "periodic", "steady" (no state changes), or "not settled": then the other numbers are those of the second half of the run.
    period : int or None
        After how many periods of the forcing it repeats, 1 to 16, or, of a flow without one, after how many returns to the section that the
        run shows; None of what does not repeat within the run, or is steady.
    duration : float
        The time until it repeats; NaN where it does not.
    ranges : dict of (float, float)
        Smallest and largest value in a cycle, by state.
    modes : dict of float
        Fraction of the time in each mode that it goes through.
    pattern : tuple
        The modes in the order in which a cycle goes through them, from where it passes the section.
    mean_rates : dict of float
        Mean rate of each cyclic coordinate over the cycle, by state; without one of the second half of the run.
    change : float
        How far the states at the last return are from those of a cycle before, as a part of their swing; NaN without two returns.

    Examples
    --------
    A ball that is thrown up again at every hit:

    >>> import stickslip as ss
    >>> hit = ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, 2.0))
    >>> ball = ss.SwitchingFlow({0: lambda t, y: (y[1], -10.0)}, {0: (hit,)}, states=("height", "v"))
    >>> m = ss.motion(ss.solve(ball, start={"height": 1.0}, duration=20.0))
    >>> m.type, m.period, round(m.duration, 9), round(m.ranges["height"][1], 9), round(m.amplitudes["v"], 9)
    ('periodic', 1, 0.4, 0.2, 2.0)
    """

    type: str
    period: int | None
    duration: float
    ranges: dict[str, tuple[float, float]]
    modes: dict[Any, float]
    pattern: tuple[Any, ...]
    change: float
    mean_rates: dict[str, float] = field(default_factory=dict)
    _run: Any = None

    _drawn_by = "phase"

    def _drawn(self) -> Any:
        return self._run

    @property
    def amplitudes(self) -> dict[str, float]:
        """Half of the way from the smallest to the largest value, by state."""
        return {name: 0.5 * (high - low) for name, (low, high) in self.ranges.items()}

    @property
    def mean_velocity(self) -> float:
        """Mean rate of the first cyclic coordinate; NaN of a flow without one."""
        return next(iter(self.mean_rates.values()), np.nan)

    @property
    def settled(self) -> bool:
        """Whether it repeats, or is steady."""
        return self.type != "not settled"

    def _facts(self) -> dict[str, Any]:
        facts: dict[str, Any] = {"type": self.type}
        if self.period is not None:
            facts["repeats after"] = f"{self.duration:.9g} ({self.period} turn{'s' * (self.period != 1)})"
        facts |= {f"mean rate of {name}": f"{rate:.9g}" for name, rate in self.mean_rates.items()}
        if not self.settled:
            facts["change from turn to turn"] = f"{self.change:.1e} of the swing; run it for longer"
        return facts

    def _tables(self) -> list[list[tuple[str, ...]]]:
        states = [(name, f"{low:.6g}", f"{high:.6g}") for name, (low, high) in self.ranges.items()]
        modes = [(str(mode), f"{100 * part:.1f} %") for mode, part in self.modes.items()]
        return [[("state", "smallest", "largest"), *states], [("mode", "of the time"), *modes]]

    def __str__(self) -> str:
        return self._text()


def flow_motion(run: Trajectory, settle: float | None = None) -> FlowMotion:
    """The motion at the end of a run of a flow: of what is later than `settle`, or of its second half; of a run that is a cycle of all."""
    begin, end, known = float(run.nodes[0]), float(run.nodes[-1]), run.known_period
    middle = begin if known is not None else 0.5 * (begin + end) if settle is None else settle
    low, high = _range(run, middle, end)
    kept = np.delete(np.arange(len(low)), run.model.drifts.free)
    low, high, lowest, highest = (each[kept] for each in (low, high, run.lowest, run.highest))
    if np.all(high - low <= _STILL * np.maximum(abs(lowest), abs(highest))):
        return _of(run, "steady", None, middle, end, 0.0)
    if known is not None:
        returns = np.array([begin, end])
    else:
        returns = run.strobe_times if run.model.period is not None else passages(run, cut_of(run))
        returns = returns[returns >= middle]
    if len(returns) < 2:
        return _of(run, "not settled", None, middle, end, np.nan)
    states = run.at(returns)
    points, swing = np.column_stack([np.asarray(states[name], float) for name in run.names]), np.full(len(run.names), np.inf)
    swing[kept] = np.maximum(high - low, 1e-300)
    points, swing = run.model.drifts.embedded(points, swing) if run.model.drifts else (points, swing)
    rows = points / swing
    if known is not None:
        return _of(run, "periodic", known, begin, end, float(np.max(abs(rows[1] - rows[0]))))
    modes = np.asarray(states["mode"])
    misses = [float(np.max(abs(rows[-1] - rows[-1 - p]))) for p in range(1, min(_LONGEST, len(rows) - 1) + 1)]
    for p, miss in enumerate(misses, start=1):
        lasting = len(rows) > 2 * p and float(np.max(abs(rows[-1 - p] - rows[-1 - 2 * p]))) <= 10.0 * _NEAR
        if miss <= _NEAR and lasting and modes[-1] == modes[-1 - p]:
            return _of(run, "periodic", p, float(returns[-1 - p]), float(returns[-1]), miss)
    return _of(run, "not settled", None, middle, end, min(misses))


def _pieces(run: Trajectory, begin: float, end: float) -> Array:
    """The pieces of a run that lie within a stretch, even if in part."""
    return np.flatnonzero((run.nodes[1:] > begin) & (run.nodes[:-1] < end))


def _range(run: Trajectory, begin: float, end: float) -> tuple[Array, Array]:
    """Smallest and largest value of each state on the pieces of a stretch; of a cycle what a piece has beyond its end is of the next."""
    c = run.pieces.coefficients[_pieces(run, begin, end)]
    return extremes(c, c[:1, :, 0])


def _of(run: Trajectory, kind: str, period: int | None, begin: float, end: float, change: float) -> FlowMotion:
    """The numbers of a stretch of a run: a cycle, or what there is."""
    low, high = _range(run, begin, end)
    pieces = _pieces(run, begin, end)
    times = np.minimum(run.nodes[pieces + 1], end) - np.maximum(run.nodes[pieces], begin)
    labels = run._columns.labels(pieces).tolist()
    parts: dict[Any, float] = {}
    for label, time in zip(labels, times.tolist(), strict=True):
        parts[label] = parts.get(label, 0.0) + time / (end - begin)
    pattern = tuple(label for k, label in enumerate(labels) if k == 0 or label != labels[k - 1])
    pattern = pattern[:-1] if period is not None and len(pattern) > 1 and pattern[-1] == pattern[0] else pattern
    ranges = {name: (float(a), float(b)) for name, a, b in zip(run.names, low, high, strict=True)}
    at, cyclic = run.at(np.array([begin, end])), run.model.drifts.names
    rates = {name: float((at[name][1] - at[name][0]) / (end - begin)) for name in cyclic}
    return FlowMotion(kind, period, end - begin if period else np.nan, ranges, parts, pattern, change, rates, run)
