"""A step where a matrix of inertia varies: series of a higher order, whose lines do as little as they can for one lane alone.

There an order costs several times what it does elsewhere, so that longer steps pay. What few steps ask for is written apart, and lanes
jump over it together: guards that matter while a contact rests, and borders of loads that no angle may reach. Sums over the coefficients
are those of `BLOCKS` parts, side by side: one lane alone has vectors too. Elsewhere it is the step of `taylor.py`.
"""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.basics.status import Status
from stickslip.engine.linear_systems import least_of
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.rows import RowWriter
from stickslip.engine.symbols import STATE, Sym
from stickslip.engine.system import System
from stickslip.engine.taylor import ROUNDING, Polynomial, SeriesWriter
from stickslip.engine.unforeseen import LAST
from stickslip.engine.write import LOG_OF_BITS, horner, literal

HIGHER = 24
BLOCKS = 4  # coefficients side by side
AT_BORDER = "fma(1e-11, {}, 1e-12)"  # of a period, in s: from where on a border of loads is reached; nearer, coefficients are no numbers
WIDER = 5.0  # times as large as the next term of a series is one at the end of a step, at most


def write_step(eq: System) -> Step:
    """The lines of the series: `stickslip.engine.taylor.write_step`."""
    return LongSeriesWriter(eq).write()


@dataclass(frozen=True)
class _Apart:
    """Guards that are asked for only where something holds, by their places among those that are watched."""

    holds: str
    places: tuple[int, ...]


