"""``stickslip sweep``: simulate a robot over a grid of its numbers."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems, as_path
from stickslip.basics.interruption import ended_early
from stickslip.show.cli import show
from stickslip.show.cli.arguments import SOLVER, Subject, subject, units_of, value
from stickslip.show.cli.commands.resume import remembered
from stickslip.show.cli.declaring import ROBOT, STUDIES, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import FILES, Outcome
from stickslip.show.cli.study_files import study_named

if TYPE_CHECKING:
    from argparse import Namespace


_SHOWN = 60  # rows of the printed table
_COLUMNS = ("mean_velocity", "motion_type", "pattern", "period", "margin")
_SETTLED = 1  # the status of a case whose strobe point repeats
_NOT_OURS = (".xls", ".ods", ".txt", ".tsv", ".dat", ".json", ".npy", ".npz", ".h5", ".hdf5", ".pkl", ".png", ".pdf", ".svg", ".zarr")


@command(
    about="Simulate a robot over a grid of its numbers, or over any other design.",
    more="""\
values
  amplitude=4e-4          one value
  law=lugre,coulomb       several
  amplitude=4e-4..8e-4:9  nine from 4e-4 to 8e-4; amplitude=1e-4..1e-3:9:log: logarithmically spaced

examples
  stickslip sweep piezo_rig law=lugre,coulomb tilt_deg=1.7 amplitude=4e-4..8e-4:9 --out grid.nc
  stickslip sweep piezo_rig law=lugre tilt_deg=1.7 amplitude=0.1e-3..0.8e-3:512 omega=60..300:512 workers=2 --out study --resume
  stickslip sweep piezo_rig law=lugre tilt_deg=0..6:512 amplitude=1e-4..8e-4:4096 --out part --shard 3/7
  stickslip sweep piezo_rig tilt_deg=0.5..5 amplitude=1e-4..8e-4 --sobol 1024 --seed 1 --out design.csv""",
    arguments=(
        *ROBOT,
        *STUDIES,
        argument("--sobol", metavar="COUNT", type=int, help="a Sobol design: NAME=a..b are ranges"),
        argument("--latin", metavar="COUNT", type=int, help="a Latin hypercube: NAME=a..b are ranges"),
        argument("--seed", type=int, default=0, help="seed of a random design (0)"),
        argument("--zip", action="store_true", help="combine the lists value by value"),
        argument("--table", metavar="FILE", help="a CSV file with a line of names and a row for each case"),
    ),
    example="""\
$ stickslip sweep piezo_rig law=coulomb tilt_deg=1.7,2.7 amplitude=4e-4..8e-4:3
tilt_deg [degrees]  amplitude [m]  mean velocity [m/s]  type  pattern  period [drive periods]  margin
1.7                 0.0004         0.0009004046         I     +0-0     1                       0.158
1.7                 0.0006         0.002358779          III   +-0      1                       0.0223
1.7                 0.0008         0.004308808          IV    +-       1                       0.418
2.7                 0.0004         0.001457833          II    +0       1                       0.00218
2.7                 0.0006         0.003786734          III   +-0      1                       0.0404
2.7                 0.0008         0.006689673          IV    +-       1                       0.369
piezo_rig: 6 cases: 6 settled
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    file = out_file(asked.out)
    study, designs = axes_of(asked)

    from stickslip.studies import export, sweep

    options = run_options(asked, file)
    before = len(ended_early)
    with remembered(asked, file):
        grid = sweep(study.make, *designs, progress=True, **{**study.options, **options}, **study.arguments)
    if file is not None:
        export(grid, file)
    elif "out" in options and len(ended_early) > before:
        print(f"stickslip: type stickslip resume {asked.out} to go on", file=sys.stderr)
    written = str(file or asked.out) if asked.out else None
    return Outcome(lambda: _record(grid, study, written), lambda: _text(grid, study, written))


# ---- arguments ----
def out_file(out: str | None) -> Path | None:
    """The file of --out, or None for a study folder; a name with an unsupported file extension is refused."""
    if not out or (Path(out).suffix.lower() not in (*FILES, *_NOT_OURS)) or (as_path(out, "sweep") / "manifest.json").exists():
        return None
    return show.writable("--out", out, FILES)


