"""``stickslip basins``: basins of attraction: which initial state leads to which motion."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems
from stickslip.show.cli import show
from stickslip.show.cli.arguments import section_asked, subject, units_of, values
from stickslip.show.cli.declaring import EXECUTOR, FIGURES, ROBOT, SECTION, TABLES, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import Outcome
from stickslip.show.cli.study_files import study_named

if TYPE_CHECKING:
    from argparse import Namespace


_NAME = re.compile(r"x|v|z\d*|memory\d*|phase")
_SOLVER = ("settle", "limit", "rtol", "workers")
_START = re.compile(rf"({_NAME.pattern})=(.+)")


@command(
    about="Basins of attraction over a grid of initial states: v=a..b:n [m/s], z=a..b:n [m], phase=0..0.9:10. With a range of one of the robot's numbers: the attractors along it.",
    arguments=(
        *ROBOT,
        *SECTION,
        *EXECUTOR,
        argument("--figure", metavar="FILE", ends=FIGURES, help="draw the map (.png, .svg or .pdf)"),
        argument("--out", metavar="FILE", ends=TABLES, help="write the map (.nc, .mat, .csv, .xlsx or .parquet)"),
    ),
    example="""\
$ stickslip basins piezo_rig tilt_deg=1.7 amplitude=8e-4 f0=0.5 v=-0.1..0.1:5 z=-1e-6,1e-6 settle=80
piezo_rig tilt_deg=1.7 amplitude=0.0008 f0=0.5
attractor  motion    mean velocity [m/s]  share   95 %
0          period 1  0.003552104          0.6000  0.3127 to 0.8318
1          period 1  0.002005917          0.4000  0.1682 to 0.6873
10 starts
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    filed = {name: v for name, v in study_named(asked.robot).arguments.items() if _NAME.fullmatch(name)}
    starts = {**_starts([f"{name}={_text(v)}" for name, v in filed.items()]), **_starts(asked.settings)}
    words = [word for word in asked.settings if not _START.fullmatch(word)]
    study = subject(asked.robot, words, many=True, solver=_SOLVER, own=tuple(filed), strict=False)
    ranges = [name for name, given in study.arguments.items() if hasattr(given, "__len__") and not isinstance(given, str)]
    if not ranges and asked.figure is not None and sum(isinstance(v, list) and len(v) > 1 for v in starts.values()) < 2:
        raise InputError("--figure", ["a map needs two coordinates with several values; type for example v=-0.1..0.1:41 z=-2e-6..2e-6:21"])
    return _along(asked, study, ranges, starts) if ranges else _one(asked, study, starts)


def _one(asked: Namespace, study: Any, starts: dict[str, Any]) -> Outcome:
    """One robot: the attractor of each initial state."""
    from stickslip.dynamics.attractors.basins import basins

    how = {**section_asked(asked), **study.options, **executor_asked(asked.executor)}
    result = basins(study.robot(), progress=True, **how, **starts)
    attractors = [
        {
            "motion": a.kind, "period": a.period, "mean_velocity": a.mean_velocity, "share": a.share, "interval": a.interval,
            "exponent": a.exponent, "error": a.error,
        }
        for a in result.attractors
    ]  # fmt: skip
    others = [{"motion": word, "share": share, "interval": interval} for word, (share, interval) in result.others.items()]
    axes = {str(name): result.map[name].values for name in result.map.attractor.dims}
    columns = {str(name): result.map[name].values for name in result.map.data_vars}
    record = {"robot": study.title(), "attractors": attractors, "others": others, "axes": axes, "columns": columns, "notes": result.notes}
    return Outcome(record, _summary(study, result), ((asked.figure, result.plot),), asked.out, result.map)


