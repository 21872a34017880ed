"""Robots with a vibrating inner mass: the founding paper's rig, and the robot without dimensions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any

from stickslip.basics.arguments import checked_arguments, explains_arguments
from stickslip.basics.batch import labels_together
from stickslip.basics.errors import InputError, Problems, did_you_mean, is_one_of
from stickslip.basics.fields import describe, described_by, everywhere
from stickslip.basics.quantities import AMPLITUDE, BODY_MASS, FREQUENCY, GRAVITY, INNER_MASS, OMEGA, TILT_DEG, VOLTAGE, quantity
from stickslip.models.drives import Harmonic, PiezoBeam
from stickslip.models.friction import Coulomb, LuGre
from stickslip.models.friction.coefficients import F0, MU0, SIGMA0, SIGMA1, SIGMA2, V_S
from stickslip.models.robot import Robot
from stickslip.models.tracks import Incline, Level
from stickslip.models.tracks.tracks import fold

#: The laws of a rig, and the arguments that each has no use for.
LAWS_HERE = {"lugre": (), "coulomb": ("f0", "sigma0", "sigma1", "sigma2", "v_s"), "coulomb-static": ("sigma0", "sigma1", "sigma2", "v_s")}


_ANOTHER_LAW = 'for another law type piezo_rig(..., incline="gravity").replace(friction=ss.Stribeck(...))'


@explains_arguments
def piezo_rig(
    tilt_deg: Annotated[Any, TILT_DEG],
    amplitude: Annotated[Any, AMPLITUDE],
    omega: Annotated[Any, OMEGA | {"allowed": ""}] = 65.4 * math.pi,
    mu0: Annotated[Any, MU0] = 0.18,
    f0: Annotated[Any, F0] = 0.21,
    law: str = "lugre",
    incline: str = "folded",
    gravity: Annotated[Any, GRAVITY] = 9.81,
    sigma0: Annotated[Any, SIGMA0] = 4e5,
    sigma1: Annotated[Any, SIGMA1] = 100.0,
    sigma2: Annotated[Any, SIGMA2] = 0.04,
    v_s: Annotated[Any, V_S] = 2e-3,
    body_mass: Annotated[Any, BODY_MASS] = 62.59e-3,
    inner_mass: Annotated[Any, INNER_MASS] = 9.48e-3,
) -> Robot:
    """The paper's piezo-driven robot on its inclined track (sections 3 and 4).

    Parameters
    ----------
    tilt_deg : float or array
        Tilt of the track, downhill is forwards [degrees].
    amplitude : float or array
        Amplitude of the inner mass [m]. The paper prints none for its experiments; `ss.presets.PAPER_AMPLITUDES` has the inferred ones.
    omega : float or array
        Angular frequency of the drive [rad/s].
    mu0, f0 : float or array
        Isotropic kinetic and static friction coefficients of body and track [-].
    law : {"lugre", "coulomb", "coulomb-static"}
        "coulomb" is Eq. 2.4 to the letter: break-away at mu0, f0 unused; "coulomb-static" breaks away at f0, as the printed results of
        the paper do.
    incline : {"folded", "gravity"}
        "folded" includes the incline in the coefficients, as the paper does (Eq. 4.1); "gravity" lets gravity act. Choose "gravity" if you
        want to replace the law: in place of the folded law it would be on a level track, as ``notes`` then says.
    gravity : float or array
        Acceleration of gravity [m/s^2].
    sigma0, sigma1, sigma2, v_s : float or array
        LuGre numbers (Eq. 5.3) [N/m, N s/m, N s/m, m/s].
    body_mass, inner_mass : float or array
        Masses [kg].

    Returns
    -------
    Robot

    Examples
    --------
    >>> robot = piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)
    >>> round(robot.friction.mu_plus, 6)
    0.150255
    """
    numbers, problems = _numbers(locals())
    for name, value, allowed in (("law", law, tuple(LAWS_HERE)), ("incline", incline, ("folded", "gravity"))):
        if not is_one_of(value, allowed):
            near = did_you_mean(str(value), allowed)
            hint = near if near.startswith("did") else _ANOTHER_LAW if name == "law" else ""
            problems.add(f"{name} = {value!r}; allowed is one of {', '.join(allowed)}" + (f"; {hint}" if hint else ""))
    if not problems.mistakes:
        _check_shapes(numbers, law, problems)
    if not problems.mistakes:
        _check_tilt(numbers, law, incline, problems)
    problems.check()
    n = numbers
    tilt = n["tilt_deg"] * (math.pi / 180)
    return Robot(
        body_mass=n["body_mass"],
        inner_mass=n["inner_mass"],
        drive=Harmonic(amplitude=n["amplitude"], omega=n["omega"]),
        friction=_friction(law, tilt if incline == "folded" else 0.0 * tilt, n),
        gravity=n["gravity"],
        track=Level(folded=tilt) if incline == "folded" else Incline(tilt=tilt),
    )


def _friction(law: str, tilt: Any, n: dict[str, Any]) -> Any:
    mu = fold(n["mu0"], tilt)
    if law == "coulomb":
        return Coulomb(mu_plus=mu[0], mu_minus=mu[1])
    f = fold(n["f0"], tilt)
    if law == "coulomb-static":
        return Coulomb(mu_plus=mu[0], mu_minus=mu[1], f_plus=f[0], f_minus=f[1])
    return LuGre(*mu, *f, sigma0=n["sigma0"], sigma1=n["sigma1"], sigma2=n["sigma2"], v_s=n["v_s"])


def _numbers(arguments: dict[str, Any]) -> tuple[dict[str, Any], Problems]:
    """The arguments that are numbers, checked one by one; what is wrong with all of them."""
    problems = Problems("piezo_rig")
    return checked_arguments(piezo_rig, arguments, problems), problems


def _check_shapes(numbers: dict[str, Any], law: str, problems: Problems) -> None:
    """Note arrays that do not fit together, of those that the law uses."""
    try:
        labels_together({name: value for name, value in numbers.items() if name not in LAWS_HERE[law]}, "piezo_rig")
    except InputError as error:
        problems.include(error)


def _check_tilt(n: dict[str, Any], law: str, incline: str, problems: Problems) -> None:
    """Folding needs mu_plus > 0: the track must be flatter than the friction angle."""
    import numpy as np

    if law != "coulomb" and not everywhere(n["f0"] >= n["mu0"]):
        problems.add(f"f0 = {describe(n['f0'])} is below mu0 = {describe(n['mu0'])}; allowed is f0 >= mu0; type for example f0=0.21")
    tilt, angle = n["tilt_deg"], np.degrees(np.arctan(n["mu0"]))
    if incline == "folded" and not everywhere(abs(tilt) < angle):
        problems.add(
            f"tilt_deg = {describe(n['tilt_deg'])} is at or beyond the friction angle atan(mu0) = {np.min(np.asarray(angle)):.4g} degrees, "
            "where the folded mu_plus is not positive; allowed is a smaller tilt; "
            'type incline="gravity" for a robot that slides down by itself'
        )
    elif incline == "gravity" and not everywhere(abs(tilt) < 90):
        problems.add(f"tilt_deg = {describe(n['tilt_deg'])}; allowed is between -90 and 90 degrees; type for example tilt_deg=1.7")


@explains_arguments
def piezo_beam_rig(
    voltage: Annotated[Any, VOLTAGE],
    frequency: Annotated[Any, FREQUENCY | {"label": "drive frequency"}],
    tilt_deg: Annotated[Any, TILT_DEG],
    beam: PiezoBeam | None = None,
    length: Annotated[Any, described_by(PiezoBeam, "length")] = None,
    thickness: Annotated[Any, described_by(PiezoBeam, "thickness")] = None,
    patch_length: Annotated[Any, described_by(PiezoBeam, "patch_length")] = None,
    tip_mass: Annotated[Any, described_by(PiezoBeam, "tip_mass")] = None,
    damping: Annotated[Any, quantity("damping ratio of the beam", "1", r"\zeta", example=0.02)] = None,
    mu0: Annotated[Any, MU0] = 0.18,
    f0: Annotated[Any, F0] = 0.21,
    law: str = "lugre",
    incline: str = "folded",
    gravity: Annotated[Any, GRAVITY] = 9.81,
    sigma0: Annotated[Any, SIGMA0] = 4e5,
    sigma1: Annotated[Any, SIGMA1] = 100.0,
    sigma2: Annotated[Any, SIGMA2] = 0.04,
    v_s: Annotated[Any, V_S] = 2e-3,
    body_mass: Annotated[Any, BODY_MASS] = 62.59e-3,
) -> Robot:
    """The paper's robot from volts and hertz: the inner mass is the tip of a `PiezoBeam` (section 3.1).

    The paper does not specify its beam. The default beam is our choice, with the inner mass of the paper. Remarks, such as a voltage
    beyond that of the paper's hardware, are in the robot's `notes`.

    Parameters
    ----------
    voltage : float or array
        Amplitude of the voltage on the patches [V].
    frequency : float or array
        Frequency of the voltage [Hz].
    tilt_deg : float or array
        Tilt of the track, downhill is forwards [degrees].
    beam : PiezoBeam, optional
        The beam; its tip mass is the robot's inner mass.
    length, thickness, patch_length, tip_mass, damping : float or array, optional
        Numbers of the beam that are to be other than in `beam` [m, m, m, kg, -].
    mu0, f0, law, incline, gravity, sigma0, sigma1, sigma2, v_s, body_mass
        As for `piezo_rig`.

    Returns
    -------
    Robot
        With a `Harmonic` drive: amplitude and frequency of the beam's tip.

    Examples
    --------
    >>> robot = piezo_beam_rig(voltage=20.0, frequency=32.7, tilt_deg=1.7)
    >>> print(f"{robot.drive.amplitude * 1e3:.3f} mm at {robot.drive.frequency:.1f} Hz")
    0.671 mm at 32.7 Hz
    """
    problems = Problems("piezo_beam_rig")
    changes = {"length": length, "thickness": thickness, "patch_length": patch_length, "tip_mass": tip_mass, "damping": damping}
    changes = {name: value for name, value in changes.items() if value is not None}
    rest = {"mu0": mu0, "f0": f0, "law": law, "incline": incline, "gravity": gravity, "body_mass": body_mass}
    rest |= {"sigma0": sigma0, "sigma1": sigma1, "sigma2": sigma2, "v_s": v_s}
    mine = _noted(problems, lambda: _beam(beam).replace(changes)) or PiezoBeam()
    drive = _noted(problems, lambda: mine.drive(voltage, frequency))
    robot = _noted(problems, lambda: piezo_rig(tilt_deg=tilt_deg, amplitude=0.0, inner_mass=mine.tip_mass, **rest))
    problems.check()
    return robot.replace(drive=drive)


def _beam(beam: Any) -> PiezoBeam:
    if beam is not None and not isinstance(beam, PiezoBeam):
        raise InputError(
            "piezo_beam_rig", [f"beam = {beam!r}; allowed is a PiezoBeam; type for example beam=ss.drives.PiezoBeam(length=0.1)"]
        )
    return PiezoBeam() if beam is None else beam


def _noted(problems: Problems, make: Callable[[], Any]) -> Any:
    """The robot of a maker; None, with its problems noted, if it cannot be made."""
    try:
        return make()
    except InputError as error:
        problems.include(error)
    return None


@explains_arguments
def coulomb_robot(
    alpha_plus: Annotated[Any, quantity("sliding friction forwards over drive force", "1", r"\alpha_{+}", example=0.5)],
    alpha_minus: Annotated[Any, quantity("sliding friction backwards over drive force", "1", r"\alpha_{-}", example=1.2)],
) -> Robot:
    r"""The dimensionless Coulomb robot: :math:`w' = \sin\tau - r` with r = alpha_plus forwards and -alpha_minus backwards.

    All its units are 1 (A mu omega = omega = g = 1, mass 1), so velocities are w = v/(A mu omega) and times are omega t.

    Parameters
    ----------
    alpha_plus, alpha_minus : float or array
        Sliding friction over drive force, forwards and backwards: :math:`\mu_\pm g/(A\mu\omega^2)` [-].

    Returns
    -------
    Robot

    Examples
    --------
    >>> import stickslip as ss
    >>> round(float(ss.sweep(coulomb_robot, alpha_plus=0.5, alpha_minus=1.2).mean_velocity), 15)
    0.201452203333669
    """
    return Robot(0.5, 0.5, Harmonic(amplitude=2.0, omega=1.0), Coulomb(mu_plus=alpha_plus, mu_minus=alpha_minus), gravity=1.0)
