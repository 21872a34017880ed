"""Columns of bodies, contacts and stops: what lanes note on the way is what the dense output of single runs says."""

from dataclasses import dataclass

import numpy as np
import pytest

import every
import problems
import stickslip as ss
from parts_of_runs import columns_of, solved
from rows import each_row
from stickslip.basics.coded_words import CodedWords
from stickslip.maths import pi
from stickslip.models.machine_adapter import machine_of

EXTREMES = ("velocity_max", "velocity_min", "slip_max", "slip_min")
FRACTIONS = ("stick_fraction", "forward_fraction", "backward_fraction")
WORDS = ("motion_type", "pattern", "direction")
#: Both sides take the same steps. Integrals and lengths differ by rounding of some hundred steps; a peak is found by the judge to
#: (1e-9 of a piece)^2 at best, and not nearer than 1e-9 of a piece to its ends, where a hit may have it: slope times that.
ROUNDING = 1e-8
#: Under a dynamic law powers are not polynomials: Gauss's rule with 4 nodes and the judge's with 12 agree to the tolerance of the steps.
OF_STEPS = 1e-6

LUGRE = ss.Chain((every.SHAKEN.replace(friction=ss.LuGre.example()),) * 2, ss.Spring(1200.0, damping=0.4), (0.0, 1.57))
HAMMER = every.Capsule(300.0, every.DRY)


def compared(machine, periods, **options):
    """The columns of lanes against those of a single run, in words where they differ; and how far apart numbers are at most."""
    many, run = solved(machine, periods, **options)
    assert int(many.status[0]) == 0, many
    want = columns_of(run, int(many.period[0]))
    steady, scale = int(many.steadiness[0]) == 0, float(machine_of(machine).velocity_scale)
    power = max(abs(want["friction_power"]).max(), 1e-300)
    worst, words = {}, []
    for name in (*EXTREMES, *FRACTIONS, "friction_power"):
        size = {"friction_power": power}.get(name, scale if name in EXTREMES else 1.0)
        off = (getattr(many, name)[0] - want[name]) / size
        if name in EXTREMES[:2] and not steady:  # these are then over the whole window of the mean
            off = np.minimum(off, 0.0) if name == "velocity_max" else np.maximum(off, 0.0)
        worst[name] = float(abs(off).max(initial=0.0))
    for name in WORDS:
        words += [f"{name}: {a} for {b}" for a, b in zip(getattr(many, name)[0].tolist(), want[name], strict=True) if a != b]
    count = len(want["hits"])
    if count:
        assert many.hits[0].tolist() == want["hits"]
        worst["impulse_max"] = float(max(abs(many.impulse_max[0] - want["impulse_max"]) / np.maximum(want["impulse_max"], 1e-300)))
    means = [float(ss.mean_velocity(run, body=name)) for name in run.bodies]
    return many, run, worst, words, means


@each_row(
    ("machine", "periods", "rtol"),
    [(ss.Chain.example(), 60, 1e-6), (LUGRE, 30, 1e-6), (problems.CAPSULE_3, 60, 1e-6), (problems.Worm(0.2, 0.3, 5.0), 20, 1e-6)],
    ids=["chain", "LuGre", "hits", "prescribed distances"],
)
def test_lanes_note_of_each_part_what_single_runs_say(machine, periods, rtol):
    many, run, worst, words, means = compared(machine, periods, rtol=rtol)
    dynamic = machine_of(machine).has_inner_states
    assert not words
    assert worst.pop("friction_power") <= (OF_STEPS if dynamic else ROUNDING)
    assert max(worst.values()) <= ROUNDING, worst
    parts = len(machine_of(machine).mechanics.bodies)
    assert many.body_velocity.shape == (2, parts) and many.friction_power.shape == (2, len(run.contacts))
    assert np.allclose(many.body_velocity[0], means, rtol=0, atol=1e-6 * abs(float(machine_of(machine).velocity_scale)))


def test_bodies_of_a_steady_chain_have_the_mean_velocity_of_its_centre_of_mass():
    many = ss.solve(ss.Chain.example().replace({"phases.1": [0.5, 1.0]}), periods=80, settle=40)
    assert (many.steadiness == 0).all()
    assert np.allclose(many.body_velocity, many.mean_velocity[:, None], rtol=1e-9)
    window = many.displacement / many.mean_velocity
    assert np.allclose(many.body_displacement, many.body_velocity * window[:, None], rtol=1e-12)


