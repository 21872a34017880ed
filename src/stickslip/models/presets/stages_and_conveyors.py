"""Masses on tracks that move: piezo stages and vibratory conveyors."""

from __future__ import annotations

import math
from typing import Annotated, Any

from stickslip.basics.arguments import checked_numbers, explains_arguments
from stickslip.basics.errors import InputError, is_one_of
from stickslip.basics.maths import cos, sin
from stickslip.basics.quantities import FREQUENCY, GRAVITY, LOAD, MASS, STROKE, TILT_DEG, Rule, positive, quantity
from stickslip.models.drives import Harmonic, Sawtooth
from stickslip.models.friction import Coulomb, LuGre
from stickslip.models.friction.coefficients import MU, SIGMA0, SIGMA1, V_S
from stickslip.models.machines import MovingTrack

#: Angles [degrees].
_BELOW_90 = Rule(lambda angle: (angle > 0) & (angle < 90), "above 0 and below 90 degrees")
_WITHIN_90 = Rule(lambda angle: abs(angle) < 90, "between -90 and 90 degrees")


@explains_arguments
def stick_slip_stage(
    stroke: Annotated[Any, STROKE | {"label": "stroke of the tip", "example": 5e-6}] = 5e-6,
    rise: Annotated[Any, quantity("duration of the rise", "s", "t_{r}", example=0.95e-3)] = 0.95e-3,
    fall: Annotated[Any, quantity("duration of the fall", "s", "t_{f}", example=0.05e-3)] = 0.05e-3,
    mass: Annotated[Any, MASS] = 0.02,
    load: Annotated[Any, LOAD | {"example": 20.0}] = 20.0,
    mu: Annotated[Any, MU] = 0.1,
    force: Annotated[Any, quantity("external force", "N", "F_{0}", example=0.5)] = 0.0,
    law: str = "coulomb",
    sigma0: Annotated[Any, SIGMA0] = 1e7,
    sigma1: Annotated[Any, SIGMA1] = 100.0,
    v_s: Annotated[Any, V_S] = 2e-3,
) -> MovingTrack:
    r"""A piezo stick-slip stage: a sawtooth motion carries a slider forwards slowly; it slips during the fast return.

    The numbers are our choice, typical of a stage with a thousand steps of 5 micrometres per second. Under Coulomb friction, where the
    slider still moves with :math:`t_f a_-/a_+ \le t_s`, a cycle is

    .. math:: \frac{L}{t_s}(t_s+t_f) - \frac{a_- t_f^2}{2}\Bigl(1+\frac{a_-}{a_+}\Bigr), \qquad a_\mp = \frac{\mu N \pm q}{m}

    with q the external force against the step.

    Parameters
    ----------
    stroke : float or array
        Stroke L of the tip [m].
    rise, fall : float or array
        Durations of the tip's motion forwards, t_s, and back, t_f [s].
    mass : float or array
        Mass m of the slider [kg].
    load : float or array
        Preload N between slider and tip [N].
    mu : float or array
        Friction coefficient, the same both ways and at rest [-].
    force : float or array
        External force, positive forwards: -q [N].
    law : {"coulomb", "lugre"}
        "lugre" has the presliding of a real contact, over a distance of mu load / sigma0.
    sigma0, sigma1, v_s : float or array
        Stiffness [N/m] and damping [N s/m] of its bristles, and its Stribeck velocity [m/s]; of "lugre" alone.

    Returns
    -------
    MovingTrack

    Examples
    --------
    >>> import stickslip as ss
    >>> print(f"{ss.analysis.step_per_cycle(ss.solve(ss.presets.stick_slip_stage(), periods=10)) * 1e6:.6f} micrometres")
    5.013158 micrometres
    """
    along = Sawtooth(stroke=stroke, rise=rise, fall=fall)
    friction = _law_of_track("stick_slip_stage", law, mu, sigma0, sigma1, v_s)
    return MovingTrack(mass=mass, along=along, friction=friction, load=load, force=force)


