"""The atlas: regions against brute force, borders against closed forms and one-parameter values, and what is interrupted goes on."""

import json

import numpy as np
import pytest

import stickslip as ss
from every import DEN_HARTOG
from stickslip.analysis.closed_form import coulomb_type
from stickslip.dynamics.atlas import atlas as making_an_atlas
from stickslip.dynamics.atlas.borders_followed import Border
from stickslip.dynamics.atlas.levels import RefinementLevel
from stickslip.dynamics.atlas.motions_on_the_grid import MotionThere, PointOfGrid, with_more
from stickslip.dynamics.atlas.parameter_plane import plane_over
from stickslip.dynamics.atlas.uncertain_places import UncertainPlaces
from stickslip.show.reports import atlas_page

RIG = {"tilt_deg": 1.7, "law": "coulomb"}
OVER = {"amplitude": [3.3e-4, 3.5e-4, 3.7e-4, 3.9e-4], "mu0": [0.165, 0.175, 0.185]}


def strengths(amplitude, mu0):
    """alpha_plus and alpha_minus: the friction limits over the amplitude of the drive's force."""
    robot = ss.presets.piezo_rig(amplitude=amplitude, mu0=mu0, **RIG)
    drive, whole = robot.drive, robot.body_mass + robot.inner_mass
    force = robot.inner_mass * drive.amplitude * drive.omega**2
    return robot.friction.mu_plus * whole * robot.gravity / force, robot.friction.mu_minus * whole * robot.gravity / force


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("atlas") / "kept"


@pytest.fixture(scope="module")
def found(folder):
    return ss.atlas(ss.presets.piezo_rig, over=OVER, out=folder, **RIG)


def test_a_border_that_is_known_in_closed_form_is_found_to_rounding(found):
    (border,) = found.borders
    p, q = np.array(border.values).T
    assert border.kind == "type-border" and np.ptp(q) > 0.9 * 0.02
    assert np.max(abs(strengths(p, q)[1] - 1.0)) < 1e-12  # types I and II meet where alpha_minus is 1
    assert np.max(border.accuracy) < 1e-12


def test_special_points_are_those_of_one_parameter_with_their_accuracy(found):
    assert found.special_points and not found.notes
    for point in found.special_points:
        assert point.stable and abs(strengths(*point.values)[1] - 1.0) < 1e-12 + max(point.accuracy) / 1e-4
    level = found.special_points[0].values[1]
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3.9e-4, stop=3.3e-4, step=0.2, mu0=0.17, **RIG)
    (special,) = branch.special  # at a value that the atlas has not: its curve passes there
    p, q = np.array(found.borders[0].values).T
    order = np.argsort(q)
    assert abs(np.interp(0.17, q[order], p[order]) - special.value) < 1e-9 and level != 0.17


def test_regions_are_those_of_brute_force_at_random_points(found):
    random = np.random.default_rng(20261123)
    p, q = random.uniform(3.3e-4, 3.9e-4, 40), random.uniform(0.165, 0.185, 40)
    runs = ss.solve(ss.presets.piezo_rig(amplitude=p, mu0=q, **RIG), periods=200, settle="auto", keep="summary")
    assert [found.at(amplitude=a, mu0=m) for a, m in zip(p, q, strict=True)] == [(word,) for word in runs.motion_type]
    assert set(runs.motion_type) == {"I", "II"} == set(found.regions)


def test_the_former_name_of_special_points_is_an_error_that_says_the_new_one(found):
    with pytest.raises(AttributeError, match="'found'; type special_points"):
        _ = found.found


def test_what_is_kept_is_not_computed_again(found, folder, monkeypatch):
    def never(*arguments):
        raise AssertionError("it computes again")

    for name in ("motions_at", "follow_borders"):
        monkeypatch.setattr(making_an_atlas, name, never)
    again = ss.atlas(ss.presets.piezo_rig, over=OVER, out=folder, resume=True, **RIG)
    assert (again.points, again.borders, again.special_points, again.notes) == (
        found.points,
        found.borders,
        found.special_points,
        found.notes,
    )


