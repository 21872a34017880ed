"""The series of a step by a loop over orders: its coefficients, what it says of guards, several contacts, and all lanes alike."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import mpmath as mp
import numpy as np
import pytest

import drawn
import stickslip as ss
from engine.test_emit import plain
from models.machines.test_any_coordinates import ARM, POLE
from problems import chain
from stickslip.basics.batch import rows_of
from stickslip.basics.fields import leaves
from stickslip.basics.status import Status
from stickslip.engine import lanes, taylor, trace
from stickslip.engine.linear_systems import least_of
from stickslip.engine.roundings import Sizes
from stickslip.engine.steptext import bound
from stickslip.engine.symbols import TraceError
from stickslip.engine.unforeseen import hides
from stickslip.engine.values import values_of

#: The k-th coefficient of a function's series at a; mpmath's own series, by differences, is not for the neighbourhood of poles.
KNOWN = {
    "exp": lambda a, k: mp.exp(a) / mp.factorial(k),
    "log": lambda a, k: -((-1 / a) ** k) / k if k else mp.log(a),
    "sqrt": lambda a, k: mp.sqrt(a) * mp.binomial(0.5, k) / a**k,
    "reciprocal": lambda a, k: (-1 / a) ** k / a,
}
SMOOTH = {name: getattr(mp, name) for name in ("sin", "cos", "atan", "sinh", "cosh", "tanh", "asinh")}
SMOOTH |= {"bell": lambda x: mp.sech(x) ** 2}


def outer(name, a, length):
    """The series of a function at a."""
    return [KNOWN[name](a, k) for k in range(length)] if name in KNOWN else mp.taylor(SMOOTH[name], a, length - 1)


# ---- the second method ----
class Series:
    """Expressions of a graph as truncated series in 30 digits: products by the definition, functions by their series at the value."""

    def __init__(self, known, length):
        self.known, self.length, self.found = known, length, {}

    def of(self, node):
        if node.number not in self.found:
            self.found[node.number] = self._of(node)
        return self.found[node.number]

    def _of(self, node):
        if node.op in ("constant", "case", "flag"):
            return self._constant(node.value if node.op == "constant" else self.known[node.name])
        if node.op == "variable":
            return (self.known[node.name] + [mp.mpf(0)] * self.length)[: self.length]
        if node.op == "select":
            held, yes, no = node.args
            return self.of(yes) if self.of(held)[0] > 0 else self.of(no)
        a = [self.of(arg) for arg in node.args]
        if node.op == "multiply":
            return self._product(*a)
        if node.op in ("add", "subtract"):
            return [x + y if node.op == "add" else x - y for x, y in zip(*a, strict=True)]
        return self._composed(outer(node.op, a[0][0], self.length), [mp.mpf(0), *a[0][1:]])

    def _constant(self, value):
        return [mp.mpf(float(value)), *[mp.mpf(0)] * (self.length - 1)]

    def _product(self, a, b):
        return [mp.fdot(a[: m + 1], b[m::-1]) for m in range(self.length)]

    def _composed(self, outer, inner):
        result = self._constant(0.0)
        for c in reversed(outer):
            result = self._product(result, inner)
            result[0] += c
        return result


def second(eq, known, roots):
    """The coefficients of the solution that begins as `known` says, and of some expressions along it."""
    y = {state.name: [mp.mpf(known[state.name])] for state in eq.y}
    order = lanes.step_of(eq, None, True).degree
    for m in range(order):
        series = Series(known | y | {"t": [mp.mpf(known["t"]), mp.mpf(1)]}, m + 1)
        for state, rate in zip(eq.y, eq.f, strict=True):
            y[state.name].append(series.of(rate)[m] / (m + 1))
    series = Series(known | y | {"t": [mp.mpf(known["t"]), mp.mpf(1)]}, order + 1)
    return [[float(c) for c in series.of(root)] for root in roots]


# ---- the step, by Python ----
def begun(eq, row, rng):
    """What a lane may hold: an instant, states of some size, and flags and modes that fit them."""
    known = dict(zip(eq.names, row, strict=True))
    period, scale = (float(values_of(eq.graph, known, [node])[node.number]) for node in (eq.period, eq.velocity_scale))
    known |= {"t": rng.uniform(0, 0.9) * period}
    known |= {s.name: scale * rng.normal() * (0.0 if i == 0 and rng.random() < 0.25 else 1.0) for i, s in enumerate(eq.y)}
    known |= {f"clk{k}": math.copysign(1.0, values_of(eq.graph, known, [clock])[clock.number]) for k, clock in enumerate(eq.clocks)}
    known |= {s.name: float(np.sign(known[v.name])) for s, v in zip(eq.modes, eq.y, strict=False)}
    for k in range(eq.signs):
        known[f"b{k}"] = 1.0 if values_of(eq.graph, known, [eq.guards[k]])[eq.guards[k].number] >= 0 else -1.0
    return known, period


def stepped(eq, known, period):
    """The lines of the step, done by Python."""
    step = lanes.step_of(eq, None, True)
    numbers = values_of(eq.graph, known, step.case_nodes)
    given = {f"c{j}": numbers[node.number] for j, node in enumerate(step.case_nodes)}
    given |= {name: known[name] for name in ("t", *(s.name for s in eq.modes), *(f"clk{k}" for k in range(len(eq.clocks))))}
    given |= {f"b{k}": known[f"b{k}"] for k in range(eq.signs)} | {f"y{i}": known[s.name] for i, s in enumerate(eq.y)} | {"tend": period}
    given |= {field[:-2]: np.zeros(step.degree + 1) for field in step.fields if field[-2:] == "_0"}
    return plain(step.lines, given)


def compared(robot, rng):
    """The largest error of a coefficient, in units of what roundings may do to it; what is said of the guards, and their polynomials."""
    eq = trace.trace(robot)
    known, period = begun(eq, rows_of(robot, eq.names)[0].tolist(), rng)
    done, watched = stepped(eq, known, period), taylor.watched(eq)
    roots = [*eq.y, *(eq.guards[k] for k in watched)]
    near = known | {name: known[name] * (1 + rng.choice([-1, 1]) * EPS) for name in (*eq.names, "t", *(y.name for y in eq.y))}
    with mp.workdps(30):
        right, beside = (second(eq, given, roots) for given in (known, near))
    names = [*(f"_k{i}" for i in range(eq.states)), *(f"_g{p}" for p in range(len(watched)))]
    flags = [*(1.0 for _ in eq.y), *(known[f"b{k}"] if k < eq.signs else 1.0 for k in watched)]
    powers, worst = float(done["_hh"]) ** np.arange(len(done["_k0"])), 0.0
    for name, root, flag, *both in zip(names, roots, flags, right, beside, strict=True):
        if name[:2] == "_g" and out_of_reach(eq, watched[int(name[2:])], known):  # a number, and not above what it may be
            assert done[name][0] == pytest.approx(values_of(eq.graph, known, [root])[root.number]) and not done[name][1:].any()
            continue
        c, other = (flag * np.array(series) * powers for series in both)
        around = np.abs(np.pad(c, 1))
        size = np.maximum(np.maximum(around[1:-1], around[:-2]), around[2:])
        worst = max(worst, (np.abs(done[name] - c) / (EPS * size + np.abs(other - c) + 1e-300)).max())
    return worst, [(float(done[f"_clear{p}"]), done[f"_g{p}"]) for p in range(len(watched))]


def out_of_reach(eq, k, known):
    """Whether a guard is a border of loads at which no angle brings it."""
    if k not in eq.switches or eq.switches[k].status != Status.PAINLEVE:
        return False
    least = least_of(eq.guards[k])
    return least is not None and values_of(eq.graph, known, [least])[least.number] > 0.0


def check(robots, rng):
    said = []
    for robot in robots:
        worst, clear = compared(robot, rng)
        assert worst <= ROUNDINGS, robot
        said += clear
    assert {clear > 0 for clear, _ in said} == {True, False}  # some guards are cleared, some are not
    theta = np.linspace(0.0, 1.0, 401)
    for clear, c in said:
        assert clear <= 0 or np.polynomial.polynomial.polyval(theta, c).min() > 0


#: A value has some ten roundings, a coefficient those of up to 16 recurrences, and h to the m-th power m more; each may count as what a
#: rounding of a number that is given does, or as one of the coefficient and its neighbours, from which it follows. Of 270 draws 267 stay
#: below 8; a power of .5 at rest, whose slope is rounded off there, makes 310.
ROUNDINGS, EPS = 500, 2.0**-52


def test_coefficients_are_those_of_a_second_method():
    """Laws and drives in turn; a guard that is said to be clear of zero is."""
    check([drawn.robot(i) for i in range(0, 54, 5)], np.random.default_rng(7))


@pytest.mark.slow
def test_coefficients_of_every_law_and_drive_are_those_of_a_second_method():
    check([drawn.robot(i) for i in range(270)], np.random.default_rng(8))


def test_coefficients_of_machines_with_places_are_those_of_a_second_method():
    """Whose accelerations solve linear equations: the second method divides series, as elimination is written out."""
    rail = ss.machines.CartPole(1.0, 0.8, 0.5, ss.Coulomb(0.1, 0.12))
    for model in (rail, rail.replace({"friction.mu_plus": 6.0}), POLE, ARM):  # the second one has borders that its angle may reach
        assert trace.trace(model).graph.linear
        assert compared(model, np.random.default_rng(0))[0] <= ROUNDINGS, type(model).__name__


def test_places_cost_a_product_of_series_for_each_that_cannot_be_spared():
    """Of a cart with a pendulum: sine and cosine times u, and cos times the cart's acceleration; and nothing is held against slopes."""
    eq = trace.trace(POLE)
    sums = {line.split()[0] for line in lanes.step_of(eq, None, True).lines if line.strip()[:2] in ("_s", "_a") and "+ j]" in line}
    assert len({name.removesuffix("o") for name in sums}) == 3 and not hides(eq)