class LongSeriesWriter(SeriesWriter):
    """The lines of such a step."""

    order = HIGHER

    @property
    def _near_pole(self) -> float:
        return float(2.0**-self.order)

    def _series(self) -> None:
        resting, far = dict[str, list[int]](), dict[int, str]()
        for p, (_, guard) in enumerate(self.watched):
            if self._is_border(p):
                if (least := least_of(guard)) is not None:
                    far[p] = f"{self._value(least)} <= 0.0"
            elif (asked := _asked_last(guard)) is not None:
                resting.setdefault(f"{self._value(asked)} > 0.0", []).append(p)
        self._apart = [_Apart(holds, tuple(places)) for holds, places in resting.items()]
        self._apart += [_Apart(f"({' or '.join(far.values())})", tuple(far))] if far else []
        within = {p for each in self._apart for p in each.places}
        self._always = [p for p in range(len(self.watched)) if p not in within]
        borders = [self.watched[p][1] for p in self._always if self._is_border(p)]
        self._main = RowWriter(
            self.eq.y, self.eq.f, [*borders, *(node.args[0] for node in self.rising), *self.quotients], self.w, self.start, self.order,
            multiples=[self.watched[p][1] for p in self._always if not self._is_border(p)],
            later=[self.watched[p][1] for places in resting.values() for p in places],
        )  # fmt: skip
        self._main.write()
        self.rows = self._main.rows

    def _is_border(self, p: int) -> bool:
        """Whether a guard is a border beyond which no load follows, or two, that varies."""
        k, guard = self.watched[p]
        return k in self.eq.switches and self.eq.switches[k].status == Status.PAINLEVE and bool(self.eq.graph.varies(guard))

    # ---- how long a step is ----
    def _limits(self) -> None:
        w, always = self.w, [self.watched[p] for p in self._always]
        self._limit_by(self._of_states(), LAST)
        if self.eq.sizes:  # nothing says how long a step is but the states: what a guard may leave out is measured within theirs
            w.line("_longest", "1.0 * _hh")
        self._limit_by([*self._of_guards("_longest", always), *self._of_quotients()])
        self._limit_by_borders(always)
        for each in self._apart:
            pairs = [self.watched[p] for p in each.places]
            for _, guard in pairs:  # asked inside and outside
                self._value(guard)
            w.begin(f"if {each.holds}")
            w.line("_free", "1.0 * _hh")
            written = RowWriter(self.eq.y, [], [guard for _, guard in pairs], w, self.start, self.order, self.rows, called="_l")
            written.write()
            self.rows = written.rows
            self._limit_by(self._of_guards("_longest", pairs))
            self._limit_by_borders(pairs)
            w.line("_hh", f"_hh if {each.holds} else _free")  # lanes that only come along keep their steps
            w.end()

    def _limit_by(self, tolerated: list[tuple[Sym, str]], last: int = 2) -> None:
        """Shorten it until the next term of each series would be below its size, if terms fall to a fifth from one to the next.

        Of states more of them are asked: what a gap hides shows there.
        """
        w, rows = self.w, list[tuple[str, str]]()
        for node, text in tolerated:
            row, factor = self._row(node)
            rows.append((row, w.line(w.fresh(), f"{f'abs({factor})' if factor else '1.0'} / ({text})")))
        if not rows:
            return
        w.line("_wider", f"{literal(WIDER**last)}")
        w.begin(f"for m in range({self.order + 1 - last}, {self.order + 1})")
        for k, (row, weight) in enumerate(rows):
            w.line("_other", f"{weight} * abs({row}[m])")
            w.line("_term", "_term if _term > _other else _other" if k else "1.0 * _other")
        power = w.line(w.fresh(), f"1 / m * ((as_bits(_wider) - as_bits(_term)) * {LOG_OF_BITS})")
        w.line(power, f"{power} if {power} < 900.0 else 900.0")
        h = w.line(w.fresh(), f"as_float(np.int64(fma({power}, 4503599627370496.0, 4606988764016040448.0)))")
        w.line("_hh", f"_hh if _hh < {h} else {h}")
        w.line("_wider", f"{literal(1.0 / WIDER)} * _wider")
        w.end()

    def _row(self, node: Sym) -> tuple[str, str]:
        """The row of an expression, or one of which it is a multiple, and the factor, if it is not one; none where it does not vary."""
        if node.number in self.rows:
            return self.rows[node.number], ""
        row, factor = self._main.multiple(node)
        return row, "" if factor.value == 1.0 and factor.op == "constant" else self._value(factor)

    def _of_guards(self, reach: str, pairs: list[tuple[int, Sym]]) -> list[tuple[Sym, str]]:
        sizes = []
        for _, guard in pairs:
            row, factor = self._row(guard)
            if row:
                size = horner([f"abs({row}[{m}])" for m in (1, 2, 3)], reach)
                size = f"fma({f'abs({factor}) * ({size})' if factor else size}, {reach}, abs({self._value(guard)}))"
                sizes.append((guard, f"{literal(ROUNDING)} * ({size} + {self._size_of_slip(guard) or '1e-290'})"))
        return sizes

    # ---- in parts of a step ----
    def _guard(self, number: int, k: int, guard: Sym) -> Polynomial:
        name, _, flag, begin = super()._guard(number, k, guard)
        row, factor = self._row(guard)
        if self._is_border(number):
            near = f"{self._value(guard)} < {AT_BORDER.format(self.period)} * -{row}[1]"
            holds = next((f"{each.holds} and " for each in self._apart if number in each.places), "")
            begin = self.w.line(self.w.fresh(), f"-1.0 if {holds}{near} else {begin}")
        return name, row, " * ".join(each for each in (flag, factor) if each), begin

    def _polynomials(self) -> None:
        w = self.w
        states, searched = self._begun()
        w.line("_powers", f"row({self.order + 1})")
        w.line("_powers[1]", "1.0 * _hh")
        for m in range(2, BLOCKS + 1):
            w.line(f"_powers[{m}]", f"_powers[{m // 2}] * _powers[{m - m // 2}]")
        w.begin(f"for m in range({BLOCKS + 1}, {self.order + 1})")
        w.line("_powers[m]", f"_powers[{BLOCKS}] * _powers[m - {BLOCKS}]")
        w.end()
        self._in_powers(states, {p: searched[p] for p in (*self._always, *range(len(self.watched), len(searched)))})
        for each in self._apart:
            w.begin(f"if {each.holds}")
            self._in_powers([], {p: searched[p] for p in each.places})
            w.end()

    def _in_powers(self, states: list[Polynomial], searched: dict[int, Polynomial]) -> None:
        """The coefficients of some states and of what is searched, the ends of the first, and what the others have left at least."""
        w, moving = self.w, {p: each for p, each in searched.items() if each[1]}
        ends = [w.line(f"_sum{i}", f"row({BLOCKS + 1})") for i in range(len(states))]
        falls = {p: w.line(f"_fall{p}", f"row({BLOCKS + 1})") for p in moving}
        w.begin(f"for m in range(1, {BLOCKS + 1})")
        for end, state in zip(ends, states, strict=True):
            w.line(f"{end}[m]", " + ".join(reversed(self._terms(*state[:3]))))
        for p, each in moving.items():
            terms = reversed(self._terms(*each[:3]))
            w.line(f"{falls[p]}[m]", " + ".join(f"({term} if {term} < 0.0 else 0.0)" for term in terms))
        w.end()
        each_part = range(BLOCKS, 0, -1)
        for i, end in enumerate(ends):
            w.line(f"_ends{i}", " + ".join([*(f"{end}[{m}]" for m in each_part), f"{states[i][0]}[0]"]))
        for p, fall in falls.items():
            w.line(f"_clear{p}", f"_clear{p} + ({' + '.join(f'{fall}[{m}]' for m in each_part)})")

    def _terms(self, name: str, row: str, factor: str) -> list[str]:
        """The coefficients that are so many further than one another, as they are written."""
        w, terms, of = self.w, list[str](), f"({factor} * {row}" if factor else row
        for b in range(0, self.order, BLOCKS):
            terms.append(w.line(w.fresh(), f"_powers[m + {b}] * {of}[m + {b}]{')' if factor else ''}"))
            w.line(f"{name}[m + {b}]", f"1.0 * {terms[-1]}")
        return terms

    def _whole(self) -> None:
        """The mean of the first state, where positions count as differences, and its slopes, where no signals are noted instead."""
        w, n = self.w, self.order
        w.line("_rates0", f"{n}.0 * _k0[{n}]" if not self.eq.signals else "0.0")
        w.line("_rates1", "1.0 * _rates0")
        w.line("_mean", f"{literal(1.0 / (n + 1))} * _k0[{n}]")
        if self.eq.cyclic or not self.eq.signals:
            w.begin(f"for q in range(1, {n})")
            if self.eq.cyclic:
                w.line("_mean", f"fma(1.0 / ({n + 1}.0 - q), _k0[{n} - q], _mean)")
            if not self.eq.signals:
                w.line("_term", f"({n}.0 - q) * _k0[{n} - q]")
                w.line("_rates0", "_rates0 + _term")
                w.line("_rates1", "fma(_rates1, 0.5, _term)")
            w.end()
            w.line("_mean", "_mean + _k0[0]")


def _asked_last(guard: Sym) -> Sym | None:
    """Whether a guard is asked, of one that is a number unless none of some modes holds; None of another."""
    graph, asked = guard.graph, guard.graph.constant(1.0)
    held, node = list[Sym](), guard
    while node.op == "select" and node.args[1].level < STATE and not graph.varies(node.args[0]):
        held.append(node.args[0])
        node = node.args[2]
    if not held or node.op == "select" or not graph.varies(node):
        return None
    for each in reversed(held):
        asked = graph.select(each, graph.constant(0.0), asked)
    return asked
