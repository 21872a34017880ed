"""One step of a set-valued law's motion: its Taylor polynomial, written out; where it ends stands in ``kernels/arcs.py``.

Between two events the motion is analytic, so a polynomial of high order is exact to rounding over a good part of a period;
the guards (contact velocity while it slides, distance to break-away while it is stuck, the law's own conditions) are polynomials too.
The series are written for all lanes at once; the driver then searches each lane's guards for their first zero on the whole
step, dips between the looks included. What the coefficients cannot foresee is in ``unforeseen.py``.
"""

from __future__ import annotations

import re

from stickslip.engine.jets import ZERO, Jets
from stickslip.engine.rosenbrock import Step
from stickslip.engine.symbols import CASE, Sym
from stickslip.engine.trace import Equations
from stickslip.engine.unforeseen import FLOOR, NEAR_POLE, Way, active
from stickslip.engine.write import LOG_OF_BITS, Writer, horner, literal

__all__ = ["ORDER", "switches", "write_step"]

ORDER = 16
LONGEST = 0.25  # of a period
ROUNDING = 1e-16  # of the velocity scale: what a step may leave out


def write_step(eq: Equations) -> Step:
    """The lines of the series: _k<state>_<power> and _g<guard>_<power> in units of the step, its length _hh, whether it is the _last."""
    return _SeriesWriter(eq).write()


def switches(eq: Equations, step: Step) -> str:
    """Text of what each guard's zero does to the modes and states of a lane; it returns the status of a run that ends there."""
    lines = ['@njit("int64(int64, int64, float64[::1])", **OPTIONS)', "def switched(which, lane, S):", "    t = S[F_T + lane]"]
    lines += [f"    y{i} = S[F_Y + {i} * L + lane]" for i in range(eq.states)]
    bind = (
        {s.name: f"y{i}" for i, s in enumerate(eq.y)} | {"t": "t"} | {s.name: f"S[F_MODE + {i} * L + lane]" for i, s in enumerate(eq.modes)}
    )
    bind |= {f"b{k}": f"S[F_B + {k} * L + lane]" for k in range(eq.signs)}
    bind |= {f"clk{k}": f"S[F_CLK + {k} * L + lane]" for k in range(len(eq.clocks))}
    for k, switch in eq.switches.items():
        w = Writer()
        w.case_nodes = list(step.case_nodes)
        news = [(f"S[F_MODE + {i} * L + lane]", w.value(new, bind)) for i, new in enumerate(switch.modes)]
        news += [(f"S[F_Y + {i} * L + lane]", w.value(new, bind)) for i, new in enumerate(switch.states) if new is not None]
        text = [*w.lines, *(f"_new{i} = {value}" for i, (_, value) in enumerate(news))]
        text += [f"{place} = _new{i}" for i, (place, _) in enumerate(news)] + [f"return {switch.status}"]
        reads = [f"_c{j} = S[F_C + {j} * L + lane]" for j in range(len(w.case_nodes)) if any(_names(f"_c{j}", line) for line in text)]
        lines += [f"    if which == {k}:", *(f"        {line}" for line in reads + text)]
        if len(w.case_nodes) > len(step.case_nodes):
            raise AssertionError("a switch needs a number that the step does not hold")
    lines += [f"    if which < {eq.signs}:", "        S[F_B + which * L + lane] = -S[F_B + which * L + lane]", "    return 0"]
    return "\n".join(lines)


def _names(name: str, line: str) -> bool:
    return re.search(rf"(?<![\w.]){name}(?!\w)", line) is not None


