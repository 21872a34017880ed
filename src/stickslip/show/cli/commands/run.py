"""``stickslip run``: simulate one robot and report its motion."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.interruption import complete_before
from stickslip.show.cli import aperiodic_runs as timed, bodies, flow_runs, show
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import FIGURES, ROBOT, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


DATA = (".nc", ".mat", ".csv", ".xlsx")


@command(
    about="Simulate one robot, mechanism, machine or flow and report its motion.",
    arguments=(
        *ROBOT,
        argument(
            "--figure", metavar="FILE", ends=FIGURES, help="draw velocity (of a flow its states) and phase portrait (.png, .svg or .pdf)"
        ),
        argument(
            "--data", "--out", metavar="FILE", ends=(".nc", ".mat", ".csv", ".xlsx"), help="write every column (.nc, .mat, .csv or .xlsx)"
        ),
    ),
    example="""\
$ stickslip run piezo_rig tilt_deg=1.7 amplitude=5.56e-4
piezo_rig tilt_deg=1.7 amplitude=0.000556
  mean velocity      0.001786509 m/s
  motion type        I  (pattern +0-0; with Coulomb friction I)
  repeats after      1 drive period of 0.030581 s
  margin             0.000874  (0 is the border to another type)
  parts of a period  forward 54.0 %, backward 38.8 %, stick 7.2 %
  velocity           -0.006237868 m/s to 0.01098599 m/s
  energy per period  drive 1.823e-05 J, friction 1.823e-05 J
  energy balance     worst residual 1.7e-09
  status             finished, 200 periods (100 to settle)
  made by            stickslip 0.1.0, Taylor12 at rtol 1e-06
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    study = subject(asked.robot, asked.settings)
    robot = study.robot()

    from stickslip.solvers import solve

    before = len(complete_before)
    run = solve(robot, **study.options, keep="trajectory")
    written = [str(path) for path in (_drawn(run, asked.figure), written_to(run, asked.data)) if path is not None]
    if len(complete_before) > before:
        raise KeyboardInterrupt("run was interrupted: the motion is computed, and what it is was not looked for")
    if not run.pieces.layout.bodies:
        of_flow = flow_runs.record(study, run, written)
        return Outcome(of_flow, lambda: flow_runs.as_text(of_flow))
    make, tell = (_record, _text) if robot.period is not None else (timed.record, timed.as_text)
    make, tell = (make, tell) if run.pieces.layout.single else (bodies.record, bodies.as_text)
    record = make(study, run, written)
    return Outcome(record, lambda: tell(record))


def _record(study: Any, run: Any, written: list[str]) -> dict[str, Any]:
    """All results of the command, by name, in SI units."""
    from dataclasses import asdict

    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity, velocity_range
    from stickslip.basics.fields import leaves
    from stickslip.models.machine_adapter import machine_of

    m, balance = motion(run), energy(run)
    slowest, fastest = velocity_range(run)
    of_motion = {k: v for k, v in asdict(m).items() if k != "_twin"} | {"twin": m.twin}
    works = {name: float(getattr(balance, name)[balance.settle :].mean()) for name in ("drive", "gravity", "friction", "actuator")}
    return {
        "robot": study.title(),
        "law": machine_of(run.model).law_names,
        "dimensionless": study.dimensionless,
        "parameters": {name: float(value) for name, value in leaves(run.model)},
        "mean_velocity": mean_velocity(run),
        "motion": of_motion,
        "has_drive": machine_of(run.model).drive is not None,
        "period_time": run.period_time,
        "velocity_max": fastest,
        "velocity_min": slowest,
        "displacement": float(run.strobe_x[-1] - run.strobe_x[0]),
        "energy": {**works, "worst_residual": balance.worst},
        "status": run.status,
        **run.provenance["settings"],
        **({"rtol": None} if "steps_per_period" in run.counts else {}),  # fixed steps have no tolerance
        "counts": run.counts,
        "notes": [*run.notes, *([show.no_period(run.periods)] if m.period is None and run.notes == machine_of(run.model).notes else [])],
        "steadiness": _steadiness(run.steadiness),
        "provenance": run.provenance,
        "written": written,
    }


def _steadiness(steadiness: Any) -> dict[str, Any]:
    """Whether the mean velocity is that of a steady motion, for JSON."""
    error = steadiness.error if math.isfinite(steadiness.error) else None
    return {"code": steadiness.code, "word": steadiness.word, "settling_error": error}


def _text(record: dict[str, Any]) -> str:
    """The record as text."""
    m, work = record["motion"], record["energy"]
    percent = ", ".join(f"{name} {100 * m[f'{name}_fraction']:.1f} %" for name in ("forward", "backward", "stick"))
    twin = f"; with Coulomb friction {m['twin']}" if m["slip_ratio"] is not None and m["twin"] else ""
    per_second, second, joule = ("", "", "") if record["dimensionless"] else ("m/s", " s", " J")
    low, high, mean = (show.quantity_text(record[name], per_second) for name in ("velocity_min", "velocity_max", "mean_velocity"))
    rows = [
        ("mean velocity", mean if record["steadiness"]["code"] in (0, -1) else f"{mean}  ({record['steadiness']['word']})"),
        ("motion type", f"{m['type']}  (pattern {m['pattern']}{twin})") if record["has_drive"] else ("motion", f"pattern {m['pattern']}"),
        (
            "repeats after",
            "not found" if m["period"] is None else f"{show.counted(m['period'], 'drive period')} of {record['period_time']:.6g}{second}",
        ),
        ("margin", f"{show.quantity_text(m['margin'], digits=3)}  (0 is the border to another type)"),
        ("parts of a period", percent),
        ("velocity", f"{low} to {high}"),
        ("energy per period", _works(work, joule)),
        ("energy balance", f"worst residual {work['worst_residual']:.1e}"),
        ("status", f"{record['status']}, {show.counted(record['periods'], 'period')} ({record['settle']} to settle)"),
    ]
    return show.run_text(record, rows, _method(record))


def _method(record: dict[str, Any]) -> str:
    """The method and its accuracy settings."""
    if record["rtol"]:
        return f"{record['method']} at rtol {record['rtol']:g}"
    steps = record["counts"].get("steps_per_period")
    return f"{record['method']} with {steps} steps per period" if steps else str(record["method"])


def _works(work: dict[str, float], unit: str) -> str:
    """Work per period; values within rounding are left out."""
    shown = {name: work[name] for name in ("drive", "gravity", "friction")}
    return ", ".join(
        f"{name} {value:.4g}{unit}" for name, value in shown.items() if abs(value) > 1e-12 * abs(work["drive"]) or name == "drive"
    )


def _drawn(run: Any, path: Path | None) -> Path | None:
    if path is None:
        return None
    from matplotlib.figure import Figure

    from stickslip.show import figures as plot

    with plot.publication():
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        (plot.velocity if run.pieces.layout.bodies else plot.states)(run, ax=left)
        plot.phase(run, ax=right)
        return show.draw_to(path, figure)


def written_to(run: Any, path: Path | None) -> Path | None:
    """Write every column of a run to a .nc, .mat, .csv or .xlsx file; returns its path."""
    return None if path is None else Path(run.save(path))
