"""The methods of `solve` as objects: their names, the machines that they accept, and how they run them.

A method decides by the equations, never by a class: `accepts` gives None, or the reason in words. The first that accepts runs; if none
does, the error has what each of them said.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.engine.refused import refusal_of
from stickslip.engine.remembered import Remembered
from stickslip.engine.tableaux import TABLEAUX
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of

if TYPE_CHECKING:
    from stickslip.engine.lanes import AnySteps
    from stickslip.engine.several_series import SeveralSeries
    from stickslip.engine.slaved import Series
    from stickslip.engine.tableaux import Tableau
    from stickslip.results.summary import Summary
    from stickslip.results.trajectory import Trajectory
    from stickslip.solvers.settings import Request


class Method(Protocol):
    """The interface of a method."""

    @property
    def title(self) -> str:
        """Its name in words."""

    @property
    def names(self) -> tuple[str, ...]:
        """The values of ``method=`` that select it."""

    @property
    def observes(self) -> bool:
        """Whether it evaluates a user's functions of the state on the way."""

    @property
    def pauses(self) -> bool:
        """Whether it can stop at any instant, and go on from there with other numbers."""

    def accepts(self, model: Model) -> str | None:
        """None where it solves a machine, or all of a batch; else why not."""

    def run(self, todo: Request) -> Trajectory | Summary:
        """Solve as asked, one case or many."""


class Stepping(Protocol):
    """Base class of the methods that step cases side by side."""

    def steps(self, todo: Request) -> tuple[AnySteps, float]:
        """The steps that a request takes (None: Taylor steps of set-valued laws), and the tolerance to which they are held."""

    def run(self, todo: Request) -> Trajectory | Summary:
        """Step by step."""
        from stickslip.solvers import stepping

        return stepping.run(todo, *self.steps(todo))


def _of_laws(model: Model, dynamic: bool) -> str | None:
    """Why a compiled method for laws of one sort does not take a machine."""
    machine = machine_of(model)
    if not all(law.compiles for law in machine.laws):
        return f"it is compiled, and {machine.law_names} is written for plain numbers only"
    if machine.has_inner_states != dynamic:
        kinds = ("set-valued laws", "laws with inner states")
        is_one = "has inner states" if machine.has_inner_states else "is set-valued"
        return f"it is for {kinds[dynamic]}; {machine.law_names} {is_one}"
    return refusal_of(machine) or None


@dataclass(frozen=True)
class ClosedArcs:
    """Coulomb friction under one sine: every arc is a formula."""

    title: str = "closed arcs"
    names: tuple[str, ...] = ("auto", "exact")
    observes: bool = False
    pauses: bool = False

    def accepts(self, model: Model) -> str | None:
        """By the traced equations, which are taken apart into a sine and constants."""
        from stickslip.solvers.closed_arcs import handles

        return handles(model)

    def run(self, todo: Request) -> Trajectory | Summary:
        """Arc by arc."""
        from stickslip.solvers import set_valued as exact

        return exact.solve(todo)


@dataclass(frozen=True)
class LocalSteps:
    """Rows of many bodies under set-valued laws: Taylor steps of what moves together, from event to event."""

    title: str = "local Taylor steps"
    names: tuple[str, ...] = ("auto", "exact")
    observes: bool = False
    pauses: bool = False

    def accepts(self, model: Model) -> str | None:
        """By how many contacts there are, and what their forces are made of."""
        from stickslip.solvers.local_steps import lacks

        return lacks(model)

    def run(self, todo: Request) -> Trajectory | Summary:
        """From event to event."""
        from stickslip.solvers import local_steps

        return local_steps.run(todo)


@dataclass(frozen=True)
class TaylorSteps(Stepping):
    """Every other set-valued law, and machines of several bodies: polynomials of order 16, exact to rounding."""

    title: str = "Taylor steps"
    names: tuple[str, ...] = ("auto", "exact")
    observes: bool = True
    pauses: bool = True

    def accepts(self, model: Model) -> str | None:
        """Laws that rest exactly."""
        return _of_laws(model, dynamic=False)

    def steps(self, todo: Request) -> tuple[None, float]:
        """Those of set-valued laws, to the zeros of the guards."""
        from stickslip.solvers.set_valued import REPEAT

        return None, min(REPEAT / 10, todo.rtol) if todo.auto else REPEAT / 10


