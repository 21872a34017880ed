"""Page on the best machine of a search: gains and costs, the varied numbers, active limits, and its motion."""

from __future__ import annotations

from math import isfinite
from typing import Any

from stickslip.basics.fields import leaves
from stickslip.basics.number_names import numbers_meant
from stickslip.inverse.optimisation.results import unit_of_result
from stickslip.models.naming import unit_in
from stickslip.show.reports.charts import Figure, Table, chart, curve, tables_of
from stickslip.show.reports.drawn import svg
from stickslip.show.reports.run import run_page

_PERIODS = 500  # transient periods of the run shown
_SHOWN = ("mean_velocity", "drive_power", "cost_of_transport", "stroke", "relative_velocity", "relative_acceleration")
_SLOPES = 16  # rows in the table of derivatives


def optimum_page(best: Any, title: str, command: str = "") -> str:
    """The page on a result of `optimise`: the search, then a run of the best machine.

    Parameters
    ----------
    best : Optimum
    title : str
        Title of the page.
    command : str
        The command that makes the page, if it was made by one.

    Returns
    -------
    str

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> best = ss.optimise(robot, over={"drive.amplitude": (2e-4, 8e-4)}, maximise="mean_velocity")
    >>> text = optimum_page(best, "A faster rig")
    >>> "What was searched" in text, "0.004308808" in text
    (True, True)
    """
    from stickslip.solvers import solve

    run = solve(best.model, periods=_PERIODS, settle="auto", keep="trajectory")
    return run_page(run, title, command, search=_section(best))


def _section(best: Any) -> dict[str, Any]:
    """The values of the template for the search."""
    aim = f"The {_words(best.of)} was to be {'as large' if best.search.maximised else 'as small'} as possible"
    return {
        "aim": f"{aim}; {best.tried} candidates were run. It is the best that the search met: it is not proved that there is none better.",
        "share": best.limit
        if best.of_limit is None
        else f"The mean velocity is {100 * best.of_limit:.4g} % of the limit for {best.limit}.",
        "tables": tables_of((_gains(best), _varied(best), _limits(best), _uncertain(best), _slopes(best))),
        "notes": [*best.notes, *best.sensitivities.notes],
        "figures": [_history(best)],
    }


def _words(name: str) -> str:
    return name.replace("_", " ")


def _text(value: Any, unit: str = "") -> str:
    """A number with its unit; a dash if it is missing."""
    missing = value is None or not isfinite(float(value))
    return "–" if missing else f"{float(value):.7g} {unit}".rstrip().replace("-", "−")


def _per(unit: str, of: str) -> str:
    """The unit of a derivative."""
    return f"{unit or 1} per {of}" if of else unit


def _within(ends: tuple[float, float], unit: str) -> str:
    return f"{ends[0]:g} to {ends[1]:g} {unit}".rstrip()


def _gains(best: Any) -> Table:
    """Gains and costs of the best machine relative to the given one."""
    names = [name for name in dict.fromkeys((best.of, *_SHOWN)) if name in best.values]
    rows = []
    for name in names:
        before, after = best.given.get(name), best.values[name]
        change = (
            f"{100 * (after / before - 1) + 0.0:+.3g} %".replace("-", "−").replace("+0 %", "0 %")
            if before and isfinite(before) and isfinite(after)
            else "–"
        )
        rows.append((_words(name), _text(before, unit_of_result(name, best.model)), _text(after, unit_of_result(name, best.model)), change))
    return "Gain and cost.", ("", "as given", "best", "change"), rows


def _varied(best: Any) -> Table:
    """The varied numbers with their bounds, and the waveforms."""
    own, now = dict(leaves(best.model)), best.varied
    rows = []
    for name, what in best.search.over.items():
        if isinstance(what, tuple):
            at = "at a bound" if name in best.active else ""
            value = next(now[leaf] for leaf in now if numbers_meant(name, [leaf]))
            rows.append((name, _within(what, unit_in(name, best.model)), _text(value, unit_in(name, best.model)), at))
        else:
            rows.append((name, f"a waveform of {what.count} ({what.kind})", "its numbers stand below", ""))
    return f"What varied, of {len(own)} numbers.", ("number", "between", "best", ""), rows


def _limits(best: Any) -> Table:
    """Limits, and the values of the best machine."""
    rows = []
    for name, (low, high) in best.search.subject_to.items():
        numbers = (_text(value, unit_of_result(name, best.model)) for value in (low, high, best.values.get(name)))
        rows.append((_words(name), *numbers, "reached" if name in best.active else ""))
    return "Limits.", ("", "least", "largest", "best", ""), rows


def _uncertain(best: Any) -> Table:
    """The uncertain numbers and the criterion of the robust search."""
    part = best.search.quantile
    counted = "the worst of the sample" if part is None else f"what {100 * part:g} % of the sample fall short of"
    rows = [(name, f"{' '.join(map(str, spread))} {unit_in(name, best.model)}".rstrip()) for name, spread in best.search.robust.items()]
    worth = _text(best.robust, unit_of_result(best.of, best.model))
    return f"Numbers that are not known exactly. What counted is {counted}: {worth}.", ("number", "distribution"), rows


def _slopes(best: Any) -> Table:
    """Derivatives, the largest effect first."""
    own, slopes, unit = dict(leaves(best.model)), best.sensitivities, unit_of_result(best.of, best.model)
    effects = {name: slope * own[name] / 100 for name, slope in slopes.items() if name in own and isfinite(slope)}
    order = sorted(effects, key=lambda name: -abs(effects[name]))[:_SLOPES]
    one_sided = {note.partition(":")[0] for note in slopes.notes}
    rows = []
    for name in order:
        of = unit_in(name, best.model)
        numbers = (_text(own[name], of), _text(slopes[name], _per(unit, of)), _text(effects[name], unit))
        rows.append((name, *numbers, "one side, see the remarks" if name in one_sided else ""))
    head = ("number", "value", "derivative", "for 1 % more", "")
    return f"Effect of each number on the {_words(best.of)}, with the others held.", head, rows


def _history(best: Any) -> Figure:
    """The best value against the number of candidates."""
    tried, value = best.search.history.T
    x, y = [*tried, best.tried], [*value, value[-1]]
    what, unit = f"{_words(best.of)}, the best so far", unit_of_result(best.of, best.model)

    def draw(ax: Any) -> None:
        ax.step(x, y, where="post")
        ax.set(xlabel="candidates tried", ylabel=f"{_words(best.of)}{f' ({unit})' if unit else ''}")

    asked = chart(what, x, ("candidates", ""), (_words(best.of), unit), [curve("best so far", y)])
    return Figure(f"Course of the search: {what}.", svg(draw), asked)
