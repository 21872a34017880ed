"""What a load may depend on: time, positions, velocities, and the forces of the same instant that follow from them, by their names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.of_own import OfOwn, without_others
from stickslip.models.links_in_time import takes_arguments

#: Arguments with which a load is called, by their number; those that stand first are tried first.
ARGUMENTS = {
    2: ("time", "position"),
    4: ("time", "position", "velocity", "forces"),
    3: ("time", "position", "velocity"),
    1: ("time",),
}
#: Loads, in words.
LOADS = "allowed is a function of t, of t and x, of t, x and v, or of t, x, v and forces"
_GRAVITY = "gravity"


def arguments_of_load(load: Any) -> int | None:
    """How many arguments a load takes: 0 of a number, 1 to 4 of a function; None of a function that takes others.

    Examples
    --------
    >>> arguments_of_load(1.5), arguments_of_load(lambda t, x: 1.0 + x), arguments_of_load(lambda t, x, v, forces: abs(forces["motor"]))
    (0, 2, 4)
    """
    return next((n for n, takes in ARGUMENTS.items() if takes_arguments(load, takes)), None) if callable(load) else 0


def parts_of_forces(forces: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, str | None, Any]]:
    """Forces with the bodies that they act on, and with their names where they have some: ``{"joint": {"motor": 0.3}}``.

    Examples
    --------
    >>> list(parts_of_forces({"head": 0.2, "joint": {"motor": 0.3}}.items()))
    [('head', None, 0.2), ('joint', 'motor', 0.3)]
    """
    for body, force in forces:
        if isinstance(force, Mapping):
            yield from ((body, name, part) for name, part in force.items())
        else:
            yield body, None, force


def pressing(load: Any, count: int, own: Callable[[Mapping[str, Any]], Any]) -> Callable[[Any, Any, Any, Any], Any]:
    """A load of three or four arguments as a function of time, positions and velocities of all bodies, and forces.

    `own` gives what is the contact's own of positions or velocities.
    """
    if count == 3:
        return lambda t, x, v, forces: without_others(load(t, OfOwn(own(x), x), OfOwn(own(v), v)))
    return lambda t, x, v, forces: without_others(load(t, OfOwn(own(x), x), OfOwn(own(v), v), forces))


class InstantForces(Mapping[Any, Any]):
    """The forces of one instant that follow from time, positions, velocities and the states of controllers [N].

    Of a body's name, all that is applied to it: its own force, those of the machine and of controllers; no links and no friction. Of a
    controller's name what it exerts, of the name of a force that a machine gives one, ``{"joint": {"motor": 0.3}}``, that one, and of
    ``"gravity"`` what bodies say is gravity; where such a part acts on several bodies, ask with the body's name, as in
    ``forces["gravity", "arm"]``. Of a link or an elastic stop, by the bodies that it joins, ``"head-tail"`` or ``("head", "tail")``, the
    tension with which it pulls them together.

    Friction is not among them: what holds a contact follows from its load.

    Parameters
    ----------
    mechanics : SeveralBodies
        The machine.
    t, x, v, z
        Time, positions and velocities by body, and the states of the controllers.

    Examples
    --------
    >>> import stickslip as ss
    >>> joint = ss.Joint(inertia=0.01, friction=ss.Coulomb(0.02, 0.02), torque=0.3, gravity_torque=0.2)
    >>> forces = InstantForces(joint.mechanics, 0.0, {"joint": -1.5707963267948966}, {"joint": 0.0}, ())
    >>> forces["motor"], forces["gravity"], forces["joint"], sorted(map(str, forces))
    (0.3, 0.2, 0.5, ['gravity', 'joint', 'motor'])
    """

    def __init__(self, mechanics: Any, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Sequence[Any]):
        self._mechanics, self._t, self._x, self._v, self._z = mechanics, t, x, v, z

    def with_more(self, body: str, name: str, force: Any) -> InstantForces:
        """With one more force on a body, which counts to those of its name."""
        more = InstantForces(self._mechanics, self._t, self._x, self._v, self._z)
        more._further = [*self._further, (body, name, force, None)]
        return more

    def seen(self, mechanics: Any, x: Mapping[str, Any], v: Mapping[str, Any]) -> InstantForces:
        """Those of another machine, at other positions and velocities, in which controllers hold the same."""
        return InstantForces(mechanics, self._t, x, v, self._z)

    @cached_property
    def _further(self) -> list[tuple[str, str | None, Any, str | None]]:
        """Forces of the machine, then those of controllers: body, name, force, controller."""
        m, t, x, v = self._mechanics, self._t, dict(self._x), dict(self._v)
        own: list[tuple[str, str | None, Any, str | None]] = [(*part, None) for part in parts_of_forces(m.model.forces(t, x, v).items())]
        for controller, forces in m.controllers.forces_by_name(t, x, v, self._z):
            own += [(*part, controller) for part in parts_of_forces(forces.items())]
        return own

    def _applied(self, body: str) -> Any:
        total = 0.0 + self._mechanics.parts[body].applied(self._t, self._x[body], self._v[body])
        for name, _, force, _ in self._further:
            total = total + force if name == body else total
        return total

    def _named(self, name: str) -> dict[str, Any]:
        """A part of the applied forces by its name, for each body on which it acts."""
        m, parts = self._mechanics, dict[str, Any]()
        if name == _GRAVITY:
            parts = {
                body: part.weight_at(self._t, self._x[body], self._v[body])
                for body, part in m.parts.items()
                if not (isinstance(part.gravity, float) and part.gravity == 0.0)
            }
        for body, own, force, controller in self._further:
            if name in (own, controller):
                parts[body] = parts[body] + force if body in parts else force
        return parts

    def _tensions(self, name: Any) -> list[Any]:
        """Of links and elastic stops of a name, or between two bodies."""
        m, tensions = self._mechanics, list[Any]()
        if not m.elastic:
            return tensions
        own = m.names_of_links
        exactly = name in own
        for label, (ends, _), pull in zip(own, m.elastic, m.pulls, strict=True):
            joined = "-".join(end for end in ends if end is not None)
            if label == name if exactly else name in (joined, ends):
                apart = (of[ends[0]] if ends[1] is None else of[ends[0]] - of[ends[1]] for of in (self._x, self._v))
                tensions.append(pull(self._t, *apart))
        return tensions

    def __getitem__(self, name: Any) -> Any:
        m = self._mechanics
        if name in m.parts:
            return self._applied(name)
        if tensions := self._tensions(name):
            total = tensions[0]
            for tension in tensions[1:]:
                total = total + tension
            return total
        part, body = name if isinstance(name, tuple) and len(name) == 2 else (name, None)
        of = self._named(part) if isinstance(part, str) else {}
        if body is not None and body in of:
            return of[body]
        if body is None and len(of) == 1:
            return next(iter(of.values()))
        raise InputError("load", [self._refused(name, part, of)])

    def _refused(self, name: Any, part: Any, of: dict[str, Any]) -> str:
        """Why there is no force of a name."""
        m, known = self._mechanics, list(self)
        if of:
            return f'forces[{name!r}] acts on {", ".join(map(repr, of))}; type for example forces[{part!r}, "{next(iter(of))}"]'
        joined = {"-".join(end for end in ends if end is not None): ends for ends, _ in m.prescribed}
        stops = {stop.name: stop.ends for stop in m.stops}
        solved = "which follows from the accelerations, and so from the friction that this load is to decide, in a loop"
        if name in m.contacts:
            why = f"is friction of the same instant, {solved}"
        elif name in joined or name in joined.values():
            why = f"is what keeps a prescribed distance, {solved}"
        elif name in stops or name in stops.values():
            why = f"is what a stop with restitution bears, {solved}"
        else:
            return f"forces has no {name!r}; {did_you_mean(str(name), map(str, known))}"
        return (
            f"forces[{name!r}] {why}; allowed are {', '.join(map(repr, known))}; type for example "
            f"load=lambda t, x, v, forces: 1.0 + 0.1 * abs(forces[{known[-1]!r}])"
        )

    def __iter__(self) -> Iterator[Any]:
        m, joined = self._mechanics, dict[Any, None]()
        for ends, _ in m.elastic:
            joined["-".join(end for end in ends if end is not None)] = None
        names = [_GRAVITY, *(name for _, own, _, controller in self._further for name in (own, controller) if name is not None)]
        parts: list[Any] = []
        for name in dict.fromkeys(names):
            of = self._named(name)
            parts += [name] if len(of) == 1 else [(name, body) for body in of]
        return iter(dict.fromkeys([*m.parts, *joined, *parts]))

    def __contains__(self, name: object) -> bool:
        return name in list(self)

    def __len__(self) -> int:
        return len(list(iter(self)))
