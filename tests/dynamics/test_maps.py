"""Maps: the Coulomb robot's against its exact borders, refined ones against filled ones, and their pictures."""

from __future__ import annotations

import json

import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.analysis import closed_form
from stickslip.analysis.coulomb_borders import border_functions
from stickslip.solvers import set_valued as exact
from stickslip.solvers.coulomb_steady_motions import orbit_rows

RIG, UNIT = ss.presets.piezo_rig, ss.presets.coulomb_robot


def alphas(size):
    """Each in (0, 1.6]."""
    return np.linspace(1.6 / size, 1.6, size)


def judged(size, workers=1):
    """The (alpha_plus, alpha_minus) map against the borders: cells on the wrong side, and cells that a border cuts.

    A border cuts a cell if the type at one of the cell's four corners is another than at its middle.
    """
    a = alphas(size)
    grid = ss.map(UNIT, alpha_plus=a, alpha_minus=a, workers=workers)
    half = 0.5 * 1.6 / size
    middle = closed_form.coulomb_type(*np.meshgrid(a, a, indexing="ij"))
    corners = [closed_form.coulomb_type(*np.meshgrid(a + p * half, a + m * half, indexing="ij")) for p in (-1, 1) for m in (-1, 1)]
    cut = np.any([corner != middle for corner in corners], axis=0)
    return grid, (grid.motion_type.values != middle) & ~cut, cut


# the periodic motions ------------------------------------------------------------------------------------------------


def test_every_cell_is_on_the_right_side_of_the_exact_borders():
    grid, wrong, cut = judged(200)
    assert not wrong.any() and 0 < cut.sum() < 0.06 * cut.size
    assert (grid.status == 1).all() and (grid.period == 1).all()


@pytest.mark.slow
def test_every_cell_of_a_million_is_on_the_right_side():
    _, wrong, cut = judged(1000, workers=2)
    assert not wrong.any() and 0 < cut.sum() < 0.012 * cut.size


@each_row(
    ("plus", "minus", "kind", "w", "tol"),
    [
        (0.5, 1.2, "II", 0.201452203333669, 1e-12),  # T7
        (0.7, 0.9, "I", 0.0615227380297986, 1e-12),  # T8
        (0.4, 0.8, "III", 0.269172787549942, 1e-12),  # T9
        (0.4, 0.5, "IV", 0.122475359974498, 1e-12),  # T10
    ],
)
def test_known_motions(plus, minus, kind, w, tol):
    grid = ss.sweep(UNIT, alpha_plus=[plus, minus], alpha_minus=[minus, plus])
    assert grid.mean_velocity.values[0, 0] == pytest.approx(w, abs=tol)
    assert grid.mean_velocity.values[1, 1] == pytest.approx(-w, abs=tol)  # its mirror image
    assert grid.motion_type.values[0, 0] == grid.motion_type.values[1, 1] == kind


def test_the_formula_is_where_waiting_ends():
    """Strobe points by formula against thousands of periods of the mode machine, over the whole plane and with its edges."""
    rng = np.random.default_rng(5)
    plus, minus = rng.uniform(0.01, 1.2, (2, 400))
    plus[:4], minus[:4] = (1.0, 0.5, 0.3, 1.0), (1.0, 0.5, 1.0, 0.3)
    rows = np.stack([plus, minus, plus, minus, 0 * plus, 0 * plus], axis=1)
    mine, waited = orbit_rows(rows), exact.solve_rows(rows, 100_000, "auto")
    assert (mine["status"] == 1).all() and np.array_equal(mine["seg_count"], waited["seg_count"])
    for name in ("displacement", "v_max", "v_min", "seg_time"):
        np.testing.assert_allclose(mine[name], waited[name], rtol=0, atol=1e-11)  # waiting stops at 1e-14 over its rate
    np.testing.assert_allclose(mine["forward_way"] - mine["backward_way"], mine["displacement"], rtol=0, atol=1e-14)


def test_friction_takes_what_the_drive_gives():
    """In w: the work of the drive over the period is that of friction; the first by quadrature over the motion."""
    robot = UNIT(0.4, 0.8)
    run = ss.solve(robot, periods=20, settle=19)
    cell = ss.sweep(UNIT, alpha_plus=0.4, alpha_minus=0.8)
    assert float(cell.drive_power) == pytest.approx(ss.energy(run).actuator[-1] / run.period_time, rel=1e-12)
    assert float(cell.drive_power) == pytest.approx(ss.energy(run).friction[-1] / run.period_time, rel=1e-12)


# the borders ---------------------------------------------------------------------------------------------------------


