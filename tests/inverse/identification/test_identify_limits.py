"""Static friction is not below kinetic friction: a search never proposes it, and finds laws without an excess of static friction."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.inverse.identification.force_problem import DrivenProblem
from stickslip.inverse.identification.law_forces import driven_force
from stickslip.inverse.identification.motions import PrescribedMotion
from stickslip.inverse.identification.parameters import parameters
from stickslip.inverse.identification.search import multistart, starting_points
from stickslip.inverse.identification.uncertainty import faults

RIG = ss.presets.piezo_rig
BRISTLES = dict(sigma0=1e5, sigma1=0.0, sigma2=0.0, v_s=1e-3)
MU, STATIC = ({name: (0.05, 1.0) for name in names} for names in (("mu_plus", "mu_minus"), ("f_plus", "f_minus")))
HOW = dict(tilt_deg=2.0, amplitude=5e-4, law="lugre")
LIMITED = {
    "both free": (ss.LuGre, MU | STATIC, BRISTLES, 1),
    "static known": (ss.LuGre, MU, BRISTLES | dict(f_plus=0.3, f_minus=0.4), 1),
    "kinetic known": (ss.LuGre, STATIC, BRISTLES | dict(mu_plus=0.3, mu_minus=0.4), 1),
    "folded": (RIG, {"mu0": (0.05, 0.5), "f0": (0.05, 0.8)}, HOW, 1),
    "logarithms, less room for the static one": (RIG, {"mu0": (0.05, 0.5, "log"), "f0": (0.05, 0.3, "log")}, HOW, 1),
    "one static for each record": (RIG, {"mu0": (0.05, 0.5), "f0[:]": (0.05, 0.3)}, HOW, 2),
}


def sines(law, noise=0.02):
    t = np.linspace(0, 2, 1500)
    x = 2e-4 * np.sin(2 * np.pi * t) + 4e-5 * np.sin(2 * np.pi * 5 * t)
    m = PrescribedMotion(t, np.concatenate([[0.0], np.diff(x) / np.diff(t)]), np.full(len(t), 10.0), np.zeros(len(t)), 0, False, "")
    F = driven_force(law, m)[:, 0] + np.random.default_rng(3).normal(scale=noise, size=len(t))
    return ss.Record.of(t, {"x [m]": x, "F [N]": F})


@each_row("kind", LIMITED)
def test_every_place_of_a_multistart_is_possible_and_has_its_coordinates_back(kind):
    make, free, known, count = LIMITED[kind]
    of = parameters(make, free, None, known, count)
    inner = multistart(len(of.free), 16, 0)
    assert any(of.models(place) is None for place in inner)  # without coordinates of its own
    places = starting_points(of, 16, 0)
    assert all(of.models(place) is not None for place in places)
    assert np.allclose([of.limits.inner(place) for place in places], inner, rtol=0, atol=1e-12)
    held = of.only({of.names[0]: float(of.free[0].outer(places[3][0]))})
    assert all(held.models(place) is not None for place in starting_points(held, 8, 0))


@each_row("kind", LIMITED)
def test_derivatives_of_the_place_by_the_coordinates_are_those_of_differences(kind):
    make, free, known, count = LIMITED[kind]
    limits, h = parameters(make, free, None, known, count).limits, 1e-6
    for inner in np.random.default_rng(1).uniform(0.05, 0.95, (8, len(free) + count - 1)):
        seen = [(limits.point(inner + h * e) - limits.point(inner - h * e)) / (2 * h) for e in np.eye(len(inner))]
        assert np.allclose(limits.slopes_of_point(inner).T, seen, rtol=0, atol=1e-8)  # h² and rounding over h


def test_a_law_that_takes_less_static_friction_has_no_limit():
    """What a law allows is told by the law, not by the names of its numbers."""
    of = parameters(lambda **n: ss.Coulomb(n["mu"], n["mu"], 2 * n["mu"] + n["f"], None), {"mu": (0.1, 0.5), "f": (0.0, 0.5)}, None, {}, 1)
    assert len(of.limits.slopes) == 0


def test_a_search_never_proposes_less_static_than_kinetic_friction(monkeypatch):
    """A law without an excess of static friction, at the edge of what is possible: it is found, and nothing beyond the edge is asked."""
    truth = {"mu_plus": 0.2, "mu_minus": 0.25, "f_plus": 0.2, "f_minus": 0.25}
    asked, own = [], DrivenProblem.ends

    def noted(self, places, readings):
        asked.extend(self.parameters.models(place) is not None for place in places)
        return own(self, places, readings)

    monkeypatch.setattr(DrivenProblem, "ends", noted)
    fit = ss.identify(
        sines(ss.Stribeck(**truth, v_s=5e-4)), ss.Stribeck, free=MU | STATIC, v_s=5e-4, load=10.0, starts=8, sensor={"gain": 1.0}
    )
    assert len(asked) > 50 and all(asked)
    assert all(abs(fit.values[name] - value) < max(4.5 * fit.errors[name], 1e-3) for name, value in truth.items())
    edge = [name for name in STATIC if fit.values[name] < fit.values[name.replace("f_", "mu_")] * (1 + 1e-4)]
    said = [warning for warning in fit.warnings if "ends at its bound" in warning]
    assert len(said) == len(edge) > 0 and all(any(name in warning for warning in said) for name in edge)
    assert not faults(fit)  # noise has moved it there, so that the law is not blamed


@pytest.mark.slow
@pytest.mark.parametrize("law", ["coulomb-static", "lugre"])
def test_intervals_hold_the_truth_where_static_friction_is_the_kinetic_one(law):
    """Ten records each: 95 % of ten are below seven once in a thousand."""
    how = dict(tilt_deg=2.0, amplitude=6e-4, law=law)
    held = 0
    for seed in range(10):
        record = ss.virtual_rig(RIG(mu0=0.17, f0=0.17, **how), noise=3e-3, seed=seed)
        fit = ss.identify(record, RIG, free={"mu0": (0.05, 0.5), "f0": (0.05, 0.8)}, starts=8, **how)
        low, high = fit.interval("mu0")
        held += low <= 0.17 <= high
    assert held >= 7
