"""The claims about a law, each a function that measures it."""

from __future__ import annotations

import dataclasses
import math
import random
from typing import TYPE_CHECKING, Any

from stickslip.analysis.bench.probe import Probe
from stickslip.analysis.law_claims.moved_contact import burst, reversed_at_limit, shaken
from stickslip.analysis.law_claims.reports import Claim, LawReport, claim_of
from stickslip.analysis.law_claims.symbol_values import traced
from stickslip.analysis.law_claims.unit_change import FACTORS, in_other_units
from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Law
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.fields import checked_number, example_in, is_array, leaves
from stickslip.basics.quantities import between
from stickslip.engine.law_checks import ARGUMENTS, check_signatures, finite
from stickslip.models.friction.law_adapter import adapted, mirrored_law

if TYPE_CHECKING:
    from stickslip.models.friction.law_adapter import LawAdapter


#: Rounding errors of formulas that are equal on paper, and of integrals with a relative tolerance of 1e-8.
_SAME, _SAME_WORK = 1e-11, 1e-5
#: A change of the states at a reversal, of themselves, and what it may change of the forces after it.
_BESIDE, _SAME_AFTER = 1e-9, 1e-5
#: Strokes in typical deflections and largest velocities in typical velocities; velocities of a burst.
MOTIONS = ((0.3, 1.0), (3.0, 1.0), (3.0, 0.1), (3.0, 10.0), (10.0, 1.0))
BURSTS = (10.0, 1000.0)


@explains_arguments
def check_law(law: Any, load: float = 1.0, raise_: bool = True) -> LawReport:
    """Check a law against the claims for which the built-in laws are tested.

    The claims are: its numbers are finite; a contact at rest stays at rest; sliding friction opposes motion; a closed cycle dissipates
    energy; reflection exchanges plus and minus; the formula survives a change of units (where the docstring gives them in brackets, as in
    ``[N/m]``); numbers, arrays and the engine's symbols give the same result; a law with discrete memory, reversed at its limits, goes on
    alike when it is restarted there from states that differ by rounding. The energy that the law returns in excess of what it received
    from its initial state on is measured: it is zero for a passive law.

    Parameters
    ----------
    law : law, or its class
        A class needs a classmethod ``example()``, or defaults and ``field(metadata={"example": "0.15"})``.
    load : float
        Normal force [N].
    raise_ : bool
        Whether to raise an error if claims fail.

    Returns
    -------
    LawReport

    Raises
    ------
    InputError
        If claims fail; the message names all of them, with remedies.

    Examples
    --------
    >>> import stickslip as ss
    >>> report = ss.testing.check_law(ss.Dahl)
    >>> report.passed, report["energy given back"].value
    (True, 0.0)
    """
    law = _instance(law)
    problems = Problems("check_law")
    checked_number("load", load, problems, between(1e-100, 1e100), "one positive load [N]", "load=1.0")
    problems.check()
    _check_methods(law, float(load))
    probe = Probe(law, float(load))
    with finite(law):
        claims = [_finite(probe)]
        if claims[0].passed:
            try:
                claims += _of_motions(probe)
            except SolveError as error:
                claims.append(claim_of("endless", False, math.nan, error=error))
    report = LawReport(type(law).__name__, tuple(claims))
    if raise_ and report.failures:
        raise InputError(report.law, [f"{c.name}: {_measured(c)}{c.meaning}; {c.remedy}" for c in report.failures])
    return report


def _of_motions(probe: Probe) -> list[Claim]:
    """All claims but that numbers are finite."""
    runs = _cycles(probe)
    claims = [_rest(probe), _opposes(probe), _costs(runs), _gives_back(probe, runs)]
    claims += [make(probe) for make in (_restarts, _mirror, _other_units, _arrays, _symbols)]
    return [claim for claim in claims if claim is not None]


def _instance(law: Law) -> Any:
    if isinstance(law, type):
        law = law.example() if hasattr(law, "example") else example_in(law)
    if not dataclasses.is_dataclass(law) or not (hasattr(law, "sliding") or hasattr(law, "rate")):
        raise InputError(
            "check_law", [f"{law!r} is not a law; allowed is a dataclass with rate and force or with sliding and breakaway; type "
                          "for example check_law(MyLaw(mu=0.2))"],
        )  # fmt: skip
    many = [name for name, value in leaves(law) if is_array(value)]
    if many:
        raise InputError("check_law", [f"{', '.join(many)} of the law are arrays; allowed is one law, no batch; take one case of it"])
    return law


