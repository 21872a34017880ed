"""Protocols of the parts of a model. A user-defined class needs these methods and no base class.

Velocities are in m/s, forces in N, times in s. Every number may be an array of cases, or a symbol while equations are traced.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, runtime_checkable

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    #: A NumPy array; docstrings give its shape.
    Array: TypeAlias = NDArray[Any]
else:
    Array = ArrayLike = Any  # NumPy takes a tenth of a second to import, and command lines that compute nothing do without


class Numeric(Protocol):
    """Anything with arithmetic: a float, an array of cases, a labelled array, a symbol while equations are traced."""

    def __add__(self, other: Any, /) -> Any: ...
    def __radd__(self, other: Any, /) -> Any: ...
    def __sub__(self, other: Any, /) -> Any: ...
    def __rsub__(self, other: Any, /) -> Any: ...
    def __mul__(self, other: Any, /) -> Any: ...
    def __rmul__(self, other: Any, /) -> Any: ...
    def __truediv__(self, other: Any, /) -> Any: ...
    def __rtruediv__(self, other: Any, /) -> Any: ...
    def __pow__(self, power: Any, /) -> Any: ...
    def __neg__(self) -> Any: ...
    def __abs__(self) -> Any: ...
    def __lt__(self, other: Any, /) -> Any: ...
    def __le__(self, other: Any, /) -> Any: ...
    def __gt__(self, other: Any, /) -> Any: ...
    def __ge__(self, other: Any, /) -> Any: ...
    def __float__(self) -> float: ...


@runtime_checkable
class SetValuedLaw(Protocol):
    """A law that may hold a body at rest; `stickslip.models.friction.law_adapter` reads it, with its optional attributes."""

    def sliding(self, v: Any, load: Any) -> Any:
        """Friction force [N] at a slip velocity v [m/s] that is not zero."""

    def breakaway(self, load: Any) -> tuple[Any, Any]:
        """Static friction limits (backward, forward) [N]: the first is negative."""


@runtime_checkable
class DynamicLaw(Protocol):
    """A law with `states` inner states (1 if not given): z and the value of `rate` are a number if there is one, else a tuple."""

    def rate(self, v: Any, z: Any, load: Any) -> Any:
        """Rates of the inner states [their unit / s]."""

    def force(self, v: Any, z: Any, zdot: Any, load: Any) -> Any:
        """Friction force [N]."""


class BalancingLaw(Protocol):
    """A dynamic law that needs `applied`, the friction force that would keep v constant [N]."""

    def rate(self, v: Any, z: Any, load: Any) -> Any:
        """Rates of the inner states [their unit / s]."""

    def force(self, v: Any, z: Any, zdot: Any, load: Any, applied: Any) -> Any:
        """Friction force [N]."""


class SwitchingLaw(Protocol):
    """A dynamic law with whole-number memories: `mode` is a tuple of them, and `modes` is their number."""

    def rate(self, v: Any, z: Any, load: Any, mode: Any) -> Any:
        """Rates of the inner states [their unit / s]."""

    def force(self, v: Any, z: Any, zdot: Any, load: Any, mode: Any) -> Any:
        """Friction force [N]."""

    def switches(self, v: Any, z: Any, load: Any, mode: Any) -> list[tuple[Any, Any, Any]]:
        """Guards that end a mode: (guard, positive until then; mode after it; z after it, or None if unchanged)."""


Law: TypeAlias = SetValuedLaw | DynamicLaw | BalancingLaw | SwitchingLaw


class Drive(Protocol):
    """A prescribed relative motion of the inner mass."""

    @property
    def period(self) -> Any:
        """Period of the motion [s]."""

    def position(self, t: Any) -> Any:
        """Relative position [m]."""

    def velocity(self, t: Any) -> Any:
        """Relative velocity [m/s]."""

    def acceleration(self, t: Any) -> Any:
        """Relative acceleration [m/s^2]."""


class Track(Protocol):
    """The protocol of a track: the components of gravity across and along it."""

    def across(self, gravity: Any) -> Any:
        """Component of gravity normal to the track [m/s^2]."""

    def along(self, gravity: Any) -> Any:
        """Component of gravity along the track, forwards [m/s^2]."""


class OneContact(Protocol):
    """The protocol of a robot or a mechanism: one body with one contact."""

    @property
    def friction(self) -> Any:
        """The law of its contact."""

    @property
    def load(self) -> Any:
        """Normal force on the contact [N]: a number, or a function of time [s] and place [m]."""

    @property
    def period(self) -> Any:
        """Period of its drive or forcing [s]; None if it is not periodic."""

    @property
    def total_mass(self) -> Any:
        """Total mass that moves with the contact [kg]."""

    @property
    def velocity_scale(self) -> Any:
        """A typical velocity, against which errors are measured [m/s]."""

    def acceleration(self, t: Any, x: Any, v: Any, R: Any) -> Any:
        """Acceleration of the body [m/s^2] under a friction force R [N]."""

    def contact_velocity(self, v: Any) -> Any:
        """Velocity at the contact [m/s] of a body with velocity v."""


class Model(Protocol):
    """A robot, a mechanism, a machine that lists its parts, or a flow: all have a period, or None."""

    @property
    def period(self) -> Any:
        """Period of its drive or forcing [s]; None if it is not periodic."""


@runtime_checkable
class DeclaresContact(Protocol):
    """What tells a model of one body on one contact from other objects; all that it needs is in `OneContact`."""

    @property
    def friction(self) -> Any:
        """The law of its contact."""

    def acceleration(self, t: Any, x: Any, v: Any, R: Any) -> Any:
        """Acceleration of the body [m/s^2] under a friction force R [N]."""


@runtime_checkable
class DeclaresParts(Protocol):
    """What tells a model that lists its parts from other objects."""

    def bodies(self) -> Any:
        """Bodies by name."""

    def contacts(self) -> Any:
        """Contacts by name."""

    def links(self) -> Any:
        """Links by the names of the bodies that they join."""


@runtime_checkable
class DataFrame(Protocol):
    """A data frame of any library: columns by name."""

    @property
    def columns(self) -> Any:
        """Names of the columns."""

    def __getitem__(self, name: Any, /) -> Any: ...


@runtime_checkable
class Executor(Protocol):
    """What has the `submit` of `concurrent.futures.Executor`; its futures have done(), result(), exception() and cancel()."""

    def submit(self, function: Callable[..., Any], /, *args: Any) -> Any:
        """Begin a call, and return a future."""


_MOST = 1024  # processes


def process_count(text: Any) -> int | None:
    """How many processes ``"processes:8"`` asks for; None for anything else.

    Examples
    --------
    >>> process_count("processes:8"), process_count("processes:0"), process_count(8)
    (8, None, None)
    """
    kind, _, count = text.partition(":") if isinstance(text, str) else ("", "", "")
    return int(count) if kind == "processes" and count.isdecimal() and 1 <= int(count) <= _MOST else None


#: What may be an executor, in words.
EXECUTORS = 'an executor with submit(), a function that makes one, or "processes:N"; type for example executor="processes:8"'


def is_executor(value: Any) -> bool:
    """Whether it is an executor, a function that makes one, ``"processes:8"``, or None."""
    return value is None or callable(value) or isinstance(value, Executor) or process_count(value) is not None
