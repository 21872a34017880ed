"""Layout of the states of a run: which belong to which body, and which to which contact."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from stickslip.basics.errors import InputError, is_whole


@dataclass(frozen=True)
class BodyStates:
    """The states that describe the motion of one body.

    Its position is `factor` times a way, plus a state. A way is the displacement of a reference body, the integral of that body's
    velocity; no force depends on it. With a way the state is the rest of the position, such as the length of a spring to the reference
    body; without one it is the position itself.

    Parameters
    ----------
    name : str
    velocity : int
        Number of the state that is its velocity [m/s].
    way : int, optional
        Number of its way.
    factor : float
        Its displacement per unit of that way.
    position : int, optional
        Number of the state that is its position, or the rest of it [m].
    """

    name: str
    velocity: int
    way: int | None = None
    factor: float = 1.0
    position: int | None = None


@dataclass(frozen=True)
class ContactStates:
    """The states and memories of one contact.

    Parameters
    ----------
    name : str
    direction : tuple of float
        Coefficients of the velocities of the bodies in the slip velocity, to which prescribed velocities are added.
    inner : tuple of int
        Numbers of the states that are the inner states of its law.
    memory : tuple of int
        Numbers of the whole-number memories of its law.
    """

    name: str
    direction: tuple[float, ...] = (1.0,)
    inner: tuple[int, ...] = ()
    memory: tuple[int, ...] = ()


@dataclass(frozen=True)
class ControllerStates:
    """The states of one controller.

    Parameters
    ----------
    name : str
    states : tuple of str
        Their names.
    inner : tuple of int
        Their numbers among the states.
    """

    name: str
    states: tuple[str, ...]
    inner: tuple[int, ...]


@dataclass(frozen=True)
class StateLayout:
    """Layout of the states of a run.

    Parameters
    ----------
    bodies : tuple of BodyStates
    contacts : tuple of ContactStates
    ways : tuple of int
        For each way the number of the state that is the velocity of its reference body.
    single : bool
        Whether the machine has one body and one contact by its kind, as a `Robot` has: columns then have no axis for them.
    principal : str, optional
        Name of the principal body of a machine of several bodies: columns are then those of this body and its contact, without an axis.
    controllers : tuple of ControllerStates, optional

    Examples
    --------
    >>> StateLayout.of_one(inner=1).names
    ('v', 'z')
    >>> head, tail = BodyStates("head", velocity=0, way=0), BodyStates("tail", velocity=1, way=0, position=2)
    >>> contacts = ContactStates("head", (1.0, 0.0)), ContactStates("tail", (0.0, 1.0), inner=(3,))
    >>> StateLayout((head, tail), contacts, ways=(0,)).names
    ('v.head', 'v.tail', 'l.tail', 'z.tail.0')
    """

    bodies: tuple[BodyStates, ...]
    contacts: tuple[ContactStates, ...]
    ways: tuple[int, ...] = ()
    single: bool = False
    principal: str | None = None
    controllers: tuple[ControllerStates, ...] = ()

    @classmethod
    def of_one(cls, inner: int = 0, memories: int = 0, knows_position: bool = False) -> StateLayout:
        """One body on one contact: v, the inner states, and x if the equations contain it.

        Parameters
        ----------
        inner, memories : int
            Inner states and whole-number memories of the law.
        knows_position : bool
            Whether the position is a state; if not it is the integral of the velocity.
        """
        placed = {"position": 1 + inner} if knows_position else {"way": 0}
        body = BodyStates("body", velocity=0, **placed)
        contact = ContactStates("contact", (1.0,), tuple(range(1, 1 + inner)), tuple(range(memories)))
        return cls((body,), (contact,), () if knows_position else (0,), single=True)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states: "v" velocity, "l" addition to a way, "x" position, "z" inner state; then the part if there are several."""
        named: dict[int, str] = {}
        for body in self.bodies:
            named.setdefault(body.velocity, self._name("v", body.name))
            if body.position is not None:
                named.setdefault(body.position, self._name("x" if body.way is None else "l", body.name))
        for contact in self.contacts:
            numbered = len(contact.inner) > 1 or not self.single
            named |= {n: self._name("z", contact.name) + (f".{k}" if numbered else "") for k, n in enumerate(contact.inner)}
        for part in self.controllers:
            named |= {n: f"{state}.{part.name}" for state, n in zip(part.states, part.inner, strict=True)}
        return tuple(named.get(number, f"y{number}") for number in range(max(named, default=-1) + 1))

    def _name(self, letter: str, part: str) -> str:
        return letter if self.single else f"{letter}.{part}"

    @property
    def is_one(self) -> bool:
        """Whether it is one body on one contact, with or without axes for them."""
        return (len(self.bodies), len(self.contacts)) == (1, 1)

    @property
    def own(self) -> dict[str, int]:
        """Numbers of the body and the contact that the columns belong to, by dimension; empty if they have an axis for all."""
        if self.principal is not None:
            return of_principal(self.principal, [b.name for b in self.bodies], [c.direction for c in self.contacts])
        return {"body": 0, "contact": 0} if self.single else {}

    @property
    def with_inner(self) -> tuple[ContactStates | ControllerStates, ...]:
        """Parts that may have inner states: the contacts, then the controllers."""
        return (*self.contacts, *self.controllers)

    @property
    def most_inner(self) -> int:
        """Largest number of inner states of a law or a controller."""
        return max((len(part.inner) for part in self.with_inner), default=0)

    # ---- checks ----
    def flaws(self, states: int, ways: int, memories: int, contacts: int) -> list[str]:
        """Inconsistencies with arrays of these numbers of states, ways, memories and contacts: a sentence each."""
        bodies = self.bodies
        used = [*self.ways, *(b.velocity for b in bodies), *(b.position for b in bodies if b.position is not None)]
        inner, memory = [n for c in self.with_inner for n in c.inner], [n for c in self.contacts for n in c.memory]
        return [
            *_misnamed("bodies", bodies),
            *_misnamed("contacts", self.contacts),
            *(f"body {b.name!r} has neither a way nor a position; give one" for b in bodies if b.way is None and b.position is None),
            *_outside("state", used + inner, states),
            *_outside("way", [b.way for b in bodies if b.way is not None], len(self.ways)),
            *_outside("memory", memory, memories),
            *_twice("inner states", inner),
            *_twice("memories", memory),
            *_unequal("columns of x0", ways, "ways", len(self.ways)),
            *_unequal("columns of mode", contacts, "contacts", len(self.contacts)),
            *self._misdirected(),
            *self._not_single(),
            *self._without_principal(),
        ]

    def _misdirected(self) -> list[str]:
        count = len(self.bodies)
        flaws = (_unequal(f"numbers in the direction of {c.name!r}", len(c.direction), "bodies", count) for c in self.contacts)
        return [flaw for several in flaws for flaw in several]

    def _not_single(self) -> list[str]:
        if not self.single or self.is_one:
            return []
        return [f"single=True with {self.description}; allowed is one body and one contact; leave it out"]

    def _without_principal(self) -> list[str]:
        names = [body.name for body in self.bodies]
        known = self.principal is None or self.principal in names
        return [] if known else [f"principal={self.principal!r}; allowed is one of {', '.join(map(repr, names))}, or None"]

    @property
    def description(self) -> str:
        """The numbers of bodies and contacts, and their names."""
        return " and ".join(
            f"{len(parts)} {word if len(parts) == 1 else plural}" + (f" ({', '.join(p.name for p in parts)})" if parts else "")
            for parts, word, plural in ((self.bodies, "body", "bodies"), (self.contacts, "contact", "contacts"))
        )

    # ---- files ----
    def to_text(self) -> str:
        """The layout as JSON for a file, with the names of the states."""
        return json.dumps({**asdict(self), "states": self.names})

    @classmethod
    def from_text(cls, text: str) -> StateLayout:
        """The layout from its JSON text."""
        kept = json.loads(text)
        bodies = tuple(BodyStates(**{**body, "factor": float(body["factor"])}) for body in kept["bodies"])
        contacts = tuple(
            ContactStates(c["name"], tuple(map(float, c["direction"])), tuple(c["inner"]), tuple(c["memory"])) for c in kept["contacts"]
        )
        controllers = tuple(ControllerStates(c["name"], tuple(c["states"]), tuple(c["inner"])) for c in kept.get("controllers", ()))
        principal = kept.get("principal")
        return cls(bodies, contacts, tuple(kept["ways"]), bool(kept["single"]), principal, controllers)


