"""The mirror image of a machine, which moves in the opposite direction."""

from __future__ import annotations

import dataclasses
from typing import Any

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.contracts import Drive, Numeric
from stickslip.basics.errors import InputError
from stickslip.models.drives.turned import Reversed
from stickslip.models.friction.law_adapter import law_of, mirrored_law as mirrored_law
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.tracks.profiles import mirrored_track

# fractions of the period, velocities [m/s], positions [m]; not round numbers, where a patch may end
_MOMENTS = ((0.13, 0.02, 0.00403718), (0.57, 3e-4, -0.30117933), (0.81, -7e-3, 0.02023491))


@explains_arguments
def mirrored(robot: Model) -> Any:
    """The mirror image of a robot or machine: it performs the same motion in the opposite direction.

    Drives and applied forces are reversed, friction forwards and backwards is exchanged, and downhill becomes uphill. The
    last module of a chain becomes its head; in every other machine, and in a chain with a gait, the bodies keep their names.

    Parameters
    ----------
    robot : Robot, mechanism or machine
        Each law has a method `mirrored()`, or fields that end in ``_plus`` and ``_minus``, or is the same in both directions. A machine of
        one body that is not a Robot must have a method `mirrored()` itself, as the mechanisms have.

    Returns
    -------
    Robot, mechanism or machine
        A new one; its own mirror image is the original.

    Raises
    ------
    InputError
        If the image of the parts is not the image of the whole.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static", incline="gravity")
    >>> turned = ss.dynamics.mirrored(robot)
    >>> turned.track.tilt == -robot.track.tilt, turned.acceleration(0.01, 0.0, 0.0, 0.0) == -robot.acceleration(0.01, 0.0, 0.0, 0.0)
    (True, True)
    >>> ss.dynamics.mirrored(ss.Chain.example()).phases == ss.Chain.example().phases[::-1]
    True
    """
    image = _image(robot)
    wrong = _unmirrored(robot, image) if machine_of(robot).one_body is not None else ""
    if wrong:
        why = f"the mirror images of its parts do not make up its mirror image: {wrong} is another one"
        allowed = "allowed are machines that drive, friction and track define completely"
        raise InputError(type(robot).__name__, [f"{why}; {allowed}; write the mirror image by hand"])
    return image


def _image(model: Any) -> Any:
    """The mirror image that a machine declares; for a robot, the one composed of the mirror images of its parts."""
    own = adapter_of(model).mirror_image
    if own is not None:
        return own()
    if not all(hasattr(model, name) for name in ("drive", "friction", "track")):
        why = f"{type(model).__name__} has no drive on a track that could be turned round, and no method mirrored()"
        raise InputError("mirrored", [f"{why}; write one that returns its mirror image"])
    drive = tuple(map(_turned, model.drive)) if isinstance(model.drive, tuple) else _turned(model.drive)
    return dataclasses.replace(model, drive=drive, friction=mirrored_law(model.friction), track=mirrored_track(model.track))


def _turned(drive: Drive) -> Any:
    """A drive in the opposite direction."""
    own = getattr(drive, "mirrored", None)
    return own() if callable(own) else drive.drive if isinstance(drive, Reversed) else Reversed(drive)


def _unmirrored(model: Any, image: Any) -> str:
    """The part of a machine of one body that is not mirrored, tested at a few instants; "" if there is none."""
    law, other, T = law_of(model), law_of(image), machine_of(model).time_scale or 1.0
    for s, v, x in _MOMENTS:
        t, w, back = s * T, model.contact_velocity(v), image.contact_velocity(-v)
        N, there = normal_load(model, t, x), normal_load(image, t, -x)
        size = N / model.total_mass
        if not _opposite(N, -there):
            return "the load"
        if not _opposite(w, back, machine_of(model).velocity_scale):
            return "the velocity at the contact"
        if not _opposite(model.acceleration(t, x, v, 0.1 * N), image.acceleration(t, -x, -v, -0.1 * N), size):
            return "the acceleration"
        if not law.dynamic and not _opposite(law.sliding(w, N), other.sliding(-w, N), N):
            return "the sliding friction"
    return ""


def _opposite(a: Any, b: Numeric, size: Any = 0.0) -> bool:
    apart = abs(a + b) > 1e-9 * (abs(a) + size)
    return not (apart.any() if hasattr(apart, "any") else apart)
