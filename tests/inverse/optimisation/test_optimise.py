"""`ss.optimise`: optima that are known in closed form are found from nothing, and what it says of them is so."""

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import Problems
from stickslip.drives import DRIVES
from stickslip.inverse.optimisation.candidates import Candidates
from stickslip.inverse.optimisation.coexisting_motions import continued
from stickslip.inverse.optimisation.constraints import checked_limits
from stickslip.inverse.optimisation.peaks import LIMITS, peaks_of
from stickslip.inverse.optimisation.unknowns import Unknowns, Varied, checked_over
from stickslip.inverse.optimisation.waveforms import Scales, Waveform, drive_of_waveform, unknowns_of

G, MU = 9.81, 0.1315
LAW = ss.Coulomb(0.15, 0.25)
BOUNDED = {"stroke": (None, 0.01), "relative_acceleration": (None, 60.0)}


def robot(drive, mu=MU, law=LAW):
    return ss.Robot(1.0 - mu, mu, drive, law)


def two_phase(U, mu=MU, up=0.15, down=0.25, L=0.01):
    """The fastest motion of two phases within a speed U."""
    if 2 * mu * U**2 >= up * G * L:
        return mu * U - up * (up + down) * G * L / (4 * down * U)
    return mu**2 * U**3 * (1 / up - 1 / down) / (G * L)


@pytest.mark.parametrize(("U", "V"), [(0.2, 0.003760462113490), (0.4, 0.037885), (0.8, 0.0978425), (2.0, 0.260057)])
def test_two_phases_are_fastest_at_both_speeds(U, V):
    best = ss.optimise(
        robot(ss.drives.TwoPhase(stroke=0.01, u1=0.1, u2=0.1)), over={"drive.u1": (0.0, U), "drive.u2": (0.0, U)}, maximise="mean_velocity",
        subject_to={"relative_velocity": (None, U)}, starts=None,
    )  # fmt: skip
    assert two_phase(U) == pytest.approx(V, rel=1e-9)
    assert best["mean_velocity"] == pytest.approx(V, rel=1e-6)
    assert set(best.active) == {"relative_velocity", "drive.u1", "drive.u2"}
    assert best.of_limit == pytest.approx(V / (MU * U), rel=1e-9)  # small friction: mu U min(1, mu_minus/mu_plus)


def three_phase(W, L=0.01, up=0.15, down=0.25, mu=MU):
    """The fastest motion of three phases without slipping back: w1 on the verge of it, w2 = w3 = W."""
    w1 = down * G / mu
    u1, u3 = math.sqrt(2 * L * w1 * W / (w1 + W)), math.sqrt(L * W)
    v2 = (mu * W - up * G) * (u1 + u3) / W
    v3 = v2 - (mu * W + up * G) * u3 / W
    a2, a3, a1 = mu * W - up * G, mu * W + up * G, (down + up) * G
    T = u1 / w1 + (u1 + u3) / W + u3 / W
    return (v2**2 / (2 * a2) + (v2**2 - v3**2) / (2 * a3) + v3**2 / (2 * a1)) / T


def test_three_phases_wait_on_the_verge_of_slipping_back():
    best = ss.optimise(
        robot(ss.drives.ThreePhase.example()), maximise="mean_velocity", subject_to={"stroke": (None, 0.01)}, starts=None,
        over={"drive.u1": (0.01, 1.0), "drive.w1": (1.0, 60.0), "drive.w2": (1.0, 60.0), "drive.w3": (1.0, 60.0)},
    )  # fmt: skip
    assert best["mean_velocity"] == pytest.approx(three_phase(60.0), rel=1e-6)
    assert best["mean_velocity"] == pytest.approx(0.041032906654407, rel=1e-6)
    assert best.model.drive.w1 == pytest.approx(0.25 * G / MU, rel=1e-5)
    assert {"stroke", "drive.w2", "drive.w3"} == set(best.active)
    assert any(note.startswith("drive.w1: one-sided") for note in best.sensitivities.notes)