def _along(asked: Namespace, study: Any, ranges: list[str], starts: dict[str, Any]) -> Outcome:
    """Robots along a parameter: the attractors as it changes."""
    from stickslip.dynamics.attractors.attractor_continuation import attractors
    from stickslip.show import figures as plot

    if len(ranges) > 1:
        raise InputError(
            "basins", [f"{' and '.join(ranges)} have several values; allowed is one number of the robot; type {ranges[0]}=a..b:n"]
        )
    parameter = ranges[0]
    rest = {name: given for name, given in study.arguments.items() if name != parameter}
    along = {"parameter": parameter, "values": study.arguments[parameter], "starts": starts}
    how = {**section_asked(asked), **study.options, **executor_asked(asked.executor)}
    lives = attractors(study.make, progress=True, **along, **how, **rest)
    columns = {str(name): lives[name].values for name in lives.data_vars}
    record = {"robot": study.name, "axes": {n: lives[n].values for n in ("attractor", parameter)}, "columns": columns}
    return Outcome(record, _lives(study.name, parameter, lives), ((asked.figure, lambda: plot.attractors(lives)),), asked.out, lives)


def _lives(name: str, parameter: str, lives: Any) -> str:
    """For each attractor, its range, mean velocity and share of the initial states at the ends of that range."""
    import numpy as np

    unit, rows = lives[parameter].attrs["units"], []
    for k in lives.attractor.values:
        one = lives.isel(attractor=int(k))
        here = np.flatnonzero(one.period.values >= 0)
        first, last = (f"{float(one[parameter][i]):.6g}" for i in (here[0], here[-1]))
        kinds = zip(one.period.values[here].tolist(), one.motion.values[here].tolist(), strict=True)
        motions = ", ".join(dict.fromkeys(f"period {p}" if p else kind for p, kind in kinds))
        V, share = (" to ".join(f"{float(one[q][i]):.{d}g}" for i in (here[0], here[-1])) for q, d in (("mean_velocity", 5), ("share", 3)))
        rows.append([str(k), f"{first} to {last}", motions, V, share])
    head = ["attractor", f"{parameter}{'' if unit == '1' else f' [{unit}]'}", "motion", "mean velocity [m/s]", "share"]
    undone = int((lives.unsolved < 0).sum())
    lines = [f"{name}: {parameter} {lives.sizes[parameter]} values, {show.counted(lives.attrs['starts'], 'start')} at each"]
    return "\n".join([*lines, show.aligned_table(head, rows), *_left(lives), *([f"{undone} values not computed"] if undone else [])])


def _left(lives: Any) -> list[str]:
    """How many starts have not settled, and run away or were not solved, at how many values."""
    kinds = {"unsettled": "have not settled", "runs_away": "run away", "unsolved": "were not solved"}
    counts = {words: lives[name].values[lives[name].values > 0] for name, words in kinds.items()}
    return [f"at {len(n)} values up to {show.counted(int(n.max()), 'start')} {words}" for words, n in counts.items() if len(n)]


def _text(value: Any) -> str:
    """An initial value of a study file as it would be typed on the command line."""
    return ",".join(map(str, value)) if isinstance(value, list) else str(value)


def _starts(words: list[str]) -> dict[str, Any]:
    """The initial values among the words."""
    problems, initial, units = Problems("arguments"), {}, units_of(None)
    for match in filter(None, map(_START.fullmatch, words)):
        try:
            initial[match[1]] = values(match[2], units(f"start.{match[1]}"))
        except ValueError as error:
            problems.add(f"{match[1]}: {error}")
    problems.check()
    return initial


def _summary(study: Any, result: Any) -> str:
    head = ["attractor", "motion", "mean velocity [m/s]", "share", "95 %"]
    rows = [
        [str(k), a.word, f"{a.mean_velocity:.7g}", f"{a.share:.4f}", f"{a.interval[0]:.4f} to {a.interval[1]:.4f}"]
        for k, a in enumerate(result.attractors)
    ]
    rows += [["none", word, "", f"{share:.4f}", f"{low:.4f} to {high:.4f}"] for word, (share, (low, high)) in result.others.items()]
    lines = [study.title(), show.aligned_table(head, rows), show.counted(int(result.map.attractor.size), "start")]
    return "\n".join([*lines, *(f"note: {note}" for note in result.notes)])
