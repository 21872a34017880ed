"""One step of one body under a law with one inner state, as Taylor series: explicit near rest, on the slow manifold while it slips.

Friction of this sort is stiff only while it slips. The inner state z relaxes with the rate a = |dz'/dz|, which grows with |v|: near rest a
is small and an explicit series of (v, z) takes long steps. In slip z is *slaved* to v. With z' = p(v, t) + J(v, t) z it is

    z = (z' - p) / J,

where z' is small beside p, and follows from the series of z itself: beginning with z' = 0, each *sweep* makes the series of v with the z'
of the one before, and that of z from the line above, and gains a factor of about |v'| / (a |v|). The series of v alone is not stiff. Sweeps
are a fixed number, so that a lane does not depend on its neighbours; a step after which two sweeps still differ, or whose z at the start is
not yet slaved, is refused, and an explicit one is made instead. Of the lanes that step together those make a step whose sort more of them
want; the others wait, which they do not notice.

The same writer of series as for laws that rest exactly makes the coefficients from the traced equations (`rows.py`). The length of a step
follows from the last two coefficients, and from what they cannot foresee: an exponential that is next to nothing where the step begins may
come up within it, so that its argument may rise in a step by no more than the order can bear.
"""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.basics.status import Status
from stickslip.engine.graphs import Substituted
from stickslip.engine.lawtext import rule_of_work
from stickslip.engine.rosenbrock_step import Step, sides
from stickslip.engine.rows import RowWriter
from stickslip.engine.slaving import Slaving
from stickslip.engine.steptext import bound
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.unforeseen import active
from stickslip.engine.write import LOG_OF_BITS, Writer, horner, literal, write_length


@dataclass(frozen=True)
class Series:
    """A method of this sort: its order, and when z counts as slaved."""

    name: str
    order: int
    sweeps: int
    slaved: float  # |v'| / (a |v|) below which the series of v alone is tried
    velocity_floor: float = 0.3  # error of v: tolerance (floor times the velocity without friction + |v|)
    inner_floor: float = 5.0  # error of z: tolerance (floor times its scale + |z|)
    slow: float = 0.3  # the same while z is slaved, where errors last, as a part
    longest: float = 0.15  # of a period
    rise: float = 0.7  # of an exponential's argument in a step, for each order


#: From which tolerance on (of the steps) each is used.
SERIES = (
    (9e-7, Series("Taylor8", 8, 4, 0.014)),
    (1e-9, Series("Taylor12", 12, 5, 0.01)),
    (1e-11, Series("Taylor16", 16, 7, 0.004)),
    (0.0, Series("Taylor18", 18, 10, 0.004)),
)

PEAKS = 3  # rounds of Newton's method to an extremum: its value is off by the square of how far its instant is
ROUNDS = 60  # of a search for a zero: bisection from a period to rounding, if nothing is faster
GAIN = 4.0  # by how much less a sweep may gain than the one before
CALM = 0.01  # part of the error tolerated in v: how well a zero is found
LEAST = 1e-3  # part of what counts as slaved to which refusals may lower it
SHORTER = 4  # times that a step is shortened before it is refused
SLACK = 2.0  # by how much less z may be slaved at a step's end
CUTS = 20  # of a step in which an exponential rises too far
NOTED = ("ratio", "tail", "t0", "hh", "top")  # of a step, where somebody looks
NUMBERS = 150  # in the series of a step that two vectors hold in turn; of more, registers hold those of one alone, in half the text
TINY = 1e-14  # of the velocity scale: below it a velocity is zero


