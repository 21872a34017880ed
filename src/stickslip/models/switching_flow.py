r"""Switching flows (hybrid automata): smooth fields, guards and resets, for systems that are not machines of bodies and contacts.

A mode has a field :math:`\dot y = f(t, y)` and switches. A switch happens when its guard falls through zero; the mode after it and the
state after it may depend on the time and state of the switch. A guard that is below zero where a mode begins switches at once; further
switches at the same instant are merged into one with the composed resets. A run does not begin so if a reset would change its start.
If several guards fall through zero together, the first in
the tuple takes effect. Fields, guards and resets are plain Python on sequences, written with `stickslip.maths`; their derivatives are
derived from this code.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from types import SimpleNamespace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import checked_number, floats, is_array
from stickslip.basics.maths import cos, pi
from stickslip.models.cyclic_coordinates import CyclicCoordinates, checked_cyclic, lengths_of
from stickslip.models.flow_contacts import (
    FlowContact,
    check_contacts,
    inner_names,
    inner_scales,
    memories_of,
    mode_labels,
    resting_contacts,
)

Mode = Hashable


@dataclass(frozen=True)
class Switch:
    """A switch that ends a mode.

    Parameters
    ----------
    guard : callable
        g(t, y), positive before the switch, which occurs when it falls through zero, or immediately if a mode begins below zero.
    to : int, str or callable
        The mode after it, or a function of (t, y) that returns it.
    reset : callable, optional
        The state after it, from (t, y); unchanged if not given.

    Examples
    --------
    >>> floor = Switch(guard=lambda t, y: y[0], to=0, reset=lambda t, y: (0.0, -0.8 * y[1]))
    >>> floor.reset(0.0, [0.0, -2.0])
    (0.0, 1.6)
    """

    guard: Callable[..., Any]
    to: Mode | Callable[..., Mode]
    reset: Callable[..., Any] | None = None

    def __post_init__(self) -> None:
        problems = Problems("Switch")
        if not callable(self.guard):
            problems.add(f"guard = {self.guard!r}; allowed is a function of (t, y); type for example guard=lambda t, y: y[0]")
        if self.reset is not None and not callable(self.reset):
            problems.add(f"reset = {self.reset!r}; allowed is a function of (t, y) that gives the state after the switch, or None")
        problems.check()


@dataclass(frozen=True, init=False, eq=False)
class SwitchingFlow:
    """A flow of several modes.

    Parameters
    ----------
    fields : dict or callable
        Mode (a number or a word) -> function of (t, y) that gives the rates. Of a flow of one mode that function alone. With `contacts`
        it takes their friction forces too, as f(t, y, R) with R.name [N].
    switches : dict
        Mode -> tuple of `Switch`.
    period : float or callable, optional
        Period of the forcing, or a function of the numbers that returns it; None for an autonomous flow.
    numbers : dict, optional
        Name -> number. With them every function of the flow, those of its switches too, takes (t, y, n) with the numbers as n.name.
        Arrays mean cases, and their names are names of axes in a sweep.
    states : tuple of str, optional
        Names of the coordinates of y, in order: the columns of a run. If not given they are y0, y1, and so on.
    scales : tuple of float, optional
        A typical size of each state, against which analyses measure distances; 1 each if not given.
    contacts : dict of FlowContact, optional
        Contacts that rub, by name. Rest, break-away and the direction of slip are then modes of the flow, which follow from the state;
        inner states of their laws are further states, ``z_name``, behind those of the field, and so is what a law remembers,
        ``memory_name``.
    cyclic : str, tuple of str, or dict, optional
        States that drift while the motion repeats: names of those on which no function of the flow depends, such as a displacement, or
        name -> length after which all of them repeat, such as ``{"angle": 2 * np.pi}`` (a number, or a function of the numbers; None
        for no dependence). The first is the displacement whose mean rate is the flow's mean velocity. The functions are asked whether
        it is so.

    Raises
    ------
    InputError
        For inconsistent modes, such as a switch to a mode that has no field; where it is first solved, for functions that depend on a
        state that is called cyclic.

    Examples
    --------
    A ball that bounces with restitution r:

    >>> hit = Switch(lambda t, y, n: y[0], to=0, reset=lambda t, y, n: (0.0, -n.r * y[1]))
    >>> ball = SwitchingFlow({0: lambda t, y, n: (y[1], -9.81)}, {0: (hit,)}, numbers={"r": 0.8}, states=("height", "v"))
    >>> ball.replace(r=0.5).numbers, ball.period
    ({'r': 0.5}, None)

    A block on a belt, whose friction force R brakes it:

    >>> import stickslip as ss
    >>> belt = ss.machines.FlowContact(slip=lambda t, y, n: y[1] - n.speed, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)
    >>> field = lambda t, y, R, n: (y[1], -4.0 * y[0] - R.belt)
    >>> block = SwitchingFlow(field, numbers={"speed": 0.1}, states=("x", "v"), contacts={"belt": belt})
    >>> block.modes
    ('belt-', 'belt0', 'belt+')
    """

    fields: Mapping[Any, Callable[..., Any]]
    switches: Mapping[Any, tuple[Switch, ...]]
    forcing: float | Callable[..., Any] | None
    numbers: Mapping[str, float]
    states: tuple[str, ...] | None
    scales: Sequence[Any] | None
    contacts: Mapping[str, FlowContact]
    cyclic: Mapping[str, Any]
    map: Callable[..., Any] | None

    def __init__(
        self,
        fields: Mapping[Any, Callable[..., Any]] | Callable[..., Any],
        switches: Mapping[Any, tuple[Switch, ...]] | None = None,
        period: float | Callable[..., Any] | None = None,
        numbers: Mapping[str, float] | None = None,
        states: tuple[str, ...] | None = None,
        scales: Sequence[float] | None = None,
        contacts: Mapping[str, FlowContact] | None = None,
        cyclic: str | Sequence[str] | Mapping[str, Any] | None = None,
    ):
        fields = {0: fields} if callable(fields) else fields
        problems, switches, numbers = Problems("SwitchingFlow"), {} if switches is None else switches, {} if numbers is None else numbers
        _check_fields(problems, fields)
        _check_switches(problems, fields, switches)
        numbers = _checked_numbers(problems, numbers)
        _check_states(problems, states, numbers)
        _check_scales(problems, scales, states)
        _check_period(problems, period, numbers)
        contacts = check_contacts(problems, contacts, fields)
        drifting = checked_cyclic(problems, cyclic, states, numbers)
        problems.check()
        names, sizes = (None if given is None else tuple(given) for given in (states, scales))
        own = {"fields": dict(fields), "switches": dict(switches), "forcing": period, "numbers": numbers, "states": names, "scales": sizes}
        own |= {"contacts": contacts, "cyclic": drifting, "map": None}
        for name, value in own.items():
            object.__setattr__(self, name, value)
        for contact in contacts.values():
            contact.law(*self.given_once)

    @classmethod
    def of_map(
        cls,
        f: Callable[..., Any],
        numbers: Mapping[str, float] | None = None,
        states: tuple[str, ...] | None = None,
        scales: Sequence[float] | None = None,
    ) -> SwitchingFlow:
        """A map as a flow that is at rest and jumps once in each period of 1, so that every function for flows accepts it.

        Parameters
        ----------
        f : callable
            The map as a function of y, or of (y, n) if there are numbers, as for `lyapunov_of_map`; written with `stickslip.maths`.
        numbers, states, scales
            As for a flow.

        Examples
        --------
        >>> import stickslip as ss
        >>> henon = lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0])
        >>> flow = SwitchingFlow.of_map(henon, {"a": 0.3, "b": 0.3}, ("x", "y"))
        >>> b = ss.continuation(flow, parameter="a", start=0.3, stop=0.4, guess={"x": 0.8, "y": 0.2})
        >>> [(s.kind, s.rounded) for s in b.special]  # a = 3 (1 - b)^2/4
        [('flip', '0.3675')]
        """
        if not callable(f):
            raise InputError(
                "SwitchingFlow.of_map", [f"f = {f!r}; allowed is a function; type for example lambda y, n: (n.r * y[0] * (1 - y[0]),)"]
            )

        def still(t: Array, y: Array, *n: Any) -> Any:
            return tuple(0.0 * value for value in y)

        def clock(sign: float) -> Callable[..., Any]:
            return lambda t, y, *n: 0.5 + sign * cos(2 * pi * t)  # where one guard falls the other is far from zero

        first = Switch(clock(1.0), "after", lambda t, y, *n: f(y, *n))
        switches = {"before": (first,), "after": (Switch(clock(-1.0), "before"),)}
        return cls({"before": still, "after": still}, switches, 1.0, numbers, states, scales)._of_map(f)

    def _of_map(self, f: Callable[..., Any] | None) -> SwitchingFlow:
        """The flow, which says of which map it was made; None of no map."""
        object.__setattr__(self, "map", f)
        return self

    @property
    def period(self) -> Any:
        """Period of the forcing; None for an autonomous flow."""
        return self.forcing(self.given) if callable(self.forcing) else self.forcing

    @property
    def given(self) -> SimpleNamespace:
        """The numbers as they are passed to the flow's functions."""
        return SimpleNamespace(**self.numbers)

    def replace(self, changes: Mapping[str, Any] | None = None, /, **numbers: Any) -> SwitchingFlow:
        """The flow with other numbers.

        Raises
        ------
        InputError
            For an unknown name.
        """
        new = {**(changes or {}), **numbers}
        if wrong := [name for name in new if name not in self.numbers]:
            raise InputError("SwitchingFlow", [f"{name!r} is not a number of the flow; {_known(name, self.numbers)}" for name in wrong])
        numbers = {**self.numbers, **new}
        own = (self.fields, self.switches, self.forcing, numbers, self.states, self.scales, self.contacts, self.cyclic)
        return SwitchingFlow(*own)._of_map(self.map)

    @property
    def plain(self) -> SwitchingFlow:
        """The same flow with its numbers substituted: its functions take (t, y)."""
        if not self.numbers:
            return self
        put, last = partial(_with_numbers, n=self.given), partial(_with_forces_and_numbers, n=self.given)
        fields = {mode: last(f) if self.contacts else put(f) for mode, f in self.fields.items()}
        switches = {
            mode: tuple(Switch(put(s.guard), put(s.to) if callable(s.to) else s.to, s.reset and put(s.reset)) for s in exits)
            for mode, exits in self.switches.items()
        }
        contacts = {name: contact.with_numbers(self.given) for name, contact in self.contacts.items()}
        cyclic = {n: length(self.given) if callable(length) else length for n, length in self.cyclic.items()}
        return SwitchingFlow(fields, switches, self.period, {}, self.states, self.scales, contacts, cyclic)

    def to_toml(self) -> str:
        """Raise `InputError`: the functions of a flow are Python code, which cannot be stored in a file."""
        raise InputError("SwitchingFlow", [_NO_FILE])

    @classmethod
    def from_toml(cls, text: str) -> SwitchingFlow:
        """Raise `InputError`, as `to_toml` does."""
        raise InputError("SwitchingFlow", [_NO_FILE])

    @cached_property
    def labels(self) -> Mapping[Any, tuple[Any, tuple[int, ...]]]:
        """Every mode, with the mode of its field and what each contact that can rest does there: +1, 0 or -1."""
        return mode_labels(self.fields, resting_contacts(self.contacts, *self.given_once))

    @property
    def modes(self) -> tuple[Any, ...]:
        """The modes: those of the fields, each once for all that the contacts may do."""
        return tuple(self.labels)

    @property
    def start_modes(self) -> Mapping[Any, Any]:
        """The modes with which a run may begin: all modes, and those of the fields, in which contacts do what the state says."""
        return {**self.labels, **self.fields}

    @cached_property
    def inner(self) -> tuple[str, ...]:
        """Names of the inner states of the contacts' laws, which are the last states."""
        return inner_names(self.contacts, *self.given_once)

    @property
    def given_once(self) -> tuple[SimpleNamespace, ...]:
        """The numbers as functions take them, of the first case where there are several."""
        return (SimpleNamespace(**{name: float(np.ravel(value)[0]) for name, value in self.numbers.items()}),) if self.numbers else ()

    def inner_start(self, y: Array) -> tuple[float, ...]:
        """The inner states of the contacts' laws where nothing has moved them, at a state of the field."""
        numbers = self.given_once
        laws = [(contact.law(*numbers), contact.normal(0.0, list(map(float, y)), *numbers)) for contact in self.contacts.values()]
        return tuple(float(z) for law, load in laws if law.dynamic for z in (*law.start(load), *(0.0,) * law.modes))

    @cached_property
    def memories(self) -> Array:
        """Which of the inner states are whole numbers that a law remembers."""
        return memories_of(self.contacts, *self.given_once)

    @property
    def sizes(self) -> tuple[float, ...]:
        """A typical size of each named state, those of the laws last, against which analyses measure distances."""
        own = (1.0,) * len(self.states or ()) if self.scales is None else self.scales
        return (*own, *inner_scales(self.contacts, (0.0,) * len(own), *self.given_once))

    @property
    def drifts(self) -> CyclicCoordinates:
        """The cyclic coordinates, by their places among the states."""
        return lengths_of(self.cyclic, self.states, self.numbers)

    def names(self, count: int) -> tuple[str, ...]:
        """Names of `count` states."""
        own = count - len(self.inner)
        return (*(self.states if self.states is not None else (f"y{i}" for i in range(own))), *self.inner)

    def __repr__(self) -> str:
        numbers = "".join(
            f", {name} = {value if not is_array(value) else f'array of shape {np.shape(value)}'}" for name, value in self.numbers.items()
        )
        return f"<SwitchingFlow: modes {', '.join(map(repr, self.fields))}{numbers}>"


