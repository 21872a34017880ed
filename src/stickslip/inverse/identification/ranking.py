"""`rank`: which law do the data support, and can they tell at all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import described_as, explains_arguments
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.phrases import listed
from stickslip.inverse.identification.covariance import effective
from stickslip.inverse.identification.fit import Fit
from stickslip.inverse.identification.uncertainty import at_zero, faults
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.records.record import Record

#: A difference of AICc below which data do not tell two laws apart (Burnham and Anderson 2002), here for corrected sample sizes.
UNDECIDED = 4.0


@dataclass(frozen=True)
class Ranked:
    """One law in the ranking.

    Parameters
    ----------
    label : str
    parameters : int
        Fit numbers, phases included.
    rms : float
        Of the residuals over all records, in standard deviations of the noise as the fits see it.
    aicc, bic : float
        Information criteria, less those of the best law. Sample size counts independent residuals only.
    weight : float
        Akaike weight.
    held_out : float
        Rms on records that were not fitted [SI]; NaN where there are none.
    faults : tuple of str
        Why the fit is not one of a law that holds: correlated or too large residuals, numbers at bounds, a search that was interrupted.
    """

    label: str
    parameters: int
    rms: float
    aicc: float
    bic: float
    weight: float
    held_out: float
    faults: tuple[str, ...] = ()


@described_as("what ss.identification.rank returns; type ss.identification.rank([fit, another_fit])")
@sealed
@dataclass(frozen=True, eq=False, repr=False)
class Ranking(Drawn):
    """Laws in the order in which the data support them, and the verdict.

    Parameters
    ----------
    rows : tuple of Ranked
        The best first.
    decided : bool
        Whether the data tell the first from the second.
    verdict : str
        One sentence.
    effective : float
        Independent values in the data.
    count : int
        Values in the data.
    supported : tuple of str
        The laws that the data support: whose fits have no fault and are within 4 of the least AICc of such fits. None where no law fits.
    """

    rows: tuple[Ranked, ...]
    decided: bool
    verdict: str
    effective: float
    count: int
    supported: tuple[str, ...] = ()

    _drawn_by = "ranking"

    @property
    def reason(self) -> str:
        """Why the data support what they do: the verdict, and the faults of the fits."""
        return "; ".join([self.verdict, *(f"{row.label}: {fault}" for row in self.rows for fault in row.faults)])

    @property
    def best(self) -> Ranked:
        """The first."""
        return self.rows[0]

    def __str__(self) -> str:
        widths = (max(len(r.label) for r in self.rows), 7, 9, 9, 9, 6, 8)
        rows = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False)).rstrip() for row in self._tables()[0]]
        return "\n".join([*rows, *(f"{r.label}: {fault}" for r in self.rows for fault in r.faults), self.verdict])

    def _title(self) -> str:
        return self.verdict

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("", "numbers", "rms [σ]", "ΔAICc", "ΔBIC", "weight", "held out", "")
        held = ["" if np.isnan(r.held_out) else f"{r.held_out:.4g}" for r in self.rows]
        criteria = [(f"{r.rms:.4g}", f"{r.aicc:.4g}", f"{r.bic:.4g}", f"{r.weight:.3f}") for r in self.rows]
        return [
            [head, *((r.label, str(r.parameters), *t, h, "; ".join(r.faults)) for r, t, h in zip(self.rows, criteria, held, strict=True))]
        ]

    __repr__ = __str__


@explains_arguments
def rank(fits: Sequence[Fit] | dict[str, Fit], held_out: dict[str, Sequence[float]] | None = None) -> Ranking:
    """Rank fits of several laws to the same records by information criteria and by held-out records.

    A law is not supported if the residuals of its fit are correlated or larger than the noise, if one of its numbers is at a bound, or
    if its search was interrupted, however much better than the others it fits; if every fit has such a fault, no law fits. Correlated
    residuals carry less information than their number suggests: all criteria count the independent ones, as estimated from the best fit.
    If these are too few, or if criteria and held-out records disagree, the verdict is that the data cannot decide.

    Parameters
    ----------
    fits : list or dict of label -> Fit
        From `identify`, all to the same records in the same way.
    held_out : dict of label -> list of numbers, optional
        For each label the rms on each held-out record, from `prediction_errors`.

    Returns
    -------
    Ranking

    Examples
    --------
    >>> import stickslip as ss
    >>> rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), noise=1e-4, seed=1)
    >>> both = {law: ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.2)}, tilt_deg=1.7, amplitude=6e-4, law=law)
    ...         for law in ("coulomb", "lugre")}
    >>> print(ss.identification.rank(both).verdict)
    lugre is supported: ΔAICc to coulomb is ...
    """
    named = dict(fits) if isinstance(fits, dict) else _named(fits)
    _check(named)
    count = next(iter(named.values())).count
    given = all(_given(fit) for fit in named.values())
    smallest = min(named.values(), key=lambda fit: fit.cost)
    independent = float(np.clip(sum(effective(part) for part in smallest.problem.parts(smallest.residuals)), 1.0, count))
    parts = {label: _criteria(fit, independent, given) for label, fit in named.items()}
    least = {k: min(p[k] for p in parts.values()) for k in (0, 1)}
    weights = {label: np.exp(-0.5 * min(p[0] - least[0], 1400.0)) for label, p in parts.items()}
    total = sum(weights.values())
    outside = {
        label: float(np.sqrt(np.mean(np.square(np.asarray(held_out[label], float))))) if held_out and label in held_out else float("nan")
        for label in named
    }
    rows = sorted(
        (
            Ranked(
                label,
                fit.fitted,
                float(np.sqrt(fit.cost / count)),
                parts[label][0] - least[0],
                parts[label][1] - least[1],
                float(weights[label] / total),
                outside[label],
                (*faults(fit), *_superfluous(fit, label, named, parts)),
            )
            for label, fit in named.items()
        ),
        key=lambda r: r.aicc,
    )
    supported, decided, verdict = _verdict(rows, held_out)
    return Ranking(tuple(rows), decided, verdict, independent, count, supported)


def _superfluous(fit: Fit, label: str, named: dict[str, Fit], parts: dict[str, tuple[float, float]]) -> list[str]:
    """What a law has besides one that fits no worse, where all of that ends at zero: it is then that law with parts that do nothing."""
    zero = at_zero(fit)
    for other, each in named.items():
        more = [name for name in fit.names if name not in each.names]
        within = len(more) == len(fit.names) - len(each.names) > 0 and set(more) <= set(zero)
        if within and parts[other][0] <= parts[label][0] and not faults(each):
            return [f"{listed(more)} {'ends' if len(more) == 1 else 'end'} at the bound 0, which makes it {other}"]
    return []


@explains_arguments
def prediction_errors(
    fit: Fit, records: Record | Sequence[Record], *, load: float | None = None, frequency: float | None = None, **arguments: Any
) -> list[float]:
    """How well a fit predicts held-out records: rms for each record [SI]. The drive's phase and the sensor are fitted there.

    Parameters
    ----------
    fit : Fit
    records : Record or list of them
    load, frequency
        As for `identify`.
    **arguments
        Arguments of the model for these records, as for `identify`.

    Returns
    -------
    list of float

    Examples
    --------
    >>> import stickslip as ss
    >>> one, two = (ss.virtual_rig(ss.presets.piezo_rig(1.7, A, law="coulomb"), noise=1e-4, seed=1) for A in (6e-4, 8e-4))
    >>> fit = ss.identify(one, ss.presets.piezo_rig, free={"mu0": (0.1, 0.3)}, tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    >>> [round(e, 4) for e in ss.identification.prediction_errors(fit, two, tilt_deg=1.7, amplitude=8e-4, law="coulomb")]
    [0.0001]
    """
    from stickslip.inverse.identification.fit_settings import FitSettings
    from stickslip.inverse.identification.identify import as_list, problem_of
    from stickslip.inverse.identification.search import polished_to_end

    of = fit.problem.parameters
    free = {f.name: (f.low, f.high, "log") if f.log else (f.low, f.high) for f in of.free}
    using = fit.problem.targets[0].kind
    transient = any(t.transient for t in fit.problem.targets)
    if not as_list(records):
        raise InputError(
            "prediction_errors", ["no record is given; type for example ss.identification.prediction_errors(fit, ss.read(path))"]
        )
    body = fit.problem.targets[0].body if using in ("velocity", "position", "mean") else None
    names = machine_of(fit.model()).part_names.get("body", ()) if body is not None else ()
    how = FitSettings(
        using=using,
        frequency=frequency,
        load=load,
        transient=transient,
        sensor=fit.problem.given,
        harmonics=fit.problem.harmonics,
        body=None if body is None else names[body],
    )
    whole = problem_of(as_list(records), of.make, free, of.tied, arguments, how)
    problem = whole.only(fit.values)
    end = polished_to_end(problem, problem.aligned(np.empty(0)))
    rest = problem.parts(end.residuals[: len(problem.y)] * problem.sigma)
    return [float(np.sqrt(np.mean(part**2))) for part in rest]


def _named(fits: Any) -> dict[str, Fit]:
    named: dict[str, Fit] = {}
    for fit in fits:
        label = fit.law if fit.law not in named else f"{fit.law} ({len(named) + 1})"
        named[label] = fit
    return named


def _check(named: dict[str, Fit]) -> None:
    if len(named) < 2:
        raise InputError(
            "rank", [f"{len(named)} fits given; allowed are two or more; type ss.identification.rank([fit_of_one_law, fit_of_another])"]
        )
    (one, first), *others = named.items()
    problems = Problems("rank")
    for label, fit in others:
        if fit.count != first.count or not np.allclose(fit.problem.y, first.problem.y, rtol=1e-9, atol=0.0):
            problems.add(f"{label} was fitted to other values than {one}; fit all laws to the same records in the same way")
        elif _given(fit) != _given(first) or not np.allclose(fit.problem.model.sigma, first.problem.model.sigma, rtol=1e-9, atol=0.0):
            problems.add(
                f"{label} was fitted with {_noise(fit)} and {one} with {_noise(first)}, so that their misfits are counted in other units; "
                "fit all laws with the same noise=, or all without"
            )
    problems.check()


def _noise(fit: Fit) -> str:
    """The noise of a fit in words."""
    sizes = dict.fromkeys(f"{size:.3g}" for size in (fit.problem.model.sigma.min(), fit.problem.model.sigma.max()))
    return f"a noise of {' to '.join(sizes)}{'' if _given(fit) else ' (found in the record)'}"


def _given(fit: Fit) -> bool:
    return all(t.given_sigma for t in fit.problem.targets)


def _criteria(fit: Fit, independent: float, given: bool) -> tuple[float, float]:
    """AICc and BIC for as many values as are independent."""
    n, k = independent, fit.fitted + (0 if given else 1)
    misfit = fit.cost * n / fit.count if given else n * np.log(max(fit.cost, 1e-300) / fit.count)
    correction = 2 * k * (k + 1) / (n - k - 1) if n > k + 1.5 else 0.0 if given else np.inf
    return float(misfit + 2 * k + correction), float(misfit + k * np.log(max(n, 2.0)))


def _verdict(rows: list[Ranked], held_out: dict[str, Any] | None) -> tuple[tuple[str, ...], bool, str]:
    """The supported laws, whether it is one, and a sentence."""
    sound = [r for r in rows if not r.faults]
    if not sound:
        return (), False, f"no law fits: the residual of the best, {rows[0].label}, is not noise, or its numbers are not credible"
    first = sound[0]
    alike = tuple(r.label for r in sound if r.aicc - first.aicc < UNDECIDED)
    other = next(r for r in rows if r is not first)
    apart = other.aicc - first.aicc
    if not np.isfinite(first.aicc) or not np.isfinite(apart):
        return alike, False, "these data cannot decide: there are fewer independent values than fitted numbers"
    if len(alike) > 1:
        return alike, False, _undecided([r for r in sound if r.label in alike])
    if apart < UNDECIDED:
        off = f"higher by {apart:.3g}" if apart >= 0 else f"lower by {-apart:.3g}"
        return alike, True, f"{first.label} is supported: {other.label} has an AICc that is {off}, but {other.faults[0]}"
    if held_out is not None and first.label in held_out and other.label in held_out:
        decided, verdict = _held_out_verdict([first, other, *(r for r in rows if r not in (first, other))], held_out)
        return alike if decided else (), decided, verdict
    return alike, True, f"{first.label} is supported: ΔAICc to {other.label} is {apart:.3g}"


def _undecided(alike: list[Ranked]) -> str:
    """What is to be said of laws that explain the data as well as one another."""
    first, *others = alike
    apart = f"ΔAICc is {others[-1].aicc - first.aicc:.2g}{' at most' if len(others) > 1 else ''}, less than {UNDECIDED:g}"
    fewest = min(alike, key=lambda row: row.parameters)
    alone = all(row is fewest or row.parameters > fewest.parameters for row in alike)
    fewer = f"; {fewest.label} has the fewest numbers" if alone else ""
    each = "both explain" if len(others) == 1 else "all explain"
    return f"these data cannot distinguish {first.label} from {listed(row.label for row in others)}: {each} them, {apart}{fewer}"


def _held_out_verdict(rows: list[Ranked], held_out: dict[str, Any]) -> tuple[bool, str]:
    first = rows[0]
    outside = min((r for r in rows if r.label in held_out), key=lambda r: r.held_out)
    if outside.label != first.label and outside.held_out < 0.98 * first.held_out:
        return False, f"these data cannot decide: {first.label} fits best, but {outside.label} predicts the held-out records better"
    second = rows[1]
    wins = int(np.sum(np.asarray(held_out[first.label]) <= np.asarray(held_out[second.label])))
    return (
        True,
        f"{first.label} is supported: ΔAICc to {second.label} is {second.aicc:.3g}, and it predicts {wins} of "
        f"{len(held_out[first.label])} held-out records better",
    )