def verge(mu, up, down, L, W):
    """Mean velocity of the verge gait by its formula."""
    p, T = down / (up + down), ss.drives.Pieces.verge(W, L, mu, up, down).period
    return p**2 * T * (mu**2 * W**2 - up**2 * G**2) / (4 * mu * W)


SETS = [
    (0.1315, 0.15, 0.25, 0.01, 60.0),
    (0.2, 0.1, 0.3, 0.005, 40.0),
    (0.3, 0.2, 0.22, 0.02, 30.0),
    (0.1, 0.05, 0.2, 0.01, 100.0),
    (0.25, 0.12, 0.18, 0.002, 50.0),
    (0.15, 0.3, 0.5, 0.01, 80.0),
]


def fastest(mu, up, down, L, W, **more):
    limits = {"stroke": (None, L), "relative_acceleration": (None, W)}
    made = robot(ss.drives.Pieces.example(), mu, ss.Coulomb(up, down))
    return ss.optimise(made, over={"drive": ss.optimisation.waveform(**more)}, maximise="mean_velocity", subject_to=limits, starts=None)


@pytest.mark.parametrize("numbers", [SETS[0], *(pytest.param(each, marks=pytest.mark.slow) for each in SETS[1:])])
def test_three_free_pieces_find_the_verge_gait(numbers):
    best = fastest(*numbers, pieces=3)
    assert best["mean_velocity"] == pytest.approx(verge(*numbers), rel=1e-6)
    assert best["stroke"] == pytest.approx(numbers[3], rel=1e-8)
    assert best["relative_acceleration"] == pytest.approx(numbers[4], rel=1e-8)


@pytest.mark.slow
def test_more_pieces_come_as_far_as_three():
    # nothing faster is known; a thousandth below is what a search in eighteen unknowns may leave
    V = verge(*SETS[0])
    assert V * (1 - 1e-3) < fastest(*SETS[0], pieces=8)["mean_velocity"] < V * (1 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [{"fourier": 3}, {"spline": 6}])
def test_smooth_waveforms_stay_below_the_verge_gait_and_beat_a_sine(shape):
    sine = fastest(*SETS[0], fourier=1)["mean_velocity"]
    best = fastest(*SETS[0], **shape)
    assert sine < best["mean_velocity"] < verge(*SETS[0])
    assert best["relative_acceleration"] < 60.0 * (1 + 1e-9)
    assert best["stroke"] < 0.01 * (1 + 1e-9)


def test_closed_starts_are_at_least_as_good_and_one_seed_is_one_result():
    asked = dict(
        over={"drive.amplitude": (2e-4, 8e-4), "drive.omega": (150.0, 250.0)},
        maximise="mean_velocity",
        subject_to={"relative_acceleration": (None, 30.0)},
    )
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    one, two = (ss.optimise(rig, **asked, starts=None, seed=3, workers=n) for n in (1, 2))
    assert one.model == two.model
    assert one["mean_velocity"] == two["mean_velocity"]
    # grid by hand: V grows with the amplitude along the limit A omega^2 = 30
    omega = np.sqrt(30.0 / 8e-4)
    assert one["mean_velocity"] == pytest.approx(
        float(ss.periodic_orbit(rig.replace({"drive.amplitude": 8e-4, "drive.omega": omega})).mean_velocity), rel=1e-6
    )
    assert set(one.active) == {"relative_acceleration", "drive.amplitude"}


