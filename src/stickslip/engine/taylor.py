"""One step of a set-valued law's motion: its Taylor polynomial; where it ends stands in ``kernels/arcs.py``.

Between two events the motion is analytic, so a polynomial of high order is exact to rounding over a good part of a period;
the guards (contact velocity while it slides, distance to break-away while it is stuck, the law's own conditions) are polynomials too.
The series (`rows.py`) are written for all lanes at once; the driver then searches each lane's guards for their first zero on the whole
step, dips between the looks included. What the coefficients cannot foresee is in ``unforeseen.py``.
"""

from __future__ import annotations

from stickslip.basics.status import Status
from stickslip.engine.coupled import SLIP
from stickslip.engine.kernel_text import function
from stickslip.engine.rosenbrock_step import Step, ended_by, sides
from stickslip.engine.roundings import hold_sizes
from stickslip.engine.rows import write_rows
from stickslip.engine.steptext import bound, held
from stickslip.engine.symbols import CASE, Sym
from stickslip.engine.system import System, TracedContact, TracedSwitch
from stickslip.engine.unforeseen import FLOOR, MISFIT, NEAR_POLE, POINTS, ROUNDING_OF_SLOPES, Way, active, hides
from stickslip.engine.values import needed_by
from stickslip.engine.write import LOG_OF_BITS, Writer, horner, literal

ORDER = 16
LONGEST = 0.25  # of a period
ROUNDING = 1e-16  # of a state's scale: what a step may leave out
MOST_CHECKED = 3  # states: of more, each lane is checked for itself
TOGETHER = 4  # points of a step at which it is checked side by side
BESIDE = 2e-10  # of its size: how much further than such a guard its border is

#: The name of a polynomial of a step, the row that it is made of (none if it does not vary), a factor of that, and how it begins.
Polynomial = tuple[str, str, str, str]


def write_step(eq: System) -> Step:
    """The lines of the series: _k of states, _g of guards, _e of exponents, in units of the step; its length _hh; if it is the _last."""
    return SeriesWriter(eq).write()


def watched(eq: System) -> list[int]:
    """The guards whose zeros matter: they have a switch, or a flag that something reads."""
    news = [new for switch in eq.switches.values() for new in (*switch.modes, *switch.states) if new is not None]
    read = {node.name for node in needed_by([*eq.active, *eq.guards, *news]) if node.op == "flag"}
    return [k for k in range(len(eq.guards)) if k in eq.switches or f"b{k}" in read]


def switches(eq: System, step: Step, lanes: int) -> str:
    """Text of what the zero of each watched guard does to the modes and states of a lane, or that its flag flips.

    It returns the status of a run that ends there.
    """
    parts, calls = [], []
    for number, k in enumerate(watched(eq)):
        switch = eq.switches.get(k)
        lines = [] if switch is None else _switch(eq, step, lanes, switch)
        lines += [_put(step, lanes, f"b{k}", f"-_b{k}")] if k < eq.signs else []
        status = 0 if switch is None else switch.status
        parts.append(function(f"switch_{number}", "lane, S", [*held(step, lanes, lines), *lines], "void(int64, f1)"))
        calls += [f"if which == {number}:", f"    switch_{number}(lane, S)", f"    return {status}"]
    return "\n".join([*parts, function("switched", "which, lane, S", [*calls, "return 0"])])


def _switch(eq: System, step: Step, lanes: int, switch: TracedSwitch) -> list[str]:
    """The lines of one switch; what stays as it is is not among them."""
    w = Writer()
    w.case_nodes = list(step.case_nodes)
    news = [(mode.name, new) for mode, new in zip(eq.modes, switch.modes, strict=True) if new is not mode]
    news += [(f"y{i}", new) for i, new in enumerate(switch.states) if new is not None]
    puts = [_put(step, lanes, name, w.value(new, bound(eq))) for name, new in news]
    if len(w.case_nodes) > len(step.case_nodes):
        raise AssertionError("a switch needs a number that the step does not hold")
    return [*w.lines, *puts]


