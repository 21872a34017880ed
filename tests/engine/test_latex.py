"""Equations as LaTeX: those of a textbook, derived by hand, for machines of one body and of several; and they can be drawn."""

import math
import random
import re
from dataclasses import dataclass, field
from typing import Any

import pytest
from matplotlib.mathtext import MathTextParser

import stickslip as ss
from every import DRY, SHAKEN, every_machine, with_bodies
from latex_values import value
from models.machines.test_mirrored_machines import WORM, Everything, Prescribed
from registries import examples
from rows import each_row
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.latex_motion import _Parts
from stickslip.engine.letters import expression_of, spread, symbol
from stickslip.engine.tex import dotted, indices, letters_of, letters_of_coordinates, text_of
from stickslip.friction import LAWS
from stickslip.maths import cos, sin
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.machine_adapter import machine_of
from stickslip.show.reports.mathml import mathml


@dataclass(frozen=True, eq=False)
class OwnCoordinates(ss.Machine):
    """A pendulum on a cart."""

    length: float
    tilt: float
    friction: Any
    coordinates = ("x", "theta")

    def bodies(self):
        return {"cart": ss.Body(1.0), "bob": ss.Body(0.1)}

    def places(self, t, q):
        return {"cart": (q["x"], 0.0), "bob": (q["x"] + self.length * sin(q["theta"]), -self.length * cos(q["theta"]))}

    def contacts(self):
        return {"rail": ss.Contact("x", self.friction, load=10.8 * cos(self.tilt))}


DROPPED = ss.Chain((SHAKEN, SHAKEN.replace(drive=ss.drives.TwoPhase(stroke=0.01, u1=0.654, u2=0.654))), ss.machines.Rigid())
MACHINES = {
    **{name: made[0] for name, made in with_bodies.items()},
    "everything": Everything(300.0, DRY),
    "prescribed": Prescribed(ss.Harmonic(2e-3, 60.0), ss.Coulomb(0.1, 0.3)),
    "five": ss.Chain((SHAKEN,) * 5, ss.Spring(1200.0, 0.4)),
    "one": SHAKEN,
    "worm": WORM,
}


SPRING = ss.Spring(1.0)
LE, LEQ = "\\le ", "\\leq "


def lines(model, text=None):
    head, *found, end = (ss.latex(model) if text is None else text).split("\n")
    assert (head, end) == (r"\begin{aligned}", r"\end{aligned}")
    return [line.removesuffix(r" \\") for line in found]


def test_a_chain_has_newtons_law_for_each_module_and_one_law_for_all():
    drive = r"A_{%d} \omega_{%d}^{2} m_{%d} \sin{\left(\omega_{%d} t + \varphi_{%d} \right)}"
    assert lines(with_bodies["Chain, set-valued laws"][0]) == [
        rf"\left(M_{{1}} + m_{{1}}\right) \ddot x_{{1}} &= {drive % ((1,) * 5)} - F_{{12}} - R_{{1}}",
        rf"\left(M_{{2}} + m_{{2}}\right) \ddot x_{{2}} &= {drive % ((2,) * 5)} + F_{{12}} - R_{{2}}",
        r"F_{12} &= c \left(v_{1} - v_{2}\right) + k \left(x_{1} - \ell - x_{2}\right)",
        r"N_{i} &= g_{i} \left(M_{i} + m_{i}\right)",
        r"R_{i} &= N_{i} \mu_{+,i}, && v_{i} > 0",
        r"R_{i} &= - N_{i} \mu_{-,i}, && v_{i} < 0",
        r"- N_{i} \mu_{-,i} \le R_{i} &\le N_{i} \mu_{+,i}, && v_{i} = 0",
        r"i &= 1, 2",
    ]


