"""The bench: the standard experiments reproduce the literature, and say what is trivial instead of leaving holes."""

from __future__ import annotations

import json
import math

import matplotlib

matplotlib.use("Agg")

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.analysis.bench import EXPERIMENTS
from stickslip.analysis.bench.contact import MovedContact, swing
from stickslip.analysis.bench.probe import Probe
from stickslip.analysis.bench.setup import Setup
from stickslip.show.cli import main

#: Canudas de Wit et al. 1995, with a load of 1 N: Fc = 1 N, Fs = 1.5 N; their mass is 1 kg.
LUGRE_1995 = ss.LuGre(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3)
COULOMB = ss.Coulomb(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24)


@pytest.fixture(scope="module")
def found():
    """The LuGre model of 1995 on its own bench: spring of 2 N/m pulled at 0.1 m/s."""
    return ss.bench(LUGRE_1995, mass=1.0, stiffness=2.0, speed=0.1)


@pytest.fixture(scope="module")
def coulomb():
    return ss.bench(COULOMB)


def curve(found, experiment, number=0):
    line = found[experiment].curves[number]
    return np.asarray(line.x), np.asarray(line.y)


# the literature -----------------------------------------------------------------------------------------------------


def test_stick_slip_of_1995(found):
    """Period and peak velocity by an integrator that is not ours, to seven digits."""
    assert found.numbers["stick_slip"] is True
    assert found.numbers["stick_slip_period"] == pytest.approx(6.36271982, rel=1e-6)
    assert found.numbers["peak_velocity"] == pytest.approx(0.369816, rel=1.4e-6)  # its last digit


def test_steady_friction_is_the_stribeck_curve(found):
    v, R = curve(found, "steady")
    assert pytest.approx(1.0 + 0.5 * np.exp(-((v / 1e-3) ** 2)) + 0.4 * v, rel=1e-7) == R
    assert np.allclose(curve(found, "steady", 1)[1], R, rtol=1e-7)


def test_break_away_force_falls_with_the_force_rate(found):
    """Their Fig. 5: near Fs for slow ramps, towards Fc for fast ones."""
    rates, forces = curve(found, "breakaway")
    assert rates[0] < 1.0 and rates[-1] > 50.0
    assert np.all(np.diff(forces) < 0)
    assert 1.4 < forces[0] < 1.5 and forces[-1] < 1.1


def test_friction_is_higher_while_the_velocity_rises_and_the_loop_widens_with_frequency(found):
    """Their Fig. 4."""
    widths = []
    for k in range(3):
        v, R = curve(found, "lag", k)
        widths.append(np.sum(0.5 * (R[1:] + R[:-1]) * np.diff(v)) / np.ptp(v))
    assert 0 < widths[0] < widths[1] < widths[2]
    assert found.numbers["lag"] == pytest.approx(widths[2], rel=0.01)  # its swing is 0.8 of the middle, sampled at 240 points


def test_pre_sliding_is_a_spring_with_a_loop(found):
    assert found.numbers["stiffness"] == pytest.approx(1e5, rel=1e-9)
    x, R = curve(found, "hysteresis")
    # the area of the first outer loop, from its two branches of 80 samples each, is the work that was integrated
    x, R = x[80:240], R[80:240]
    area = np.sum(0.5 * (R[1:] + R[:-1]) * np.diff(x))
    assert area == pytest.approx(found.numbers["loop_loss"], rel=2e-3) and area > 0
    assert found.numbers["gap"] > 0.05  # LuGre's memory is local: an inner loop does not close (Swevers et al. 2000)


def test_lugre_drifts_below_break_away(found):
    """Force 0.4 + 0.2 sin(2 pi t) on 1 kg: 2.347e-6 m per period (Dupont et al. 2002 show it)."""
    conditions = found["drift"].conditions
    # the bench measures the static limit at a hundredth of v_s, where the Stribeck curve lies 3.3e-5 below 1.5 N
    assert conditions["bias"][0] == pytest.approx(0.4, rel=5e-5) and conditions["force"][0] == pytest.approx(0.2, rel=5e-5)
    assert found.numbers["drift"] == pytest.approx(2.347e-6, rel=0.01)


def test_elasto_plastic_friction_does_not_drift():
    law = ss.friction.ElastoPlastic(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3, z_ba=0.7e-5)
    assert abs(ss.bench(law, experiments=["drift"]).numbers["drift"]) < 1e-12


