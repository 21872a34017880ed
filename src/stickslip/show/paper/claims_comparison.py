"""Claims of sections 2 to 4: anisotropy, the folded incline, four types, and which law is closer to the experiment."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.show.paper.cases import EXPERIMENTS, rig
from stickslip.show.paper.claims_page import IN_PART, ClaimData, PaperClaim, judged, together
from stickslip.show.paper.solved_runs import batch, scaled_velocity

__all__ = [
    "anisotropy",
    "closer_in_number",
    "closer_in_shape",
    "folding_coulomb",
    "folding_lugre",
    "four_types",
    "six_groups",
    "type_four_same",
]


def anisotropy(study: ClaimData) -> PaperClaim:
    """Net motion by anisotropy."""
    A = np.linspace(2e-4, 1.5e-3, 14 if study.fast else 53)
    level, forwards, mirrored = (
        {law: scaled_velocity(rig(EXPERIMENTS[0], amplitude=A, law=law, tilt_deg=tilt)) for law in ("coulomb", "lugre")}
        for tilt in (0.0, 1.7, -1.7)
    )
    moving = A[forwards["coulomb"] > 0.0]
    numbers: dict[str, Any] = {
        "isotropic_over_scale": {law: float(abs(w).max()) for law, w in level.items()},
        "mirror_over_scale": {law: float(abs(w + mirrored[law]).max()) for law, w in forwards.items()},
        "largest_over_scale": float(forwards["coulomb"].max()),
    }
    still = max(numbers["isotropic_over_scale"].values()) < 1e-5 and max(numbers["mirror_over_scale"].values()) < 1e-4
    holds = still and len(moving) and (forwards["lugre"][-len(moving) :] > 0).all()
    return judged("anisotropy", holds, numbers, A=A, still=A[forwards["coulomb"] == 0.0])


def folding_coulomb(study: ClaimData) -> PaperClaim:
    """Folding an incline into friction, Coulomb."""
    tilt, A = np.array([e.tilt_deg for e in EXPERIMENTS]), np.array([e.amplitude for e in EXPERIMENTS])
    folded, gravity = (
        batch(rig(EXPERIMENTS[0], tilt_deg=tilt, amplitude=A, law="coulomb-static", incline=i), periods=200).mean_velocity
        for i in ("folded", "gravity")
    )
    difference = abs(gravity / folded - 1).max()
    return judged("folding_coulomb", difference < 1e-10, {"folded": folded.tolist(), "gravity": gravity.tolist()}, difference=difference)


def folding_lugre(study: ClaimData) -> PaperClaim:
    """Folding an incline into friction, LuGre."""
    sizes = [abs(r.gravity / r.lugre - 1) for r in study.table]
    parts = [(size < 1e-3, {"r": r}) for r, size in zip(study.table, sizes, strict=True)]
    numbers = {"folded": [r.lugre for r in study.table], "gravity": [r.gravity for r in study.table]}
    return judged("folding_lugre", max(sizes) < 1e-3, numbers, parts, sizes=sizes)


def four_types(study: ClaimData) -> PaperClaim:
    """Four types of motion."""
    parts = [(r.type == r.experiment.type, {"r": r}) for r in study.table]
    numbers = {"types": [r.type for r in study.table], "lugre_words": [r.lugre_words for r in study.table]}
    return judged("four_types", all(holds for holds, _ in parts), numbers, parts, table=study.table)


def six_groups(study: ClaimData) -> PaperClaim:
    """Six groups of experiments."""
    tilts = sorted({e.tilt_deg for e in EXPERIMENTS})
    return judged("six_groups", None if len(tilts) < 6 else True, {"reported": len(tilts)}, tilts=tilts)


def closer_in_number(study: ClaimData) -> PaperClaim:
    """LuGre closer in number."""
    e = [r.experiment for r in study.table]
    measured = np.array([x.measured for x in e])
    velocities = {
        "printed": {"coulomb": [x.coulomb for x in e], "lugre": [x.lugre for x in e]},
        "computed": {"coulomb": [r.coulomb for r in study.table], "lugre": [r.lugre for r in study.table]},
    }
    errors = {kind: {law: _errors(np.array(v), measured) for law, v in both.items()} for kind, both in velocities.items()}
    parts = [
        (
            by_law["lugre"][measure] < by_law["coulomb"][measure],
            {"label": f"{measure}, {kind} velocities", "by_law": by_law, "measure": measure},
        )
        for kind, by_law in errors.items()
        for measure in by_law["lugre"]
    ]
    at = [(r.closer == "LuGre", {"label": f"{r.experiment.tilt_deg}°", "r": r, "measure": None}) for r in study.table]
    away = [r.experiment.tilt_deg for r in study.table if r.closer != "LuGre"]
    spread = {law: (np.array(v) / measured - 1).tolist() for law, v in velocities["computed"].items()}
    holds = together(*(part for part, _ in [*parts, *at]))
    return judged("closer_in_number", holds, {"errors": errors, "relative": spread}, [*parts, *at], away=away, table=study.table)


def _errors(velocity: Any, measured: Any) -> dict[str, float]:
    """Mean and root mean square of the relative error, and root mean square of the error [m/s]."""
    relative = velocity / measured - 1
    return {
        "mean relative error": float(abs(relative).mean()),
        "r.m.s. relative error": float(np.sqrt((relative**2).mean())),
        "r.m.s. error": float(np.sqrt(((velocity - measured) ** 2).mean())),
    }


def closer_in_shape(study: ClaimData) -> PaperClaim:
    """LuGre closer in shape."""
    peaks, turns = {}, {}
    for e in EXPERIMENTS:
        _, lugre, rest = _curves(study, e)
        if rest.any():
            peaks[str(e.tilt_deg)] = float(abs(lugre[rest]).max()), float(abs(lugre).max())
            turns[str(e.tilt_deg)] = _turns(lugre, rest)
    curved = all(sum(counts) > 0 for counts in turns.values())
    numbers = {"velocity_at_rest_and_peak": peaks, "turning_points_in_each_rest": turns}
    return judged("closer_in_shape", IN_PART if curved else None, numbers, [(curved, {}), (None, {})])


def _turns(v: Any, rest: Any) -> list[int]:
    """The number of maxima and minima of the LuGre velocity in each interval in which the Coulomb body rests."""
    start = int(np.argmin(rest))  # begin in sliding: no rest is cut in two
    v, rest = np.roll(v, -start), np.roll(rest, -start)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], rest, [False]]).astype(int)))
    signs = [np.sign(np.diff(v[a:b])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return [int((s[1:] != s[:-1]).sum()) for s in signs]


def _curves(study: ClaimData, e: Any) -> tuple[Any, Any, Any]:
    """Both velocities over the last period, and the mask of rest of the Coulomb body."""
    run, other = study.runs.coulomb[e.name], study.runs.lugre[e.name]
    t = np.linspace(run.strobe_times[-2], run.strobe_times[-1], 4001)[:-1]
    exact = run.at(t)
    return exact["v"], other.at(t)["v"], exact["mode"] == 0


def type_four_same(study: ClaimData) -> PaperClaim:
    """Type four cannot tell the laws apart."""
    rows = {}
    for r in study.table:
        coulomb, lugre, _ = _curves(study, r.experiment)
        shape = float(np.sqrt(np.mean((lugre - coulomb) ** 2) / np.mean(coulomb**2)))
        rows[r.type] = {"curve": shape, "mean": abs(r.lugre / r.coulomb - 1)}
    others, same = {k: row for k, row in rows.items() if k != "IV"}, rows["IV"]
    holds = max(same.values()) < 0.05 and all(same[name] < row[name] for row in others.values() for name in same)
    return judged("type_four_same", holds, rows, others=others, tilt=EXPERIMENTS[-1].tilt_deg)