def axes_of(asked: Namespace) -> tuple[Subject, list[Any]]:
    """The robot with its axes, and the designs."""
    from stickslip.studies import designs

    solver = tuple(name for name in SOLVER if name not in ("samples", "steps"))
    count = asked.sobol or asked.latin
    made, settings = [], list(asked.settings)
    if count:
        ranges, settings = _ranges(settings, units_of(study_named(asked.robot).make))
        make = designs.sobol if asked.sobol else designs.latin_hypercube
        made.append(make(count, seed=asked.seed, **ranges))
    if asked.table:
        made.append(designs.table(asked.table))
    settings += [f"{name}={values[0]}" for design in made for name, values in design.columns.items()]
    study = subject(asked.robot, settings, many=True, solver=solver)
    arguments = {name: v for name, v in study.arguments.items() if not any(name in d.columns for d in made)}
    if asked.zip:
        lists = {name: v for name, v in arguments.items() if isinstance(v, list)}
        made.append(designs.zipped(**lists))
        arguments = {name: v for name, v in arguments.items() if name not in lists}
    return Subject(study.name, study.make, arguments, study.options), made


def _ranges(settings: list[str], units: Callable[[str], str]) -> tuple[dict[str, Any], list[str]]:
    """NAME=a..b words as ranges of a random design, and the other words."""
    ranges: dict[str, Any] = {}
    rest, problems = [], Problems("arguments")
    for word in settings:
        name, _, text = word.partition("=")
        if ".." in text and ":" not in text:
            low, _, high = text.partition("..")
            ranges[name] = (value(low, units(name)), value(high, units(name)))
        else:
            rest.append(word)
            if ".." in text:
                problems.add(f"{word!r} gives the number of values, and so does the design; type {name}={text.partition(':')[0]}")
    if not ranges and problems.mistakes == []:
        problems.add("--sobol and --latin draw from ranges, and there is none; type for example amplitude=1e-4..8e-4")
    problems.check()
    return ranges, rest


def run_options(asked: Namespace, file: Path | None) -> dict[str, Any]:
    """Arguments of `sweep` from the options; results for a single file are computed in memory."""
    if file is not None and (asked.resume or asked.shard):
        raise InputError("--out", [f"{str(file)!r} is a file; --resume and --shard are for a study folder; type for example --out study"])
    if not asked.out and (asked.resume or asked.shard):
        raise InputError("--resume" if asked.resume else "--shard", ["this is for a study folder; type for example --out study"])
    if asked.tile is not None and asked.tile < 1:
        raise InputError("--tile", [f"{asked.tile}; allowed is a whole number of cases from 1; type for example --tile 1000"])
    options: dict[str, Any] = {"resume": asked.resume, "shard": asked.shard, "tile": asked.tile, "continue_along": asked.along}
    if asked.out and file is None:
        options["out"] = asked.out
    if asked.dask:
        from stickslip.studies.cluster import connected

        options["client"] = connected(asked.dask)
    options |= executor_asked(asked.executor)
    return {name: v for name, v in options.items() if v}


# ---- output ----
def _axes(grid: Any) -> list[str]:
    """The axes in the order of the results. A dataset has its own order, which differs if it was transposed."""
    return [str(d) for d in grid["mean_velocity"].dims]


def _column(grid: Any, name: Any) -> Any:
    """A result or a coordinate at every point of the grid, in the order of the axes."""
    return grid[name].broadcast_like(grid["mean_velocity"]).transpose(*_axes(grid)).values


def _shown(grid: Any, name: str) -> Any:
    """A column for the table: a mean velocity within rounding of the velocities is zero."""
    import numpy as np

    from stickslip.models.rounding import ROUNDING

    values, ends = _column(grid, name), ("velocity_max", "velocity_min")
    if name != "mean_velocity" or not all(end in grid for end in ends):
        return values
    each = [abs(grid[end]).max([dim for dim in grid[end].dims if dim not in _axes(grid)]) for end in ends]  # of the fastest body
    speed = np.maximum(*(of.broadcast_like(grid["mean_velocity"]).transpose(*_axes(grid)).values for of in each))
    return np.where(np.abs(values) < ROUNDING * speed, 0.0, values)