@pytest.mark.parametrize("incline", ["folded", pytest.param("gravity", marks=pytest.mark.slow)])
def test_the_cheapest_sine_at_a_speed_never_slips_back(incline):
    # friction takes mu_plus (M + m) g for each metre forwards and more for each metre back: the cost is mu_plus at least, and is
    # mu_plus for all that never slip back. With gravity along the track it is mu cos - sin, which is what is folded in (Eq. 4.1)
    over = {"drive.amplitude": (1e-4, 1.5e-3), "drive.omega": (60.0, 300.0)}
    rig = ss.presets.piezo_rig(tilt_deg=3.0, amplitude=7e-4, law="coulomb", incline=incline)
    best = ss.optimise(rig, over=over, minimise="cost_of_transport", subject_to={"mean_velocity": (2e-3, None)}, starts=None)
    least = ss.presets.piezo_rig(tilt_deg=3.0, amplitude=7e-4, law="coulomb").friction.mu_plus
    assert best["cost_of_transport"] == pytest.approx(least, rel=1e-9)
    assert best["mean_velocity"] >= 2e-3 * (1 - 1e-8)
    assert best["backward_fraction"] == 0.0


def test_a_search_climbs_by_exact_derivatives_of_all_that_has_them():
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=7e-4, law="coulomb", incline="gravity")
    ends = {"drive.amplitude": (6e-4, 1.2e-3), "drive.omega": (180.0, 300.0)}
    space = Unknowns(rig, [Varied(name, (name,), *pair) for name, pair in ends.items()], None)
    u = np.array([0.5, 0.5])
    for of in ("mean_velocity", "cost_of_transport", "drive_power", "friction_power"):
        found, slopes = Candidates(space, of, 1.0, []).slope(u), ss.optimisation.gradient(space.machine(u), of, wrt=list(ends))
        assert not slopes.notes
        # the unknowns' own slopes are differences of a line, known to 1e-16 / 1e-6
        assert found == pytest.approx([slopes[name] * (b - a) for name, (a, b) in ends.items()], rel=1e-8, abs=1e-12 * abs(slopes.value))


def test_the_best_phase_of_two_modules_is_opposite():
    module = ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude=6e-4, omega=65.4 * np.pi), ss.Coulomb(0.15, 0.21))
    pair = ss.Chain((module, module), link=ss.Spring(1200.0, 0.4), phases=(0.0, 1.0))
    best = ss.optimise(pair, over={"phases[1]": (0.5, 6.0)}, maximise="mean_velocity", starts=None)
    assert best["mean_velocity"] == pytest.approx(0.011119895989126, rel=1e-9)  # M2c, phase pi
    assert best.model.phases[1] == pytest.approx(math.pi, abs=1e-4)
    assert best.of_limit is None
    assert "no limit is known" in best.limit


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [100.0, 400.0, 1200.0, 1585.0, 3000.0, 10_000.0])
def test_no_phase_of_a_fine_grid_beats_the_best_phase(stiffness):
    best = ss.optimise(ss.presets.two_modules(stiffness=stiffness), over={"phases[1]": (0.0, math.pi)}, maximise="mean_velocity")
    grid = ss.sweep(ss.presets.two_modules, phase=np.linspace(0.0, math.pi, 721), stiffness=stiffness).mean_velocity
    assert best["mean_velocity"] >= float(grid.max()) * (1 - 1e-9)
    # a quarter of a degree from a maximum V is below it by less than a hundredth, unless the grid has missed a spike
    assert best["mean_velocity"] <= 1.01 * float(grid.max())


def test_a_stop_keeps_the_best_so_far():
    seen = []
    best = ss.optimise(
        robot(ss.drives.TwoPhase(stroke=0.01, u1=0.1, u2=0.1)), over={"drive.u1": (0.01, 0.4), "drive.u2": (0.01, 0.4)},
        maximise="mean_velocity",
        starts=None, progress=lambda tried, most: seen.append((tried, most)) or len(seen) < 4,
    )  # fmt: skip
    assert len(seen) == 4
    assert best.tried == seen[-1][0]
    assert any("stopped" in note for note in best.notes)
    assert best["mean_velocity"] > 0.0


