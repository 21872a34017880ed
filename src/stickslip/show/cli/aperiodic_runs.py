"""Output of ``stickslip run`` for a mechanism without a period: times of sticking and slipping, and number of slips."""

from __future__ import annotations

from collections import Counter
from typing import Any

from stickslip.show.cli import show


def record(study: Any, run: Any, written: list[str]) -> dict[str, Any]:
    """All results of the command, by name, in SI units."""
    from stickslip.analysis.energy import energy
    from stickslip.analysis.run_segments import shares
    from stickslip.analysis.steady import mean_velocity
    from stickslip.basics.fields import leaves
    from stickslip.models.machine_adapter import machine_of

    balance = energy(run)
    return {
        "robot": study.title(),
        "law": machine_of(run.model).law_names,
        "mechanism": type(run.model).__name__,
        "parameters": {name: float(value) for name, value in leaves(run.model)},
        "duration": float(run.pieces.t[-1] - run.pieces.t[0]),
        "mean_velocity": mean_velocity(run),
        "shares": shares(run),
        "events": dict(Counter(e.kind for e in run.events)),
        "velocity_max": float(run.v.max()),
        "velocity_min": float(run.v.min()),
        "energy": {**{n: float(getattr(balance, n).sum()) for n in ("drive", "friction")}, "worst_residual": balance.worst},
        "status": run.status,
        "notes": list(run.notes),
        "provenance": run.provenance,
        "written": written,
    }


def as_text(record: dict[str, Any]) -> str:
    """The record as text."""
    rows = [
        ("mechanism", f"{record['mechanism']} with {record['law']} friction"),
        ("mean velocity", show.quantity_text(record["mean_velocity"], "m/s")),
        ("velocity", f"{show.quantity_text(record['velocity_min'], 'm/s')} to {show.quantity_text(record['velocity_max'], 'm/s')}"),
        ("parts of the time", ", ".join(f"{name} {100 * share:.1f} %" for name, share in record["shares"].items())),
        ("events", ", ".join(f"{name} {n}" for name, n in record["events"].items()) or "none"),
        ("energy", f"drive {record['energy']['drive']:.4g} J, friction {record['energy']['friction']:.4g} J"),
        ("energy balance", f"worst residual {record['energy']['worst_residual']:.1e}"),
        ("status", f"{record['status']}, {record['duration']:.6g} s"),
    ]
    return show.run_text(record, rows, record["provenance"]["settings"]["method"])
