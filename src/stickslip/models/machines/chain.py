"""Modules in a row, joined by links."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere, replace_leaf
from stickslip.basics.maths import maximum, pi
from stickslip.basics.quantities import quantity
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.drives.shifted import begun_at
from stickslip.models.forces import offered_force
from stickslip.models.machine_adapter import machine_of
from stickslip.models.machines.bodies import Bodies
from stickslip.models.machines.checks import periods_differ
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.parts import LINKS, Body, Contact, Gait, Spring
from stickslip.models.normal_loads import normal_load
from stickslip.models.robot import Robot


@dataclass(frozen=True, eq=False)
class Chain(Machine):
    r"""Bodies in a row, neighbours joined by a link: vibration-driven modules, or plain masses whose distances a gait prescribes.

    .. math:: P_i\ddot x_i = -m_i\ddot\xi_i(t + \varphi_i T/2\pi) + P_i\,g\sin\theta - R_i - \sum_j F_{ij}

    The first module is the head; each of the others is behind its neighbour by the length of the link.

    Parameters
    ----------
    modules : tuple of Robot, or Bodies
        The modules from head to tail, with one common period. One robot with arrays of numbers is a batch, not a chain.
    link : Spring, Rigid, Gait or any link
        The link between neighbours, or a tuple with one for each pair.
    phases : tuple of float, optional
        Phase lead of the drive of each module [rad], from -2 pi to 2 pi; zero if left out.

    Examples
    --------
    >>> import stickslip as ss
    >>> module = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="coulomb")
    >>> pair = ss.Chain((module, module), link=ss.Spring(stiffness=1200.0, damping=0.4), phases=(0.0, 1.57))
    >>> pair.mechanics.bodies, pair.mechanics.masses[0] == module.total_mass
    (('module 1', 'module 2'), True)

    A worm of three masses, one of which always sticks: it advances by three amplitudes per period.

    >>> wave = ss.machines.Gait(ss.Harmonic(amplitude=2e-3, frequency=2.0), lag=2 * pi / 3)
    >>> worm = ss.Chain(ss.machines.Bodies(mass=0.05, count=3, friction=ss.Coulomb(mu_plus=0.1, mu_minus=0.3)), link=wave)
    >>> round(ss.mean_velocity(ss.solve(worm, periods=20)), 12)
    0.012
    """

    modules: Any
    link: Any
    phases: tuple[float, ...] | None = field(default=None, metadata=quantity("phase of the drive", "rad", r"\varphi", example=(0.0, 1.57)))

    kind: ClassVar[str] = "chain"  # its name in a study file
    part_kinds: ClassVar[dict[str, dict[str, Any]]] = {"modules": {"robot": Robot, "bodies": Bodies}, "link": LINKS}

    def _check(self, problems: Problems) -> None:
        _check_modules(self.modules, problems)
        if problems.mistakes:
            return
        count = len(self.names)
        if self.phases is not None and not self._robots:
            problems.add("phases are those of modules with a drive, and plain bodies have none; a Gait has a lag; leave phases out")
        elif self.phases is not None and len(self.phases) != count:
            problems.add(f"phases has {len(self.phases)} numbers for {count} modules; type phases={(0.0,) * count}")
        if isinstance(self.link, tuple) and len(self.link) != count - 1:
            problems.add(
                f"link has {len(self.link)} links for {count} bodies; allowed is one link, or one for each pair of neighbours; type "
                "link=ss.Spring(stiffness=1200.0, damping=0.4)"
            )
        if isinstance(self.link, (list, type)) or self.link is None:
            listed = "this is a list, and several links are given as a tuple; " if isinstance(self.link, list) else ""
            problems.add(f"link = {self.link!r}; {listed}allowed is a link; type link=ss.Spring(stiffness=1200.0, damping=0.4)")
        for i, phase in enumerate(self.phases or ()):
            if not everywhere(abs(phase) <= 2 * pi):
                problems.add(f"phases[{i}] = {describe(phase)}; allowed is from -2 pi to 2 pi [rad]; type math.radians(90) for 90 degrees")
        if problems.mistakes:
            return
        _check_periods(self._driven, problems)
        super()._check(problems)

    @property
    def _robots(self) -> tuple[Any, ...]:
        """The modules that are robots; none of plain bodies."""
        return self.modules if isinstance(self.modules, tuple) else ()

    @property
    def _driven(self) -> dict[str, Any]:
        """The parts with a drive, by their names in messages."""
        robots = {f"modules[{i}]": machine_of(each).drive for i, each in enumerate(self._robots)}
        links = self.link if isinstance(self.link, tuple) else (self.link,)
        named = ["link"] if not isinstance(self.link, tuple) else [f"link[{i}]" for i in range(len(links))]
        return robots | {name: link.drive for name, link in zip(named, links, strict=True) if isinstance(link, Gait)}

    @property
    def period(self) -> Any:
        """The common period of the drives [s]; None without a drive."""
        return next((drive.period for drive in self._driven.values()), None)

    @property
    def velocity_scale(self) -> Any:
        """The largest velocity scale of the drives [m/s]; for a chain without drives that of its parts."""
        return reduce(maximum, [drive_of(drive).velocity_scale for drive in self._driven.values()]) if self._driven else None

    @property
    def free_velocity(self) -> Any:
        """The largest velocity that a drive would give a body without friction [m/s]."""
        gaits = [drive_of(drive).velocity_scale for name, drive in self._driven.items() if name.startswith("link")]
        velocities = [machine_of(module).free_velocity for module in self._robots] + gaits
        return reduce(maximum, velocities) if velocities else None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies, from head to tail."""
        return tuple(f"module {i + 1}" for i in range(len(self._robots))) or self.modules.names

    def module(self, i: int) -> Any:
        """One module, with the phase lead of its drive."""
        own = self.modules[i]
        return own if self.phases is None else replace_leaf(own, {"drive": begun_at(own.drive, self.phases[i] / (2 * pi), own.cycles)})

    def bodies(self) -> Mapping[str, Any]:
        """The modules, or the plain bodies."""
        bodies: dict[str, Any] = {}
        position: Any = 0.0
        for i, (name, link) in enumerate(zip(self.names, [*self._links(), None], strict=True)):
            bodies[name] = _body(self.module(i), position) if self._robots else Body(self.modules.masses[i], position=position)
            position = position - getattr(link, "length", 0.0)
        return bodies

    def contacts(self) -> Mapping[str, Any]:
        """One contact for each body, of the same name."""
        if self._robots:
            return {name: _contact(name, self.module(i)) for i, name in enumerate(self.names)}
        return {name: Contact(name, self.modules.friction) for name in self.names}

    def links(self) -> Mapping[tuple[str, str | None], Any]:
        """Neighbours are joined."""
        links = [link.of_pair(j) if isinstance(link, Gait) else link for j, link in enumerate(self._links())]
        return dict(zip(itertools.pairwise(self.names), links, strict=True))

    def _links(self) -> tuple[Any, ...]:
        return self.link if isinstance(self.link, tuple) else (self.link,) * (len(self.names) - 1)

    def mirrored(self) -> Any:
        """The chain with forwards and backwards exchanged: its last body is the head. Where a gait counts its bodies the names stay."""
        from stickslip.models.mirroring import mirrored

        if any(isinstance(link, Gait) for link in self._links()):
            return super().mirrored()
        turned = tuple(mirrored(module) for module in self._robots[::-1]) or self.modules.mirrored()
        link = self.link[::-1] if isinstance(self.link, tuple) else self.link
        phases = None if self.phases is None else self.phases[::-1]
        return replace(self, modules=turned, link=link, phases=phases)

    @classmethod
    def example(cls) -> Chain:
        """Two modules that push in turn."""
        from stickslip.models.drives import Harmonic
        from stickslip.models.friction import Coulomb

        module = Robot(0.06259, 0.00948, Harmonic(amplitude=6e-4, omega=65.4 * pi), Coulomb(mu_plus=0.15, mu_minus=0.21))
        return cls((module, module), link=Spring(stiffness=1200.0, damping=0.4), phases=(0.0, 0.5 * pi))