def _record(grid: Any, study: Any, written: str | None) -> dict[str, Any]:
    """All results, for JSON."""
    from stickslip.studies.writing import one_row_a_case

    flat = one_row_a_case(grid)
    columns = {name: _column(flat, name) for name in flat.data_vars}
    axes = {name: grid[name].values for name in _axes(grid)}
    return {"robot": study.name, "axes": axes, "columns": columns, "attributes": dict(grid.attrs), "written": written}


def _text(grid: Any, study: Any, written: str | None) -> str:
    """The first rows of the grid, and a summary of how the cases ended."""
    from stickslip.show.reports.study import headed
    from stickslip.studies.result_columns import is_of_cases

    axes = _axes(grid)
    varying = [str(n) for n in grid.coords if n not in axes and set(grid[n].dims) & set(axes)]
    names = (*axes, *varying, *(name for name in _COLUMNS if is_of_cases(grid, name)))  # several contacts have a type each
    cases = grid["mean_velocity"].size
    part = grid.isel({axes[0]: slice(0, _SHOWN)}) if axes else grid
    columns = [_shown(part, name).ravel() if name in part.variables else part[name].values for name in names]
    head = [{"motion_type": "type", "period": "period [drive periods]"}.get(name) or headed(grid, name) for name in names]
    rows = [[_cell(name, column[i]) for name, column in zip(names, columns, strict=True)] for i in range(min(cases, _SHOWN))]
    lines = [show.aligned_table(head, rows)]
    if cases > _SHOWN:
        lines.append(f"… {cases - _SHOWN} more rows; --out FILE or --json gives all")
    lines.append(f"{study.name}: {show.counted(cases, 'case')}: {_ends(grid)}" + (f"; written to {written}" if written else ""))
    return "\n".join([*lines, *_unperiodic(grid, study), *unsettled(grid), *_notes(grid)])


def _ends(grid: Any) -> str:
    """Numbers of cases by status."""
    import numpy as np

    from stickslip.basics.status import STATUS

    meanings = STATUS | {_SETTLED: "settled"}
    codes, counts = np.unique(grid["status"].values, return_counts=True)
    return ", ".join(f"{n} {meanings[int(c)]}" for c, n in zip(codes, counts, strict=True))


def _unperiodic(grid: Any, study: Any) -> list[str]:
    """A sentence on the cases that ran to their end without repeating; empty if no model has a period."""
    if study.options.get("duration") is not None:
        return []
    from stickslip.results.steadiness import UNSETTLED
    from stickslip.studies.planning import SOLVER as DEFAULTS

    number = int(((grid["period"] == 0) & (grid["status"] <= _SETTLED) & (grid["steadiness"] != UNSETTLED)).sum())
    periods = study.options.get("periods", DEFAULTS["periods"])
    return [f"{show.counted(number, 'case')}: {show.no_period(periods)}"] if number else []


def unsettled(grid: Any) -> list[str]:
    """A sentence on the cases whose mean velocity has not reached a steady value."""
    from stickslip.results.steadiness import unsettled_note

    return unsettled_note(grid["steadiness"].values, grid["settling_error"].values) if "steadiness" in grid else []


def _notes(grid: Any) -> list[str]:
    """The reasons why cases were refused or failed."""
    import json

    notes = json.loads(grid.attrs.get("notes", "{}"))
    lines = [f"{show.counted(n, 'case')}: {sentence}" for sentence, n in list(notes.items())[:5]]
    return [*lines, *([f"… and {len(notes) - 5} other reasons"] if len(notes) > 5 else [])]


def _cell(name: str, value: Any) -> str:
    if name == "period":
        return str(int(value)) if value > 0 else "none"
    if hasattr(value, "dtype") and value.dtype.kind == "f":
        return show.quantity_text(float(value), digits=3 if name == "margin" else 7)
    return str(value)
