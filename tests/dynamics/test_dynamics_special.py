"""Special points of branches with answers from elsewhere: Neimark-Sacker points, and grazings of a dynamic law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stickslip as ss
from stickslip.maths import sin

W, CUBIC = 0.6, 0.1


@dataclass(frozen=True)
class Fed:
    """Friction that feeds slow motion and brakes fast one: Rayleigh's oscillator, R = -a v + b v^3."""

    a: float
    b: float
    states = 0

    def rate(self, v, z, load):
        """No inner state."""
        return ()

    def force(self, v, z, zdot, load):
        """R [N]."""
        return -self.a * v + self.b * v**3


def fed(a):
    return ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.0, force=1.0, omega=W, friction=Fed(a, CUBIC))


@pytest.mark.slow
def test_neimark_sacker_points_are_where_the_flow_keeps_areas():
    """Determinant of the flow = exp(integral of a - 3 b v^2): a pair passes the unit circle where a = 3 b <v^2>, by another integrator."""
    b = ss.continuation(fed, parameter="a", start=0.05, stop=0.2)
    assert [s.kind for s in b.special] == ["neimark-sacker"]
    _, a, orbit = b.special[0]
    np.testing.assert_allclose(abs(orbit.multipliers), 1.0, atol=1e-9)
    assert np.all(abs(np.imag(orbit.multipliers)) > 0.1) and "rotates by 0.336" in orbit.notes[0]
    np.testing.assert_allclose(orbit.multipliers, orbit.differences, atol=1e-6)

    def rates(t, y):
        x, v = y[:2]
        P = y[2:6].reshape(2, 2)
        J = np.array([[0.0, 1.0], [-1.0, a - 3 * CUBIC * v * v]])
        return [v, -x + a * v - CUBIC * v**3 + sin(W * t), *(J @ P).ravel(), v * v]

    T = 2 * np.pi / W
    end = solve_ivp(rates, (0, T), [*orbit.state, 1, 0, 0, 1, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(end[:2], orbit.state, atol=1e-10)
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(end[2:6].reshape(2, 2))), np.sort_complex(orbit.multipliers), atol=1e-8)
    assert a == pytest.approx(3 * CUBIC * end[6] / T, abs=1e-9)
    assert [bool(s) for s in b.points.stable.values[[0, -1]]] == [True, False]


def test_a_neimark_sacker_point_of_a_linear_oscillator():
    """Without the force and the cubic term the multipliers are exp((a/2 +- i sqrt(1 - a^2/4)) T): unit circle at a = 0."""
    free = lambda a: ss.ForcedOscillator(1.0, 1.0, 1.0, W, Fed(a, 0.0))  # noqa: E731
    b = ss.continuation(free, parameter="a", start=-0.2, stop=0.1, step=0.2)
    assert [s.kind for s in b.special] == ["neimark-sacker"] and b.special[0].value == pytest.approx(0.0, abs=1e-10)
    assert "Neimark-Sacker" in ss.plot.continuation(b, "x").get_legend_handles_labels()[1]
    for a, orbit in zip(b.values, b.orbits, strict=True):
        exact = np.exp((a / 2 + 1j * np.sqrt(1 - a * a / 4)) * 2 * np.pi / W)
        np.testing.assert_allclose(np.sort_complex(orbit.multipliers), np.sort_complex([exact, exact.conjugate()]), atol=1e-7)


def dip(amplitude):
    """The lowest peak of v in the last of many periods, by brute force: negative peaks are not motion forwards [m/s]."""
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude), periods=30, rtol=1e-10)
    T = run.period_time
    t = run.strobe_times[-2] + np.linspace(0.0, T, 40_001)[:-1]
    v = run.at(t)["v"]
    inner = (v > np.roll(v, 1)) & (v >= np.roll(v, -1)) | (v < np.roll(v, 1)) & (v <= np.roll(v, -1))
    i = np.flatnonzero(inner)
    i = i[np.argmin(abs(v[i]))]
    a, b, c = v[i - 1], v[i], v[(i + 1) % len(v)]
    return float(b - (a - c) ** 2 / (8 * (a - 2 * b + c)))


def test_a_grazing_of_a_bristle_by_brute_force():
    """Where an extremum of v just touches zero: two of four reversals are lost. Located to 1e-6 of the range of the branch."""
    start, stop = 4.15e-4, 4.25e-4
    b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=start, stop=stop, tilt_deg=1.7, step=0.2)
    ((_, value, orbit),) = [s for s in b.special if s.kind == "grazing"]
    assert "4 reversals in a motion period before, 2 after" in orbit.notes[0]
    scanned = brentq(dip, start, stop, xtol=1e-14)
    assert value == pytest.approx(scanned, abs=2e-6 * (stop - start) + 1e-11)
    counts = [
        len(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=A), periods=1, settle=0, rtol=1e-10, start=orbit.start).events)
        for A in (start, stop)
    ]
    assert counts[0] != counts[1]