@dataclass(frozen=True)
class Rosenbrock(Stepping):
    """Laws with inner states, which are stiff: those of `TABLEAUX`, by tolerance unless one is named."""

    title: str = "Rosenbrock steps"
    names: tuple[str, ...] = ("auto", *TABLEAUX)
    observes: bool = True
    pauses: bool = True

    def accepts(self, model: Model) -> str | None:
        """Laws with inner states."""
        return _of_laws(model, dynamic=True)

    def steps(self, todo: Request) -> tuple[Tableau, float]:
        """The tableau that is asked for, or the one that is cheaper."""
        from stickslip.solvers.rosenbrock import SAFETY, tableau

        return TABLEAUX.get(todo.method) or tableau(todo.model, todo.rtol), SAFETY * todo.rtol


@dataclass(frozen=True)
class TaylorSeries(Stepping):
    """One body on one contact under a law with one inner state: series of order 8, 12 or 18, on the slow manifold while it slips."""

    title: str = "Taylor series"
    names: tuple[str, ...] = ("auto", "taylor")
    observes: bool = False
    pauses: bool = True

    def accepts(self, model: Model) -> str | None:
        """Laws whose inner state relaxes with a rate that grows with the velocity, asked of the traced equations."""
        from stickslip.solvers.series import series_refusal

        return _of_laws(model, dynamic=True) or series_refusal(model)

    def steps(self, todo: Request) -> tuple[Series, float]:
        """The series of the order that the tolerance asks for."""
        from stickslip.solvers import series

        return series.method(todo.rtol)


@dataclass(frozen=True)
class SeriesOfSeveralStates(Stepping):
    """Laws whose inner states are bounded in how fast they relax, such as generalised Maxwell slip: explicit series of all states.

    Cases in which they are fast beside the period go by Rosenbrock steps, each by its own numbers.
    """

    title: str = "Taylor series of several states"
    names: tuple[str, ...] = ("auto", "taylor")
    observes: bool = True
    pauses: bool = True

    def accepts(self, model: Model) -> str | None:
        """Laws whose rates are affine in the inner states, asked of the traced equations."""
        from stickslip.solvers.series import swings_of

        why = _of_laws(model, dynamic=True) or swings_of(model)
        return why if isinstance(why, str) else None

    def steps(self, todo: Request) -> tuple[SeveralSeries | Tableau, float]:
        """The series of the order that the tolerance asks for, if they suit all cases."""
        from stickslip.solvers import series

        every = todo.method == "taylor" or series.smooth_cases(todo).all()
        return series.method_of_several(todo.rtol) if every else Rosenbrock().steps(todo)

    def run(self, todo: Request) -> Trajectory | Summary:
        """Step by step, each case by the steps that suit it."""
        from stickslip.solvers import series, stepping

        one, other = series.method_of_several(todo.rtol), Rosenbrock().steps(todo)
        smooth = None if todo.method == "taylor" else series.smooth_cases(todo)
        if smooth is None or smooth.all():
            return stepping.run(todo, *one)
        if not smooth.any() or todo.watched is not None:
            return stepping.run(todo, *other)
        return stepping.run_of_two(todo, smooth, one, other)


@dataclass(frozen=True)
class RungeKutta:
    """The naive judge: steps of fixed length."""

    title: str = "Runge-Kutta steps"
    names: tuple[str, ...] = ("rk4",)
    observes: bool = False
    pauses: bool = False

    def accepts(self, model: Model) -> str | None:
        """One body on one contact, of what a plain script knows."""
        why = _of_laws(model, dynamic=machine_of(model).has_inner_states)
        if why is not None:
            return why
        from stickslip.engine.fixed_steps import lacks
        from stickslip.engine.refused import refused
        from stickslip.engine.trace import trace

        return refused(model) or lacks(trace(model)) or None

    def run(self, todo: Request) -> Trajectory | Summary:
        """So many steps in each period."""
        from stickslip.solvers import rk4

        return rk4.solve(todo)