_NO_FILE = (
    "the functions of a flow are Python, which no file holds; write a function in mine.py that returns the flow, and type "
    'make = "mine.py:flow" in a study file, or import it'
)


def is_flow(model: Any) -> bool:
    """Whether an object declares fields by modes and the switches between them, as a `SwitchingFlow` does."""
    return isinstance(getattr(model, "fields", None), Mapping) and isinstance(getattr(model, "switches", None), Mapping)


def _with_numbers(f: Callable[..., Any], n: Any) -> Callable[[Any, Any], Any]:
    return lambda t, y: f(t, y, n)


def _with_forces_and_numbers(f: Callable[..., Any], n: Any) -> Callable[[Any, Any, Any], Any]:
    return lambda t, y, R: f(t, y, R, n)


# ---- checks ----
def _check_fields(problems: Problems, fields: Any) -> None:
    if not isinstance(fields, Mapping) or not fields:
        problems.add(f"fields = {fields!r}; allowed is a dict of functions; type for example fields={{0: lambda t, y: (y[1], -y[0])}}")
        problems.check()
    for mode, f in fields.items():
        if not callable(f):
            problems.add(f"fields[{mode!r}] = {f!r}; allowed is a function of (t, y) that gives the rates")


def _check_switches(problems: Problems, fields: Any, switches: Any) -> None:
    if not isinstance(switches, Mapping):
        problems.add(f"switches = {switches!r}; allowed is a dict of tuples of Switch; type for example switches={{0: (switch,)}}")
        problems.check()
    for mode, exits in switches.items():
        if mode not in fields:
            problems.add(f"switches[{mode!r}]: {unknown_mode(mode, fields)}")
        if not isinstance(exits, (tuple, list)) or not all(isinstance(s, Switch) for s in exits):
            problems.add(f"switches[{mode!r}] = {exits!r}; allowed is a tuple of Switch; type (switch,) for a single one")
            continue
        for k, s in enumerate(exits):
            if not callable(s.to) and not knows_mode(fields, s.to):
                problems.add(f"switches[{mode!r}][{k}].to: {unknown_mode(s.to, fields)}")


