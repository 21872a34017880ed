"""Figures of our own that carry the verdicts: step sizes, period numbers, types by the static coefficient, amplitudes."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.paper.amplitudes import ROUNDING, Amplitudes, Bracket
from stickslip.paper.cases import AMPLITUDE_5
from stickslip.paper.claims import Claim, Study
from stickslip.paper.drawing import COULOMB, LUGRE, Picture, render
from stickslip.paper.words import listed, millimetres, plain, speed
from stickslip.plot.style import INK

__all__ = ["draw"]

#: Colours of motion types and of period numbers (Okabe and Ito 2008), light for what does not slide.
TYPES = {"rest": "#E4E7EB", "presliding": "#E4E7EB", "II": "#56B4E9", "I": "#0072B2", "III": "#E69F00", "IV": "#D55E00", "other": "#333333"}
PERIODS = (("1", "#E4E7EB"), ("2", "#56B4E9"), ("3 to 16", "#E69F00"), ("none found", "#333333"))


def draw(study: Study, claims: tuple[Claim, ...], folder: Path) -> tuple[Picture, ...]:
    """Draw all of them."""
    study.tell("drawing the evidence", 0, 4)
    pictures = (
        _amplitudes(study.amplitudes, folder),
        _ladder(next(c for c in claims if c.key == "quasi_periodic").numbers, folder),
        _periods(study.period_map, folder),
        _static(study.static_map, folder),
    )
    study.tell("drawing the evidence", 4, 4)
    return pictures


# ---- amplitudes of section 4 ----
def _amplitudes(found: Amplitudes, folder: Path) -> Picture:
    text = "; ".join(f"{b.experiment.tilt_deg}°: {millimetres(b.good[0])} to {millimetres(b.good[1])}" for b in found.section4 if b.good)
    return render(
        folder,
        "evidence-amplitudes",
        [partial(_bracket, b) for b in found.section4],
        title="Which amplitudes reproduce section 4",
        caption="Computed mean velocity against amplitude; bands: the printed values with half a digit to either side. Shaded: "
        "amplitudes of the printed type "
        "that reproduce both printed velocities (at 1.7°: the one with Coulomb friction). Line: the amplitude taken.",
        alt=f"Four panels, one for each angle. Amplitudes that fit: {text}.",
        section="evidence",
    )


def _bracket(b: Bracket, ax: Any) -> None:
    e, A = b.experiment, 1e3 * b.scan["amplitude"]
    for printed, style, name, values in ((e.coulomb, COULOMB, "Coulomb", b.scan["coulomb"]), (e.lugre, LUGRE, "LuGre", b.scan["lugre"])):
        ax.axhspan(1e3 * (printed - ROUNDING), 1e3 * (printed + ROUNDING), color=style["color"], alpha=0.16, linewidth=0)
        ax.plot(A, 1e3 * values, **style, label=name)
    if b.good:
        ax.axvspan(1e3 * b.good[0], 1e3 * b.good[1], color="#999999", alpha=0.3, linewidth=0)
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
    text = listed(f"{speed(r['velocity'], 3)} at {r['steps']}" for r in ladder)
    return render(
        folder,
        "evidence-step-size",
        [partial(_steps, ladder, best)],
        height=2.4,
        title="Fixed steps at μ₀ = 0.03 (Figure 22)",
        caption="Mean velocity by classical Runge-Kutta against steps per drive period, from rest; line: the converged value. Filled: "
        "a period was found; open: none. "
        "What is missing blew up.",
        alt=f"Mean velocities: {text}; converged {speed(best)}.",
        section="evidence",
    )


def _steps(ladder: list[dict[str, Any]], best: float, ax: Any) -> None:
    ax.axhline(0.0, color=INK, linewidth=0.5)
    ax.axhline(1e3 * best, color=LUGRE["color"], linewidth=1.2)
    ax.text(0.02, 1e3 * best, "converged, period 1", transform=ax.get_yaxis_transform(), color=LUGRE["color"], va="bottom", fontsize=7)
    ax.plot([r["steps"] for r in ladder], [1e3 * r["velocity"] for r in ladder], color=COULOMB["color"], linewidth=0.6)
    for r in ladder:
        ax.plot(
            r["steps"],
            1e3 * r["velocity"],
            "o",
            color=COULOMB["color"],
            markerfacecolor=COULOMB["color"] if r["period"] else "white",
            markersize=5,
        )
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
        bbox_to_anchor=(-0.12, 1.0),
        ncols=len(patches),
        handlelength=1.0,
        columnspacing=0.9,
        handletextpad=0.4,
        borderaxespad=0.2,
    )


def _periods(found: dict[str, Any], folder: Path) -> Picture:
    p = found["period"]
    shares = {"1": np.mean(p == 1), "2": np.mean(p == 2), "3 to 16": np.mean(p > 2), "none": np.mean(p == 0)}
    return render(
        folder,
        "evidence-periods",
        [partial(_period_panel, found)],
        height=2.9,
        title="Period numbers at small kinetic friction",
        caption="Converged LuGre motion at 1.7°, 200 periods from rest. Circles: Figures 22 (μ₀ = 0.03), 23 (0.04) and 24 (0.05) at "
        "the inferred 0.6 mm. "
        "Higher periods and irregular motion exist, but not at μ₀ = 0.03. Along borders the transient outlasts the run, and no period "
        "is found.",
        alt="Map over kinetic coefficient and amplitude. Shares of the map: "
        + ", ".join(f"period {k}: {plain(100 * v, 2)} %" for k, v in shares.items())
        + ".",
        section="evidence",
    )


def _period_panel(found: dict[str, Any], ax: Any) -> None:
    p = found["period"]
    index = np.where(p == 1, 0, np.where(p == 2, 1, np.where(p > 2, 2, 3)))
    _mesh(ax, found["mu0"], 1e3 * found["amplitude"], index, [colour for _, colour in PERIODS])
    ax.plot([0.03, 0.04, 0.05], [1e3 * AMPLITUDE_5] * 3, "o", color="#D55E00", markeredgecolor="white", markersize=5, clip_on=False)
    ax.set(xlabel="kinetic coefficient $\\mu_0$", ylabel="amplitude $A$ (mm)")
    _key(ax, [("period " + name if i == 0 else name, colour) for i, (name, colour) in enumerate(PERIODS)])


def _static(found: dict[str, Any], folder: Path) -> Picture:
    words = next(iter(found["words"].values()))
    return render(
        folder,
        "evidence-static-friction",
        [
            partial(_type_panel, found, found["exact"], "exact, break-away at $f_0$"),
            partial(_type_panel, found, words, "LuGre words, default thresholds"),
        ],
        height=2.9,
        title="Motion types by the static coefficient",
        caption="Dotted: the four coefficients of Figures 27 to 30; line: the inferred 0.6 mm. No horizontal line meets the four types "
        "at the four dotted ones.",
        alt="Two maps of motion types over static coefficient and amplitude. With growing static coefficient the motion passes from "
        "type IV or III through I and II to rest.",
        section="evidence",
    )


def _type_panel(found: dict[str, Any], types: Any, title: str, ax: Any) -> None:
    order = ["rest", "II", "I", "III", "IV", "other"]
    index = np.select([types == name for name in order[1:-1]] + [np.isin(types, ("rest", "presliding"))], [1, 2, 3, 4, 0], 5)
    _mesh(ax, found["f0"], 1e3 * found["amplitude"], index, [TYPES[name] for name in order])
    for place in found["printed"]:
        ax.axvline(found["f0"][place], color="white", linewidth=1.8, clip_on=False)
        ax.axvline(found["f0"][place], color="black", linestyle=(0, (1, 1)), linewidth=1.2, clip_on=False)
    ax.axhline(1e3 * AMPLITUDE_5, color="white", linewidth=2.0)
    ax.axhline(1e3 * AMPLITUDE_5, color="black", linewidth=0.9)
    ax.set(xlabel=f"static coefficient $f_0$ ({title})", ylabel="amplitude $A$ (mm)")
    _key(ax, [(name if name != "rest" else "rest, presliding", TYPES[name]) for name in order])