@each_row("name", DRIVES)
def test_peaks_of_drives_are_those_of_a_fine_grid(name):
    drive = DRIVES[name].example()
    t = np.linspace(0.0, 1.0, 20001) * drive.period
    jumps = any(jump != 0.0 for _, jump in drive.jumps)
    found = {limit: float(peaks_of(drive, limit)) for limit in LIMITS}
    grid = {
        "stroke": np.ptp(drive.position(t)),
        "relative_velocity": abs(drive.velocity(t)).max(),
        "relative_acceleration": abs(drive.acceleration(t)).max(),
    }
    for limit in LIMITS if not jumps else ("stroke", "relative_velocity"):
        # a grid may miss a corner by half a step, 2.5e-5 of a period, in which a value changes by at most 8 times itself per period
        assert grid[limit] * (1 - 1e-9) <= found[limit] <= grid[limit] * (1 + 4e-4), limit
    assert not jumps or math.isinf(found["relative_acceleration"])


@pytest.mark.parametrize("form", [Waveform("pieces", 5), Waveform("fourier", 3), Waveform("spline", 6)], ids=lambda form: form.kind)
def test_waveforms_keep_their_limits_and_close(form):
    u = np.random.default_rng(5).random((unknowns_of(form), 40))
    scales = Scales(60.0, stroke=0.01, velocity=0.7)
    many = drive_of_waveform(form, u, scales)
    good = np.isfinite(many.period)
    assert good.sum() > 30
    for i in np.flatnonzero(good)[:10]:
        drive = drive_of_waveform(form, u[:, i], scales).replace()  # the record checks itself
        assert drive.period == pytest.approx(many.period[i], rel=1e-12)
        assert peaks_of(drive, "stroke") <= 0.01 * (1 + 1e-12)
        assert peaks_of(drive, "relative_velocity") <= 0.7 * (1 + 1e-12)
        assert peaks_of(drive, "relative_acceleration") <= 60.0 * (1 + 1e-9)


TWO = robot(ss.drives.TwoPhase(stroke=0.01, u1=0.1, u2=0.1))


@each_row(
    ("asked", "told"),
    [
        (dict(over={"drive": ss.optimisation.waveform(pieces=4), "drive.u1": (0.1, 0.2)}, subject_to=BOUNDED), "cannot both vary"),
        (dict(over={"drive.u1": (0.2, 0.1)}), r"type \(0.1, 0.2\)"),
        (dict(over={"drive.u3": (0.1, 0.2)}), "did you mean"),
        (dict(over={"gravity": ss.optimisation.waveform(pieces=4)}, subject_to=BOUNDED), "is not a drive"),
        (dict(over={"drive": ss.optimisation.waveform(pieces=4)}), '"relative_acceleration"'),
        (dict(over={"drive.u1": (0.1, 0.2)}, subject_to={"strok": (None, 0.01)}), "did you mean 'stroke'"),
        (dict(over={"drive.u1": (0.1, 0.2)}, subject_to={"friction_power": (None, 1.0)}), "is not a quantity that can be limited"),
        (dict(over={"drive.u1": (0.1, 0.2)}, subject_to={"stroke": (0.02, 0.01)}), "cannot be satisfied"),
        (dict(over={"drive.u1": (0.1, 0.2)}, subject_to={"stroke": (None, 0.001)}), "nearest: 0.01"),
        (dict(over={"drive.u1": (0.1, 0.2)}, minimise="drive_power"), "allowed is one of them"),
        (dict(over={"drive.u1": (0.1, 0.2)}, starts="open"), "starts=None"),
        (dict(over={}), "over = "),
        (dict(over={"drive.u1": (-0.2, -0.1)}), "a positive velocity"),
        (dict(over={"friction.mu_plus": (-0.1, 0.3)}), r"zero or more; type \(0, 0\.3\)"),
        (dict(over={"drive.u1": (float("nan"), 0.2)}), "finite bounds"),
        (dict(over={"drive.u1": "12"}), "not two numbers"),
        (dict(over={"drive.u1": ("0.1", "0.2")}), "'0.1' is not a number"),
        (dict(over={"drive.u1": ("1 mm", "2 mm")}), "unit of position"),
        (dict(over={"drive.u1": (False, True)}), "False is not a number"),
        (dict(over={"drive.u1": (None, 0.2)}), "a bound is missing"),
        (dict(over={"drive.u1": (0.1, 0.2)}, subject_to={"stroke": (None, "x")}), "'x' is not a number"),
        (dict(over={"drive.u1": (0.1, 0.2)}, robust={"friction.mu_plus": ("uniform", -0.2, 0.1)}), "in the sample, mu_plus"),
        (dict(over={"drive.u1": (0.1, 0.2)}, robust={"friction.mu_plus": ("gamma", 0.1, 0.2)}), '"uniform", low, high'),
        (dict(over={"drive.u1": (0.1, 0.2)}, robust="worst"), "or a Fit"),
    ],
)  # fmt: skip
def test_bad_input_says_what_to_type(asked, told):
    with pytest.raises(ss.InputError, match=told):
        ss.optimise(TWO, maximise="mean_velocity", **asked)