def _checked_numbers(problems: Problems, numbers: Any) -> dict[str, Any]:
    if not isinstance(numbers, Mapping):
        problems.add(f"numbers = {numbers!r}; allowed is a dict of numbers by name; type for example numbers={{'r': 0.8}}")
        return {}
    checked = {}
    for name, value in numbers.items():
        if not (isinstance(name, str) and name.isidentifier()) or name in ("t", "mode"):
            problems.add(f"numbers has {name!r}; allowed are names that can be typed after n., other than t and mode")
            continue
        allowed = "a number, or an array of one for each case"
        checked[name] = checked_number(f"numbers[{name!r}]", value, problems, None, allowed, f"numbers={{{name!r}: 0.8}}")
    return checked


def _check_states(problems: Problems, states: Any, numbers: Mapping[str, Any]) -> None:
    if states is None:
        return
    names = list(states) if isinstance(states, (tuple, list)) else []
    if not names or not all(isinstance(name, str) and name for name in names) or len(set(names)) < len(names):
        problems.add(f"states = {states!r}; allowed is a tuple of names, no two alike; type for example states=('x', 'v')")
    for name in names:
        if name in (*numbers, "t", "mode"):
            problems.add(
                f"states has {name!r}, which is {'a number of the flow' if name in numbers else 'a column of every run'}; give another name"
            )


