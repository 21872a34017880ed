"""Our own figures on which verdicts rest: step sizes, the surroundings of section 5, types by the static coefficient, amplitudes."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.show.figures.style import INK
from stickslip.show.paper import beam_figure, omitted
from stickslip.show.paper.amplitudes import ROUNDING, AmplitudeBracket, Amplitudes
from stickslip.show.paper.cases import AMPLITUDE_5, CASES
from stickslip.show.paper.claims_page import ClaimData, PaperClaim
from stickslip.show.paper.coexistence import STARTS, Coexistence
from stickslip.show.paper.drawing import COULOMB, LUGRE, Picture, render
from stickslip.show.paper.parameter_map import ParameterMap

__all__ = ["draw"]

#: Colours of motion types (after Okabe and Ito 2008), light without sliding; distinguishable with any colour vision.
TYPES = {"rest": "#E4E7EB", "presliding": "#E4E7EB", "II": "#56B4E9", "I": "#0072B2", "III": "#F0C000", "IV": "#D55E00", "other": "#333333"}
#: Colour of coexisting motions.
BOTH = "#009E73"


def draw(study: ClaimData, claims: tuple[PaperClaim, ...], folder: Path) -> tuple[Picture, ...]:
    """Draw all figures of the evidence."""
    study.tell("drawing the evidence", 0, 5)
    pictures = (
        beam_figure.draw(study.beam, folder),
        _amplitudes(study.amplitudes, folder),
        _ladder(next(c for c in claims if c.key == "quasi_periodic").numbers, folder),
        _around(study.around, folder),
        _static(study.static_map, study.coexistence, folder),
        omitted.draw(study.omitted, folder),
    )
    study.tell("drawing the evidence", 5, 5)
    return pictures


# ---- amplitudes of section 4 ----
def _amplitudes(amplitudes: Amplitudes, folder: Path) -> Picture:
    return render(
        folder, "evidence-amplitudes", [partial(_bracket, b) for b in amplitudes.section4], each=[{"b": b} for b in amplitudes.section4]
    )


def _bracket(b: AmplitudeBracket, ax: Any) -> None:
    e, A = b.experiment, 1e3 * b.scan["amplitude"]
    for printed, style, name, values in ((e.coulomb, COULOMB, "Coulomb", b.scan["coulomb"]), (e.lugre, LUGRE, "LuGre", b.scan["lugre"])):
        ax.axhspan(1e3 * (printed - ROUNDING), 1e3 * (printed + ROUNDING), color=style["color"], alpha=0.16, linewidth=0)
        ax.plot(A, 1e3 * values, **style, label=name)
    if b.joint:
        ax.axvspan(1e3 * b.joint[0], 1e3 * b.joint[1], color="#999999", alpha=0.3, linewidth=0)
    ax.axvline(1e3 * e.amplitude, color=INK, linewidth=0.7)
    half = max(0.02 * e.amplitude, 1.5e-5) * 1e3
    low, high = min(e.coulomb, e.lugre), max(e.coulomb, e.lugre)
    ax.set(xlim=(1e3 * e.amplitude - half, 1e3 * e.amplitude + half), ylim=(1e3 * low - 0.4, 1e3 * high + 0.4))
    ax.set(xlabel="amplitude $A$ (mm)", ylabel="mean velocity (mm/s)")
    ax.set_title(f"{e.tilt_deg}°, type {e.type}", loc="left")
    ax.legend(loc="lower right")


# ---- RK4 at mu0 = 0.03 ----
def _ladder(numbers: dict[str, Any], folder: Path) -> Picture:
    ladder, best = [r for r in numbers["rk4"] if r["velocity"] is not None], numbers["converged"][-1][1]
    return render(folder, "evidence-step-size", [partial(_steps, ladder, best)], height=2.4, ladder=ladder, best=best)


def _steps(ladder: list[dict[str, Any]], best: float, ax: Any) -> None:
    ax.axhline(0.0, color=INK, linewidth=0.5)
    ax.axhline(1e3 * best, color=LUGRE["color"], linewidth=1.2)
    ax.text(0.02, 1e3 * best, "converged, period 1", transform=ax.get_yaxis_transform(), color=LUGRE["color"], va="bottom", fontsize=7)
    ax.plot([r["steps"] for r in ladder], [1e3 * r["velocity"] for r in ladder], color=COULOMB["color"], linewidth=0.6)
    for r in ladder:
        face = COULOMB["color"] if r["period"] else "white"
        ax.plot(r["steps"], 1e3 * r["velocity"], "o", color=COULOMB["color"], markerfacecolor=face, markersize=5)
    ax.set_xscale("log")
    ax.set_ylim(top=1e3 * best * 1.18)
    ax.set(xlabel="steps per drive period", ylabel="mean velocity (mm/s)")


# ---- maps ----
def _mesh(ax: Any, x: Any, y: Any, index: Any, colours: list[str]) -> None:
    from matplotlib.colors import ListedColormap

    ax.pcolormesh(x, y, index, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(colours) - 0.5, rasterized=True, shading="nearest")


def _key(ax: Any, entries: list[tuple[str, str]]) -> None:
    from matplotlib.patches import Patch

    patches = [Patch(facecolor=colour, edgecolor=INK, linewidth=0.4, label=name) for name, colour in entries]
    ax.legend(
        handles=patches,
        loc="lower left",
        bbox_to_anchor=(-0.02, 1.0),
        ncols=len(patches),
        handlelength=1.0,
        columnspacing=0.9,
        handletextpad=0.4,
        borderaxespad=0.2,
    )


def _around(around: ParameterMap, folder: Path) -> Picture:
    panels = [partial(_around_panel, around, quantity) for quantity in ("motion", "exponent")]
    return render(folder, "section5-around", panels, height=3.6, around=around)


def _around_panel(around: ParameterMap, quantity: str, ax: Any) -> None:
    from stickslip.show.figures import chaos_map

    chaos_map(around.grid, ax, quantity, around.curves)
    ax.xaxis.set_major_formatter(lambda value, _: f"{1e-3 * value:g}")  # as everywhere in this report: mm
    ax.set(xlabel="amplitude $A$ (mm)", ylabel="kinetic coefficient $\\mu_0$")
    x, y = 1e6 * around.grid.amplitude.values, around.grid.mu0.values
    for case in CASES:
        A, mu0 = 1e6 * case.amplitude, case.changes.get("mu0", 0.18)
        if case.section in ("5.1", "5.3") and x[0] <= A <= x[-1] and y[0] - 1e-9 <= mu0 <= y[-1] + 1e-9:
            ax.plot(A, mu0, "D", color="white", markeredgecolor="black", markeredgewidth=0.8, markersize=3.6, clip_on=False, zorder=6)
            ax.annotate(
                str(case.figure), (A, mu0), (5, 0), textcoords="offset points", va="center", fontsize=7, zorder=7, annotation_clip=False,
                bbox={"boxstyle": "round,pad=0.08", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
            )  # fmt: skip


def _static(static_map: dict[str, Any], both: Coexistence, folder: Path) -> Picture:
    panels = [
        partial(_type_panel, static_map, static_map["exact"], "Exact motion, break-away at $f_0$"),
        partial(_type_panel, static_map, next(iter(static_map["words"].values())), "LuGre labels, from rest"),
        partial(_both_panel, both),
    ]
    return render(folder, "evidence-static-friction", panels, height=2.9, columns=3, starts=STARTS, both=both)


def _type_panel(static_map: dict[str, Any], types: Any, title: str, ax: Any) -> None:
    order = ["rest", "II", "I", "III", "IV", "other"]
    index = np.select([types == name for name in order[1:-1]] + [np.isin(types, ("rest", "presliding"))], [1, 2, 3, 4, 0], 5)
    _mesh(ax, static_map["f0"], 1e3 * static_map["amplitude"], index, [TYPES[name] for name in order])
    _key(ax, [(_called(name, types), TYPES[name]) for i, name in enumerate(order) if (index == i).any()])
    _frame(ax, static_map["f0"][static_map["printed"]], title)


def _called(name: str, types: Any) -> str:
    """The name of a type on a map: a LuGre body does not rest, it preslides."""
    return "presliding" if name == "rest" and (types == "presliding").any() else name


def _both_panel(both: Coexistence, ax: Any) -> None:
    _mesh(ax, both.f0, 1e3 * both.amplitude, both.two.astype(int), [TYPES["rest"], BOTH])
    _key(ax, [("one motion", TYPES["rest"]), ("two motions", BOTH)])
    _frame(ax, both.printed, "LuGre, from several starts")


def _frame(ax: Any, printed: Any, title: str) -> None:
    """Draw the lines common to the three maps: printed coefficients with figure numbers, and the inferred amplitude."""
    for number, f0 in zip((c.figure for c in CASES if c.section == "5.4"), printed, strict=True):
        ax.axvline(f0, color="white", linewidth=1.6)
        ax.axvline(f0, color="black", linestyle=(0, (1, 1.4)), linewidth=1.0)
        ax.text(
            f0, 0.97, f"{number}", transform=ax.get_xaxis_transform(), ha="center", va="top", fontsize=7, zorder=6,
            bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none"},
        )  # fmt: skip
    ax.axhline(1e3 * AMPLITUDE_5, color="white", linewidth=2.0)
    ax.axhline(1e3 * AMPLITUDE_5, color="black", linewidth=0.9)
    ax.set(xlabel="static coefficient $f_0$", ylabel="amplitude $A$ (mm)", xlim=(0.16, 1.02))
    ax.text(0.0, 1.13, title, transform=ax.transAxes, fontsize=8, ha="left", va="bottom")
