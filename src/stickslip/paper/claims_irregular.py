"""Claims of section 5.3 about small kinetic friction: quasi-periodic at 0.03, period two at 0.04."""

from __future__ import annotations

import dataclasses
from typing import Any

from stickslip.paper.cases import CASES, rig
from stickslip.paper.claims_page import Claim, Part, Study, verdict
from stickslip.paper.followed_motions import Followed, followed
from stickslip.paper.section5_motions import Motion
from stickslip.paper.solved_runs import batch
from stickslip.paper.words import listed, millimetres, percent, plain, speed
from stickslip.report.html import grouped

__all__ = ["period_two", "quasi_periodic", "rk4_ladder"]

#: Steps per period of the fixed-step comparison; the last few only in the full run.
STEPS = (500, 1000, 1500, 2000, 2500, 3000, 5000, 10_000, 20_000, 50_000)
FAST_STEPS = (500, 1000, 2000, 3000, 5000)
#: ... with how many periods are run.
LONG_STEPS = ((200_000, 200), (1_000_000, 40))
TOLERANCES = (1e-6, 1e-8, 1e-10)
FIG22, FIG23 = (next(c for c in CASES if c.figure == n) for n in (22, 23))


def rk4_ladder(study: Study) -> tuple[dict[str, Any], ...]:
    """Classical RK4 at mu0 = 0.03 against steps per period: mean velocity and period number, where it stays finite.

    They are those of `ss.solve(robot, method="rk4", steps=N, keep="summary")`; verification/rk4_at_mu0_03.py prints the same rows.
    """
    found = []
    plan = [(n, 200) for n in (FAST_STEPS if study.fast else STEPS)] + ([] if study.fast else list(LONG_STEPS))
    for i, (steps, periods) in enumerate(plan):
        study.tell(f"Runge-Kutta with {grouped(steps)} steps per period at μ₀ = 0.03", i, len(plan))
        many = batch(rig(FIG22), method="rk4", steps=steps, periods=periods, workers=1)
        finite = int(many.status) <= 1
        found.append(
            {
                "steps": steps,
                "periods": periods,
                "velocity": float(many.mean_velocity) if finite else None,
                "period": int(many.period) if finite else None,
            }
        )
    return tuple(found)


def _converged(case: Any, method: str = "auto") -> list[tuple[float, float, int]]:
    """Tolerance, mean velocity and period number of a case."""
    many = [(rtol, batch(rig(case), rtol=rtol, method=method, periods=200)) for rtol in TOLERANCES]
    return [(rtol, float(m.mean_velocity), int(m.period)) for rtol, m in many]


def _steps(wrong: list[dict[str, Any]], what: str) -> str:
    """At which steps per period no period was found, or the velocity is negative."""
    found = [grouped(r["steps"]) for r in wrong if (r["period"] == 0 if what == "period" else r["velocity"] < 0)]
    return f"{listed(found)} steps" if found else "none of the step sizes"


def _judged(motion: Motion) -> str:
    """What multipliers and exponents say of a figure, as a sentence."""
    return f"Largest multiplier {motion.multiplier}, largest exponent {motion.exponents} per drive period: {motion.word}."


