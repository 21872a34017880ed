r"""Periodic motions that are proved to exist: enclosures of their switch times, mean velocity and multiplier.

For one body under a set-valued law whose arcs are closed formulas, w' = sin tau - r with r = r_plus forwards and -r_minus backwards. Every
slide begins with w = 0, so that the switch times are the only unknowns; Krawczyk's operator proves that their equations have one solution
near the orbit. The conditions that make it a motion are then enclosed over whole arcs: no slide comes to zero before its end, rest stays
within its limits, and what follows each switch is what must follow.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.batch import numbers_by_name
from stickslip.basics.contracts import ArrayLike, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.periodic.arc_sequences import Sequence, sequence_of
from stickslip.dynamics.periodic.ball_arithmetic import Ball, Enclosure, above_zero, balls_of, flint_for, krawczyk
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.engine.closed_arc_conditions import closed_of
from stickslip.solvers.closed_arcs import handles


@sealed
class Certificate:
    """Proved properties of a periodic motion.

    Parameters
    ----------
    proved : bool
        Whether a motion with this sequence of arcs exists, and no other one nearby has the same sequence.
    why : str
        What could not be proved; "" if all was.
    pattern : str
        The arcs in order: + slides forwards, - backwards, 0 rests.
    period : int
        Number of drive periods after which it repeats.
    times : tuple of Enclosure
        When each arc begins [drive periods].
    mean_velocity : Enclosure or None
        [m/s].
    multiplier : Enclosure or None
        Derivative of the velocity after one motion period with respect to that before it; 0 if the body rests in between.
    shares : dict of str to Enclosure
        Fractions of the period taken by the arcs of each sign.
    margins : dict of str to float
        Smallest amounts by which the applied force stays within, or exceeds, the static friction limits, in units of the drive's force; by
        the condition and the number of the arc.

    Examples
    --------
    >>> import stickslip as ss
    >>> rest = ss.dynamics.certify(ss.periodic_orbit(ss.presets.coulomb_robot(1.2, 1.5)))
    >>> rest.proved, rest.pattern, round(rest.margins["rest within its limits, 0"], 6)
    (True, '0', 0.5)
    """

    proved: bool
    why: str
    pattern: str
    period: int
    times: tuple[Enclosure, ...] = ()
    mean_velocity: Enclosure | None = None
    multiplier: Enclosure | None = None
    shares: dict[str, Enclosure] | None = None
    margins: dict[str, float] | None = None

    def __str__(self) -> str:
        if not self.proved:
            return f"not proved: {self.why}"
        lines = [f"proved: one motion {self.pattern} of {self.period} drive period{'s' * (self.period > 1)}"]
        lines += [f"mean velocity  {self.mean_velocity} m/s", f"multiplier     {self.multiplier}"]
        return "\n".join([*lines, *(f"{sign} from         {t}" for sign, t in zip(self.pattern, self.times, strict=False))])


def certify(orbit: PeriodicOrbit, digits: int = 20) -> Certificate:
    r"""Prove that a periodic motion exists, with rigorous bounds of its properties.

    For one body under a set-valued law with closed-form arcs, such as Coulomb friction under a harmonic drive. The numbers of the model are
    taken as their printed decimals: 9.81 is 981/100, not the nearest double. The law guarantees that the break-away force is not below the
    sliding friction.

    Parameters
    ----------
    orbit : PeriodicOrbit
        From `stickslip.periodic_orbit`, stable or not.
    digits : int
        Number of digits of the enclosures.

    Returns
    -------
    Certificate
        `proved` is False, with the reason in `why`, if a condition cannot be distinguished from equality, as on the border of two motion
        types.

    Raises
    ------
    InputError
        If the arcs of the model are not closed formulas, or python-flint is not installed.

    Notes
    -----
    Each slide from the phase :math:`\tau_i`, on the side s, ends at :math:`\tau_{i+1}` where

    .. math:: (S - r_s)\,d - S\,(d - \sin d) + C\,(1 - \cos d) = 0, \qquad d = \tau_{i+1} - \tau_i,\; S = s \sin\tau_i,\; C = s \cos\tau_i

    and rest where :math:`s \sin\tau_{i+1}` is the limit of rest on the side s of the next slide. Krawczyk's operator is applied to these
    equations in ball arithmetic (F. Johansson, IEEE Trans. Comput. 66 (2017) 1281).

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    >>> proof = ss.dynamics.certify(ss.periodic_orbit(robot))
    >>> proof.proved, proof.pattern, proof.multiplier.high < 1e-300
    (True, '0+-', True)
    >>> bool(abs(float(proof.mean_velocity) - ss.analysis.periodic_mean_velocity(robot)) < 1e-15)
    True
    """
    _check(orbit, digits)
    flint = flint_for("certify")
    with flint.ctx.workprec(int(3.33 * digits) + 128):
        sequence, times = sequence_of(orbit)
        return _Proof(flint, orbit.model, sequence, digits).certificate(times)


def _check(orbit: PeriodicOrbit, digits: Any) -> None:
    problems = Problems("certify")
    problems.whole("digits", digits, 1, example=20, most=10_000)
    problems.check()
    if not isinstance(orbit, PeriodicOrbit):
        mistake = f"orbit = {type(orbit).__name__}; allowed is a periodic orbit; type ss.dynamics.certify(ss.periodic_orbit(robot))"
        raise InputError("certify", [mistake])
    if reason := handles(orbit.model):
        raise InputError("certify", [f"{reason}; a proof needs these formulas"])


class _Missing(Exception):
    """A condition that could not be proved."""


class _Proof:
    """The equations of one sequence of arcs in balls."""

    def __init__(self, flint: Any, model: Model, sequence: Sequence, digits: int):
        self.flint, self.arb, self.sequence, self.digits = flint, flint.arb, sequence, digits
        self.turn = 2 * flint.arb.pi()
        numbers = self._numbers(model)
        drive = numbers["drive"]
        self.speed = drive / numbers["omega"]
        self.resist = {side: numbers[f"resist_{word}"] / drive for side, word in ((1, "plus"), (-1, "minus"))}
        self.hold = {side: numbers[f"hold_{word}"] / drive for side, word in ((1, "plus"), (-1, "minus"))}
        self.margins: dict[str, float] = {}

    def _numbers(self, model: Model) -> dict[str, Ball]:
        closed = closed_of(model)
        known = {name: float(np.ravel(value)[0]) for name, value in numbers_by_name(model).items()}
        roots = [*closed.numbers.values(), *(s for pair in closed.sines for s in pair), *(c for _, c in closed.vanishing)]
        balls = balls_of(self.arb, known, roots)
        for why, c in closed.vanishing:
            if not balls[c.number].contains(0):
                raise InputError("certify", [f"the acceleration depends on {why}, so that arcs are not closed formulas"])
        numbers = {name: balls[node.number] for name, node in closed.numbers.items()}
        numbers["omega"] = self.turn / numbers["period"]
        fits = [abs(float(balls[rate.number]) - float(numbers["omega"])) <= 1e-12 * float(numbers["omega"]) for rate, _ in closed.sines]
        numbers["drive"] = sum((balls[a.number] for (_, a), fit in zip(closed.sines, fits, strict=True) if fit), self.arb(0))
        return numbers

    # the equations ------------------------------------------------------------------------------------------------

    def certificate(self, times: ArrayLike) -> Certificate:
        """The proof, or why there is none."""
        motion = self.sequence.pattern, self.sequence.period
        try:
            switch_times = self._switches(times)
            self._arcs(switch_times)
        except _Missing as missing:
            return Certificate(False, str(missing), *motion)
        whole = self.turn * self.sequence.period
        velocity = self.speed * sum((self._way(i, switch_times) for i, m in enumerate(self.sequence.modes) if m), self.arb(0)) / whole
        return Certificate(
            True, "", *motion, tuple(self._enclosure(t / self.turn) for t in switch_times),
            self._enclosure(velocity), self._enclosure(self._multiplier(switch_times)),
            {sign: self._enclosure(share / whole) for sign, share in self._shares(switch_times).items()}, self.margins,
        )  # fmt: skip

    def _enclosure(self, ball: Ball) -> Enclosure:
        return Enclosure.of(ball, self.digits)

    def _switches(self, times: Any) -> list[Ball]:
        if not len(times):
            return []
        start = [self.arb(float(t)) * self.turn for t in times]
        roots = krawczyk(self.flint, self._misses, self._slopes, start, self.arb(10) ** -(self.digits + 8))
        if roots is None:
            raise _Missing("the equations of the switch times have no solution that is isolated near these")
        return roots

    def _ends(self, times: list[Ball]) -> list[Ball]:
        return [*times[1:], times[0] + self.turn * self.sequence.period] if times else [self.turn * self.sequence.period]

    def _after(self, i: int) -> int:
        return self.sequence.modes[(i + 1) % len(self.sequence.modes)]

    def _misses(self, times: list[Ball]) -> list[Ball]:
        residuals = []
        for i, (mode, begin, end) in enumerate(zip(self.sequence.modes, times, self._ends(times), strict=True)):
            if mode:
                residuals.append(self._velocity(mode, begin)(end - begin))
            else:
                residuals.append(self._after(i) * end.sin() - self.hold[self._after(i)])
        return residuals

    def _slopes(self, times: list[Ball]) -> Any:
        n = len(times)
        jacobian = self.flint.arb_mat(n, n)
        for i, (mode, begin, end) in enumerate(zip(self.sequence.modes, times, self._ends(times), strict=True)):
            if mode:
                jacobian[i, i] -= mode * begin.sin() - self.resist[mode]
                jacobian[i, (i + 1) % n] += mode * end.sin() - self.resist[mode]
            else:
                jacobian[i, (i + 1) % n] += self._after(i) * end.cos()
        return jacobian

    def _velocity(self, mode: int, begin: Ball) -> Callable[[Ball], Ball]:
        S, C, r = mode * begin.sin(), mode * begin.cos(), self.resist[mode]
        return lambda d: (S - r) * d - S * (d - d.sin()) + C * (1 - d.cos())

    def _way(self, i: int, times: list[Ball]) -> Ball:
        mode, begin = self.sequence.modes[i], times[i]
        d, S, C = self._ends(times)[i] - begin, mode * begin.sin(), mode * begin.cos()
        half = d * d / 2
        return mode * ((S - self.resist[mode]) * half - S * (half - 1 + d.cos()) + C * (d - d.sin()))

    def _shares(self, times: list[Ball]) -> dict[str, Ball]:
        shares: dict[str, Ball] = {}
        for sign, begin, end in zip(self.sequence.pattern, times or [self.arb(0)], self._ends(times), strict=True):
            shares[sign] = shares.get(sign, self.arb(0)) + end - begin
        return shares

    def _multiplier(self, times: list[Ball]) -> Ball:
        if 0 in self.sequence.modes:
            return self.arb(0)
        multiplier = self.arb(1)
        for i, (mode, end) in enumerate(zip(self.sequence.modes, self._ends(times), strict=True)):
            after = self._after(i)
            multiplier *= (end.sin() - after * self.resist[after]) / (end.sin() - mode * self.resist[mode])
        return multiplier

    # the conditions -----------------------------------------------------------------------------------------------

    def _arcs(self, times: list[Ball]) -> None:
        for i, (mode, begin, end) in enumerate(zip(self.sequence.modes, times or [self.arb(0)], self._ends(times), strict=True)):
            if not end > begin:
                raise _Missing(f"the switches at the ends of arc {i} ({self.sequence.pattern[i]}) cannot be told apart")
            (self._slides if mode else self._rests)(i, mode, begin, end, bool(times))

    def _holds(self, what: str, i: int, bound: Ball | None) -> None:
        if bound is None or not bound >= 0:
            raise _Missing(f"{what} in arc {i} of {self.sequence.pattern} cannot be told from its border")
        if bound > 0:  # what vanishes at the end of an arc has no margin
            self.margins[f"{what}, {i}"] = float(np.nextafter(float(bound), -np.inf))

    def _positive(self, what: str, i: int, value: Ball) -> None:
        self._holds(what, i, value.lower() if value > 0 else None)

    def _rests(self, i: int, mode: int, begin: Ball, end: Ball, switches: bool) -> None:
        after = self._after(i) if switches else 0
        for side in (1, -1):
            hold = self.hold[side]
            if not switches:
                self._positive("rest within its limits", i, hold - 1)
                continue
            self._positive("rest from its start", i, hold - side * begin.sin())

            def room(tau: Ball, side: int = side, hold: Ball = hold) -> Ball:
                return hold - side * tau.sin()

            def slope(tau: Ball, side: int = side) -> Ball:
                return -side * tau.cos()

            self._holds("rest within its limits", i, above_zero(self.arb, room, slope, begin, end, root=side == after))

    def _slides(self, i: int, mode: int, begin: Ball, end: Ball, switches: bool) -> None:
        after, d, r = self._after(i), end - begin, self.resist[mode]
        S, C = mode * begin.sin(), mode * begin.cos()
        gain = S - r  # of the speed at the start; 0 after break-away from a limit that is the force of sliding
        if not gain > 0 and self.sequence.modes[i - 1] == 0:
            gain = gain.nonnegative_part()

        def slope(d: Ball) -> Ball:
            return gain - S * (1 - d.cos()) + C * d.sin()

        def divided(d: Ball) -> Ball:  # by d^2, with the least of gain / d
            least = gain.lower() / d.upper() if gain > 0 else self.arb(0)
            return least + C * (d / 2).sinc() ** 2 / 2 - S * d * self._cubic(d)

        speed = self._velocity(mode, begin)
        self._holds("speed of the slide", i, above_zero(self.arb, speed, slope, self.arb(0), d, root=True, divided=divided))
        if after == 0:
            for side in (1, -1):
                self._positive("rest at the end of the slide", i, self.hold[side] - side * end.sin())
        else:
            self._positive("turning over at the end of the slide", i, after * end.sin() - self.hold[after])

    def _cubic(self, d: Ball) -> Ball:
        """(d - sin d) / d^3: between 1/6 - d^2/120 and 1/6 near 0."""
        if d.lower() > 0.01:
            return (d - d.sin()) / d**3
        square = (d * d).upper()
        return (self.arb(1) / 6 - square / 120).lower().union(self.arb(1) / 6)
