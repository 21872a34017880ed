"""The motion at the end of a run without drive periods: whether it oscillates by itself, rests, or slides on steadily."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.run_segments import segments_within, watched_contacts
from stickslip.analysis.section_choice import cut_of, passages
from stickslip.basics.arguments import described_as
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.maths import bisected
from stickslip.basics.notebook_display import Drawn
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.models.rounding import without_rounding
from stickslip.results.segments import intervals_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

#: A contact counts as stuck while the elastic part of its friction is below this fraction of its steady sliding value ...
SLIP_RATIO = 0.75
#: ... for at least this fraction of a drive period, or of a cycle.
DWELL = 0.03
_STEADY = 1e-6  # of the velocity scale: velocities that vary by less in the second half of a run are steady
_NEAR = 1e-6  # of the swing: states at two returns that differ by less are one, unless the tolerance of the run is coarser
_LONGEST = 16  # turns after which a motion may repeat
_HALVINGS = 60
_SAMPLES = 400  # instants in a cycle at which extremes are looked for, besides those of the columns


@dataclass(frozen=True)
class ContactOscillation:
    """What one contact does in a cycle: the signs of its slip in order, and the fractions of the time."""

    pattern: str
    stick_fraction: float
    forward_fraction: float
    backward_fraction: float


@described_as("what ss.motion returns of a machine without a period; type ss.motion(run)")
@dataclass(frozen=True)
class Oscillation(Drawn):
    """The motion that a machine without a period ends in.

    A turn is the time from one passage of a section to the next. It is the section of return maps and cycles: a turn of the spring of one
    body on a spring, else the middle of the range of the position that moves most.

    Parameters
    ----------
    type : str
        As of a limit cycle, see `kind_of_cycle`: "stick-slip", "slip", "reversing" or "oscillation"; or "steady" (no velocity changes),
        or "not settled": then all other numbers are those of the last turn. Where the second half of the
        run has no whole turn, velocities and contacts are those of this half, and the other numbers are NaN.
    period : int or None
        Turns until it repeats, 1 to 16; None of what does not repeat within the run, or is steady.
    duration : float
        The time until it repeats [s]; NaN where it does not.
    amplitudes : dict of float
        Half of the way from the lowest to the highest position in a cycle, by body, less the mean motion [m].
    velocity_ranges : dict of (float, float)
        Lowest and highest velocity in a cycle, by body [m/s].
    mean_velocity : float
        Of the centre of mass, or of the principal body, over a cycle [m/s].
    contacts : dict of ContactOscillation
        By name.
    change : float
        How far the states at the last return are from those of a cycle before, as a part of their swing.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    >>> run = ss.solve(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law), duration=60)
    >>> m = ss.motion(run)
    >>> m.type, m.period, round(m.duration, 9), round(m.amplitude, 9), round(m.stick_fraction, 6), m.pattern
    ('stick-slip', 1, 7.611259254, 0.259807621, 0.656922, '0-')
    """

    type: str
    period: int | None
    duration: float
    amplitudes: dict[str, float]
    velocity_ranges: dict[str, tuple[float, float]]
    mean_velocity: float
    contacts: dict[str, ContactOscillation]
    change: float
    _run: Any = None

    _drawn_by = "phase"

    def _drawn(self) -> Any:
        return self._run

    @property
    def amplitude(self) -> float:
        """Of the only body, or the largest [m]."""
        return max(self.amplitudes.values())

    @property
    def settled(self) -> bool:
        """Whether it repeats, or is steady."""
        return self.type != "not settled"

    @property
    def brief(self) -> str:
        """The type, as a printed run has it."""
        return self.type

    @property
    def pattern(self) -> str:
        """Signs of the slip in a cycle, of a machine with one contact."""
        return self._only("pattern").pattern

    @property
    def stick_fraction(self) -> float:
        """Part of the time in which the contact sticks, of a machine with one contact."""
        return self._only("stick_fraction").stick_fraction

    def _only(self, what: str) -> ContactOscillation:
        if len(self.contacts) == 1:
            return next(iter(self.contacts.values()))
        names = ", ".join(map(repr, self.contacts)) or "none"
        mistake = f"{what} is that of one contact, and the machine has {len(self.contacts)} ({names})"
        raise InputError("motion", [f"{mistake}; type motion.contacts[name].{what}"])

    def _facts(self) -> dict[str, Any]:
        facts: dict[str, Any] = {"type": self.type}
        if not np.isnan(self.mean_velocity):
            mean = self.mean_velocity if self._run is None else without_rounding(self.mean_velocity, self._run.model)
            facts["mean velocity"] = f"{mean:.6g} {self._unit('v', '')}"
        if self.period is not None:
            facts["repeats after"] = f"{self.duration:.9g} s ({self.period} turn{'s' * (self.period != 1)})"
        if self.type == "not settled":
            change = "change from turn to turn", f"{self.change:.1e} of the swing"
            what, how = ("whole turns in its second half", "none, or too few") if np.isnan(self.change) else change
            facts[what] = f"{how}; run it for longer"
        return facts

    def _unit(self, column: str, body: str) -> str:
        """Of a body's position or velocity, or of the machine's."""
        return unit_of_part(column, self._run.model, body) if self._run is not None else {"x": "m", "v": "m/s"}[column]

    def _tables(self) -> list[list[tuple[str, ...]]]:
        bodies = []
        for name, (low, high) in self.velocity_ranges.items():
            way, rate = self._unit("x", name), self._unit("v", name)
            bodies.append((name, f"{self.amplitudes[name]:.6g} {way}", f"{low:.6g} {rate}", f"{high:.6g} {rate}"))
        contacts = [
            (
                name,
                c.pattern.replace("-", "−"),
                *(f"{100 * part:.1f} %" for part in (c.forward_fraction, c.backward_fraction, c.stick_fraction)),
            )
            for name, c in self.contacts.items()
        ]
        head = ("contact", "pattern", "forward", "backward", "stick")
        return [[("body", "amplitude", "lowest velocity", "highest velocity"), *bodies], [head, *contacts]]

    def __str__(self) -> str:
        return self._text()

    def __getattr__(self, name: str) -> Any:
        known = "type, period, duration, amplitudes, velocity_ranges, mean_velocity, contacts, change"
        raise AttributeError(f"the motion of a machine without a period has no {name}; it has {known}; type for example motion.duration")


def oscillation(run: Trajectory, slip_ratio: float, dwell: float, settle: float | None = None) -> Oscillation:
    """The motion at the end of a run of a machine without a period, or of one that is a cycle; `dwell` is a part of its cycle.

    What is earlier than `settle` [s] is not looked at, or the first half of the run.
    """
    run = run.with_axes
    begin, end = float(run.pieces.t[0]), float(run.pieces.t[-1])
    if run.known_period is not None:
        return _of_stretch(run, "", run.known_period, begin, end, _missed(run, begin, end), slip_ratio, dwell)
    settle = 0.5 * (begin + end) if settle is None else settle
    late = np.unique(np.concatenate([run.t[run.t >= settle], [end]]))
    v = _velocities(run, late)
    swings = np.ptp(v, axis=0)
    if swings.max() <= _STEADY * float(np.max(machine_of(run.model).velocity_scale)):
        return _of_stretch(run, "steady", None, float(late[0]), end, 0.0, slip_ratio, dwell)
    returns = passages(run, cut_of(run))
    returns = returns[returns >= late[0]]
    if len(returns) < 2:  # velocities and contacts are those since `settle`; of a part of a turn there is no amplitude and no mean
        part = _of_stretch(run, "not settled", None, float(late[0]), end, np.nan, slip_ratio, dwell)
        return replace(part, amplitudes=dict.fromkeys(part.amplitudes, np.nan), mean_velocity=np.nan)
    turns, change = _repeats(run, returns, v)
    if turns is None:
        return _of_stretch(run, "not settled", None, float(returns[-2]), float(returns[-1]), change, slip_ratio, dwell)
    return _of_stretch(run, "", turns, float(returns[-1 - turns]), float(returns[-1]), change, slip_ratio, dwell)


def kind_of_cycle(patterns: Sequence[str], inner_states: bool) -> str:
    """What a cycle is, by the signs of the slip of each contact in it, 0 where it rests.

    Stick-slip: a contact rests or, with inner states, which let no contact rest, its slip changes sign. Slip: all slide on one side.
    Reversing: on both, without rest. Oscillation: there is no contact.

    Examples
    --------
    >>> kind_of_cycle(["0-"], False), kind_of_cycle(["+-"], True), kind_of_cycle(["-"], True), kind_of_cycle(["+-", "+"], False)
    ('stick-slip', 'stick-slip', 'slip', 'reversing')
    """
    if not patterns:
        return "oscillation"
    if any("0" in pattern for pattern in patterns):
        return "stick-slip"
    if all(len(pattern) == 1 for pattern in patterns):
        return "slip"
    return "stick-slip" if inner_states else "reversing"


def _velocities(run: Trajectory, t: Array) -> Array:
    """Velocities of the bodies at some instants (time, body)."""
    return np.asarray(run._states_at(t, run._index(t))[1], float)


def _repeats(run: Trajectory, returns: Array, v: Array) -> tuple[int | None, float]:
    """After how many turns the states at the returns, and what happened between them, come back; and how far they are from it."""
    states = run.at(returns)
    x = np.asarray(states["x"], float).reshape(len(returns), -1)
    z = np.asarray(states["z"], float).reshape(len(returns), -1) if states["z"] is not None else np.zeros((len(returns), 0))
    ways, times = np.diff(x[:, 0]), np.diff(returns)
    rows = np.column_stack([_velocities(run, returns)[1:], (x - x[:, :1])[1:], z[1:], ways, times])
    way, inner = max(float(np.ptp(v)) * float(times.mean()), 1e-300), np.max(abs(z), axis=0, initial=0.0)
    speeds = np.maximum(np.ptp(v, axis=0), 1e-300)
    sizes = np.concatenate([speeds, np.full(x.shape[1], way), np.where(inner > 0, inner, 1.0), [way, float(times.mean())]])
    near = max(_NEAR, 100.0 * float(run.rtol))
    misses = [float(np.max(abs(rows[-1] - rows[-1 - p]) / sizes)) for p in range(1, min(_LONGEST, len(rows) - 1) + 1)]
    for p, miss in enumerate(misses, start=1):
        lasting = len(rows) > 2 * p and float(np.max(abs(rows[-1 - p] - rows[-1 - 2 * p]) / sizes)) <= 10.0 * near
        if miss <= near and lasting:
            return p, miss
    return None, min(misses, default=np.nan)


def _missed(run: Trajectory, begin: float, end: float) -> float:
    """How far the states at the end of a cycle are from those at its beginning, as a part of their swing."""
    ends = np.array([begin, end])
    x, v, z = (np.asarray(of, float).reshape(2, -1) for of in run._states_at(ends, run._index(ends)))
    swing, inner = np.maximum(np.ptp(run.v, axis=0), 1e-300), np.max(abs(z), axis=0, initial=0.0)
    way = np.full(x.shape[1], max(float(np.ptp(run.v)) * (end - begin), 1e-300))
    rows, sizes = np.column_stack([v, x - x[:, :1], z]), np.concatenate([swing, way, np.where(inner > 0, inner, 1.0)])
    return float(np.nanmax(abs(rows[1] - rows[0]) / sizes))


def _of_stretch(
    run: Trajectory, kind: str, turns: int | None, begin: float, end: float, change: float, slip_ratio: float, dwell: float
) -> Oscillation:
    """The numbers of a stretch of a run: a cycle, or what there is."""
    t = np.unique(np.concatenate([run.t[(run.t > begin) & (run.t < end)], np.linspace(begin, end, _SAMPLES)]))
    ends = np.asarray(run.at(np.array([begin, end]))["x"], float).reshape(2, -1)
    drift = (ends[1] - ends[0]) / (end - begin)
    t = np.unique(np.concatenate([t, *_turnings(run, t, "v", drift), *_turnings(run, t, "acceleration", 0.0 * drift)]))
    x = np.asarray(run.at(t)["x"], float).reshape(len(t), -1)
    v = _velocities(run, t)
    swing = np.ptp(x - drift * (t - begin)[:, None], axis=0) / 2
    layout = run.pieces.layout
    names = [body.name for body in layout.bodies]
    segments = {name: segments_within(each, begin, end, slip_ratio) for name, each in watched_contacts(run).items()}
    contacts = {name: _contact(edges, code, dwell) for name, (edges, code, _) in segments.items()}
    if not kind:  # however short its intervals are
        signs = [
            {*contacts[name].pattern, *("-0+"[1 + side] for side in np.sign(code).tolist())} for name, (_, code, _) in segments.items()
        ]
        kind = kind_of_cycle(["".join(each) for each in signs], machine_of(run.model).has_inner_states)
    m = machine_of(run.model).mechanics
    rates = m.coordinates_of(tuple(drift))
    mean = float(sum(float(share) * rate for share, rate in zip(m.shares, rates, strict=True)))
    return Oscillation(
        kind, turns, end - begin if turns else np.nan, dict(zip(names, swing.tolist(), strict=True)),
        {name: (float(low), float(high)) for name, low, high in zip(names, v.min(axis=0), v.max(axis=0), strict=True)}, mean, contacts,
        change, run,
    )  # fmt: skip


def _turnings(run: Trajectory, t: Array, column: str, level: Array) -> list[Array]:
    """For each body the instants at which a column passes a level: there what it is the rate of has an extreme."""
    instants = []
    for body in range(len(level)):
        above = _is_above(run, column, body, level[body], t)
        where = np.flatnonzero(above[1:] != above[:-1])
        as_before = partial(_is_as_before, run, column, body, level[body], above[where])
        instants += list(bisected(as_before, t[where], t[where + 1], _HALVINGS)) if len(where) else []
    return instants


def _is_above(run: Trajectory, column: str, body: int, level: float, t: Array) -> Array:
    """Whether a column of a body is above a level at some instants."""
    values = _velocities(run, t) if column == "v" else np.asarray(run.at(t)[column], float).reshape(len(t), -1)
    return np.asarray(values[:, body] > level)


def _is_as_before(run: Trajectory, column: str, body: int, level: float, before: Array, t: Array) -> Array:
    """Whether that is what it was before."""
    return np.asarray(_is_above(run, column, body, level, t) == before)


def _contact(edges: Array, code: Array, dwell: float) -> ContactOscillation:
    """What one contact does in the intervals between these instants, by the signs of its slip."""
    time = np.diff(edges) / (edges[-1] - edges[0])
    merged = intervals_of(np.array([len(time)]), time[None, :], code[None, :], dwell)
    parts = [float(merged.length[0][merged.sign[0] == sign].sum()) for sign in (0, 1, -1)]
    return ContactOscillation(_from_rest(str(merged.pattern[0])), *parts)


def _from_rest(pattern: str) -> str:
    """A pattern that begins with rest, if there is any: "0-" for "-0"."""
    return pattern[pattern.index("0") :] + pattern[: pattern.index("0")] if "0" in pattern else pattern