class StepWriter:
    """Writes the lines of a step."""

    ends = "_last or _wrong or _cross"  # what may make a step as short as it likes

    def __init__(self, eq: System, method: Series, law: Slaving, record: bool):
        self.eq, self.k, self.law, self.record, self.w = eq, method, law, record, Writer()
        self.n = method.order
        self.start = bound(eq)
        self.rising = list(active(eq, "exp"))
        self.rates: dict[str, str] = {}  # rows of velocities, and of m times these
        self.w.count_uses([*eq.f, law.braked, law.z, law.slope, *self.rising])

    def write(self) -> Step:
        """All lines in order."""
        self._begin()
        self._slaved()
        self._explicit()
        self._end()
        orders = range(self.n + 1)
        signs, clocks = range(self.eq.signs), range(len(self.eq.clocks))
        fields = ["t", "tend", "x", "y0", "y1", *(f"b{k}" for k in signs), "m1", *(f"clk{k}" for k in clocks)]
        fields += ["stat", "nacc", "nrej", "lim", "sort"]
        fields += [] if self.record else ["high_0", "low_0", "looked", "soon", "marks"]  # what follows does not last
        fields += [*(f"{name}_0" for name in NOTED), *(["work_0"] if self._works else []), *(f"k{i}_{m}" for i in (0, 1) for m in orders)]
        fields += ["x0", *sides(self.eq)] if self.record else []
        rows = sum(" = row(" in line for line in self.w.lines)
        return Step(tuple(self.w.lines), tuple(fields), tuple(self.w.case_nodes), self.n, by_vector=rows * (self.n + 1) > NUMBERS)

    def _value(self, node: Sym, bind: dict[str, str] | None = None) -> str:
        return self.w.value(node, bind or self.start)

    # ---- what both sorts of steps need ----
    def _begin(self) -> None:
        """Rates and tolerances at the start; which lanes make which sort of step."""
        w, eq = self.w, self.eq
        self.f = [self._value(f) for f in eq.f]
        w.line("_idle", "_tend > 1e29")
        w.line("_slow", "_sort > 0.5 and not _idle")
        w.line("_mine", "not _slow and not _idle")
        self._look_at_start()
        self.explicit = RowWriter(eq.y, self._rates(), [], w, self.start, self.n, out=True)
        self.slope_row = self.explicit.rate(eq.y[0])
        for name in ("went", "v", "z", "dx", "d1"):
            w.line(f"_{name}", "0.0")
        for name in ("cross", "wrong", "last", "done", "refused"):
            w.line(f"_{name}", "False")
        w.line("_most", "1.0 * _y0")

    def _rates(self) -> list[Sym]:
        """The rates of explicit steps."""
        return list(self.eq.f)

    def _tolerances(self) -> None:
        """_tv: the error of v that a step may make; _size, _bent: sizes of v and z; _low: how far an exponential may rise."""
        w, eq, k = self.w, self.eq, self.k
        scale = self._value(self.law.deflection if eq.scales[1] is None else eq.scales[1])
        w.line("_size", f"fma({literal(k.velocity_floor)}, {self._value(eq.free_velocity)}, abs(_y0))")
        w.line("_tv", "fma(rtol, _size, 1e-290)")
        w.line("_bent", f"fma({literal(k.inner_floor)}, {scale}, fma(1e-150, 1.0, abs(_y1)))")
        w.line("_rem", "_tend - _t")
        self.before = [self._value(node.args[0]) for node in self.rising]
        for i, before in enumerate(self.before):  # how far an exponential may rise: as the order bears, or to where it is still nothing
            w.line(f"_low{i}", f"fma(as_bits(rtol) * 1.0, {literal(float(LOG_OF_BITS) * 0.6931)}, -709.09) - {before}")
            w.line(f"_low{i}", f"_low{i} if _low{i} > {literal(k.rise * self.n)} else {literal(k.rise * self.n)}")

    def _relaxes(self) -> None:
        """_fast: how fast z relaxes, in parts of v; _below: by which part of it v may change in a step with z slaved."""
        w = self.w
        w.line("_fast", f"abs({self._value(self.law.slope)}) * abs(_y0)")
        w.line("_below", f"abs(_lim) if _lim != 0.0 else {literal(self.k.slaved)}")

    def _look_at_start(self) -> None:
        """Values recorded at the start of a step if the lane is observed: the slip ratio."""
        w = self.w
        self._looking("0.5")
        small = f"abs(_y0) < {literal(100 * TINY)} * {self._value(self.eq.velocity_scale)}"
        w.line("_ratio[0]", f"0.0 if {small} else 1.0 - {self.f[1]} / (1.0 if {small} else _y0)")
        w.end()

    def _looking(self, least: str) -> None:
        """Begins a part for lanes that are observed, or for all if everything is recorded."""
        self.w.begin("for q in each(0, 1)" if self.record else f"if _looked > {least}")

    def _wish(self, rows: list[tuple[str, str]], tolerance: str) -> None:
        """_h: where the last two terms of some series fall to what is tolerated; each is multiplied by its weight."""
        w = self.w
        w.line("_bits", f"as_bits({tolerance})")
        write_length(w, rows, self.n, "_bits", "_h")
        w.line("_longest", f"{literal(self.k.longest)} * {self._value(self.eq.period)}")
        w.line("_h", "_h if _h < _longest else _longest")
        w.line("_ends", "_rem <= _h * 1.0000001")
        w.line("_h", "_rem if _ends else _h")

    def _at(self, row: str, first: str, h: str) -> str:
        return horner([first, *(f"{row}[{m}]" for m in range(1, self.n + 1))], h)

    def _rate_at(self, row: str, h: str) -> str:
        if row in self.rates:
            return horner([f"{self.rates[row]}[{m}]" for m in range(1, self.n + 1)], h)
        return horner([f"{row}[1]", *(f"{m}.0 * {row}[{m}]" for m in range(2, self.n + 1))], h)

    def _ahead(self, row: str, site: str, mine: str) -> None:
        """_ve, _de: velocity and its rate at _h; _far: whether an exponential rises too far on the way, each by its own _rise."""
        w = self.w
        w.line("_ve", self._at(row, "_y0", "_h"))
        w.line("_de", self._rate_at(row, "_h"))
        if not self.rising:
            return
        w.line("_least", "_ve * _b0")
        w.line("_turns", f"{self.f[0]} * _b0 < 0.0 and _de * _b0 > 0.0 and {mine}")
        w.begin("if _turns")
        w.line("_lt", f"_h * ({self.f[0]} / ({self.f[0]} - _de))")
        w.line("_lt", self._at(row, "_y0", "_lt"))
        w.line("_least", "_lt * _b0 if (_turns and _lt * _b0 < _least) else _least")
        w.end()
        nearest = w.line(f"_near{site}", "(_least if _least > 0.0 else 0.0) * _b0")
        end = self.start | {"v": nearest, "t": w.line(f"_then{site}", "_t + _h")}
        w.line("_far", "False")
        for i, (node, before) in enumerate(zip(self.rising, self.before, strict=True)):
            w.line(f"_rise{i}", f"{self._value(node.args[0], end)} - {before}")
            w.line("_far", f"_far or _rise{i} > _low{i}")
        w.line("_far", f"_far and {mine}")

    def _foresee(self, row: str, site: str, mine: str) -> None:
        """Shorten a step in which an exponential would rise too far."""
        w = self.w
        self._ahead(row, f"{site}a", mine)
        if not self.rising:
            return
        w.begin(f"for q in while_any(_far, {CUTS})")
        w.line("_part", "0.8")
        for i, before in enumerate(self.before):
            w.line("_bend", f"1.0 + _low{i} / ({before} if {before} < -1.0 else -1.0)")  # a Gaussian's argument is a square
            w.line("_good", "(1.0 - math.sqrt(_bend if _bend > 0.0 else 0.0)) * (_y0 / (_y0 - _ve))")
            w.line("_part", f"_good if (_rise{i} > _low{i} and _good < _part) else _part")
        w.line("_part", "_part if _part > 0.1 else 0.1")
        w.line("_h", "_h * _part if _far else _h")
        w.line("_ends", "_ends and not _far")
        self._ahead(row, f"{site}b", mine)
        w.end()

    # ---- z slaved ----
    def _slaved(self) -> None:
        """The step of lanes in which z is slaved, where it succeeds: then they are _done."""
        w, law = self.w, self.law
        w.begin("if more(_slow, _mine)")
        w.line("_mine", "False")
        row = self._sweeps()
        self._tolerances()
        self._relaxes()
        w.line("_ts", f"{literal(self.k.slow)} * _tv")
        self._wish([(row, "_bent"), ("_zr", "_size")], "_ts * _bent")
        self._foresee(row, "s", "_slow")
        w.line("_off", self._left("_brake", "_brake1", "_brake2"))
        self._shorten(row)
        end = self.start | {"v": w.line("_vs", "1.0 * _ve"), "t": w.line("_tn", "_t + _h"), law.rate.name: "_sped"} | self._rest("_h")
        first, last = self._first(), w.value(law.weight, end)
        w.line("_zn", f"1.0 * {w.value(law.z, end)}")
        same = ["_slow", "_y0 * _b0 > 0.0", "_ve * _b0 > 0.0", "_off * _h <= _ts", f"abs({last}) * _late * _h <= _ts"]
        w.line("_done", " and ".join([*same, f"abs({first} * (_y1 - _zs)) <= _ts", *self._solves_rest(last)]))
        self._gone("_done", row, "_zr", "_y0", "_zs", "_zn")
        w.line("_refused", "_slow and not _done")
        w.begin("if _refused")
        w.line("_over", "_off * _h / _ts")
        w.line("_over", "math.sqrt(math.sqrt(_over if _over > 1.0 else 1.0))")  # some four sweeps gain as much as the fourth power
        w.line("_over", "_over if _over < 3.0 else 3.0")
        w.line("_later", f"{literal(0.8)} * abs({self.f[0]}) / (_fast * _over + 1e-290)")
        w.line("_later", f"_later if _later > {literal(LEAST * self.k.slaved)} else {literal(LEAST * self.k.slaved)}")
        w.line("_later", f"_later if abs({first} * (_y1 - _zs)) <= _ts else _below")  # what is not slaved yet soon is
        w.line("_lim", "-_later if _refused else _lim")  # below zero: an explicit step first
        w.line("_nrej", "_nrej + (1.0 if _refused else 0.0)")
        w.end()
        w.end()

    def _sweeps(self) -> str:
        """_zr: the series of z as the last sweep found it, _dz and _dw: those of z' in it and in the one before; returns the row of v."""
        w, law, n, graph = self.w, self.law, self.n, self.eq.graph
        for row in ("_zr", "_dz", "_dw"):
            w.line(row, f"row({n + 1})")
        for name in ("_brake", "_brake1", "_brake2", "_zs", "_dz0"):
            w.line(name, "0.0")
        at_rest = Substituted(graph, dict.fromkeys(law.swept, graph.constant(0.0)))
        self._begin_rest()
        self._sweep(at_rest.of(law.braked), at_rest.of(law.z), {})
        w.begin(f"for m in each(0, {n + 1})")
        w.line("_dz[m]", "0.0")
        w.end()
        for node in law.not_swept(graph):
            self._value(node)
        w.begin(f"for sweep in range(1, {self.k.sweeps})")
        w.begin(f"for m in each(0, {n})")
        w.line("_dw[m]", "1.0 * _dz[m]")
        w.line("_dz[m]", "(m + 1) * _zr[m + 1]")
        w.end()
        w.line(f"_dz[{n}]", "0.0")
        w.line("_dz0", "1.0 * _dz[0]")
        row = self._sweep(law.braked, law.z, {law.rate.number: "_dz"} | self._rest_row())
        self._write_rest(row)
        w.end()
        return row

    def _sweep(self, braked: Sym, z: Sym, known: dict[int, str]) -> str:
        """The series of v with a known z', and that of z, which follows from it."""
        w, n = self.w, self.n
        bind = self.start | {self.law.rate.name: "_dz0"} | self._rest()
        rows = RowWriter([self.eq.y[0]], [braked], [z], w, bind, n, known, out=True)
        rows.write()
        w.line("_brake2", "1.0 * _brake1")
        w.line("_brake1", "1.0 * _brake")
        w.line("_brake", f"1.0 * {w.value(braked, bind)}")
        w.line("_zs", f"1.0 * {w.value(z, bind)}")
        w.begin(f"for m in each(1, {n + 1})")
        w.line("_zr[m]", f"1.0 * {rows.rows[z.number]}[m]" if z.number in rows.rows else "0.0")
        w.end()
        return rows.rows[self.eq.y[0].number]

    # A rate of several pieces has a rest; here there is none.
    def _begin_rest(self) -> None:
        """The rest of the first sweep."""

    def _write_rest(self, v: str) -> None:
        """The rest for the next sweep, which follows from what this one found."""

    def _solves_rest(self, weight: str) -> list[str]:
        """Whether it is what it follows from, where the step ends, as far as matters: conditions."""
        return []

    def _rest_row(self) -> dict[int, str]:
        """Its row, by the number of the variable that stands for it."""
        return {}

    def _rest(self, h: str = "") -> dict[str, str]:
        """What the variable is where the step begins, or at h."""
        return {}

    def _first(self) -> str:
        """The derivative of the acceleration by z' at the start of the step."""
        return self.w.value(self.law.weight, self.start | {self.law.rate.name: "_dz0"} | self._rest())

    def _shorten(self, row: str) -> None:
        """Shorten a step at whose end z would be less slaved, or the sweeps further apart, than is tolerated; _sped: z' at the end."""
        w, n = self.w, self.n

        def look() -> None:
            w.line("_sped", horner(["_zr[1]", *(f"{m}.0 * _zr[{m}]" for m in range(2, n + 1))], "_h"))
            w.line("_was", horner([f"_dz[{m}]" for m in range(n)], "_h"))
            w.line("_before", horner([f"_dw[{m}]" for m in range(n)], "_h"))
            w.line("_late", self._left("_sped", "_was", "_before"))
            w.line("_long", f"abs(_de) * (_y0 * _y0) > {literal(SLACK * self.k.slaved)} * _fast * (_ve * _ve) or _ve * _b0 <= 0.0")
            w.line("_long", f"_slow and (_long or abs({first}) * _late * _h > _ts)")

        first = self._first()
        look()
        w.begin(f"for q in while_any(_long, {SHORTER})")
        w.line("_h", "0.6 * _h if _long else _h")
        w.line("_ends", "_ends and not _long")
        w.line("_ve", self._at(row, "_y0", "_h"))
        w.line("_de", self._rate_at(row, "_h"))
        look()
        w.end()

    def _left(self, now: str, before: str, first: str) -> str:
        """How far what the last sweep found may be from what further ones would find: each gains about as much as the one before."""
        w = self.w
        w.line("_step", f"abs({now} - {before})")
        w.line("_gain", f"{literal(GAIN)} * _step / (abs({before} - {first}) + 1e-290)")
        return "_step * (_gain if _gain < 1.0 else 1.0)"

    # ---- explicit ----
    def _explicit(self) -> None:
        """The step of all other lanes: to the end of what the series bears, or to where v passes zero."""
        w = self.w
        v, z = (self.explicit.rows[y.number] for y in self.eq.y)
        self.rates[v] = self.slope_row
        w.begin("if _mine")
        self.explicit.write()
        self._tolerances()
        self._wish([(v, "_bent"), (z, "_size")], "_tv * _bent")
        self._foresee(v, "f", "_mine")
        self._crossing(v)
        w.line("_zn", self._at(z, "_y1", "_h"))
        self._gone("_mine", v, z, "_y0", "_y1", "_zn")
        w.line("_lim", "abs(_lim) if _mine else _lim")
        w.end()

    def _crossing(self, v: str) -> None:
        """Where v leaves its side: _h is shortened to there. A lane whose v begins at zero and goes to the other side is _wrong."""
        w = self.w
        w.line("_slope", f"{self.f[0]} * _b0")
        w.line("_calm", f"{literal(CALM)} * _tv")  # at rest v has either sign, by less than matters: its side stays
        w.line("_still", f"{literal(TINY)} * {self._value(self.eq.velocity_scale)}")
        w.line("_calm", "_calm if _calm > _still else _still")
        w.line("_depth", "_ve * _b0")
        w.line("_out", "_depth < -_calm and _mine")
        w.line("_dip", "_slope < 0.0 and _de * _b0 > 0.0 and _mine and fma(_slope, _h, _y0 * _b0) < 0.0 and not _out")
        w.line("_any", "_out or _dip")
        w.begin("if _any")
        w.line("_hi", "1.0 * _h")
        w.line("_deep", "False")
        w.begin("if _dip")
        self._turning(v)
        w.line("_lt", f"({self._at(v, '_y0', '_pt')}) * _b0")
        w.line("_deep", "_dip and _lt < -_calm")
        w.line("_hi", "_pt if _deep else _hi")
        w.line("_depth", "_lt if _deep else _depth")
        w.line("_out", "_out or _deep")
        w.end()
        w.line("_wrong", f"_out and _y0 * _b0 <= 0.0 and (_slope < 0.0 or (_slope == 0.0 and {v}[2] * _b0 < 0.0))")
        w.line("_cross", "_out and not _wrong")
        w.line("_gap", "_y0 * _b0 - _depth")
        w.line("_s", "_y0 * _b0 / (_gap if _gap > 0.0 else 1.0)")
        w.line("_th", "_hi * _s if _slope < 0.0 else 0.5 * _hi")  # from a start at zero: the zero after it, from the far end
        self._guess()
        self._search(v)
        w.line("_h", "_th if _cross else (0.0 if _wrong else _h)")
        w.line("_ends", "_ends and not _out")
        w.line("_ve", "0.0 if _cross else (_y0 if _wrong else _ve)")
        w.line("_de", f"_dt * _b0 if _cross else ({self.f[0]} if _wrong else _de)")
        w.end()

    def _turning(self, v: str) -> None:
        """_pt: where v turns within _h; beyond the first guess a Newton's step that leaves the bracket is halved."""
        w, first = self.w, self.f[0]
        w.line("_pa", "0.0")
        w.line("_pc", "1.0 * _h")
        w.line("_pt", f"_h * ({first} / ({first} - _de))")
        w.begin(f"for q in range(0, {PEAKS})")
        w.line("_pd", self._rate_at(v, "_pt"))
        w.line("_pp", horner([f"2.0 * {v}[2]", *(f"{m * (m - 1)}.0 * {v}[{m}]" for m in range(3, self.n + 1))], "_pt"))
        w.line("_same", f"_pd * {first} > 0.0")
        w.line("_pa", "_pt if _same else _pa")
        w.line("_pc", "_pc if _same else _pt")
        w.line("_go", "_pd / (_pp if _pp != 0.0 else 1.0)")
        w.line("_pt", "_pt - _go")
        w.line("_within", "(_pt > _pa and _pt < _pc) or abs(_go) < 1e-8 * _h")  # what has converged is left where it is
        w.line("_pt", "_pt if _within else 0.5 * (_pa + _pc)")
        w.end()

    def _guess(self) -> None:
        """_th: where the cubic of time over v is at v = 0, from the slopes at both ends of a step in which v falls."""
        w = self.w
        w.line("_falls", "_slope < 0.0 and _de * _b0 < 0.0 and not _deep")
        w.line("_a", "_gap / (-_slope if _falls else 1.0)")
        w.line("_c", "_gap / (-(_de * _b0) if _falls else 1.0)")
        w.line("_tn", "_s * _s * ((3.0 - 2.0 * _s) * _hi - (1.0 - _s) * _c) + _s * (1.0 - _s) * (1.0 - _s) * _a")
        w.line("_th", "_tn if (_falls and _tn > 0.0 and _tn < _hi) else _th")

    def _search(self, v: str) -> None:
        """Newton's method in a bracket, or bisection; a lane that has converged, or does so with its next step, is left alone."""
        w = self.w
        w.line("_lo", "0.0")
        w.line("_dt", "0.0")
        w.line("_bends", "2.0 * abs(_de * _b0 - _slope) / _h")
        w.line("_todo", "_cross and _cross")
        w.begin(f"for q in while_any(_todo, {ROUNDS})")
        w.line("_in", "_th > _lo and _th < _hi")
        w.line("_th", "0.5 * (_lo + _hi) if (_todo and not _in) else _th")
        w.line("_vt", f"({self._at(v, '_y0', '_th')}) * _b0")
        w.line("_dt", f"({self._rate_at(v, '_th')}) * _b0 if _todo else _dt")
        w.line("_up", "_vt > 0.0")
        w.line("_lo", "_th if (_todo and _up) else _lo")
        w.line("_hi", "_th if (_todo and not _up) else _hi")
        w.line("_go", "_vt / (_dt if _dt < 0.0 else -1e-290)")
        w.line("_tn", "_th - _go")
        w.line("_near", "_tn >= _lo and _tn <= _hi")
        w.line("_close", "(abs(_vt) <= _calm or _bends * _go * _go <= _calm) and _near or _hi - _lo <= 1e-15 * _h")
        w.line("_tn", "_tn if _near else 0.5 * (_lo + _hi)")
        w.line("_th", "_tn if _todo else _th")
        w.line("_todo", "_todo and not _close")
        w.end()

    # ---- after the step ----
    def _gone(self, mine: str, v: str, z: str, v0: str, z0: str, z1: str) -> None:
        """Take what a step came to for the lanes that made it."""
        w, n = self.w, self.n
        w.line("_way", f"_h * {horner([v0, *(f'{literal(1 / (m + 1))} * {v}[{m}]' for m in range(1, n + 1))], '_h')}")
        for name, value in (("went", "_h"), ("v", "_ve"), ("z", z1), ("dx", "_way"), ("d1", "_de"), ("most", "_ve")):
            w.line(f"_{name}", f"{value} if {mine} else _{name}")
        w.line("_last", f"_ends if {mine} else _last")
        self._looking("0.1")
        self._extremum(mine, v)
        w.end()
        self._looking("0.5")
        rise = horner([f"{z}[1]", *(f"{m}.0 * {z}[{m}]" for m in range(2, n + 1))], "_h")
        w.line("_slips", f"0.0 if _ve == 0.0 else 1.0 - ({rise}) / (_ve if _ve != 0.0 else 1.0)")
        w.line("_tail[0]", f"_slips if {mine} else _tail[0]")
        w.line("_pw", "1.0 * _h")
        kept = [("_k0", v, v0), ("_k1", z, z0)]
        for name, _, first in kept:
            w.line(f"{name}[0]", f"{first} if {mine} else {name}[0]")
        w.begin(f"for m in each(1, {n + 1})")
        for name, row, _ in kept:
            w.line(f"{name}[m]", f"_pw * {row}[m] if {mine} else {name}[m]")
        w.line("_pw", "_pw * _h")
        w.end()
        w.end()

    def _extremum(self, mine: str, v: str) -> None:
        """_most: the largest or smallest velocity within the step, where it turns; else that at its end."""
        w = self.w
        w.line("_peak", f"{mine} and {self.f[0]} * _de < 0.0{'' if self.record else ' and _looked > 0.1'}")
        w.begin("if _peak")
        self._turning(v)
        w.line("_most", f"({self._at(v, '_y0', '_pt')}) if _peak else _most")
        w.end()

    def _end(self) -> None:
        """New state of the lanes that made a step; others wait."""
        w, eq = self.w, self.eq
        offset = self._value(eq.offset)
        self._relaxes()
        w.line("_was", "1.0 * _sort")
        w.line("_made", "_done or _mine")
        w.line("_heads", "abs(_d1) * (_y0 * _y0) < _below * _fast * (_v * _v) and _lim >= 0.0 and _v * _b0 > 0.0")
        self._settle()
        w.line("_begun", "1.0 * _t")
        if self.record:
            w.line("_x0", "1.0 * _x")
            w.line(f"_{sides(eq)[0]}", "1.0 * _b0")
        w.line("_x", "_x + _dx" if offset.strip("()") in ("0.0", "-0.0") else f"_x + fma({offset}, _went, _dx)")
        w.line("_y0", "_v if _made else _y0")
        w.line("_y1", "_z if (_made and not _wrong) else _y1")
        w.line("_m1", "abs(_y1) if abs(_y1) > _m1 else _m1")
        w.line("_b0", "-_b0 if (_cross or _wrong) else _b0")
        w.line("_lim", "0.0 if (_cross or _wrong) else _lim")
        w.line("_sort", "1.0 if (_made and _heads) else (0.0 if (_made or _refused) else _sort)")
        w.line("_nacc", "_nacc + (1.0 if _made else 0.0)")
        w.line("_short", f"_went < fma(_t, 4.5e-16, 1e-25 * {self._value(eq.period)}) and _made and not ({self.ends})")
        w.line("_t", "_tend if _last else _t + _went")
        w.line("_stat", f"1.0 if _last else ({Status.TOO_SMALL}.0 if _short else _stat)")
        w.line("_stat", f"{Status.NOT_A_NUMBER}.0 if (_y0 != _y0 or _y1 != _y1) else _stat")
        w.line("_stat", f"{Status.BUDGET}.0 if (_nacc + _nrej > budget and _stat < 0.5) else _stat")
        self._look_at_end()
        if not self.record:  # which sort of step a lane wants next, and whether something is to be noted, or there is no case
            w.line("_soon", "_sort + (2.0 if (_stat > 0.5 or _looked > 0.5) else 0.0)")
            w.line("_marks", "bits(_soon != _was and not _idle)")

    def _settle(self) -> None:
        """What else must hold that z may be slaved."""

    def _look_at_end(self) -> None:
        """Values recorded at the end of a step if the lane is observed."""
        w = self.w
        self._looking("0.1")
        for name, value in (("t0", "_begun"), ("hh", "_went"), ("top", "_most")):
            w.line(f"_{name}[0]", f"1.0 * {value}")
        if not self.record:
            for name, sign in (("_high", ">"), ("_low", "<")):
                w.line("_more", f"_most if _most {sign} _y0 else _y0")
                w.line(f"{name}[0]", f"_more if (_looked > 0.1 and _more {sign} {name}[0]) else {name}[0]")
        w.end()
        if self._works:
            self._looking("0.5")
            self._work()
            w.end()

    @property
    def _works(self) -> bool:
        """Whether a step adds up the work of friction itself; else ``kernels/work.py`` does so lane by lane."""
        return not self.record and self.eq.offered is not None

    def _work(self) -> None:
        """What was offered in the step and did not become kinetic energy, by the rule and on the dense output of ``kernels/work.py``."""
        w, eq, n = self.w, self.eq, self.n

        def velocity(part: str) -> str:
            return horner([f"_k0[{m}]" for m in range(n + 1)], part)

        rule = rule_of_work(n)
        for k, pair in enumerate(zip(*rule, strict=True)):
            for letter, number in zip("nw", pair, strict=True):
                w.line(f"_{letter}{k}", literal(number))
        w.line("_sum", "0.0")
        w.begin(f"for q in range(0, {len(rule[0])})")  # in a loop, since its text would be as long again as that of all else here
        offered = w.value(eq.offered, self.start | {"t": w.line("_then", "fma(_n0, _went, _begun)")})
        w.line("_sum", f"fma(_w0 * {offered}, {velocity('_n0')}, _sum)")
        for k in range(len(rule[0]) - 1):
            for letter in "nw":
                w.line(f"_{letter}{k}", f"1.0 * _{letter}{k + 1}")
        w.end()
        w.line("_ve", velocity("1.0"))
        w.line("_work[0]", f"_sum * _went - 0.5 * {self._value(eq.mass)} * (_ve - _k0[0]) * (_ve + _k0[0])")
