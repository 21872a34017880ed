"""A machine that goes on step by step is where `solve` is, whatever the steps, and goes on from a jump of an input as from any event."""

from dataclasses import dataclass

import numpy as np

import stickslip as ss
from every import every_machine
from rows import each_row
from stickslip.basics.fields import leaves
from stickslip.maths import where, within
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import parts_of
from stickslip.models.pushed import PushedBody, PushedParts, force_names, pushed
from stickslip.models.switching_flow import is_flow
from stickslip.solvers.flow_engine import follow_flow

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


def cuts(end, count, seed):
    """Uneven instants up to the end."""
    return np.append(np.sort(np.random.default_rng(seed).uniform(0.0, end, count - 1)), end)


def length_of(machine):
    return 3.0 * machine.period if machine.period is not None else 6.0


def run_of(machine, start, method="auto"):
    span = {"periods": 3} if machine.period is not None else {"duration": 6.0}
    return ss.solve(machine, **span, start=start, method=method, **({} if is_flow(machine) else {"rtol": RTOL}))


def missed(run, sim, begun=0.0):
    """The largest difference of a state from a run that began so late, in the size of its column."""
    names = ("x", "v")
    at, state = run.at(sim.t - begun), sim.state
    sizes = {name: np.max(abs(run[name] if is_flow(sim.machine) else getattr(run, name))) for name in names}
    return max(float(np.max(abs(at[name] - state[name]))) / sizes[name] for name in names)


@each_row("name", list(every_machine))
def test_steps_of_any_length_are_the_run_of_solve_with_all_its_events(name):
    machine, start = every_machine[name][0], {"x": 1.0, "v": 0.0} if name == "a SwitchingFlow" else None
    run, sim = run_of(machine, start), ss.simulation(machine, start, **({} if is_flow(machine) else {"rtol": RTOL}))
    worst, events = 0.0, []
    for instant in cuts(length_of(machine), 25, 7):
        sim.step(until=instant)
        events += sim.events
        worst = max(worst, missed(run, sim))
    assert worst < (DYNAMIC if name == "Chain, LuGre" else EXACT)
    assert [(type(e), getattr(e, "part", "")) for e in events] == [(type(e), getattr(e, "part", "")) for e in run.events]
    assert (
        np.allclose([e.t for e in events], [e.t for e in run.events], rtol=0.0, atol=1e-9 * length_of(machine)) and sim.status == "finished"
    )


# ---- an input that jumps ----
#: Machines on which a force jumps, on the first body; on the others a number of theirs does.
FORCED = ("Robot", "Chain, set-valued laws", "a machine without contacts")


def jump_of(name, machine):
    """An input that jumps, by its name, and the machine after it."""
    if name in FORCED:
        force, number = next(iter(force_names(machine).items()))
        return {force: 0.05}, pushed(machine).replace({number: 0.05})
    named = {"F": 0.1, "friction.mu_plus": 0.17, "link.stiffness": 900.0, "along.amplitude": 4.1e-4, "control.kp": 1.5}
    jump = next({number: value} for number, value in named.items() if number in dict(leaves(machine)) | getattr(machine, "numbers", {}))
    return jump, machine.replace(jump)


@each_row("name", [name for name in every_machine if name != "PulledMass"])  # which is never again where its time begins
def test_after_a_jump_of_an_input_it_goes_on_as_solve_does_from_there(name):
    machine, start = every_machine[name][0], {"x": 1.0, "v": 0.0} if name == "a SwitchingFlow" else None
    (jump, after), end = jump_of(name, machine), length_of(machine)
    sim = ss.simulation(machine, start, **({} if is_flow(machine) else {"rtol": RTOL}))
    for instant in cuts(end, 9, 3):
        sim.step(until=instant)
    begun, worst = sim.t, 0.0
    if is_flow(machine):
        state = sim.state
        leg = follow_flow(after, np.array([state["x"], state["v"]]), state["mode"], end, begin=sim.t, growth=False)
    else:
        run = run_of(after, sim.start)
    for instant in cuts(end, 12, 4):
        sim.step(until=begun + instant, inputs=jump)
        if not is_flow(machine):
            worst = max(worst, missed(run, sim, begun))
    if is_flow(machine):
        worst = max(abs(np.array([sim.state["x"], sim.state["v"]]) - leg.state))
    assert worst < (DYNAMIC if name == "Chain, LuGre" else EXACT)
    assert sim.inputs[next(iter(jump))] == next(iter(jump.values()))


@dataclass(frozen=True, eq=False)
class LaterBody(PushedBody):
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
        return self.machine.acceleration(t, x, v, R - self.come(t) * self.applied)


@dataclass(frozen=True, eq=False)
class LaterParts(PushedParts):
    """The same of several bodies."""

    instant: float = 0.0

    period, breaks, come = LaterBody.period, LaterBody.breaks, LaterBody.come

    def forces(self, t, x, v):
        own, come = parts_of(self.machine).forces(t, x, v), self.come(t)
        return {name: own.get(name, 0.0) + come * force for name, force in zip(x, self.applied, strict=True)}


@each_row("name", ["Robot", "PulledMass", "a machine of your own", "LuGre"])
def test_within_a_period_it_goes_on_from_a_jump_as_the_judge_does(name):
    machine = LUGRE if name == "LuGre" else every_machine[name][0]
    instant, single = 0.377 * (machine.period or 2.0), machine_of(machine).is_single
    force = next(iter(force_names(machine)))
    later = LaterBody(machine, 0.1, instant) if single else LaterParts(machine, (0.1, 0.0), instant)
    span = {"periods": 1} if machine.period is not None else {"duration": 6.0}
    judge = ss.solve(later, **span, method="radau" if name == "LuGre" else "dop853", rtol=1e-10)
    sim = ss.simulation(machine, rtol=RTOL)
    sim.step(instant)
    worst = missed(judge, sim)
    for more in cuts(length_of(machine) - instant, 9, 5):
        sim.step(until=instant + more, inputs={force: 0.1})
        worst = max(worst, missed(judge, sim))
    assert worst < 1e-7  # of the judge, whose tolerance is held within a step
