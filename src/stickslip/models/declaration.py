"""All functions of a machine that solvers call, called with one set of arguments: numbers, or symbols.

Solvers call them in any order, at any instant, and some of them once only, with symbols. So they have to be functions of their
arguments: what draws a random number, counts its calls, reads a clock or stores a value is none, and is refused here.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.errors import InputError
from stickslip.models.friction.law_adapter import LawAdapter
from stickslip.models.machine_adapter import fresh_mechanics, machine_of
from stickslip.models.mechanics import Mechanics

#: A function of a machine with its arguments filled in, by its name in words.
Calls = Mapping[str, Callable[[], Any]]

#: What functions have to be, in words.
NOT_REPEATABLE = (
    "allowed are functions that give the same for the same arguments: no random draw, counter, clock or value stored by an earlier call; "
    "for noise draw phases once, outside of the function, and type a sum such as force=lambda t, x, v: a[0] * sin(w[0] * t + phase[0]) + "
    "a[1] * sin(w[1] * t + phase[1]), or a record: force=lambda t, x, v: record.at(t) with record = "
    "ss.drives.RecordedForce.from_samples(times, force=values, period=T); what has to be remembered is a state, of a law (rate) or of a "
    "controller (controllers())"
)


@dataclass(frozen=True)
class Arguments:
    """One set of arguments of all functions: time, coordinates, their velocities, and of each contact force, slip, load and states."""

    t: Any
    q: tuple[Any, ...]
    u: tuple[Any, ...]
    forces: tuple[Any, ...]
    slips: tuple[Any, ...]
    loads: tuple[Any, ...]
    inner: tuple[tuple[Any, ...], ...]
    memories: tuple[tuple[Any, ...], ...]
    controlled: tuple[Any, ...]

    def aside(self, part: float) -> Arguments:
        """The same with time and velocities larger by a part of themselves."""
        return replace(self, t=self.t * (1 + part), u=tuple(v * (1 + part) for v in self.u))


def calls(m: Mechanics, at: Arguments) -> Calls:
    """Every function of a machine that the equations of motion are made of.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb")
    >>> m = fresh_mechanics(robot)
    >>> list(calls(m, instants(robot, m, 1)[0]))
    ['period', 'masses', 'load', 'acceleration', 'contact velocity', 'sliding', 'breakaway']
    """
    single = m.bodies == ("body",) and m.contacts == ("contact",)
    functions: dict[str, Callable[[], Any]] = {
        "period": lambda: (m.period,),
        "masses": lambda: m.masses,
        "load" if single else "loads": lambda: m.loads(at.t, at.q, at.u, at.controlled),
        "acceleration" if single else "accelerations": lambda: m.accelerations(at.t, at.q, at.u, at.forces, at.controlled),
        "contact velocity" if single else "slips": lambda: m.slips(at.t, at.u, at.q),
    }
    for i, law in enumerate(m.laws):
        functions |= _of_law(law, "" if single else f" of {m.contacts[i]!r}", at.slips[i], at.loads[i], at.inner[i], at.memories[i])
    for stop in m.stops:
        functions[f"stop {stop.name!r}"] = partial(_of_stop, stop, at)
    if m.controllers.count:
        functions["rates of the controllers"] = lambda: m.control_rates(at.t, at.q, at.u, at.controlled)
        functions["samples of the controllers"] = lambda: m.control_sampled(at.t, at.q, at.u, at.controlled)
        functions["starts of the controllers"] = lambda: m.control_start(at.t, at.q, at.u)
    return functions


def _of_law(
    law: LawAdapter, of: str, w: Numeric, load: Numeric, z: tuple[Any, ...], memory: tuple[Any, ...]
) -> dict[str, Callable[[], Any]]:
    """The functions of the law of a contact."""
    if not law.dynamic:
        return {f"sliding{of}": lambda: (law.sliding(w, load),), f"breakaway{of}": lambda: law.breakaway(load)}
    functions: dict[str, Callable[[], Any]] = {
        f"rate{of}": lambda: law.rate(w, z, load, memory),
        f"force{of}": lambda: (law.force(w, z, z, load, memory, load),),
    }
    return functions | {f"switches{of}": lambda: _flat(law.switches(w, z, load, memory))} if law.switching else functions


def _of_stop(stop: Any, at: Arguments) -> tuple[Any, ...]:
    return stop.gap(at.t, at.q), stop.rate(at.t, at.u)


def _flat(switches: Any) -> tuple[Any, ...]:
    return tuple(value for guard, modes, z in switches for value in (guard, *modes, *(z or ())))


def instants(model: Model, m: Mechanics, count: int) -> list[Arguments]:
    """So many sets of arguments in plain floats, of the sizes of a machine's motion and smaller, on both sides of zero; always the same."""
    draw, machine = random.Random(20261128), machine_of(model)
    speed, time, start = _size(machine.velocity_scale), _size(machine.time_scale), tuple(map(float, m.start))
    loads = tuple(abs(float(load)) or 1.0 for load in m.loads(0.0, m.start))
    points = []
    for k in range(count):
        v = speed * (1.0, 0.03, 1.0, 10.0, 1e-4)[k % 5]

        def around(size: float, n: int) -> tuple[float, ...]:
            return tuple(size * draw.uniform(0.2, 1.0) * draw.choice((-1.0, 1.0)) for _ in range(n))

        t, u = time * draw.uniform(0.0, 1.0), around(v, m.coordinates)
        q = tuple(x + d for x, d in zip(start, around(v * time, m.coordinates), strict=True))
        forces = tuple(load * d for load, d in zip(loads, around(0.3, len(loads)), strict=True))
        inner = tuple(_inner(law, load, around(1.0, law.states), v * time) for law, load in zip(m.laws, loads, strict=True))
        memories = tuple(tuple(draw.choice((-1, 0, 1)) for _ in range(law.modes)) for law in m.laws)
        held = tuple(float(scale) * d for scale, d in zip(m.controllers.scales, around(1.0, m.controllers.count), strict=True))
        points.append(Arguments(t, q, u, forces, around(v, len(loads)), loads, inner, memories, held))
    return points


