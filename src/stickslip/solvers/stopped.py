"""Why and where a run ended before its time, in words: the instant, the contact and its slip velocity."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.status import STATUS, Status

#: Steps, or events, before the end of a run whose changes of mode are counted.
LAST = 1000
_OFTEN = 0.25  # of the last steps: so many change a mode where a run chatters
#: Cases of a batch that ended before their time of which the first have a message.
FAILURES = 20
_SMOOTHER = (
    "If a force jumps with the sign of a state, as a relay or a saturated controller of high gain does, write tanh(s / width) of "
    "stickslip.maths for that sign; if a law's memory switches without end, its guards must not fall right after a switch; or shorten "
    "duration= or periods= to before this instant"
)
LOST = "Nothing presses the body on its track there: give a smaller vertical vibration, more gravity or another phase of the drive"
PRESSES_BACK = (
    "What rigid bodies do there is not told by Coulomb's friction: give a smaller friction coefficient or another start, or a load= that "
    "does not follow from the motion"
)
STIFF = (
    "So many steps are taken where something is much faster than the rest, as a current, a stiff bristle or a controller is: type "
    'method="radau", whose steps do not follow it, or method="auto"'
)
_RATTLES = (
    "Such a machine rattles: what one of its contacts does undoes what another one did, as where friction at one foot lifts the other. A "
    "position in which forces could rest is not one to which hits lead then: give another friction coefficient, another restitution=, or "
    "shorten duration= or periods= to before this instant"
)
_STOPS = 'If hits on a stop follow one another without end until it is pressed for a while, type method="dop853" (SciPy: slower)'


def rattling(status: int, sides: Array | None) -> int:
    """The status of a run that has used up its steps, which says that it chatters where its last steps were changes of modes.

    Parameters
    ----------
    status : int
    sides : array (steps, contacts), or None
        Modes of the contacts in the last steps, where they are known.

    Examples
    --------
    >>> rattling(Status.BUDGET, np.arange(1000)[:, None] % 2) == Status.CHATTERS
    True
    >>> rattling(Status.BUDGET, np.zeros((1000, 1))) == Status.BUDGET
    True
    """
    if status != Status.BUDGET or sides is None or len(sides) < LAST:
        return status
    changed = np.count_nonzero(np.any(np.diff(sides[-LAST:], axis=0), axis=1))
    return int(Status.CHATTERS) if changed >= LAST * _OFTEN else status


def location(mechanics: Any, t: float, u: Any, sides: Array | None, q: Any = ()) -> str:
    """The instant, and the contact that changed its mode most often: how often, and its slip velocity.

    Parameters
    ----------
    mechanics : Mechanics
    t : float
        Time at the end [s].
    u : array (coordinates,)
        Velocities there [m/s].
    sides : array (steps, contacts), or None
        Modes of the contacts in the last steps, where they are known: else the contact that slips least is named.
    q : array (coordinates,), optional
        Coordinates there; they matter where slips depend on the place.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.models.machine_adapter import machine_of
    >>> rig = machine_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)).mechanics
    >>> location(rig, 0.25, [0.5], np.array([[1], [0], [1]]))
    'at t = 0.25 s, where contact has changed its mode 2 times in 3 steps and its slip velocity is 0.5 m/s'
    """
    if not mechanics.contacts:
        return f"at t = {t:.9g} s"
    slips = np.array([float(w) for w in mechanics.slips(t, list(u), list(q))])
    if sides is None:
        sides = np.empty((0, len(slips)))
    changes = np.count_nonzero(np.diff(sides[-LAST:], axis=0), axis=0) if len(sides) > 1 else np.zeros(len(slips), int)
    i = int(np.argmax(changes)) if changes.any() else int(np.argmin(abs(slips)))
    name, steps = mechanics.contacts[i], min(len(sides), LAST)
    contact = name if name == "contact" else f"contact {name!r}"
    if not len(sides):
        return f"at t = {t:.9g} s, where the slip velocity of {contact} is {slips[i]:.9g} m/s"
    history = f"has changed its mode {changes[i]} times in {steps} steps and its" if changes.any() else "keeps its mode and its"
    return f"at t = {t:.9g} s, where {contact} {history} slip velocity is {slips[i]:.9g} m/s"


def stopping_message(status: int, where: str, state: str, remedy: str) -> str:
    """The message of a run that could not be finished."""
    return f"the run stopped {where}: {STATUS[status]}; the state was {state}. {remedy}"


def remedy(status: int, rtol: float, stops: bool, several: bool = False) -> str:
    """A suggestion after a failed run of a machine, which may have stops, or several contacts that are decided together."""
    if status == Status.LOST:
        return LOST
    if status == Status.PAINLEVE:
        return PRESSES_BACK
    if stops:
        return _STOPS
    if status == Status.CHATTERS:
        return _RATTLES if several else _SMOOTHER
    judge = 'method="radau" (SciPy on the law in plain Python: slower)'
    return f"Try another rtol (now {rtol:g}) or start, check the law's numbers, or type {judge}"
