"""One step under a law whose rate has several smooth pieces, as elasto-plastic friction's: on one z relaxes, on one it is elastic.

Where z does not relax, the equations are nearly linear, and their series cost next to nothing. Where it relaxes as under LuGre, z is slaved
to v as there (`slaved.py`). Pieces between, on which the rate may be any function of z, have explicit series; near the piece where it
relaxes z is slaved too: there it is what it would be on that piece, and an excess that is small and follows from the z of the sweep before.

On which piece a lane is, is asked where a step begins. A step ends where a condition changes, within what does not matter, as the rates
have no jump there.
"""

from __future__ import annotations

from stickslip.engine.graphs import Substituted
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.rows import RowWriter
from stickslip.engine.slaved import ROUNDS, Series, StepWriter
from stickslip.engine.slaving import Slaving, slaving
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.values import needed_by
from stickslip.engine.write import literal, write_secants

LOOSE = 1.0  # of what is tolerated: how far beyond its zero a condition may be
NEAR = 0.1  # of z: excess from which on it is not slaved


def write_step(eq: System, method: Series, record: bool) -> Step:
    """The lines of one step under a law of either sort; with `record` the dense output is kept always, else while a lane is looked at."""
    law = slaving(eq)
    if isinstance(law, str):
        raise TypeError(law)
    return (StepWriter if law.pieces is None else _PiecesWriter)(eq, method, law, record).write()


