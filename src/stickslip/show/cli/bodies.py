"""Output of ``stickslip run`` for a machine of several bodies: the motion of each body and contact, by name."""

from __future__ import annotations

from typing import Any

from stickslip.models.angular_coordinates import unit_of_part
from stickslip.show.cli import show


def record(study: Any, run: Any, written: list[str]) -> dict[str, Any]:
    """All results of the command, by name, in SI units."""
    from stickslip.analysis.steady import mean_velocity
    from stickslip.basics.fields import leaves
    from stickslip.models.machine_adapter import machine_of

    driven = run.model.period is not None
    return {
        "robot": study.title(),
        "law": machine_of(run.model).law_names,
        "machine": type(run.model).__name__,
        "velocity_unit": unit_of_part("v", run.model, ""),
        "parameters": {name: float(value) for name, value in leaves(run.model)},
        "mean_velocity": mean_velocity(run),
        "bodies": {name: _body(run, name) for name in run.body_columns},
        **(_motion(run) if driven else {}),
        "period_time": run.period_time if driven else None,
        "duration": float(run.pieces.t[-1] - run.pieces.t[0]),
        "energy": _energy(run),
        "status": run.status,
        **run.provenance["settings"],
        "counts": run.counts,
        "notes": list(run.notes),
        "steadiness": {"code": run.steadiness.code, "word": run.steadiness.word},
        "provenance": run.provenance,
        "written": written,
    }


def _body(run: Any, name: str) -> dict[str, Any]:
    """Mean velocity of one body, the range of its velocity over the averaging window, and their unit."""
    from stickslip.analysis.steady import mean_velocity

    v = run.body_columns[name].v[run.t >= run.window[0]]
    numbers = {"mean_velocity": mean_velocity(run, body=name), "velocity_max": float(v.max()), "velocity_min": float(v.min())}
    return numbers | {"velocity_unit": unit_of_part("v", run.model, name)}


def _motion(run: Any) -> dict[str, Any]:
    """The motion of each contact."""
    from dataclasses import asdict

    from stickslip.analysis.motion import motion

    m: Any = motion(run)
    contacts = {name: {k: v for k, v in asdict(each).items() if k != "_twin"} for name, each in m.contacts.items()}
    return {"contacts": contacts, "anchored": list(m.anchored), "period": m.period, "direction": m.direction}


def _energy(run: Any) -> dict[str, Any]:
    """Work per period, or the reason why it is unknown."""
    from stickslip.analysis.energy import energy
    from stickslip.basics.errors import InputError

    try:
        balance = energy(run)
    except InputError as error:
        return {"unknown": error.problems[0]}
    works = {name: float(getattr(balance, name)[balance.settle :].mean()) for name in ("drive", "friction", "damping")}
    return {**works, "worst_residual": balance.worst}


def as_text(record: dict[str, Any]) -> str:
    """The record as text."""
    work = record["energy"]
    driven, period = record["period_time"] is not None, record.get("period")
    per_second = record["velocity_unit"]
    mean = show.quantity_text(record["mean_velocity"], per_second)
    rows = [
        ("machine", f"{record['machine']} with {record['law']} friction"),
        ("mean velocity", mean if record["steadiness"]["code"] in (0, -1) else f"{mean}  ({record['steadiness']['word']})"),
        *((name, _of_body(body)) for name, body in record["bodies"].items()),
        *((f"contact {name}", _of_contact(m, name in record["anchored"])) for name, m in record.get("contacts", {}).items()),
        *([("repeats after", "not found" if period is None else show.counted(period, "drive period"))] if driven else []),
        *_balance(work, driven),
        ("status", f"{record['status']}, {record['duration']:.6g} s"),
    ]
    return show.run_text(record, rows, record["provenance"]["settings"]["method"])


def _of_body(body: dict[str, Any]) -> str:
    mean, low, high = (show.quantity_text(body[name], body["velocity_unit"]) for name in ("mean_velocity", "velocity_min", "velocity_max"))
    return f"mean velocity {mean}, velocity {low} to {high}"


def _of_contact(m: dict[str, Any], anchored: bool) -> str:
    shares = ", ".join(f"{name} {100 * m[f'{name}_fraction']:.1f} %" for name in ("forward", "backward", "stick"))
    return f"{'anchored' if anchored else m['type']}  (pattern {m['pattern']}; {shares})"


def _balance(work: dict[str, Any], driven: bool) -> list[tuple[str, str]]:
    """Work per period and the residual of the balance; values within rounding are left out."""
    if "unknown" in work:
        return [("energy", work["unknown"])]
    names = [n for n in ("drive", "friction", "damping") if n == "drive" or abs(work[n]) > 1e-12 * abs(work["drive"])]
    said = ", ".join(f"{name} {work[name]:.4g} J" for name in names)
    return [("energy per period" if driven else "energy", said), ("energy balance", f"worst residual {work['worst_residual']:.1e}")]