@explains_arguments
def conveyor(
    throw_index: Annotated[Any, quantity("throw index", "1", r"\Gamma", example=2.5, rule=positive)] = 0.9,
    angle_deg: Annotated[Any, quantity("angle of the swing", "degrees", r"\beta", example=30.0, rule=_BELOW_90)] = 30.0,
    frequency: Annotated[Any, FREQUENCY | {"label": "frequency of the swing", "example": 50.0}] = 50.0,
    mu: Annotated[Any, MU] = 0.4,
    tilt_deg: Annotated[Any, TILT_DEG | {"rule": _WITHIN_90, "allowed": "", "example": 0.0}] = 0.0,
    restitution: Annotated[Any, quantity("restitution", "1", "e", example=0.3)] = 0.0,
    mass: Annotated[Any, MASS] = 0.01,
    gravity: Annotated[Any, GRAVITY] = 9.81,
    law: str = "coulomb",
    sigma0: Annotated[Any, SIGMA0] = 1e5,
    sigma1: Annotated[Any, SIGMA1] = 10.0,
    v_s: Annotated[Any, V_S] = 2e-3,
) -> MovingTrack:
    r"""A vibratory conveyor: a trough vibrates along an inclined line and conveys a part.

    The numbers are our choice, typical of a feeder at mains frequency. The throw index measures the vertical acceleration,

    .. math:: \Gamma = \frac{A\omega^2\sin\beta}{g\cos\theta},

    and sets the amplitude A. Above 1 the part flies in each cycle.

    Parameters
    ----------
    throw_index : float or array
        Throw index [-].
    angle_deg : float or array
        Angle between the vibration and the track, 0 < angle < 90 [degrees].
    frequency : float or array
        Frequency of the vibration [Hz].
    mu : float or array
        Friction coefficient, the same both ways and at rest [-].
    tilt_deg : float or array
        Tilt of the track, downhill is forwards [degrees].
    restitution : float or array
        Coefficient of restitution of a landing, 0 <= restitution < 1 [-].
    mass : float or array
        Mass of the part [kg].
    gravity : float or array
        Acceleration of gravity [m/s^2].
    law : {"coulomb", "lugre"}
        Under "lugre" a run ends where the part leaves the track.
    sigma0, sigma1, v_s : float or array
        Stiffness [N/m] and damping [N s/m] of its bristles, and its Stribeck velocity [m/s]; of "lugre" alone.

    Returns
    -------
    MovingTrack

    Examples
    --------
    >>> import stickslip as ss
    >>> slides, hops = (ss.solve(ss.presets.conveyor(throw_index=index), periods=40) for index in (0.9, 2.5))
    >>> print(f"{ss.mean_velocity(slides) * 1e3:.6f} mm/s without hops, {ss.mean_velocity(hops) * 1e3:.6f} mm/s with them")
    22.453808 mm/s without hops, 130.469302 mm/s with them
    """
    degrees = math.pi / 180
    n = checked_numbers(conveyor, throw_index=throw_index, angle_deg=angle_deg, frequency=frequency, tilt_deg=tilt_deg, gravity=gravity)
    index, angle, f, tilt, g = n.values()
    angle, tilt, omega = degrees * angle, degrees * tilt, 2 * math.pi * f
    amplitude = index * g * cos(tilt) / (omega**2 * sin(angle))
    along, across = (Harmonic(amplitude=amplitude * of, omega=omega) for of in (cos(angle), sin(angle)))
    friction = _law_of_track("conveyor", law, mu, sigma0, sigma1, v_s)
    return MovingTrack(mass=mass, along=along, across=across, tilt=tilt, friction=friction, restitution=restitution, gravity=g)


def _law_of_track(what: str, law: str, mu: Any, sigma0: Any, sigma1: Any, v_s: Any) -> Any:
    """Isotropic friction with one coefficient, without inner states or with bristles."""
    if not is_one_of(law, ("coulomb", "lugre")):
        raise InputError(what, [f'law = {law!r}; allowed are "coulomb" and "lugre"; for another one type .replace(friction=...)'])
    if law == "coulomb":
        return Coulomb(mu_plus=mu, mu_minus=mu)
    return LuGre(mu_plus=mu, mu_minus=mu, f_plus=None, f_minus=None, sigma0=sigma0, sigma1=sigma1, sigma2=0.0, v_s=v_s)
