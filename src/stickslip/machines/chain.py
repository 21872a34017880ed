"""Modules in a row, joined by links."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.drives.shifted import Shifted
from stickslip.errors import Problems
from stickslip.fields import everywhere, replace_leaf
from stickslip.machine import machine_of
from stickslip.machines.machine import Machine
from stickslip.machines.parts import LINKS, Body, Contact, Spring
from stickslip.maths import maximum, pi
from stickslip.mechanics import normal_load
from stickslip.robot import Robot

__all__ = ["Chain"]


@dataclass(frozen=True, eq=False)
class Chain(Machine):
    r"""Vibration-driven modules in a row, neighbours joined by a link.

    .. math:: P_i\ddot x_i = -m_i\ddot\xi_i(t + \varphi_i T/2\pi) + P_i\,g\sin\theta - R_i - \sum_j F_{ij}

    The first module is the head; each of the others is behind its neighbour by the length of the link.

    Parameters
    ----------
    modules : tuple of Robot
        The modules from head to tail, with one common period. One robot with arrays of numbers is a batch and no chain.
    link : Spring or any link
        What joins neighbours; a tuple of links, one for each pair, where they differ.
    phases : tuple of float, optional
        How far the drive of each module is ahead [rad], from -2 pi to 2 pi; none where it is left out.

    Examples
    --------
    >>> import stickslip as ss
    >>> module = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="coulomb")
    >>> pair = ss.Chain((module, module), link=ss.Spring(stiffness=1200.0, damping=0.4), phases=(0.0, 1.57))
    >>> pair.mechanics.bodies, pair.mechanics.masses[0] == module.total_mass
    (('module 1', 'module 2'), True)
    """

    modules: Any
    link: Any
    phases: tuple[float, ...] | None = None

    kind: ClassVar[str] = "chain"  # its name in a study file
    _table: ClassVar[str] = "mechanism"
    part_kinds: ClassVar[dict[str, dict[str, Any]]] = {"modules": {"robot": Robot}, "link": LINKS}

    def _check(self, problems: Problems) -> None:
        modules = self.modules
        if not isinstance(modules, tuple) or len(modules) < 2:
            listed = "a list is no tuple, and a tuple means several parts; " if isinstance(modules, list) else ""
            problems.add(
                f"modules = {modules!r}; {listed}allowed is a tuple of two robots or more (an array of numbers in one robot means cases); "
                "type modules=(head, tail)"
            )
            return
        problems.found += [
            f"modules[{i}] = {each!r}; allowed is a Robot"
            for i, each in enumerate(modules)
            if not hasattr(each, "drive") or isinstance(each, type)
        ]
        if self.phases is not None and len(self.phases) != len(modules):
            problems.add(f"phases has {len(self.phases)} numbers for {len(modules)} modules; type phases={(0.0,) * len(modules)}")
        if isinstance(self.link, tuple) and len(self.link) != len(modules) - 1:
            problems.add(
                f"link has {len(self.link)} links for {len(modules)} modules; allowed is one link, or one for each pair of neighbours"
            )
        if isinstance(self.link, (list, type)) or self.link is None:
            listed = "a list is no tuple, and a tuple means several links; " if isinstance(self.link, list) else ""
            problems.add(f"link = {self.link!r}; {listed}allowed is a link; type link=ss.Spring(stiffness=1200.0, damping=0.4)")
        for i, phase in enumerate(self.phases or ()):
            if not everywhere(abs(phase) <= 2 * pi):
                problems.add(f"phases[{i}] = {phase!r}; allowed is from -2 pi to 2 pi [rad]")
        if problems.found:
            return
        for i, each in enumerate(modules[1:], start=1):
            if not everywhere(abs(each.period - modules[0].period) <= 1e-12 * modules[0].period):
                problems.add(
                    f"modules[{i}] has the period {each.period!r} s and modules[0] {modules[0].period!r} s; allowed is one common period"
                )
        super()._check(problems)

    @property
    def period(self) -> float:
        """The common period of the drives [s]."""
        return self.modules[0].period

    @property
    def velocity_scale(self) -> float:
        """The largest of the modules' velocity scales [m/s]."""
        return _largest(module.velocity_scale for module in self.modules)

    @property
    def free_velocity(self) -> float:
        """The largest velocity that a drive would give its module without friction [m/s]."""
        return _largest(machine_of(module).free_velocity for module in self.modules)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the modules, from head to tail."""
        return tuple(f"module {i + 1}" for i in range(len(self.modules)))

    def module(self, i: int) -> Any:
        """One module, its drive ahead by its phase."""
        own = self.modules[i]
        return own if self.phases is None else replace_leaf(own, {"drive": Shifted(own.drive, self.phases[i] / (2 * pi))})

    def bodies(self) -> Mapping[str, Any]:
        """The modules."""
        links = [*self._links(), None]
        found, place = {}, 0.0
        for i, name in enumerate(self.names):
            found[name] = _body(self.module(i), place)
            place = place - getattr(links[i], "length", 0.0)
        return found

    def contacts(self) -> Mapping[str, Any]:
        """One contact for each module, of the same name."""
        return {name: _contact(name, self.module(i)) for i, name in enumerate(self.names)}

    def links(self) -> Mapping[tuple[str, str | None], Any]:
        """Neighbours are joined."""
        return dict(zip(itertools.pairwise(self.names), self._links(), strict=True))

    def _links(self) -> tuple[Any, ...]:
        return self.link if isinstance(self.link, tuple) else (self.link,) * (len(self.modules) - 1)

    @classmethod
    def example(cls) -> Chain:
        """Two modules that push in turn."""
        from stickslip.drives import Harmonic
        from stickslip.friction import Coulomb

        module = Robot(0.06259, 0.00948, Harmonic(amplitude=6e-4, omega=65.4 * pi), Coulomb(mu_plus=0.15, mu_minus=0.21))
        return cls((module, module), link=Spring(stiffness=1200.0, damping=0.4), phases=(0.0, 0.5 * pi))


def _body(module: Any, place: Any) -> Body:
    machine = machine_of(module)

    def force(t: Any, x: Any, v: Any) -> Any:
        return module.total_mass * module.acceleration(t, x, v, 0.0)

    return Body(module.total_mass, force=force, position=place, jumps=machine.impulses, breaks=machine.unsorted_breaks)


def _contact(name: str, module: Any) -> Contact:
    return Contact(name, module.friction, load=lambda t, x: normal_load(module, t, x))


def _largest(values: Any) -> Any:
    found = list(values)
    largest = found[0]
    for value in found[1:]:
        largest = maximum(largest, value)
    return largest
