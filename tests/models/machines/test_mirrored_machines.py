"""The mirror image of a machine runs as the machine does, the other way: every column of one is minus that of the other, to rounding."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from every import DRY, SHAKEN, STICTION, Capsule, every_machine, with_bodies
from rows import each_row
from stickslip.maths import cos, pi, sin
from stickslip.models.mirroring import _unmirrored

LINKS = (ss.Spring(900.0, 0.3, 0.02), ss.Spring(1200.0, 0.4))
WORM = ss.Chain(ss.machines.Bodies(0.05, 3, ss.Coulomb(0.1, 0.3)), ss.machines.Gait(ss.Harmonic(2e-3, frequency=2.0), lag=2 * pi / 3))
LOPSIDED = SHAKEN.replace(track=ss.Incline(0.03))


@dataclass(frozen=True, eq=False)
class Everything(ss.Machine):
    """Every sort of part: a belt, a motion, a body on a body, links and stops to the ground, jumps, a force between bodies, loads."""

    stiffness: float
    friction: Any
    omega: float = 60.0
    belt: float = 0.02

    @property
    def period(self):
        return 2 * pi / self.omega

    @property
    def velocity_scale(self):
        return 0.3

    def bodies(self):
        return {
            "a": ss.Body(0.1, force=lambda t, x, v: 0.9 * sin(self.omega * t) - 2.0 * x - 0.1 * v + 0.05, jumps=((0.01, 0.02),)),
            "b": ss.Body(0.05, position=-0.03),
            "c": ss.Body(0.02, position=0.01, force=0.01),
        }

    def contacts(self):
        return {
            "belt": ss.Contact("a", self.friction, on=self.belt),
            "pad": ss.Contact("c", ss.Coulomb(0.1, 0.3), on="a", load=lambda t, x: 0.2 + 0.02 * cos(self.omega * t) + 0.5 * x),
            "foot": ss.Contact("b", ss.Coulomb(0.2, 0.1), load=0.3),
        }

    def links(self):
        return {("a", "b"): ss.Spring(self.stiffness, 0.2, 0.02), ("b", None): ss.Spring(20.0, 0.1, -0.04)}

    def stops(self):
        return {
            ("c", "a"): ss.Stop(gap=0.013, restitution=0.4),
            ("b", None): ss.Stop(gap=0.02, stiffness=2e3),
            ("a", None): ss.Stop(gap=0.05, restitution=0.5, side=-1),
        }

    def forces(self, t, x, v):
        pull = 3.0 * (x["c"] - x["a"] - 0.01) + 0.02
        return {"a": pull, "c": -pull}


@dataclass(frozen=True, eq=False)
class Prescribed(ss.Machine):
    """Two bodies whose distance is told by a drive, one of them on a shaken table."""

    drive: Any
    friction: Any

    @property
    def period(self):
        return self.drive.period

    def bodies(self):
        return {"front": ss.Body(0.1), "rear": ss.Body(0.07, position=-0.1)}

    def contacts(self):
        table = ss.Harmonic(1e-4, self.drive.omega)
        return {"front": ss.Contact("front", self.friction), "rear": ss.Contact("rear", self.friction, on=table)}

    def links(self):
        return {("front", "rear"): self.drive}


@pytest.mark.parametrize(
    "machine",
    [
        every_machine["PulledMass"][0],
        every_machine["BlockOnBelt"][0],
        ss.ForcedOscillator(1.0, 1.0, 1.0, 0.7, ss.Coulomb(0.2, 0.3), bias=0.1, damping=0.01),
        ss.Chain((SHAKEN, LOPSIDED.replace(body_mass=0.05), SHAKEN), LINKS, phases=(0.0, 1.0, 2.0)),
        every_machine["capsule with an elastic stop"][0],
        every_machine["a machine of your own"][0],
        Everything(300.0, STICTION),
        Prescribed(ss.Harmonic(2e-3, 60.0), ss.Coulomb(0.1, 0.3)),
        WORM,
        ss.Chain(ss.machines.Bodies((0.05, 0.04, 0.03), 3, ss.Coulomb(0.1, 0.3)), (ss.machines.Rigid(), ss.machines.Gait(ss.Harmonic(2e-3,
        12.0), lag=0.7))),
    ],
    ids=lambda machine: type(machine).__name__,
)  # fmt: skip
def test_a_machine_in_the_mirror_is_the_machine_the_other_way(machine):
    """Over a few periods, in which rounding grows by less than the tolerance; bodies of a chain change places."""
    length = {"duration": 6.0} if machine.period is None else {"periods": 3}
    run, image = ss.solve(machine, **length), ss.solve(ss.dynamics.mirrored(machine), **length)
    order = slice(None, None, -1) if isinstance(ss.dynamics.mirrored(machine), ss.Chain) else slice(None)
    t = np.linspace(0.0, run.pieces.t[-1], 200)
    here, there = run.at(t), image.at(t)
    for name in ("v", "friction_force", "acceleration"):
        column = there[name][..., order] if np.ndim(there[name]) > 1 else there[name]
        size = abs(here[name]).max()
        near = np.isclose(column, -here[name], rtol=0, atol=1e-8 * size)
        assert near.mean() > 0.99, name  # an instant beside a jump may be on its other side
    assert sorted((e.kind, e.part) for e in image.events) == sorted((e.kind, _named(e.part, machine)) for e in run.events)
    assert [e.t for e in image.events] == pytest.approx([e.t for e in run.events], rel=1e-9)


def _named(part, machine):
    """The name in the mirror: of a chain counted from the other end; of a stop with its ends exchanged."""
    if isinstance(ss.dynamics.mirrored(machine), ss.Chain):
        return f"module {len(machine.modules) + 1 - int(part.rpartition(' ')[2])}"
    first, dash, second = part.partition("-")
    return f"{second}-{first}" if dash else part


@dataclass(frozen=True, eq=False)
class Stage(ss.Machine):
    """A mass on a table that a sawtooth moves."""

    table: Any
    friction: Any

    @property
    def period(self):
        return self.table.period

    def bodies(self):
        return {"mass": ss.Body(0.1)}

    def contacts(self):
        return {"mass": ss.Contact("mass", self.friction, on=self.table)}


def test_jumps_of_what_a_contact_rubs_on_are_in_the_mirror_too():
    stage = Stage(ss.drives.Sawtooth(stroke=5e-6, rise=0.95e-3, fall=0.05e-3), ss.Coulomb(0.2, 0.3))
    there, back = (ss.mean_velocity(ss.solve(each, periods=30)) for each in (stage, ss.dynamics.mirrored(stage)))
    assert there > 0 and back == pytest.approx(-there, rel=1e-12)


@each_row("name", with_bodies)
def test_what_is_mirrored_twice_is_the_machine_again(name):
    machine = every_machine[name][0]
    assert ss.dynamics.mirrored(ss.dynamics.mirrored(machine)) == machine


def test_a_chain_stays_a_chain_that_a_file_can_hold():
    chain = ss.Chain((SHAKEN, SHAKEN.replace(body_mass=0.05)), ss.Spring(900.0), phases=(0.0, 1.0))
    image = ss.dynamics.mirrored(chain)
    assert [m.body_mass for m in image.modules] == [0.05, SHAKEN.body_mass] and image.phases == (1.0, 0.0)
    assert ss.Chain.from_toml(image.to_toml()) == image


def test_plain_bodies_in_the_mirror_change_places():
    row = ss.Chain(ss.machines.Bodies((0.05, 0.04), 2, ss.Coulomb(0.1, 0.3)), ss.Spring(900.0))
    image = ss.dynamics.mirrored(row)
    assert image.modules.mass == (0.04, 0.05) and image.modules.friction == ss.Coulomb(0.3, 0.1) and ss.dynamics.mirrored(image) == row


def test_a_bench_whose_equations_were_changed_is_refused():
    @dataclass(frozen=True, eq=False)
    class Pushed(ss.PulledMass):
        def acceleration(self, t, x, v, R):
            return super().acceleration(t, x, v, R) + 0.1

    with pytest.raises(ss.InputError, match="the acceleration is another one"):
        ss.dynamics.mirrored(Pushed(1.0, 2.0, 0.1, DRY))


def test_each_part_of_a_bench_that_is_not_mirrored_is_named():
    bench = every_machine["BlockOnBelt"][0]
    image = ss.dynamics.mirrored(bench)
    assert _unmirrored(bench, image) == ""
    for change, said in [
        ({"load": 2.0}, "the load"), ({"speed": 0.1}, "the velocity at the contact"), ({"stiffness": 3.0}, "the acceleration"),
        ({"friction.mu_plus": 0.25}, "the sliding friction"),
    ]:  # fmt: skip
        assert _unmirrored(bench, image.replace(change)) == said


def test_what_has_no_mirror_image_says_what_to_write():
    class Slide:
        friction, load, period, shape, total_mass = DRY, 1.0, None, (), 1.0

        def acceleration(self, t, x, v, R):
            return 1.0 - R

        def contact_velocity(self, v):
            return v

    with pytest.raises(ss.InputError, match=r"Slide has no drive on a track .* no method mirrored\(\); write one"):
        ss.dynamics.mirrored(Slide())


def test_a_capsule_in_the_mirror_goes_backwards_with_its_hammer_at_the_other_wall():
    capsule = Capsule(300.0, DRY)
    stop = ss.dynamics.mirrored(capsule).stops()
    assert list(stop) == [("capsule", "hammer")]