def _put(step: Step, lanes: int, field: str, value: str) -> str:
    return f"S[{step.fields.index(field) * lanes} + lane] = {value}"


def _outcomes(node: Sym) -> list[Sym]:
    """The possible values of an expression, by its conditions; without signs."""
    if node.op == "select":
        return [*_outcomes(node.args[1]), *_outcomes(node.args[2])]
    if node.op == "multiply" and node.args[0].op == "constant":
        return _outcomes(node.args[1])
    return [node]


def slips_of(eq: System, guard: Sym) -> list[TracedContact]:
    """The contacts whose slip a guard is on some side; none if it is no slip."""
    reached = {node.number for node in _outcomes(guard)}
    return [contact for contact in eq.contacts if contact.slip.number in reached]


class SeriesWriter:
    """The lines of a step, and what a lane holds of it."""

    order = ORDER

    def __init__(self, eq: System):
        self.eq, self.w = eq, Writer()
        self._held: set[int] = set()  # numbers of the expressions that `_hold` has been given
        self.watched = [(k, eq.guards[k]) for k in watched(eq)]
        self.rising = active(eq, "exp") | active(eq, "tanh")
        self.quotients = active(eq, "reciprocal")
        self.start = bound(eq)
        self.w.count_uses([*eq.active, *eq.guards])

    def write(self) -> Step:
        """All lines in order."""
        self.period = self._value(self.eq.period)
        self._series()
        self.w.line("_ratio", "1.0")
        self._length()
        self._polynomials()
        self._whole()
        if self._checks:
            self._check()
        for switch in self.eq.switches.values():  # what they need is held by the lane too
            for new in (*switch.modes, *switch.states):
                self._hold(new)
        for node in (*self.eq.offsets[:1], self.eq.period):
            self._hold(node)
        hold_sizes(self.eq, self.w.case_nodes)
        return Step(tuple(self.w.lines), tuple(self._fields()), tuple(self.w.case_nodes), self.order, series=True)

    def _series(self) -> None:
        """The coefficients, by time, and the names of their rows by the numbers of the expressions."""
        wanted = [*(guard for _, guard in self.watched), *(node.args[0] for node in self.rising), *self.quotients]
        self.rows = write_rows(self.eq.y, self.eq.f, wanted, self.w, self.start, self.order)

    def _fields(self) -> list[str]:
        eq, states, orders = self.eq, range(self.eq.states), range(self.order + 1)
        fields = ["t", "tend", "x", *(f"y{i}" for i in states), *(f"b{k}" for k in range(eq.signs)), *(s.name for s in eq.modes)]
        fields += [*(f"clk{k}" for k in range(len(eq.clocks))), *(f"m{i}" for i in states if i), "stat", "nacc", "nrej", "ratio"]
        fields += ["t0", "hh", "x0", *sides(eq), "last", "top", *ended_by(eq), *(f"k{i}_{m}" for i in states for m in orders)]
        fields += [*(f"ends{i}" for i in states), "mean", "rates0", "rates1", *(["fits"] if self._checks else [])]
        searched = [*(f"g{k}" for k in range(len(self.watched))), *(f"e{k}" for k in range(len(self.rising)))]
        return fields + [f"{row}_{m}" for row in searched for m in orders] + [f"clear{k}" for k in range(len(searched))]

    @property
    def _checks(self) -> bool:
        """Whether the polynomials of a whole step are held against the equations for all lanes at once."""
        return hides(self.eq) and self.eq.states <= MOST_CHECKED and not self.eq.passive

    def _value(self, node: Sym) -> str:
        return self.w.value(node, self.start)

    def _hold(self, node: Sym | None) -> None:
        """Have the case's part of an expression computed once for each case."""
        if node is None or node.op == "constant" or node.number in self._held:
            return
        self._held.add(node.number)
        if node.level == CASE:
            self.w.value(node, {})
        else:
            for a in node.args:
                self._hold(a)

    def _length(self) -> None:
        """The longest step whose last terms are below rounding; it ends at the next known instant at the latest."""
        w = self.w
        w.line("_longest", f"{literal(LONGEST)} * {self.period}")
        w.line("_hh", "1.0 * _longest")
        self._limits()
        w.line("_rem", "_tend - _t")
        w.line("_last", "1.0 if _rem <= _hh * 1.0000001 else 0.0")
        w.line("_hh", "_rem if _last > 0.5 else _hh")

    def _limits(self) -> None:
        """Shorten it by all that has a series."""
        if self.eq.sizes:  # nothing says how long a step is but the states: what a guard may leave out is measured within theirs
            self._limit_by(self._of_states())
            self._limit_by([*self._of_guards("_hh", self.watched), *self._of_quotients()])
        else:
            self._limit_by([*self._of_states(), *self._of_guards("_longest", self.watched), *self._of_quotients()])
        self._limit_by_borders(self.watched)

    def _limit_by_borders(self, pairs: list[tuple[int, Sym]]) -> None:
        """Keep it to half of the way to where loads that follow from the motion are infinite: nothing there has a series."""
        w = self.w
        for k, guard in pairs:
            if k in self.eq.switches and self.eq.switches[k].status == Status.PAINLEVE and guard.number in self.rows:
                value, row = self._value(guard), self.rows[guard.number]
                size = horner([f"abs({c})" for c in (value, f"{row}[1]", f"{row}[2]")], "_longest")
                left, falls = w.line(w.fresh(), f"0.5 * (abs({value}) + {literal(BESIDE)} * ({size}))"), w.line(w.fresh(), f"abs({row}[1])")
                w.line("_hh", f"_hh if _hh * {falls} < {left} else {left} / {falls}")

    def _limit_by(self, tolerated: list[tuple[Sym, str]]) -> None:
        """Shorten the step until the last terms of some series are below their sizes."""
        w = self.w
        rows = [(self.rows[node.number], w.line(w.fresh(), text)) for node, text in tolerated]
        if not rows:
            return
        w.begin(f"for m in range({self.order - 1}, {self.order + 1})")
        for row, least in rows:
            self._limit(row, least)
        w.end()

    def _of_states(self) -> list[tuple[Sym, str]]:
        """The states that limit a step, each with the size that its last terms may have."""
        eq = self.eq
        passive = (None,) * eq.passive
        scales = (*eq.sizes, *passive) if eq.sizes else (*(eq.velocity_scale for _ in eq.offsets), *eq.scales[eq.coordinates :])
        return [(y, f"{literal(ROUNDING)} * {self._value(s)}") for y, s in zip(eq.y, scales, strict=True) if s is not None]

    def _of_guards(self, reach: str, pairs: list[tuple[int, Sym]]) -> list[tuple[Sym, str]]:
        """The same of guards, which are as large as they become within some time."""
        sizes = []
        for _, guard in pairs:
            if guard.number in self.rows:
                low = [self._value(guard), *(f"{self.rows[guard.number]}[{m}]" for m in (1, 2, 3))]
                size = horner([f"abs({c})" for c in low], reach)
                sizes.append((guard, f"{literal(ROUNDING)} * ({size} + {self._size_of_slip(guard) or '1e-290'})"))
        return sizes

    @property
    def _near_pole(self) -> float:
        """What the last terms of a quotient are at most, in parts of it."""
        return NEAR_POLE

    def _of_quotients(self) -> list[tuple[Sym, str]]:
        """The same of quotients."""
        sizes = []
        for quotient, ways in self.quotients.items():
            near = literal(self._near_pole)
            sizes.append((quotient, f"{near} * abs({self._value(quotient)}) if {self._counts(ways)} else 1e300"))
        return sizes

    def _counts(self, ways: list[Way]) -> str:
        """Whether what is held leads to a part of the equations."""
        texts = {" and ".join(f"{self._value(a)} {'>' if up else '<='} 0.0" for a, up in way) for way in ways}
        return "True" if "" in texts else f"({' or '.join(f'({text})' for text in sorted(texts))})"

    def _limit(self, row: str, least: str) -> None:
        """Shorten the step to where one of the last two terms of a series falls to what is tolerated."""
        w = self.w
        power = w.line(w.fresh(), f"1 / m * ((as_bits({least}) - as_bits(abs({row}[m]))) * {LOG_OF_BITS})")
        w.line(power, f"{power} if {power} < 900.0 else 900.0")
        h = w.line(w.fresh(), f"as_float(np.int64(({power} + 1022.957) * 4503599627370496.0))")
        w.line("_hh", f"_hh if _hh < {h} else {h}")

    def _polynomials(self) -> None:
        """The series in theta = (time since the start) / h: of the states, the guards, and of how far exponents are below the floor."""
        w = self.w
        states, searched = self._begun()
        w.line("_power", "1.0")
        w.begin(f"for m in range(1, {self.order + 1})")
        w.line("_power", "_power * _hh")
        for name, row, _, _ in states:
            w.line(f"{name}[m]", f"_power * {row}[m]")
        for k, (name, row, factor, _) in enumerate(searched):
            if row:
                term = w.line(w.fresh(), f"_power * ({factor} * {row}[m])" if factor else f"_power * {row}[m]")
                w.line(f"{name}[m]", term)
                w.line(f"_clear{k}", f"_clear{k} + ({term} if {term} < 0.0 else 0.0)")
        w.end()

    def _begun(self) -> tuple[list[Polynomial], list[Polynomial]]:
        """Of states, and of all that is searched: the name, the row that it is made of, a factor, and how it begins, which is written."""
        w = self.w
        states = [(f"_k{i}", self.rows[y.number], "", self._value(y)) for i, y in enumerate(self.eq.y)]
        searched = [self._guard(p, k, guard) for p, (k, guard) in enumerate(self.watched)]
        searched += [self._exponent(k, node, ways) for k, (node, ways) in enumerate(self.rising.items())]
        for name, _, _, begin in (*states, *searched):
            w.line(f"{name}[0]", begin)
        for k, (_, _, _, begin) in enumerate(searched):
            size = self._size_of_slip(self.watched[k][1]) if k < len(self.watched) else ""
            w.line(f"_clear{k}", f"fma({literal(SLIP)}, {size}, {begin})" if size else f"1.0 * {begin}")
        return states, searched

    def _whole(self) -> None:
        """What a lane asks of a step that no event ends: the states there, the mean of the first, and its slope there and half the way."""
        w, n = self.w, self.order
        states = range(self.eq.states)
        for i in states:
            w.line(f"_ends{i}", f"1.0 * _k{i}[{n}]")
        w.line("_mean", f"{literal(1.0 / (n + 1))} * _k0[{n}]")
        for name in ("_rates0", "_rates1"):
            w.line(name, f"{n}.0 * _k0[{n}]")
        w.begin(f"for q in range(1, {n})")
        for i in states:
            w.line(f"_ends{i}", f"_ends{i} + _k{i}[{n} - q]")
        w.line("_mean", f"fma(1.0 / ({n + 1}.0 - q), _k0[{n} - q], _mean)")
        w.line("_term", f"({n}.0 - q) * _k0[{n} - q]")
        w.line("_rates0", "_rates0 + _term")
        w.line("_rates1", "fma(_rates1, 0.5, _term)")
        w.end()
        for i in states:
            w.line(f"_ends{i}", f"_ends{i} + _k{i}[0]")
        w.line("_mean", "_mean + _k0[0]")

    def _check(self) -> None:
        """_fits: whether the slopes of the polynomials are what the equations say, at `POINTS` points of the whole step."""
        w, n, eq = self.w, self.order, self.eq
        states = range(eq.states)
        for i in states:
            w.line(f"_terms{i}", "0.0")
        w.begin(f"for m in range(1, {n + 1})")
        for i in states:
            w.line(f"_terms{i}", f"fma(1.0 * m, abs(_k{i}[m]), _terms{i})")
        w.end()
        sizes = [eq.free_velocity if i == 0 else eq.scales[i] for i in states]
        asked = [(i, size) for i, size in enumerate(sizes) if size is not None]
        for i, size in asked:
            w.line(f"_slack{i}", f"fma({literal(ROUNDING_OF_SLOPES)}, _terms{i}, {literal(MISFIT)} * {self._value(size)})")
        w.line("_good", "_hh > 0.0")
        w.begin(f"for j in range(0, {POINTS // TOGETHER})")
        points = range(TOGETHER)
        for p in points:
            w.line(f"_px{p}", f"fma({literal(TOGETHER / POINTS)}, j, {literal((p + 1) / POINTS)})")
            for i in states:
                w.line(f"_pv{i}_{p}", f"1.0 * _k{i}[{n}]")
                w.line(f"_ps{i}_{p}", "0.0")
        w.begin(f"for q in range(1, {n + 1})")
        for p in points:
            for i in states:
                w.line(f"_ps{i}_{p}", f"fma(_ps{i}_{p}, _px{p}, _pv{i}_{p})")
                w.line(f"_pv{i}_{p}", f"fma(_pv{i}_{p}, _px{p}, _k{i}[{n} - q])")
        w.end()
        for p in points:
            there = self.start | {y.name: f"_pv{i}_{p}" for i, y in enumerate(eq.y)} | {"t": w.line(f"_pt{p}", f"fma(_px{p}, _hh, _t)")}
            for i, _ in asked:
                w.line("_good", f"_good and abs(fma(-_hh, {w.value(eq.f[i], there)}, _ps{i}_{p})) <= _slack{i}")
        w.end()
        w.line("_fits", "1.0 if _good else 0.0")

    def _guard(self, number: int, k: int, guard: Sym) -> Polynomial:
        """A polynomial's name, the row that it is made of (none if it does not vary), what its flag multiplies it by, and its beginning."""
        flag, value = f"_b{k}" if k < self.eq.signs else "", self._value(guard)
        if size := self._size_of_slip(guard):  # what rounding leaves of a slip that is zero, is zero: it may grow more slowly than that
            value = self.w.line(self.w.fresh(), f"0.0 if abs({value}) <= {literal(SLIP)} * {size} else {value}")
        return f"_g{number}", self.rows.get(guard.number, ""), flag, f"{flag} * {value}" if flag else value

    def _size_of_slip(self, guard: Sym) -> str:
        """Of a guard that is a slip made of velocities, or of one and of what is prescribed: how large they are; else nothing."""
        for contact in slips_of(self.eq, guard):
            moves = [y for y, g in zip(self.eq.y, contact.direction, strict=False) if g]
            if contact.row:
                moves = [y * contact.taken(j) for j, y in enumerate(self.eq.y[: len(contact.row)]) if contact.direction[j]]
            if all(contact.slip is not y for y in moves):
                return f"({' + '.join(f'abs({self._value(node)})' for node in (self.eq.velocity_scale, *moves))})"
        return ""

    def _exponent(self, k: int, node: Sym, ways: list[Way]) -> Polynomial:
        """The same of an exponent's distance from the floor, where it counts."""
        w, (a,) = self.w, node.args
        value = self._value(a)
        times = "(-1.0)" if node.op == "exp" else w.line(w.fresh(), f"2.0 if {value} > 0.0 else (-2.0)")  # tanh a knows exp(-2|a|)
        begin = w.line(w.fresh(), f"{times} * {value} + {literal(FLOOR)} if {self._counts(ways)} else 0.0")
        return f"_e{k}", self.rows[a.number], times, begin
