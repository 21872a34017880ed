"""Rate-and-state friction: steps of the speed, the critical stiffness, creep from rest, and earthquakes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import stickslip as ss
from models.friction.test_laws import integrated
from rows import each_row

ROCK = ss.friction.RateState(mu0=0.6, a=0.010, b=0.015, Dc=1e-5, v0=1e-6)
END = 3300.0  # s, of four earthquakes


@each_row(
    ("evolution", "phi"),
    [  # of a step from v0 to v: the age goes from Dc/v0 to Dc/v as exp(-x/Dc); the logarithm of v theta/Dc falls as exp(-x/Dc)
        ("aging", lambda r, x: math.log(1 / r + (1 - 1 / r) * math.exp(-x))),
        ("slip", lambda r, x: math.log(r) * math.exp(-x) - math.log(r)),
    ],
)
def test_a_step_of_the_speed_raises_friction_at_once_and_lowers_it_over_the_slip_dc(evolution, phi):
    law, r = ROCK.replace(evolution=evolution), 10.0
    assert law.force(r * ROCK.v0, 0.0, 0.0, 2.0) / 2.0 == pytest.approx(0.6 + 0.010 * math.log(r), abs=1e-13)
    ways = np.array([0.1, 1.0, 3.0, 20.0])
    found = integrated(law, lambda t: r * ROCK.v0, ways[-1] * ROCK.Dc / (r * ROCK.v0), times=ways * ROCK.Dc / (r * ROCK.v0))
    assert found == pytest.approx([phi(r, x) for x in ways], abs=1e-10)
    assert law.force(r * ROCK.v0, found[-1], 0.0, 2.0) / 2.0 == pytest.approx(0.6 - 0.005 * math.log(r), abs=1e-9)
    assert law.steady(r * ROCK.v0, 2.0) == pytest.approx(2.0 * (0.6 - 0.005 * math.log(r)), abs=1e-13)


@pytest.mark.parametrize("evolution", ["aging", pytest.param("slip", marks=pytest.mark.slow)])
def test_a_slider_is_stable_above_its_critical_stiffness_and_not_below(evolution):
    law, load = ROCK.replace(evolution=evolution), 1e6
    for part in (0.8, 1.25):
        k = part * law.critical_stiffness(load)
        slider = ss.PulledMass(mass=1.0, stiffness=k, speed=1e-6, friction=law, load=load)  # light: its swing takes 0.3 ms
        less = 1e-6 * 0.6 * load / k  # how much shorter the spring is than in steady sliding
        run = ss.solve(slider, duration=200.0, start={"v": 1e-6, "x": less - 0.6 * load / k}, rtol=1e-8)
        # without inertia and for small changes: s' = -w, k s = N (a w/v0 + b f), f' = -(v0/Dc) (f + w/v0)
        speed = (k / load / law.a * 1e-6, -law.b / law.a * 1e-6)
        A = np.array([[-speed[0], -speed[1]], [-speed[0] / law.Dc, -(1e-6 + speed[1]) / law.Dc]])
        for t in (10.0, 50.0, 120.0, 200.0):
            small = speed @ (expm(A * t) @ (-less, 0.0))
            assert run.at(t)["v"] - 1e-6 == pytest.approx(small, abs=1e-3 * abs(speed[0] * less) * math.exp(0.5 * np.trace(A) * t))
        assert (np.trace(A) > 0) == (part < 1)


@each_row("evolution", ["aging", "slip"])
def test_a_contact_that_nobody_has_moved_is_in_the_state_of_steady_sliding_at_the_reference_speed(evolution):
    law = ROCK.replace(evolution=evolution)
    assert law.rate(law.v0, law.start(10.0), 10.0) == pytest.approx(0.0, abs=1e-12 * law.v0 / law.Dc)
    assert law.force(law.v0, law.start(10.0), 0.0, 10.0) == pytest.approx(0.6 * 10.0, rel=1e-6) == law.steady(law.v0, 10.0)


def test_numbers_of_a_rock_that_are_none_are_told():
    with pytest.raises(ss.InputError, match=r'evolution = "healing"|evolution = .healing.; allowed is "aging" or "slip"'):
        ROCK.replace(evolution="healing")
    with pytest.raises(ss.InputError, match=r"a = 0\.001 is less than mu0/300"):
        ROCK.replace(a=0.001)


def force_of(law, k, V, load, u, z, x, t):
    return k * (V * t - x) - law.a * load * math.asinh(0.5 * u / law.v0 * math.exp((law.mu0 + law.b * z) / law.a))


def earthquakes_by_scipy(law, k, m, V, load, end, start):
    """The instants at which the slider passes ten times the speed of its pull, by LSODA on the logarithm of its velocity."""

    def slope(t, y):
        u, z, x = V * math.exp(y[0]), y[1], y[2]
        r = u / law.v0
        rate = math.exp(-z) - r if law.evolution == "aging" else -r * (math.log(r) + z)
        return [force_of(law, k, V, load, u, z, x, t) / (m * u), rate * law.v0 / law.Dc, u]

    def fast(t, y):
        return y[0] - math.log(10.0)

    fast.direction = 1
    options = dict(method="LSODA", rtol=1e-10, atol=[1e-10, 1e-10, 1e-14], max_step=2.0)
    return solve_ivp(slope, (0.0, end), start, events=fast, **options).t_events[0]


@pytest.mark.parametrize("evolution", [pytest.param("aging", marks=pytest.mark.slow), "slip"])
def test_earthquakes_below_the_critical_stiffness_recur_as_scipy_says(evolution):
    law, load, V = ROCK.replace(evolution=evolution), 1.0, 1e-6
    k = 0.3 * law.critical_stiffness(load)
    slider = ss.PulledMass(mass=1e-3, stiffness=k, speed=V, friction=law, load=load)
    stretched = -0.6 * load / k
    run = ss.solve(slider, duration=END, start={"v": V, "x": stretched, "z": 0.5}, rtol=1e-9)
    t = np.linspace(0.0, END, 200_001)
    v = run.at(t)["v"]
    ups = np.flatnonzero((v[:-1] < 10 * V) & (v[1:] >= 10 * V))
    quakes = [brentq(lambda s: float(run.at(s)["v"]) - 10 * V, t[i], t[i + 1], xtol=1e-12) for i in ups]
    others = earthquakes_by_scipy(law, k, slider.mass, V, load, END, [0.0, 0.5, stretched])
    assert len(quakes) == len(others) >= 3
    # each has some thousand steps in a cycle: ours to 1e-9, LSODA's to 1e-10; LSODA is the worse of the two, 8e-9 from our own limit
    assert np.diff(quakes) == pytest.approx(np.diff(others), rel=1e-6)


def test_a_contact_under_a_force_below_friction_creeps_from_rest_ever_slower():
    """From v = 0: at constant force F the velocity is 2 v0 sinh(F/aN) exp(-(mu0 + b z)/a), and z the logarithm of the time of rest."""
    law = ss.friction.RateState.example()
    push = ss.ForcedOscillator(mass=1.0, stiffness=0.0, damping=0.0, force=0.0, omega=2 * math.pi, friction=law, load=1.0, bias=0.05)
    run = ss.solve(push, periods=40, rtol=1e-8)
    for t in (0.01, 1.0, 40.0):
        z = math.log1p(law.v0 * t / law.Dc)  # of the aging law at rest; slip adds nothing that can be seen: 1e-8 of Dc
        assert run.at(t)["z"] == pytest.approx(z, abs=1e-6)
        assert run.at(t)["v"] == pytest.approx(2 * law.v0 * math.sinh(0.05 / law.a) * math.exp(-(law.mu0 + law.b * z) / law.a), rel=1e-4)
        assert run.at(t)["friction_force"] == pytest.approx(0.05, rel=1e-6)


def test_lanes_of_creeping_contacts_are_the_single_runs():
    push = ss.ForcedOscillator(
        mass=1.0, stiffness=0.0, damping=0.0, force=0.02, omega=2 * math.pi, friction=ss.friction.RateState.example(), load=1.0,
        bias=np.array([0.03, 0.05]),
    )  # fmt: skip
    many = ss.solve(push, periods=10, settle=5, rtol=1e-8)
    for i, bias in enumerate((0.03, 0.05)):
        one = ss.solve(push.replace(bias=bias), periods=10, settle=5, rtol=1e-8)
        assert ss.mean_velocity(many)[i] == pytest.approx(ss.mean_velocity(one), rel=1e-6)


def test_friction_of_a_rock_is_odd_and_no_number_of_it_is_beyond_a_float():
    for v in (0.0, 1e-30, 1e-6, 10.0):
        for z in (-30.0, 0.0, 40.0):
            assert ROCK.force(-v, z, 0.0, 2.0) == -ROCK.force(v, z, 0.0, 2.0)
            assert math.isfinite(ROCK.force(v, z, 0.0, 2.0))
            if v:  # mu0 + a ln(v/v0) + b z, as the textbooks have it, where that is a force
                mu = 0.6 + ROCK.a * math.log(v / ROCK.v0) + ROCK.b * z
                assert mu < 5 * ROCK.a or ROCK.force(v, z, 0.0, 2.0) == pytest.approx(2.0 * mu, rel=1e-4)


def test_the_bench_takes_rate_and_state_from_rest():
    found = ss.bench(ss.friction.RateState.example(), experiments=["steady", "lag", "drift"])
    assert found.numbers["drift"] > 0  # it creeps on, however little
    assert found.numbers["lag"] > 0


def test_the_judge_goes_the_same_way_from_rest():
    """Radau on the law in plain Python, whose errors of slow velocities are measured against the creep velocity too."""
    law = ss.friction.RateState.example()
    push = ss.ForcedOscillator(
        mass=1.0, stiffness=0.0, damping=0.0, force=0.02, omega=2 * math.pi, friction=law, load=1.0, bias=0.05
    )  # fmt: skip
    shaken = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, incline="gravity").replace(friction=law)
    for model in (push, shaken):
        ours, judged = (ss.solve(model, periods=1, settle=0, method=method, rtol=1e-6) for method in ("rodas5p", "radau"))
        assert float(ours.x[-1]) == pytest.approx(float(judged.x[-1]), rel=1e-5)  # a hundred steps to 1e-6, of which few are as bad


def _by_logarithms(stage, rtol):
    """Position after one period, by Radau steps on s = arsinh(v/creep), in which the force is a N s: no velocity is too small for it."""
    law, motion, N = stage.friction, stage.along, stage.load

    def right(t, y):
        s, phi, _ = y
        creep = math.log(2 * law.v0) - (law.mu0 + law.b * phi) / law.a
        size = math.exp(min(abs(s) + creep, 50.0)) / 2
        slip, slope = math.copysign(size, s) * -math.expm1(-2 * abs(s)), size * (1 + math.exp(-2 * abs(s)))
        age = (math.exp(-phi) - abs(slip) / law.v0) * law.v0 / law.Dc
        speeds_up = stage.force / stage.mass - law.a * N * s / stage.mass - motion.acceleration(t)
        return [speeds_up / slope + law.b / law.a * age * math.tanh(s), age, slip + motion.velocity(t)]

    start = math.asinh(-motion.velocity(0.0) / (2 * law.v0 * math.exp(-law.mu0 / law.a)))
    found = solve_ivp(right, (0, stage.period), [start, 0.0, 0.0], "Radau", rtol=rtol, atol=[1e-8, 1e-8, 1e-16])
    assert found.success, found.message
    return found.y[2, -1]


@pytest.mark.slow
def test_a_stage_that_sticks_and_slips_follows_the_law_in_logarithms_of_velocity():
    """The slip is a difference here, and proportional friction below 1e-9 of the velocity scale lets it be off by as much."""
    law = ss.friction.RateState(mu0=0.2, a=0.012, b=0.018, Dc=1e-6, v0=1e-4)
    stage = ss.MovingTrack(mass=0.05, along=ss.Harmonic(amplitude=2e-5, omega=600.0), friction=law, load=5.0, force=0.1)
    unit = stage.velocity_scale * stage.period
    assert float(ss.solve(stage, periods=1, rtol=1e-9).at(stage.period)["x"]) == pytest.approx(_by_logarithms(stage, 1e-8), abs=1e-8 * unit)


@pytest.mark.slow
def test_creep_that_is_lost_in_rounding_does_not_stop_a_run():
    """Static friction 45 times the direct effect: a creep of 1e-20 of the velocities."""
    law = ss.friction.RateState(mu0=0.9, a=0.02, b=0.03, Dc=1e-6, v0=1e-3)
    for force in (0.0, 2.0):
        stage = ss.MovingTrack(
            mass=0.05, along=ss.Harmonic(amplitude=2e-5, omega=np.array([400.0, 900.0])), friction=law, load=5.0, force=force
        )
        assert ss.solve(stage, periods=5).status_counts == {"finished": 2}
