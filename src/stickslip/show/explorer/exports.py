"""Downloads: the figure, the columns, a study file, the Python code, a report."""

from __future__ import annotations

import io
import threading
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.show.explorer.code import python
from stickslip.show.explorer.models import FRICTION
from stickslip.show.explorer.requests import State
from stickslip.show.explorer.sliders import PARAMETERS

Export = tuple[str, Callable[[State], bytes]]
_drawing = threading.Lock()  # matplotlib's settings are global to the process
#: Drive periods in a table of columns.
PERIODS = 8


def _runs(state: State, laws: Iterable[str]) -> list[Any]:
    """Runs of full length."""
    from stickslip.show.explorer.responses import run_of

    return [run_of(state, law, True) for law in laws]


def _figure(kind: str, state: State) -> bytes:
    return drawn(_runs(state, state.laws), [FRICTION[law].label for law in state.laws], kind)


def drawn(runs: list[Any], labels: list[str], kind: str) -> bytes:
    """Velocity, phase portrait and forces as one figure, in the style of a journal."""
    from matplotlib.figure import Figure

    from stickslip.show import figures as plot

    file = io.BytesIO()
    with _drawing, plot.publication():
        figure = Figure(figsize=(10.0, 3.2), layout="constrained")
        left, middle, right = figure.subplots(1, 3)
        plot.velocity(runs, ax=left, labels=labels)
        plot.phase(runs, ax=middle, labels=labels)
        plot.forces(runs[0], ax=right)
        figure.savefig(file, format=kind)
    return file.getvalue()


def _csv(state: State) -> bytes:
    """Every column of the last periods, with all digits."""
    from stickslip.results.datasets import COLUMNS, columns_with_units, headed, write_csv

    (run,) = _runs(state, [state.law])
    end = float(run.strobe_times[-1])
    count = min(PERIODS, len(run.strobe_times) - 1)
    at = run.at(np.clip(np.linspace(end - count * run.period_time, end, 400 * count + 1), 0.0, end))
    file = io.StringIO()
    columns = columns_with_units({name: at[name] for name in COLUMNS if at.get(name) is not None}, {}, None)
    write_csv(headed(columns), [values for values, _ in columns.values()], file)
    return file.getvalue().encode()


def _toml(state: State) -> bytes:
    """A study file that `stickslip run` reads."""
    return (state.robot().to_toml() + "\n[solve]\nperiods = 200\nrtol = 1e-4\n").encode()


def _report(state: State) -> bytes:
    """A self-contained page: numbers, figure, parameters, Python code, provenance."""
    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity
    from stickslip.show.reports.html import page

    labels = [FRICTION[law].label for law in state.laws]
    runs = _runs(state, state.laws)
    solved = []
    for label, run in zip(labels, runs, strict=True):
        m, balance = motion(run), energy(run)
        works = {name: float(getattr(balance, name)[balance.settle :].mean()) for name in ("drive", "gravity", "friction", "actuator")}
        figures = {"velocity": float(mean_velocity(run)), "motion": m, "works": works, "worst": balance.worst}
        solved.append({"label": label, "run": run, **figures})
    numbers = [{"p": PARAMETERS[name], "shown": PARAMETERS[name].shown(state.values[name])} for name in state.active]
    return page(
        "explored.html",
        title=f"{labels[0]} friction, {state.drive} drive",
        state=state,
        solved=solved,
        numbers=numbers,
        picture=drawn(runs, labels, "svg").decode(),
        python=python(state),
        toml=_toml(state).decode(),
        provenance=runs[0].provenance,
        notes=list(runs[0].notes),
    ).encode()


#: File name -> (media type, function that makes the file).
EXPORTS: dict[str, Export] = {
    "figure.png": ("image/png", partial(_figure, "png")),
    "figure.svg": ("image/svg+xml", partial(_figure, "svg")),
    "run.csv": ("text/csv; charset=utf-8", _csv),
    "study.toml": ("application/toml; charset=utf-8", _toml),
    "robot.py": ("text/x-python; charset=utf-8", lambda state: python(state).encode()),
    "report.html": ("text/html; charset=utf-8", _report),
}


def export(name: str, state: State) -> bytes:
    """The content of an export."""
    if name not in EXPORTS:
        raise InputError("export", [f"{name!r} is not known; allowed is one of {', '.join(EXPORTS)}"])
    return EXPORTS[name][1](state)
