"""Events of one's own along a branch: functions of a motion, whose zeros are special points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems

if TYPE_CHECKING:
    from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit


Event = Callable[[Any], float]
KINDS = ("fold", "flip", "neimark-sacker", "branch-point", "grazing", "type-border", "hopf")  # that have their own meaning
_TYPE = 'type events={"fast": lambda orbit: orbit.mean_velocity - 1e-3}'


def checked_events(what: str, events: Any) -> dict[str, Event]:
    """The events that were given, by name; `InputError` with everything that is wrong with them."""
    problems = Problems(what)
    if events is None:
        return {}
    if not isinstance(events, Mapping):
        raise InputError(what, [f"events = {events!r}; allowed is a dict of functions of an orbit, by name; {_TYPE}"])
    for name, event in events.items():
        if not isinstance(name, str) or not name or name in KINDS:
            problems.add(f"events: {name!r} is no name for an event; allowed is a text other than {', '.join(KINDS)}; {_TYPE}")
        if not callable(event):
            problems.add(f"events[{name!r}] = {event!r}; allowed is a function of an orbit that returns a number; {_TYPE}")
    problems.check()
    return dict(events)


def number_of(name: str, event: Event, orbit: PeriodicOrbit) -> float:
    """The value of an event for a motion; `InputError` if it is not a number.

    Examples
    --------
    >>> import stickslip as ss
    >>> orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"))
    >>> number_of("backwards", lambda orbit: orbit.mean_velocity, orbit) < 0
    False
    """
    try:
        number = event(orbit)
        return float(number)
    except (AttributeError, KeyError, IndexError, NameError, TypeError, ValueError, ArithmeticError) as error:
        raise InputError(
            "events",
            [f"events[{name!r}] raised {type(error).__name__}: {error}; allowed is a function of an orbit that returns a number; {_TYPE}"],
        ) from error
