"""The paper's figures as states of the page, for its list of presets."""

from __future__ import annotations

from typing import Any

from stickslip.paper.cases import CASES, EXPERIMENTS, OMEGA

__all__ = ["PRESETS"]


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
PRESETS: dict[str, dict[str, Any]] = {**_of_the_paper(), **_OTHERS}
"""Every preset by its name: a label, and a state in which only what differs from the page at first is given."""