class _SeriesWriter:
    def __init__(self, eq: Equations):
        self.eq, self.w = eq, Writer()
        self.n, self.guards = eq.states, range(1, len(eq.guards))  # guard 0, the side of v, is the mode
        self.w.count_uses([*eq.f, *eq.guards])

    def write(self) -> Step:
        """All lines in order."""
        n = range(self.n)
        fields = ["t", "tend", "x", *(f"y{i}" for i in n), *(f"b{k}" for k in range(self.eq.signs)), "mode0"]
        fields += [*(f"clk{k}" for k in range(len(self.eq.clocks))), *(f"m{i}" for i in n if i), "stat", "nacc", "nrej", "ratio", "acc"]
        fields += ["t0", "hh", "x0", "side", "last", "top", *(f"k{i}_{m}" for i in n for m in range(ORDER + 1))]
        fields += [f"g{k}_{m}" for k in self.guards for m in range(ORDER + 1)]
        self.rising = active(self.eq, "exp") | active(self.eq, "tanh")
        fields += [f"e{k}_{m}" for k in range(len(self.rising)) for m in range(ORDER + 1)]
        self._series()
        self._length()
        self._polynomials()
        for switch in self.eq.switches.values():  # what they need is held by the lane too
            for new in (*switch.modes, *switch.states):
                self._hold(new)
        for node in (self.eq.offset, self.eq.period):
            self._hold(node)
        return Step(tuple(self.w.lines), tuple(fields), tuple(self.w.case_nodes), ORDER, series=True)

    def _hold(self, node: Sym | None) -> None:
        """Have the case's part of an expression computed once for each case."""
        if node is None or node.op == "constant":
            return
        if node.level == CASE:
            self.w.value(node, {})
        else:
            for a in node.args:
                self._hold(a)

    def _bind(self, t: str, y: list[str]) -> dict[str, str]:
        bind = {s.name: name for s, name in zip(self.eq.y, y, strict=True)} | {"t": t, "mode0": "_mode0"}
        bind |= {f"b{k}": f"_b{k}" for k in range(self.eq.signs)}
        return bind | {f"clk{k}": f"_clk{k}" for k in range(len(self.eq.clocks))}

    def _series(self) -> None:
        """Taylor coefficients of the states and of the guards."""
        start = self._bind("_t", [f"_y{i}" for i in range(self.n)])
        self.start = start
        self.scale_v = self.w.value(self.eq.velocity_scale, start)
        self.period = self.w.value(self.eq.period, start)
        self.jets = jets = Jets(self.eq, self.w, start)
        orders = range(ORDER + 1)
        self.c = [[jets.coefficient(y, m) for m in orders] for y in self.eq.y]
        held = {k: f"_b{k}" if k < self.eq.signs else "" for k in self.guards}
        self.g = {}
        for k in self.guards:
            plain = [jets.coefficient(self.eq.guards[k], m) for m in orders]
            self.g[k] = [c if not held[k] or c == ZERO else self.w.line(self.w.fresh(), f"{held[k]} * {c}") for c in plain]
        self.w.line("_acc", f"1.0 * {self.w.value(self.eq.f[0], start)}")
        self.w.line("_ratio", "1.0")

    def _length(self) -> None:
        """The longest step whose last terms are below rounding; it ends at the next known instant at the latest."""
        w = self.w
        w.line("_longest", f"{literal(LONGEST)} * {self.period}")
        w.line("_hh", "1.0 * _longest")
        tolerated = f"{literal(ROUNDING)} * {self.scale_v}"
        self._limit(self.c[0], tolerated)
        for k in self.guards:
            if all(c == ZERO for c in self.g[k][2:]):
                continue
            low = [f"abs({c})" if c != ZERO else ZERO for c in self.g[k][:4]]
            size = w.line(w.fresh(), f"{horner(low, '_longest')} + 1e-290")
            self._limit(self.g[k], f"{literal(ROUNDING)} * {size}")
        for quotient, ways in active(self.eq, "reciprocal").items():
            c = [self.jets.coefficient(quotient, m) for m in range(ORDER + 1)]
            self._limit(c, f"({literal(NEAR_POLE)} * abs({c[0]}) if {self._counts(ways)} else 1e300)")
        w.line("_rem", "_tend - _t")
        w.line("_last", "1.0 if _rem <= _hh * 1.0000001 else 0.0")
        w.line("_hh", "_rem if _last > 0.5 else _hh")

    def _counts(self, ways: list[Way]) -> str:
        """Whether what is held leads to a part of the equations."""
        texts = {" and ".join(f"{self.w.value(a, self.start)} {'>' if up else '<='} 0.0" for a, up in way) for way in ways}
        return "True" if "" in texts else f"({' or '.join(f'({text})' for text in sorted(texts))})"

    def _limit(self, c: list[str], tolerated: str) -> None:
        """Shorten the step to where the last two terms of a series fall to what is tolerated."""
        w = self.w
        for m in (ORDER - 1, ORDER):
            if c[m] == ZERO:
                continue
            bits = w.line(w.fresh(), f"(as_bits({tolerated}) - as_bits(abs({c[m]}))) * {LOG_OF_BITS}")
            power = w.line(w.fresh(), f"{literal(1 / m)} * {bits}")
            w.line(power, f"{power} if {power} < 900.0 else 900.0")
            h = w.line(w.fresh(), f"as_float(np.int64(({power} + 1022.957) * 4503599627370496.0))")
            w.line("_hh", f"_hh if _hh < {h} else {h}")

    def _polynomials(self) -> None:
        """The series in theta = (time since the start) / h: of the states, the guards, and of how far exponents are below the floor."""
        w = self.w
        powers = ["1.0", "_hh"]
        for m in range(2, ORDER + 1):
            powers.append(w.line(w.fresh(), f"{powers[m // 2]} * {powers[m - m // 2]}"))
        for i in range(self.n):
            for m in range(ORDER + 1):
                w.line(f"_k{i}_{m}", f"{powers[m]} * {self.c[i][m]}" if self.c[i][m] != ZERO else "0.0")
        for k, c in self.g.items():
            for m in range(ORDER + 1):
                w.line(f"_g{k}_{m}", f"{powers[m]} * {c[m]}" if c[m] != ZERO else "0.0")
        for k, (node, ways) in enumerate(self.rising.items()):
            c = [self.jets.coefficient(node.args[0], m) for m in range(ORDER + 1)]
            times = "1.0" if node.op == "exp" else w.line(w.fresh(), f"-2.0 if {c[0]} > 0.0 else 2.0")  # tanh a knows exp(-2|a|)
            w.line(f"_e{k}_0", f"{literal(FLOOR)} - {times} * {c[0]} if {self._counts(ways)} else 0.0")
            for m in range(1, ORDER + 1):
                w.line(f"_e{k}_{m}", f"-{times} * {powers[m]} * {c[m]}" if c[m] != ZERO else "0.0")
