"""Links and stops that see time: prescribed distances and walls by a function of time, and how strongly any link pulls at an instant."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType, MethodType
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.fields import Frozen
from stickslip.basics.time_rates import with_rates

#: A tension [N] by time, distance and its rate.
Pull = Callable[[Any, Any, Any], Any]


@dataclass(frozen=True, eq=False)
class Placed(Frozen):
    """A motion by its position as a function of time; velocity and acceleration are its derivatives.

    Parameters
    ----------
    at : callable
        Position [m] at a time [s], of functions from `stickslip.maths`.

    Examples
    --------
    >>> from stickslip.maths import sin
    >>> wall = Placed(lambda t: 0.01 + 0.002 * sin(3.0 * t))
    >>> wall.position(0.0), wall.velocity(0.0), wall.acceleration(0.0)
    (0.01, 0.006, 0.0)
    """

    at: Callable[[Any], Any]

    def position(self, t: Numeric) -> Any:
        """Position [m]."""
        return self.at(t)

    def velocity(self, t: Numeric) -> Any:
        """Velocity [m/s]."""
        return with_rates(self.at, t)[1]

    def acceleration(self, t: Numeric) -> Any:
        """Acceleration [m/s^2]."""
        return with_rates(self.at, t)[2]


def motion_of(given: Any) -> Any:
    """A motion that is given as such, as every drive is, or by its position as a function of time.

    Examples
    --------
    >>> motion_of(lambda t: 0.1 * t).velocity(3.0)
    0.1
    """
    return Placed(given) if callable(given) else given


def lacks_motion(given: Any) -> str:
    """What an object lacks that is to be a motion, in words; "" where nothing is missing."""
    lacking = [
        name for name in ("position", "velocity", "acceleration") if isinstance(given, type) or not callable(getattr(given, name, None))
    ]
    return f"has no {' and no '.join(lacking)}" if lacking else ""


def takes_arguments(function: Any, names: tuple[str, ...]) -> bool:
    """Whether an object is a function that can be called with so many arguments."""
    plain, bound = (function.__func__, 1) if isinstance(function, MethodType) else (function, 0)
    if isinstance(plain, FunctionType) and not plain.__dict__:  # nothing says that it stands for another one
        code, count = plain.__code__, len(names) + bound
        least, named = code.co_argcount - len(plain.__defaults__ or ()), code.co_kwonlyargcount - len(plain.__kwdefaults__ or ())
        return least <= count and not named and (count <= code.co_argcount or bool(code.co_flags & inspect.CO_VARARGS))
    try:
        inspect.signature(function).bind(*names)
    except TypeError:
        return False
    except ValueError:  # one that does not say what it takes
        return callable(function)
    return True


def sees_time(link: Any) -> bool:
    """Whether the force of a link is a function of time, distance and rate, and not of distance and rate alone.

    Examples
    --------
    >>> import stickslip as ss
    >>> sees_time(ss.Spring(1.0)), sees_time(ss.machines.Link(force=lambda t, distance, rate: -t * distance))
    (False, True)
    """
    return not takes_arguments(link.force, ("distance", "rate"))


def pull_of(link: Any) -> Pull:
    """The tension of a link by time, distance and rate, whether it sees time or not."""
    force = link.force
    return force if sees_time(link) else lambda t, distance, rate: force(distance, rate)


def several(parts: Any) -> tuple[Any, ...]:
    """Links or stops between two bodies: one or more."""
    return parts if isinstance(parts, tuple) and not isinstance(parts, Frozen) else (parts,)
