"""One Rosenbrock step, written out for a traced model: stages, dense output, error, event, control, acceptance.

The step is branch-free: every decision is a select, so that it runs in SIMD lanes. It is limited so that it foresees
break-away, ends on the zero of a guard, and flips that guard's flag.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce

from stickslip.basics.status import Status
from stickslip.engine.step_events import EventWriter
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System, TracedContact
from stickslip.engine.tableaux import Tableau
from stickslip.engine.write import LOG_OF_BITS, Writer, combine, horner, literal

_FOLLOWED = 0.05  # of the least creep of a slip that is a difference: its error, where it is hardly more than zero


@dataclass(frozen=True)
class Step:
    """The written step: its lines, and what a lane must hold."""

    lines: tuple[str, ...]
    fields: tuple[str, ...]  # lane fields, each read at the start and written at the end
    case_nodes: tuple[Sym, ...]  # values _c0, _c1, … of a lane
    degree: int  # of the dense output
    series: bool = False  # a Taylor step: the driver does the rest
    by_vector: bool = False  # long enough to be written for one vector of lanes, one after the other


def write_step(eq: System, tableau: Tableau, record: bool) -> Step:
    """The lines of one step; with `record` the dense output's coefficients are kept too."""
    return RosenbrockWriter(eq, tableau, record).write()


