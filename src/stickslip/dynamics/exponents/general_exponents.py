"""Lyapunov exponents of any map and of any flow: QR along the orbit, with a record of how they converge and an error.

The derivative may be given; else the function's own lines are called with numbers that carry their slopes, so write it with
`stickslip.maths` (or plain arithmetic).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.arguments import described_as, explains_arguments
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import Ending, interruptible, look, looking, partial_result
from stickslip.basics.notebook_display import Drawn, rounded, with_error
from stickslip.dynamics.exponents.growing_frames import compiled_flow, grown, growth_along, orbit_of_map, stretches_of
from stickslip.dynamics.flows.flow_stretches import needs_flow
from stickslip.solvers.flow_engine import unknown
from stickslip.solvers.plain.user_functions import coordinates_of_map, of_state

_LEAST = 10  # parts of a motion over which an interrupted average is taken at least
_SHOWN = 200  # points of the record of how they converge, at most
STRETCHES = 20  # of which the scatter of the means gives the error


@described_as("exponents; type for example ss.lyapunov(robot)")
@sealed
class Lyapunov(Drawn):
    """Lyapunov exponents with their errors and convergence.

    Parameters
    ----------
    spectrum : array (n,)
        The exponents, the largest first, natural logarithm per `unit`. -inf: perturbations in that direction vanish in finite time.
    errors : array (n,)
        Standard errors, from the scatter of the means of long stretches.
    record : array (m, 1 + n)
        How they converged: time so far (in units) and the exponents until then.
    unit : str
        Unit of time: "drive period", "second", "iteration" or "time".
    steps : int
        Number of units that they were averaged over.
    note : str
        Remarks.
    method : str
        By what the motion was followed, where there is a choice: "compiled", or "plain Python" with why.

    Examples
    --------
    >>> l = lyapunov_of_map(lambda x: (0.5 * x[0],), [1.0], iterations=100)
    >>> round(l.largest, 6), l.chaotic, l.record.shape
    (-0.693147, False, (100, 2))
    """

    spectrum: Array
    errors: Array
    record: Array
    unit: str
    steps: float
    note: str = ""
    method: str = ""

    @property
    def largest(self) -> float:
        """The largest exponent."""
        return float(self.spectrum[0])

    @property
    def error(self) -> float:
        """Standard error of the largest exponent."""
        return float(self.errors[0])

    @property
    def chaotic(self) -> bool:
        """Whether the largest exponent is positive by more than three of its errors (and not by rounding)."""
        return bool(self.largest > max(3 * self.error, 1e-6) and np.isfinite(self.largest))

    @property
    def dimension(self) -> float:
        """Kaplan-Yorke dimension of the attractor."""
        total = 0.0
        for k, exponent in enumerate(self.spectrum):
            if total + exponent < 0:
                return float(k + (total / abs(exponent) if np.isfinite(exponent) else 0.0))
            total += float(exponent)
        return float(len(self.spectrum))

    _drawn_by = "convergence"

    @property
    def rounded(self) -> str:
        """The exponents with their standard errors, rounded accordingly."""
        known = zip(self.spectrum.tolist(), self.errors.tolist(), strict=True)
        return ", ".join(f"{rounded(a, e)} ± {e:.1g}" if np.isfinite(a) else "−∞" for a, e in known) + f" per {self.unit}"

    def _facts(self) -> dict[str, Any]:
        known = {"exponents": self.rounded, "averaged over": f"{self.steps:g} {self.unit}s"}
        return known | ({"method": self.method} if self.method else {})

    def _remarks(self) -> list[str]:
        return [self.note] if self.note else []

    def __repr__(self) -> str:
        listed = ", ".join(with_error(a, e) for a, e in zip(self.spectrum.tolist(), self.errors.tolist(), strict=True))
        return f"<Lyapunov: {listed} per {self.unit}, over {self.steps:g}{'; ' + self.note if self.note else ''}>"


def error_of_mean(samples: Array, stretches: int = STRETCHES) -> Array:
    """Standard error of the mean of correlated samples (n, ...): from the means of long stretches, at least `stretches` of them."""
    length = max(len(samples) // stretches, 1)
    count = len(samples) // length
    means = samples[: count * length].reshape(count, length, *samples.shape[1:]).mean(axis=1)
    with np.errstate(invalid="ignore"):  # of -inf it is not known
        return means.std(axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.full(samples.shape[1:], np.inf)


def gathered(logs: Array, time: float, unit: str) -> Lyapunov:
    """The result from the growth in every stretch of length `time`: array (n, exponents)."""
    order = np.argsort(-logs.mean(axis=0), kind="stable")
    logs = logs[:, order]
    count = np.arange(1, len(logs) + 1)
    shown = np.unique(np.linspace(0, len(logs) - 1, min(_SHOWN, len(logs))).astype(int))
    means = np.cumsum(logs, axis=0)[shown] / (count[shown] * time)[:, None]
    record = np.column_stack([count[shown] * time, means])
    return Lyapunov(means[-1], error_of_mean(logs) / time, record, unit, len(logs) * time)


def _checked(what: str, x0: ArrayLike, whole: dict[str, Any], **numbers: tuple[Any, bool]) -> Array:
    """The start; an error that says everything that is wrong. Of each number: its value, and whether it may be 0."""
    problems = Problems(what)
    x = np.atleast_1d(floats(x0))
    if x.ndim != 1 or not len(x) or not np.isfinite(x).all():
        problems.add(f"x0 = {x0!r}; allowed is a list of finite numbers, one for each coordinate")
    for name, value in whole.items():
        problems.whole(name, value, 0 if name == "settle" else 1, example=1000)
    for name, (value, zero) in numbers.items():
        number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool) and np.isfinite(value)
        if not number or value < 0 or (value == 0 and not zero):
            problems.add(f"{name} = {value!r}; allowed is a {'finite number from 0' if zero else 'positive finite number'}")
    problems.check()
    return x


@explains_arguments
@interruptible
def lyapunov_of_map(
    f: Callable[..., Any], x0: ArrayLike, *, iterations: int = 20_000, settle: int = 1000, jacobian: Callable[[Any], Any] | None = None
) -> Lyapunov:
    """Lyapunov exponents of a map x -> f(x), per iteration.

    Parameters
    ----------
    f : callable
        Takes a list of numbers, returns as many. Written in plain arithmetic and with `stickslip.maths` it is compiled, with what it
        asks by ``if``; else it is iterated by plain Python, and `method` says why.
    x0 : sequence of float
        Where to begin.
    iterations, settle : int
        Numbers of iterations to average over, and to discard before.
    jacobian : callable, optional
        The Jacobian matrix of f at x, with which f may be any Python; if not given, it follows from f.

    Returns
    -------
    Lyapunov

    Examples
    --------
    >>> henon = lambda x: (1 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0])
    >>> l = lyapunov_of_map(henon, [0.1, 0.1], iterations=5000)
    >>> round(float(l.spectrum.sum()), 6), l.chaotic  # the sum is ln 0.3
    (-1.203973, True)
    """
    x = _checked("lyapunov_of_map", x0, dict(iterations=iterations, settle=settle))
    if not callable(f):
        raise InputError("lyapunov_of_map", [f"f = {f!r}; allowed is a function that takes a list of numbers and returns as many"])
    coordinates_of_map(f, x)  # which says what is wrong with f
    motion = orbit_of_map(f, x, jacobian)
    motion.settled(settle)
    logs, done, ending = _collected(growth_along(motion, int(iterations)), (int(iterations), len(x)))
    if not np.isfinite(motion.x).all():
        raise InputError("lyapunov_of_map", [f"the map diverges from x0 = {x0!r}; give a start on its attractor"])
    return replace(_noted(logs, done, 1.0, "iteration", ending), method=motion.method)


def _collected(parts: Iterable[Array], shape: tuple[int, int]) -> tuple[Array, int, Ending]:
    """Growth in parts of a motion as one array, how much of it is there, and whether it was interrupted."""
    logs, done = np.empty(shape), 0
    with partial_result() as ending:
        for part in parts:
            logs[done : done + len(part)] = part
            done += len(part)
    return logs, done, ending


def _noted(logs: Array, done: int, every: float, unit: str, ending: Ending) -> Lyapunov:
    """The exponents of as many parts of a motion as were done, which a note says after an interruption."""
    ending.needs(done >= min(_LEAST, len(logs)))
    exponents = gathered(logs[:done], every, unit)
    return (
        replace(exponents, note=ending.note(f"averages over {done} of {len(logs)} parts of the motion"))
        if ending.interrupted
        else exponents
    )


_ENGINE = 1e-9  # a tolerance that steps which are exact to rounding do not read
_MOST = 1e8  # parts of a run in which growth is measured


@explains_arguments
@interruptible
def lyapunov_of_flow(
    f: Callable[..., Any],
    x0: ArrayLike,
    *,
    duration: float = 500.0,
    settle: float = 50.0,
    every: float = 0.5,
    jacobian: Callable[..., Any] | None = None,
    rtol: float = 1e-9,
    mode: int = 0,
) -> Lyapunov:
    """Lyapunov exponents of a flow x' = f(x), smooth or switching, per unit of time.

    Parameters
    ----------
    f : callable or SwitchingFlow
        Takes a list of numbers, returns their rates, in plain arithmetic and with `stickslip.maths`. A `SwitchingFlow` has a saltation
        matrix at every switch.
    x0 : sequence of float
        Where to begin.
    duration, settle : float
        Time to average over, and to discard before.
    every : float
        Time between two orthonormalisations.
    jacobian : callable, optional
        The Jacobian matrix of f at x, with which f may be any Python; if not given, it follows from f.
    rtol : float
        Tolerance of SciPy's integrator, which follows what cannot be called with symbols (`method` says why); the engine's steps are exact
        to rounding.
    mode : int
        Initial mode of a `SwitchingFlow`.

    Returns
    -------
    Lyapunov

    Raises
    ------
    InputError
        If the solution diverges before the end.

    Examples
    --------
    >>> damped = lambda x: (x[1], -x[0] - 0.2 * x[1])
    >>> lyapunov_of_flow(damped, [1.0, 0.0], duration=100.0).spectrum.round(3).tolist()  # the real parts of the eigenvalues
    [-0.1, -0.1]
    """
    x = _checked("lyapunov_of_flow", x0, {}, duration=(duration, False), every=(every, False), settle=(settle, True), rtol=(rtol, False))
    if not callable(f):
        needs_flow("lyapunov_of_flow", f, f"f = {f!r}; allowed is a function that gives the rates of a list of numbers, or a SwitchingFlow")
        return _of_stretches(f, x, mode, unknown(f, len(x)), duration=duration, settle=settle, every=every, rtol=rtol)
    if not np.isfinite(coordinates_of_map(f, x)).all():
        raise InputError("lyapunov_of_flow", [f"f gave {coordinates_of_map(f, x).tolist()} at x0 = {x0!r}; allowed are finite rates"])
    if not duration / every <= _MOST:
        raise InputError("lyapunov_of_flow", [f"every = {every!r} makes {duration / every:.3g} parts of duration; allowed are {_MOST:.0e}"])
    flow, why = compiled_flow(f, len(x), jacobian is not None)
    if flow is not None:
        try:
            exponents = _of_stretches(flow, x, 0, "", duration=duration, settle=settle, every=every, rtol=_ENGINE)
        except SolveError as error:
            why = str(error)
        else:
            if not np.isnan(exponents.spectrum).any():
                return exponents
            why = "it touches the zero of a condition"
    slope, count = jacobian or (lambda x: of_state(f, x)[1]), max(int(duration / every), 1)
    parts = _plain_stretches(f, slope, x0, count=count, settle=settle, every=every, rtol=rtol)
    logs, done, ending = _collected(parts, (count, len(x)))
    return replace(_noted(logs, done, every, "unit of time", ending), method=_by_scipy(why))


def _plain_stretches(
    f: Callable[..., Any], slope: Callable[..., Any], x0: ArrayLike, *, count: int, settle: float, every: float, rtol: float
) -> Iterator[Array]:
    """Logarithms of the growth in stretches of a flow that SciPy's integrator follows with a frame: arrays (1, n), `count` in all."""
    x = np.atleast_1d(floats(x0))
    n, Q = len(x), np.eye(len(x))

    def rates(t: float, y: Array) -> Array:
        return np.concatenate([coordinates_of_map(f, y[:n]), (np.asarray(slope(y[:n]), float) @ y[n:].reshape(n, n)).ravel()])

    if settle > 0:
        x = _followed(lambda t, y: coordinates_of_map(f, y), x, settle, rtol, 0.0, x0)
    for done in range(count):
        look()
        end = _followed(rates, np.concatenate([x, Q.ravel()]), every, rtol, max(settle, 0.0) + done * every, x0)
        x = end[:n]
        Q, log = grown(end[n:].reshape(n, n), np.eye(n))
        yield log[None]


