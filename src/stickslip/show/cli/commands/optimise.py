"""``stickslip optimise``: find the best numbers and drives of a robot, within limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.basics.quantities import also_in
from stickslip.show.cli import show
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import EXECUTOR, ROBOT, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import Outcome
from stickslip.show.cli.recorded import in_words_of_the_shell
from stickslip.show.cli.searches import asked_for, search_table
from stickslip.show.cli.study_files import study_named

if TYPE_CHECKING:
    from argparse import Namespace


_QUANTITIES = (
    ("mean velocity", "mean_velocity", "m/s"), ("drive power", "drive_power", "W"), ("cost of transport", "cost_of_transport", ""),
    ("stroke", "stroke", "m"), ("relative velocity", "relative_velocity", "m/s"),
    ("relative acceleration", "relative_acceleration", "m/s^2"),
)  # fmt: skip


@command(
    about="Find the best numbers and drives of a robot or a machine, within limits.",
    more="""\
what varies, by names of the machine's numbers (`stickslip init` lists them with their meaning)
  --over drive.amplitude=2e-4..8e-4   a number between bounds
  --over drive=pieces:4               a waveform: pieces:N, fourier:N or spline:N
limits, of stroke, relative_velocity and relative_acceleration of the drives and of results
  --limit stroke=..0.01 --limit mean_velocity=2e-3..
uncertain numbers
  --uncertain friction.mu_plus=0.13..0.17 --uncertain friction.mu_minus=0.25+-0.01 --uncertain track.tilt=0.03+-1%

A study file says the same in TOML, and --out writes such a file with the best machine in it:
  [optimise]
  maximise = "mean_velocity"
  [optimise.over]
  "drive.amplitude" = [2e-4, 8e-4]
  [optimise.subject_to]
  stroke = "..0.01"
  [optimise.robust]
  "friction.mu_plus" = ["uniform", 0.13, 0.17]

Ctrl-C ends the search; the best so far is printed and written.""",
    arguments=(
        *ROBOT,
        *EXECUTOR,
        argument("--over", action="append", metavar="NAME=A..B", default=[], help="what varies, with its bounds (may be repeated)"),
        argument("--maximise", metavar="NAME", help="what to maximise: a column of a sweep (default: mean_velocity)"),
        argument("--minimise", metavar="NAME", help="what to minimise instead, such as cost_of_transport"),
        argument("--limit", action="append", metavar="NAME=A..B", default=[], help="a limit; either end may be omitted (may be repeated)"),
        argument("--uncertain", action="append", metavar="NAME=A..B", default=[], help="an uncertain number (may be repeated)"),
        argument("--quantile", type=float, help="the fraction of the sample that may be worse than the result that counts (default: none)"),
        argument("--starts", metavar="WORD", help="closed: begin also with drives known in closed form (default); none: without"),
        argument("--seed", type=int, help="the same seed gives the same result (0)"),
        argument("--out", metavar="FILE", ends=(".toml",), help="write the best machine as a study file (.toml)"),
        argument("--search", metavar="FILE", ends=(".json",), help="write a record of the search (.json): options, candidates, result"),
        argument("--report", metavar="FILE", ends=(".html",), help="write an offline HTML page (.html)"),
    ),
    example="""\
$ stickslip optimise piezo_rig tilt_deg=3 amplitude=7e-4 law=coulomb --over drive.amplitude=1e-4..7e-4 --limit relative_acceleration=..20 --out best.toml --report best.html
piezo_rig tilt_deg=3 amplitude=0.0007 law=coulomb: mean_velocity maximised
  mean velocity          0.002692084 m/s  (was 0.005741795 m/s)
  drive power            0.0002859123 W  (was 0.0009433626 W)
  cost of transport      0.1502176  (was 0.2323846)
  stroke                 0.0009475557 m  (was 0.0014 m)
  relative velocity      0.09734247 m/s  (was 0.1438221 m/s)
  relative acceleration  20 m/s^2  (was 29.54971 m/s^2)
  drive.amplitude        0.000473777851 m
  limits reached         relative_acceleration
  small friction         22.03 % of the limit …
  note                   the given machine violates the limit of relative_acceleration (at most 20 m/s²)
  candidates             …
  written                best.toml
  written                best.html
