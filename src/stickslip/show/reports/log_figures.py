"""The figures of a fitted file, as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.inverse.identification.fit_text import OVER_MOTION

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit


MOST_DRAWN = 4  # records of which there are figures

#: The figure of each file, with its heading: of forces over a motion, of forces at speeds, of angles under a command, and of motions over
#: the drive's period.
_FRICTION, _RESIDUALS = ("friction_curve", "Friction against velocity"), ("residuals_over_velocity", "Residuals")
_OVER_MOTION = {"curve": ("over_time", "The fit over the data"), "friction": _FRICTION, "residuals": _RESIDUALS}
_AT_SPEEDS = {"friction": _FRICTION, "residuals": _RESIDUALS}
_COMMANDED = {name: _OVER_MOTION[name] for name in ("curve", "residuals")}
_STEADY = {"curve": ("fitted", "The fit over the data"), "residuals": ("residuals", "Residuals")}


def figures_of(fit: Fit) -> dict[str, tuple[str, str]]:
    """The figures that show a fit: the name of the file, and for each the function that draws it and its heading."""
    if not all(t.kind in OVER_MOTION for t in fit.problem.targets):
        return _STEADY
    if all(t.kind == "angle" for t in fit.problem.targets):
        return _COMMANDED
    return _AT_SPEEDS if all(t.timeless for t in fit.problem.targets) else _OVER_MOTION


def write_report(folder: Path, fit: Fit) -> list[Path]:
    """Draw the fit over the data, friction against velocity, and what is left; returns the paths."""
    from matplotlib.figure import Figure

    from stickslip.show import figures as plot
    from stickslip.show.cli.show import draw_to

    written = []
    for name, (draws, _) in figures_of(fit).items():
        with plot.publication():
            means = all(t.kind == "mean" for t in fit.problem.targets)  # all in one figure
            count = 1 if means else min(len(fit.problem.targets), MOST_DRAWN)
            figure = Figure(figsize=(4.4, 2.6 * count), layout="constrained")
            for record, ax in enumerate(figure.subplots(count, squeeze=False)[:, 0]):
                getattr(plot, draws)(fit, record, ax=ax)
            written.append(draw_to(folder / f"{name}.png", figure))
    return written
