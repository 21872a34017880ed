"""One step of any number of states as Taylor series, to a tolerance, with the events of a Rosenbrock step.

What is between events is as smooth as the equations: coefficients of high order cost little and carry far, where no state relaxes much
faster than the others move. The series of all states come from the same writer as for laws that rest exactly (`rows.py`); the length of a
step follows from their last two coefficients, and from what these cannot foresee: the argument of an exponential may rise in a step by no
more than the order can bear. A step ends where the first guard is zero. Slips are polynomials; other guards, which may have an exponential
in them that the states do not feel, are looked at as they are, at some points of the step up to there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.engine.graphs import Substituted
from stickslip.engine.rosenbrock_step import RosenbrockWriter, Step, ended_by, sides
from stickslip.engine.rows import RowWriter
from stickslip.engine.symbolic import SPAN
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.tableaux import Control
from stickslip.engine.unforeseen import active
from stickslip.engine.values import Arithmetic, needed_by, values_of
from stickslip.engine.write import LOG_OF_BITS, Writer, horner, literal, write_length, write_secants


@dataclass(frozen=True)
class SeveralSeries:
    """A method of this sort."""

    name: str
    order: int
    velocity_floor: float = 0.3  # error of a velocity: tolerance (floor times the velocity without friction + |v|)
    inner_floor: float = 5.0  # error of an inner state: tolerance (floor times its scale + |z|)
    longest: float = 0.15  # of a period
    rise: float = 0.7  # of an exponential's argument in a step, for each order
    looks: int = 2  # at guards in a step: steps of high order are long


#: From which tolerance on (of the steps) each is used.
SERIES = (
    (9e-7, SeveralSeries("Taylor10", 10)),
    (1e-10, SeveralSeries("Taylor12", 12, looks=3)),
    (0.0, SeveralSeries("Taylor18", 18, looks=5, longest=0.05)),
)
CUTS = 20  # of a step in which an exponential rises too far
CALM = 0.01  # part of the error tolerated: how well a zero is found
ROUNDING = 1e-14  # of the size of the terms of which a guard is the difference
SECANTS = 12  # to the zero of a guard
ROUNDS = 60  # of a search for a zero: bisection to rounding, if nothing is faster
LOOKS = 2  # of a step, for this
PEAKS = 2  # rounds of Newton's method to where an argument turns


#: How far the inner states of a case may swing or relax in a period [rad]: up to here explicit steps are cheaper than implicit ones.
SMOOTH = 300.0
_FASTER = 10.0  # times, of an inner state that relaxes the faster the faster it slips
_KNOWN = ("add", "subtract", "multiply", "select", "reciprocal", "exp", "variable", "flag")  # operations whose series are foreseen


class Swings:
    """How fast the inner states of a machine swing and relax at rest, asked of its equations."""

    def __init__(self, eq: System):
        graph, inner = eq.graph, [i for contact in eq.contacts for i in contact.inner]
        self.eq, self.relaxing, self.parts = eq, [graph.derivative(eq.f[i], eq.y[i]) for i in inner], list[tuple[Sym, list[Sym]]]()
        pairs = [(i, j) for i in inner for j in range(eq.coordinates)]
        there = [graph.derivative(eq.f[j], eq.y[i]) * graph.derivative(eq.f[i], eq.y[j]) for i, j in pairs]
        zero, one = graph.constant(0.0), graph.constant(1.0)
        still = {y.name: zero for y in (*eq.y, eq.t)} | {f"b{k}": one for k in range(eq.signs)}
        still |= {f"clk{k}": one for k in range(len(eq.clocks))}
        for mode in (zero, one):
            at = Substituted(graph, still | {each.name: mode for each in eq.modes})
            self.parts.append((sum((at.of(node) for node in there), zero), [at.of(node) for node in self.relaxing]))
        roots = [node for square, rates in self.parts for node in (square, *rates)]
        self.nodes = needed_by([*dict.fromkeys(roots), eq.period])

    def in_a_period(self, numbers: dict[str, Any]) -> Any:
        """How far they swing or relax in a period at most [rad], for numbers of one case or of many."""
        import numpy as np

        with np.errstate(all="ignore"):
            values, most = Arithmetic(numbers).values(self.nodes), 0.0
            for square, rates in self.parts:
                for rate in (abs(values[square.number]) ** 0.5, *(abs(values[node.number]) for node in rates)):
                    most = np.fmax(most, rate)
            return most * values[self.eq.period.number]

    def grow(self) -> bool:
        """Whether an inner state relaxes the faster the faster it slips: asked at numbers of no meaning."""
        import numpy as np

        of, eq = np.random.default_rng(20261130), self.eq
        known = {name: of.uniform(0.5, 1.5) for name in (*eq.names, SPAN)} | {each.name: 1.0 for each in eq.modes} | {eq.t.name: 0.0}
        known |= {y.name: 0.0 for y in eq.y}
        slow, fast = (values_of(eq.graph, known | {y.name: v for y in eq.y[: eq.coordinates]}, self.relaxing) for v in (1.0, 1e4))
        return any(abs(fast[node.number]) > _FASTER * abs(slow[node.number]) for node in self.relaxing)


def swings(eq: System) -> Swings | str:
    """How fast the inner states of a machine swing and relax; or the reason why the method does not take it."""
    graph, inner = eq.graph, [i for contact in eq.contacts for i in contact.inner]
    if eq.graph.linear or any(c.flight is not None or c.branches is not None or c.balances for c in eq.contacts):
        return "it knows contacts that neither rest exactly nor fly, and inertia that does not vary"
    if any(c.guard is None or c.state is None for c in eq.contacts) or eq.signs > len(eq.contacts):
        return "it knows no conditions but the sides of slips that are states, and memories"
    if any(switch.status for switch in eq.switches.values()) or any(c.creep_velocity is not None for c in eq.contacts):
        return "it does not follow a contact to where it is lost, nor one that creeps"
    moved = [node for node in needed_by([*eq.active, *eq.guards]) if graph.varies(node) and node.op not in _KNOWN]
    if any(node.op not in ("sin", "cos") or graph.varies(node) != {eq.t.name} for node in moved):
        return "a function in the equations may change within a step unseen"
    names = {eq.y[i].name for i in inner}
    if any(graph.varies(graph.derivative(eq.f[i], eq.y[k])) & names for i in inner for k in inner):
        return "the rate of an inner state is not affine in the inner states"
    made = Swings(eq)
    return "its inner states relax the faster the faster it slips" if made.grow() else made


def write_step(eq: System, method: SeveralSeries, record: bool) -> Step:
    """The lines of one step; with `record` the coefficients of all states are kept."""
    return _SeriesWriter(eq, method, record).write()


class _SeriesWriter(RosenbrockWriter):
    def __init__(self, eq: System, method: SeveralSeries, record: bool):
        self.eq, self.method, self.record = eq, method, record
        self.w, self.k = Writer(), Control()
        self.n, self.g, self.active = eq.states, len(eq.guards), eq.states - eq.passive
        self.slips = {c.guard: c.state for c in eq.contacts if c.guard is not None and c.state is not None}
        self.degree = method.order
        self.extended, self.falls = set(range(eq.states)), dict[str, str]()
        news = [new for switch in eq.switches.values() for new in (*switch.modes, *switch.states) if new is not None]
        self.w.count_uses([*eq.f, *eq.guards, *eq.guard_rates, *news])

    def write(self) -> Step:
        """All lines in order."""
        self._slopes()
        self._series()
        self._crossings()
        self._locate()
        self._decide()
        self._next_length()
        self._keep()
        return Step(tuple(self.w.lines), tuple(self._fields()), tuple(self.w.case_nodes), self.degree, by_vector=True)

    def _fields(self) -> list[str]:
        n, g, eq = range(self.n), range(self.g), self.eq
        fields = ["t", "tend", "x", "lim", *(f"y{i}" for i in n), *(f"b{k}" for k in g), *(f"on{k}" for k in g)]
        fields += [*(f"m{i}" for i in n if i), *(f"mode{i}" for i in range(len(eq.modes))), *(f"clk{k}" for k in range(len(eq.clocks)))]
        kept = n if self.record or eq.signals else (0,)
        fields += ["stat", "nacc", "nrej", "ratio", "t0", "hh", *(f"k{i}_{m}" for i in kept for m in range(self.degree + 1))]
        fields += ended_by(eq)
        if self.record:
            fields += ["x0", *sides(eq), *(f"held{i}" for i in range(len(eq.modes)))]
        elif eq.signals:
            fields += ["looked"]
        return fields

    def _derivatives(self) -> None:
        """None: series need no Jacobian."""

    def _series(self) -> None:
        """The coefficients of all states, the length of the step, and the polynomials in parts of it: _k<state>_<power>."""
        w, eq = self.w, self.eq
        self.rising = [node.args[0] for node in active(eq, "exp")]
        w.line("_longest", f"{literal(self.method.longest)} * {w.value(eq.period, self.start)}")
        self._sizes()
        rows = RowWriter(eq.y, eq.f, self.rising, w, self.start, self.degree, out=True)
        rows.write()
        self.rows = [rows.rows[y.number] for y in eq.y]
        self.others = [k for k in range(self.g) if k not in self.slips]
        self._wish()
        self._foresee([(rows.rows.get(node.number, ""), w.value(node, self.start)) for node in self.rising])
        w.line("_rem", "_tend - _t")
        w.line("_last", "_rem <= _hh * 1.0000001")
        w.line("_hh", "_rem if _last else _hh")
        w.line("_hh", "_hh if _hh > 0.0 else 0.0")
        w.line("_ih", "1.0 / (_hh if _hh > 0.0 else 1.0)")
        self._polynomials()

    def _sizes(self) -> None:
        """_s<state>: the error that a step may make in it."""
        w, eq, k = self.w, self.eq, self.method
        free = w.value(eq.free_velocity, self.start)
        for i in range(self.active):
            if i < eq.coordinates:
                floor = f"{literal(k.velocity_floor)} * {free}"
            elif i in eq.positions:
                floor = f"{literal(0.1 * k.velocity_floor)} * {free} * {w.value(eq.period, self.start)}"
            else:
                floor = f"{literal(k.inner_floor)} * {f'_m{i}' if eq.scales[i] is None else w.value(eq.scales[i], self.start)}"
            w.line(f"_tol{i}", f"fma({floor} + abs(_y{i}), rtol, 1e-290)")
            w.line(f"_is{i}", f"1.0 / _tol{i}")

    def _wish(self) -> None:
        """_hh: where the last two terms of some series fall to what is tolerated."""
        w = self.w
        weighed = [(self.rows[i], f"_is{i}") for i in range(self.active)]
        write_length(w, weighed, self.degree, "4607182418800017408.0", "_hh")  # bits of 1.0
        w.line("_hh", "_hh if _hh < _longest else _longest")
        w.line("_hh", "_lim if (_lim > 0.0 and _lim < _hh) else _hh")

    def _foresee(self, rising: list[tuple[str, str]]) -> None:
        """Shorten a step in which an exponential would rise too far: as the order bears, or to where it is still nothing."""
        w = self.w
        if not rising:
            return
        w.line("_nothing", f"fma(as_bits(rtol) * 1.0, {literal(float(LOG_OF_BITS) * 0.6931)}, -709.09)")
        bears = literal(self.method.rise * self.degree)
        for k, (_, before) in enumerate(rising):
            w.line(f"_low{k}", f"_nothing - {before} if _nothing - {before} > {bears} else {bears}")
        w.line("_far", "_hh > 0.0")
        w.line("_cut", "1.0")
        w.begin(f"for q in while_any(_far, {CUTS})")
        w.line("_hh", "_cut * _hh if _far else _hh")
        self._look_ahead(rising)
        w.line("_cut", "0.7")
        w.end()

    def _look_ahead(self, rising: list[tuple[str, str]]) -> None:
        """_far: whether an exponential's argument rises too far, at the end of the step or where it turns on the way."""
        w, n = self.w, self.degree
        w.line("_asked", "_far and _far")
        w.line("_far", "_hh < 0.0")
        w.line("_part", f"{literal(1 / LOOKS)} * _hh")
        for k, (row, _) in enumerate(rising):
            rise = ["0.0", *(f"{row}[{m}]" for m in range(1, n + 1))]
            slope, bend = _derivatives([f"{row}[{m}]" for m in range(n + 1)])
            w.line("_at", "0.0")
            w.line("_turn", f"1.0 * {row}[1]")
            for look in range(1, LOOKS + 1):
                w.line("_was", "1.0 * _at")
                w.line("_from", "1.0 * _turn")
                w.line("_at", f"{literal(float(look))} * _part")
                w.line("_turn", horner(slope, "_at"))
                w.line("_far", f"_far or {horner(rise, '_at')} > _low{k}")
                w.line("_peak", "_from > 0.0 and _turn < 0.0 and _asked")
                w.begin("if _peak")
                w.line("_top", "_was + _part * (_from / (_from - _turn if _peak else 1.0))")
                self._approach("_top", slope, bend, "_was", "_at")
                w.line("_far", f"_far or (_peak and {horner(rise, '_top')} > _low{k})")
                w.end()
        w.line("_far", "_far and _asked")

    def _approach(self, x: str, slope: list[str], bend: list[str], begin: str, end: str) -> None:
        """Lines for x: where a polynomial turns between two points, by Newton's method from x on."""
        w = self.w
        for _ in range(PEAKS):
            w.line("_bend", horner(bend, x))
            w.line("_tn", f"{x} - ({horner(slope, x)}) / (_bend if _bend != 0.0 else 1.0)")
            w.line(x, f"_tn if (_tn > {begin} and _tn < {end}) else {x}")

    def _polynomials(self) -> None:
        w = self.w
        for i in range(self.n):
            w.line(f"_k{i}_0", f"1.0 * _y{i}")
        for m in range(1, self.degree + 1):
            w.line("_pw", "_pw * _hh" if m > 1 else "1.0 * _hh")
            for i in range(self.n):
                w.line(f"_k{i}_{m}", f"_pw * {self.rows[i]}[{m}]")
        for i in range(self.n):
            w.line(f"_n{i}", " + ".join(f"_k{i}_{m}" for m in range(self.degree, -1, -1)))
            w.line(f"_big{i}", f"abs(_y{i}) if abs(_y{i}) > abs(_n{i}) else abs(_n{i})")
        w.line("_ok", f"({' and '.join(f'_n{i} == _n{i}' for i in range(self.active))})")

    def _next_length(self) -> None:
        """_lim: how long the next step may be where this one is to be made again; else 0."""
        self.w.line("_lim", "_cut * _hh if _evB else 0.0")

    # ---- events ----
    def _crossings(self) -> None:
        """Which guard leaves its side first in the step; _th: where.

        Slips are polynomials: where the first of them is zero is known before the others are looked at, at some points up to there.
        """
        w = self.w
        w.line("_calm", f"-1e-14 * {self.scale_v}")
        for name, value in (("_th", "1.0"), ("_which", "0.0")):
            w.line(name, value)
        for name in ("_cr", "_pre", "_wrong", "_conv"):
            w.line(name, "False")
        for k, i in self.slips.items():
            self._slip(k, i)
        if self.others:
            self._look_at_others()

    def _slip(self, k: int, i: int) -> None:
        """Where a slip leaves its side, if it does so before what was found until now."""
        w, n, side = self.w, self.degree, f"_b{k}"
        rate, bend = _derivatives([f"_k{i}_{m}" for m in range(n + 1)])
        w.line("_first", f"_y{i} * {side}")
        w.line("_fall", f"_k{i}_1 * {side}")
        w.line("_last_rate", f"({horner(rate, '1.0')}) * {side}")
        w.line("_deep", f"_n{i} * {side}")
        w.line("_hi", "1.0")
        w.line("_dip", "_fall < 0.0 and _last_rate > 0.0 and _deep >= _calm")
        w.begin("if _dip")
        w.line("_tx", "_fall / (_fall - _last_rate if _dip else -1.0)")
        self._approach("_tx", rate, bend, "0.0", "1.0")
        w.line("_low", f"({self._at(f'_k{i}', '_tx')}) * {side}")
        w.line("_dip", "_dip and _low < _calm")
        w.line("_hi", "_tx if _dip else _hi")
        w.line("_deep", "_low if _dip else _deep")
        w.end()
        w.line("_out", "_deep < _calm")
        w.line("_off", f"_out and _first <= 0.0 and (_fall < 0.0 or (_fall == 0.0 and _k{i}_2 * {side} < 0.0))")
        w.line("_off", f"_off or (_first < _calm and _on{k} < 0.5)")  # it starts on the wrong side: its state was set
        w.line("_seek", "_out and not _off")
        w.begin("if _seek")
        w.line("_near", f"fma({literal(CALM)}, _tol{i}, -_calm)")
        w.line("_lo", "0.0")
        w.line("_tx", "_hi * _first / (_first - _deep if _seek else 1.0) if _first > 0.0 else 0.5 * _hi")
        w.begin(f"for q in while_any(_seek, {ROUNDS})")
        w.line("_pv", f"({self._at(f'_k{i}', '_tx')}) * {side}")
        w.line("_pd", f"({horner(rate, '_tx')}) * {side}")
        w.line("_lo", "_tx if (_pv > 0.0 and _seek) else _lo")
        w.line("_hi", "_hi if (_pv > 0.0 or not _seek) else _tx")
        w.line("_seek", "_seek and abs(_pv) > _near and _hi - _lo > 1e-15")
        w.line("_tn", "_tx - _pv / (_pd if _pd != 0.0 else 1.0)")
        w.line("_tx", "((_tn if (_tn > _lo and _tn < _hi) else 0.5 * (_lo + _hi)) if _seek else _tx)")
        w.end()
        w.line("_hi", "1.0 * _tx")
        w.end()
        w.line("_hi", "0.0 if _off else _hi")
        w.line("_sooner", "(_out or _off) and (_hi < _th or not _cr)")
        for name, value in (("_th", "_hi"), ("_which", f"{k}.0"), ("_pre", "_off"), ("_wrong", "_off")):
            w.line(name, f"{value} if _sooner else {name}")
        w.line("_cr", "_cr or _sooner")
        w.line("_conv", "(not _off) if _sooner else _conv")

    def _look_at_others(self) -> None:
        """Other guards, up to where a slip ends the step: at some points, and where a parabola through three of them is least."""
        w = self.w
        w.line("_reach", "1.0 * _th")
        for k in self.others:
            w.line(f"_least{k}", f"{literal(-ROUNDING)} * {self._size(self.eq.guards[k], self.start)}")
        looks = [(0.0, [self.guard_start[k] for k in self.others])]
        for look in range(1, self.method.looks + 1):
            w.line(f"_at{look}", f"{literal(look / self.method.looks)} * _reach")
            looks.append((look / self.method.looks, self._guards_at(f"_at{look}")))
        w.line("_lo", "0.0")
        w.line("_hi", "1.0")
        w.line("_gs", "1.0")
        w.line("_ge", "0.0")
        w.line("_some", "False")
        w.line("_at0", "0.0")
        for number, k in enumerate(self.others):
            values = [each[number] for _, each in looks]
            w.line("_off", f"{values[0]} <= 0.0 and {values[1]} < {values[0]} and {values[1]} < _least{k}")
            w.line("_sooner", "_off and not (_some and _lo <= 0.0 and _hi <= 0.0)")
            self._take(k, "0.0", "0.0", values[0], values[0])
            for look in range(1, self.method.looks + 1):
                before, after, begin = values[look - 1], values[look], f"_at{look - 1}"
                w.line("_sooner", f"not _some or {begin} < _lo or ({begin} == _lo and {after} < _ge)")
                w.line("_sooner", f"_sooner and {after} < _least{k} and {before} >= _least{k}")
                self._take(k, begin, f"_at{look}", before, after)
        for look in range(1, self.method.looks):
            self._between(look, [values[look - 1 : look + 2] for values in zip(*(each for _, each in looks), strict=True)])
        w.line("_some", "_some and _ok")
        w.line("_seek", "_some and not _pre")
        w.begin("if _some")
        w.line("_conv", "False if _some else _conv")
        self._secants()
        w.end()

    def _take(self, k: int, begin: str, end: str, before: str, after: str) -> None:
        """Where it is _sooner: a guard, and between which parts of the step it leaves its side."""
        w = self.w
        for name, value in (("_lo", begin), ("_hi", end), ("_gs", before), ("_ge", after), ("_which", f"{k}.0")):
            w.line(name, f"{value} if _sooner else {name}")
        off = "True" if begin == end else "False"
        for name in ("_pre", "_wrong"):
            w.line(name, f"({off} and _sooner) or ({name} and not _sooner)" if off == "True" else f"{name} and not _sooner")
        w.line("_some", "_some or _sooner")
        w.line("_cr", "_cr or _sooner")

    def _between(self, look: int, values: list[tuple[str, str, str]]) -> None:
        """Guards above zero at three looks: of the first that has a minimum between, by a parabola, all are looked at there."""
        w = self.w
        w.line("_any", "False")
        w.line("_tx", f"1.0 * _at{look}")
        for k, (left, middle, right) in zip(self.others, values, strict=True):
            w.line("_rise", f"0.5 * ({right} - {left})")
            w.line("_bend", f"{right} - 2.0 * {middle} + {left}")
            w.line(f"_dip{k}", f"{left} > 0.0 and {middle} > 0.0 and {right} > 0.0 and _bend > 0.0 and abs(_rise) < _bend")
            w.line(f"_dip{k}", f"_dip{k} and {middle} * _bend < 0.6 * _rise * _rise and (not _some or _lo > _at{look - 1})")
            w.line("_tx", f"_at{look} - _rise / (_bend if _dip{k} else 1.0) * _at1 if (_dip{k} and not _any) else _tx")
            w.line("_any", f"_any or _dip{k}")
        w.begin("if _any")
        for k, (left, _, _), there in zip(self.others, values, self._guards_at("_tx"), strict=True):
            w.line("_sooner", f"_dip{k} and {there} < _least{k}")
            self._take(k, f"_at{look - 1}", "_tx", left, there)
        w.end()

    def _guards_at(self, theta: str) -> list[str]:
        """Values of the guards that are no slips, on the polynomials of the states."""
        w = self.w
        wanted = frozenset[str]().union(*(self.eq.graph.varies(self.eq.guards[k]) for k in self.others))
        y = [w.line(w.fresh(), self._at(f"_k{i}", theta)) if s.name in wanted else "0.0" for i, s in enumerate(self.eq.y)]
        t = w.line(w.fresh(), f"fma({theta}, _hh, _t)")
        return [w.line(w.fresh(), f"1.0 * {w.value(self.eq.guards[k], self._bind(t, y))}") for k in self.others]

    def _secants(self) -> None:
        """The zero of the guard that goes first, by secants in a bracket; the event is found if no other guard is beyond its zero there."""
        w = self.w
        w.line("_th", "(0.0 if _pre else _lo + (_hi - _lo) * (_gs / (_gs - _ge if _ge < _gs else 1.0))) if _some else _th")
        w.line("_span", "0.0")
        for k in self.others:
            w.line("_span", f"fma({literal(CALM)} * rtol, _gs - _ge, -_least{k}) if _which == {k}.0 else _span")
        for name, value in (("_xa", "_lo"), ("_ga", "_gs"), ("_xb", "_hi"), ("_gb", "_ge"), ("_pv", "_gs")):
            w.line(name, f"1.0 * {value}")
        write_secants(w, SECANTS, lambda: self._chosen(self._guards_at("_th"), self.others), "_pv", "_span", ends="=")
        w.line("_conv", "(not _seek and not _pre) if _some else _conv")
        values = self._guards_at("_th")
        for number, k in enumerate(self.others):
            w.line("_missed", f"_some and _which != {k}.0 and {self.guard_start[k]} > 0.0 and {values[number]} < 1e6 * _least{k}")
            w.line("_conv", "_conv and not _missed")

    def _locate(self) -> None:
        """The states where the step ends, if a guard leaves its side in it."""
        w = self.w
        for i in range(self.n):
            w.line(f"_v{i}", "0.0")
        w.begin("if _cr")
        for i in range(self.n):
            w.line(f"_v{i}", self._at(f"_k{i}", "_th"))
        w.end()


def _derivatives(coefficients: list[str]) -> tuple[list[str], list[str]]:
    """The coefficients of the first and of the second derivative of a polynomial."""
    powers = range(len(coefficients))
    slope = [coefficients[1], *(f"{m}.0 * {coefficients[m]}" for m in powers[2:])]
    return slope, [f"{m * (m - 1)}.0 * {coefficients[m]}" for m in powers[2:]]
