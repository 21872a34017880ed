"""Results show themselves in notebooks: a title, numbers rounded to what is known, and their figure, which is not a figure of pyplot."""

import base64
import html
import inspect
import re

import matplotlib.pyplot as plt
import numpy as np
import pytest

import every
import stickslip as ss
from rows import each_row
from stickslip.basics.notebook_display import Face, Text, rounded
from stickslip.show.reports.optimum import optimum_page

ROBOT = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")


@pytest.fixture(scope="module")
def results():
    run, chain = ss.solve(ROBOT, periods=20), ss.solve(ss.presets.two_modules(), periods=20)
    record = ss.virtual_rig(ROBOT, noise=1e-4, seed=1)
    fit = ss.identify(record, ss.presets.piezo_rig, free={"mu0": (0.05, 0.5)}, tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
    told = ss.verdict(ROBOT, periods=40, settle=40)
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=6e-4, stop=6.2e-4, tilt_deg=1.7, law="coulomb")
    spread = {"friction.mu_plus": (0.15, "3%")}
    return {
        "run": run, "chain": chain, "motion": ss.motion(run), "motions": ss.motion(chain), "energy": ss.energy(run), "fit": fit,
        "orbit": told.orbit, "verdict": told, "exponents": told.exponents, "branch": branch,
        "sensitivity": ss.dynamics.sensitivity(told.orbit),
        "bench": ss.bench(ss.Coulomb, experiments=["steady"]), "benches": ss.bench([ss.Coulomb, ss.Viscous], experiments=["steady"]),
        "comparison": ss.compare(record, ROBOT, laws=["coulomb"]), "propagated": ss.optimisation.propagate(ROBOT, uncertain=spread,
        samples=16),
        "optimum": ss.optimise(ROBOT, over={"drive.amplitude": (5e-4, 6e-4)}, maximise="mean_velocity"),
        "ranking": ss.identification.rank([fit, fit]),
    }  # fmt: skip


def test_every_result_has_a_face_and_a_picture(results):
    before = plt.get_fignums()
    for name, result in results.items():
        shown = result._repr_html_()
        pictures = re.findall(r'src="data:image/png;base64,([^"]+)"', shown)
        assert pictures, name
        assert all(base64.b64decode(picture).startswith(b"\x89PNG") for picture in pictures)
        assert "<b>" in shown and "nan" not in re.sub(r'src="[^"]+"', "", shown), name
    assert plt.get_fignums() == before  # a notebook would show those a second time


def test_what_a_function_returns_draws_itself_or_says_why_not():
    """Every class that a public function names as what it returns."""
    places = (ss, ss.dynamics, ss.analysis, ss.identification, ss.optimisation, ss.studies)
    functions = [f for place in places for f in (getattr(place, name) for name in dir(place)) if inspect.isfunction(f)]
    returned = {cls for f in functions for cls in _named(f) if cls.__module__.startswith("stickslip.")}
    without = {cls.__name__ for cls in returned if not callable(getattr(cls, "plot", None))}
    assert len(returned) > 25 and without == every.without_picture.keys()
    assert all(callable(getattr(cls, "plot", None)) for cls in _faces(Face))


def _named(function):
    """The classes in the annotation of what a function returns."""
    words = re.findall(r"\w+", str(inspect.signature(function).return_annotation))
    found = [inspect.unwrap(function).__globals__.get(word) for word in words]
    return [cls for cls in found if inspect.isclass(cls)]


def _faces(cls):
    return [sub for one in cls.__subclasses__() for sub in (one, *_faces(one))]


def test_a_face_says_what_the_result_holds(results):
    text = html.unescape(re.sub(r"<[^>]+>", " ", results["motion"]._repr_html_()))
    assert "+0−0" in text and "1 drive period" in text
    fit, error = results["fit"], results["fit"].errors["mu0"]
    assert rounded(fit.values["mu0"], error) in fit._repr_html_()
    assert f"{results['orbit'].mean_velocity:.9g} m/s" in results["orbit"]._repr_html_()
    assert results["verdict"].kind in results["verdict"]._repr_html_()


