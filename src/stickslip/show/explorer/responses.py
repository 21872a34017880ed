"""Responses to a page: curves with the figures of merit, or maps around them; cancelled when a newer request supersedes them."""

from __future__ import annotations

import contextlib
import functools
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.analysis.motion import motion
from stickslip.analysis.steady import mean_velocity
from stickslip.basics.errors import InputError, StickslipError, without_advice
from stickslip.engine.remembered import Remembered
from stickslip.models.friction.law_adapter import law_of
from stickslip.show.explorer.chaos import exponent_of
from stickslip.show.explorer.code import python
from stickslip.show.explorer.effort import RTOL, affordable
from stickslip.show.explorer.frames import encoded
from stickslip.show.explorer.kernels import Kernels, compiling
from stickslip.show.explorer.machines import FIRST, LOOSE, OF_A_ROBOT, PLAIN, Shown, picture
from stickslip.show.explorer.models import FRICTION
from stickslip.show.explorer.requests import IsCancelled, Message, State, Stopped
from stickslip.show.explorer.surroundings import map_of, strip_of
from stickslip.solvers import solve

#: Drive periods of a run while a slider moves, and after its release.
COARSE, FINE = 40, 200
SAMPLES, LONGEST = 256, 8
#: Longest processor time of a run for the first picture [s].
AT_ONCE = 3.0
_first: Remembered[Any] = Remembered(most=8)


def sooner(asked: Message, kernels: Kernels, stop: IsCancelled) -> bytes | None:
    """Curves of the set-valued laws alone, where a law with inner states takes longer to solve without its kernel; None elsewhere."""
    if asked.channel != "curves" or asked.wish is not None or asked.machine is not None:
        return None
    with contextlib.suppress(StickslipError):  # the whole response reports the error
        waits = [law for law in asked.state.laws if not kernels.ready(asked.state, law, asked.state.robot(law), False)]
        if 0 < sum(_is_dynamic(asked.state, law) for law in waits) < len(asked.state.laws):
            return answer(asked, kernels, stop, dynamic=False)
    return None


def _is_dynamic(state: State, law: str) -> bool:
    return bool(law_of(state.robot(law)).dynamic)


def answer(asked: Message, kernels: Kernels, stop: IsCancelled, shown: Shown | None = None, dynamic: bool = True) -> bytes:
    """The response to a request, where `shown` is the server's machine; errors in the numbers also give a response.

    Without `dynamic` no law with inner states is solved whose kernel is not ready.
    """
    head = {"channel": asked.channel, "id": asked.id}
    response: tuple[dict[str, Any], dict[str, Any]]
    try:
        if asked.wish is not None:
            from stickslip.show.explorer.faster import faster_of

            response = faster_of(asked, kernels, stop, shown), {}
        elif asked.machine is not None:
            response = _machine(asked, kernels, stop, shown), {}
        else:
            of_laws = functools.partial(curves, dynamic=dynamic)
            channels: dict[str, Callable[..., Any]] = {"curves": of_laws, "map": map_of, "strip": strip_of, "exponent": exponent_of}
            response = channels[asked.channel](asked, kernels, stop)
    except InputError as error:
        response = {"kind": "problems", "problems": [without_advice(p) for p in error.problems]}, {}
    except StickslipError as error:
        response = {"kind": "problems", "problems": [str(error)]}, {}
    header, arrays = response
    return encoded({**head, **header}, arrays)


def _machine(asked: Message, kernels: Kernels, stop: IsCancelled, shown: Shown | None) -> dict[str, Any]:
    """The picture of the machine with the requested numbers."""
    if shown is None or asked.machine is None:
        raise InputError("machine", [OF_A_ROBOT])
    model = shown.with_values(asked.machine)
    if kernels.ready(shown, "", model, False):
        return picture(shown, asked.fine, model, _stopped_by(stop))
    waits = {"kind": "machine", "waits": f"preparing {shown.title}: compiled once, which takes some seconds, and kept for later"}
    return waits | (at_once(lambda tell: picture(shown, False, model, tell, first=True), stop) or {})


def _stopped_by(stop: IsCancelled | None) -> Callable[[int, int], None]:
    """The callback that ends a run when its result is no longer needed."""

    def tell(done: int, whole: int) -> None:
        if stop is not None and stop():
            raise Stopped

    return tell


# ---- the first picture, while a kernel is compiled ----
class TooLong(Exception):
    """The compiled kernel may well be ready first."""


def at_once(make: Callable[[Callable[[int, int], None]], Any], stop: IsCancelled) -> Any | None:
    """What can be made without a compiled kernel, by SciPy on plain Python; None if that takes too long, or fails.

    Parameters
    ----------
    make : callable
        Solves with the given progress callback.
    stop : callable
        Whether the result is no longer needed.
    """
    ends = time.thread_time() + AT_ONCE  # of its own: other programs may take the processor

    def tell(done: int, whole: int) -> None:
        if stop():
            raise Stopped
        if time.thread_time() > ends:
            raise TooLong

    try:
        return make(tell)
    except (TooLong, StickslipError):  # the compiled run reports the error
        return None