def test_a_machine_of_ones_own_has_its_declared_names():
    assert lines(with_bodies["a machine of your own"][0]) == [
        r"\mathrm{head} \, \ddot x_{\mathrm{head}} &= \mathrm{push} \, \sin{\left(\omega t \right)} "
        r"- F_{\mathrm{head},\mathrm{sledge}} - R_{\mathrm{head}}",
        r"\mathrm{sledge} \, \ddot x_{\mathrm{sledge}} &= F_{\mathrm{head},\mathrm{sledge}} - R_{\mathrm{sledge}}",
        r"F_{\mathrm{head},\mathrm{sledge}} &= c \left(v_{\mathrm{head}} - v_{\mathrm{sledge}}\right) "
        r"+ k \left(x_{\mathrm{head}} - x_{\mathrm{sledge}}\right)",
        r"N_{\mathrm{head}} &= \mathrm{head} \, g",
        r"N_{\mathrm{sledge}} &= \mathrm{sledge} \, g",
        r"R_{i} &= N_{i} \mu_{+}, && v_{i} > 0",
        r"R_{i} &= - N_{i} \mu_{-}, && v_{i} < 0",
        r"- N_{i} \mu_{-} \le R_{i} &\le N_{i} \mu_{+}, && v_{i} = 0",
        r"i &= \mathrm{head}, \mathrm{sledge}",
    ]


def test_an_elastic_stop_pushes_and_never_pulls():
    (stop,) = [line for line in lines(with_bodies["capsule with an elastic stop"][0]) if r"\max" in line]
    assert stop.startswith(r"F'_{\mathrm{hammer},\mathrm{capsule}} &= \begin{cases} \max\left(0, ") and r"0 & \text{otherwise}" in stop
    assert r"d_{\mathrm{hammer},\mathrm{capsule}} &= x_{\mathrm{hammer}} - x_{\mathrm{capsule}}" in lines(
        with_bodies["capsule with an elastic stop"][0]
    )


def test_hits_belts_jumps_and_prescribed_distances_have_their_lines():
    told = lines(Everything(300.0, DRY))
    assert "v_{c}^+ - v_{a}^+ &= - 0.4 \\left(v_{c}^- - v_{a}^-\\right), && x_{c} - x_{a} = 0.013" in told
    assert r"v_{a}^+ &= - \frac{1}{2} v_{a}^-, && x_{a} = -0.05" in told
    assert r"w_{\mathrm{belt}} &= v_{a} - \mathrm{belt}" in told and r"w_{\mathrm{pad}} &= v_{c} - v_{a}" in told
    assert r"\Delta v_{a} &= 0.02, && t = 0.01" in told
    joined = lines(Prescribed(ss.Harmonic(2e-3, 60.0), DRY))
    assert r"x_{\mathrm{front}} - x_{\mathrm{rear}} &= A \sin{\left(\omega t \right)} + 0.1" in joined
    assert r"0.1 \ddot x_{\mathrm{front}} + 0.07 \ddot x_{\mathrm{rear}} &= - R_{\mathrm{front}} - R_{\mathrm{rear}}" in joined
    assert any(line.startswith(r"\Delta v_{2} &= ") for line in lines(DROPPED))
    own = lines(OwnCoordinates(0.5, 0.1, DRY))
    assert (
        own[0]
        == r"0.1 \ell \ddot \theta \cos{\left(\theta \right)} + 1.1 \ddot x &= 0.1 \ell \dot \theta^{2} \sin{\left(\theta \right)} - R"
    )
    assert r"N &= 10.8 \cos{\left(\mathrm{tilt} \right)}" in own  # theta is a coordinate there


@each_row("name", MACHINES)
def test_the_equations_can_be_drawn(name):
    model, text = MACHINES[name], ss.latex(MACHINES[name])
    markup = mathml(text, as_block=True)
    assert "merror" not in markup and "<munderover" not in markup and markup.count("<mtr") >= len(lines(model, text))
    draw = MathTextParser("path")
    for line in lines(model, text):
        if "cases" not in line:
            draw.parse(f"${line.replace('&', '').replace(LE, LEQ)}$")  # mathtext knows it by its longer name
    mechanics = machine_of(model).mechanics
    for own in indices(mechanics.bodies) if not mechanics.joined else ():
        assert rf"\ddot x_{{{own}}}" in text if own else r"\ddot x " in text
    for letter in letters_of_coordinates(mechanics.bodies) if mechanics.joined else ():
        assert dotted("ddot", letter) in text and "x_{" not in text and "v_{" not in text.replace("v_{s}", "")


