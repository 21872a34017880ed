"""The verdict on a robot's motion: periodic, quasi-periodic or chaotic."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.basics.notebook_display import Face
from stickslip.dynamics.exponents.general_exponents import STRETCHES, Lyapunov
from stickslip.dynamics.exponents.motion_exponents import check_exponents, exponents_along, state_after
from stickslip.dynamics.exponents.rotation import Rotation, rotation_of_strobe
from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
from stickslip.dynamics.stroboscopic.chunked_runs import Report
from stickslip.dynamics.stroboscopic.periodicity import repetition


@sealed
class Verdict(Face):
    """The kind of steady motion of a robot, with the evidence.

    Parameters
    ----------
    kind : str
        "periodic", "quasi-periodic", "chaotic" or "undecided".
    period : int or None
        Drive periods after which it repeats.
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
        period = {} if self.period is None else {"repeats after": f"{self.period} drive period{'s' * (self.period != 1)}"}
        rotation = {} if self.rotation is None else {"rotation number": f"{self.rotation.rounded} turns per drive period"}
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
    start: Any = None,
    rtol: float = 1e-8,
    progress: Report | None = None,
) -> Verdict:
    """Periodic, quasi-periodic or chaotic: decided by the exponents and the strobe point together.

    Periodic: the strobe point returns, Newton's method finds a stable orbit there, and the largest exponent is that of its multipliers.
    Chaotic: it does not return, and the largest exponent is positive by more than three of its errors. Quasi-periodic: it does not return,
    the largest exponent is zero within three errors that are small, and its strobe points wind round one closed curve, so that it has two
    frequencies; their rotation number is given where two numbers of the state show the curve unfolded. Anything else is undecided.

    Parameters
    ----------
    model, periods, settle, start, rtol, progress
        As for `lyapunov`. For a periodic motion the exponents are averaged over whole motion periods, so slightly more drive periods than
        requested may be used.

    Returns
    -------
    Verdict
        `kind`, `period`, `exponents`, `orbit`, `rotation`, and `why`, the evidence in a sentence.

    Examples
    --------
    >>> import stickslip as ss
    >>> ss.verdict(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"), periods=50, settle=50).kind
    'periodic'
    """
    check_exponents(model, periods, settle)
    state = state_after(model, start, settle, rtol)
    back = repetition(model, state[0], rtol)
    whole = STRETCHES * (back.period or 1)  # then every stretch whose mean counts for the error holds whole motion periods
    exponents, interrupted = exponents_along(model, -(-periods // whole) * whole, 0, state[0], rtol, progress)
    if interrupted:
        return Verdict("undecided", back.period, exponents, None, f"{exponents.note}; {back.why}")
    if back.period is not None:
        orbit = None
        with suppress(SolveError, InputError):
            orbit = periodic_orbit(model, back.period, guess=back.state)
        if orbit is not None and orbit.stable:
            why = f"the strobe point returns after {back.period} and the largest multiplier is {abs(orbit.multipliers[0]):.4g}; {back.why}"
            return Verdict("periodic", back.period, exponents, orbit, why)
    evidence = f"the largest exponent is {exponents.largest:.4g} ± {exponents.error:.2g} per drive period over {periods} periods"
    if back.period is None and exponents.chaotic:
        return Verdict("chaotic", None, exponents, None, f"the strobe point does not return and {evidence}")
    if back.period is None and exponents.error < 0.003 and abs(exponents.largest) < 3 * exponents.error + 1e-3:
        rotation, description, winds = rotation_of_strobe(model, back.state, rtol)
        why = f"the strobe point does not return and {evidence}: zero; {description}"
        return Verdict("quasi-periodic" if winds else "undecided", None, exponents, None, why, rotation)
    return Verdict("undecided", back.period, exponents, None, f"{evidence}; {back.why}; try more periods and a longer settle")