def of_principal(name: str, bodies: Sequence[str], directions: Sequence[Sequence[float]]) -> dict[str, int]:
    """Numbers of the principal body and of its first contact, by dimension; if it has no contact, of the machine's first.

    Parameters
    ----------
    name : str
        Name of the principal body.
    bodies : sequence of str
        Names of all bodies.
    directions : sequence
        For each contact, the coefficients of the bodies' velocities in its slip.

    Examples
    --------
    >>> of_principal("tail", ["head", "tail"], [(1.0, 0.0), (0.0, 1.0)])
    {'body': 1, 'contact': 1}
    """
    body = bodies.index(name)
    contact = next((i for i, row in enumerate(directions) if row[body]), 0)
    return {"body": body, "contact": contact} if len(directions) else {"body": body}


def _outside(word: str, numbers: list[Any], count: int) -> list[str]:
    """Sentences on numbers that are out of range."""
    wrong = [n for n in dict.fromkeys(numbers) if not (is_whole(n) and 0 <= n < count)]
    return [f"{word} number {n!r}; allowed is {f'0 to {count - 1}' if count else 'none'}" for n in wrong]


def _twice(word: str, numbers: list[Any]) -> list[str]:
    """A sentence if a number is given to two contacts, or twice to one."""
    return [] if len(set(numbers)) == len(numbers) else [f"the numbers of {word} are {numbers!r}; allowed is each once"]