def test_a_folder_of_another_atlas_is_refused(folder, found, tmp_path):
    with pytest.raises(ss.InputError, match="holds results of this atlas already; type resume=True"):
        ss.atlas(ss.presets.piezo_rig, over=OVER, out=folder, **RIG)
    with pytest.raises(ss.InputError, match="another atlas"):
        ss.atlas(ss.presets.piezo_rig, over=OVER, out=folder, resume=True, starts=7, **RIG)
    with pytest.raises(ss.InputError, match="folder of an atlas"):
        ss.open_study(folder)
    (tmp_path / "points-0-000000.json").write_text("{")
    (tmp_path / "manifest.json").write_text((folder / "manifest.json").read_text())
    with pytest.raises(ss.InputError, match="cannot be read"):
        ss.atlas(ss.presets.piezo_rig, over=OVER, out=tmp_path, resume=True, **RIG)
    (tmp_path / "points-0-000000.json").write_text(json.dumps([{"cell": 3}]))
    with pytest.raises(ss.InputError, match="cannot be read"):
        ss.atlas(ss.presets.piezo_rig, over=OVER, out=tmp_path, resume=True, **RIG)


def stopping(after, how):
    """A callback that stops the work once something is there."""

    def told(now):
        if now.done >= after:
            return how()

    return told


def ctrl_c():
    raise KeyboardInterrupt


@pytest.mark.parametrize("how", [lambda: False, ctrl_c], ids=["False", "Ctrl-C"])
def test_an_interrupted_atlas_keeps_what_is_there_and_goes_on(found, tmp_path, how, monkeypatch):
    monkeypatch.setattr(making_an_atlas, "_TILE", 4)
    monkeypatch.setattr("stickslip.studies.progress.PAUSE", 0.0)
    part = ss.atlas(ss.presets.piezo_rig, over=OVER, out=tmp_path, progress=stopping(8, how), branches=0, **RIG)
    assert 0 < len(part.points) < 12 and part.notes[0].startswith(("interrupted", "stopped by progress"))
    assert (part.map["count"] == -1).sum() == 12 - len(part.points)
    whole = ss.atlas(ss.presets.piezo_rig, over=OVER, out=tmp_path, resume=True, branches=0, **RIG)
    assert whole.points == found.points and "interrupted" not in "".join(whole.notes)


def test_results_do_not_depend_on_threads(found, monkeypatch):
    monkeypatch.setattr(making_an_atlas, "_TILE", 3)
    assert ss.atlas(ss.presets.piezo_rig, over=OVER, branches=0, workers=2, **RIG).points == found.points


def test_an_atlas_has_a_dataset_a_figure_a_face_and_a_page(found):
    assert found.map.motion.sel(amplitude=3.9e-4, mu0=0.165).values.tolist() == ["I"] and found.map.share.units == "1"
    assert found.special.kind.values.tolist() == ["type-border"] * len(found.special_points)
    axes = found.plot()
    assert len(axes.lines) == 2 and {text.get_text() for text in axes.texts} == {"I", "II"}  # the border, black on white
    page = atlas_page(found, "Where it walks")
    assert "Special points, to the digits that are certain." in page and found.rows()[0][1] in page
    assert "<b>Atlas over amplitude and mu0</b>" in found._repr_html_()


def test_the_border_of_rest_is_a_curve():
    """A robot moves where the force of its drive exceeds its friction: alpha_plus is 1 there."""
    found = ss.atlas(ss.presets.piezo_rig, over={"amplitude": [2.5e-4, 2.8e-4], "mu0": [0.175, 0.185]}, **RIG)
    (border,) = found.borders
    assert border.kind == "grazing" and not found.notes and set(found.regions) == {"rest", "II"}
    assert np.max(abs(strengths(*np.array(border.values).T)[0] - 1.0)) < 1e-11 and np.max(border.accuracy) < 1e-11


def test_two_motions_at_one_point_are_those_of_basins():
    found = ss.atlas(ss.presets.piezo_rig, over={"amplitude": [7.0e-4, 8.0e-4], "f0": [0.4, 0.5]}, tilt_deg=1.7, branches=0)
    (there,) = found.coexisting().values()
    basins = ss.basins(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, f0=0.5), v=np.linspace(-0.1, 0.1, 5), z=[-1e-6, 1e-6], settle=80)
    assert np.allclose(sorted(m.mean_velocity for m in there), sorted(a.mean_velocity for a in basins.attractors), rtol=1e-5)
    assert found.at(amplitude=8e-4, f0=0.5) == ("I", "I") and found.regions["2 × I"] == 0.25
    assert "no motion was followed" in found.notes[-1]


