"""The figures of a fitted file, as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit


#: The figure of each file, of forces over a motion and of motions over the drive's period.
_OVER_MOTION = {"curve": "over_time", "friction": "friction_curve", "residuals": "residuals_over_velocity"}
_STEADY = {"curve": "fitted", "residuals": "residuals"}


def write_report(folder: Path, fit: Fit) -> list[Path]:
    """Draw the fit over the data, friction against velocity, and what is left; returns the paths."""
    from matplotlib.figure import Figure

    from stickslip.inverse.identification.fit_text import OVER_MOTION
    from stickslip.show import figures as plot
    from stickslip.show.cli.show import draw_to

    over_motion = all(t.kind in OVER_MOTION for t in fit.problem.targets)
    written = []
    for name, draws in (_OVER_MOTION if over_motion else _STEADY).items():
        with plot.publication():
            count = min(len(fit.problem.targets), 4)
            figure = Figure(figsize=(4.4, 2.6 * count), layout="constrained")
            for record, ax in enumerate(figure.subplots(count, squeeze=False)[:, 0]):
                getattr(plot, draws)(fit, record, ax=ax)
            written.append(draw_to(folder / f"{name}.png", figure))
    return written