def quasi_periodic(study: Study) -> Claim:
    """Quasi-periodic at mu0 = 0.03."""
    wide = followed("amplitude", 1.25e-3, 3e-4, 1.25e-3, step=0.1, rtol=1e-6, mu0=0.03)
    once = wide.low.kind == "range"
    ours, judge, ladder = _converged(FIG22), [] if study.fast else _converged(FIG22, "rodas4"), rk4_ladder(study)
    best = ours[-1][1]
    spread = max(abs(v / best - 1) for _, v, _ in [*ours, *judge])
    wrong = [r for r in ladder if r["velocity"] is not None and abs(r["velocity"] / best - 1) > 0.1]
    right = [r for r in ladder if r not in wrong and r["velocity"] is not None]
    quasi = not once and all(p == 0 for _, _, p in ours)
    return Claim(
        "quasi_periodic",
        "5.3",
        "At μ₀ = 0.03 the motion is quasi-periodic (Figure 22).",
        "when the dynamic friction coefficient is μ0=0.03, the rigid body does a quasi-period motion",
        verdict(quasi),
        (
            f"The converged motion repeats after {listed(sorted({p for _, _, p in [*ours, *judge]}))} drive period, with a mean "
            f"velocity of {speed(best, 8)} "
            f"({'one method' if study.fast else 'two methods'}, tolerances from 10⁻⁶ to 10⁻¹⁰, largest relative difference "
            f"{plain(spread, 2)}).",
            _judged(study.motions[22]),
            f"By continuation of its orbit it has period one at every amplitude from {wide.low.text()} to 1.25 mm, with no multiplier "
            f"larger than {plain(wide.multiplier, 2)}" + ("." if once else f"; there it {wide.low.why}."),
            f"Here k₁ = {plain(rig(FIG22).friction.f_plus / rig(FIG22).friction.mu_plus, 3)} and μ₊ = "
            f"{plain(rig(FIG22).friction.mu_plus, 2)}: extremely stiff. Fixed-step Runge-Kutta "
            + (f"is wrong up to {grouped(wrong[-1]['steps'])} steps per period, " if wrong else "")
            + f"finds no period at {_steps(wrong, 'period')}, and moves backwards at {_steps(wrong, 'velocity')}."
            + (
                f" At {grouped(right[-1]['steps'])} steps it gives {speed(right[-1]['velocity'], 6)}, period {right[-1]['period']}."
                if right
                else ""
            ),
            "With too few steps Runge-Kutta can be irregular, as the paper describes its motion; at which step sizes depends on the "
            "rounding of the machine, so no single row proves anything.",
        ),
        f"high: {'several tolerances' if study.fast else 'independent methods'} agree, and the failure of the paper's method can be shown",
        {
            "converged": ours,
            "second_method": judge,
            "rk4": list(ladder),
            "period_one_from": wide.low.value,
            "period_one_to": wide.high.value,
            "largest_multiplier": wide.multiplier,
        },
    )


def period_two(study: Study) -> Claim:
    """Period two at mu0 = 0.04."""
    ours, found, near = _converged(FIG23), study.amplitudes.section5.period_two, study.around
    rows = study.amplitudes.section5.round_values
    parts = tuple(Part(f"A = {millimetres(r['amplitude'], 1)}", verdict(r["period"] == 2), _at(r)) for r in rows)
    return Claim(
        "period_two",
        "5.3",
        "At μ₀ = 0.04 the motion has period two (Figure 23).",
        "the motion of body M displays the dynamic behavior of period two shown in Fig. 23",
        verdict(all(p == 2 for _, _, p in ours)),
        (
            f"At A = 0.6 mm (inferred) the motion repeats after {listed(sorted({p for _, _, p in ours}))} drive periods at tolerances "
            f"from 10⁻⁶ to 10⁻¹⁰; mean velocity {speed(ours[-1][1], 8)}.",
            f"By continuation of its orbit the motion of period two is stable from {found.low.text()} mm, where it {found.low.why}, to "
            f"{found.high.text()} mm, where it {found.high.why} ({_sure(found)}).",
            f"{_judged(study.motions[23])} Along μ₀ the period doubles at {listed(near.rounded_flips)}.",
            f"On the map of {near.grid.period.size} pairs of μ₀ (0.03 to 0.21) and A (0.25 to 0.95 mm) "
            f"{percent(near.shares['period 2'])} have period two, {percent(near.shares['higher periods'])} a higher one, and "
            f"{percent(near.shares['chaotic'])} are chaotic: small kinetic friction does give more than the four types.",
        ),
        "high for the motion; that Figure 23 was drawn with 0.6 mm is inferred",
        {"converged": ours, "interval": dataclasses.asdict(found), "round_values": rows, "flips": near.flips, "shares": near.shares},
        parts,
    )


def _sure(found: Followed) -> str:
    """How accurate the ends of a motion are, in words."""
    known = [1e3 * end.accuracy for end in (found.low, found.high) if end.accuracy]
    if len(known) < 2:
        return "to the last digit printed"
    return f"both to {plain(max(known), 1)} mm"


def _at(row: dict[str, Any]) -> str:
    """The motion at one of the round amplitudes."""
    if row["period"]:
        return f"periodic, period {row['period']}, largest multiplier |λ| = {plain(row['multiplier'], 2)}"
    return f"{row['kind']}, largest exponent {plain(row['exponent'], 2)} ± {plain(row['error'], 1)} per drive period"