def test_all_that_is_wrong_is_said_at_once():
    with pytest.raises(ss.InputError) as raised:
        ss.atlas(
            ss.presets.piezo_rig,
            over={"amplitude": [3e-4], "mu0": (0.2, 0.1)},
            starts=0,
            settle=0,
            branches=-1,
            refine=-1,
            rtol=2.0,
            resume=True,
        )
    assert len(raised.value.problems) == 8
    with pytest.raises(ss.InputError, match="two numbers of the machine by name"):
        ss.atlas(ss.presets.piezo_rig, over={"amplitude": (3e-4, 4e-4)}, **RIG)


def test_a_place_outside_is_refused_by_name(found):
    with pytest.raises(ss.InputError, match=r"allowed is a number from 0\.165 to 0\.185"):
        found.at(amplitude=3.5e-4, mu0=0.3)
    with pytest.raises(ss.InputError, match="allowed are both numbers"):
        found.at(amplitude=3.5e-4)


def test_numbers_of_a_machine_are_named_with_dots():
    robot = ss.presets.piezo_rig(amplitude=3.5e-4, mu0=0.18, **RIG)
    over = {"drive.amplitude": [3.4e-4, 3.8e-4], "friction.mu_minus": [0.2, 0.21]}
    assert set(ss.atlas(robot, over=over, branches=0, starts={"v": [0.0, 0.01]}).regions) == {"I", "II"}


@pytest.mark.slow
def test_the_whole_plane_of_the_coulomb_robot_is_that_of_the_closed_form():
    found = ss.atlas(ss.presets.piezo_rig, over={"amplitude": (2e-4, 9e-4), "mu0": (0.1, 0.3)}, **RIG)
    random = np.random.default_rng(7)
    p, q = random.uniform(2e-4, 9e-4, 1000), random.uniform(0.1, 0.3, 1000)
    plus, minus = strengths(p, q)
    told = np.array([" ".join(found.at(amplitude=a, mu0=m)) for a, m in zip(p, q, strict=True)])
    assert np.array_equal(told, coulomb_type(plus, minus))
    (rest,) = (border for border in found.borders if border.kind == "grazing")
    assert np.max(abs(strengths(*np.array(rest.values).T)[0] - 1.0)) < 1e-11 and not any("rest" in note for note in found.notes)


@pytest.mark.slow
def test_folds_and_flips_of_a_capsule_part_the_motions_that_brute_force_finds():
    over = {"omega": list(np.linspace(1.05, 1.13, 7)), "force_ratio": list(np.linspace(0.6, 1.2, 5))}
    found = ss.atlas(ss.presets.capsule, over=over, branches=12)
    assert {"flip", "fold"} & {border.kind for border in found.borders} and found.coexisting()
    for cell, motions in found.coexisting().items():
        robot = ss.presets.capsule(*found.plane.point(cell)[::-1])
        for motion in (m for m in motions if m.period):
            orbit = ss.periodic_orbit(robot, motion.period, guess=np.array(motion.state))
            assert orbit.stable and abs(orbit.mean_velocity - motion.mean_velocity) < 1e-6
    flips = [s for s in found.special_points if s.kind == "flip"]
    for flip in flips[:3]:  # each is the flip of the branch at that value, found from elsewhere
        omega, ratio = flip.values
        orbit = ss.periodic_orbit(ss.presets.capsule(force_ratio=ratio, omega=omega), guess=None)
        assert abs(np.min(orbit.multipliers.real) + 1.0) < 1e-5