# ---- which guards there are to watch ----
def test_guards_are_watched_that_have_a_switch_or_a_flag_that_something_reads():
    for law in ("coulomb", "tabulated"):
        eq = trace.trace(
            ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="coulomb").replace(friction=ss.friction.LAWS[law].example())
        )
        assert taylor.watched(eq) == list(range(1, len(eq.guards)))  # the side of v is the mode, which has switches of its own
    eq = trace.trace(chain(0.0, 1.0))
    assert taylor.watched(eq) == list(range(6))  # of each contact: it comes to rest, and breaks away to either side


def test_a_select_on_what_is_not_held_is_refused():
    eq = trace.trace(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"))
    (v,) = eq.y
    with pytest.raises(TraceError, match="not held"):
        lanes.step_of(replace(eq, f=(eq.graph.select(v, v, -v),)), None, True)


# ---- several contacts ----
def moved(kernel, machine, periods=400):
    """What modules do that start at rest, in their last period."""
    rows = np.ascontiguousarray(rows_of(machine, kernel.names))
    start = np.zeros((len(rows), 1 + kernel.states))
    return lanes.run(kernel, rows, start, lanes.Job(periods, periods - 1, False, 1e-12, 0.75, 1e6))


def test_two_modules_move_as_the_reference_says_and_alike_on_one_lane_and_sixteen():
    """Two velocities, two modes, six guards; in phase two modules are one. The page on several contacts has the numbers, to 15 digits."""
    pair = chain(0.0, 0.0).replace({"phases.1": np.array([0.0, math.pi / 2, *(0.2 * i for i in range(1, 18))])})
    many, one = (moved(lanes.kernel_of(pair, None, record), pair) for record in (False, True))
    assert set(many.status) == {0} and np.ptp(many.accepted) > 0
    for name in ("displacement", "end", "accepted", "v_max", "v_min"):
        assert np.array_equal(getattr(many, name), getattr(one, name)), name
    velocity = many.displacement / pair.period
    assert velocity[:2] == pytest.approx([0.002383491055471, 0.002938713863365], abs=5e-15)  # last printed digit 1e-15


@dataclass(frozen=True, eq=False)
class Hanging(ss.Machine):
    """Four links that hang from one another, with friction in their joints."""

    coordinates = ("1", "2", "3", "4")

    def bodies(self):
        return {n: ss.Body(0.4, inertia=0.005) for n in self.coordinates}

    def places(self, t, q):
        x, z, places = 0.0, 0.0, {}
        for n in self.coordinates:
            across, up = 0.2 * ss.maths.sin(q[n]), -0.2 * ss.maths.cos(q[n])
            places[n] = (x + across, z + up, q[n])
            x, z = x + 2 * across, z + 2 * up
        return places

    def contacts(self):
        rows = {n: {n: 1.0, **({before: -1.0} if before else {})} for before, n in zip(("", *"123"), "1234", strict=True)}
        return {n: ss.Contact(row, ss.Coulomb(0.3, 0.2), load=0.5) for n, row in rows.items()}


def test_roundings_of_what_solves_equations_are_a_part_of_its_terms():
    """Pivots are made of pivots: terms multiplied out said 1e50 for rates of 10, beside which every rate was none."""
    eq = trace.trace(Hanging())
    sizes = Sizes(eq, [])
    wanted = [(sizes.of(f), sizes._value(f)) for f in eq.f[:4]]
    given = {y.name: v for y, v in zip(eq.y, (1.3, 1.3, 1.3, 1.3, 0.1, 0.2, 0.3, 0.8), strict=True)} | {eq.t.name: 0.0}
    modes = {mode.name: side for mode, side in zip(eq.modes, (1.0, -1.0, -1.0, 0.0), strict=True)}
    own = {name[1:]: (given | modes)[by] for by, name in bound(eq).items() if by in given | modes}
    constants = values_of(eq.graph, given | modes | dict(leaves(Hanging())), sizes.w.case_nodes)
    own |= {f"c{k}": float(constants[node.number]) for k, node in enumerate(sizes.w.case_nodes)}
    names = plain(sizes.w.lines, own)
    for size, rate in wanted:
        assert abs(names[rate]) <= names[size] < 1e6 * max(1.0, abs(names[rate]))