@pytest.mark.parametrize("strokes", [0.2, 1.0, 5.0])
def test_dahl_loss_per_cycle(strokes):
    """4 Fc a - 4 Fc^2/sigma tanh(sigma a/Fc) for a steady cycle of amplitude a."""
    sigma, Fc = 4e5, 0.2
    found = ss.bench(ss.Dahl(Fc, Fc, sigma), experiments=["dissipation"])
    a, loss = curve(found, "dissipation")
    k = int(np.argmin(abs(a * sigma / Fc - strokes)))
    assert a[k] * sigma / Fc == pytest.approx(strokes)
    truth = 4 * Fc * a[k] - 4 * Fc**2 / sigma * math.tanh(sigma * a[k] / Fc)
    # cycles are repeated until the loss changes by 1e-9; what is left decays by exp(-4 a sigma/Fc) from cycle to cycle
    assert loss[k] == pytest.approx(truth, rel=1e-9 / (1 - math.exp(-4 * strokes)) + 2e-8)


def test_dahl_has_no_stribeck_effect_and_no_lag():
    found = ss.bench(ss.Dahl(0.2, 0.2, 4e5), experiments=["steady", "lag"])
    assert found.numbers["fall"] == 0 and found.numbers["lag"] == 0
    assert np.allclose(curve(found, "steady")[1], 0.2, rtol=1e-8)


def test_maxwell_slip_remembers_reversals_and_dahl_does_not():
    flat = ss.friction.GMS(0.2, 0.2, None, None, sigma0=4e5, v_s=2e-3, attraction=1e4)
    gms, dahl = (ss.bench(law, experiments=["hysteresis"]).numbers["gap"] for law in (flat, ss.Dahl(0.2, 0.2, 4e5)))
    assert abs(gms) < 1e-6 * 0.2 < 0.01 < dahl


# exact rest -----------------------------------------------------------------------------------------------------------


def test_coulomb_stick_slip_is_the_closed_form(coulomb):
    """Slip takes (2/w)(pi - atan(D w/u)), stick 2 D/u, with D = (Fs - Fk)/k: Den Hartog's belt seen from the other side."""
    u = coulomb["stick_slip"].conditions["speed"][0]
    D, w = 0.03 / 2.0, math.sqrt(2.0)
    period = 2 / w * (math.pi - math.atan(D * w / u)) + 2 * D / u
    assert coulomb.numbers["stick_slip_period"] == pytest.approx(period, rel=1e-8)
    assert coulomb.numbers["peak_velocity"] == pytest.approx(u + math.hypot(D * w, u), rel=1e-8)
    # at rest, and a little while slower than a hundredth of the pull
    assert coulomb.numbers["stick_share"] == pytest.approx(2 * D / u / period, abs=5e-3)


def test_a_law_that_rests_exactly_says_what_is_trivial(coulomb):
    assert math.isinf(coulomb.numbers["stiffness"]) and math.isnan(coulomb.numbers["gap"])
    assert coulomb.numbers["drift"] == 0 and coulomb.numbers["lag"] == 0
    assert set(curve(coulomb, "breakaway")[1]) == {0.18}
    for name, word in (("hysteresis", "no pre-sliding"), ("breakaway", "at every force rate"), ("drift", "exactly")):
        assert word in coulomb[name].remark and word in coulomb.table
    reach = coulomb["hysteresis"].conditions["reach"][0]
    assert coulomb.numbers["loop_loss"] == pytest.approx(2 * reach * (0.15 + 0.21), rel=1e-7)


@pytest.mark.parametrize(
    ("law", "least", "most"),
    [
        (ss.friction.TanhCoulomb(0.15, 0.21, 1e-3), 2e-4, 5e-4),
        (ss.friction.DeadBand(0.15, 0.21, 1e-3), 2e-4, 5e-4),
        (ss.friction.Karnopp.example(), 9e-4, 1.1e-3),
    ],
    ids=lambda x: getattr(type(x), "__name__", str(x)),
)
@pytest.mark.slow
def test_approximations_creep(law, least, most):
    """In a period of 1 s: w artanh(F/mu N) and w F/mu N with F = 4/15 of the friction force; Karnopp's goes on with w."""
    found = ss.bench(law, experiments=["drift"])
    assert least < found.numbers["drift"] < most and "creeps on" in found["drift"].remark
    assert any("does not bring" in note or "creeps" in note for note in found.notes)


# the contact that is moved as prescribed ---------------------------------------------------------------------------------


def test_a_swing_goes_its_distance():
    moved = MovedContact(Probe(COULOMB, 1.0), 1e-3, rtol=1e-10)
    moved.follow(*swing(2e-3, 0.1))
    moved.follow(*swing(-5e-4, 0.1))
    assert moved.x == pytest.approx(1.5e-3, rel=1e-9)
    assert moved.done == pytest.approx(0.15 * 2e-3 + 0.21 * 5e-4, rel=1e-9)


@pytest.mark.parametrize(
    "law",
    [LUGRE_1995, ss.friction.GMS.example(), ss.Dahl.example(), ss.friction.ElastoPlastic.example()],
    ids=lambda law: type(law).__name__,
)
def test_contact_stiffness_is_sigma0(law):
    assert Setup(law, 1.0, 1.0).contact_stiffness == pytest.approx(law.sigma0, rel=1e-9)