def test_border_functions_are_zero_on_the_borders_of_the_truth():
    """T3 to T6."""
    for types, small, large in (
        (("III", "IV"), 0.537029272146315, 0.537029272146315),
        (("III", "IV"), 0.284485276155916, 2 * 0.284485276155916),
        (("I", "III"), 0.406899269748192, 2 * 0.406899269748192),
        (("II", "I"), 0.5, 1.0),
        (("II", "III"), 0.110433505278347, 0.9),
    ):
        for plus, minus in ((small, large), (large, small)):
            assert abs(float(border_functions(plus, minus)[types])) < 2e-12
    assert set(border_functions(0.5, 0.5)) == {("rest", "II"), ("II", "I"), ("II", "III"), ("I", "III"), ("III", "IV")}


def test_borders_over_amplitude_are_those_of_the_truth():
    """T P9: the borders in A at 1.7 degrees [mm], from a coarse map."""
    grid = ss.map(RIG, amplitude=np.linspace(2e-4, 8e-4, 25), tilt_deg=np.linspace(1.0, 2.4, 15), law="lugre")
    told = {("rest", "II"): 0.26545, ("II", "I"): 0.37027, ("I", "III"): 0.55297, ("III", "IV"): 0.64711}
    found = {}
    for curve in ss.dynamics.coulomb_borders(grid):
        if curve.y.min() < 1.7 < curve.y.max():
            order = np.argsort(curve.y)
            found[curve.types] = 1e3 * np.interp(1.7, curve.y[order], curve.x[order])
    assert set(told) <= set(found)
    for types, amplitude in told.items():
        assert found[types] == pytest.approx(amplitude, abs=2e-5)  # printed digits, and the spline between 15 tilts


def test_no_borders_without_a_coulomb_twin():
    grid = ss.map(RIG, amplitude=[1e-4, 2e-4], tilt_deg=[1.0, 2.0]).drop_vars(["alpha_plus", "alpha_minus"])
    with pytest.raises(ss.InputError, match="no alpha_plus and alpha_minus"):
        ss.dynamics.coulomb_borders(grid)
    with pytest.raises(ss.InputError, match="allowed are two of numbers"):
        ss.dynamics.coulomb_borders(ss.sweep(RIG, amplitude=[1e-4, 2e-4], tilt_deg=1.0))


# refining ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["coulomb", "lugre"])
def test_a_refined_map_is_the_filled_one_at_a_fraction_of_the_work(law):
    axes = dict(amplitude=np.linspace(1e-4, 8e-4, 129), omega=np.linspace(60, 300, 97), tilt_deg=1.7, law=law)
    fine, full = ss.map(RIG, refine=True, coarse=17, **axes), ss.map(RIG, **axes)
    computed = (fine.status != 102).values
    assert computed.mean() < 0.35 and json.loads(fine.attrs["refined"])["computed"] == computed.sum()
    differ = (fine.motion_type != full.motion_type).values
    assert differ.mean() < (0.0 if law == "coulomb" else 1e-3) + 1e-12  # LuGre: a sliver of "other" thinner than a coarse cell
    assert np.array_equal(fine.mean_velocity.values[computed], full.mean_velocity.values[computed])
    scale = float(abs(full.mean_velocity).max())
    assert float(abs(fine.mean_velocity - full.mean_velocity).max()) < 0.02 * scale  # straight lines over a coarse cell


def test_a_refined_map_finds_what_only_its_edges_show():
    """A thin region that crosses two coarse cells: found in one of them, it is followed into the next."""
    calls = []

    def maker(a, b):
        inside = abs(a - b - 0.05) < 0.02
        calls.append(np.size(a))
        return UNIT(np.where(inside, 0.3, 0.7), np.where(inside, 0.3, 0.9))

    x = np.linspace(0, 1, 65)
    fine, full = (ss.map(maker, a=x, b=x, **kw) for kw in (dict(refine=True, coarse=17), {}))
    assert np.array_equal(fine.motion_type, full.motion_type) and "IV" in fine.motion_type.values


def test_refining_says_what_it_cannot_do(tmp_path):
    axes = dict(amplitude=[1e-4, 2e-4], omega=[100.0, 200.0], tilt_deg=1.7)
    with pytest.raises(ss.InputError, match="out cannot go with refine=True"):
        ss.map(RIG, refine=True, out=tmp_path / "study", **axes)
    with pytest.raises(ss.InputError, match=r"only axis is amplitude; .*exactly two, of numbers; .*plot.line_cut\(grid, \"amplitude\"\)"):
        ss.map(RIG, refine=True, amplitude=[1e-4, 2e-4], tilt_deg=1.7)
    with pytest.raises(ss.InputError, match="exactly two, of numbers"):
        ss.map(RIG, law=["lugre", "coulomb"], amplitude=[1e-4, 2e-4], tilt_deg=1.7)
    with pytest.raises(ss.InputError, match=r"out cannot go with refine=True(.|\n)*coarse = 1"):
        ss.map(RIG, refine=True, coarse=1, out=tmp_path / "study", **axes)
    marked = ss.map(RIG, refine=True, coarse=2, amplitude=[1e-4, np.nan, 3e-4], omega=[100.0, 200.0, 210.0], tilt_deg=1.7, law="coulomb")
    assert (marked.status.values[1] == 5).any()