def test_a_bodys_extremes_lie_between_the_ends_of_steps():
    """A sine's peak is found to rounding: free of friction, the modules shake with their drive's amplitude and nothing else."""
    free = every.SHAKEN.replace(friction=ss.Coulomb(1e-12, 1e-12))
    many = ss.solve(ss.Chain((free, free), ss.Spring(0.0), (0.0, 1.0)).replace({"phases.1": [1.0, 1.1]}), periods=4, settle=2)
    peak = free.drive.amplitude * free.drive.omega * free.inner_mass / free.total_mass
    assert np.allclose(many.velocity_max - many.velocity_min, 2 * peak, rtol=1e-8)  # friction of 1e-12 g does the rest


def test_friction_takes_what_the_energy_balance_says():
    for machine, periods in ((ss.Chain.example(), 60), (LUGRE, 30)):
        many, run = solved(machine, periods, rtol=1e-6)
        power = ss.energy(run).friction[-1] / run.period_time
        assert float(many.friction_power[0].sum()) == pytest.approx(power, rel=OF_STEPS)


def test_an_elastic_stop_has_its_greatest_force_and_is_counted():
    many, run = solved(HAMMER, 40)
    begin = run.pieces.t[-1] - max(int(many.period[0]), 1) * run.period_time
    t = np.linspace(begin, run.pieces.t[-1], 200_001)
    at = run.at(t)
    depth, rate = at["x"][:, 1] - at["x"][:, 0] - HAMMER.gap, at["v"][:, 1] - at["v"][:, 0]
    force = np.where(depth > 0, np.maximum(HAMMER.wall * depth + rate, 0.0), 0.0)
    assert force.max() > 0.1
    assert many.stop_force_max[0, 0] == pytest.approx(force.max(), rel=1e-6)  # 2e5 samples: (2 pi / 2e5)^2 of the fastest part, and a kink
    assert int(many.hits[0, 0]) == np.count_nonzero((force[1:] > 0) & (force[:-1] == 0))
    assert np.isnan(many.impulse_max).all()


def test_judge_and_lanes_say_the_same_of_every_part():
    """The judge samples 5000 instants of a period: peaks to (pi / 5000)^2, and ends of segments to a sample each."""
    few = ss.Chain.example().replace({"phases.1": [0.5, 1.0]})
    ours, judged = (ss.solve(few, periods=6, settle=5, keep="summary", method=method) for method in ("auto", "dop853"))
    assert (ours.motion_type == judged.motion_type).all() and (ours.pattern == judged.pattern).all()
    for name, within in (("velocity_max", 1e-5), ("slip_min", 1e-5), ("stick_fraction", 1e-3), ("body_velocity", 1e-6)):
        size = float(machine_of(ss.Chain.example()).velocity_scale) if name != "stick_fraction" else 1.0
        assert abs(getattr(ours, name) - getattr(judged, name)).max() <= within * size, name
    assert np.allclose(ours.friction_power, judged.friction_power, rtol=1e-3)
    pressed = HAMMER.replace(stiffness=np.array([300.0, 303.0]))
    ours, judged = (ss.solve(pressed, periods=10, keep="summary", method=method) for method in ("auto", "dop853"))
    assert (ours.hits == judged.hits).all() and ours.hits.all()
    assert np.allclose(ours.stop_force_max, judged.stop_force_max, rtol=1e-4)  # a peak of short contact


@dataclass(frozen=True, eq=False)
class Rattle(problems.Capsule):
    """The capsule with a stop on either side of the inner mass."""

    def stops(self):
        return {("inner", "capsule"): tuple(ss.Stop(gap, restitution=self.restitution, side=side) for gap, side in ((0.5, 1), (0.3, -1)))}


def test_two_stops_between_two_bodies_are_told_apart():
    machine = Rattle(alpha=1.0, omega=0.95, gap=0.5, mass=4.0, restitution=0.6)
    many, run = solved(machine, 30)
    begin = run.pieces.t[-1] - max(int(many.period[0]), 1) * run.period_time
    hits = [e for e in run.events if e.kind == "hit" and e.t > begin + 1e-12]
    ahead = [e for e in hits if run.at(e.t)["x"][0] > run.at(e.t)["x"][1]]
    assert 0 < len(ahead) < len(hits)
    assert many.hits[0].tolist() == [len(ahead), len(hits) - len(ahead)]
    reduced = 1.0 * machine.mass / (1.0 + machine.mass)
    for k, own in enumerate((ahead, [e for e in hits if e not in ahead])):
        assert many.impulse_max[0, k] == pytest.approx(max(-1.6 * e.velocity for e in own) * reduced, rel=1e-9)
    names = ss.sweep(machine, alpha=[0.5, 1.0], periods=30).stop.values.tolist()
    assert names == ["inner-capsule 1", "inner-capsule 2"]