def _check_methods(law: LawAdapter, load: float) -> None:
    """Check that the methods of a law exist and take the required arguments, and that breakaway returns two forces."""
    problems = Problems(type(law).__name__)
    pairs = (("sliding", "breakaway"), ("rate", "force"))
    for one, other in pairs if not any(hasattr(law, one) and hasattr(law, other) for one, other in pairs) else ():
        if hasattr(law, one):
            problems.add(f"it has {one} and no {other}; type def {other}(self, {', '.join(ARGUMENTS[other])})")
    problems.check()
    check_signatures(law)
    if not adapted(law).dynamic:
        forces = law.breakaway(load)
        if not isinstance(forces, (tuple, list)) or len(forces) != 2:
            problems.add(f"breakaway gives {forces!r}; allowed are two forces; type return backward, forward (the first is negative)")
    problems.check()


def _measured(claim: Claim) -> str:
    return "" if math.isnan(claim.value) else f"{claim.value:.3g} "


def _points(probe: Probe, count: int = 60) -> list[tuple[float, tuple[float, ...], tuple[int, ...], float]]:
    """Velocities, states, memories and applied forces over the typical ranges of the law; always the same ones."""
    draw = random.Random(1)
    points = []
    for k in range(count):
        v = (-1) ** k * probe.velocity_scale * 10 ** draw.uniform(-2, 1)
        z = tuple(draw.uniform(-1.2, 1.2) * size for size in probe.scale)
        points.append((v, z, (k // 2 % 2,) * probe.law.modes, draw.uniform(-0.5, 0.5) * probe.load))
    return points


def _all_values(probe: Probe, v: Any, z: Any, mode: Any, applied: Any) -> tuple[Any, ...]:
    force, rates = probe.response(v, z, mode, applied)
    return (force, *rates)


def _difference(these: Any, those: Any) -> float:
    """Largest relative difference of numbers that should be equal; magnitudes below 1e-9 count as 1e-9."""
    return max((abs(a - b) / max(abs(a), abs(b), 1e-9) for a, b in zip(these, those, strict=True)), default=0.0)


def _finite(probe: Probe) -> Claim:
    bad = total = 0
    at_rest = [(0.0, z, mode, applied) for _, z, mode, applied in _points(probe, 8)]
    for point in [*_points(probe), *at_rest]:
        try:
            values = [float(value) for value in _all_values(probe, *point)]
        except (ValueError, ZeroDivisionError, OverflowError):
            values = [math.nan]
        bad, total = bad + sum(not math.isfinite(value) for value in values), total + len(values)
    return claim_of("finite", bad == 0, bad, total=total)


def _rest(probe: Probe) -> Claim | None:
    """A contact at rest does not change; its static friction limits enclose zero and the friction of sliding."""
    if probe.law.dynamic:
        if not probe.law.states:
            return None
        worst = max(_change_at_rest(probe, z) for _, z, _, _ in _points(probe)) / probe.velocity_scale
        return claim_of("states_rest", worst <= _SAME, worst)
    low, high = probe.law.breakaway(probe.load)
    tiny = 1e-9 * probe.velocity_scale
    lack = max(low, -high, probe.force(tiny, (), ()) - high, low - probe.force(-tiny, (), ()), 0.0)
    return claim_of("limits_enclose", lack <= 1e-6 * probe.load, lack)


def _change_at_rest(probe: Probe, z: tuple[float, ...]) -> float:
    """Largest rate of a state at v = 0; 0 if the force at rest does not change with it, as when a contact ages."""
    mode = (0,) * probe.law.modes
    force, rates = probe.response(0.0, z, mode)
    largest = max(abs(float(rate)) for rate in rates)
    if largest == 0.0:
        return 0.0
    step = 1e-3 * min(probe.scale) / largest
    later = probe.force(0.0, tuple(zi + step * rate for zi, rate in zip(z, rates, strict=True)), mode)
    return largest if abs(later - force) > _SAME * probe.load else 0.0


def _opposes(probe: Probe) -> Claim | None:
    if probe.law.states or probe.law.needs_applied:
        return None
    wrong = max(max(-math.copysign(1.0, v) * probe.force(v, z, mode) for v, z, mode, _ in _points(probe)), 0.0)
    return claim_of("opposes", wrong <= 0, wrong)


def _cycles(probe: Probe) -> list[dict[str, float]]:
    """Reciprocating motion over several strokes at several velocities, beginning forwards and backwards."""
    reach, motions = max(probe.scale, default=0.01), MOTIONS[:2] if not probe.law.compiles else MOTIONS
    return [shaken(probe, a * reach, side * w * probe.velocity_scale) for a, w in motions for side in (1.0, -1.0)]


def _costs(runs: list[dict[str, float]]) -> Claim:
    least = min(run["loss"] / max(run["loss_turned"], 1e-300) for run in runs)
    return claim_of("costs", least >= -1e-4, least)


def _gives_back(probe: Probe, runs: list[dict[str, float]]) -> Claim:
    """Reciprocating motion, and a slow push followed by a sudden burst, which reveals violations of Barabanov and Ortega's condition."""
    reach, speed = 4.0 * max(probe.scale, default=0.01), probe.velocity_scale
    bursts = [burst(probe, reach, 0.01 * side * speed, fast * side * speed) for fast in BURSTS for side in (1.0, -1.0)]
    most = max(-run["least"] / max(run["turned"], 1e-300) for run in [*runs, *bursts])
    most = most if most > 1e-9 else 0.0
    return claim_of("gives_back", None, most)


def _restarts(probe: Probe) -> Claim | None:
    """A law with a memory, slid to its limits and reversed: from states that differ there by rounding it goes on alike."""
    if not probe.law.modes:
        return None
    reach, worst = max(probe.scale, default=0.01), 0.0
    for side in (1.0, -1.0):
        forces = [reversed_at_limit(probe, reach, side, by) for by in (0.0, _BESIDE, -_BESIDE)]
        size = max(probe.load, *map(abs, forces[0]))
        worst = max([worst, *(abs(a - b) / size for other in forces[1:] for a, b in zip(forces[0], other, strict=True))])
    return claim_of("restarts", worst <= _SAME_AFTER, worst)


def _mirror(probe: Probe) -> Claim:
    other = Probe(mirrored_law(probe.law.law), probe.load)
    worst = min(_unmirrored(probe, other, turns) for turns in (-1.0, 1.0))
    if probe.law.modes:
        stroke = 3.0 * max(probe.scale, default=0.01)
        one, two = (shaken(p, stroke, side * probe.velocity_scale, cycles=1) for p, side in ((probe, 1.0), (other, -1.0)))
        apart = abs(one["turned"] - two["turned"]) / one["turned"]
        worst = max(worst, apart if apart > _SAME_WORK else 0.0)
    return claim_of("mirror", worst <= _SAME, worst)


def _unmirrored(probe: Probe, other: Probe, turns: float) -> float:
    """Deviation of two laws from mirror images, if their states change sign (-1: deflections) or keep it (1: ages)."""
    worst, rest = 0.0, (0,) * probe.law.modes
    for v, z, _, applied in _points(probe):
        force, *rates = _all_values(probe, v, z, rest, applied)
        there = _all_values(other, -v, tuple(turns * zi for zi in z), rest, -applied)
        worst = max(worst, _difference([-force, *(turns * rate for rate in rates)], there))
    return worst


def _other_units(probe: Probe) -> Claim:
    try:
        law = in_other_units(probe.law.law)
    except LookupError as error:
        return claim_of("no_units", None, math.nan, field=error)
    other, worst = Probe(law, FACTORS["N"] * probe.load), 0.0
    own = probe.law.scale(probe.load) is not None
    sizes = [new / old if own else FACTORS["m"] for new, old in zip(other.scale, probe.scale, strict=True)]
    for v, z, mode, applied in _points(probe):
        here = _all_values(probe, v, z, mode, applied)
        moved = tuple(size * zi for size, zi in zip(sizes, z, strict=True))
        there = _all_values(other, v * FACTORS["m"] / FACTORS["s"], moved, mode, FACTORS["N"] * applied)
        by = [FACTORS["N"], *(size / FACTORS["s"] for size in sizes)]
        worst = max(worst, _difference([b * value for b, value in zip(by, here, strict=True)], there))
    return claim_of("units", worst <= 1e-9, worst)


def _arrays(probe: Probe) -> Claim | None:
    import numpy as np

    if not probe.law.compiles:
        return None
    points = _points(probe)
    v, applied = (np.array([point[k] for point in points]) for k in (0, 3))
    z, mode = (tuple(np.array(column) for column in zip(*(point[k] for point in points), strict=True)) for k in (1, 2))
    try:
        at_once = [np.broadcast_to(np.asarray(value, float), v.shape) for value in _all_values(probe, v, z, mode, applied)]
    except (TypeError, ValueError) as error:
        return claim_of("no_arrays", False, math.nan, error=error)
    single = np.array([_all_values(probe, *point) for point in points], float).T
    worst = _difference(np.ravel(at_once), np.ravel(single))
    return claim_of("arrays", worst <= _SAME, worst)


def _symbols(probe: Probe) -> Claim | None:
    if not probe.law.compiles:
        return None
    worst = 0.0
    try:
        for v, z, mode, applied in _points(probe):
            worst = max(worst, _difference(_all_values(probe, v, z, mode, applied), traced(probe.law.law, probe.load, v, z, mode, applied)))
    except (TypeError, ValueError, AttributeError) as error:
        return claim_of("no_symbols", False, math.nan, error=error)
    return claim_of("symbols", worst <= 1e-9, worst)
