"""Chains by their names: plain masses, gaits, and what is refused."""

import inspect
from math import pi

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.models.drives.shifted import Shifted

THIRD = 2 * pi / 3


def worm(mu_plus, mu_minus, drive, lag=THIRD, mass=0.05):
    bodies = ss.machines.Bodies(mass=mass, count=3, friction=ss.Coulomb(mu_plus=mu_plus, mu_minus=mu_minus))
    return ss.Chain(bodies, link=ss.machines.Gait(drive, lag=lag, length=0.02))


SLOW, FAST = ss.Harmonic(amplitude=2e-3, frequency=2.0), ss.Harmonic(amplitude=2e-3, frequency=6.0)
LOPSIDED = ss.MultiHarmonic(frequency=5.0, amplitudes=(2e-3, 7e-4), phases=(pi / 2, pi / 2 + 0.6))  # a [cos + .35 cos(2 . + .6)]
ROWS = {
    "one mass always holds: 3 a f": (worm(0.1, 0.3, SLOW), 0.012),
    "below mu_minus = 2 mu_plus": (worm(0.15, 0.25, FAST), 0.016577138514499),
    "as much friction both ways": (worm(0.2, 0.2, LOPSIDED), 0.011084435192200),
    "the wave reversed": (worm(0.2, 0.2, LOPSIDED, lag=-THIRD), -0.011084435192200),
    "an antiperiodic wave and the same friction": (worm(0.2, 0.2, FAST), 0.0),
}


@pytest.mark.parametrize(("chain", "V"), ROWS.values(), ids=ROWS)
def test_worms_move_as_they_should(chain, V):
    assert ss.mean_velocity(ss.solve(chain, periods=60)) == pytest.approx(V, abs=1e-14)
    assert ss.mean_velocity(ss.solve(chain, periods=60, keep="summary")) == pytest.approx(V, abs=1e-14)


def test_the_judge_agrees_on_a_worm():
    run = ss.solve(ROWS["the wave reversed"][0], periods=6, method="dop853", rtol=1e-12)  # feet that hold forget the start
    assert ss.mean_velocity(run) == pytest.approx(-0.0110844351922, abs=2e-12)


def test_a_sawtooth_gait_that_begins_elsewhere_is_what_the_judge_says():
    """Shifts of the drive and of the lags make more than a period: the feet knew a wrong velocity at the start, and slid the wrong way."""
    gait = Shifted(ss.drives.Sawtooth(stroke=2.44e-3, rise=0.116, fall=0.084), -0.9)
    for chain in (worm(0.1, 0.2, gait), worm(0.1, 0.2, gait, lag=-THIRD)):
        judged = ss.solve(chain, periods=3, method="dop853", rtol=1e-12)
        assert ss.solve(chain, periods=3).v[-1] == pytest.approx(judged.v[-1], abs=1e-10)


def test_distances_are_those_of_the_gait_at_any_lag():
    lag, drive = 5.0, LOPSIDED  # beyond a half period: of the fourth distance it is more than two periods
    bodies = ss.machines.Bodies(mass=0.05, count=5, friction=ss.Coulomb(0.1, 0.2))
    run = ss.solve(ss.Chain(bodies, link=ss.machines.Gait(drive, lag=lag, length=0.02)), periods=3)
    for j in range(4):
        told = 0.02 + drive.position(run.t + 10 * drive.period - j * lag / drive.omega)
        assert run.x[:, j] - run.x[:, j + 1] == pytest.approx(told, abs=1e-15)


def test_one_mass_for_all_is_one_number_and_a_tuple_is_one_for_each():
    chain = ROWS["below mu_minus = 2 mu_plus"][0]
    many = ss.sweep(chain, **{"modules.mass": [0.05, 0.5]}, periods=20)  # all masses together change nothing
    assert many.mean_velocity.values == pytest.approx([0.016577138514499] * 2, abs=1e-13)
    uneven = ss.sweep(worm(0.15, 0.25, FAST, mass=(0.05, 0.05, 0.05)), **{"modules.mass.0": [0.05, 0.5]}, periods=40)
    assert uneven.mean_velocity.values[0] == pytest.approx(0.016577138514499, abs=1e-13)
    assert abs(np.diff(uneven.mean_velocity.values)) > 1e-3


def test_worms_stand_in_files_and_older_files_of_chains_are_read():
    for chain in (ROWS["the wave reversed"][0], ss.Chain.example()):
        text = chain.to_toml()
        assert ss.Chain.from_toml(text) == chain
        assert ss.Chain.from_toml(text.replace('kind = "robot"\n', "")) == chain