def _by_scipy(why: str) -> str:
    return f"SciPy's DOP853 on plain Python: {why}"


def _of_stretches(flow: Any, x: Array, mode: Any, why: str, *, duration: float, settle: float, every: float, rtol: float) -> Lyapunov:
    """The exponents of a flow from the growth in its stretches; `why` says why the engine cannot follow it, if that is so."""
    every = float(flow.period or every)
    count = max(int(duration / every), 1)
    parts = stretches_of(flow, x, mode, count=count, settle=int(np.ceil(max(settle, 0.0) / every)), every=every, rtol=rtol)
    logs, done, ending = _collected(parts, (count, len(x) - len(flow.drifts.free)))
    return replace(_noted(logs, done, every, "unit of time", ending), method=_by_scipy(why) if why else "compiled")


def _followed(rates: Callable[[float, Array], Array], y: Array, time: float, rtol: float, since: float, x0: ArrayLike) -> Array:
    """The state of a flow after some time; `since` and `x0` say in a message where it came from."""
    from scipy.integrate import solve_ivp

    with np.errstate(over="ignore", invalid="ignore"):
        done = solve_ivp(looking(rates), (0.0, time), y, method="DOP853", rtol=rtol, atol=rtol)
    end: Array = done.y[:, -1]
    if done.status != 0 or not np.isfinite(end).all():
        mistake = f"the flow diverges at t = {since + done.t[-1]:.6g} from x0 = {x0!r}: {done.message}"
        raise InputError("lyapunov_of_flow", [f"{mistake} Give a start on its attractor, or a shorter settle and duration"])
    return end
