"""The base of machines that a user writes: bodies, contacts, links and stops by their names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from stickslip.basics.batch import check_shape
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, OneContactNeeded, Problems
from stickslip.models.equations_of_motion import mechanics_of
from stickslip.models.machines.checks import check_parts
from stickslip.models.machines.coordinate_checks import check_coordinates
from stickslip.models.machines.filed import Filed

#: What a machine of one body on one contact says of itself.
_OF_ONE = ("friction", "load", "acceleration", "contact_velocity", "total_mass", "velocity_scale", "drive", "track")


class Machine(Filed):
    r"""Base of the machines: a subclass is a frozen dataclass of numbers that lists its parts in four methods.

    .. math:: M\ddot q = F(t, q, \dot q) - \sum_i g_i R_i(w_i, N_i, z_i), \qquad w_i = g_i\cdot\dot q + b_i(t)

    `bodies()` and `contacts()` must be there; `links()`, `stops()`, `forces(t, x, v)` and `period` may be. Every part has a name, which is
    the key of its dictionary; results are selected by these names.

    A field annotated ``float`` is a number of the machine: it may be an array, it can be swept, and it is saved in files.
    Write `stickslip.maths` functions (``sin``, ``where``, …) in forces and loads: they are traced and compiled.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> from typing import Any
    >>> import stickslip as ss
    >>> from stickslip.maths import pi, sin
    >>> @dataclass(frozen=True, eq=False)
    ... class Pair(ss.Machine):
    ...     mass: float
    ...     push: float
    ...     omega: float
    ...     stiffness: float
    ...     friction: Any
    ...
    ...     @property
    ...     def period(self):
    ...         return 2 * pi / self.omega
    ...
    ...     def bodies(self):
    ...         pushed = ss.Body(self.mass, force=lambda t, x, v: self.push * sin(self.omega * t))
    ...         return {"head": pushed, "tail": ss.Body(self.mass)}
    ...
    ...     def contacts(self):
    ...         return {name: ss.Contact(name, self.friction) for name in ("head", "tail")}
    ...
    ...     def links(self):
    ...         return {("head", "tail"): ss.Spring(self.stiffness)}
    >>> pair = Pair(mass=0.1, push=0.5, omega=60.0, stiffness=400.0, friction=ss.Coulomb(mu_plus=0.1, mu_minus=0.2))
    >>> pair.mechanics.bodies, pair.mechanics.loads(0.0, (0.0, 0.0))[0]
    (('head', 'tail'), 0.9810000000000001)
    """

    #: The body whose motion is the machine's: ``run.x``, ``run.v`` and columns of datasets are its own, and those of its first contact,
    #: without axes for bodies and contacts; others are in ``run.bodies[name]``. None: columns have an axis for all bodies.
    principal: ClassVar[str | None] = None

    #: Names of coordinates of the machine's own, such as ``("x", "angle")``; None: each body moves along a line and is a coordinate.
    #: Then it has one of these methods: ``places(t, q)``, where bodies are (a number, (x, z) or (x, z, angle), z upwards);
    #: ``inertia(q)``, the matrix of inertia as a tuple of rows; or ``kinetic(q, u)``, the kinetic energy [J].
    coordinates: ClassVar[tuple[str, ...] | None] = None

    #: Which of these are angles [rad], for the units of columns and axes; None: those that a whole turn leaves where they are.
    angles: ClassVar[tuple[str, ...] | None] = None

    #: After this time the drives repeat [s]; None where nothing does: a run is then so many seconds long.
    period: Any = None

    def __getattr__(self, name: str) -> Any:
        if name in _OF_ONE:
            raise OneContactNeeded.of(self, name)
        raise AttributeError(f"{type(self).__name__} has no {name!r}")

    def bodies(self) -> Mapping[str, Any]:
        """The bodies by name: a dictionary of `stickslip.Body`."""
        raise InputError(type(self).__name__, ['it has no bodies; write def bodies(self): return {"head": ss.Body(mass=...)}'])

    def contacts(self) -> Mapping[str, Any]:
        """The contacts by name: a dictionary of `stickslip.Contact`."""
        return {}

    def links(self) -> Mapping[tuple[str, str | None], Any]:
        """Links between two bodies, or a body and the ground (None): ``{("head", "tail"): ss.Spring(...)}``."""
        return {}

    def stops(self) -> Mapping[tuple[str, str | None], Any]:
        """Stops between two bodies, or a body and the ground: ``{("head", None): ss.Stop(...)}``."""
        return {}

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> Mapping[str, Any]:
        """Further applied forces [N] by body, from the positions [m] and velocities [m/s] of all bodies by name."""
        return {}

    def controllers(self) -> Mapping[str, Any]:
        """Controllers by name: parts with states of their own that act on bodies, such as those of a `stickslip.Joint`."""
        return {}

    def _check(self, problems: Problems) -> None:
        check_shape(self, problems)
        if not problems.mistakes:
            (check_parts if self.coordinates is None else check_coordinates)(self, problems)

    def mirrored(self) -> Any:
        """The machine with forwards and backwards exchanged; bodies and contacts keep their names."""
        from stickslip.models.machine_adapter import fresh_mechanics
        from stickslip.models.machines.mirrored import Turned, TurnedCoordinates

        fresh_mechanics(self)  # which refuses equations that its parts do not say
        return Turned(self) if self.coordinates is None else TurnedCoordinates(self)

    mechanics = mechanics_of