def _check_modules(modules: Any, problems: Problems) -> None:
    """Note what is neither a row of robots nor plain bodies."""
    if isinstance(modules, Bodies):
        return
    if not isinstance(modules, tuple) or len(modules) < 2:
        listed = "this is a list, and several parts are given as a tuple; " if isinstance(modules, list) else ""
        given = "[...]" if listed else repr(modules)
        problems.add(
            f"modules = {given}; {listed}allowed is a tuple of two robots or more (an array of numbers in one robot means cases), or "
            "ss.machines.Bodies; type modules=(head, tail)"
        )
        return
    problems.mistakes += [
        f"modules[{i}] = {each!r}; allowed is a Robot whose drive prescribes the motion of its inner mass"
        for i, each in enumerate(modules)
        if not hasattr(each, "drive") or isinstance(each, type) or machine_of(each).drive is None
    ]


def _check_periods(driven: dict[str, Any], problems: Problems) -> None:
    """Note drives whose periods differ."""
    for i, (name, drive) in enumerate(driven.items()):
        first, other = next(iter(driven.items()))
        if i and not everywhere(abs(drive.period - other.period) <= 1e-12 * other.period):
            problems.add(periods_differ(name, drive.period, first, other.period))


def _body(module: Any, position: Any) -> Body:
    machine = machine_of(module)
    drive: Any = machine.drive

    def force(t: Numeric, x: Numeric, v: Numeric) -> Any:
        return module.total_mass * module.acceleration(t, x, v, 0.0)

    def gravity(t: Numeric, x: Numeric, v: Numeric) -> Any:
        return offered_force(module, t, x) + machine.whole_inner_mass * drive.acceleration(t)

    breaks = machine.unsorted_breaks
    return Body(module.total_mass, force=force, position=position, jumps=machine.impulses, breaks=breaks, gravity=gravity)


def _contact(name: str, module: Any) -> Contact:
    return Contact(name, module.friction, load=lambda t, x: normal_load(module, t, x))