@each_row("more", [{"mu0": [0.18, 0.2]}, {"law": ["coulomb", "lugre"]}, {"continue_along": "amplitude"}])
def test_a_map_that_is_no_plane_is_refused_before_the_work(tmp_path, more):
    axes = dict(amplitude=[1e-4, 2e-4], omega=[100.0, 200.0], tilt_deg=1.7, **more)
    with pytest.raises(ss.InputError, match="exactly two, of numbers"):
        ss.map(RIG, out=tmp_path / "study", **axes)
    assert not (tmp_path / "study").exists()


# pictures ------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def plane():
    return ss.map(RIG, amplitude=np.linspace(1e-4, 8e-4, 40), omega=np.linspace(60, 300, 40), tilt_deg=1.7, law="coulomb")


def test_the_motion_map_names_its_regions_and_draws_the_exact_borders(plane):
    ax = ss.plot.motion_map(plane)
    named = {text.get_text() for text in ax.texts} | {text.get_text() for text in ax.get_legend().get_texts()}
    assert {"rest", "I", "II", "III", "IV", "Coulomb, exact"} <= named
    assert ax.get_xlabel() == "amplitude of the inner mass $A$ (µm)" and "rad/s" in ax.get_ylabel()
    assert len(ax.lines) >= 8  # four borders, each with a white edge
    turned = ss.plot.motion_map(plane, x="omega", borders=False)
    assert "rad/s" in turned.get_xlabel() and not turned.lines


def test_borders_of_another_law_than_the_maps_are_drawn_only_when_asked_for():
    axes = dict(amplitude=np.linspace(1e-4, 8e-4, 12), omega=np.linspace(60, 300, 12), tilt_deg=1.7)
    static = ss.map(RIG, law="coulomb-static", **axes)
    assert not ss.plot.motion_map(static).lines  # it breaks away later than its twin
    twin = ss.plot.motion_map(static, borders="twin")
    assert len(twin.lines) >= 8 and "Coulomb twin" in {text.get_text() for text in twin.get_legend().get_texts()}


def test_axes_are_logarithmic_where_values_are_spaced_so(plane):
    spaced = ss.map(RIG, amplitude=np.geomspace(1e-4, 1e-2, 12), omega=np.linspace(60, 300, 9), tilt_deg=1.7, law="coulomb")
    for draw in (ss.plot.motion_map, ss.plot.velocity_map):
        ax = draw(spaced, x="omega")
        assert (ax.get_xscale(), ax.get_yscale()) == ("linear", "log") and ax.get_ylim() == pytest.approx((0.1, 10.0))
        corners = np.asarray(ax.collections[0].get_coordinates())[:, 0, 1]  # each cell reaches half way, by a factor, to its neighbours
        assert corners[1:-1] == pytest.approx(1e3 * np.sqrt(spaced.amplitude.values[1:] * spaced.amplitude.values[:-1]), rel=1e-12)
    assert ss.plot.line_cut(spaced, "amplitude").get_xscale() == "log" and ss.plot.line_cut(plane, "amplitude").get_xscale() == "linear"
    diagram = ss.bifurcation(RIG, parameter="mu0", values=np.geomspace(0.1, 0.3, 4), settle=5, points=2, follow=False, amplitude=6e-4,
                             tilt_deg=0.5, law="coulomb")  # fmt: skip
    assert ss.plot.bifurcation(diagram).get_xscale() == "log"


def test_each_drawn_region_has_the_colour_of_its_type(plane):
    from matplotlib.colors import to_rgba

    from stickslip.show.figures.maps import TYPE_COLOURS

    mesh = ss.plot.motion_map(plane).collections[0]
    mesh.update_scalarmappable()
    shown = mesh.get_facecolors().reshape(40, 40, 4)
    for i, j in ((0, 0), (39, 39), (20, 30), (30, 20)):
        assert shown[j, i] == pytest.approx(to_rgba(TYPE_COLOURS[str(plane.motion_type.values[i, j])]))


def test_neighbouring_types_differ_in_grey_too():
    from matplotlib.colors import to_rgb

    from stickslip.show.figures.maps import TYPE_COLOURS

    grey = {name: float(np.dot(to_rgb(c), (0.2126, 0.7152, 0.0722))) for name, c in TYPE_COLOURS.items()}
    for one, other in (("rest", "II"), ("presliding", "II"), ("II", "I"), ("I", "III"), ("III", "IV"), ("II", "III")):
        assert abs(grey[one] - grey[other]) > 0.03, (one, other)