def _inner(law: LawAdapter, load: float, parts: tuple[float, ...], size: float) -> tuple[float, ...]:
    typical = law.scale(load)
    scales = [size] * law.states if typical is None else [float(s) or size for s in typical]
    return tuple(scale * part for scale, part in zip(scales, parts, strict=True))


def _size(said: Any) -> float:
    size = 1.0 if said is None else float(said)
    return size if 0.0 < size < math.inf else 1.0


def answers(functions: Calls) -> dict[str, tuple[Any, ...] | str]:
    """What the functions give; the type of an error where one raises it, which is said in words where it is met again."""
    given: dict[str, tuple[Any, ...] | str] = {}
    for name, call in functions.items():
        try:
            given[name] = tuple(call())
        except Exception as error:  # a user's function may raise what it likes
            given[name] = type(error).__name__
    return given


def check_repeatable(what: str, now: Calls, between: Calls, again: Calls) -> dict[str, tuple[Any, ...] | str]:
    """The answers of functions; `InputError` if they answer otherwise after other calls.

    Parameters
    ----------
    what : str
        Name of the model.
    now, again : mapping
        The functions with one set of arguments, twice.
    between : mapping
        The same with other arguments, called in between.
    """
    first = answers(now)
    answers(between)
    for name, second in answers(again).items():
        if not same_answers(first[name], second):
            raise InputError(
                what, [f"{name} gives {_shown(first[name])}, and {_shown(second)} for the same arguments later; {NOT_REPEATABLE}"]
            )
    return first


def same_answers(a: tuple[Any, ...] | str, b: tuple[Any, ...] | str) -> bool:
    """Whether two answers are the same to the last bit; not a number is the same as itself."""
    if isinstance(a, str) or isinstance(b, str):
        return a == b if isinstance(a, str) and isinstance(b, str) else False
    return len(a) == len(b) and all(type(x) is type(y) and _bits(x) == _bits(y) for x, y in zip(a, b, strict=True))


def _bits(value: Numeric) -> Any:
    return float(value).hex() if isinstance(value, (int, float)) else repr(value)


def _shown(answer: tuple[Any, ...] | str) -> str:
    if isinstance(answer, str):
        return answer
    return ", ".join(f"{x:.9g}" if isinstance(x, float) else repr(x) for x in answer)


def answers_of(model: Model) -> dict[str, tuple[Any, ...] | str]:
    """What a machine of single numbers answers at one instant, its equations made anew; `InputError` if not the same when asked again.

    Examples
    --------
    >>> import stickslip as ss
    >>> answers_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb"))["contact velocity"]
    (-0.0...,)
    """
    what, one, other = type(model).__name__, fresh_mechanics(model), fresh_mechanics(model)
    here, there = instants(model, one, 2)
    repeated = check_repeatable(what, calls(one, here), calls(one, there), calls(other, here))
    for check in (_check_continuous, _check_braking, _check_motions):
        try:
            check(what, one, (here, there))
        except InputError:
            raise
        except Exception:  # what a user's function raises is said where it is traced, or met by the judge
            continue
    return repeated


