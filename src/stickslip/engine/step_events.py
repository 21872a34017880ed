"""Whether and where a guard changes sign in a Rosenbrock step, written out: part of the step's text.

The dense output is looked at on the side that a flag holds. Of several guards the one that goes first is located; the step ends there,
or, if it began on the wrong side, the flag flips and the step is done again.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from stickslip.engine.graphs import Along
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.write import Writer, horner

_ORDER = 1e-8  # of the size of a guard: how far beyond its zero it may be where another one's event is, if both come in one step
_LOCATED = 1e-7  # of the size of a guard: how far beyond its zero the location of an event may leave it
_FLIPS = 2.5  # times that a flag flips at one instant, and half a time
_FALLS = 1.2  # steps in which a guard that falls as it begins would be at zero, if it may be there and back within one


class EventWriter:
    """The lines from the dense output to the decision; a step's writer brings the names of slopes and guards at its start."""

    eq: System
    w: Writer
    k: Any  # the constants of the control
    n: int  # states
    g: int  # guards
    degree: int  # of the dense output
    record: bool
    f: list[str]
    guard_start: list[str]
    guard_rate: list[str]
    slips: dict[int, int]  # guards that are the slip of a contact -> the state that is that slip
    scale_v: str
    extended: set[int]  # states whose dense output is written
    falls: dict[str, str]  # rate of a guard -> how far it falls in a step, and a little more
    _extend: Any  # writes that of a state
    _bind: Any  # names for time and states -> names for everything that an expression depends on

    def _at(self, polynomial: str, theta: str) -> str:
        return horner([f"{polynomial}_{m}" for m in range(self.degree + 1)], theta)

    def _rate_at(self, polynomial: str, theta: str) -> str:
        return horner([f"{polynomial}_1", *(f"{m}.0 * {polynomial}_{m}" for m in range(2, self.degree + 1))], theta)

    def _crossings(self) -> None:
        """Whether a guard leaves its held side in this step, and which goes first."""
        w = self.w
        w.line("_tiny", f"-1e-14 * {self.scale_v}")
        if self.g > 1 and self._all_slips:
            self._slip_crossings()
            return
        end = self._first_crossing()
        for k in range(1, self.g):
            self._other_crossing(k, end)

    def _first_crossing(self) -> dict[str, str]:
        """The first guard, to which the others are compared; names for what holds at the end of the step."""
        w, state = self.w, self.slips.get(0)
        if state is None:
            w.line("_to", "_t + _hh")
            end = self._bind("_to", [f"_n{i}" for i in range(self.n)])
            w.line("_g0s", f"{self.guard_start[0]} * _b0")
            w.line("_g0e", f"{w.value(self.eq.guards[0], end)} * _b0")
            self._sag(0, "_tiny")
            w.line("_te", "1.0 * _te0")
            w.line("_ge", "1.0 * _ge0")
        else:
            w.line("_g0s", f"_y{state} * _b0")
            w.line("_g0e", f"_n{state} * _b0")
            self._dip(state, "_b0", "_g0e", "")
        w.line("_late", "_g0s < _tiny and _on0 < 0.5")  # it starts on the wrong side: another guard's flip moved this one
        w.line("_cr", "_ge < _tiny or _late")
        if self.g > 1:
            w.line("_cr0", "_ge < _tiny or _late")
        w.line("_gs", "_g0s if _g0s > 0.0 else 0.0")
        w.line("_th", "_te * _gs / (_gs - _ge if _ge < _tiny else 1.0)")
        w.line("_pre", self._begins_at_zero(0, f"1e-6 * {self._size(self.eq.guards[0], end)}" if state is None else "-1e4 * _tiny"))
        w.line("_wrong", f"_late or {self._leaves(self.guard_rate[0], '_b0', '_g0e < _tiny')}")
        w.line("_which", "0.0")
        w.line("_size", "0.0")
        if state is not None:
            w.line("_to", "_t + _hh")
            end = self._bind("_to", [f"_n{i}" for i in range(self.n)])
        if self.g > 1:
            w.line("_size0", self._size(self.eq.guards[0], end))
        return end

    @property
    def _branches(self) -> bool:
        """Whether to jump over what did not happen: one lane alone, or several contacts, which have much to do and few vectors in turn."""
        return self.record or len(self.eq.contacts) > 1

    @property
    def _skips(self) -> bool:
        """Whether to jump over the location of events where there is none."""
        return self._branches and self._all_slips

    @property
    def _all_slips(self) -> bool:
        """Whether every guard is the slip of a contact that is a state: then what goes first is a polynomial that is known."""
        return len(self.slips) == self.g

    def _slip_crossings(self) -> None:
        """Slips of several contacts: which leave their sides is asked of all, and which goes first only where one does.

        _kg_<power> is then the dense output of that one, and _bg its held side.
        """
        w = self.w
        for k, i in self.slips.items():
            w.line(f"_g{k}s", f"_y{i} * _b{k}")
            w.line(f"_g{k}e", f"_n{i} * _b{k}")
            self._dip(i, f"_b{k}", f"_g{k}e", str(k))
            w.line(f"_late{k}", f"_g{k}s < _tiny and _on{k} < 0.5")  # it starts on the wrong side: its state was set
            w.line(f"_cr{k}", f"_ge{k} < _tiny or _late{k}")
        w.line("_cr", " or ".join(f"_cr{k}" for k in self.slips))
        polynomial = [f"_kg_{m}" for m in range(self.degree + 1)]
        for name in (*polynomial, "_bg", "_te", "_which"):
            w.line(name, "0.0")
        w.line("_th", "2.0")  # beyond the step
        w.line("_pre", "False")
        w.line("_wrong", "False")
        w.begin("if _cr")
        for k, i in self.slips.items():
            w.line("_gp", f"_g{k}s if _g{k}s > 0.0 else 0.0")
            w.line("_tk", f"_te{k} * _gp / (_gp - _ge{k} if _ge{k} < _tiny else 1.0)")
            w.line("_first", f"_cr{k} and _tk < _th")
            w.line("_pre", f"({self._begins_at_zero(k, '-1e4 * _tiny')}) if _first else _pre")
            w.line("_wrong", f"(_late{k} or {self._leaves(self.guard_rate[k], f'_b{k}', f'_ge{k} < _tiny')}) if _first else _wrong")
            values = [("_th", "_tk"), ("_te", f"_te{k}"), ("_which", f"{k}.0"), ("_bg", f"_b{k}")]
            for name, value in (*values, *zip(polynomial, (f"_k{i}_{m}" for m in range(self.degree + 1)), strict=True)):
                w.line(name, f"{value} if _first else {name}")
        w.end()

    def _dip(self, i: int, side: str, end: str, suffix: str) -> None:
        """Where a velocity is nearest to leaving its side: _te and _ge, the end of the step or the extremum of the dense output within."""
        w, d = self.w, self.degree
        w.line("_d0", f"_k{i}_1 * {side}")
        w.line("_d1", "(" + " + ".join(f"{m}.0 * _k{i}_{m}" for m in range(1, d + 1)) + f") * {side}")
        w.line("_dip", f"_d0 < 0.0 and _d1 > 0.0 and {end} >= 0.0")
        w.line("_low", end)
        if self._branches:
            w.line("_tx", "1.0")
            w.begin("if _dip")
        w.line("_tx", "_d0 / (_d0 - _d1) if _dip else 0.5")
        second = horner([f"2.0 * _k{i}_2", *(f"{m * (m - 1)}.0 * _k{i}_{m}" for m in range(3, d + 1))], "_tx")
        w.line("_curve", second)
        w.line("_tx", f"_tx - ({self._rate_at(f'_k{i}', '_tx')}) / (_curve if _dip else 1.0)")
        w.line("_dip", "_dip and _tx > 0.0 and _tx < 1.0")
        w.line("_low", f"({self._at(f'_k{i}', '_tx')}) * {side}")
        w.line("_dip", "_dip and _low < _tiny")
        w.end()
        w.line(f"_te{suffix}", "_tx if _dip else 1.0")
        w.line(f"_ge{suffix}", f"_low if _dip else {end}")

    @cached_property
    def _rates(self) -> dict[int, Sym]:
        """How guards that are no state change: expressions of the slopes of the states, by number of the guard."""
        graph, zero = self.eq.graph, self.eq.graph.constant(0.0)
        flow = Along(graph, {y.name: graph.variable(f"slope of {y.name}") for y in self.eq.y} | {self.eq.t.name: graph.constant(1.0)})
        rates = {k: flow.of(guard) for k, guard in enumerate(self.eq.guards) if k not in self.slips}
        return {k: rate for k, rate in rates.items() if rate is not zero}

    def _on_step(self, theta: str, node: Sym) -> str:
        """An expression of time, states and their slopes at a place of the dense output."""
        w, wanted = self.w, self.eq.graph.varies(node)
        there = self._bind(
            w.line(w.fresh(), f"fma({theta}, _hh, _t)"),
            [w.line(w.fresh(), self._at(f"_k{i}", theta)) if y.name in wanted else "0.0" for i, y in enumerate(self.eq.y)],
        )
        slopes = {f"slope of {y.name}": self._rate_at(f"_k{i}", theta) for i, y in enumerate(self.eq.y)}
        there |= {name: w.line(w.fresh(), f"({slope}) * _ih") for name, slope in slopes.items() if name in wanted}
        return w.value(node, there)

    def _sag(self, k: int, noise: str) -> None:
        """Where a guard that is no state is least in the step: _te<k> and _ge<k>, at its end, or at a minimum within, if that is negative.

        It is looked for where the guard falls so fast at the start that it would be gone by the end, and is not: at the minimum of the
        cubic that has its values and rates at both ends, which one Newton step moves to that of the dense output.
        """
        w, guard, rate = self.w, self.eq.guards[k], self._rates.get(k)
        w.line(f"_te{k}", "1.0")
        w.line(f"_ge{k}", f"1.0 * _g{k}e")
        if rate is None:
            return
        if self.guard_rate[k] not in self.falls:
            self.falls[self.guard_rate[k]] = w.line(w.fresh(), f"{_FALLS} * _hh * {self.guard_rate[k]}")
        w.line("_dip", f"fma({self.falls[self.guard_rate[k]]}, _b{k}, _g{k}s) < 0.0 and _g{k}e >= {noise}")
        w.begin("if _dip")
        w.line("_d0", f"{self.guard_rate[k]} * _hh * _b{k}")
        w.line("_d1", f"{self._on_step('1.0', rate)} * _hh * _b{k}")
        w.line("_rise", f"_g{k}e - _g{k}s")
        w.line("_bend", "3.0 * _rise - 2.0 * _d0 - _d1")
        w.line("_root", "math.sqrt(abs(fma(_bend, _bend, -3.0 * (_d0 + _d1 - 2.0 * _rise) * _d0)))")
        w.line("_tx", "-_d0 / (_bend + _root)")
        w.line("_tx", f"_tx - 0.5 * {self._on_step('_tx', rate)} * _b{k} * _hh / _root")
        w.line("_low", f"{self._on_step('_tx', guard)} * _b{k}")
        w.line("_dip", f"_dip and _g{k}s > 0.0 and _d1 > 0.0 and _tx > 0.0 and _tx < 1.0 and _low < {noise}")
        w.line(f"_te{k}", f"_tx if _dip else _te{k}")
        w.line(f"_ge{k}", f"_low if _dip else _ge{k}")
        w.end()

    def _begins_at_zero(self, k: int, near: str) -> str:
        """Whether a guard is at its zero where the step begins: it has just flipped there, and is no farther than its event is located.

        A flag that flips because a hit or a reset has moved its guard is not at a zero: what leaves that side in the step crosses later.
        """
        return f"(_on{k} > 0.5 and _g{k}s < {near}) or _g{k}s <= 0.0"

    def _leaves(self, rate: str, side: str, out: str) -> str:
        """Whether a guard that starts at zero goes to the other side: by its rate, or, where that is zero too, by where the step ends."""
        return f"({rate} * {side} < 0.0 or ({rate} == 0.0 and {out}))"

    def _is_memory(self, k: int) -> bool:
        """Whether the switch of a guard goes on without a jump of a velocity; stops, which have one, close where their rebounds end."""
        switch = self.eq.switches[k]
        return not switch.status and all(new is None for new in switch.states[: len(self.eq.offsets)])

    def _other_crossing(self, k: int, end: dict[str, str]) -> None:
        """The same for another guard; the one that goes first is kept."""
        w, guard, state = self.w, self.eq.guards[k], self.slips.get(k)
        w.line(f"_g{k}s", f"{self.guard_start[k]} * _b{k}")
        w.line(f"_g{k}e", f"{w.value(guard, end)} * _b{k}")
        w.line(f"_size{k}", self._size(guard, end))
        least, at = f"_ge{k}", f"_te{k}"
        if state is None:
            near = f"1e-6 * _size{k}"
            w.line("_noise", f"-1e-11 * _size{k}" if guard.op in ("add", "subtract", "select", "sin", "cos") else "0.0")
            self._sag(k, "_noise")
        else:
            near = "-1e4 * _tiny"
            self._dip(state, f"_b{k}", f"_g{k}e", str(k))
            w.line("_noise", "1.0 * _tiny")
        # far on the wrong side, a flag that has just flipped itself was moved by the flip of another
        if state is None and k < self.eq.signs:  # held where its event was located, its guard is off zero by what that left over
            held = f"_g{k}s < 0.0 and _g{k}s > -1e-7 * _size{k} and abs({self.guard_rate[k]} * _hh) < 1e-11 * _size{k}"
            w.line("_noise", f"_noise + _g{k}s if ({held}) else _noise")
        elif state is None and self._is_memory(k):  # as near to zero as events are located, and rising: it has not fallen
            rising = f"({self.guard_rate[k]} > 0.0 or ({self.guard_rate[k]} == 0.0 and _g{k}e > _g{k}s))"
            w.line("_noise", f"_noise + _g{k}s if (_g{k}s < 0.0 and _g{k}s > -{_LOCATED} * _size{k} and {rising}) else _noise")
        w.line("_late", f"_g{k}s < _noise and (_on{k} < 0.5 or _g{k}s < -1e-6 * _size{k})")
        w.line(f"_out{k}", f"{least} < _noise")
        w.line(f"_cr{k}", f"_out{k} or _late")
        w.line(f"_gp{k}", f"_g{k}s if _g{k}s > 0.0 else 0.0")
        w.line(f"_th{k}", f"{at} * _gp{k} / (_gp{k} - {least} if _out{k} else 1.0)")
        w.line("_first", f"_cr{k} and (not _cr or _th{k} < _th)")
        w.line("_pre", f"({self._begins_at_zero(k, near)}) if _first else _pre")
        w.line("_wrong", f"(_late or {self._leaves(self.guard_rate[k], f'_b{k}', f'_out{k}')}) if _first else _wrong")
        for name, value in (
            ("_gs", f"_gp{k}"),
            ("_ge", least),
            ("_th", f"_th{k}"),
            ("_te", at),
            ("_which", f"{k}.0"),
            ("_size", f"_size{k}"),
        ):
            w.line(name, f"{value} if _first else {name}")
        w.line("_cr", f"_cr or _cr{k}")

    def _size(self, guard: Sym, bind: dict[str, str]) -> str:
        """Size of the terms of which a guard is the difference: its rounding is a part of that."""
        if guard.op in ("add", "subtract"):
            return "(" + " + ".join(f"abs({self.w.value(a, bind)})" for a in guard.args) + ")"
        if guard.op == "select":
            held, yes, no = guard.args
            return f"({self._size(yes, bind)} if {self.w.value(held, bind)} > 0.0 else {self._size(no, bind)})"
        if guard.op in ("sin", "cos"):
            return "1.0"
        return f"abs({self.w.value(guard, bind)})"

    def _locate(self) -> None:
        """theta of the event on the dense output: safeguarded Newton for a slip, the secant method where other guards exist."""
        w = self.w
        w.line("_lo", "0.0")
        w.line("_hi", "_te")
        if self._skips:
            w.line("_conv", "False")
            for i in range(self.n):
                w.line(f"_v{i}", "0.0")
            w.begin("if _cr")
        if self._all_slips:
            self._newton(*(("_kg", "_bg") if self.g > 1 else ("_k0", "_b0")))
        else:
            self._secant()
        for i in range(self.n):
            if i not in self.extended:
                self._extend(i)
            w.line(f"_v{i}", self._at(f"_k{i}", "_th"))
        w.end()

    def _newton(self, polynomial: str, side: str) -> None:
        w = self.w
        for _ in range(self.k.newton):
            w.line("_pv", f"({self._at(polynomial, '_th')}) * {side}")
            w.line("_pd", f"({self._rate_at(polynomial, '_th')}) * {side}")
            w.line("_lo", "_th if _pv > 0.0 else _lo")
            w.line("_hi", "_hi if _pv > 0.0 else _th")
            w.line("_tn", "_th - _pv / (_pd if _pd != 0.0 else 1.0)")
            w.line("_th", "_tn if (_tn >= _lo and _tn <= _hi) else 0.5 * (_lo + _hi)")
        w.line("_pv", f"abs({self._at(polynomial, '_th')})")
        w.line("_conv", f"_pv <= 1e-10 * {self.scale_v}")

    def _secant(self) -> None:
        w = self.w
        close = "fma(1e-8, _span, 1e-15 * _size)"
        w.line("_span", "_gs - _ge")
        for name, value in (("_xa", "0.0"), ("_ga", "_gs"), ("_xb", "_te"), ("_gb", "_ge")):
            w.line(name, f"1.0 * {value}")
        for _ in range(self.k.newton + 1):
            w.line("_pv", self._chosen(self._guards_at("_th")))
            w.line("_up", "_pv > 0.0")
            w.line("_lo", "_th if _up else _lo")
            w.line("_hi", "_hi if _up else _th")
            near = "abs(_ga) < abs(_gb)"  # the nearer of the two points before and the new one: a secant
            w.line("_xb", f"_xa if {near} else _xb")
            w.line("_gb", f"_ga if {near} else _gb")
            w.line("_xa", "1.0 * _th")
            w.line("_ga", "1.0 * _pv")
            w.line("_gap", "_gb - _ga")
            w.line("_tn", "_th - _pv * (_xb - _xa) / (_gap if _gap != 0.0 else 1.0)")
            w.line("_mid", f"_th if abs(_pv) <= {close} else 0.5 * (_lo + _hi)")  # rounding has no slope
            w.line("_th", "_tn if (_tn >= _lo and _tn <= _hi) else _mid")
        values = self._guards_at("_th")
        w.line("_pv", f"abs({self._chosen(values)})")
        w.line("_conv", f"_pv <= {close}")
        for k, value in enumerate(values if self.g > 1 else []):
            size = self.scale_v if k in self.slips else f"_size{k}"
            w.line("_missed", f"_cr{k} and _g{k}s > 0.0 and {value} < -{_ORDER} * {size}")
            w.line("_conv", f"_conv and not (_missed and _which != {k}.0)")  # the chord misled: this one goes first

    def _guards_at(self, theta: str) -> list[str]:
        """Values of all guards on their held sides, on the dense output."""
        w = self.w
        y = [w.line(w.fresh(), self._at(f"_k{i}", theta)) for i in range(self.n)]
        t = w.line(w.fresh(), f"fma({theta}, _hh, _t)")
        return [w.line(w.fresh(), f"{w.value(guard, self._bind(t, y))} * _b{k}") for k, guard in enumerate(self.eq.guards)]

    def _chosen(self, values: Sequence[str], numbers: Sequence[int] | None = None) -> str:
        """That of the guard which goes first, of all or of those with these numbers."""
        w, text = self.w, "0.0"
        for k, value in zip(range(len(values)) if numbers is None else numbers, values, strict=True):
            text = w.line(w.fresh(), f"{value} if _which == {k}.0 else {text}")
        return text

    def _decide(self) -> None:
        w = self.w
        # started on the wrong side: flip and do the step again; but where either side leads to the other, by rounding, shorten the step
        flipped = self._chosen([f"_on{k}" for k in range(self.g)])
        w.line("_flip0", f"_ok and _cr and _pre and _wrong and {flipped} < {_FLIPS}")
        w.line("_evt", "_ok and _cr and not _flip0")
        w.line("_evA", "_evt and _conv and not _pre")  # the event is located: the step ends there
        w.line("_evB", "_evt and not _evA")  # it is not yet: do a shorter step
        w.line("_acc1", "_ok and not _flip0 and not _evB")
        w.line("_flip", "_flip0 or _evA")
        w.line("_part", "_th if _evA else 1.0")
        w.line("_cut", "0.5 if _pre else (_th if (_th < 0.9 and _th > 1e-3) else 0.5)")
