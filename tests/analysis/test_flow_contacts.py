"""What the contacts of a flow do: the work of friction by two ways, stretches of sticking, and what a flow is checked and drawn with."""

import numpy as np
import pytest

import stickslip as ss
from every import every_machine
from rows import each_row

BELT, DEN_HARTOG, VAN_DER_POL = (every_machine[name][0] for name in ("a flow with contacts", "a SwitchingFlow", "a flow without a period"))


def cycle(flow, long, **start):
    """A run of one cycle that begins on it."""
    run = ss.solve(flow, duration=long, start=start or None)
    return ss.solve(flow, duration=ss.motion(run).duration, start=dict(zip(run.names, run.state, strict=True)), mode=run.end_mode)


def test_friction_of_a_belt_takes_what_its_motor_gives():
    """Over a cycle of v' = -k x - R the work of R on the block is zero, and that of the belt is u times the integral of k x."""
    run = cycle(BELT, 200.0)
    t, weights = np.polynomial.legendre.leggauss(10)
    h, T = 0.5 * np.diff(run.nodes), float(run.nodes[-1])
    x = run.at((run.nodes[:-1, None] + h[:, None] * (1.0 + t)).ravel())["x"].reshape(-1, 10)
    taken = ss.energy(run)
    assert taken.friction[0] == pytest.approx(0.1 * 4.0 * float((x @ weights) @ h), rel=1e-12 * len(h) * 10) and T > 1.0
    assert taken.friction_of["belt"][0] == taken.friction[0] > 0.0


def test_works_at_two_contacts_and_of_each_period():
    """Two pads on one driven block: each takes its share, in every period of the forcing."""
    pad = lambda mu: ss.machines.FlowContact(lambda t, y: y[1], ss.Coulomb(mu_plus=mu, mu_minus=mu), 2.0)  # noqa: E731
    law = ss.LuGre(0.2, 0.2, 0.3, 0.3, v_s=0.1, sigma0=100.0, sigma1=0.5, sigma2=0.0)
    lugre = ss.machines.FlowContact(lambda t, y: y[1], law, 1.0)
    push = lambda t, y, R: (y[1], 3.0 * ss.maths.sin(t) - R.dry - R.bristles)  # noqa: E731
    flow = ss.SwitchingFlow(push, None, 2 * np.pi, states=("x", "v"), contacts={"dry": pad(0.1), "bristles": lugre})
    run = ss.solve(flow, periods=12, settle=8)
    taken = ss.energy(run)
    t = np.linspace(10 * 2 * np.pi, 11 * 2 * np.pi, 200_001)
    at = run.at(t)
    for name in flow.contacts:
        power = at[f"friction_force_{name}"] * at[f"slip_{name}"]
        assert taken.friction_of[name][10] == pytest.approx(np.trapezoid(power, t), rel=1e-6)
    assert len(taken.friction) == 12 and taken.settle == 8 and set(taken.works) == {"friction of dry", "friction of bristles"}
    rows = ss.plot.contacts(run, periods=1)
    assert [label.get_text() for label in rows.get_yticklabels()] == ["dry", "bristles"]
    assert [line.get_label() for line in ss.plot.forces(run).lines[1:]] == ["dry", "bristles"]


def test_lines_of_a_cycle_are_the_fourier_series_of_its_states():
    """Of van der Pol's oscillator with a stop, which has no drive, and of Den Hartog's, which has one: against a dense sampling."""
    for run, name in ((ss.solve(VAN_DER_POL, duration=200.0, start={"x": 0.5}), "x"), (ss.solve(DEN_HARTOG, periods=200), "v")):
        lines, motion = ss.dynamics.spectrum(run, name, harmonics=8), ss.motion(run)
        T, n = motion.duration, 1 << 16
        t = run.nodes[-1] - T + (np.arange(n) + 0.5) * T / n
        sums = [abs(np.mean(run.at(t)[name] * np.exp(-2j * np.pi * k * t / T))) for k in (0, motion.period, 3 * motion.period)]
        orders = lines.amplitude.sel(order=[0.0, 1.0, 3.0]).values * [1.0, 0.5, 0.5]
        assert orders == pytest.approx(sums, abs=1e-4 * float(lines.amplitude.max()))
    assert lines.attrs["of"] == "drive" and ss.plot.spectrum(lines).get_xlabel() == "frequency / frequency of the drive"


def test_sections_of_a_flow_have_its_states():
    run = ss.solve(VAN_DER_POL, duration=100.0, start={"x": 0.5})
    points = ss.dynamics.poincare(run, on="v", value=0.0, direction=1)
    assert np.max(abs(points.v)) < 1e-12 and set(points.data_vars) == {"time", "x", "v", "mode"}
    assert np.diff(points.time[-3:]) == pytest.approx([ss.motion(run).duration] * 2, rel=1e-6)
    forced = ss.solve(DEN_HARTOG, periods=20)
    quarter = ss.dynamics.strobe(forced, phase=0.25)
    assert quarter.x.values == pytest.approx(forced.at(quarter.time.values)["x"]) and quarter.phase.values == pytest.approx(0.25)


def test_a_check_of_a_flow_counts_the_digits_on_which_scipy_agrees():
    sure = ss.check(BELT, duration=8.0)
    by_scipy = sure.judges[-1].end
    assert sure.digits >= 10 and all(abs(by_scipy[name] - sure.end[name]) < 1e-10 for name in ("x", "v"))
    assert "digits of the states after 8" in str(sure) and [judge.counts for judge in sure.judges] == [True, False, True]
    assert sure.plot().get_xlabel() == "difference in the states, as a part of their size"


@each_row(
    ("asked", "said"),
    [
        (lambda run: ss.energy(run), "a flow without contacts has no forces and no masses, and so no energy; type ss.SwitchingFlow"),
        (lambda run: ss.plot.contacts(run), r"no modes of contacts; type ss.plot.states\(run\)"),
        (lambda run: ss.plot.forces(run), r"no friction force; type ss.plot.states\(run\)"),
        (lambda run: ss.plot.velocity(run), r"no velocity of one; type ss.plot.states\(run\)"),
        (lambda run: ss.dynamics.strobe(run), r"no phase at which it could be looked at; type ss.dynamics.poincare\(run, on='x'\)"),
        (lambda run: ss.dynamics.spectrum(run), "does not repeat within the run, so it has no lines; type ss.solve"),
        (lambda run: ss.dynamics.poincare(run, on="w"), "on = 'w' is not a column .* known: x, v"),
        (lambda run: ss.dynamics.poincare(run, on="x", settle=3), "settle = 3 is a number of drive periods, and this run has none"),
        (lambda run: ss.check(VAN_DER_POL), "has no period, so periods does not say how long to run"),
    ],
)  # fmt: skip
def test_what_a_flow_lacks_is_said_with_what_to_type(asked, said):
    with pytest.raises(ss.InputError, match=said):
        asked(ss.solve(VAN_DER_POL, duration=3.0, start={"x": 0.5}))
