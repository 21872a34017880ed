"""The verdict on a robot's motion: periodic, quasi-periodic, chaotic or not settled."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.basics.notebook_display import Face
from stickslip.dynamics.attractors.kinds_of_motion import CHAOTIC, PERIODIC, QUASI_PERIODIC, RUNS_AWAY, STEADY, UNSETTLED, UNSOLVED
from stickslip.dynamics.attractors.settled_motions import LIMIT, Settled, Settling, checked_limit, settled_motions
from stickslip.dynamics.attractors.starts_run_on import ERRORS
from stickslip.dynamics.exponents.general_exponents import STRETCHES, Lyapunov
from stickslip.dynamics.exponents.motion_exponents import check_exponents, exponents_along, state_after
from stickslip.dynamics.exponents.rotation import Rotation, rotation_of_strobe
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.periodic_orbits import orbit_near
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.chunked_runs import Report
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, spread_over

_ZERO = 1e-9  # an exponent that is not told from zero


@sealed
class Verdict(Face):
    """The kind of steady motion of a robot, with the evidence.

    Parameters
    ----------
    kind : str
        "periodic", "quasi-periodic", "chaotic", "steady" (a model without a period stands still) or "not settled".
    period : int or None
        Drive periods, or returns to the section of a model without a period, after which it repeats.
    exponents : Lyapunov
        Of the motion.
    orbit : PeriodicOrbit or None
        The orbit of a periodic motion, found by Newton's method.
    why : str
        The evidence in a sentence.
    rotation : Rotation or None
        Of a quasi-periodic motion of two frequencies: the rotation number of its strobe points, in turns per drive period.

    Examples
    --------
    >>> import stickslip as ss
    >>> told = ss.verdict(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"), periods=20, settle=20)
    >>> told.kind, told.period, told.orbit.type
    ('periodic', 1, 'III')
    """

    kind: str
    period: int | None
    exponents: Lyapunov
    orbit: Any
    why: str
    rotation: Rotation | None = None

    def plot(self, *args: Any, **options: Any) -> Any:
        """Draw the orbit or, if there is none, the convergence of the exponents. Returns the axes."""
        return (self.exponents if self.orbit is None else self.orbit).plot(*args, **options)

    def _figures(self) -> list[Any]:
        return (self.exponents if self.orbit is None else self.orbit)._figures()

    def _facts(self) -> dict[str, Any]:
        unit = self.exponents.unit if self.exponents.unit == "drive period" else "return"
        period = {} if self.period is None else {"repeats after": f"{self.period} {unit}{'s' * (self.period != 1)}"}
        rotation = {} if self.rotation is None else {"rotation number": f"{self.rotation.rounded} turns per {unit}"}
        return {"motion": self.kind, **period, **rotation, "exponents": self.exponents.rounded, "evidence": self.why}

    def __repr__(self) -> str:
        return f"<Verdict: {self.kind}{f' of period {self.period}' if self.period else ''}; {self.why}>"


@explains_arguments
@interruptible
def verdict(
    model: Model,
    periods: int = 1000,
    *,
    settle: int = 500,
    limit: int | None = None,
    start: Any = None,
    rtol: float = 1e-8,
    section: Any = None,
    turns: int = 1,
    progress: Report | None = None,
) -> Verdict:
    """Periodic, quasi-periodic or chaotic: by the rule of `basins` and `bifurcation`, and a second piece of evidence.

    A motion that does not repeat after `settle` drive periods is run on, up to `limit`, and then looked at over 600 more; see `basins`.
    Periodic: its strobe points repeat or close in on an orbit, and Newton's method finds the orbit, which is not unstable. Chaotic: the
    largest exponent is positive by more than three of its errors, by two neighbouring motions and by the tangent. Quasi-periodic: weighted
    means agree, and the strobe points wind round one closed curve, so that it has two frequencies; their rotation number is given where two
    numbers of the state show the curve unfolded. Anything else is not settled, and `why` has the reason.

    Parameters
    ----------
    model, periods, settle, start, rtol, section, turns, progress
        As for `lyapunov`. For a periodic motion the exponents are averaged over whole motion periods, so slightly more drive periods than
        requested may be used. They begin after `settle`, or where a motion that took longer was recognised or given up.
    limit : int, optional
        Drive periods up to which a motion is run on that has not settled, eight times `settle` if not given.

    Returns
    -------
    Verdict
        `kind`, `period`, `exponents`, `orbit`, `rotation`, and `why`, the evidence in a sentence.

    Raises
    ------
    SolveError
        Where the state grows without bound, or cannot be solved: there are no exponents.

    Examples
    --------
    >>> import stickslip as ss
    >>> ss.verdict(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"), periods=50, settle=50).kind
    'periodic'
    """
    check_exponents(model, periods, settle)
    problems = Problems("verdict")
    most, first = checked_limit(problems, settle, limit), max(settle, 1)
    problems.check()
    begun = states_of(start, model)
    at = on_section(model, section=section, turns=turns, states=begun, what="verdict")
    begun = at.section.starts(begun) if start is None and at.section is not None else begun
    motion = settled_motions(spread_over(model, 1), begun, at, Settling(first, most or LIMIT * first, rtol, exponents=periods))
    if motion.kind[0] in (RUNS_AWAY, UNSOLVED):
        why = "its state grows without bound" if motion.kind[0] == RUNS_AWAY else "it cannot be solved"
        raise SolveError(f"verdict: the motion has no exponents, as {why}; give another start=, or other numbers")
    last, repeats = motion.points[0, -1], int(motion.period[0])
    begin = state_after(model, begun[0], settle, rtol, at)[0] if motion.run[0] <= first else last
    whole = STRETCHES * (repeats or 1)  # then every stretch whose mean counts for the error holds whole motion periods
    exponents, interrupted = exponents_along(model, -(-periods // whole) * whole, 0, begin, rtol, progress, at)
    judged = _judged(model, motion, exponents, last, rtol, interrupted, at)
    return replace(judged, why=f"{exponents.note}; {judged.why}") if interrupted else judged


def _judged(model: Model, motion: Settled, exponents: Lyapunov, state: Array, rtol: float, interrupted: bool, at: Coordinates) -> Verdict:
    """What a motion is by the rule, if the second piece of evidence says the same."""
    kind, repeats, run = str(motion.kind[0]), int(motion.period[0]), int(motion.run[0])
    point, unit = ("strobe point", "drive period") if at.section is None else (f"point on the section ({at.section})", "return")
    over = f"{exponents.steps:g} periods" if at.section is None else f"a time of {exponents.steps:g}"
    evidence = f"the largest exponent is {exponents.largest:.4g} ± {exponents.error:.2g} per {exponents.unit} over {over}"
    if kind == PERIODIC:
        return _periodic(model, repeats, exponents, state, f"after {run} {unit}s the {point} returns after {repeats}", at)
    if kind == STEADY:
        return _still(exponents, evidence)
    if kind == CHAOTIC and (exponents.chaotic or interrupted):
        return Verdict(CHAOTIC, None, exponents, None, f"the {point} does not return and {evidence}")
    if kind == CHAOTIC:
        neighbours = f"two neighbouring motions part by {motion.exponent[0]:.3g} ± {motion.error[0]:.2g} per {unit}"
        return Verdict(UNSETTLED, None, exponents, None, f"{neighbours}, but along the tangent {evidence}; try more periods")
    if kind == QUASI_PERIODIC:
        rotation, description, winds = rotation_of_strobe(model, state, rtol, at)
        why = f"the {point} does not return and {evidence}: zero; {description}"
        return Verdict(QUASI_PERIODIC if winds else UNSETTLED, None, exponents, None, why, rotation)
    why = f"{motion.why[0]}; {evidence}; type limit={10 * run} to run it on for longer"
    return Verdict(UNSETTLED, None, exponents, None, why)


def _still(exponents: Lyapunov, evidence: str) -> Verdict:
    """A state that stands still is steady if no disturbance grows there."""
    if exponents.largest > ERRORS * exponents.error + _ZERO:
        why = f"it stands still, but {evidence}: what is beside it leaves it; try another start"
        return Verdict(UNSETTLED, None, exponents, None, why)
    return Verdict(STEADY, None, exponents, None, f"it stands still, and {evidence}")


def _periodic(model: Model, period: int, exponents: Lyapunov, state: Array, returns: str, at: Coordinates) -> Verdict:
    """A motion whose strobe points repeat is periodic if there is an orbit that does not repel it."""
    try:
        orbit: Any = orbit_near(model, period, state, at)
    except (SolveError, InputError) as error:
        return Verdict(UNSETTLED, None, exponents, None, f"{returns}, but there is no orbit: {error}; try a longer settle")
    largest = f"the largest multiplier is {abs(orbit.multipliers[0]):.4g}" if len(orbit.multipliers) else "it has no multipliers"
    if orbit.stability == "unstable":
        why = f"{returns}, but the orbit there is unstable ({largest}): what stays on it for now leaves it in the end; try another start"
        return Verdict(UNSETTLED, None, exponents, None, why)
    neutral = "" if orbit.stable else f", which is {orbit.stability}"
    why = f"{returns}, Newton's method finds its orbit, and {largest}{neutral}"
    return Verdict(PERIODIC, period, exponents, orbit, why)