def _check_motions(what: str, m: Mechanics, points: Sequence[Arguments]) -> None:
    """`InputError` for prescribed motions whose velocity or acceleration is not the rate of what they give before."""
    still = (0.0,) * m.coordinates
    pairs = {
        "the acceleration of what a contact rubs on, or of a prescribed distance, is not the rate of its velocity": (
            m.offsets, m.offset_rates
        ),
        "the velocity of a prescribed distance is not the rate of its position": (
            lambda t: m.positions(t, points[0].q), lambda t: m.velocities(t, still)
        ),
    }  # fmt: skip
    for mistake, (values, rates) in pairs.items():
        if all(_differ(values, rates, at.t * (1 + _APART), at.t * (1 - _APART)) for at in points):
            raise InputError(
                what, [f"{mistake}; allowed are position(t), velocity(t) and acceleration(t) of one motion; override all three"]
            )


def _differ(values: Callable[[float], Any], rates: Callable[[float], Any], later: float, earlier: float) -> bool:
    """Whether rates are other ones than the differences of values next to an instant say, for one of them."""
    steps = [(b - a) / (later - earlier) for a, b in zip(values(earlier), values(later), strict=True)]
    given = [0.5 * (a + b) for a, b in zip(rates(earlier), rates(later), strict=True)]
    return any(abs(a - b) > 0.01 * max(abs(a), abs(b)) for a, b in zip(steps, given, strict=True))


def _check_continuous(what: str, m: Mechanics, points: Sequence[Arguments]) -> None:
    """`InputError` for functions that jump wherever they are asked: noise that is stored by its arguments, so that it is the same again."""
    names = set(calls(m, points[0]))
    for at in points:
        now, near = answers(calls(m, at)), answers(calls(m, at.aside(_NEAR)))
        names = {name for name in names if _jumps(now[name], near[name])}
    for name in sorted(names):
        raise InputError(what, [f"{name} jumps from each instant to the next one, as noise does; {NOT_REPEATABLE}"])


def _jumps(a: tuple[Any, ...] | str, b: tuple[Any, ...] | str) -> bool:
    """Whether two answers of next to the same arguments differ by more than a part of themselves."""
    if isinstance(a, str) or isinstance(b, str) or len(a) != len(b):
        return False
    numbers = [(x, y) for x, y in zip(a, b, strict=True) if isinstance(x, float) and isinstance(y, float)]
    return any(abs(x - y) > _JUMP * max(abs(x), abs(y)) for x, y in numbers)


_APART = 1e-5  # of an instant: over which differences are taken
_NEAR, _JUMP = 1e-10, 1e-3  # of time and velocities; of the answers


def _check_braking(what: str, m: Mechanics, points: Sequence[Arguments]) -> None:
    """`InputError` where friction accelerates other coordinates than its contact is on, or otherwise than their masses say."""
    if m.joined:
        return  # its equations are made here, and no function of the user's says what friction does
    at = points[0]
    without = m.accelerations(at.t, at.q, at.u, (0.0,) * len(at.forces), at.controlled)
    if len(m.contacts) > _MANY and not _misbraked(m, at, at.forces, without):
        return  # the forces are drawn at random, so that no two mistakes cancel
    for i, name in enumerate(m.contacts):
        one = tuple(force if k == i else 0.0 for k, force in enumerate(at.forces))
        for c, changed, wanted in _misbraked(m, at, one, without):
            of = "friction" if len(m.contacts) == 1 else f"friction at {name!r}"
            mistake = f"{of} of {one[i]:.6g} N changes the acceleration of coordinate {c} by {changed:.6g} m/s^2"
            allowed = f"allowed is -R/mass, {wanted:.6g}, on what the contact is on, and nothing elsewhere"
            raise InputError(what, [f"{mistake}; {allowed}; {_BRAKING}"])


def _misbraked(m: Mechanics, at: Arguments, forces: Sequence[float], without: Sequence[float]) -> list[tuple[int, float, float]]:
    """The coordinates that friction accelerates otherwise than it should: number, change of the acceleration, and what it should be."""
    wanted = [0.0] * len(without)
    for row, force in zip(m.directions, forces, strict=True):
        if force:
            wanted = [w if g == 0.0 else w - g * force / mass for w, g, mass in zip(wanted, row, m.masses, strict=True)]
    now = m.accelerations(at.t, at.q, at.u, forces, at.controlled)
    return [
        (c, a - b, w)
        for c, (a, b, w) in enumerate(zip(now, without, wanted, strict=True))
        if abs(a - b - w) > _ROUNDED * (abs(a) + abs(b) + abs(w))
    ]


_MANY = 16  # contacts that are asked one by one
_BRAKING = (
    "give the mass that it moves (total_mass), or write the system as an ss.SwitchingFlow with contacts={...} of ss.machines.FlowContact"
)
_ROUNDED = 1e-9  # of the accelerations