# ---- curves ----
def run_of(state: State, law: str, fine: bool, robot: Any = None, stop: IsCancelled | None = None) -> Any:
    """The run of one law, cancelled when its result is no longer needed."""
    made = state.robot(law) if robot is None else robot
    periods = affordable(made, FINE if fine else COARSE)
    return solve(made, periods=periods, rtol=RTOL, keep="trajectory", samples=400 if fine else 48, progress=_stopped_by(stop))


def _first_run(robot: Any, tell: Callable[[int, int], None]) -> Any:
    """A short run from rest by SciPy; None if less than three drive periods of it are finished in time."""
    run = solve(robot, periods=FIRST, rtol=LOOSE, method=PLAIN, keep="trajectory", progress=tell)
    return run if len(run.strobe_times) > 3 else None


def _once(robot: Any, tell: Callable[[int, int], None]) -> Any:
    """A short run of a robot, which the next response of the same robot draws again."""
    return _first(robot, lambda: _first_run(robot, tell))


def curves(asked: Message, kernels: Kernels, stop: IsCancelled, dynamic: bool = True) -> tuple[dict[str, Any], dict[str, Any]]:
    """The curves of all laws of the page, with the figures of merit of the first."""
    state, laws, runs = asked.state, [], {}
    for law in state.laws:
        entry: dict[str, Any] = {"name": law, "label": FRICTION[law].label}
        laws.append(entry)
        robot = state.robot(law)
        if not kernels.ready(state, law, robot, False):
            entry["waits"], slow = compiling(state, law), _is_dynamic(state, law)
            run = at_once(functools.partial(_once, robot), stop) if dynamic or not slow else None
        else:
            run = run_of(state, law, asked.fine, robot, stop)
        if stop():
            raise Stopped
        if run is not None:
            runs[law] = run
            entry["mean_velocity"] = _mean(run)
    header: dict[str, Any] = {"kind": "curves", "fine": asked.fine, "laws": laws, "period": float(robot.period), "samples": SAMPLES}
    header |= {"figures": None, "shown": 3, "once": 3}
    if state.law in runs:
        header["figures"] = _figures(runs[state.law])
        count = header["figures"]["period_number"] or LONGEST
        header |= {"once": min(count, LONGEST), "shown": 3 if count == 1 else min(2 * count, LONGEST)}
    arrays: dict[str, Any] = {}
    for law, run in runs.items():
        arrays |= {f"{law}.{name}": column for name, column in _columns(run, header["shown"], law == state.law).items()}
    if state.law in runs:
        header["figures"]["power"] = _power(runs[state.law], count, arrays)
    if asked.fine:
        header["python"] = python(state)
    return header, arrays


def _mean(run: Any) -> float | None:
    return None if len(run.strobe_times) < 3 else float(mean_velocity(run))


def _figures(run: Any) -> dict[str, Any]:
    """Figures of merit of a run."""
    if len(run.strobe_times) < 3:
        raise InputError("run", [f"{run.status} after {float(run.pieces.t[-1]):.4g} s, within the first periods"])
    m = motion(run)
    return {
        "mean_velocity": float(mean_velocity(run)), "motion_type": m.type, "pattern": m.pattern, "margin": m.margin,
        "period_number": m.period, "direction": m.direction, "stick_fraction": m.stick_fraction,
        "forward_fraction": m.forward_fraction, "backward_fraction": m.backward_fraction,
        "status": run.status, "periods": run.periods, "method": run.method, "notes": [without_advice(note) for note in run.notes],
        "steadiness": run.steadiness.word,
    }  # fmt: skip


def _power(run: Any, count: int, arrays: dict[str, Any]) -> float:
    """Mean power of the actuator in the steady motion [W]: dissipation by friction minus the power of gravity."""
    law = next(name for name in arrays if name.endswith(".mode")).partition(".")[0]
    last = slice(-(SAMPLES * count + 1), None)
    t, v, R = (arrays[f"{law}.{name}"][last] for name in ("t", "v", "R"))
    taken = np.trapezoid(R * v, t) / np.ptp(t)
    return float(taken - run.model.total_mass * run.model.track.along(run.model.gravity) * np.trapezoid(v, t) / np.ptp(t))


def _columns(run: Any, shown: int, main: bool) -> dict[str, Any]:
    """The columns that the page draws, over the last periods, with times from their start."""
    count = min(shown, len(run.strobe_times) - 1)
    end = float(run.strobe_times[-1])
    start = end - count * run.period_time
    at = run.at(np.clip(np.linspace(start, end, SAMPLES * count + 1), start, end))
    columns = {"t": at["t"] - start, "v": at["v"], "x": at["x"] - at["x"][0], "R": at["friction_force"]}
    if main:
        columns |= {"xi": at["xi"], "mode": at["mode"]}
    kept = min(max(len(run.strobe_times) - 1 - int(run.settle), 1), count)  # those of the curve: elsewhere its mean motion is not theirs
    drift, instants = float(at["x"][-1] - at["x"][0]) / (end - start), run.strobe_times[-kept:]
    return columns | {"strobe_s": run.strobe_x[-kept:] - at["x"][0] - drift * (instants - start), "strobe_v": run.strobe_v[-kept:]}