def test_columns_of_parts_do_not_depend_on_threads_or_lanes():
    phases = np.linspace(0.0, 3.0, 300)
    batch = ss.Chain.example().replace({"phases.1": phases})
    one, two = (ss.solve(batch, periods=30, settle="auto", workers=workers) for workers in (1, 2))
    alone = ss.solve(ss.Chain.example().replace({"phases.1": phases[[7]]}), periods=30, settle="auto")
    for name, values in one.columns.items():
        exact = {"equal_nan": np.asarray(values).dtype.kind == "f"}
        assert np.array_equal(values, two.columns[name], **exact), name
        assert np.array_equal(np.asarray(values)[7], np.asarray(alone.columns[name])[0], **exact), name


# ---- datasets and folders ----
AXES = {"phases.1": [0.5, 1.0, 1.5], "link.stiffness": [500.0, 1200.0]}


@pytest.fixture(scope="module")
def grid():
    return ss.sweep(ss.Chain.example(), **AXES, periods=60)


def same(a, b):
    return all(np.array_equal(a[n].values, b[n].values, equal_nan=a[n].dtype.kind == "f") and a[n].dims == b[n].dims for n in a.data_vars)


def test_a_sweep_has_the_dimensions_body_and_contact_with_their_names(grid):
    assert grid.velocity_max.dims == ("phases.1", "link.stiffness", "body") and grid.motion_type.dims[-1] == "contact"
    assert grid.body.values.tolist() == grid.contact.values.tolist() == ["module 1", "module 2"]
    assert grid.mean_velocity.dims == ("phases.1", "link.stiffness") and "stop" not in grid.dims
    run = ss.solve(ss.Chain.example().replace({"phases.1": 0.5, "link.stiffness": 500.0}), periods=120)
    told = ss.motion(run).contacts["module 2"]
    here = grid.isel({"phases.1": 0, "link.stiffness": 0}).sel(contact="module 2", body="module 2")
    assert (here.motion_type.item(), here.pattern.item()) == (told.type, told.pattern)
    assert here.stick_fraction.item() == pytest.approx(told.stick_fraction, abs=1e-7)  # the strobe point repeats to 1e-8


def test_a_study_folder_keeps_the_parts_and_goes_on_with_them(grid, tmp_path):
    folder = tmp_path / "study"
    kept = ss.sweep(ss.Chain.example(), **AXES, periods=60, out=folder, tile=2)
    assert same(grid, kept)
    next((folder / "tiles").glob("*1.nc")).unlink()
    unfinished = ss.open_study(folder)
    assert int((unfinished.status == 101).sum()) == 2 and np.isnan(unfinished.velocity_max.values).sum() == 4
    assert same(grid, ss.sweep(ss.Chain.example(), **AXES, periods=60, out=folder, tile=2, resume=True))
    assert kept.velocity_max.sel(body="module 2")[1].values.tolist() == grid.velocity_max.sel(body="module 2")[1].values.tolist()
    assert same(grid, ss.open_study(ss.studies.export(folder, tmp_path / "whole.nc")))


def test_text_files_have_a_column_for_each_part(grid, tmp_path):
    head, *rows = ss.studies.export(grid, tmp_path / "grid.csv").read_text(encoding="utf-8").splitlines()
    columns = head.split(",")
    assert "velocity_max.module 2 [m/s]" in columns and "motion_type.module 1" in columns and "body" not in columns
    assert len(rows) == 6
    at = columns.index("friction_power.module 2 [W]")
    assert [float(row.split(",")[at]) for row in rows] == grid.friction_power.sel(contact="module 2").values.ravel().tolist()


def test_machines_of_other_parts_keep_what_is_of_the_whole():
    def chain(count):
        return ss.Chain((every.SHAKEN,) * int(count), ss.Spring(1200.0, 0.4))

    found = ss.sweep(chain, count=["2", "3"], periods=20)
    assert np.isfinite(found.mean_velocity.values).all() and np.isfinite(found.velocity_max.values[0]).all()
    assert np.isnan(found.velocity_max.values[1]).all()
    assert "are not those of the first machine" in found.attrs["notes"]