def test_numbers_of_optima_and_designs_have_units(results):
    best = html.unescape(re.sub(r"<[^>]+>", "|", results["optimum"]._repr_html_()))
    assert re.search(r"drive\.amplitude\|+[\d.e-]+\|+m\|", best) and re.search(r"relative_acceleration\|+[\d.]+\|+[\d.]+\|+m/s²\|", best)
    assert re.search(r"mean_velocity = 0\.0\d+ m/s\|", best) and re.search(
        r"= 0\.0\d+ m/s at drive\.amplitude = 0\.\d+ m; ", repr(results["optimum"])
    )
    page = optimum_page(results["optimum"], "A faster rig")
    assert "0.0005 to 0.0006 m<" in page and "m/s per rad/s" in page and "m/s per m<" in page
    asked = dict(experiments={"amplitude": [4e-4, 8e-4], "law": ["lugre"]}, noise=1e-3, samples=200, tilt_deg=1.7)
    plan = ss.identification.design(ss.presets.piezo_rig, free={"mu0": 0.18, "sigma0": 4e5}, **asked)
    assert {e.words for e in plan.experiments} == {f"amplitude = {A} m, law = lugre" for A in (4e-4, 8e-4)}
    assert "error of sigma0 = 4e+05 N/m" in plan._repr_html_()
    spread = results["propagated"]
    assert spread.unit == "m/s" and f"{spread.nominal:.6g} m/s;" in repr(spread) and f"{spread.std:.3g} m/s</td>" in spread._repr_html_()
    assert spread.plot().get_xlabel() == "mean velocity (mm/s)"
    assert plan.best.units == {"sigma0": "N/m", "amplitude": "m"} and re.match(r"amplitude = 0\.000\d m, ", str(plan))


def test_results_with_a_figure_draw_it(results):
    for name in results.keys() - {"bench", "benches"}:  # whose figures have several axes
        axes = plt.subplots()[1]
        assert results[name].plot(ax=axes) is axes and axes.has_data() | bool(axes.texts), name
    plt.close("all")


def test_the_bars_of_a_motion_are_its_intervals(results):
    axes = ss.plot.pattern(results["motion"])
    widths = sum(path.get_extents().width for bars in axes.collections for path in bars.get_paths())
    assert widths == pytest.approx(results["motion"].period, rel=1e-12)  # the motion period, without holes and overlaps
    plt.close("all")


def test_a_report_prints_as_lines(results):
    report = results["fit"].report()
    assert isinstance(report, Text) and repr(report) == str(report) and "\n" in report
    assert report._repr_html_() == f"<pre>{html.escape(report)}</pre>"


@each_row(("value", "error", "text"), [(0.1797921, 0.00112, "0.1798"), (-np.inf, 0.0, "-inf"), (7961.23, 720.0, "7960")])
def test_numbers_have_the_digits_that_their_error_leaves(value, error, text):
    assert rounded(value, error) == text


def test_motions_print_as_sentences():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=4.2e-4, law="coulomb")
    assert str(ss.motion(ss.solve(robot, periods=60))).startswith("Motion: type I; pattern +0−0; repeats after 1 drive period; margin ")
    assert str(ss.motion(ss.solve(ss.Chain.example(), periods=60))).splitlines()[1].startswith("  contact module 1, pattern +−, forward ")
    record = ss.virtual_rig(robot, noise=1e-4)
    assert str(record.motion) == record.motion.verdict


def test_a_curve_in_two_parameters_draws_itself():
    rig = dict(tilt_deg=1.7, mu0=0.18, law="coulomb")
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3.6e-4, stop=3.8e-4, step=0.2, **rig)
    curve = ss.dynamics.special_curve(branch, branch.special[0], "mu0", stop=0.19, step=0.2)
    axes = curve.plot()
    x, y = axes.lines[0].get_data()
    assert np.allclose(x, 1e6 * curve.values[:, 0]) and np.allclose(y, curve.values[:, 1])  # µm, and the coefficient
    assert "data:image/png" in curve._repr_html_()
    for wrong in ([], [curve, 3], None):
        with pytest.raises(ss.InputError, match="curves in the same two parameters"):
            ss.plot.special_curve(wrong)
    plt.close("all")