$ stickslip run best.toml periods=40
…
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    files = [asked.out, asked.search, asked.report]
    study = subject(asked.robot, asked.settings, solver=("workers",), strict=False)
    job, model = asked_for(asked, study_named(asked.robot).optimise), study.robot()
    if asked.out is not None:
        model.to_toml()  # a machine that a file cannot describe is reported before the search

    from stickslip.inverse.optimisation import optimise

    with in_words_of_the_shell("searches"):
        best = optimise(model, **job, **{**study.options, **executor_asked(asked.executor)}, progress=True)
    written = [str(path) for path in files if path is not None]
    record = {**_record(study.title(), asked.typed, best), "written": written}
    _write(files, best, record, study, asked.typed)
    return Outcome(record, _text(record, best, written))


def _write(files: list[Path | None], best: Any, record: dict[str, Any], study: Any, again: str) -> None:
    from stickslip.basics.whole_files import unwritable, write_whole

    out, search, report = files
    if out is not None:
        import tomli_w

        write_whole(out, f"{best.model.to_toml()}\n{tomli_w.dumps({'optimise': search_table(best)})}", unwritable("optimise"))
    if search is not None:
        import json

        from stickslip.basics.jsontext import strict

        write_whole(search, json.dumps(strict(record), indent=1, allow_nan=False, ensure_ascii=False) + "\n", unwritable("optimise"))
    if report is not None:
        from stickslip.show.reports import optimum_page, write

        write(report, optimum_page(best, f"The best of {study.title()}", again))


def _record(title: str, again: str, best: Any) -> dict[str, Any]:
    """The arguments and the results of the search, by name, in SI units."""
    from stickslip import __version__
    from stickslip.basics.fields import leaves

    slopes = best.sensitivities
    return {
        "robot": title, "command": again, "optimise": search_table(best), "best": best.values, "given": best.given,
        "parameters": {name: float(number) for name, number in leaves(best.model)},
        "of_limit": best.of_limit, "limit": best.limit, "active": best.active, "robust": best.robust, "continued": best.continued,
        "sensitivities": dict(slopes), "notes": [*best.notes, *slopes.notes], "tried": best.tried,
        "history": {"tried": best.search.history[:, 0], "best": best.search.history[:, 1]},
        "study_file": _as_toml(best.model), "version": __version__,
    }  # fmt: skip


def _as_toml(model: Any) -> str | None:
    """The machine as a study file; None if a part of it is a class that a file cannot name."""
    try:
        return str(model.to_toml())
    except InputError:
        return None


def _varied(number: float, unit: str) -> str:
    """A number that varied, and an angular frequency in hertz too, an angle in degrees."""
    also = also_in(number, unit)
    return f"{number:.9g} {unit}".rstrip() + (f"  ({also})" if also else "")


def _text(record: dict[str, Any], best: Any, written: list[str]) -> str:
    """The record as text."""
    from stickslip.inverse.optimisation.results import unit_of_result
    from stickslip.models.naming import unit_in

    best_values, given = record["best"], record["given"]
    quantities = [row for row in _QUANTITIES if row[1] in best_values] + (
        [] if best.of in [row[1] for row in _QUANTITIES] else [(best.of, best.of, "")]
    )
    rows = [
        *(
            (name, f"{show.quantity_text(best_values[key], unit)}  (was {show.quantity_text(given.get(key, float('nan')), unit)})")
            for name, key, unit in quantities
        ),
        *((name, _varied(number, unit_in(name, best.model))) for name, number in best.varied.items()),
        ("limits reached", ", ".join(best.active) or "none"),
        ("small friction", best.limit if best.of_limit is None else f"{100 * best.of_limit:.4g} % of the limit ({best.limit})"),
        *([] if best.robust is None else [("over the sample", show.quantity_text(best.robust, unit_of_result(best.of, best.model)))]),
        *(("note", note) for note in record["notes"]),
        ("candidates", str(best.tried)),
        *(("written", path) for path in written),
    ]
    return f"{record['robot']}: {best.of} {'maximised' if best.search.maximised else 'minimised'}\n{show.facts(rows)}"