def test_no_axis_is_called_as_a_dimension_of_parts():
    def chain(body):
        return ss.Chain((every.SHAKEN.replace(body_mass=body),) * 2, ss.Spring(1200.0, 0.4))

    with pytest.raises(ss.InputError, match="body is the dimension of the machine's parts"):
        ss.sweep(chain, body=[0.05, 0.06], periods=4)


def test_maps_draw_one_contact_and_say_how_to_choose_it(grid):
    ax = ss.plot.motion_map(grid.sel(contact="module 2"), borders=False)
    assert ax.get_xlabel()
    velocities = ss.plot.velocity_map(grid.sel(body="module 1"), quantity="velocity_max")
    assert "velocity max" in velocities.figure.axes[-1].get_ylabel()
    with pytest.raises(ss.InputError, match=r"motion_type of each contact \(module 1, module 2\).*grid.sel\(contact='module 1'\)"):
        ss.plot.motion_map(grid)
    with pytest.raises(ss.InputError, match="quantity = 'pattern' holds <U4; allowed is a column of numbers"):
        ss.plot.velocity_map(grid.sel(contact="module 1"), quantity="pattern")


def test_a_refined_map_follows_the_motion_of_every_contact():
    axes = {"phases.1": np.linspace(0.0, 1.5, 9), "link.stiffness": np.linspace(500.0, 1200.0, 9)}
    whole, refined = ss.map(ss.Chain.example(), **axes, periods=60), ss.map(ss.Chain.example(), **axes, periods=60, refine=True, coarse=3)
    computed = (refined.status != 102).values
    assert 0 < computed.sum() <= computed.size
    assert (refined.pattern.values[computed] == whole.pattern.values[computed]).all()


def test_coded_words_are_their_words():
    words = np.array([["I", "rest"], ["II", "I"]])
    coded = CodedWords(np.array([[0, 1], [2, 0]], np.uint8), ("I", "rest", "II"))
    assert (np.asarray(coded) == words).all() and (coded[1] == words[1]).all()
    more = coded.joined([CodedWords(np.array([[1, 0]], np.uint8), ("rest", "IV"))])
    assert (np.asarray(more) == np.array([*words, ["IV", "rest"]])).all() and more.codes.dtype == np.uint8
    assert np.asarray(coded.where(words != "I", "unsolved")).tolist() == [["unsolved", "rest"], ["II", "unsolved"]]


# ---- many ----
def random_chain(seed):
    """Two to five modules of other numbers under one law, set-valued or dynamic."""
    rng = np.random.default_rng([20261123, seed])
    laws = (ss.Coulomb(0.15, 0.21), ss.Stribeck.example(), ss.CoulombViscous.example(), ss.LuGre.example())
    law, omega = laws[seed % len(laws)], 65.4 * pi

    def module():
        drive = ss.Harmonic(amplitude=float(rng.uniform(3e-4, 9e-4)), omega=omega)
        return ss.Robot(float(rng.uniform(0.03, 0.1)), float(rng.uniform(0.005, 0.02)), drive, law)

    count = int(rng.integers(2, 6))
    link = ss.Spring(stiffness=float(10 ** rng.uniform(2.0, 3.5)), damping=float(rng.uniform(0.05, 1.0)))
    return ss.Chain(tuple(module() for _ in range(count)), link, tuple(map(float, rng.uniform(-pi, pi, count))))


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 200, 20))
def test_random_chains_are_noted_as_single_runs_say(first):
    for seed in range(first, first + 20):
        machine = random_chain(seed)
        dynamic = machine_of(machine).has_inner_states
        many, _, worst, words, means = compared(machine, 60, **({"rtol": 1e-7} if dynamic else {}))
        shortest = float(np.nanmin(many.margin[0]))
        assert not words or shortest < 1e-9, (seed, words)  # an interval that short is there or not by rounding
        assert worst.pop("friction_power") <= (OF_STEPS if dynamic else ROUNDING), seed
        assert max(worst.values()) <= ROUNDING, (seed, worst)
        assert np.allclose(many.body_velocity[0], means, rtol=0, atol=1e-3 * float(machine_of(machine).velocity_scale)), seed