def _misnamed(word: str, parts: Sequence[BodyStates | ContactStates]) -> list[str]:
    """A sentence if a name is invalid or belongs to two parts."""
    names = [part.name for part in parts]
    if all(isinstance(name, str) and name for name in names) and len(set(names)) == len(names):
        return []
    return [f"the names of the {word} are {names!r}; allowed is one text for each, no two alike"]


def _unequal(word: str, given: int, of: str, allowed: int) -> list[str]:
    """A sentence if two numbers that should be equal are not."""
    return [] if given == allowed else [f"{given} {word}; allowed is one for each of the {allowed} {of}"]


def of_one_contact(what: str, run: Any, why: str) -> Any:
    """The run of one body on one contact, with columns that have no axis for them; `InputError` with the reason for a run of several.

    Every analysis of a single velocity and contact calls it first.

    Parameters
    ----------
    what : str
        Name of the function that the user called.
    run : Trajectory
    why : str
        Why it cannot take several, such as "it balances one friction force".

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> head, tail = BodyStates("head", 0, way=0), BodyStates("tail", 1, way=0, position=2)
    >>> two = SimpleNamespace(pieces=SimpleNamespace(layout=StateLayout((head, tail), (ContactStates("pad", (1.0, 0.0)),), ways=(0,))))
    >>> try:
    ...     of_one_contact("energy", two, "it balances one friction force")
    ... except InputError as error:
    ...     print(error.problems[0][:97])
    the run has 2 bodies (head, tail) and 1 contact (pad); allowed is one body on one contact, as it
    """
    layout = run.pieces.layout
    if not layout.bodies:
        mistake = "the run is that of a flow, which has states of its own and no bodies and contacts"
        raise InputError(what, [f"{mistake}; allowed is one body on one contact; type run.to_xarray() for its columns"])
    if layout.single:
        return run
    if layout.is_one:
        return replace(run, pieces=replace(run.pieces, layout=replace(layout, single=True)))
    parts = [f"run.{kind}[{of[0].name!r}]" for kind, of in (("bodies", layout.bodies), ("contacts", layout.contacts)) if of]
    hint = f"type {' and '.join(parts)} for the columns of one of them"
    raise InputError(what, [f"the run has {layout.description}; allowed is one body on one contact, as {why}; {hint}"])
