"""States of the page for its list of presets: stories of what such a robot can do, the paper's figures, and other drives."""

from __future__ import annotations

from typing import Any

from stickslip.paper.cases import CASES, EXPERIMENTS, OMEGA

__all__ = ["GROUPS", "PRESETS"]


def _entry(label: str, values: dict[str, float], also: tuple[str, ...] = ("coulomb",), **choices: str) -> dict[str, Any]:
    first = {"drive": "harmonic", "track": "folded", "law": "lugre", "also": list(also)}
    return {"label": label, "state": {**first, **choices, "values": values}}


def _of_the_paper() -> dict[str, dict[str, Any]]:
    found = {
        f"figure-{e.figure}": _entry(
            f"Figure {e.figure}: θ = {e.tilt_deg}°, type {e.type}", {"tilt_deg": e.tilt_deg, "amplitude": e.amplitude, "omega": OMEGA}
        )
        for e in EXPERIMENTS
    }
    for case in CASES:
        values = {"tilt_deg": case.tilt_deg, "amplitude": case.amplitude, "omega": OMEGA, **case.changes}
        found[f"figure-{case.figure}"] = _entry(f"Figure {case.figure}: {case.varied}", values)
    return found


_OTHERS = {
    "two-phase": _entry("Two-phase drive, level track", {}, drive="twophase", track="level", law="coulomb", also=()),
    "bang-bang": _entry("Bang-bang drive, level track", {}, drive="bangbang", track="level", law="coulomb", also=()),
    "beam": _entry("Piezo beam at 20 V and 32.7 Hz", {}, drive="piezobeam"),
}  # fmt: skip
_A_RIG = {"tilt_deg": 1.7, "omega": OMEGA}
_STORIES = {
    "inchworm": _entry("creeps like an inchworm: forwards, rest, forwards", {**_A_RIG, "amplitude": 3e-4}),
    "steps-back": _entry("slides back after each step forwards (type III)", {"tilt_deg": 2.7, "amplitude": 6.032e-4, "omega": OMEGA}),
    "never-rests": _entry("never rests (type IV)", {"tilt_deg": 5.7, "amplitude": 1.487e-3, "omega": OMEGA}),
    "period-two": _entry("period two: every other drive period is alike", {**_A_RIG, "amplitude": 6e-4, "mu0": 0.04}, also=()),
    "chaos": _entry("chaos: it never repeats", {**_A_RIG, "amplitude": 4e-4, "mu0": 0.05}, also=()),
}  # fmt: skip
#: The presets by name, in groups.
GROUPS: dict[str, dict[str, dict[str, Any]]] = {"stories": _STORIES, "the paper's figures": _of_the_paper(), "other drives": _OTHERS}
PRESETS: dict[str, dict[str, Any]] = {name: entry for group in GROUPS.values() for name, entry in group.items()}
"""Every preset by its name: a label, and a state in which only what differs from the page at first is given."""