def test_waveforms_have_no_pieces_that_are_shorter_than_any_actuator_can_tell():
    # one tiny acceleration against seven of the other sign: the motion closes with pieces of 1e-18 of the period, on which runs went wrong
    rng = np.random.default_rng(0)
    u = rng.random((17, 500))
    u[:7], u[7] = 0.5 * u[:7], 0.5 + 10.0 ** rng.uniform(-6, -1, 500)
    drive = drive_of_waveform(Waveform("pieces", 8), u, Scales(60.0, stroke=0.01))
    shares = np.array(drive.durations) / drive.period
    made = np.isfinite(shares).all(axis=0)
    assert 0 < made.sum() < 500
    assert shares[:, made].min() > 0.9e-9


def test_a_batch_has_no_best():
    with pytest.raises(ss.InputError, match="is a batch"):
        ss.optimise(TWO.replace(gravity=np.array([9.0, 10.0])), over={"drive.u1": (0.1, 0.2)}, maximise="mean_velocity")


def test_bounds_and_limits_are_typed_with_units():
    problems = Problems("optimise")
    (varied,) = checked_over(TWO, {"drive.u1": ("10 mm/s", 0.8)}, problems)
    (limit,) = checked_limits(TWO, {"stroke": (None, "1 cm")}, problems)
    problems.check()
    assert (varied.low, varied.high, limit.high) == (0.01, 0.8, 0.01)


def test_candidates_that_the_record_refuses_with_a_number_of_the_sample_are_not_run():
    # static friction is never less than sliding friction: 0.2 is no candidate where static friction may be 0.15
    made = robot(ss.Harmonic.example(), law=ss.Stribeck(0.1, 0.1, 0.3, 0.3, 1e-3))
    space = Unknowns(made, [Varied("friction.mu_plus", ("friction.mu_plus",), 0.1, 0.2)], None)
    worth = Candidates(space, "mean_velocity", -1.0, [], sample={"friction.f_plus": np.array([0.15, 0.25])})
    machines, good = worth._machines(np.array([[0.0], [0.4], [1.0]]))
    assert good.tolist() == [0, 1]
    assert machines.friction.mu_plus.tolist() == pytest.approx([0.1, 0.14])


def test_a_waveform_is_of_one_kind():
    with pytest.raises(ss.InputError, match="exactly one"):
        ss.optimisation.waveform(pieces=3, fourier=2)
    with pytest.raises(ss.InputError, match="whole number"):
        ss.optimisation.waveform(pieces=1)