def test_the_velocity_map_marks_the_best_point(plane):
    ax = ss.plot.velocity_map(plane)
    (star,) = [line for line in ax.lines if line.get_marker() == "*"]
    i, j = np.unravel_index(np.argmax(plane.mean_velocity.values), (40, 40))
    assert star.get_xdata()[0] == pytest.approx(1e6 * plane.amplitude.values[i]) and star.get_ydata()[0] == plane.omega.values[j]
    assert f"{1e3 * float(plane.mean_velocity.max()):.3g} mm/s" in [t.get_text() for t in ax.texts]


def test_both_maps_have_one_frame_and_say_the_law_and_what_stays(plane):
    for draw in (ss.plot.motion_map, ss.plot.velocity_map):
        for borders in (True, False):
            ax = draw(plane, borders=borders)
            assert ax.get_xlim() == pytest.approx((100, 800)) and ax.get_ylim() == pytest.approx((60, 300))
            assert ax.get_title(loc="left") == "Coulomb, $θ$ = 1.7°"


def test_names_of_regions_stand_inside_the_frame_of_a_coarse_map():
    coarse = ss.map(RIG, amplitude=np.linspace(2e-4, 8e-4, 9), tilt_deg=np.linspace(0.5, 4, 9), law="coulomb")
    ax = ss.plot.motion_map(coarse)
    ax.figure.canvas.draw()
    frame = ax.get_window_extent()
    for text in ax.texts:
        box = text.get_window_extent()
        assert frame.x0 < box.x0 and box.x1 < frame.x1 and frame.y0 < box.y0 and box.y1 < frame.y1, text.get_text()


def test_borders_in_the_velocity_map_are_named_and_lie_near_the_exact_ones(plane):
    ax = ss.plot.velocity_map(plane)
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["border of motion types"]
    exact = np.concatenate([np.column_stack([1e6 * b.x / 17.9, b.y / 6.15]) for b in ss.dynamics.coulomb_borders(plane)])  # in cells
    for line in ax.lines:
        if line.get_marker() != "*":
            drawn = np.column_stack(line.get_data()) / (17.9, 6.15)
            away = np.sqrt(((drawn[::9, None] - exact[None]) ** 2).sum(axis=-1)).min(axis=1)
            assert np.median(away) < 0.6 and away.max() < 2.5  # where three types meet, corners are rounded off most


def test_specks_of_another_type_have_no_border(plane):
    spotted = plane.copy(deep=True)
    spotted["motion_type"][5, 5] = spotted["motion_type"][5, 6] = "other"
    clean, dirty = (len(ss.plot.velocity_map(grid).lines) for grid in (plane, spotted))
    assert clean == dirty


def test_symbols_at_the_end_of_a_name_are_set_as_symbols():
    grid = ss.sweep(RIG, v_s=[1e-3, 2e-3], mu0=[0.1, 0.2], amplitude=5e-4, tilt_deg=1.7, periods=3)
    ax = ss.plot.velocity_map(grid)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Stribeck velocity $v_{s}$ (mm/s)", "kinetic friction coefficient $μ_{0}$")


def test_line_cuts(plane):
    ax = ss.plot.line_cut(plane, "amplitude", lines=[150.0, 250.0])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["152.3", "250.8"]
    curve = next(line for line in ax.lines if line.get_label() == "250.8")
    assert curve.get_ydata() == pytest.approx(1e3 * plane.mean_velocity.sel(omega=250.0, method="nearest").values)
    both = ss.sweep(RIG, amplitude=np.linspace(4e-4, 1.2e-3, 9), tilt_deg=1.7, mu0=0.12, f0=0.6, continue_along="amplitude")
    assert {"up", "down"} == {t.get_text() for t in ss.plot.line_cut(both, "amplitude").get_legend().get_texts()}
    for bad, told in (
        (lambda: ss.plot.line_cut(plane, "mu0"), "is not an axis"),
        (lambda: ss.plot.line_cut(plane, "omega", {"f0": 1}), "at has f0"),
    ):
        with pytest.raises(ss.InputError, match=told):
            bad()


def test_maps_draw_into_given_axes_and_save(plane, tmp_path):
    fig, (left, right) = plt.subplots(1, 2)
    assert ss.plot.motion_map(plane, ax=left) is left and ss.plot.velocity_map(plane, ax=right, borders=False) is right
    for suffix in ("png", "pdf", "svg"):
        fig.savefig(tmp_path / f"map.{suffix}")
        assert (tmp_path / f"map.{suffix}").stat().st_size > 5000
