"""The mirror image of a machine, which moves in the opposite direction."""

from __future__ import annotations

import dataclasses
from typing import Any

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.contracts import Drive, Numeric
from stickslip.basics.errors import InputError
from stickslip.models.drives.turned import Reversed
from stickslip.models.friction.law_adapter import mirrored_law as mirrored_law
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of
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
    own: Any = adapter_of(robot).mirror_image
    return image_of_fields(robot) if own is None else own()


def image_of_fields(model: Any, numbers: tuple[str, ...] = ()) -> Any:
    """The record whose parts are the mirror images of the parts of another one.

    Parameters
    ----------
    model : dataclass
        Its drives are reversed, its law and its track turned round, and a machine within it is its mirror image.
    numbers : tuple of str
        Numbers that change their sign, and tuples of them.

    Raises
    ------
    InputError
        If that is not the image of the whole, or if it has none of these parts.
    """
    parts = {f.name for f in dataclasses.fields(model)} if dataclasses.is_dataclass(model) else set()
    if not numbers and not parts & set(_IMAGES):
        why = f"{type(model).__name__} has no drive on a track that could be turned round, and no method mirrored()"
        raise InputError("mirrored", [f"{why}; write one that returns its mirror image"])
    changes = {name: _negative(getattr(model, name)) for name in numbers}
    changes |= {name: image(getattr(model, name)) for name, image in _IMAGES.items() if name in parts}
    return _made_of_images(model, dataclasses.replace(model, **changes))


def _made_of_images(model: Any, image: Any) -> Any:
    """What the mirror images of a machine's parts make up; `InputError` if that is not the image of the whole."""
    wrong = _unmirrored(model, image)
    if wrong:
        why = f"the mirror images of its parts do not make up its mirror image: {wrong} is another one"
        allowed = "allowed are machines that drive, friction and track define completely"
        raise InputError(type(model).__name__, [f"{why}; {allowed}; write the mirror image by hand"])
    return image


def _negative(number: Any) -> Any:
    return tuple(map(_negative, number)) if isinstance(number, tuple) else 0.0 - number


def _reversed(drive: Drive | tuple[Drive, ...]) -> Any:
    """A drive in the opposite direction, or each of several."""
    if isinstance(drive, tuple):
        return tuple(map(_reversed, drive))
    own = getattr(drive, "mirrored", None)
    return own() if callable(own) else drive.drive if isinstance(drive, Reversed) else Reversed(drive)


#: What becomes in the mirror of a part, by the name of its field.
_IMAGES: dict[str, Any] = {"drive": _reversed, "along": _reversed, "friction": mirrored_law, "track": mirrored_track, "machine": mirrored}


def _unmirrored(model: Any, image: Any) -> str:
    """What of a machine is not mirrored, tested at a few instants; "" if there is nothing."""
    machine, m, o = machine_of(model), machine_of(model).mechanics, machine_of(image).mechanics
    for s, speed, position in _MOMENTS:
        t, u, q = s * (machine.time_scale or 1.0), (speed,) * m.coordinates, (position,) * m.coordinates
        back, there = (-speed,) * m.coordinates, (-position,) * m.coordinates
        loads, others = m.loads(t, q, u), o.loads(t, there, back)
        if not all(_opposite(N, -other) for N, other in zip(loads, others, strict=True)):
            return "the load"
        slips, away = m.slips(t, u, q), o.slips(t, back, there)
        if not all(_opposite(w, other, machine.velocity_scale) for w, other in zip(slips, away, strict=True)):
            return "the velocity at the contact"
        R = [0.1 * N for N in loads]
        a, turned = m.accelerations(t, q, u, R), o.accelerations(t, there, back, [-force for force in R])
        sizes = [sum(loads) / mass for mass in m.masses]
        if not all(_opposite(*each) for each in zip(a, turned, sizes, strict=True)):
            return "the acceleration"
        for law, other, w, N in zip(m.laws, o.laws, slips, loads, strict=True):
            if not law.dynamic and not _opposite(law.sliding(w, N), other.sliding(-w, N), N):
                return "the sliding friction"
    return ""


def _opposite(a: Any, b: Numeric, size: Any = 0.0) -> bool:
    apart = abs(a + b) > 1e-9 * (abs(a) + abs(size))  # the load of what takes off is negative
    return not (apart.any() if hasattr(apart, "any") else apart)