@pytest.mark.slow
def test_a_robust_drive_keeps_its_speed_on_a_fresh_sample():
    # the nominal optimum waits on the verge of slipping back, which a smaller coefficient of friction makes it do
    made, uncertain = robot(ss.drives.ThreePhase.example()), {"friction.mu_minus": ("uniform", 0.22, 0.28)}
    asked = dict(
        over={"drive.u1": (0.01, 1.0), "drive.w1": (1.0, 60.0), "drive.w2": (1.0, 60.0), "drive.w3": (1.0, 60.0)},
        maximise="mean_velocity", subject_to={"stroke": (None, 0.01)},
    )  # fmt: skip
    nominal, robust = ss.optimise(made, **asked), ss.optimise(made, **asked, robust=uncertain, quantile=0.05)
    fresh = [ss.optimisation.propagate(best.model, uncertain, samples=2048, seed=99).quantile(0.05) for best in (nominal, robust)]
    assert fresh[1] > 1.02 * fresh[0]
    assert robust.robust == pytest.approx(fresh[1], rel=5e-3)
    assert robust["mean_velocity"] < nominal["mean_velocity"]


def test_what_is_uncertain_cannot_vary():
    with pytest.raises(ss.InputError, match="is uncertain and"):
        ss.optimise(
            TWO, over={"friction.mu_plus": (0.1, 0.2)}, maximise="mean_velocity", robust={"friction.mu_plus": ("uniform", 0.13, 0.17)}
        )
    with pytest.raises(ss.InputError, match=r"quantile=0\.05"):
        ss.optimise(TWO, over={"drive.u1": (0.1, 0.2)}, maximise="mean_velocity", quantile=0.05)


def test_a_front_is_not_beaten_by_a_grid():
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    over = {"drive.amplitude": (3e-4, 8e-4), "drive.omega": (150.0, 260.0)}
    front = ss.optimisation.pareto(rig, over=over, maximise="mean_velocity", minimise="drive_power", points=4)
    grid = ss.sweep(rig, **{name: np.linspace(*ends, 61) for name, ends in over.items()})
    assert front.sizes["point"] >= 3
    assert (front.mean_velocity.diff("point") > 0).all()
    assert (front.drive_power.diff("point") > 0).all()
    for power, V in zip(front.drive_power.values, front.mean_velocity.values, strict=True):
        assert float(grid.mean_velocity.where(grid.drive_power <= power).max()) <= V * (1 + 1e-6)
    assert set(over) <= set(front.data_vars)


def test_a_front_needs_two_quantities():
    with pytest.raises(ss.InputError, match="two quantities"):
        ss.optimisation.pareto(TWO, over={"drive.u1": (0.1, 0.2)}, maximise="mean_velocity", minimise="mean_velocity")


def test_a_motion_that_is_continued_is_told_beside_the_one_from_rest():
    # A = 0.8 mm, f0 = 0.5: V near .0020 and .0036; between 0.742 and 0.802 mm both exist, above only the faster one
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8.5e-4, f0=0.5)
    best = rig.replace({"drive.amplitude": 7.9e-4})
    from_rest = ss.mean_velocity(ss.solve(best, periods=200, settle=150))
    way = continued(rig, best, {"drive.amplitude": 7.9e-4})
    assert from_rest < 2.3e-3
    assert way > 3.2e-3
    assert continued(rig, rig.replace(drive=ss.drives.TwoPhase.example()), {"drive.u1": 0.1}) is None


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_search_leaves_a_plateau_of_rest(seed):
    # the body moves only where three harmonics nearly add up, 2 % above break-away: nearly all of the box is rest
    omega, total = 100.0, 1.02 * 0.15 * G / MU
    most = [total / 3 / (k * omega) ** 2 for k in (1, 2, 3)]
    made = robot(ss.MultiHarmonic(omega=omega, amplitudes=tuple(0.5 * a for a in most), phases=(0.0, 0.0, 0.0)))
    over = {f"drive.amplitudes[{i}]": (1e-3 * a, a) for i, a in enumerate(most)} | {f"drive.phases[{i}]": (-3.0, 3.0) for i in range(3)}
    best = ss.optimise(made, over=over, maximise="mean_velocity", starts=None, seed=seed)
    assert best["mean_velocity"] > 0.0
    assert set(best.active) == {f"drive.amplitudes[{i}]" for i in range(3)}
    # where all peaks come together, in the middle of the period or anywhere else: shifting time changes no speed
    together = made.replace({f"drive.amplitudes.{i}": a for i, a in enumerate(most)} | {f"drive.phases.{i}": np.pi / 2 for i in range(3)})
    assert best["mean_velocity"] >= ss.periodic_orbit(together).mean_velocity * (1 - 1e-6) > 0.0


