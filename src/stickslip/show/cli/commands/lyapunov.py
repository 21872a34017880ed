"""``stickslip lyapunov``: Lyapunov exponents: periodic, quasi-periodic or chaotic?"""  # noqa: D400

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.basics.notebook_display import with_error
from stickslip.show.cli import show
from stickslip.show.cli.arguments import section_asked, subject, value
from stickslip.show.cli.declaring import EXECUTOR, FIGURES, ROBOT, SECTION, TABLES, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import Outcome
from stickslip.show.cli.study_files import study_named

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Lyapunov exponents per drive period, and the kind of motion: periodic, quasi-periodic or chaotic. Over one or two ranges: a map.",
    more="""\
values
  mu0=0.04                one motion: all exponents, and the kind of motion
  mu0=0.03..0.06:100      several: period number and largest exponent for each
  mu0=0.03..0.21:60:log amplitude=2.5e-4..9.5e-4:60 workers=2      a map""",
    arguments=(
        *ROBOT,
        *SECTION,
        *EXECUTOR,
        argument("--figure", metavar="FILE", ends=FIGURES, help="draw their convergence, or the map (.png, .svg or .pdf)"),
        argument("--out", metavar="FILE", ends=TABLES, help="write their convergence, or the map (.nc, .mat, .csv, .xlsx or .parquet)"),
    ),
    example="""\
$ stickslip lyapunov piezo_rig tilt_deg=1.7 amplitude=6e-4 mu0=0.04 periods=100
piezo_rig tilt_deg=1.7 amplitude=0.0006 mu0=0.04
  motion       periodic, period 2
  exponent 1   -0.466447 ± 1e-14 per drive period
  exponent 2   -19949.2 ± 9e-13 per drive period
  multipliers  -0.393413, 0
  evidence     after 500 drive periods the strobe point returns after 2, Newton's method finds its orbit, and the largest multiplier is 0.3934
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    return (_map if _several(asked) else _one)(asked)


def _several(asked: Namespace) -> bool:
    """Whether a number of the robot has several values, on the command line or in its study file."""
    filed = study_named(asked.robot).arguments.values()
    texts = [word.partition("=")[2] for word in asked.settings] + [v for v in filed if isinstance(v, str)]
    return any(".." in text or "," in text for text in texts) or any(isinstance(v, list) for v in filed)


# ---- one motion ----
def _one(asked: Namespace) -> Outcome:
    from stickslip.dynamics.exponents.motion_verdict import verdict
    from stickslip.show.figures import convergence

    if asked.executor is not None:
        raise InputError("--executor", ["one motion is followed in one process; leave it out, or give a range: mu0=0.03..0.06:100"])
    settle, rest = _settle(asked.settings)
    study = subject(asked.robot, rest, solver=("periods", "rtol", "start.x", "start.v", "start.z"), strict=False)
    judged = verdict(study.robot(), progress=True, **section_asked(asked), **settle, **study.options)
    l = judged.exponents  # noqa: E741
    record = {
        "robot": study.title(), "kind": judged.kind, "period": judged.period, "why": judged.why, "spectrum": l.spectrum, "errors": l.errors,
        "largest": l.largest, "error": l.error, "unit": l.unit, "periods": l.steps, "note": l.note,
        "multipliers": None if judged.orbit is None else [[m.real, m.imag] for m in map(complex, judged.orbit.multipliers)],
    }  # fmt: skip
    text = f"{study.title()}\n{show.facts(_rows(judged))}"
    return Outcome(record, text, ((asked.figure, lambda: convergence(l)),), asked.out, _convergence(judged, study.title()))


def _settle(words: list[str]) -> tuple[dict[str, Any], list[str]]:
    """Separate ``settle=`` and ``limit=`` from the other words, as these periods precede those of ``periods=``."""
    mine = [word for word in words if word.partition("=")[0] in ("settle", "limit")]
    pairs = [(name, value(text)) for name, _, text in (word.partition("=") for word in mine)]
    return dict(pairs), [word for word in words if word not in mine]


def _rows(judged: Any) -> list[tuple[str, str]]:
    l = judged.exponents  # noqa: E741
    rows = [("motion", judged.kind + (f", period {judged.period}" if judged.period else ""))]
    rows += [
        (f"exponent {i + 1}", f"{with_error(mean, error)} per {l.unit}")
        for i, (mean, error) in enumerate(zip(l.spectrum.tolist(), l.errors.tolist(), strict=True))
    ]
    if judged.orbit is not None:
        rows.append(("multipliers", ", ".join(f"{m:.6g}" for m in judged.orbit.multipliers)))
    return [*rows, ("evidence", judged.why), *([("note", l.note)] if l.note else [])]


def _convergence(judged: Any, title: str) -> Any:
    """The convergence of the exponents as a dataset."""
    import xarray as xr

    l = judged.exponents  # noqa: E741
    columns = {
        "exponents": (("periods", "exponent"), l.record[:, 1:], {"long_name": f"exponents per {l.unit} until then", "units": "1"}),
        "error": ("exponent", l.errors, {"long_name": "standard error at the end", "units": "1"}),
    }
    coords = {"periods": ("periods", l.record[:, 0], {"units": "1"}), "exponent": range(1, len(l.spectrum) + 1)}
    attrs = {"robot": title, "kind": judged.kind, "period": judged.period or 0, "why": judged.why, "note": l.note}
    return xr.Dataset(columns, coords, attrs)


# ---- a map ----
def _map(asked: Namespace) -> Outcome:
    from stickslip.dynamics.attractors.period_maps import chaos_map
    from stickslip.show.figures import chaos_map as draw

    settle, rest = _settle(asked.settings)
    study = subject(asked.robot, rest, many=True, solver=("periods", "rtol", "workers", "start.x", "start.v", "start.z"), strict=False)
    how = {**section_asked(asked), **settle, **study.options, **executor_asked(asked.executor)}
    grid = chaos_map(study.make, progress=True, **how, **study.arguments)
    axes = [str(d) for d in grid.period.dims]
    record = {
        "robot": study.name, "axes": {name: grid[name].values for name in axes},
        "columns": {str(name): grid[name].values for name in grid.data_vars},
    }  # fmt: skip
    return Outcome(record, _text(study.name, axes, grid), ((asked.figure, lambda: draw(grid)),), asked.out, grid)


def _text(name: str, axes: list[str], grid: Any) -> str:
    """The share of each kind of motion in the map."""
    import numpy as np

    from stickslip.dynamics.attractors.kinds_of_motion import KINDS

    period, motion = grid.period.values, grid.motion.values
    chaotic = motion == "chaotic"
    shares = [(f"period {p}", np.mean(period == p)) for p in np.unique(period[period > 0])]
    shares += [(kind, np.mean(motion == kind)) for kind in KINDS[1:]]
    sizes = " x ".join(f"{axis} {grid.sizes[axis]}" for axis in axes)
    rows = show.facts((text, f"{100 * share:.1f} %") for text, share in shares if share > 0)
    lines = [f"{name}: {sizes}", rows]
    if chaotic.any():
        top = int(np.argmax(np.where(chaotic, grid.exponent.values, -np.inf)))
        index = np.unravel_index(top, period.shape)
        where = ", ".join(f"{axis} = {float(grid[axis][i]):.6g}" for axis, i in zip(axes, index, strict=True))
        per = grid.exponent.attrs["long_name"].removeprefix("largest Lyapunov exponent ")
        largest, error = (float(grid[n].values[index]) for n in ("exponent", "error"))
        lines.append(f"largest exponent {largest:.4g} ± {error:.1g} {per} at {where}")
    return "\n".join(lines)
