"""``stickslip map``: simulate a robot over a plane and draw the map."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, as_path, did_you_mean
from stickslip.show.cli import show
from stickslip.show.cli.commands.resume import remembered
from stickslip.show.cli.commands.sweep import axes_of, out_file, run_options, unsettled
from stickslip.show.cli.declaring import ROBOT, STUDIES, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Simulate a robot over a plane of two of its numbers, given as ranges a..b:n, and draw maps.",
    more="""\
examples
  stickslip map piezo_rig tilt_deg=1.7 amplitude=1e-4..8e-4:128 omega=60..300:128 --figure types.png --velocity speed.png
  stickslip map piezo_rig law=coulomb amplitude=6e-4 tilt_deg=1.7 mu0=0.05..0.25:512 f0=0.1..0.4:512 --refine --figure types.pdf
  stickslip map coulomb_robot alpha_plus=0.005..1.6:320 alpha_minus=0.005..1.6:320 --figure types.png
  stickslip map FOLDER --figure types.png                        (a study folder that is there already)""",
    arguments=(
        *ROBOT,
        *STUDIES,
        argument("--refine", action="store_true", help="compute only where the motion changes"),
        argument("--figure", metavar="FILE", ends=(".png", ".pdf", ".svg"), help="draw the motion types (.png, .svg or .pdf)"),
        argument("--velocity", metavar="FILE", ends=(".png", ".pdf", ".svg"), help="draw the mean velocity"),
        argument("--contact", metavar="NAME", help="the contact whose motion types are drawn and counted, of a machine with several"),
        argument("--x", metavar="NAME", help="the horizontal axis; by default the first"),
    ),
    example="""\
$ stickslip map coulomb_robot alpha_plus=0.05..1.55:31 alpha_minus=0.05..1.55:31 --figure types.png
coulomb_robot: 961 cases with the law Coulomb
  II    49.1 % of the plane
  rest  15.0 % of the plane
  III   13.9 % of the plane
  I     11.8 % of the plane
  IV    10.2 % of the plane
fastest: 0.868405 at alpha_plus = 0.05, alpha_minus = 0.7
that is on the edge of alpha_plus: a wider range may have a faster one
written to types.png
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    file = out_file(asked.out)
    with remembered(asked, file):
        grid, name = _grid(asked, file)
    one = _of_contact(grid, asked.contact)
    facts, draws = (
        _shares_and_fastest(one),
        ((asked.figure, lambda: _types(one, asked.x)), (asked.velocity, lambda: _velocities(one, asked.x))),
    )
    record = {"robot": name, "found": facts, "attributes": dict(grid.attrs)}
    return Outcome(record, _text(name, facts), draws, file or asked.out, in_print=True)


def _of_contact(grid: Any, name: str | None) -> Any:
    """The map with the motion types of one contact, if one is selected."""
    if name is None:
        return grid
    names = _contacts(grid)
    if name not in names:
        advice = did_you_mean(name, names) if names else "this robot has one contact; leave it out"
        raise InputError("--contact", [f"{name!r} is no contact of this map; {advice}"])
    return grid.sel(contact=name)


def _contacts(grid: Any) -> list[str]:
    return [str(name) for name in grid["contact"].values] if "contact" in grid.dims else []


def _grid(asked: Namespace, file: Path | None) -> tuple[Any, str]:
    """The map, computed or read from a folder."""
    from stickslip.studies import export, map, open_study

    if (as_path(asked.robot, "map") / "manifest.json").exists():
        if asked.settings:
            raise InputError(
                "map", [f"{asked.robot!r} is a finished study; it takes no {asked.settings[0]!r}; give only --figure or --velocity"]
            )
        return open_study(asked.robot), Path(asked.robot).name
    asked.sobol = asked.latin = asked.table = None
    asked.zip = False
    study, _ = axes_of(asked)
    axes = [name for name, given in study.arguments.items() if isinstance(given, list)]
    if len(axes) != 2:
        given = " and ".join(axes) + (" have" if len(axes) > 1 else " has" if axes else "nothing has")
        allowed = "allowed are exactly two; type stickslip sweep with the same words for others"
        raise InputError("map", [f"{given} several values; {allowed}"])
    if asked.x is not None and asked.x not in axes:
        raise InputError("--x", [f"{asked.x!r} is not an axis of this map; {did_you_mean(asked.x, axes)}"])
    options = run_options(asked, file)
    grid = map(study.make, refine=asked.refine, progress=True, **{**study.options, **options}, **study.arguments)
    if file is not None:
        export(grid, file)
    return grid, study.name


def _types(grid: Any, x: str | None) -> Any:
    if names := _contacts(grid):
        ways = ", ".join(f"--contact {name!r}" for name in names)
        raise InputError("--figure", [f"motion types are those of one contact; type {ways}, or --velocity FILE for the mean velocity"])
    from stickslip.show import figures as plot

    return plot.motion_map(grid, x=x)


def _velocities(grid: Any, x: str | None) -> Any:
    from stickslip.show import figures as plot

    return plot.velocity_map(grid, x=x)


def _shares_and_fastest(grid: Any) -> dict[str, Any]:
    """The share of each motion type, and the fastest point."""
    import numpy as np

    from stickslip.show.reports.fastest import order
    from stickslip.studies.result_columns import is_of_cases

    types, counts = np.unique(grid["motion_type"].values if is_of_cases(grid, "motion_type") else [], return_counts=True)
    shares = {str(t): int(n) / int(counts.sum()) for t, n in zip(types, counts, strict=True)}
    V = grid["mean_velocity"]
    facts: dict[str, Any] = {"cases": int(V.size), "shares": shares}
    if np.isfinite(V.values).any():
        best = V.isel(order(grid, 1)[0])
        facts["fastest"] = {str(d): best[d].values.item() for d in V.dims} | {"mean_velocity": float(best)}
        facts["units"] = str(V.attrs.get("units", "1"))
        facts["at_the_edge_of"] = [str(d) for d in V.dims if _at_edge(V[d].values, best[d].values.item())]
    kinds = json.loads(grid.attrs.get("provenance", "{}")).get("kinds", {})
    return facts | {"law": kinds.get("law"), "notes": unsettled(grid)}


def _at_edge(values: Any, value: Any) -> bool:
    """Whether a value is the smallest or largest of a numeric axis."""
    return values.dtype.kind in "iuf" and len(values) > 1 and value in (values.min(), values.max())


def _text(name: str, facts: dict[str, Any]) -> str:
    law = f" with the law {facts['law']}" if facts["law"] else ""
    lines = [f"{name}: {show.counted(facts['cases'], 'case')}{law}"]
    shares = sorted(facts["shares"].items(), key=lambda item: -item[1])
    lines += [show.facts((t, f"{100 * share:.1f} % of the plane") for t, share in shares)] if shares else []
    return "\n".join([*lines, *_fastest(facts), *facts["notes"]])


def _fastest(facts: dict[str, Any]) -> list[str]:
    """The fastest point, and whether a larger map may contain a faster one."""
    if "fastest" not in facts:
        return []
    point = ", ".join(
        f"{k} = {v:.6g}" if isinstance(v, float) else f"{k} = {v}" for k, v in facts["fastest"].items() if k != "mean_velocity"
    )
    unit, edges = facts["units"].removeprefix("1"), " and ".join(facts["at_the_edge_of"])
    line = f"fastest: {show.quantity_text(facts['fastest']['mean_velocity'], unit, 6)} at {point}"
    return [line, f"that is on the edge of {edges}: a wider range may have a faster one"] if edges else [line]
