"""Output of ``stickslip run`` for a flow: the motion of its states, its modes, and the work at its contacts."""

from __future__ import annotations

from typing import Any

from stickslip.show.cli import show


def record(study: Any, run: Any, written: list[str]) -> dict[str, Any]:
    """All results of the command, by name, in the flow's own units."""
    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import motion

    m: Any = motion(run)
    taken = energy(run).friction_of if run.contacts else {}
    return {
        "robot": study.title(),
        "parameters": {name: float(value) for name, value in run.model.numbers.items()},
        "motion": {"type": m.type, "period": m.period, "time_until_it_repeats": m.duration if m.period else None},
        "states": {name: {"min": low, "max": high} for name, (low, high) in m.ranges.items()},
        "end": dict(zip(run.names, map(float, run.state), strict=True)),
        "modes": {str(mode): share for mode, share in m.modes.items()},
        "mean_rates": m.mean_rates,
        "friction": {name: float(work[min(run.settle, len(work) - 1) :].mean()) for name, work in taken.items()},
        "forced": run.model.period is not None,
        "switches": len(run.events),
        "duration": float(run.nodes[-1] - run.nodes[0]),
        "method": run.method,
        "status": run.status,
        "notes": list(run.notes),
        "provenance": run.provenance,
        "written": written,
    }


def as_text(record: dict[str, Any]) -> str:
    """The record as text."""
    motion, turn = record["motion"], "forcing period" if record["forced"] else "turn"
    repeats = f"{motion['period']} {turn}{'s' * (motion['period'] > 1)}, {motion['time_until_it_repeats']:.9g}" if motion["period"] else ""
    rows = [
        ("motion", motion["type"]),
        *([("repeats after", repeats)] if repeats else []),
        *((name, f"{of['min']:.6g} to {of['max']:.6g}, {record['end'][name]:.9g} at the end") for name, of in record["states"].items()),
        *((f"mean rate of {name}", f"{rate:.9g}") for name, rate in record["mean_rates"].items()),
        ("modes", ", ".join(f"{mode} {100 * share:.1f} %" for mode, share in record["modes"].items())),
        *(
            (f"friction of {name}", f"takes {work:.6g}{' a period' if record['forced'] else ''}")
            for name, work in record["friction"].items()
        ),
        ("status", f"{record['status']}, {record['duration']:.6g}, {show.counted(record['switches'], 'change') + ' of mode'}"),
    ]
    return show.run_text(record, rows, record["method"])
