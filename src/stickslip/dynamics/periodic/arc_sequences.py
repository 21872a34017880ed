"""A motion under a set-valued law as a sequence of arcs whose switch times are the unknowns.

Each arc slides forwards, slides backwards or is at rest. A slide ends where v = 0, rest ends where the net applied force meets the
break-away force. Whether the sequence is a motion at all is told by its margins, all of which must be positive:

- hold: where a slide ends in rest, the net applied force lies within the break-away forces;
- reverse: where a slide turns over without rest, it lies beyond them;
- rest: during rest the net applied force stays within them;
- graze: within a slide v does not come down to zero.

A border of motion types is a margin that vanishes: one more equation, for one parameter that is free.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.state_order import needs_one_body
from stickslip.basics.contracts import Array, ArrayLike, Model
from stickslip.basics.errors import InputError
from stickslip.basics.forward_ad import slopes_of, variables
from stickslip.models.forces import offered_force
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.position_dependence import knows_position

if TYPE_CHECKING:
    from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit


Margin = tuple[str, int, int]  # name, number of the arc, side
_SAMPLES = 96


@dataclass(frozen=True)
class Sequence:
    """Modes of the arcs in order, and the drive periods after which they repeat. Times are in drive periods."""

    modes: tuple[int, ...]
    period: int

    @property
    def pattern(self) -> str:
        """The modes as signs."""
        return "".join({1: "+", 0: "0", -1: "-"}[m] for m in self.modes)

    def ends(self, times: Array) -> Array:
        """Where each arc ends."""
        return np.append(times[1:], times[0] + self.period) if len(times) else np.array([float(self.period)])


def sequence_of(orbit: PeriodicOrbit) -> tuple[Sequence, Array]:
    """The arcs of an orbit and their switch times.

    Examples
    --------
    >>> import stickslip as ss
    >>> found, times = sequence_of(ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")))
    >>> found.pattern, times.round(6).tolist()
    ('0+-', [0.050631, 0.07294, 0.634425])
    """
    needs_one_body("sequence_of", orbit.model, "it follows the arcs of one contact")
    if law_of(orbit.model).dynamic or knows_position(orbit.model):
        raise InputError("sequence_of", ["an orbit as a sequence of arcs needs a set-valued law, and equations in which x does not appear"])
    T = float(orbit.model.period)
    t, mode = np.asarray(orbit.run.pieces.t), np.asarray(orbit.run.pieces.mode)[:, 0]
    where = np.flatnonzero(np.diff(mode)) + 1
    times, modes = list(t[where] / T), [int(m) for m in mode[where]]
    if mode[-1] != mode[0]:  # a switch on the strobe itself
        times, modes = [*times, float(orbit.period)], [*modes, int(mode[0])]
    if not times:
        return Sequence((int(mode[0]),), orbit.period), np.empty(0)
    return Sequence(tuple(modes), orbit.period), np.array(times)


def gap(model: Model, t: ArrayLike, side: int) -> Array:
    """How far the net applied force is beyond the break-away force of one side, in units of the drive's force: positive within."""
    t = np.asarray(t, float)
    limits = law_of(model).breakaway(normal_load(model, t, 0.0 * t))
    return side * (limits[1 if side > 0 else 0] - offered_force(model, t, 0.0 * t)) / _force(model)


def _force(model: Any) -> float:
    """A typical force of the drive."""
    return float(model.total_mass) * _speed(model) * 2 * np.pi / float(model.period)


def _speed(model: Model) -> float:
    return float(machine_of(model).free_velocity)


def _slide(model: Model, mode: int, begin: float, times: Array) -> Array:
    """Velocity at rising times of a slide that begins with v = 0."""
    from stickslip.solvers.closed_arcs import dimensionless_arcs, handles

    if handles(model) is None:
        from stickslip.results.dense_output import HarmonicArcs

        n = dimensionless_arcs(model)
        numbers = (float(a[0]) for a in (n.drive, n.omega, n.resist_plus, n.resist_minus))
        arc = HarmonicArcs(np.array([begin, np.inf]), np.array([mode]), np.zeros(1), np.zeros(1), *numbers)
        return arc.evaluate(times, np.zeros(len(times), int))[1][:, 0]
    return _integrated(model, mode, begin, times)


def _integrated(model: Any, mode: int, begin: float, times: Array) -> Array:
    """The same for any set-valued law, held on the side of the slide."""
    from scipy.integrate import solve_ivp

    least = 1e-12 * _speed(model)

    def rate(t: float, y: Array | list[float]) -> list[float]:
        v = mode * max(mode * y[0], least)
        return [float(model.acceleration(t, 0.0, y[0], law_of(model).sliding(model.contact_velocity(v), normal_load(model, t, 0.0))))]

    last = float(times[-1])
    if last <= begin:
        return np.zeros(len(times)) + rate(begin, [0.0])[0] * (times - begin)
    done = solve_ivp(rate, (begin, last), [0.0], method="DOP853", rtol=1e-13, atol=1e-15 * _speed(model), dense_output=True)
    return np.append(done.sol(times[:-1])[0], done.y[0, -1])


def misses(model: Model, sequence: Sequence, times: Array) -> Array:
    """One equation for each switch: v = 0 where a slide ends, the net applied force at its limit where rest ends."""
    T, ends = float(model.period), sequence.ends(times)
    residuals = np.empty(len(times))
    for i, mode in enumerate(sequence.modes if len(times) else ()):
        after = sequence.modes[(i + 1) % len(sequence.modes)]
        if mode == 0:
            residuals[i] = float(gap(model, ends[i] * T, after))
        else:
            residuals[i] = float(_slide(model, mode, times[i] * T, np.array([ends[i] * T]))[0]) / _speed(model)
    return residuals


def margins(model: Model, sequence: Sequence, times: Array) -> dict[Margin, float]:
    """By how much each condition of the sequence holds; negative where it does not.

    Examples
    --------
    >>> import stickslip as ss
    >>> orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"))
    >>> sorted({name for name, _, _ in margins(orbit.model, *sequence_of(orbit))})
    ['graze', 'hold', 'rest', 'reverse']
    """
    T, ends, kept = float(model.period), sequence.ends(times), {}
    starts = times if len(times) else np.zeros(1)
    for i, mode in enumerate(sequence.modes):
        after = sequence.modes[(i + 1) % len(sequence.modes)]
        if mode == 0:
            for side in (1, -1):
                if side != after or not len(times):  # on the side where rest ends the force only meets its limit there
                    kept["rest", i, side] = dip(model, starts[i] * T, ends[i] * T, side)
            continue
        kept["graze", i, mode] = _lowest(model, mode, starts[i] * T, ends[i] * T)
        if after == 0:
            kept["hold", i, 1], kept["hold", i, -1] = (float(gap(model, ends[i] * T, side)) for side in (1, -1))
        else:
            kept["reverse", i, after] = -float(gap(model, ends[i] * T, after))
    return kept


def dip(model: Model, begin: float, end: float, side: int) -> float:
    """The smallest distance to a break-away force at a dip within rest; infinite where there is no dip."""
    t = np.linspace(begin, end, _SAMPLES)
    room = np.asarray(gap(model, t, side), float) + 0.0 * t
    dips = np.flatnonzero((room[1:-1] < room[:-2]) & (room[1:-1] <= room[2:])) + 1
    if not len(dips):
        return float("inf")
    from scipy.optimize import brentq

    k = dips[int(np.argmin(room[dips]))]
    where = brentq(lambda s: slope_of_gap(model, s, side), t[k - 1], t[k + 1], xtol=1e-15 * end, rtol=1e-15)
    return float(gap(model, where, side))


def slope_of_gap(model: Model, t: float, side: int) -> float:
    """How fast the distance to a break-away force grows [1/s]."""
    (at,), still = variables(np.array([t])), np.zeros(1)
    limits = law_of(model).breakaway(normal_load(model, at, still))
    (slope,) = slopes_of(offered_force(model, at, still) - limits[1 if side > 0 else 0], 1)
    return -side * float(np.ravel(slope)[0]) / _force(model)


def _lowest(model: Model, mode: int, begin: float, end: float) -> float:
    """The lowest speed at a dip within a slide; infinite where it has no dip."""
    t = np.linspace(begin, end, _SAMPLES + 2)[1:-1]
    speed = mode * _slide(model, mode, begin, t) / _speed(model)
    dips = np.flatnonzero((speed[1:-1] < speed[:-2]) & (speed[1:-1] <= speed[2:])) + 1
    return float(speed[dips].min()) if len(dips) else float("inf")
