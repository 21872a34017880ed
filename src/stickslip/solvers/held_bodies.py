"""What every machine of bodies says of where it stands, whatever holds its states from one step to the next."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.batch import labels_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves
from stickslip.basics.status import STATUS
from stickslip.models.machine_adapter import MachineAdapter, is_machine
from stickslip.models.pushed import force_names
from stickslip.models.state_layout import StateLayout
from stickslip.solvers import stopped
from stickslip.solvers.request import request
from stickslip.solvers.settings import Request, Settings
from stickslip.solvers.time_dependence import check_period

FORCE = "force "  # before the name of a force among the numbers


class BodiesCase(ABC):
    """A machine of bodies and contacts, by the names of its numbers and its parts.

    Attributes
    ----------
    model : Robot or machine
        With the numbers that it has now.
    rtol : float
        The tolerance to which its steps are held.
    """

    model: Any
    rtol: float
    _machine: MachineAdapter
    _forces: dict[str, str]

    @property
    def machine(self) -> Any:
        """What was given, with these numbers."""
        return self.model

    @property
    @abstractmethod
    def layout(self) -> StateLayout:
        """What its states are."""

    @abstractmethod
    def _parts(self, side: Any, t: float) -> tuple[Array, Array, Any]:
        """Positions, velocities and other states."""

    @cached_property
    def names(self) -> dict[str, str]:
        """Numbers of the machine, and forces on bodies."""
        return {**{name: name for name, _ in leaves(self.machine)}, **self._forces}

    def numbers(self) -> dict[str, float]:
        """The inputs as they are now, but for the forces, of which zero is said."""
        numbers = dict(leaves(self.machine))
        return {name: float(numbers.get(number, 0.0)) for name, number in self.names.items()}

    def is_quick(self, number: str) -> bool:
        """Forces may change without a look at the rest of the machine."""
        return number.startswith(FORCE)

    def knows(self, memory: Any) -> bool:
        """What laws remember is any whole number."""
        return True

    @property
    def unit(self) -> float | None:
        """Its time scale [s]."""
        scale = self._machine.time_scale
        return None if scale is None else float(scale)

    def state(self, side: Any, t: float) -> dict[str, Any]:
        """t, x, v, mode and z as `Trajectory.at` has them."""
        q, u, z = self._parts(side, t)
        layout, mode = self.layout, side.sides.astype(np.int8)
        if layout.single:
            inner = None if not len(z) else _one_or_all(z.copy())
            return {"t": t, "x": float(q[0]), "v": float(u[0]), "mode": int(mode[0]), "z": inner}
        m = self._machine.mechanics
        x, v = (np.array([float(each) for each in of]) for of in (m.positions(t, tuple(q)), m.velocities(t, tuple(u))))
        states = side.states
        held = {part.name: states[list(part.inner)] for part in layout.with_inner if len(part.inner)}
        if layout.own:
            own = layout.own
            contact = layout.contacts[own["contact"]] if "contact" in own else None
            z = None if contact is None or not contact.inner else states[list(contact.inner)]
            first: dict[str, Any] = {"x": float(x[own["body"]]), "v": float(v[own["body"]])}
            first["mode"] = None if contact is None else int(mode[own["contact"]])
            return {"t": t, **first, "z": None if z is None else _one_or_all(z)}
        return {"t": t, "x": x, "v": v, "mode": mode, "z": held or None}

    def start(self, side: Any, t: float) -> dict[str, Any]:
        """The same as `solve` takes a start."""
        q, u, _ = self._parts(side, t)
        layout, states = self.layout, side.states
        inner = {part.name: states[list(part.inner)].copy() for part in layout.contacts if part.inner}
        memory = {part.name: side.memory[list(part.memory)].copy() for part in layout.contacts if part.memory}
        if layout.single:
            one = {"x": float(q[0]), "v": float(u[0])}
            return one | {name: _one_or_all(next(iter(of.values()))) for name, of in (("z", inner), ("memory", memory)) if of}
        m = self._machine.mechanics
        x, v = m.positions(t, tuple(q)), m.velocities(t, tuple(u))
        parts: dict[str, Any] = {what: dict(zip(m.bodies, map(float, of), strict=True)) for what, of in (("x", x), ("v", v))}
        control = {part.name: states[list(part.inner)].copy() for part in layout.controllers if part.inner}
        return parts | {name: of for name, of in (("z", inner), ("control", control), ("memory", memory)) if of}

    def parts(self, side: Any, t: float) -> dict[str, dict[str, Any]]:
        """Position, velocity, mode and inner states of each body and contact by its name."""
        q, u, _ = self._parts(side, t)
        m, layout, states = self._machine.mechanics, self.layout, side.states
        x, v = m.positions(t, tuple(q)), m.velocities(t, tuple(u))
        named: dict[str, dict[str, Any]] = {}
        for name, at, speed in zip(m.bodies, x, v, strict=True):
            named.setdefault(name, {}).update(x=float(at), v=float(speed))
        for contact, mode in zip(layout.contacts, side.sides, strict=True):
            own = named.setdefault(contact.name, {})
            own["mode"] = int(mode)
            own |= {"z": states[list(contact.inner)].copy()} if contact.inner else {}
        for part in layout.controllers:
            named.setdefault(part.name, {}).update(zip(part.states, states[list(part.inner)].tolist(), strict=True))
        return named

    def sentence(self, status: int, side: Any, t: float) -> str:
        """Why a step could not be made, and what to do."""
        q, u, _ = self._parts(side, t)
        where = stopped.location(self._machine.mechanics, t, u, None, q)
        return f"{STATUS[status]} {where}. {stopped.remedy(status, self.rtol, bool(self._machine.mechanics.stops))}"


def _one_or_all(values: Array) -> Any:
    """A number where there is one alone."""
    return float(values[0]) if len(values) == 1 else values


def forces_of(machine: Any) -> dict[str, str]:
    """Forces on the bodies by their names, each with the number that it is."""
    return {name: FORCE + number for name, number in force_names(machine).items()}


def request_of_one(machine: Any, start: Any, rtol: float, method: str) -> Request:
    """What `solve` is asked for over a period, or a second where nothing repeats; `InputError` where a load does not repeat with it."""
    length: dict[str, Any] = {"periods": 1} if machine.period is not None else {"duration": 1.0}
    todo = request(machine, Settings(**length, rtol=rtol, start=start, samples=4, method=method))
    check_period(machine, todo.machine)
    return todo


def check_one_machine(machine: Any, who: str) -> None:
    """`InputError` for what is not one machine."""
    if not is_machine(machine):
        flows = " or a SwitchingFlow" if who == "simulation" else ""
        allowed = f"allowed is a Robot, a mechanism{'' if flows else ' or'}{',' if flows else ''} a machine of several bodies{flows}"
        raise InputError(who, [f"{machine!r} is not a machine; {allowed}; type for example ss.{who}(ss.Joint.example())"])
    if shape := labels_of(machine).shape:
        what = f"the {type(machine).__name__} is a batch of shape {shape}"
        raise InputError(who, [f"{what}; allowed is one case; type ss.solve(machine) for a batch"])