class RosenbrockWriter(EventWriter):
    """Writes the lines of a step; what is not of the method itself serves others too."""

    def __init__(self, eq: System, tableau: Tableau, record: bool):
        self.eq, self.tab, self.record = eq, tableau, record
        self.w, self.k = Writer(), tableau.control
        self.n, self.g, self.active = eq.states, len(eq.guards), eq.states - eq.passive
        self.slips = {c.guard: c.state for c in eq.contacts if c.guard is not None and c.state is not None}
        self.degree = len(tableau.dense) + 1
        self.dt = "_hh"
        self.extended, self.falls = set[int](), dict[str, str]()
        news = [new for switch in eq.switches.values() for new in (*switch.modes, *switch.states) if new is not None]
        creeps = [node for c in eq.contacts if c.creep_velocity is not None for node in (c.creep_velocity, c.slip, c.least)]
        roots = [*eq.f, *(j for row in eq.jacobian for j in row), *eq.by_time, *eq.guards, *eq.guard_rates, *news, *creeps]
        self.w.count_uses(roots)

    def write(self) -> Step:
        """All lines in order."""
        n, g = range(self.n), range(self.g)
        scalars = ["t", "h", "tend", "x", "le", "lh", "grow"]
        fields = scalars + [f"y{i}" for i in n] + [f"b{k}" for k in g] + [f"on{k}" for k in g] + [f"m{i}" for i in n if i]
        fields += [f"mode{i}" for i in range(len(self.eq.modes))] + [f"clk{k}" for k in range(len(self.eq.clocks))]
        fields += ["stat", "nacc", "nrej", "ratio"]
        kept = n if self.record or self.eq.signals else (0,)
        fields += ["t0", "hh", *(f"k{i}_{m}" for i in kept for m in range(self.degree + 1)), *ended_by(self.eq)]
        if self.record:
            fields += ["x0", *sides(self.eq), *(f"held{i}" for i in range(len(self.eq.modes)))]
        elif self.eq.signals:
            fields += ["looked"]
        self._slopes()
        self._length()
        self._matrix()
        self._stages()
        self._dense()
        self._error()
        self._crossings()
        self._locate()
        self._decide()
        self._control()
        self._keep()
        return Step(tuple(self.w.lines), tuple(fields), tuple(self.w.case_nodes), self.degree)

    def _bind(self, t: str, y: list[str]) -> dict[str, str]:
        bind = {s.name: name for s, name in zip(self.eq.y, y, strict=True)}
        bind |= {"t": t} | {s.name: f"_{s.name}" for s in self.eq.modes} | {f"clk{k}": f"_clk{k}" for k in range(len(self.eq.clocks))}
        return bind | {f"b{k}": f"_b{k}" for k in range(self.eq.signs)}

    def _slopes(self) -> None:
        """f, its Jacobian and time derivative at the start; the signed slip ratio 1 - (dz/dt)/v for the observers."""
        start = self._bind("_t", [f"_y{i}" for i in range(self.n)])
        self.start = start
        self.f = [self.w.value(e, start) for e in self.eq.f]
        self._derivatives()
        self.guard_start = [self.w.value(e, start) for e in self.eq.guards]
        self.guard_rate = [self.w.value(e, start) for e in self.eq.guard_rates]
        self.scale_v = self.w.value(self.eq.velocity_scale, start)
        if not self.eq.contacts:
            self.w.line("_ratio", "1.0")
            return
        first = self.eq.contacts[0]
        slip = self.w.value(first.slip, start)
        small = f"abs({slip}) < 1e-12 * {self.scale_v}"
        self.w.line("_safe", f"1.0 if {small} else {slip}")
        self.w.line("_ratio", f"0.0 if {small} else 1.0 - {self.f[first.inner[0]]} / _safe" if first.inner else "1.0")

    def _derivatives(self) -> None:
        """The Jacobian and the time derivative of f at the start."""
        self.J = [[self.w.value(e, self.start) for e in row] for row in self.eq.jacobian]
        self.T = [self.w.value(e, self.start) for e in self.eq.by_time]

    def _length(self) -> None:
        """The step's length: the controller's wish, cut where break-away must be foreseen and where the period ends."""
        w = self.w
        w.line("_hh", "_h")
        for contact in self.eq.contacts:
            if contact.stribeck_velocity is not None:
                self._swing(contact)
        w.line("_rem", "_tend - _t")
        w.line("_last", "_rem <= _hh * 1.0000001")
        w.line("_hh", "_rem if _last else _hh")
        w.line("_ih", "1.0 / _hh")

    def _swing(self, contact: TracedContact) -> None:
        """A shorter step near rest: the change of the slip velocity in it is limited."""
        w, k = self.w, self.k
        v_s, slip = w.value(contact.stribeck_velocity, self.start), w.value(contact.slip, self.start)
        w.line("_jerk", f"abs({self._along(contact, self._second)})")
        w.line("_far", f"fma({v_s}, {literal(-k.swing_from)}, abs({slip}))")
        w.line("_swing", f"fma({literal(k.swing)}, {v_s}, {literal(k.swing_rate)} * (_far if _far > 0.0 else 0.0))")
        slope = w.line("_slope", f"abs({self._along(contact, lambda j: self.f[j])})")
        w.line("_hl", f"2.0 * _swing / ({slope} + math.sqrt(fma({slope}, {slope}, 2.0 * _swing * _jerk)) + 1e-300)")
        w.line("_hh", "_hh if _hh < _hl else _hl")

    def _along(self, contact: TracedContact, of: Callable[[int], str]) -> str:
        """Coefficients of the coordinates in a contact's slip."""
        terms = [("-" if g < 0 else "") + of(j) for j, g in enumerate(contact.direction) if g]
        if contact.row:
            zero = self.eq.graph.constant(0.0)
            terms = [f"{self.w.value(zero + contact.taken(j), self.start)} * {of(j)}" for j, g in enumerate(contact.direction) if g]
        return terms[0] if len(terms) == 1 else f"({' + '.join(terms)})"

    def _second(self, j: int) -> str:
        """Second time derivative of a coordinate's velocity."""
        second = self.T[j]
        for i in range(self.n):
            if self.J[j][i] != "0.0":
                second = f"fma({self.J[j][i]}, {self.f[i]}, {second})"
        return second

    def _matrix(self) -> None:
        """W = I/(h gamma) - J: its inverse for two states, else its LU factors without pivoting."""
        w, n = self.w, range(self.n)
        w.line("_d", f"_ih * {literal(1 / self.tab.gamma)}")
        if self.n == 2:
            for i in n:
                for j in n:
                    w.line(f"_a{i}_{j}", f"_d - {self.J[i][j]}" if i == j else f"-{self.J[i][j]}")
            w.line("_det", "1.0 / fma(_a0_0, _a1_1, -(_a0_1 * _a1_0))")
            for name, text in (("_i00", "_a1_1"), ("_i01", "-_a0_1"), ("_i10", "-_a1_0"), ("_i11", "_a0_0")):
                w.line(name, f"{text} * _det")
            return
        self._factors()

    def _factors(self) -> None:
        """LU factors, the last state first: the law's states know v and themselves only, so that nothing fills in."""
        w, order = self.w, range(self.n - 1, -1, -1)
        self.there = {(i, j) for i in order for j in order if i == j or self.J[i][j] != "0.0"}
        for i, j in sorted(self.there):
            w.line(f"_a{i}_{j}", f"_d - {self.J[i][j]}" if i == j else f"-{self.J[i][j]}")
        for c in order:
            w.line(f"_p{c}", f"1.0 / _a{c}_{c}")
            for r in range(c):
                if (r, c) not in self.there:
                    continue
                w.line(f"_m{r}_{c}", f"_a{r}_{c} * _p{c}")
                for j in range(c):
                    if (c, j) in self.there:
                        w.line(f"_a{r}_{j}", f"fma(-_m{r}_{c}, _a{c}_{j}, {f'_a{r}_{j}' if (r, j) in self.there else '0.0'})")
                        self.there.add((r, j))

    def _solve(self, q: int) -> None:
        """u_q = W^-1 r."""
        w, n = self.w, range(self.n)
        if self.n == 2:
            for i in n:
                w.line(f"_u{q}_{i}", f"fma(_i{i}0, _r0, _i{i}1 * _r1)")
            return
        for c in reversed(n):
            for r in range(c):
                if (r, c) in self.there:
                    w.line(f"_r{r}", f"fma(-_m{r}_{c}, _r{c}, _r{r})")
        for i in n:
            for j in range(i):
                if (i, j) in self.there:
                    w.line(f"_r{i}", f"fma(-_a{i}_{j}, _u{q}_{j}, _r{i})")
            w.line(f"_u{q}_{i}", f"_r{i} * _p{i}")

    def _stages(self) -> None:
        w, n, tab = self.w, range(self.n), self.tab
        times = {0.0: "_t"}
        for q in range(tab.stages):
            f = self.f
            if q:
                self._argument(q)
                c = tab.c[q]
                if c not in times:
                    times[c] = w.line(f"_t{q}", f"fma({literal(c)}, _hh, _t)")
                f = [w.value(e, self._bind(times[c], [f"_w{q}x{i}" for i in n])) for e in self.eq.f]
            for i in n:
                memory = combine("", [(cc, f"_u{j}_{i}") for j, cc in enumerate(tab.C[q])])
                early = f"{literal(tab.d[q])} * _hh * {self.T[i]}" if tab.d[q] and self.T[i] != "0.0" else ""
                if memory != "0.0":
                    early = f"fma(_ih, {memory}, {early})" if early else f"_ih * {memory}"
                w.line(f"_r{i}", f"{f[i]} + {early}" if early else f[i])
            self._solve(q)
        last = tab.stages - 1
        for i in n:
            w.line(f"_n{i}", f"_w{last}x{i} + _u{last}_{i}")
            w.line(f"_e{i}", f"abs(_u{last}_{i})")

    def _argument(self, q: int) -> None:
        """Where stage q evaluates f; the last stages only add an increment to the argument before."""
        a = self.tab.a
        adds = q > 1 and a[q][:-1] == a[q - 1] and a[q][-1] == 1.0
        for i in range(self.n):
            if adds:
                self.w.line(f"_w{q}x{i}", f"_w{q - 1}x{i} + _u{q - 1}_{i}")
            else:
                self.w.line(f"_w{q}x{i}", combine(f"_y{i}", [(c, f"_u{j}_{i}") for j, c in enumerate(a[q])]))

    def _dense(self) -> None:
        """The continuous extensions that every step needs; the others are written while a lane is looked at, or for an event."""
        states = range(self.n)
        moving = self.eq.coordinates if self.eq.signals else 1  # velocities, whose extremes count in the whole window
        always = [i for i in states if i < moving or self.record or not self._skips or i in self.slips.values()]
        for i in always:
            self._extend(i)
        if self.eq.signals and len(always) < self.n:
            rest = [i for i in states if i not in always]
            for name in (f"_k{i}_{m}" for i in rest for m in range(self.degree + 1)):
                self.w.line(name, "0.0")
            self.w.begin("if _looked > 0.5")
            for i in rest:
                self._extend(i)
            self.w.end()
            self.extended.difference_update(rest)

    def _extend(self, i: int) -> None:
        """Coefficients of the continuous extension in powers of theta: _k<state>_<power>."""
        w, rows = self.w, self.tab.dense
        k = [w.line(w.fresh(), combine("", [(c, f"_u{j}_{i}") for j, c in enumerate(row)])) for row in rows]
        w.line(f"_k{i}_0", f"1.0 * _y{i}")
        w.line(f"_k{i}_1", f"(_n{i} - _y{i}) + {k[0]}")
        for m in range(1, len(k)):
            w.line(f"_k{i}_{m + 1}", f"{k[m]} - {k[m - 1]}")
        w.line(f"_k{i}_{len(k) + 1}", f"-{k[-1]}")
        self.extended.add(i)

    def _error(self) -> None:
        """_ln: binary logarithm of the error in units of the tolerance (near enough for a controller); _ok: accepted."""
        w, k = self.w, self.k
        for i in range(self.active):
            w.line(f"_big{i}", f"abs(_y{i}) if abs(_y{i}) > abs(_n{i}) else abs(_n{i})")
            if i < self.eq.coordinates and (creeping := self._creeping(i)):
                w.line(f"_s{i}", f"fma({self._size_of_creep(i, creeping)}, rtol, {self._smallest(i, creeping)})")
                continue
            if i < self.eq.coordinates:
                floor = f"{literal(k.velocity_floor)} * {self.scale_v}"
            else:
                floor = f"{literal(k.inner_floor)} * {f'_m{i}' if self.eq.scales[i] is None else w.value(self.eq.scales[i], self.start)}"
            if i in self.eq.positions:  # a position need not be known better than the velocity makes it
                floor = f"fma({literal(k.velocity_floor)} * {self.scale_v}, _hh, {floor})"
            w.line(f"_s{i}", f"fma({floor}, rtol, fma(_big{i}, rtol, 1e-290))")
        parts = self._parts()
        if len(parts) == 1:
            self._largest()
        else:
            self._mean(parts)
        w.line("_ln", "_ln if _ln < 30.0 else 30.0")

    def _size_of_creep(self, i: int, creeping: list[TracedContact]) -> str:
        """The scale of errors in a velocity under creeping friction: the slip, or the velocity up to which it creeps."""
        w = self.w
        most = w.line(w.fresh(), f"{literal(self.k.velocity_floor)} * {self.scale_v}")
        sizes = []
        for contact in creeping:
            creep = w.value(contact.creep_velocity, self.start)
            slip = f"_big{i}" if contact.state == i else self._largest_slip(contact)
            sizes.append(w.line(w.fresh(), f"({creep} if {creep} < {most} else {most}) + {slip}"))
        return reduce(lambda a, b: w.line(w.fresh(), f"{a} if {a} < {b} else {b}"), sizes)

    def _creeping(self, i: int) -> list[TracedContact]:
        """The contacts that brake a coordinate and creep."""
        return [c for c in self.eq.contacts if c.creep_velocity is not None and c.direction[i]]

    def _largest_slip(self, contact: TracedContact) -> str:
        """The slip of a contact where the step begins, or where it ends if that is more."""
        w = self.w
        ends = self._bind(w.line("_rim", "_t + _hh"), [f"_n{i}" for i in range(self.n)])
        before, after = (w.line(w.fresh(), f"abs({w.value(contact.slip, at)})") for at in (self.start, ends))
        return w.line(w.fresh(), f"{before} if {before} > {after} else {after}")

    def _smallest(self, i: int, creeping: list[TracedContact]) -> str:
        """An error that no step can be free of: what it changes by in the shortest step, and what rounding makes of slips."""
        least = f"fma({self._shortest}, abs({self.f[i]}), 1e-290)"
        apart = [self.w.value(c.least, self.start) for c in creeping if c.state != i]
        return f"fma({literal(_FOLLOWED)}, {apart[0]}, {least})" if apart else least

    @property
    def _shortest(self) -> str:
        """The shortest step: time has digits near 0 that it has not later."""
        return f"fma(_t, 4.5e-16, 1e-25 * {self.w.value(self.eq.period, self.start)})"

    def _largest(self) -> None:
        """The error of one body: the largest of its states' errors."""
        w = self.w
        for i in range(self.active):
            w.line(f"_l{i}", f"(as_bits(_e{i}) - as_bits(_s{i})) * {LOG_OF_BITS}")
        w.line("_ok", " and ".join(f"_e{i} <= _s{i}" for i in range(self.active)))
        w.line("_ln", "_l0")
        for i in range(1, self.active):
            w.line("_ln", f"_ln if _ln > _l{i} else _l{i}")

    def _mean(self, parts: list[list[int]]) -> None:
        """The error of several bodies: the root mean square of what each one's error is."""
        w = self.w
        for p, states in enumerate(parts):
            largest = w.line(f"_body{p}", f"_e{states[0]} / _s{states[0]}")
            for i in states[1:]:
                w.line(f"_l{i}", f"_e{i} / _s{i}")
                w.line(largest, f"{largest} if {largest} > _l{i} else _l{i}")
        square = "0.0"
        for p in range(len(parts)):
            square = w.line("_square", f"fma(_body{p}, _body{p}, {square})")
        w.line("_square", f"{square} * {literal(1 / len(parts))}")
        w.line("_ok", "_square <= 1.0")
        w.line("_ln", f"0.5 * fma(as_bits(_square) * 1.0, {LOG_OF_BITS}, -1022.957)")

    def _parts(self) -> list[list[int]]:
        """The states of each coordinate: its velocity, its position, and the inner states of the contacts that brake it first."""
        if not self.eq.coordinates:
            return [list(range(self.active))]
        parts = [[j] for j in range(self.eq.coordinates)]
        for contact in self.eq.contacts:
            parts[next(j for j, g in enumerate(contact.direction) if g)].extend(contact.inner)
        for number, i in enumerate(self.eq.positions):
            parts[number + int(self.eq.cyclic)].append(i)
        return parts

    def _control(self) -> None:
        """The next step's length: integral control with Gustafsson's prediction, all in binary logarithms."""
        w, k = self.w, self.k
        w.line("_lf", f"fma({literal(-k.exponent)}, _ln, {literal(_log2(k.safety))})")
        w.line("_lh1", f"fma(as_bits(_hh) * 1.0, {LOG_OF_BITS}, -1022.957)")
        w.line("_lg", f"_lf + (_lh1 - _lh) + {literal(k.exponent)} * (_le - _ln)")
        w.line("_lf", "_lg if (_lg < _lf and _ok) else _lf")
        w.line("_most", f"_grow if _ok else {literal(_log2(k.growth_rejected))}")
        w.line("_lf", "_lf if _lf < _most else _most")
        w.line("_lf", f"_lf if _lf > {literal(_log2(k.shrink))} else {literal(_log2(k.shrink))}")
        w.line("_hn", "_hh * as_float(np.int64((_lf + 1022.957) * 4503599627370496.0))")
        w.line("_hn", "(_h if _h > _hn else _hn) if (_hh < _h and _ok) else _hn")  # a clipped step must not shrink the wish
        most = k.watchful if any(c.balances for c in self.eq.contacts[:1]) else k.longest
        longest = w.line(w.fresh(), f"{literal(most)} * {w.value(self.eq.period, self.start)}")
        w.line("_hn", f"_hn if _hn < {longest} else {longest}")
        w.line("_h", "_hn if _acc1 else (_cut * _hh if _evB else (_hn if not _ok else _h))")
        w.line("_le", "(_ln if _ln > -8.0 else -8.0) if _acc1 else _le")
        w.line("_lh", "_lh1 if _acc1 else _lh")
        growth, event = literal(_log2(k.growth)), literal(_log2(k.growth_event))
        w.line("_grow", f"{growth} if (_acc1 and not _flip) else ({event} if _acc1 else 0.0)")

    def _keep(self) -> None:
        """New state of the lane."""
        w = self.w
        integral = horner([f"{literal(1 / (m + 1))} * _k0_{m}" for m in range(self.degree + 1)], "_part")
        offset = w.value(self.eq.offset, self.start) if self.eq.coordinates else "0.0"
        integral = integral if offset == "0.0" else f"(({integral}) + {offset})"
        w.line("_t0", "1.0 * _t")
        if self.record:
            kept = [(f"held{i}", f"_{s.name}") for i, s in enumerate(self.eq.modes)]
            own = [self._side(c) for c in self.eq.contacts] or [f"_{s.name}" for s in self.eq.modes[: self.eq.labels]]
            held = list(zip(sides(self.eq), own, strict=True))
            for name, value in (("x0", "_x"), *held, *kept):
                w.line(f"_{name}", f"1.0 * {value}")
        for i in range(self.n):
            if 0 < i < self.active and self.eq.scales[i] is None:
                w.line(f"_m{i}", f"_big{i} if (_acc1 and _big{i} > _m{i}) else _m{i}")
            w.line(f"_y{i}", f"(_v{i} if _evA else _n{i}) if _acc1 else _y{i}")
        for k, i in self.slips.items():
            fired = "_which < 0.5" if k == 0 else f"_which == {k}.0"
            w.line(f"_y{i}", f"0.0 if (_evA and {fired}) else _y{i}")
        way = f"fma(_hh * _part, {integral}, _x) if _acc1 else _x" if self.eq.cyclic else f"1.0 * _y{self.eq.positions.start}"
        w.line("_x", way if self.eq.cyclic or self.eq.coordinates else "1.0 * _x")
        w.line("_fin", "_acc1 and _last and not _evA")
        w.line("_t", "_tend if _fin else (fma(_part, _hh, _t) if _acc1 else _t)")
        w.line("_code", "0.0")
        self._switch()
        for k in range(self.g):
            mine = f"_which == {k}.0" if self.g > 1 else "True"
            w.line(f"_b{k}", f"-_b{k} if (_flip and {mine}) else _b{k}" if k < self.eq.signs else "1.0")
            w.line(f"_on{k}", f"(1.0 if _evA else _on{k} + 1.0) if (_flip and {mine}) else (0.0 if _acc1 else _on{k})")
        w.line("_nacc", "_nacc + (1.0 if _acc1 else 0.0)")
        w.line("_nrej", "_nrej + (0.0 if _acc1 else 1.0)")
        for name in ended_by(self.eq):
            w.line(f"_{name}", "1.0 * _which if _evA else -1.0")
        w.line("_bad", f"(not _acc1) and _hh < {self._shortest}")
        nan = " or ".join(f"_n{i} != _n{i}" for i in range(self.active))
        w.line("_end", f"{Status.TOO_SMALL}.0")
        for k, switch in self.eq.switches.items():
            if switch.status:  # steps shrink without end where a contact stiffens as it is lost
                w.line("_end", f"{switch.status}.0 if _g{k}s < 1e-9 * _size{k} else _end")
                w.line("_code", f"{switch.status}.0 if (_flip0 and _g{k}s < 1e-7 * _size{k}) else _code")  # nothing else matters there
        w.line("_stat", f"1.0 if _fin else (({Status.NOT_A_NUMBER}.0 if ({nan}) else _end) if _bad else _stat)")
        w.line("_stat", "_code if _code > 0.5 else _stat")
        w.line("_stat", f"{Status.BUDGET}.0 if (_nacc + _nrej > budget and _stat < 0.5) else _stat")

    def _side(self, contact: TracedContact) -> str:
        """What holds the side of a contact: a flag, or its mode if it may rest."""
        return f"_b{contact.guard}" if contact.branches is None else f"_{self.eq.modes[contact.modes[0]].name}"

    def _switch(self) -> None:
        """The effect of a guard's zero on modes and states, besides the flip of its flag."""
        w, news = self.w, []
        if self.eq.switches:
            w.line("_te", "1.0 * _t")
            event = self._bind("_te", [w.line(f"_z{i}", f"1.0 * _y{i}") for i in range(self.n)])
        for k, switch in self.eq.switches.items():
            fired = w.line(w.fresh(), f"_flip and _which == {k}.0")
            changes = [(f"_{s.name}", new) for s, new in zip(self.eq.modes, switch.modes, strict=True)]
            changes += [(f"_y{i}", new) for i, new in enumerate(switch.states) if new is not None]
            news += [(fired, name, w.line(w.fresh(), f"1.0 * {w.value(new, event)}")) for name, new in changes]
            if switch.status:
                w.line("_code", f"{switch.status}.0 if {fired} else _code")
        for fired, name, value in news:
            w.line(name, f"{value} if {fired} else {name}")


def ended_by(eq: System) -> list[str]:
    """Field of the guard that ended the last step (-1: none), where something is noted there."""
    return ["fired"] if any(signal.guard is not None for signal in eq.signals) else []


def sides(eq: System) -> list[str]:
    """Fields of the sides, or modes, of the contacts as a step holds them."""
    return [f"side{i or ''}" for i in range(eq.sides)]


def _log2(x: float) -> float:
    import math

    return math.log2(x)
