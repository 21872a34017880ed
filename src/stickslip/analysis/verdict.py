"""The digits on which judges agree, and what to say about them."""

from __future__ import annotations

import math
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.models.machine_adapter import machine_of
from stickslip.results.steadiness import UNSETTLED

#: Name of the judge with fixed steps.
RK4 = "RK4"
_NO_TRANSIENT = 12  # digits from which what is left of a transient cannot be told from rounding


def certain_digits(answer: float, uncertainty: float) -> int:
    """Certain digits: half a unit of the last one is more than the uncertainty."""
    if not (answer and uncertainty > 0):
        return 0
    return max(0, min(15, math.floor(-math.log10(2 * uncertainty / abs(answer)))))


def _names(judges: list[Any]) -> str:
    """The judges that count, as a sentence names them."""
    short = {"exact arcs": "our exact arcs", "closed formula": "the closed formula"}
    names = [*dict.fromkeys(short.get(j.name, "scipy" if j.name.startswith("scipy") else "our ladder") for j in judges)]
    if names == ["our ladder"]:
        return "the rungs of our ladder"
    return " and ".join([*([", ".join(names[:-1])] if names[1:] else []), names[-1]])


def transient_words(steadiness: Any, uncertainty: float) -> str:
    """Of what transient the mean is, where it is not that of a steady motion to the digits on which the judges agree; empty where it is.

    Parameters
    ----------
    steadiness : Steadiness
        Of the run that is assessed.
    uncertainty : float
        Largest difference among the judges [m/s].
    """
    mean, error = steadiness.mean_velocity, steadiness.error
    if steadiness.code == UNSETTLED:
        far = f", about {error:.1e} m/s from its steady value" if math.isfinite(error) else ""
        return f"this is the mean velocity of a transient{far}"
    agreed = min(certain_digits(mean, uncertainty), _NO_TRANSIENT)
    if steadiness.steady and certain_digits(mean, error) < agreed and error > 0:
        return f"a transient of about {error:.1e} m/s is left in this mean velocity"
    return ""


def finding(answer: float, uncertainty: float, digits: int, period: int | None, counted: list[Any], robot: Model, of: str = "") -> str:
    """The finding of the judges that count for this answer; `of` says of what transient it is the mean."""
    finding = _finding(answer, uncertainty, digits, period, counted, robot)
    return f"{of[0].upper()}{of[1:]}. {finding}" if of else finding


def _finding(answer: float, uncertainty: float, digits: int, period: int | None, counted: list[Any], robot: Model) -> str:
    late = " No motion period was found, so the mean still depends on the length of the run." if period is None else ""
    if math.isnan(uncertainty):
        return f"The mean velocity is {answer:.6e} m/s, but no other method could confirm it: no digit is certain.{late}"
    if abs(answer) <= max(uncertainty, _small(robot)):
        within = f"zero to within {max(uncertainty, abs(answer)):.1e} m/s" if answer or uncertainty else "exactly zero"
        return f"There is no net motion: the mean velocity is {within}.{late}"
    who = _names(counted)
    if digits == 0:
        return f"No digit of the mean velocity {answer:.3e} m/s is certain: {who} differ by {uncertainty:.1e} m/s.{late}"
    count, shown = f"{digits} digit{'s' if digits > 1 else ''}", f"{answer:.{digits - 1}e} m/s"
    if period is None:
        only = f"{count} of the mean velocity {shown} hold for a run of this length only"
        return f"No motion period was found, so the mean depends on the length of the run: {only} ({who} agree to {uncertainty:.1e} m/s)."
    return f"{count} of the mean velocity {shown} {'are' if digits > 1 else 'is'} certain: {who} agree to {uncertainty:.1e} m/s."


def _small(robot: Model) -> float:
    return 1e-9 * float(machine_of(robot).velocity_scale)


def naive(answer: float, judges: list[Any], robot: Model) -> str:
    """The wrong answer that a script with fixed steps would have given, if it is wrong."""
    wrong = [j for j in judges if j.name == RK4 and abs(j.difference) > 0.01 * abs(answer) > _small(robot)]
    if not wrong:
        return ""
    coarse = max(wrong, key=lambda j: abs(j.difference))
    return f" Runge-Kutta with {coarse.setting.replace(' per', ' steps per', 1)} would have given {coarse.mean_velocity:.3e} m/s."