def test_bounds_and_limits_may_have_units():
    robot = ss.presets.piezo_rig(tilt_deg=3.0, amplitude=5e-4, law="coulomb")
    over = {"drive.amplitude": ("0.1 mm", "0.7 mm"), "drive.omega": ("10 Hz", "100 rad/s")}
    noted = Problems("optimise")
    found = {each.name: (each.low, each.high) for each in checked_over(robot, over, noted)}
    assert found == {"drive.amplitude": (1e-4, 7e-4), "drive.omega": (pytest.approx(20 * np.pi), 100.0)}
    [stroke, speed] = checked_limits(robot, {"stroke": (None, "1.4 mm"), "mean_velocity": ("1 mm/s", None)}, noted)
    assert stroke.high == pytest.approx(1.4e-3) and speed.low == pytest.approx(1e-3) and noted.mistakes == []
    checked_over(robot, {"drive.amplitude": ("1 s", "2 s"), "drive.frequency": (1.0, 2.0)}, noted)
    assert (
        "allowed is (low, high)" in noted.mistakes[0] and 'the frequency is omega, in rad/s; type drive.omega="40 Hz"' in noted.mistakes[1]
    )


def test_the_mean_velocity_is_maximised_if_nothing_is_said():
    found = ss.optimise(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), over={"drive.amplitude": ("0.2 mm", "0.8 mm")})
    assert found.of == "mean_velocity" and found.search.maximised and "drive.amplitude = 0.0008" in repr(found)


def test_a_limit_of_one_number_is_one_problem_with_what_to_type():
    with pytest.raises(ss.InputError) as error:
        ss.optimise(
            ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"),
            over={"drive": ss.optimisation.waveform(pieces=3)},
            subject_to={"stroke": "0.7 mm", "relative_acceleration": (None, 60.0)},
        )
    assert len(error.value.problems) == 1 and "type subject_to={\"stroke\": (None, '0.7 mm')}" in error.value.problems[0]


def test_an_optimum_at_an_edge_says_so():
    """Static above kinetic friction: on the verge of slipping back a motion 4 % slower is reached from rest, as the runs show."""
    law = ss.Coulomb(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24)
    robot = ss.Robot(
        body_mass=0.06, inner_mass=0.01, drive=ss.Harmonic(3.5e-4, frequency=40.0), friction=law, track=ss.Incline(tilt="3 deg")
    )
    limits = {"stroke": (None, "0.7 mm"), "relative_acceleration": (None, 60.0)}
    best = ss.optimise(robot, over={"drive": ss.optimisation.waveform(pieces=3)}, subject_to=limits)
    beside = [ss.mean_velocity(ss.solve(best.model.replace(body_mass=0.06 * (1 + d)), periods=100)) for d in (-1e-4, 1e-4)]
    note = next(note for note in best.notes if note.startswith("the optimum is at an edge"))
    assert min(beside) < 0.97 * best["mean_velocity"] and 'robust={"' in note and "instead of 0.01694" in note
    sine = ss.optimise(robot, over={"drive.omega": ("10 Hz", "40 Hz")})
    assert not any("edge" in note for note in sine.notes)
