"""A machine that goes on step by step is where `solve` is, whatever the steps, and goes on from a jump of an input as from any event."""

import dataclasses
import json
import math
import signal
from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from blocks import Row, row
from every import SHAKEN, every_machine
from rows import each_row
from stickslip.basics.fields import leaves
from stickslip.maths import where, within
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import parts_of
from stickslip.models.pushed import Pushed, force_names, pushed
from stickslip.models.switching_flow import is_flow
from stickslip.solvers.flow_engine import FlowStart, follow_flow
from stickslip.solvers.simulation import Simulation

#: Steps of laws without inner states are exact to rounding; those of others to this tolerance, which errors exceed by the growth of a
#: disturbance over the run.
RTOL = 1e-11
EXACT, DYNAMIC = 3e-13, 1e-8
LUGRE = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
STICTION = ss.Coulomb(0.02, 0.02, f_plus=0.03, f_minus=0.03)
ARM = ss.Joint(inertia=0.01, friction=STICTION, torque=0.0)
BALL = ss.SwitchingFlow(
    {0: lambda t, y, n: (y[1], -9.81)}, {0: (ss.Switch(lambda t, y, n: y[0], 0, lambda t, y, n: (0.0, -n.r * y[1])),)},
    numbers={"r": 0.5}, states=("height", "v"),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Walled(Row):
    """A row on a ground that is shaken, before a wall."""

    amplitude: float = 0.02
    period = 1.0

    def contacts(self):
        shaken = ss.Harmonic(amplitude=self.amplitude, frequency=1.0)
        return {name: dataclasses.replace(contact, on=shaken) for name, contact in super().contacts().items()}

    def stops(self):
        return {("b0", None): ss.Stop(gap=0.02, restitution=0.5)}


BRISTLES = ss.LuGre(0.5, 0.5, f_plus=1.0, f_minus=1.0, sigma0=1e3, sigma1=1.0, sigma2=0.0, v_s=0.25)
#: Every sort of machine, and rows of more contacts than equations are written out for where they go by tables.
BY_HAND = ss.SwitchingFlow(
    lambda t, y, R, n: (y[1], -50.0 * y[0] - R.belt),
    numbers={"speed": 0.05, "k": 1.0},
    states=("x", "v"),
    contacts={
        "belt": ss.machines.FlowContact(slip=lambda t, y, n: y[1] - n.speed, friction=ss.friction.GMS.example(), load=lambda t, y, n: n.k)
    },
)
STEPPED = {name: machine for name, (machine, *_) in every_machine.items()} | {
    "a row of blocks": row(40),
    "a flow that remembers": BY_HAND,
    "a row before a wall": Walled(row(17).offsets, spring=lambda k: ss.Spring(k, damping=0.3)),
}


def tolerance_of(name):
    return DYNAMIC if name in ("Chain, LuGre", "a flow that remembers") else EXACT


def cuts(end, count, seed):
    """Uneven instants up to the end."""
    return np.append(np.sort(np.random.default_rng(seed).uniform(0.0, end, count - 1)), end)


def length_of(machine):
    return 3.0 * machine.period if machine.period is not None else 6.0


def run_of(machine, start, method="auto"):
    span = {"periods": 3} if machine.period is not None else {"duration": 6.0}
    return ss.solve(machine, **span, start=start, method=method, **({} if is_flow(machine) else {"rtol": RTOL}))


#: Starts of flows, which without one begin where nothing moves.
STARTS = {
    "a SwitchingFlow": {"x": 1.0, "v": 0.0},
    "a flow without a period": {"x": 0.5, "v": 0.0},
    "a Filippov flow": {"prey": 0.8, "predator": 0.3},
}


def states_of(machine):
    return machine.names(len(machine.states) + len(machine.inner)) if is_flow(machine) else ("x", "v")


def missed(run, sim, begun=0.0):
    """The largest difference of a state from a run that began so late, in the size of its column."""
    names = states_of(sim.machine)
    at, state = run.at(sim.t - begun), sim.state
    sizes = {name: np.max(abs(run[name] if is_flow(sim.machine) else getattr(run, name))) for name in names}
    return max(float(np.max(abs(at[name] - state[name]))) / sizes[name] for name in names)


def assert_goes_as_solve_does(machine, tolerance, start=None):
    """Uneven steps and a run have the same states and events."""
    run, sim = run_of(machine, start), ss.simulation(machine, start, **({} if is_flow(machine) else {"rtol": RTOL}))
    worst, events = 0.0, []
    for instant in cuts(length_of(machine), 25, 7):
        sim.step(until=instant)
        events += sim.events
        worst = max(worst, missed(run, sim))
    assert worst < tolerance and (run.events or is_flow(machine))  # what a law of a flow remembers is no event
    assert [(type(e), getattr(e, "part", "")) for e in events] == [(type(e), getattr(e, "part", "")) for e in run.events]
    assert (
        np.allclose([e.t for e in events], [e.t for e in run.events], rtol=0.0, atol=1e-9 * length_of(machine)) and sim.status == "finished"
    )


@each_row("name", list(STEPPED))
def test_steps_of_any_length_are_the_run_of_solve_with_all_its_events(name):
    assert_goes_as_solve_does(STEPPED[name], tolerance_of(name), STARTS.get(name))


@pytest.mark.slow
def test_steps_of_a_row_under_a_law_with_inner_states_are_the_run_of_solve():
    assert_goes_as_solve_does(row(17, friction=BRISTLES), DYNAMIC)


# ---- an input that jumps ----
#: Machines on which a force jumps, on the first body; on the others a number of theirs does.
FORCED = ("Robot", "Chain, set-valued laws", "a machine without contacts")


def jump_of(name, machine):
    """An input that jumps, by its name, and the machine after it."""
    if name in FORCED:
        force, number = next(iter(force_names(machine).items()))
        return {force: 0.05}, pushed(machine).replace({number: 0.05})
    named = {
        "F": 0.1,
        "friction.f_plus": 0.9,
        "friction.mu_plus": 0.17,
        "link.stiffness": 900.0,
        "along.amplitude": 4.1e-4,
        "control.kp": 1.5,
        "gap": 1.15,
        "effort": 0.4,
        "k": 4.4,
    }
    jump = next({number: value} for number, value in named.items() if number in dict(leaves(machine)) | getattr(machine, "numbers", {}))
    return jump, machine.replace(jump)


@each_row("name", [name for name in STEPPED if name != "PulledMass"])  # which is never again where its time begins
def test_after_a_jump_of_an_input_it_goes_on_as_solve_does_from_there(name):
    machine, start = STEPPED[name], STARTS.get(name)
    (jump, after), end = jump_of(name, machine), length_of(machine)
    sim = ss.simulation(machine, start, **({} if is_flow(machine) else {"rtol": RTOL}))
    for instant in cuts(end, 9, 3):
        sim.step(until=instant)
    begun, worst = sim.t, 0.0
    if is_flow(machine):
        state = sim.state
        there = FlowStart(np.array([state[each] for each in states_of(machine)]), state["mode"], sim.t)
        leg = follow_flow(after, there, end, growth=False)
    else:
        run = run_of(after, sim.start)
    for instant in cuts(end, 12, 4):
        sim.step(until=begun + instant, inputs=jump)
        if not is_flow(machine):
            worst = max(worst, missed(run, sim, begun))
    if is_flow(machine):
        worst = max(abs(np.array([sim.state[each] for each in states_of(machine)]) - leg.state))
    assert worst < tolerance_of(name)
    assert sim.inputs[next(iter(jump))] == next(iter(jump.values()))


@dataclass(frozen=True, eq=False)
class Later(Pushed):
    """The force comes at an instant of the first of three periods."""

    instant: float = 0.0

    @property
    def period(self):
        return None if self.machine.period is None else 3 * self.machine.period

    @property
    def breaks(self):
        return (self.instant,) if self.period is not None else ()

    def come(self, t):
        return where((t if self.period is None else within(t, self.period)) < self.instant, 0.0, 1.0)

    def acceleration(self, t, x, v, R):
        return self.machine.acceleration(t, x, v, R - self.come(t) * self.applied[0])

    def forces(self, t, x, v):
        own, come = parts_of(self.machine).forces(t, x, v), self.come(t)
        return {name: own.get(name, 0.0) + come * force for name, force in zip(x, self.applied, strict=True)}


@each_row("name", ["Robot", "PulledMass", "a machine of your own", "LuGre"])
def test_within_a_period_it_goes_on_from_a_jump_as_the_judge_does(name):
    machine = LUGRE if name == "LuGre" else every_machine[name][0]
    instant, bodies = 0.377 * (machine.period or 2.0), machine_of(machine).mechanics.bodies
    force = next(iter(force_names(machine)))
    later = Later(machine, (0.1, *(0.0 for _ in bodies[1:])), instant)
    span = {"periods": 1} if machine.period is not None else {"duration": 6.0}
    judge = ss.solve(later, **span, method="radau" if name == "LuGre" else "dop853", rtol=1e-9)
    sim = ss.simulation(machine, rtol=RTOL)
    sim.step(instant)
    worst = missed(judge, sim)
    for more in cuts(length_of(machine) - instant, 9, 5):
        sim.step(until=instant + more, inputs={force: 0.1})
        worst = max(worst, missed(judge, sim))
    assert worst < 1e-7  # of the judge, whose tolerance is held within a step


# ---- back, and later ----
def stepped(sim, T, jump):
    """Some steps, one of them with a jump: the states at their ends."""
    return [str(sim.step(share * T, inputs=jump if k == 2 else None)) for k, share in enumerate((0.31, 0.07, 0.4, 1.3))]


@each_row("name", ["Robot", "Chain, LuGre", "a SwitchingFlow", "Joint", "a machine without contacts"])
def test_what_follows_a_snapshot_or_a_file_is_the_same_to_the_last_bit(name, tmp_path):
    machine = every_machine[name][0]
    jump, _ = jump_of(name, machine)
    sim, T = ss.simulation(machine), machine.period
    sim.step(0.613 * T, inputs=jump)
    before, path = sim.snapshot(), sim.save(tmp_path / "sim.json")
    inputs, first = sim.inputs, stepped(sim, T, {next(iter(jump)): 0.2})
    sim.restore(before)
    assert (sim.t, sim.inputs) == (before.t, inputs) and stepped(sim, T, {next(iter(jump)): 0.2}) == first
    loaded = Simulation.load(path, machine=None if name in ("Robot", "Joint", "Chain, LuGre") else machine)
    assert (loaded.t, loaded.inputs) == (before.t, inputs) and stepped(loaded, T, {next(iter(jump)): 0.2}) == first


def test_a_file_of_another_version_goes_on_from_its_state(tmp_path):
    machine = every_machine["Chain, set-valued laws"][0]
    sim = ss.simulation(machine)
    sim.step(0.7 * machine.period, inputs={"force on module 1": 0.05})
    table = json.loads(sim.save(tmp_path / "sim.json").read_text())
    (tmp_path / "other.json").write_text(json.dumps(table | {"kernel": "another", "lane": []}))
    loaded = Simulation.load(tmp_path / "other.json")
    for _ in range(5):
        there, here = loaded.step(0.4 * machine.period), sim.step(0.4 * machine.period)
    assert np.allclose(there["v"], here["v"], rtol=0.0, atol=1e-12) and loaded.t == sim.t


def test_a_file_that_is_none_or_damaged_or_of_another_machine_is_refused(tmp_path):
    path = ss.simulation(SHAKEN).save(tmp_path / "sim.json")
    table = json.loads(path.read_text())
    flow = ss.simulation(BALL, {"height": 1.0, "v": 0.0}).save(tmp_path / "ball.json")
    damage = {"time": -1.0, "periods": -5, "span": "long", "lane": table["lane"][1:], "state": [0.0], "t": None, "asked": {}, "numbers": {}}
    texts = [
        "",
        "[]",
        "{",
        "[" * 100_000,
        json.dumps({"stickslip_simulation": 99}),
        *(json.dumps(table | {k: v}) for k, v in damage.items()),
    ]
    for text in texts:
        (tmp_path / "bad.json").write_text(text)
        with pytest.raises(ss.InputError, match=r"load: .*bad\.json' (is damaged|holds no simulation|has format 99)"):
            Simulation.load(tmp_path / "bad.json")
    with pytest.raises(ss.InputError, match=r"body_mass = 0\.1 in the machine given, and 0\.06259 in"):
        Simulation.load(path, machine=SHAKEN.replace(body_mass=0.1))
    with pytest.raises(ss.InputError, match="holds a simulation of a Robot, and the machine given is a Joint"):
        Simulation.load(path, machine=ARM)
    with pytest.raises(ss.InputError, match="holds a simulation of a SwitchingFlow, which no file can hold; type"):
        Simulation.load(flow)
    with pytest.raises(ss.InputError, match=r"ends in '\.nc'; allowed is \.json"):
        ss.simulation(SHAKEN).save(tmp_path / "sim.nc")


# ---- what happens on the way ----
@each_row("name", ["PulledMass", "MovingTrack", "a machine without contacts", "a SwitchingFlow"])
def test_a_step_that_stops_at_events_stops_at_each_of_them(name):
    machine, start = every_machine[name][0], STARTS.get(name)
    run, sim, end = run_of(machine, start), ss.simulation(machine, start), length_of(machine)
    met = []
    while sim.t < end * (1 - 1e-12):
        sim.step(until=end, stop_at_events=True)
        assert not sim.events or abs(sim.events[-1].t - sim.t) < 1e-12 * end
        met += [event.t for event in sim.events]
    assert len(met) > 1 and np.allclose(met, [event.t for event in run.events], rtol=0.0, atol=1e-12 * end)


def test_a_contact_that_an_input_tears_off_slips_from_that_instant():
    sim = ss.simulation(ARM)
    sim.step(0.25, inputs={"torque on joint": 0.0299})
    assert sim.state["mode"] == 0 and not sim.events
    state = sim.step(0.5, inputs={"torque on joint": 0.05})
    assert [(event.t, event.kind) for event in sim.events] == [(0.25, "slip")]
    assert np.isclose(state["v"], 0.5 * (0.05 - 0.02) / 0.01, rtol=1e-14, atol=0.0) and np.isclose(sim.columns["friction_force"], 0.02)


def test_a_flow_with_a_contact_is_torn_off_by_its_belt_as_the_machine_is():
    block = every_machine["BlockOnBelt"][0]
    contact = ss.machines.FlowContact(slip=lambda t, y, n: y[1] - n.speed, friction=block.friction, load=1.0)
    field = lambda t, y, R, n: (y[1], -2.0 * y[0] - R.belt)  # noqa: E731
    flow = ss.SwitchingFlow(field, numbers={"speed": 0.1}, states=("x", "v"), contacts={"belt": contact})
    sims = ss.simulation(flow, {"x": 0.0, "v": 0.1}), ss.simulation(block, {"x": 0.0, "v": 0.1})
    for k, speed in enumerate((0.1, 0.1, 0.15, 0.15, 0.05)):
        states = [sim.step(0.7, inputs={"speed": speed}) for sim in sims]
        assert all(np.isclose(states[0][name], states[1][name], rtol=0.0, atol=1e-12) for name in ("x", "v")), k


def test_recorded_stretches_are_runs_with_the_forces_of_their_inputs():
    sim = ss.simulation(SHAKEN, record=True)
    for force in (0.0, 0.0, 0.1):
        sim.step(0.7 * SHAKEN.period, inputs={"force": force})
    first, second = sim.trajectories()
    whole = ss.solve(SHAKEN, periods=2)
    t = np.linspace(0.0, 1.4 * SHAKEN.period, 30)
    assert np.allclose(first.at(t)["v"], whole.at(t)["v"], rtol=0.0, atol=1e-13) and second.pieces.t[0] == first.pieces.t[-1]
    at = second.at(second.pieces.t[-1])
    assert np.isclose(at["acceleration"], second.model.acceleration(at["t"], at["x"], at["v"], at["friction_force"]))


def test_time_that_goes_on_without_a_period_is_that_of_one_long_run():
    belt = every_machine["BlockOnBelt"][0]
    run, sim = ss.solve(belt, duration=500.0), ss.simulation(belt)
    while sim.t < 500.0:
        sim.step(min(7.3, 500.0 - sim.t))
    assert missed(run, sim) < 1e-11


def test_a_step_that_cannot_be_made_says_so_and_loses_nothing():
    ball = ss.simulation(BALL, {"height": 1.0, "v": 0.0})
    state = ball.step(5.0)
    rest = math.sqrt(2 / 9.81) * (1 + 2 * 0.5 / (1 - 0.5))
    assert ball.status.startswith("its switches accumulate") and np.isclose(ball.t, rest, rtol=1e-9) and state["height"] < 1e-9
    vertical = ss.drives.VerticalVibration(ss.Harmonic(amplitude=6e-4, omega=200.0), amplitude=4e-3)
    lost = ss.simulation(ss.Robot(0.06, 0.01, vertical, ss.Coulomb(0.15, 0.21)))
    lost.step(1.0)
    at = lost.t
    assert lost.status.startswith("contact lost") and lost.events[-1].kind == "contact lost" and 0.0 < at < 1.0
    assert lost.step(1.0)["t"] == at


def test_ctrl_c_within_a_step_leaves_the_state_before_it():
    def interrupt(*_):
        raise KeyboardInterrupt

    sim = ss.simulation(LUGRE)
    sim.step(1e-3)
    state, before = str(sim.state), signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(KeyboardInterrupt):
            sim.step(1e5 * LUGRE.period)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    fresh = ss.simulation(LUGRE)
    fresh.step(1e-3)
    assert str(sim.state) == state and str(sim.step(2e-3)) == str(fresh.step(2e-3))


def wrong(make, **given):
    return lambda: make().step(**given)


@each_row(
    "call, said",
    [
        (wrong(lambda: ss.simulation(SHAKEN)), "neither of dt and until is given"),
        (wrong(lambda: ss.simulation(SHAKEN), dt=1.0, until=2.0), "dt and until are both given"),
        (wrong(lambda: ss.simulation(SHAKEN), dt=0.0), r"dt = 0\.0; allowed is a positive time"),
        (wrong(lambda: ss.simulation(SHAKEN), dt=1e-3, inputs={"fource": 1.0}), "there is no input 'fource'; did you mean 'force'"),
        (wrong(lambda: ss.simulation(SHAKEN), dt=1e-3, inputs={"force": [1.0]}), "allowed is one finite number, constant over the step"),
        (wrong(lambda: ss.simulation(SHAKEN), dt=1e-3, inputs={"body_mass": -1.0}), "body_mass = -1.0; allowed is a positive mass"),
        (lambda: ss.simulation(SHAKEN.replace(body_mass=[0.1, 0.2])), "is a batch of shape"),
        (lambda: ss.simulation(SHAKEN, method="dop853"), "it does not pause between two steps"),
        (lambda: ss.simulation(SHAKEN, start={"w": 1.0}), "start has no 'w'"),
        (lambda: ss.simulation(SHAKEN).trajectories(), "nothing is recorded"),
        (lambda: ss.simulation(SHAKEN).restore(ss.simulation(SHAKEN).snapshot()), "allowed is a snapshot of this simulation"),
    ],
)
def test_what_is_wrong_is_told_in_words(call, said):
    with pytest.raises(ss.InputError, match=said):
        call()
