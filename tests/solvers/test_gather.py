"""Summaries compute their columns when they are read, and answers that are kept are those of the same numbers."""

import copy
import dataclasses
import pickle
from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from stickslip.engine.remembered import OfFrozen
from stickslip.results.summary import Columns
from stickslip.solvers import gather as gathering


def coulomb(**numbers):
    return ss.presets.piezo_rig(**{"tilt_deg": 1.7, "amplitude": 6e-4, "law": "coulomb"} | numbers)


def test_columns_do_not_depend_on_the_order_in_which_they_are_read():
    robots = coulomb(amplitude=np.array([1e-7, 2e-4, 6e-4, 9e-4]))
    ahead, back = (ss.solve(robots, periods=30) for _ in range(2))
    names = list(ahead.columns)
    first, second = {n: ahead.columns[n] for n in names}, {n: back.columns[n] for n in reversed(names)}
    for name in names:
        assert np.array_equal(first[name], second[name], equal_nan=first[name].dtype.kind == "f"), name


def test_columns_of_a_large_batch_are_those_that_are_computed_when_read(monkeypatch):
    for machine in (
        coulomb(amplitude=np.linspace(2e-4, 9e-4, 5)),
        ss.Chain.example().replace({"link.stiffness": np.array([800.0, 900.0])}),
    ):
        later = ss.solve(machine, periods=10, keep="summary")
        with monkeypatch.context() as patched:
            patched.setattr(gathering, "_LATER", 0)
            at_once = ss.solve(machine, periods=10, keep="summary")
        assert isinstance(later.columns, Columns) and isinstance(at_once.columns, dict)
        assert list(later.columns) == list(at_once.columns)
        for name, values in at_once.columns.items():
            assert np.array_equal(np.asarray(values).astype(str), np.asarray(later.columns[name]).astype(str)), name


def test_the_direction_of_a_body_on_a_belt_is_that_of_its_slip():
    block = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
    speeds = np.array([-0.2, 0.1])
    for method in ("auto", "dop853"):
        many = ss.solve(block.replace(speed=speeds), duration=20.0, keep="summary", method=method)
        assert many.direction.tolist() == [1, -1] and [pattern[0] for pattern in many.pattern] == ["+", "-"], method
    swept = ss.sweep(block, speed=speeds, duration=40.0, settle=20.0)
    assert swept.direction.values.tolist() == [1, -1] and (abs(swept.mean_velocity.values) < 1e-9).all()


def _extremes_of_run(run, since):
    """The largest and the smallest velocity of each body from an instant on, at many instants of each piece."""
    t, whole = run.pieces.t, run.with_axes
    late = np.flatnonzero(t[:-1] >= since * (1 - 1e-12))
    at = t[late, None] + np.linspace(0.0, 1.0, 2001) * np.diff(t)[late, None]
    v = whole._states_at(at.ravel(), np.repeat(late, 2001))[1]
    return v.max(axis=0), v.min(axis=0)


def test_extremes_of_a_motion_that_has_not_settled_are_those_of_the_window():
    """Also where they lie within a step, at the instant with which the window begins, and at the last."""
    begun = {"v": {"module 1": 0.2}}
    for settle in (0, 2):
        how = dict(periods=5, settle=settle, start=begun)
        high, low = _extremes_of_run(ss.solve(ss.Chain.example(), keep="trajectory", **how), settle * ss.Chain.example().period)
        for method in ("auto", "dop853"):
            many = ss.solve(ss.Chain.example(), keep="summary", method=method, **how)
            assert many.steadiness != 0
            np.testing.assert_allclose([many.velocity_max, many.velocity_min], [high, low], atol=1e-6 * high.max())
        assert settle or many.velocity_max[0] == 0.2
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="lugre")
    for method in ("auto", "rodas5p"):
        how = dict(periods=5, settle=1, start={"v": 0.05}, method=method)
        (high,), (low,) = _extremes_of_run(ss.solve(rig, keep="trajectory", **how), rig.period)
        many = ss.solve(rig, keep="summary", **how)
        assert [float(many.velocity_max), float(many.velocity_min)] == pytest.approx([high, low], abs=1e-6 * high)


def test_a_column_is_computed_once_and_no_earlier_than_it_is_read():
    asked = []
    columns = Columns({"margin": lambda: asked.append(1) or np.zeros(2)})
    assert "margin" in columns and len(columns) == 1 and not asked
    assert columns["margin"] is columns["margin"] and asked == [1]
    with pytest.raises(ValueError, match="read-only"):
        columns["margin"][0] = 1.0


def test_summaries_can_be_pickled_and_copied_before_anything_is_read():
    for again in (lambda many: pickle.loads(pickle.dumps(many)), copy.deepcopy):
        many = ss.solve(coulomb(amplitude=np.array([2e-4, 6e-4])), periods=10)
        other = again(many)
        assert other.mean_velocity.tolist() == many.mean_velocity.tolist() and other.pattern.tolist() == many.pattern.tolist()


def test_the_sign_of_zero_and_every_last_bit_tell_cases_apart():
    velocities = [float(ss.solve(coulomb(amplitude=a), periods=20, keep="summary").mean_velocity) for a in (6e-4, np.nextafter(6e-4, 1.0))]
    both = ss.solve(coulomb(amplitude=np.array([6e-4, np.nextafter(6e-4, 1.0)])), periods=20)
    assert velocities == both.mean_velocity.tolist()


@dataclass
class Worn:
    """A law that is not frozen, against our advice."""

    mu: float
    wear: str = "none"

    def sliding(self, v, load):
        return self.mu * load * ss.maths.where(v > 0, 1.0, -1.0)

    def breakaway(self, load):
        return -self.mu * load, self.mu * load


def test_answers_about_records_that_may_change_are_not_kept():
    law, wear = Worn(0.15), OfFrozen(lambda robot: robot.friction.wear)
    robot = coulomb().replace(friction=law, track=ss.Level())
    assert wear(robot) == "none"
    law.wear = "some"
    assert wear(robot) == "some"
    before = float(ss.solve(robot, periods=20, keep="summary").mean_velocity)
    law.mu = 0.25
    fresh = coulomb().replace(friction=Worn(0.25), track=ss.Level())
    after, expected = (float(ss.solve(each, periods=20, keep="summary").mean_velocity) for each in (robot, fresh))
    assert after == expected != before


def test_answers_are_given_up_with_their_record():
    kept = OfFrozen(dataclasses.asdict)
    law = ss.Coulomb(0.15, 0.21)
    assert kept(law) is kept(law)
    assert len(kept) == 1
    del law
    assert len(kept) == 0


@dataclass(frozen=True, slots=True)
class Sled:
    """A machine to which no weak reference can be made."""

    mass: float
    friction: object
    period = None
    time_scale = velocity_scale = 1.0

    @property
    def total_mass(self):
        return self.mass

    @property
    def load(self):
        return 9.81 * self.mass

    def contact_velocity(self, v):
        return v

    def acceleration(self, t, x, v, R):
        return 1.0 - R / self.mass


def test_a_machine_with_slots_is_solved():
    run = ss.solve(Sled(2.0, ss.Coulomb(0.05, 0.05)), duration=2.0)
    assert run.v[-1] == pytest.approx((1.0 - 0.05 * 9.81) * 2.0, rel=1e-12)
