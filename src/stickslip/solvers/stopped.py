"""Why and where a run ended before its time, in words: the instant, the contact and its slip velocity."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Changes:
    """How often contacts changed their modes in the last steps of a run, of which there were so many.

    Examples
    --------
    >>> Changes.of(np.array([[1, 0], [0, 0], [1, 0]]))
    Changes(steps=3, some=2, each=(2, 0))
    """

    steps: int
    some: int  # steps with which some contact did
    each: tuple[int, ...]

    @classmethod
    def of(cls, sides: Array) -> Changes:
        """Those of the last of some steps, from the modes in each (steps, contacts)."""
        changed = np.diff(sides[-LAST:], axis=0) != 0
        return cls(min(len(sides), LAST), int(np.count_nonzero(changed.any(axis=1))), tuple(np.count_nonzero(changed, axis=0).tolist()))

    @classmethod
    def counted(cls, counts: Array) -> Changes:
        """Those that a kernel has counted: with how many of its last steps some mode changed, and that of each contact."""
        return cls(LAST, int(counts[0]), tuple(counts[1:].tolist()))


def rattling(status: int, changes: Changes | None) -> int:
    """The status of a run that has used up its steps, which says that it chatters where its last steps were changes of modes.

    Examples
    --------
    >>> rattling(Status.BUDGET, Changes(1000, 999, (999,))) == Status.CHATTERS
    True
    >>> rattling(Status.BUDGET, Changes(1000, 0, (0,))) == Status.BUDGET
    True
    """
    if status != Status.BUDGET or changes is None or changes.steps < LAST:
        return status
    return int(Status.CHATTERS) if changes.some >= LAST * _OFTEN else status


def location(mechanics: Any, t: float, u: Any, changes: Changes | None, q: Any = ()) -> str:
    """The instant, and the contact that changed its mode most often: how often, and its slip velocity.

    Parameters
    ----------
    mechanics : Mechanics
    t : float
        Time at the end [s].
    u : array (coordinates,)
        Velocities there [m/s].
    changes : Changes, or None
        Of the modes of the contacts in the last steps, where they are known: else the contact that slips least is named.
    q : array (coordinates,), optional
        Coordinates there; they matter where slips depend on the place.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.models.machine_adapter import machine_of
    >>> rig = machine_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)).mechanics
    >>> location(rig, 0.25, [0.5], Changes(3, 2, (2,)))
    'at t = 0.25 s, where contact has changed its mode 2 times in 3 steps and its slip velocity is 0.5 m/s'
    """
    if not mechanics.contacts:
        return f"at t = {t:.9g} s"
    slips = np.array([float(w) for w in mechanics.slips(t, list(u), list(q))])
    i = int(np.argmax(changes.each)) if changes is not None and changes.some else int(np.argmin(abs(slips)))
    name = mechanics.contacts[i]
    contact = name if name == "contact" else f"contact {name!r}"
    if changes is None or not changes.steps:
        return f"at t = {t:.9g} s, where the slip velocity of {contact} is {slips[i]:.9g} m/s"
    history = f"has changed its mode {changes.each[i]} times in {changes.steps} steps" if changes.some else "keeps its mode"
    return f"at t = {t:.9g} s, where {contact} {history} and its slip velocity is {slips[i]:.9g} m/s"


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