@each_row(
    ("make", "words"),
    [
        (lambda: ss.Chain((), link=ss.machines.Rigid()), r"modules = \(\); allowed is a tuple of two robots or more.*ss.machines.Bodies"),
        (
            lambda: ss.machines.Bodies([0.1, 0.2], 2, ss.Coulomb(0.1, 0.2)),
            r"a list; a tuple means one for each part.*type mass=\(0.1, 0.2\)",
        ),
        (lambda: ss.machines.Bodies((0.1, 0.2), 3, ss.Coulomb(0.1, 0.2)), "mass has 2 numbers for 3 bodies"),
        (lambda: ss.machines.Bodies(0.1, 1, ss.Coulomb(0.1, 0.2)), "count = 1; allowed is a whole number of bodies from 2"),
        (
            lambda: ss.Chain(ss.machines.Bodies.example(), link=ss.machines.Rigid(), phases=(0.0,) * 3),
            "plain bodies have none; a Gait has a lag",
        ),
        (lambda: ss.machines.Gait(3.0, lag=1.0), "drive = 3.0; allowed is a drive"),
        (
            lambda: ss.Chain(ss.Chain.example().modules, link=ss.machines.Gait(SLOW, lag=1.0)),
            r"link has the period 0.5 s and modules\[0\] 0.0305.*one common period",
        ),
    ],
)
def test_what_is_no_chain_says_what_to_type(make, words):
    with pytest.raises(ss.InputError, match=words):
        make()


@pytest.mark.parametrize("count", [3, 4])
def test_feet_that_move_alike_but_for_rounding_rest_and_slip_together(count):
    # lags of pi, 2 pi/3 and pi/2 make distances of which some add up to zero, or pass zero together
    rng, n = np.random.default_rng(7), 300
    sizes = {"amplitude": 10 ** rng.uniform(-3.5, -2, n), "frequency": 10 ** rng.uniform(-1, 1.5, n)}
    lags = rng.choice([np.pi, 2 * np.pi / 3, np.pi / 2, np.pi / 3], n)
    worms = ss.presets.worm(count=count, lag=lags, mu_minus=rng.choice([0.1, 0.15, 0.2, 0.3, 0.5], n), **sizes)
    assert ss.solve(worms, periods=20).status_counts == {"finished": n}


def test_the_judge_agrees_on_feet_that_move_alike():
    worm = ss.presets.worm(lag=np.pi, amplitude=2e-3, frequency=6.0, mu_minus=0.3)
    exact, judge = ss.solve(worm, periods=2), ss.solve(worm, periods=2, method="dop853")
    t = np.linspace(0.1, 1.9, 40) * worm.period
    assert np.max(abs(exact.at(t)["v"] - judge.at(t)["v"])) < 1e-9 * np.max(abs(exact.v))  # the judge's own tolerance is 1e-11
    x = exact.at(t)["x"]
    assert np.max(abs((x[:, 0] - x[:, 2]) - (x[0, 0] - x[0, 2]))) < 1e-15  # the first and the last foot are one


@each_row("preset", [ss.presets.two_modules, ss.presets.worm])
def test_presets_of_chains_have_the_numbers_that_they_name(preset):
    names = [name for name in inspect.signature(preset).parameters if name != "count"]
    for name in names:
        default = inspect.signature(preset).parameters[name].default
        assert ss.sweep(preset, periods=2, settle=1, **{name: [default, 1.1 * default]}).status.values.tolist() == [0, 0]


def unlike(phases):
    """M2j: modules that differ, of which V sees the sign of the phase."""
    one = ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude=6e-4, omega=65.4 * pi), ss.Coulomb(mu_plus=0.15, mu_minus=0.21))
    other = ss.Robot(0.08, 0.00948, ss.Harmonic(amplitude=5e-4, omega=65.4 * pi), ss.Coulomb(mu_plus=0.2, mu_minus=0.35))
    return ss.Chain((one, other), link=ss.Spring(stiffness=1200.0, damping=0.4), phases=phases)


def test_the_second_module_is_ahead_by_its_phase_and_not_behind():
    behind, ahead, later = ss.solve(unlike((np.array([0.0, 0.0, 1.0]), np.array([-1.0, 1.0, 0.0]))), periods=150).mean_velocity
    assert behind == pytest.approx(0.001331177341432, rel=1e-11) == later and abs(ahead - behind) > 1e-4


@pytest.mark.slow
def test_the_judge_agrees_on_modules_of_both_signs_of_phase():
    for phase in (-1.0, 1.0):
        judged = ss.solve(unlike((0.0, phase)), periods=30, settle=20, method="dop853", rtol=1e-12)
        assert ss.mean_velocity(ss.solve(unlike((0.0, phase)), periods=30, settle=20)) == pytest.approx(ss.mean_velocity(judged), rel=1e-9)
