"""``stickslip bifurcation``: bifurcations along one parameter: diagram, branches, folds and flips."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from stickslip.show.cli.arguments import Subject, axes_among, section_asked, subject
from stickslip.show.cli.declaring import EXECUTOR, FIGURES, ROBOT, SECTION, TABLES, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_OF_DIAGRAMS = ("settle", "limit", "rtol", "workers", "start")


@command(
    about="How a motion changes along one number, given as NAME=a..b:n: strobe points after settling, upwards and downwards.",
    arguments=(
        *ROBOT,
        *SECTION,
        *EXECUTOR,
        argument("--follow", action="store_true", help="also follow the periodic motions, stable or not, and find folds and flips"),
        argument(
            "--period",
            metavar="P",
            type=int,
            help="period of the branch that --follow begins with (default 1; without a drive what the run shows)",
        ),
        argument("--batch", action="store_true", help="every value from the same start, all at once (fast; shows no hysteresis)"),
        argument("--observable", metavar="NAME", help="what to draw: v, z, mean_velocity, ... (default: the first velocity)"),
        argument("--figure", metavar="FILE", ends=FIGURES, help="draw the diagram (.png, .svg or .pdf)"),
        argument("--out", metavar="FILE", ends=TABLES, help="write the diagram (.nc, .mat, .csv, .xlsx or .parquet)"),
    ),
    example="""\
$ stickslip bifurcation piezo_rig tilt_deg=1.7 amplitude=6e-4 mu0=0.0455..0.048:6 settle=150 --batch
piezo_rig tilt_deg=1.7 amplitude=0.0006
from start: period 2 from 0.0455 to 0.0465; period 1 from 0.047 to 0.048
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    known = (*(name for name in _OF_DIAGRAMS if name != "start"), "start.x", "start.v", "start.z")
    study = subject(asked.robot, asked.settings, many=True, solver=known, strict=False)
    (parameter,), fixed = axes_among(asked.command, study.arguments, 1, "mu0=0.034..0.05:200")
    values = study.arguments[parameter]

    from stickslip.dynamics.attractors.bifurcation_diagrams import bifurcation

    options = {**study.options, **fixed}
    looked = {"follow": not asked.batch, **section_asked(asked), **options, **executor_asked(asked.executor)}
    diagram = bifurcation(study.make, parameter=parameter, values=values, progress=True, **looked)
    branches = _followed(study.make, parameter, values, asked.period, options) if asked.follow else []
    record, text = _record(study, parameter, diagram, branches), _text(study, parameter, diagram, branches)
    return Outcome(record, text, ((asked.figure, lambda: _drawn(diagram, branches, asked.observable)),), asked.out, diagram)


def _followed(make: Any, parameter: str, values: list[float], period: int | None, options: dict[str, Any]) -> list[Any]:
    """The branch from the largest value down to the smallest, and the period-doubled branch from its first flip.

    Without a drive it is that of the cycle to which the start leads, from the largest value at which there is one, downwards and, where
    there are larger values, upwards to where it ends. It has no doubled one.
    """
    from stickslip.basics.errors import SolveError
    from stickslip.dynamics.continuation.branches import continuation
    from stickslip.dynamics.continuation.one_parameter import family

    fixed = {name: given for name, given in options.items() if name not in _OF_DIAGRAMS}
    if family("continuation", make, (parameter,), fixed).robot(max(values)).period is not None:
        branch = continuation(make, parameter=parameter, start=max(values), stop=min(values), period=period, **fixed)
        return [branch, *([branch.doubled()] if any(s.kind == "flip" for s in branch.special) else [])]
    fixed |= {"parameter": parameter, "period": period, "guess": options.get("start")}
    for start in sorted(values, reverse=True):
        try:
            return [continuation(make, start=start, stop=stop, **fixed) for stop in (min(values), max(values)) if stop != start]
        except SolveError as error:
            why = error
    raise why


def _drawn(diagram: Any, branches: list[Any], observable: str | None) -> Any:
    from stickslip.show import figures as plot

    return plot.continuation(branches, observable, diagram=diagram) if branches else plot.bifurcation(diagram, observable)


def _record(study: Any, parameter: str, diagram: Any, branches: list[Any]) -> dict[str, Any]:
    columns = {str(name): diagram[name].values for name in diagram.data_vars}
    followed = [
        {
            "period": b.period, "ended": b.ended, "values": b.values, "stable": [o.stable for o in b.orbits],
            "states": [o.state for o in b.orbits], "mean_velocity": [o.mean_velocity for o in b.orbits],
            "special": [{"kind": s.kind, "value": s.value, "accuracy": s.accuracy, "notes": s.orbit.notes} for s in b.special],
        }
        for b in branches
    ]  # fmt: skip
    axes = {parameter: diagram[parameter].values, "direction": diagram.direction.values}
    return {
        "robot": study.name,
        "parameter": parameter,
        "axes": axes,
        "columns": columns,
        "branches": followed,
        "notes": _left_out(parameter, branches),
    }


def _text(study: Any, parameter: str, diagram: Any, branches: list[Any]) -> str:
    """Changes of the period, and the special points on the branches."""
    fixed = {name: value for name, value in study.arguments.items() if name != parameter}
    lines = [Subject(study.name, study.make, fixed).title()]
    for direction in diagram.direction.values:
        period, motion = (diagram[name].sel(direction=direction).values for name in ("period", "motion"))
        lines.append(f"{direction}: {_stretches(diagram[parameter].values, period, motion)}")
    for b in branches:
        lines.append(f"branch of period {b.period}, {parameter} from {b.values[0]:.6g} to {b.values[-1]:.6g}: {b.ended}")
        lines += [f"  {s.kind:<12} {parameter} = {s.rounded}  {'; '.join(s.orbit.notes)}".rstrip() for s in b.special]
    return "\n".join([*lines, *(f"note: {note}" for note in _left_out(parameter, branches))])


def _left_out(parameter: str, branches: list[Any]) -> list[str]:
    """A note on the period doublings of the last branch, which are not followed, and on how to follow them."""
    doubled = bool(branches) and branches[-1].period > branches[0].period
    flips = [s.rounded for s in branches[-1].special if s.kind == "flip"] if doubled else []
    if not flips:
        return []
    count = branches[-1].period
    where = " and ".join(flips)
    again = ".doubled()" * len(branches)
    return [
        f"motions of period {2 * count} and more are not followed; they begin at {parameter} = {where}; in Python "
        f"ss.continuation(...){again} follows those of period {2 * count}"
    ]


def _stretches(values: Any, period: Any, motion: Any) -> str:
    """Intervals of equal motion."""
    words = [f"period {p}" if p > 0 else str(kind) for p, kind in zip(period, motion, strict=True)]
    ends = [0, *(i for i in range(1, len(words)) if words[i] != words[i - 1]), len(words)]
    parts = [f"{words[a]} from {values[a]:.6g}" + (f" to {values[b - 1]:.6g}" if b - 1 > a else "") for a, b in pairwise(ends)]
    return "; ".join(parts)