@each_row("name", ["Chain, set-valued laws", "a machine of your own", "everything", "five"])
def test_what_is_written_is_what_is_solved(name):
    """Newton's law as it is written, at numbers, against the machine's own accelerations: rounding of some thirty operations."""
    model = MACHINES[name]
    letters = letters_of(model, [n for n, _ in leaves(model)])
    parts = _Parts(replace_leaf(model, letters.symbols))
    n = len(parts.bodies)
    q, u = [0.01 * (i + 1) * (-1) ** i for i in range(n)], [0.03 * (i - 1) for i in range(n)]
    R = [0.05 * (i + 1) for i in range(len(parts.contacts))]
    numbers = {text_of(letters.symbols[k]): v for k, v in leaves(model)} | {"t": 0.004}
    numbers |= {text_of(s): value for of, values in ((parts.x, q), (parts.v, u)) for s, value in zip(of, values, strict=True)}
    for ends, pull, letter in parts.tensions:
        tension = pull(symbol("t", 0), parts.distance(ends, parts.x), parts.distance(ends, parts.v))
        numbers[text_of(letter)] = value(text_of(tension), numbers)
    wanted = model.mechanics.accelerations(0.004, q, u, R)
    found = parts.accelerations(symbol("t", 0), parts.x, parts.v, R)
    for mass, a, expected in zip(parts.masses, found, wanted, strict=True):
        told = value(text_of(spread(expression_of(a), expression_of(mass))), numbers) / value(text_of(mass), numbers)
        assert told == pytest.approx(float(expected), rel=1e-10, abs=1e-12)


WRITTEN = [name for name, law in examples(LAWS).items() if adapted(law).compiles]


@each_row("name", WRITTEN)
def test_the_lines_of_a_law_say_what_it_computes(name):
    """The printed text, read again and evaluated, against the law in plain Python: rounding of some hundred operations."""
    law = LAWS[name].example()
    traced, letters = adapted(law), letters_of(law, [n for n, _ in leaves(law)])
    given = {text_of(letters.symbols[n]): v for n, v in leaves(law)} | {"N": 0.7, "R_{0}": 0.05}
    many, draw = traced.states > 1, random.Random(1)
    for v in (3e-3, -3e-3, 7e-5, -7e-5):
        z = tuple(draw.uniform(0.2, 0.9) * size * (1 if v > 0 else -1) for size in (traced.scale(0.7) if traced.dynamic else ()))
        mode = tuple(draw.choice((-1, 1)) for _ in range(traced.modes))
        rates = traced.rate(v, z, 0.7, mode)
        names = [f"z_{{{i + 1}}}" if many else "z" for i in range(traced.states)]
        at = given | {"v": v} | dict(zip(names, z, strict=True)) | {rf"\dot{n}": r for n, r in zip(names, rates, strict=True)}
        at |= {f"m_{{{i + 1}}}": m for i, m in enumerate(mode)}
        wanted = {"R": traced.force(v, z, rates, 0.7, mode, 0.05)} | {rf"\dot {n}": r for n, r in zip(names, rates, strict=True)}
        for line in lines(law):
            left, _, rest = line.partition(" &= ")
            right, _, side = rest.partition(", && ")
            if left in wanted and side in ("", "v > 0" if v > 0 else "v < 0"):
                assert value(right, at) == pytest.approx(float(wanted.pop(left)), rel=1e-11, abs=1e-13)
        assert not wanted


def test_letters_are_told_apart():
    @dataclass(frozen=True, eq=False)
    class Heavy(ss.Machine):
        mass: float = field(default=1.0, metadata={"symbol": "m_b"})
        inner_mass: float = 2.0
        t: float = 3.0
        spring: Any = SPRING
        stiffness: float = 2.0

        def bodies(self):
            return {"body": ss.Body(self.mass + self.inner_mass, force=lambda t, x, v: self.t * sin(self.stiffness * t))}

        def links(self):
            return {("body", None): self.spring}

    letters = letters_of(Heavy(), [name for name, _ in leaves(Heavy())])
    texts = {name: text_of(letter) for name, letter in letters.symbols.items()}
    assert len(set(texts.values())) == len(texts)
    assert texts["mass"] == "m_{b}" and texts["inner_mass"] == "m" and texts["t"] == r"\mathrm{t}"
    assert {texts["stiffness"], texts["spring.stiffness"]} == {"k", r"k_{\mathrm{spring}}"}