def _check_scales(problems: Problems, scales: Any, states: Any) -> None:
    if scales is None:
        return
    sizes = floats(scales)
    count = len(states) if isinstance(states, (tuple, list)) else sizes.size
    if sizes.shape != (count,) or not count or not np.all(np.isfinite(sizes) & (sizes > 0)):
        problems.add(f"scales = {scales!r}; allowed are positive numbers, one for each state; type for example scales=(1e-3, 0.1)")


def _check_period(problems: Problems, given: Any, numbers: Mapping[str, Any]) -> None:
    if given is None or (callable(given) and problems.mistakes):
        return
    period = given
    if callable(given):
        try:
            period = given(SimpleNamespace(**numbers))
        except Exception as error:
            allowed = "allowed is a function of the numbers; type period=lambda n: 2 * pi / n.omega"
            problems.add(f"period raised {type(error).__name__}: {error}; {allowed}")
            return
    sizes = floats(period)
    if not sizes.size or (sizes.ndim and not callable(given)) or not np.all(np.isfinite(sizes) & (sizes > 0)):
        problems.add(f"period = {given!r}; allowed is a positive number, or None for an autonomous flow")


def knows_mode(fields: Mapping[Any, Any], mode: Any) -> bool:
    """Whether a flow has a mode."""
    return isinstance(mode, Hashable) and getattr(mode, "__hash__", None) is not None and mode in fields


def unknown_mode(mode: Any, fields: Mapping[Any, Any]) -> str:
    """The message that a flow has no such mode, with the known ones or a suggestion."""
    if isinstance(mode, str):
        return f"{mode!r} is not a mode of the flow; {did_you_mean(mode, [repr(m) if not isinstance(m, str) else m for m in fields])}"
    return f"{mode!r} is not a mode of the flow; known: {', '.join(map(repr, fields))}"


def _known(name: str, numbers: Mapping[str, Any]) -> str:
    return did_you_mean(str(name), numbers) if numbers else "it has none; type numbers={'r': 0.8} where it is made"
