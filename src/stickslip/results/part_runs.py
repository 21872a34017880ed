"""The columns of one body, one contact or one controller of a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.variables import VARIABLES
from stickslip.models.machine_adapter import machine_of


def _own(name: str, about: str) -> property:
    """The values of this part among those of all parts."""
    return property(lambda part: getattr(part.run, name)[:, part.number], doc=about)


def _column(name: str) -> property:
    variable = VARIABLES[name]
    return _own(name, f"{variable.long_name[0].upper()}{variable.long_name[1:]} [{variable.unit}].")


@dataclass(frozen=True, eq=False, repr=False)
class _PartRun:
    """One part of a run whose columns have axes for all parts."""

    run: Any
    number: int

    _kind: ClassVar[tuple[str, str]]  # of one part, of all

    @property
    def _states(self) -> Any:
        """Which states are its own."""
        return getattr(self.run.pieces.layout, self._kind[1])[self.number]

    @property
    def name(self) -> str:
        """The name of the part."""
        return str(self._states.name)

    def __repr__(self) -> str:
        return f"<{self._kind[0]} {self.name!r} of a run>"


class BodyRun(_PartRun):
    """One body of a run: its columns are arrays (time,), strobe points (strobe times,).

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=2)
    >>> run.bodies, bool((run.bodies["body"].v == run.v).all())
    ({'body': <body 'body' of a run>}, True)
    """

    _kind = ("body", "bodies")

    x = _column("x")
    v = _column("v")
    acceleration = _column("acceleration")
    strobe_x = _own("strobe_x", "Position at the strobe times [m].")
    strobe_v = _own("strobe_v", "Velocity at the strobe times [m/s].")


@dataclass(frozen=True, eq=False, repr=False)
class PlacedBodyRun:
    """A body of a run in the plane, by what `places` of its machine say: arrays (time,).

    Its place is x, z upwards [m] and an angle [rad]; v, v_z and turning are their rates. A part that places do not give is zero.
    """

    run: Any
    name: str

    def __repr__(self) -> str:
        return f"<body {self.name!r} of a run>"

    def _part(self, number: int, what: str) -> Any:
        import numpy as np

        run = self.run
        q, u = tuple(np.asarray(run.x).T), tuple(np.asarray(run.v).T)
        mechanics: Any = machine_of(run.model).mechanics
        components = mechanics.moved(0.0, q, u)[self.name]
        return 0.0 * q[0] + (getattr(components[number], what) if number < len(components) else 0.0)

    x = property(lambda self: self._part(0, "value"), doc="Place along x [m].")
    z = property(lambda self: self._part(1, "value"), doc="Height [m].")
    angle = property(lambda self: self._part(2, "value"), doc="Angle [rad].")
    v = property(lambda self: self._part(0, "rate"), doc="Velocity along x [m/s].")
    v_z = property(lambda self: self._part(1, "rate"), doc="Velocity upwards [m/s].")
    turning = property(lambda self: self._part(2, "rate"), doc="Rate of the angle [rad/s].")


class ContactRun(_PartRun):
    """One contact of a run: its columns are arrays (time,); `z` is (time, states), or (time,) if there is one, or None.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=2)
    >>> run.contacts, run.contacts["contact"].events == run.events, run.contacts["contact"].z
    ({'contact': <contact 'contact' of a run>}, True, None)
    """

    _kind = ("contact", "contacts")

    mode = _column("mode")
    friction_force = _column("friction_force")
    slip = _column("slip")
    load = _column("load")

    @property
    def z(self) -> Any:
        """Inner states of its law."""
        return self._inner(self.run.z)

    @property
    def strobe_z(self) -> Any:
        """Inner states at the strobe times."""
        return self._inner(self.run.strobe_z)

    def _inner(self, z: Any) -> Any:
        """Its own inner states, without those that only other laws have."""
        count = len(self._states.inner)
        if z is None or not count:
            return None
        own = z[:, self.number, :count]
        return own[:, 0] if count == 1 else own

    @property
    def events(self) -> list[Any]:
        """Its events, in order."""
        return [event for event in self.run.events if event.part == self.name]


class ControllerRun(_PartRun):
    """One controller of a run: what it holds, by the names of its states.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.servo(), duration=0.5)
    >>> run.controllers["control"].states
    ('integral',)
    >>> run.controllers["control"]["integral"].shape == run.t.shape
    True
    """

    _kind = ("controller", "controllers")

    @property
    def states(self) -> tuple[str, ...]:
        """The names of its states."""
        return tuple(self._states.states)

    def __getitem__(self, state: str) -> Any:
        """The column (time,) of one of its states; `InputError` for a name that is none of them."""
        if state not in self.states:
            hint = "; it has no states" if not self.states else f"; {did_you_mean(str(state), self.states)}"
            raise InputError("run.controllers", [f"{state!r} is not a state of {self!r}{hint}"])
        z = self.run._held[:, len(self.run.pieces.layout.contacts) + self.number]
        return z[:, self.states.index(state)]
