"""User-defined columns of a batch: a function of the state, and its reduction over the motion period."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fingerprints import fingerprint

#: Reductions of a function of the state over the last motion period, in words.
REDUCTIONS = {"mean": "mean", "integral": "integral over time", "min": "smallest value", "max": "largest value", "last": "value at the end"}


@dataclass(frozen=True, eq=False)
class Observable:
    """A function of the state and its reduction over the last motion period; made by `observable`.

    Parameters
    ----------
    function : callable
        Function of the state, called with symbols.
    reduce : str
        One of `REDUCTIONS`.
    unit : str
        Unit of the result.

    Examples
    --------
    >>> Observable(lambda s: s.v, "max", "m/s").meaning
    'largest value over the last motion period of an observable'
    """

    function: Callable[[Any], Any]
    reduce: str
    unit: str

    @property
    def meaning(self) -> str:
        """Meaning of the column."""
        name = getattr(self.function, "__name__", "<lambda>")
        return f"{REDUCTIONS[self.reduce]} over the last motion period of {'an observable' if name == '<lambda>' else name}"

    @property
    def fingerprint(self) -> str:
        """An identifier that is the same in every process for the same function, from its code and everything to which it refers."""
        return f"{self.reduce} [{self.unit}] {fingerprint(self.function).digest[:16]}"


@dataclass(frozen=True, eq=False)
class Derived:
    """A column that is computed from the machines of a sweep after they are solved; made by `stickslip.optimisation.derivative`.

    Parameters
    ----------
    of, by : str or Observable, str
        The differentiated column, and the number with respect to which it is differentiated.
    unit : str or None
        Unit of the result; None for the unit of `of` divided by that of the number.
    values : callable
        Function that returns columns of a batch, given the batch, its number of cases, the requested columns (by name) and the number of
        transient periods.
    """

    of: Any
    by: str
    unit: str | None
    values: Callable[[Any, int, dict[str, Derived], int], dict[str, Any]]

    @property
    def meaning(self) -> str:
        """Meaning of the column."""
        return f"derivative of {getattr(self.of, 'meaning', self.of)} by {self.by}, of the steady motion from rest"

    @property
    def fingerprint(self) -> str:
        """An identifier that is the same in every process for the same derivative."""
        return f"derivative of {getattr(self.of, 'fingerprint', self.of)} by {self.by} [{self.unit}]"


def observable(function: Callable[[Any], Any], reduce: str = "mean", unit: str = "1") -> Observable:
    """A column of your own for `sweep`, `map` and batches of `solve`: ``observe={"name": observable(...)}``.

    Parameters
    ----------
    function : callable
        The observed quantity, as a function of a state ``s``: ``s.t``, ``s.x``, ``s.v``, ``s.acceleration`` of the body, ``s.slip``,
        ``s.load``, ``s.friction_force``, ``s.z`` of the contact, and ``s.model`` with its numbers. For a machine that lists parts these are
        tuples in its order, and ``s.bodies[name].v``, ``s.contacts[name].slip`` are those of one. It is called once, with symbols: write it
        with + - * / ** and the functions of `stickslip.maths`, without ``if``. Its own conditions (``where``, ``abs``) are not events: if
        one changes within a step, the mean is accurate only to a fraction of that step.
    reduce : {"mean", "integral", "min", "max", "last"}
        Its reduction over the last motion period (the last drive period if none was found).
    unit : str
        Unit of the result.

    Returns
    -------
    Observable

    Raises
    ------
    InputError
        If an argument has the wrong type. A function that cannot be traced is refused where it is used.

    Examples
    --------
    >>> import stickslip as ss
    >>> square = ss.observable(lambda s: s.v**2, reduce="mean", unit="m^2/s^2")
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=1.7, law="coulomb", observe={"v_square": square})
    >>> (1e6 * grid.v_square.values).round(3).tolist(), grid.v_square.attrs["units"]
    ([0.037, 51.602], 'm^2/s^2')
    """
    problems = Problems("observable")
    if not callable(function):
        problems.add(f"function = {function!r}; allowed is a function of the state; type for example lambda s: s.v**2")
    if not (isinstance(reduce, str) and reduce in REDUCTIONS):
        problems.add(f"reduce = {reduce!r}; allowed is one of {', '.join(REDUCTIONS)}")
    if not isinstance(unit, str):
        problems.add(f'unit = {unit!r}; allowed is text; type for example unit="m/s"')
    problems.check()
    return Observable(function, reduce, unit)


def by_time_of_computation(observe: Any) -> tuple[dict[str, Observable], dict[str, Derived]]:
    """Columns that are observed during the run, and those that are computed afterwards."""
    observe = observe or {}
    derived = {name: each for name, each in observe.items() if isinstance(each, Derived)}
    return {name: each for name, each in observe.items() if name not in derived}, derived


def checked_observables(what: str, observe: Any, taken: Any = (), derived: bool = False) -> tuple[tuple[str, Any], ...]:
    """Observables by name, and derivatives if they are allowed; `InputError` if one is of another type, or has a name that is taken.

    Examples
    --------
    >>> checked_observables("sweep", {"square": observable(lambda s: s.v**2)})[0][0]
    'square'
    """
    if observe is None:
        return ()
    if not isinstance(observe, dict):
        raise InputError(what, [f"observe = {observe!r}; allowed is a dict; type for example observe=dict(square=ss.observable(...))"])
    problems = Problems(what)
    for name, each in observe.items():
        if not (isinstance(name, str) and name.isidentifier()) or name in taken:
            problems.add(f"observe has {name!r}; allowed is a name of letters that no column and no axis has")
        if isinstance(each, Derived) and not derived:
            problems.add(f"observe[{name!r}] is a derivative: a column of sweeps and maps; type ss.optimisation.gradient(robot)")
        elif not isinstance(each, Observable | Derived):
            problems.add(f"observe[{name!r}] = {each!r}; type ss.observable(lambda s: s.v**2) for one")
    problems.check()
    return tuple(observe.items())
