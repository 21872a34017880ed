"""The figure of the beam of section 3: its modes, the frequency response of its tip, and the initial transient."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.models.drives.cantilever import mode_shape
from stickslip.show.figures.style import COLOURS, DASHES, INK, SHADE
from stickslip.show.paper.beam import VOLTAGE, Beam
from stickslip.show.paper.cases import OMEGA
from stickslip.show.paper.drawing import Picture, render

__all__ = ["draw"]

MODES, HERTZ = 3, (8.0, 2000.0)
PERIODS = 20


def draw(beam: Beam, folder: Path) -> Picture:
    """Draw the figure."""
    panels = [partial(_shapes, beam), partial(_response, beam), partial(_beginning, beam)]
    return render(folder, "section3-beam", panels, height=2.4, columns=3, voltage=VOLTAGE, resonances=beam.beam.frequencies(MODES))


def _shapes(beam: Beam, ax: Any) -> None:
    s = np.linspace(0.0, 1.0, 201)
    ax.axvspan(0.0, 1e3 * beam.beam.patch_length, color=SHADE, linewidth=0, zorder=0)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    for i, b in enumerate(beam.b[:MODES]):
        shape = mode_shape(b, s)
        ax.plot(1e3 * beam.beam.length * s, shape / abs(shape).max(), color=COLOURS[i], linestyle=DASHES[i], label=f"mode {i + 1}")
    ax.legend(loc="lower left", bbox_to_anchor=(-0.1, 1.0), ncols=MODES, borderaxespad=0.2, columnspacing=0.9, handlelength=1.8)
    ax.set(xlabel="place along the beam $x$ (mm)", ylabel="deflection $Y_i$ (largest = 1)", xlim=(0, 1e3 * beam.beam.length))


def _response(beam: Beam, ax: Any) -> None:
    f = np.geomspace(*HERTZ, 900)
    ax.axvline(OMEGA / (2 * np.pi), color=INK, linewidth=0.7, linestyle=(0, (4, 2)))
    ax.plot(f, 1e3 * beam.amplitude(2 * np.pi * f), color=COLOURS[0])
    some = np.geomspace(*HERTZ, 28)
    ax.plot(some, 1e3 * VOLTAGE * beam.undamped(some), "o", color=COLOURS[1], markersize=2.6, markeredgewidth=0)
    ax.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="tip amplitude (mm)", xlim=HERTZ)
    ax.set_xticks([10, 100, 1000], ["10", "100", "1000"])
    ax.set_yticks([1e-4, 1e-2, 1], ["0.0001", "0.01", "1"])


def _beginning(beam: Beam, ax: Any) -> None:
    t = np.linspace(0.0, PERIODS * 2 * np.pi / OMEGA, 60 * PERIODS)
    size = 1e3 * float(beam.amplitude(OMEGA))
    ax.axhspan(-size, size, color=SHADE, linewidth=0, zorder=0)
    ax.plot(OMEGA * t / (2 * np.pi), 1e3 * beam.beam.transient(t, VOLTAGE, OMEGA / (2 * np.pi)), color=COLOURS[0], linewidth=0.8)
    ax.set(xlabel="time $t/T$ (drive periods)", ylabel="tip $u(L,t)$ (mm)", xlim=(0, PERIODS))