@dataclass(frozen=True)
class IndependentJudge:
    """SciPy's integrators on the machine in plain Python: slow, and nothing in it is ours."""

    title: str = "SciPy"
    names: tuple[str, ...] = ("auto", "radau", "lsoda", "bdf", "dop853")
    observes: bool = False
    pauses: bool = False

    def accepts(self, model: Model) -> str | None:
        """Everything."""
        return None

    def run(self, todo: Request) -> Trajectory | Summary:
        """Case by case."""
        from stickslip.solvers import plain

        return plain.solve(todo)


@dataclass(frozen=True)
class SwitchedSteps:
    """Flows that switch: Taylor steps from switch to switch, exact to rounding."""

    title: str = "Taylor steps of flows"
    names: tuple[str, ...] = ("auto", "exact")
    observes: bool = False
    pauses: bool = True

    def accepts(self, model: Model) -> str | None:
        """What declares fields and switches."""
        return None

    def run(self, todo: Request) -> Trajectory | Summary:
        """Case by case."""
        from stickslip.solvers import switched_steps

        return switched_steps.run(todo)


_BLIND = "it evaluates no functions of the state: observe is for the compiled methods"
_ENDLESS = "it does not pause between two steps of a caller's"
#: In the order in which they are asked.
ALL: tuple[Method, ...] = (
    ClosedArcs(),
    LocalSteps(),
    *(_STEPPING := (TaylorSteps(), TaylorSeries(), SeriesOfSeveralStates(), Rosenbrock())),
    *(_ALONE := (RungeKutta(), IndependentJudge())),
)
_OF_FLOWS = SwitchedSteps()
#: Names for `method=`; "auto" takes the exact solver for set-valued laws, else Taylor series where they know the law, or Rodas4 or
#: Rodas5P by tolerance.
METHODS = tuple(dict.fromkeys(name for method in ALL for name in method.names))
#: Names of those that solve one case after the other.
SLOW = tuple(name for method in _ALONE for name in method.names if name != "auto")


def takes_closed_arcs(name: str, model: Model) -> bool:
    """Whether a method of this name solves a machine by closed arcs."""
    return name in ClosedArcs.names and ClosedArcs().accepts(model) is None


def steps_of(todo: Request) -> tuple[AnySteps, float]:
    """The steps that a request takes which is not for closed arcs, and the tolerance to which they are held."""
    return next(each.steps(todo) for each in _STEPPING if todo.method in each.names and _refusal(each, todo.model) is None)


_refusals: Remembered[str | None] = Remembered()


def _refusal(method: Method, model: Model) -> str | None:
    """The answer of `accepts`; for methods whose text depends on the kind it depends on the kind only, and is cached."""
    if isinstance(method, (ClosedArcs, LocalSteps, IndependentJudge, SwitchedSteps)):
        return method.accepts(model)
    from stickslip.engine.kinds import known_kind

    return _refusals((method.title, known_kind(model)), lambda: method.accepts(model))


def method_for(name: str, model: Model, observed: bool = False, pauses: bool = False) -> Method:
    """The first method of a name that takes a machine; `InputError` with what each says where none does.

    With `observed` it evaluates a user's functions of the state, with `pauses` it can stop at any instant.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)
    >>> type(method_for("auto", robot)).__name__, type(method_for("auto", robot.replace(friction=ss.Coulomb(0.15, 0.21)))).__name__
    ('TaylorSeries', 'ClosedArcs')
    """
    refusals = {}
    for method in ALL if adapter_of(model).has_bodies else (_OF_FLOWS,):
        if name in method.names:
            reason = _BLIND if observed and not method.observes else _ENDLESS if pauses and not method.pauses else _refusal(method, model)
            if reason is None:
                return method
            refusals[method.title] = reason.partition("; type method=")[0]
    if observed and all(reason == _BLIND for reason in refusals.values()):
        raise InputError("solve", [f'observe is for the compiled methods; method = {name!r} is none of them; type method="auto"'])
    reasons = "; ".join(f"{title}: {reason}" for title, reason in refusals.items())
    raise InputError("solve", [f'method = {name!r} does not solve this {type(model).__name__}; {reasons}; type method="auto"'])