def test_a_place_between_different_motions_without_a_border_is_in_doubt_and_others_are_not(found):
    assert found.doubt(amplitude=3.8e-4, mu0=0.17) == "" and set(found.map.doubt.values.ravel()) == {""}
    coarse = ss.atlas(ss.presets.piezo_rig, over=OVER, branches=0, **RIG)  # the same grid without its border
    (border,) = found.borders
    amplitude, mu0 = border.values[len(border.values) // 2]
    assert "no border between was located" in coarse.doubt(amplitude=amplitude, mu0=mu0)
    assert any("are in doubt" in note for note in coarse.notes)
    assert found.map.unseen.values.min() == pytest.approx(1 - 0.05 ** (1 / 5))  # 5 starts


def test_scattered_starts_are_others_at_each_point(found):
    here, there = (found.plane.states(np.zeros(1), cell) for cell in ((0, 0), (1, 2)))
    assert np.array_equal(here[0], there[0]) and not np.any(np.all(np.isclose(here[1:], there[1:]), axis=1))
    assert np.max(abs(np.vstack([here, there]))) <= 4 * np.max(found.plane.at.scales)


def by_closed_form(places):
    return [(str(name),) for name in coulomb_type(*strengths(*np.array(places).T))]


def test_cells_in_doubt_are_halved_and_places_that_are_sure_then_are_right():
    random = np.random.default_rng(20261124)
    places = np.column_stack([random.uniform(3.3e-4, 3.9e-4, 400), random.uniform(0.165, 0.185, 400)])
    doubtful = []
    for refine in (0, 1, 2):
        found = ss.atlas(ss.presets.piezo_rig, over=OVER, branches=0, refine=refine, **RIG)
        here = [{"amplitude": a, "mu0": m} for a, m in places]
        sure = np.array([not found.doubt(**place) for place in here])
        told = [found.at(**place) for place in here]
        assert [word for word, is_sure in zip(told, sure, strict=True) if is_sure] == by_closed_form(places[sure])
        assert len(found.closer) == refine and found.points.keys() == {(i, j) for i in range(4) for j in range(3)}
        doubtful.append(np.mean(~sure))
    # the border is a line, so the cells that it passes are as many as they are small
    assert doubtful[0] > 0.3 and doubtful[1] < 0.7 * doubtful[0] and doubtful[2] < 0.7 * doubtful[1]
    assert len(found.closer[1].points) < 0.7 * 13 * 9  # of the points of the whole grid at a quarter of a cell


def test_no_cell_is_halved_that_a_border_explains(found):
    assert found.closer == () and "halved" not in "".join(found.notes)


def test_finer_levels_are_kept_and_go_on(tmp_path, monkeypatch):
    options = {"over": OVER, "branches": 0, "out": tmp_path, **RIG}
    ss.atlas(ss.presets.piezo_rig, refine=1, **options)
    whole = ss.atlas(ss.presets.piezo_rig, refine=2, resume=True, **options)

    def never(*arguments):
        raise AssertionError("it computes again")

    monkeypatch.setattr(making_an_atlas, "motions_at", never)
    again = ss.atlas(ss.presets.piezo_rig, refine=2, resume=True, **options)
    assert [level.points for level in again.closer] == [level.points for level in whole.closer] and len(again.closer) == 2
    assert again.points == whole.points and again.notes == whole.notes


def test_a_point_whose_starts_missed_a_motion_has_more_starts():
    here = PointOfGrid((MotionThere("I", 1, 0.1, (0.0,), 5), MotionThere("II", 1, 0.2, (0.5,), 0)))
    again = PointOfGrid((MotionThere("I", 1, 0.1, (0.0,), 12), MotionThere("II", 1, 0.2, (0.5,), 7), MotionThere("II", 1, 0.4, (0.6,), 1)))
    plane = plane_over("atlas", ss.presets.piezo_rig, OVER, 5, RIG, lambda problems: None)
    level = RefinementLevel(plane, {(1, 1): here, (1, 2): PointOfGrid((MotionThere("I", 1, 0.1, (0.0,), 5),))})
    ((cell, states),) = making_an_atlas._to_start_again(level).items()
    assert cell == (1, 1) and len(states) == 20
    both = with_more(plane, here, again, len(states))
    assert [(m.word, m.mean_velocity, m.hits) for m in both.motions] == [("I", 0.1, 17), ("II", 0.2, 7), ("II", 0.4, 1)] and both.more == 20
    assert not making_an_atlas._to_start_again(RefinementLevel(plane, {(1, 1): both}))
    assert not np.any(np.all(np.isclose(states[:, None], plane.states(np.zeros(1), (1, 1))[None, 1:]), axis=2))


def two_columns(first, second):
    """Doubts of a unit cell whose left corners have some motions and its right ones others, with borders as vertical lines."""
    plane = plane_over("atlas", ss.presets.piezo_rig, {"amplitude": [0.0, 1.0], "mu0": [0.0, 1.0]}, 5, RIG, lambda problems: None)
    points = {(i, j): PointOfGrid(tuple((first, second)[i])) for i in (0, 1) for j in (0, 1)}

    def doubts(**lines):
        borders = [Border(k.replace("_", "-"), ((p, -0.1), (p, 1.1)), ((0.0, 0.0),) * 2, "", (), ()) for k, p in lines.items()]
        return UncertainPlaces((RefinementLevel(plane, points),), tuple(borders), ())

    return doubts


def test_a_border_makes_a_place_sure_only_where_it_explains_all_that_changes_in_its_cell():
    one, two = MotionThere("I", 1, 0.1, (0.0,), 5), MotionThere("II", 1, 0.2, (0.5,), 5)
    doubled, wild = MotionThere("I, period 2", 2, 0.1, (0.0,), 5), MotionThere("no period", 0, 0.1, (0.0,), 5)
    here = (0.3, 0.4)
    assert two_columns([one], [one])().at(here) == ""
    renamed, gone = two_columns([one], [two]), two_columns([one, two], [two])
    assert "no border between was located" in renamed().at(here)
    assert renamed(type_border=0.6).at(here) == renamed(type_border=0.6).at((0.7, 0.4)) == gone(fold=0.6).at(here) == ""
    for doubts in (
        renamed(fold=0.6),  # a fold ends a motion, and makes no other
        renamed(type_border=0.6, grazing=0.5),  # and what is between them?
        gone(type_border=0.6),
        two_columns([one], [doubled])(flip=0.6),  # beyond a flip there may be a cascade
        two_columns([one, two], [wild, two])(flip=0.6),
        two_columns([one, doubled], [two])(fold=0.6),
    ):
        assert "do not explain all that changes" in doubts.at(here)


def test_the_atlas_of_a_flow_has_den_hartogs_border_of_rest():
    """Den Hartog 1931: it stops in every half period where the friction F exceeds V / sqrt(1/r^4 + U^2)."""

    def border_at(r):
        V, U = 1 / (1 - r**2), np.tan(np.pi / (2 * r)) / r
        return V / np.sqrt(1 / r**4 + U**2)

    found = ss.atlas(DEN_HARTOG, over={"F": [0.5, 0.58, 0.66], "r": [0.6, 0.66, 0.72]})
    (border,) = found.borders
    F, r = np.array(border.values).T
    assert np.ptp(r) > 0.1 and np.max(abs(F - border_at(r))) < 1e-10
    random = np.random.default_rng(3)
    for F, r in zip(random.uniform(0.5, 0.66, 40), random.uniform(0.6, 0.72, 40), strict=True):
        stops = found.at(F=F, r=r) == ("modes -1 0 1 0",)
        assert stops == (border_at(r) < F) and (stops or found.at(F=F, r=r) == ("modes -1 1",))
    assert np.isnan(found.map.mean_velocity.values).all() and not found.notes and found.doubt(F=0.64, r=0.62) == ""
    assert "grazing" in atlas_page(found, "Where it stops")


def test_the_atlas_of_a_map_has_the_flip_of_henons_fixed_point():
    """x' = 1 - a x^2 + y, y' = b x: the fixed point doubles its period at a = 3 (1 - b)^2 / 4."""
    henon = ss.SwitchingFlow.of_map(lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0]), {"a": 0.5, "b": 0.2}, ("x", "y"))
    found = ss.atlas(henon, over={"a": [0.3, 0.45, 0.55, 0.75], "b": [0.1, 0.2, 0.3]}, starts={"x": [0.0, 0.3], "y": [0.0]})
    flips = [border for border in found.borders if border.kind == "flip"]
    a, b = np.array(flips[0].values).T
    assert len(flips) == 1 and np.ptp(b) > 0.15 and np.max(abs(a - 0.75 * (1 - b) ** 2)) < 1e-9
    assert {motion.period for point in found.points.values() for motion in point.motions} >= {1, 2}
    for cell, point in found.points.items():
        a, b = found.plane.point(cell)
        assert (point.motions[0].period == 1) == (a < 0.75 * (1 - b) ** 2)


def test_motions_of_a_flow_without_a_period_are_not_taken_for_periodic_ones():
    """At one point of Henon's map there is irregular motion alone: a flow makes no way by which it would look like another."""
    henon = ss.SwitchingFlow.of_map(lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0]), {"a": 0.5, "b": 0.2}, ("x", "y"))
    found = ss.atlas(henon, over={"a": [1.0, 1.4], "b": [0.2, 0.3]}, starts={"x": [0.0, 0.3], "y": [0.0]}, branches=0, refine=0)
    assert found.at(a=1.4, b=0.3) == ("chaotic",)