# records, figures, words ---------------------------------------------------------------------------------------------------


def test_every_experiment_has_a_figure_a_table_and_units(found, coulomb):
    for one in (found, coulomb):
        assert [e.key for e in one.experiments] == list(EXPERIMENTS)
        for experiment in one.experiments:
            assert experiment.curves and all(len(c.x) == len(c.y) > 0 for c in experiment.curves)
            assert all(q.label in one.table and q.meaning for q in experiment.numbers)
        panels = ss.plot.bench(one).axes
        labels = [label for ax in panels for label in (ax.get_xlabel(), ax.get_ylabel()) if label]
        assert len(panels) == 8 and len(labels) == 14
        assert all(label.endswith(")") and "(" in label for label in labels)


def test_laws_side_by_side():
    many = ss.bench(["coulomb", ss.Viscous, COULOMB], experiments=["steady", "drift"])
    assert [b.name for b in many] == ["Coulomb", "Viscous", "Coulomb"] and len(many) == 3
    assert many["viscous"].numbers["slow_forward"] == 0 and many[0].numbers == many[2].numbers
    head = many.table.splitlines()[0].split()
    assert head[0] == "law" and head[-3:] == ["Coulomb", "Viscous", "Coulomb"]
    assert "<table>" in many._repr_html_() and ">drift [m]</th>" in many._repr_html_()
    assert len(ss.plot.bench(many).axes) == 3 * 2  # the name with the drift, and the steady curve


def test_the_numbers_survive_json(coulomb):
    told = json.loads(json.dumps(coulomb.to_dict()))
    assert told["law"] == "Coulomb" and told["parameters"]["mu_minus"] == 0.21
    assert told["numbers"]["slow_forward"] == {
        "value": 0.18, "unit": "N", "label": "static or slow, forwards", "meaning": "largest static friction force forwards",
    }  # fmt: skip
    assert told["experiments"]["steady"]["x"] == {"label": "speed |v|", "unit": "m/s"}


def test_the_command_measures_draws_and_speaks_json(capsys, tmp_path):
    picture = tmp_path / "laws.png"
    words = ["bench", "coulomb", "stribeck", "mu_plus=0.16", "--only", "steady", "--json", "--figure", str(picture)]
    assert main(words) == 0 and picture.stat().st_size > 1000
    told = json.loads(capsys.readouterr().out)
    assert [one["parameters"]["mu_plus"] for one in told["laws"]] == [0.16, 0.16]
    assert main(["bench", "coulomb", "--only", "drift"]) == 0
    assert "drift below break-away" in capsys.readouterr().out


@each_row(
    ("words", "told"),
    [
        (["coulom"], "did you mean 'coulomb'?"),
        ([], "type for example stickslip bench lugre"),
        (["coulomb", "sigma0=4"], "'sigma0' is not a number of Coulomb"),
        (["coulomb", "mu_plus=-1"], "Coulomb: mu_plus = -1"),
        (["coulomb", "--only", "drif"], "did you mean 'drift'?"),
        (["coulomb", "load=-1"], "load = -1; allowed is a positive number [N]"),
    ],
)
def test_bad_words_are_told_what_to_type(words, told, capsys):
    assert main(["bench", *words]) == 2
    assert told in capsys.readouterr().err


@each_row(
    ("call", "told"),
    [
        (lambda: ss.bench("nonsense"), "is not a law"),
        (lambda: ss.bench([]), "no law is given"),
        (lambda: ss.bench(3.0), "sliding and breakaway"),
        (lambda: ss.bench(ss.Coulomb([0.1, 0.2], 0.2)), "are arrays"),
        (lambda: ss.bench(COULOMB, mass=0.0, speed="fast"), "2 problems"),
        (lambda: ss.plot.bench("lugre"), "type ss.plot.bench(ss.bench(ss.LuGre))"),
    ],
)
def test_bad_input_is_told_what_to_type(call, told):
    with pytest.raises(ss.InputError) as raised:
        call()
    assert told in str(raised.value)


@pytest.mark.slow
@pytest.mark.parametrize("name", ss.friction.LAWS)
def test_every_law_goes_over_the_bench(name):
    found = ss.bench(name)
    assert [e.key for e in found.experiments] == list(EXPERIMENTS)
    low, high = (found.numbers[key] for key in ("slow_backward", "slow_forward"))
    assert math.isfinite(low) and math.isfinite(high) and min(low, high) >= 0
    assert found.numbers["loss"] > 0 and math.isfinite(found.numbers["drift"]) and math.isfinite(found.numbers["peak_velocity"])
    assert found.numbers["loss_share"] < 1.05  # friction that falls with the speed takes more where it slides slower: of a rock 1.7 %
    for experiment in found.experiments:
        assert all(q.value == q.value or experiment.remark or q.key in ("stick_slip_period", "loss_exponent") for q in experiment.numbers)
    ss.plot.bench(found)