def test_a_force_that_asks_python_whether_is_no_formula():
    @dataclass(frozen=True, eq=False)
    class Choosing(ss.Machine):
        mass: float = 1.0

        def bodies(self):
            return {"body": ss.Body(self.mass, force=lambda t, x, v: 1.0 if x > 0 else -1.0)}

    with pytest.raises(ss.InputError, match="cannot be written as a formula"):
        ss.latex(Choosing())


def test_harmonics_count_from_one():
    drive = ss.MultiHarmonic(omega=200.0, amplitudes=(4e-4, 1e-4), phases=(0.0, 1.57))
    text = ss.latex(SHAKEN.replace(drive=drive))
    assert "A_{1}" in text and "A_{2}" in text and "A_{0}" not in text


def test_nested_laws_have_letters_without_dots():
    law = ss.latex(ss.Coulomb(0.2, 0.3) + ss.Viscous(0.1, 0.1))
    assert not re.search(r"_\{[^{}]*_", law)


def test_lugre_friction_is_written_in_the_order_in_which_it_is_published():
    force, forward, backward = lines(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4).friction)
    assert force == r"R &= \sigma_{0} z + \sigma_{1} \dot z + \sigma_{2} v"
    g = r"\left(\mu_{+} + \left(f_{+} - \mu_{+}\right) e^{- \frac{v^{2}}{v_{s}^{2}}}\right)"
    assert forward == rf"\dot z &= v - \frac{{\sigma_{{0}} v z}}{{N {g}}}, && v > 0"
    assert backward == rf"\dot z &= v + \frac{{\sigma_{{0}} v z}}{{N {g.replace('+}', '-}')}}}, && v < 0"


@each_row(
    ("number", "text"),
    [
        (0.1, "0.1 x"),
        (1 / 3, r"\frac{x}{3}"),
        (1 / 7, r"\frac{x}{7}"),
        (0.6867000000000001, "0.6867 x"),  # rounding errors of a product are no digits
        (2.5e-12, r"2.5 \cdot 10^{-12} x"),
        (0.75 * math.pi, r"0.75 \pi x"),
    ],
)
def test_numbers_are_short(number, text):
    written = text_of(number * symbol("x"))
    assert written == text and value(written, {"x": 3.0}) == pytest.approx(3.0 * number, rel=1e-15)


def test_a_flow_has_its_rates_its_switches_and_the_laws_of_its_contacts():
    assert lines(every_machine["a flow with contacts"][0]) == [
        r"\dot x &= v",
        r"\dot v &= - R - k x",
        r"w &= v - u",
        "N &= 9.81",
        r"R &= N \left(0.1 e^{- 10 w} + 0.2\right), && w > 0",
        r"R &= N \left(- 0.1 e^{10 w} - 0.2\right), && w < 0",
        r"- 0.3 N \le R &\le 0.3 N, && w = 0",
    ]
    assert lines(every_machine["a flow without a period"][0]) == [
        r"\dot x &= v",
        r"\dot v &= \mu v \left(1 - x^{2}\right) - x",
        r"\mathrm{gap} - x &= 0, && \mathrm{mode}\ 0 \to \mathrm{mode}\ 0",
        r"x^+ &= \mathrm{gap}, && \mathrm{mode}\ 0 \to \mathrm{mode}\ 0",
        r"v^+ &= - r v, && \mathrm{mode}\ 0 \to \mathrm{mode}\ 0",
    ]
    hunted = lines(every_machine["a Filippov flow"][0])
    assert r"\mathrm{limit} - \mathrm{predator} &= 0, && \mathrm{free} \to \dots" in hunted
    assert sum(r"\mathrm{free}, \mathrm{hunted}" in line for line in hunted) == 1  # the prey has one rate there
    henon = ss.SwitchingFlow.of_map(lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0]), {"a": 0.3, "b": 0.3})
    assert r"y_{0}^+ &= y_{1} - a y_{0}^{2} + 1, && \mathrm{before} \to \mathrm{after}" in lines(henon)
    for name in ("a SwitchingFlow", "a flow with contacts", "a flow without a period", "a Filippov flow"):
        for line in lines(every_machine[name][0]):
            MathTextParser("path").parse(f"${line.replace('&', '').replace(LE, LEQ)}$")
    with pytest.raises(ss.InputError, match="a function of this flow cannot be written as a formula; write it with"):
        ss.latex(ss.SwitchingFlow(lambda t, y: (math.sin(y[0]),)))