class _PiecesWriter(StepWriter):
    ends = "_last or _wrong or _cross or _met"

    def __init__(self, eq: System, method: Series, law: Slaving, record: bool):
        super().__init__(eq, method, law, record)
        assert law.pieces is not None
        self.pieces, self.others = law.pieces, range(1, eq.signs)
        rising = {node.number for node in self.rising}
        self.rises = any(node.number in rising for node in needed_by(self._on_side(law.pieces.side)))
        self.w.count_uses([*eq.guards, law.pieces.excess])

    def _rates(self) -> list[Sym]:
        return self._on_side(-self.pieces.side)

    def _on_side(self, side: float) -> list[Sym]:
        """The rates, elastic or not."""
        there = Substituted(self.eq.graph, {self.pieces.free: self.eq.graph.constant(side)})
        return [there.of(f) for f in self.eq.f]

    def _begin(self) -> None:
        """The conditions; rows that all sorts of steps share."""
        w, eq = self.w, self.eq
        for k in self.others:
            guard = self._value(eq.guards[k])
            w.line(f"_b{k}", f"1.0 if {guard} > 0.0 else (-1.0)")
        super()._begin()
        StepWriter._tolerances(self)
        for k in self.others:
            w.line(f"_calm{k}", f"fma({literal(LOOSE)} * rtol, {self._size_of(eq.guards[k])}, 1e-290)")
            w.line(f"_from{k}", f"abs({self._value(eq.guards[k])}) + _calm{k}")
        w.line("_free", f"_mine and _{self.pieces.free} * {literal(self.pieces.side)} > 0.0")
        w.line("_mine", "_mine and not _free")
        self.elastic = RowWriter(eq.y, self._on_side(self.pieces.side), [], w, self.start, self.n, out=True)
        for row in ("_pv", "_pz"):
            w.line(row, f"row({self.n + 1})")
            w.begin(f"for m in each(1, {self.n + 1})")
            w.line(f"{row}[m]", "0.0")
            w.end()
        for name in ("_wh", "_wv", "_wd", "_wz", "_z0"):
            w.line(name, "0.0")
        w.line("_we", "False")
        w.line("_met", "False")

    def _tolerances(self) -> None:
        """They are known."""

    def _size_of(self, guard: Sym) -> str:
        """The size of what a guard is the difference of, or how it changes with the states."""
        if guard.op in ("add", "subtract"):
            return f"({' + '.join(f'abs({self._value(part)})' for part in guard.args)})"
        slopes = [self._value(self.eq.graph.derivative(guard, y)) for y in self.eq.y]
        return f"fma(abs({slopes[0]}), _size, abs({slopes[1]}) * _bent)"

    # ---- z slaved ----
    def _begin_rest(self) -> None:
        w = self.w
        there = " and ".join(f"_{flag} * {literal(side)} > 0.0" for flag, side in self.pieces.relaxing.items())
        w.line("_bends", f"_slow and not ({there})")
        w.line("_er", f"row({self.n + 1})")
        w.line("_er0", "0.0")
        w.begin(f"for m in each(0, {self.n + 1})")
        w.line("_er[m]", "0.0")
        w.end()

    def _write_rest(self, v: str) -> None:
        w, eq = self.w, self.eq
        there = self.start | {eq.y[1].name: "_zs"}
        w.line("_going", f"1.0 * sweep < {literal(self.k.sweeps - 1.5)} and _bends")
        w.begin("if _going")
        zero = eq.graph.constant(0.0)
        known = {eq.y[0].number: v, eq.y[1].number: "_zr"}
        rows = RowWriter([eq.y[0]], [zero], [self.pieces.excess], w, there, self.n, known, out=True, called="_re")
        rows.write()
        w.line("_er0", f"{w.value(self.pieces.excess, there)} if _bends else 0.0")
        w.begin(f"for m in each(1, {self.n + 1})")
        w.line("_er[m]", f"{rows.rows[self.pieces.excess.number]}[m] if _bends else 0.0")
        w.end()
        w.end()

    def _solves_rest(self, weight: str) -> list[str]:
        there = self.start | {y.name: name for y, name in zip(self.eq.y, ("_vs", "_zn"), strict=True)} | {"t": "_tn"}
        off = f"abs({weight} * ({self.w.value(self.pieces.excess, there)} - _ere)) <= _ts"
        return [f"(not _bends or ({off} and abs(_ere) < {literal(NEAR)} * abs(_zn)))"]

    def _rest_row(self) -> dict[int, str]:
        return {self.pieces.rest.number: "_er"}

    def _rest(self, h: str = "") -> dict[str, str]:
        return {self.pieces.rest.name: self.w.line("_ere", self._at("_er", "_er0", h)) if h else "_er0"}

    def _settle(self) -> None:
        w = self.w
        w.line("_asked", "_heads and _mine")
        w.begin("if _asked")
        excess = w.value(self.pieces.excess, self.start | {y.name: name for y, name in zip(self.eq.y, ("_v", "_z"), strict=True)})
        w.line("_heads", f"_heads and (abs({excess}) < {literal(NEAR)} * abs(_z) or not _mine)")
        w.end()

    # ---- explicit ----
    def _explicit(self) -> None:
        """The steps of all other lanes, elastic or between; where each lane's step ends, and what it came to."""
        w = self.w
        w.line("_tries", "False")
        w.begin("if more(_mine, _free)")
        self._try("_mine", self.explicit)
        w.line("_tries", "_mine and _mine")
        w.end()
        w.begin("if _free")
        self._try("_free", self.elastic)
        w.end()
        w.line("_mine", "_tries or _free")
        w.line("_lim", "abs(_lim) if _mine else _lim")
        w.line("_some", "_mine or _done")
        for name, value in (("_h", "_wh"), ("_ve", "_wv"), ("_de", "_wd"), ("_zn", "_wz")):
            w.line(name, f"1.0 * {value}")
        w.line("_ends", "_we and _some")
        self._crossing("_pv")
        w.line("_zn", f"({self._at('_pz', '_z0', '_h')}) if (_cross or _wrong) else _zn")
        self._meet()
        super()._gone("_some", "_pv", "_pz", "_y0", "_z0", "_zn")

    def _try(self, mine: str, rows: RowWriter) -> None:
        """An explicit step as far as the series bear."""
        v, z = (rows.rows[y.number] for y in self.eq.y)
        rows.write()
        self._wish([(v, "_bent"), (z, "_size")], "_tv * _bent")
        if mine == "_free" and not self.rises:
            w = self.w
            w.line("_ve", self._at(v, "_y0", "_h"))
            w.line("_de", self._rate_at(v, "_h"))
        else:
            self._foresee(v, mine[1], mine)
        self._gone(mine, v, z, "_y0", "_y1", self._at(z, "_y1", "_h"))

    def _gone(self, mine: str, v: str, z: str, v0: str, z0: str, z1: str) -> None:
        """Put a step beside those of other lanes."""
        w = self.w
        alone = mine != "_free"  # slaved or between: never both in one call, and before those that are elastic
        for name, value in (("_wh", "_h"), ("_wv", "_ve"), ("_wd", "_de"), ("_wz", z1), ("_z0", z0)):
            w.line(name, f"1.0 * {value}" if alone else f"{value} if {mine} else {name}")
        w.line("_we", f"_ends and {mine}" if alone else f"(_ends and {mine}) or (_we and not {mine})")
        w.begin(f"for m in each(1, {self.n + 1})")
        for name, row in (("_pv", v), ("_pz", z)):
            w.line(f"{name}[m]", f"1.0 * {row}[m]" if alone else f"{row}[m] if {mine} else {name}[m]")
        w.end()

    # ---- conditions ----
    def _meet(self) -> None:
        """Where the first condition changes, if one does: _h is shortened to there."""
        w = self.w
        w.begin("if _done")  # z slaved is known to its tolerance only
        for k, begin in zip(self.others, self._guards("0.0", "_y0", "_z0"), strict=True):
            w.line(f"_from{k}", f"{begin} + rtol * _bent if _done else _from{k}")
            w.line(f"_calm{k}", f"_calm{k} + rtol * _bent if _done else _calm{k}")
        w.end()
        ends, halves = self._guards("_h", "_ve", "_zn"), self._guards(w.line("_half", "0.5 * _h"))
        for k, end, half in zip(self.others, ends, halves, strict=True):
            w.line(f"_out{k}", f"({end} < 0.0 or {half} < 0.0) and _from{k} > 0.0 and _some")
        w.line("_seek", " or ".join(f"_out{k}" for k in self.others))
        w.line("_met", "_seek and _seek")
        w.begin("if _seek")
        self._search_guards(ends, halves)
        w.line("_ve", f"({self._at('_pv', '_y0', '_h')}) if _met else _ve")
        w.line("_de", f"({self._rate_at('_pv', '_h')}) if _met else _de")
        w.line("_zn", f"({self._at('_pz', '_z0', '_h')}) if _met else _zn")
        for name in ("_ends", "_cross", "_wrong"):
            w.line(name, f"{name} and not _met")
        w.end()

    def _guards(self, h: str, v: str = "", z: str = "") -> list[str]:
        """How far the guards are from what ends a step, at a time after its start."""
        w, eq = self.w, self.eq
        v = v or w.line(w.fresh(), self._at("_pv", "_y0", h))
        z = z or w.line(w.fresh(), self._at("_pz", "_z0", h))
        there = self.start | {"v": w.line(w.fresh(), f"1.0 * {v}"), eq.y[1].name: w.line(w.fresh(), f"1.0 * {z}")}
        there |= {"t": w.line(w.fresh(), f"_t + {h}")}
        return [w.line(w.fresh(), f"fma({w.value(eq.guards[k], there)}, _b{k}, _calm{k})") for k in self.others]

    def _least(self, values: list[str]) -> str:
        """The least of the guards, each in parts of how far it may be beyond its zero."""
        w, least = self.w, "1e300"
        for k, value in zip(self.others, values, strict=True):
            part = w.line(w.fresh(), f"{value} * _unit{k} if _from{k} > 0.0 else 1e300")
            least = w.line(w.fresh(), f"{part} if {part} < {least} else {least}")
        return least

    def _search_guards(self, ends: list[str], halves: list[str]) -> None:
        """The first zero of the least of them, by secants in a bracket, from where the first parabola through three points has its own."""
        w = self.w
        w.line("_th", "1.0")
        for k, end, half in zip(self.others, ends, halves, strict=True):
            w.line(f"_unit{k}", f"1.0 / _calm{k}")
            w.line("_fall", f"fma(4.0, {half}, fma(-3.0, _from{k}, -{end}))")
            w.line("_bend", f"2.0 * ((_from{k} - {half}) - ({half} - {end}))")
            w.line("_root", f"fma(_fall, _fall, -4.0 * _bend * _from{k})")
            w.line("_root", "math.sqrt(_root if _root > 0.0 else 0.0) - _fall")
            w.line("_tn", f"2.0 * _from{k} / (_root if _root > 0.0 else 1.0)")
            w.line("_th", f"_tn if (_out{k} and _tn > 0.0 and _tn < _th) else _th")
        middle, end = self._least(halves), self._least(ends)
        w.line("_late", f"{middle} > 0.0")
        for name, early, late in (("_lo", "0.0", "_half"), ("_hi", "_half", "_h"), ("_xb", "_half", "_half")):
            w.line(name, f"{late} if _late else {early}")
        w.line("_gb", f"1.0 * {middle}")
        w.line("_xa", "_h if _late else _half")
        w.line("_ga", f"{end} if _late else {middle}")
        w.line("_th", "_th * _h")
        w.line("_th", "_th if (_th > _lo and _th < _hi) else 0.5 * (_lo + _hi)")
        write_secants(w, ROUNDS, lambda: self._least(self._guards("_th")), "_pd", "0.5")
        w.line("_h", "_th if _met else _h")
