"""The page's list of presets: typical motions of such a robot, the paper's figures, and other drives."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

from stickslip.show.paper.cases import CASES, EXPERIMENTS, OMEGA


def _entry(label: str, values: dict[str, float], also: Sequence[str] = ("coulomb",), **choices: str) -> dict[str, Any]:
    first = {"drive": "harmonic", "track": "folded", "law": "lugre", "also": list(also)}
    omega = {"omega": OMEGA} if "amplitude" in values else {}  # the law of the paper, with its amplitudes
    return {"label": label, "state": {**first, **choices, "values": values | omega | values}}


def _of_the_paper() -> dict[str, dict[str, Any]]:
    entries = {
        f"figure-{e.figure}": _entry(
            f"Figure {e.figure}: θ = {e.tilt_deg}°, type {e.type}", {"tilt_deg": e.tilt_deg, "amplitude": e.amplitude}
        )
        for e in EXPERIMENTS
    }
    for case in CASES:
        values = {"tilt_deg": case.tilt_deg, "amplitude": case.amplitude, **case.changes}
        entries[f"figure-{case.figure}"] = _entry(f"Figure {case.figure}: {case.varied}", values)
    return entries


def _of_file(group: str) -> dict[str, dict[str, Any]]:
    presets = tomllib.loads((files("stickslip.show.explorer") / "assets" / "presets.toml").read_text(encoding="utf-8"))
    return {name: _entry(**entry) for name, entry in presets[group].items()}


#: The presets by name, in groups.
GROUPS: dict[str, dict[str, dict[str, Any]]] = {
    "stories": _of_file("stories"),
    "other drives": _of_file("others"),
    "figures of the founding paper": _of_the_paper(),
}
PRESETS: dict[str, dict[str, Any]] = {name: entry for group in GROUPS.values() for name, entry in group.items()}
"""Every preset by its name: a label, and a state in which only what differs from the page at first is given."""
