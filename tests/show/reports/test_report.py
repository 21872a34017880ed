"""Reports of runs and studies: one page that needs nothing else and says what was computed."""

import contextlib
import json
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from every import DRY, Capsule, every_machine
from house import ROOT
from printed import pictures_and_printed
from rows import each_row
from stickslip.show.cli import main
from stickslip.show.reports import run_page, study_page, write
from stickslip.show.reports.fastest import run_again
from stickslip.show.reports.html import image, outside_addresses
from stickslip.show.reports.mathml import mathml
from stickslip.show.reports.moving import moments
from stickslip.show.reports.run_charts import forces, velocity
from stickslip.show.reports.study_charts import along, cuts

CHAIN, CAPSULE = every_machine["Chain, set-valued laws"][0], every_machine["capsule with an elastic stop"][0]


@dataclass(frozen=True, eq=False)
class Thrown(Capsule):
    """The capsule with a stop that throws the hammer back."""

    def stops(self):
        return {("hammer", "capsule"): ss.Stop(gap=self.gap, restitution=0.4)}


AXE = Path(__file__).parents[2] / "vendor" / "axe.min.js"


@pytest.fixture(scope="module")
def run():
    return ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=20)


def test_the_page_of_a_run_says_its_motion_and_every_number_with_its_unit(run):
    text = run_page(run, "A <robot>")
    assert "A &lt;robot&gt;" in text and "2.01468 mm/s" in text and "I (pattern +0-0" in text
    assert "205.4601595 rad/s" in text and "0.0005525 m" in text
    assert outside_addresses(text) == [] and text.count("data:image/svg+xml") == 3


def test_the_moving_picture_is_the_last_motion_period(run):
    found = moments(run)
    body, inner = found["bodies"]
    assert found["t"][-1] == pytest.approx(1e3 * run.period_time, rel=1e-5)
    assert body["x"][-1] - body["x"][0] == pytest.approx(1e3 * ss.mean_velocity(run) * run.period_time, rel=1e-4)
    assert max(inner["x"]) - min(inner["x"]) == pytest.approx(2e3 * run.model.drive.amplitude, rel=0.2)  # the body moves less than that
    assert max(body["v"]) == pytest.approx(1e3 * run.v.max(), rel=1e-3)  # 480 instants see the crest to (pi/480)^2 of it
    assert json.loads(re.search(r'id="moments">(.*?)</script>', run_page(run, "x"))[1]) == found


def test_the_chart_of_a_run_has_the_values_of_the_run(run):
    """Five digits of every value at its instant, by the run's dense output; the rests are those of its modes."""
    T, last = run.period_time, float(run.strobe_times[-1])
    for made, column, periods in ((velocity(run), "v", 3), (forces(run), "friction_force", 2)):
        t = np.array(made["x"]) * 1e-3 + last - periods * T
        y = np.array(made["curves"][0]["y"]) * 1e-3
        here, before, after = (run.at(np.clip(t + shift, 0, last))[column] for shift in (0, -4e-6 * T, 4e-6 * T))  # six digits of a time
        near = np.minimum.reduce([abs(y - here), abs(y - before), abs(y - after)])  # a jump has two values
        assert near.max() < 1e-4 * abs(y).max() and len(y) > 1000
    rest = sum(b - a for a, b in velocity(run)["shade"])
    assert rest == pytest.approx(3e3 * T * ss.motion(run).stick_fraction, rel=1e-6)


def test_the_charts_of_a_study_are_its_columns():
    """Out of order on purpose: a chart goes along its axis."""
    grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.6, 0.2, 0.4], alpha_minus=[0.5, 0.9])
    made = cuts(grid, "alpha_plus", "alpha_minus")
    assert made["x"] == [0.2, 0.4, 0.6]
    for shown, minus in zip(made["curves"], (0.5, 0.9), strict=True):
        wanted = [grid.mean_velocity.sel(alpha_plus=plus, alpha_minus=minus).item() for plus in made["x"]]
        assert shown["y"] == pytest.approx(wanted, rel=1e-5)
    line = grid.sel(alpha_minus=0.9)
    kinds = {one["label"]: one["y"] for one in along(line, "alpha_plus")["curves"][1:]}
    for i, plus in enumerate(made["x"]):
        assert [kind for kind, y in kinds.items() if y[i] is not None] == [line.motion_type.sel(alpha_plus=plus).item()]


def test_the_fastest_case_is_run_again():
    """With a preset its name and numbers suffice; a maker of the user is not looked for."""
    grid = ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 6e-4], tilt_deg=1.7, law=["coulomb", "coulomb-static"])
    run = run_again(grid)
    assert ss.mean_velocity(run) == pytest.approx(float(abs(grid.mean_velocity).max()), rel=1e-6) and run.model.drive.amplitude == 6e-4
    assert run_again(ss.sweep(lambda a: ss.presets.coulomb_robot(a, 0.9), a=[0.2, 0.4])) is None


def test_a_study_of_several_laws_is_told_law_by_law():
    grid = ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 5e-4, 6e-4], tilt_deg=1.7, law=["coulomb", "coulomb-static"])
    text = study_page(grid, "Two")
    charts = json.loads(re.search(r'id="charts">(.*?)</script>', text)[1])
    assert len(charts[0]["curves"]) == 2 and "law = coulomb-static" in text and outside_addresses(text) == []


# in a browser -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pages(run, machines, tmp_path_factory):
    """A run's page and a study's page as files."""
    folder = tmp_path_factory.mktemp("pages")
    plane = ss.sweep(ss.presets.coulomb_robot, alpha_plus=np.linspace(0.2, 1.2, 11), alpha_minus=[0.5, 0.9])
    of_machines = [write(folder / f"{name}.html", run_page(made, name)) for name, made in machines.items()]
    return [write(folder / "run.html", run_page(run, "Run")), write(folder / "study.html", study_page(plane, "Study")), *of_machines]


@contextlib.contextmanager
def opened(browser, width=1200, height=900, **options):
    """A page that is offline; whatever goes wrong on it is an error."""
    context = browser.new_context(offline=True, viewport={"width": width, "height": height}, **options)
    with contextlib.closing(context):
        page = context.new_page()
        page.on("pageerror", lambda error: pytest.fail(str(error)))
        yield page


def test_a_chart_tells_values_zooms_and_hides_curves(browser, pages, run):
    with opened(browser, reduced_motion="reduce") as page:
        page.goto(pages[0].as_uri())
        box = page.locator(".chart").nth(1)
        box.locator(".plot").focus()
        for _ in range(41):
            page.keyboard.press("ArrowRight")
        told = box.locator("button").first.inner_text()
        assert re.fullmatch(r"\s*friction force R\s+−?[\d.]+ mN", told) and "ms" in box.locator("output").inner_text()
        made = forces(run)["curves"][0]["y"][40]
        assert float(re.search(r"−?[\d.]+(?= mN)", told)[0].replace("−", "-")) == pytest.approx(made, rel=1e-4)
        page.keyboard.press("Escape")
        whole = box.locator("canvas").evaluate("c => c.toDataURL()")
        box.locator("button").first.click()
        assert box.locator("button").first.get_attribute("aria-pressed") == "false"
        drawn(box, "!==", whole)
        box.locator("button").first.click()
        drawn(box, "===", whole)
        for x in (100, 200):  # hovering waits until the chart rests where it is
            box.locator(".u-over").hover(position={"x": x, "y": 50})
            page.mouse.down() if x == 100 else page.mouse.up()
        drawn(box, "!==", whole)
        box.get_by_role("button", name="Show all").click()
        drawn(box, "===", whole)


def drawn(box, how, before):
    """Wait until a chart's picture is, or is not, what it was (uPlot draws with one of the next frames)."""
    box.page.wait_for_function(
        f"([canvas, before]) => canvas.toDataURL() {how} before", arg=[box.locator("canvas").element_handle(), before]
    )


@pytest.mark.parametrize(("scheme", "width"), [("light", 1200), ("dark", 380)])
def test_axe_finds_nothing_on_a_report_and_nothing_sticks_out(browser, pages, scheme, width):
    with opened(browser, width, 800, color_scheme=scheme) as page:
        for path in pages:
            page.goto(path.as_uri())
            page.evaluate(AXE.read_text(encoding="utf-8"))
            found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
            assert [(v["id"], v["nodes"][0]["html"]) for v in found["violations"]] == []
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_the_pictures_stay_where_no_script_runs_and_in_print(browser, pages):
    with opened(browser, java_script_enabled=False) as plain, opened(browser) as page:
        for path in pages:
            plain.goto(path.as_uri())
            figures = plain.locator("figure")
            assert all(figures.nth(i).locator("img").is_visible() for i in range(figures.count()))
            assert not plain.locator(".chart").first.is_visible()
            page.emulate_media(media="screen")
            page.goto(path.as_uri())
            asked = page.locator("figure.asked").first
            assert asked.locator(".chart").is_visible() and not asked.locator("img").is_visible()
            page.emulate_media(media="print")
            assert asked.locator("img").is_visible() and not asked.locator(".chart").is_visible()


def test_the_pdf_of_every_report_has_every_picture(browser, pages, tmp_path):
    for path in pages:
        count, printed = pictures_and_printed(browser, path, tmp_path)
        assert printed == count > 0


def test_pictures_of_every_template_have_a_size_and_load_at_once():
    """A picture without a size moves what is below it when it appears, and one that loads late is missing in print."""
    for template in (ROOT / "src/stickslip/show/reports/templates").glob("*.html"):
        text = template.read_text(encoding="utf-8")
        assert "<img" not in text and "lazy" not in text, template.name  # the filter `image` writes them
    with pytest.raises(ss.InputError, match="viewBox"):
        image("<svg/>", "no size")


def test_the_page_of_a_study_counts_and_ranks(tmp_path):
    grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=np.linspace(0.2, 1.2, 6), alpha_minus=[0.5, 0.9])
    text = study_page(grid, "Twelve")
    kinds = grid.motion_type.values
    for kind in np.unique(kinds):
        assert re.search(rf'<th scope="row">{kind}</th><td class="n">{(kinds == kind).sum()}</td>', text)
    fastest = float(abs(grid.mean_velocity).max())
    assert f"{fastest:.6g}" in text and outside_addresses(text) == []


def test_the_command_takes_a_preset_a_saved_run_a_folder_and_a_file(run, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run.save("run.nc")
    ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.4, 0.5, 0.6], alpha_minus=0.9, out="study")
    ss.studies.export("study", "study.nc")
    for words in (["piezo_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=coulomb", "periods=20"], ["run.nc"], ["study"], ["study.nc"]):
        assert main(["report", *words, "--out", "page.html", "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["bytes"] == (tmp_path / "page.html").stat().st_size > 10_000
    assert main(["report", "run.nc", "periods=3"]) == 2 and "is finished" in capsys.readouterr().err
    assert main(["report", "nothing.nc"]) == 2 and "there is no 'nothing.nc'" in capsys.readouterr().err


def test_a_report_of_a_steady_motion_leaves_settling_out():
    """The extremes of the page are those of the last period, not of the way there."""
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=3, amplitude=7e-4, omega=300.0), periods=60)
    v = run.v[run.t >= (run.periods - 1) * run.period_time]
    assert run.v.max() > 1.1 * v.max()
    assert f"{1e3 * v.min():.6g} to {1e3 * v.max():.6g} mm/s".replace("-", "−") in run_page(run, "x")


def test_a_study_of_a_robot_keeps_the_robot_and_its_report_shows_it_and_lets_it_move(tmp_path, monkeypatch):
    """In memory, in a folder and in a file; the folder can be resumed."""
    monkeypatch.chdir(tmp_path)
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.5e-4, law="coulomb", incline="gravity")
    axes = {"drive.omega": [180.0, 220.0], "drive.amplitude": 5e-4}
    grids = [ss.sweep(robot, **axes), ss.sweep(robot, **axes, out="study")]
    ss.studies.export("study", "study.nc")
    for grid in (*grids, ss.open_study("study.nc"), ss.sweep(robot, **axes, out="study", resume=True)):
        assert ss.Robot.from_toml(grid.attrs["robot"]) == robot
        numbers = json.loads(grid.attrs["numbers"])
        assert numbers["drive.amplitude"] == 5e-4 and numbers["track.tilt"] == robot.track.tilt and "drive.omega" not in numbers
        text = study_page(grid, "Mine")
        assert re.search(r'<th scope="row">body_mass</th><td>0.06259 kg</td>', text) and 'id="moments"' in text
        assert run_again(grid).model == robot.replace({"drive.omega": 220.0, "drive.amplitude": 5e-4})


def test_a_study_tells_the_numbers_that_all_robots_of_a_maker_share():
    """A maker of the user's own that takes one number at a time; what follows from an axis is not shared."""

    def mine(tilt_deg, law):
        return ss.presets.piezo_rig(tilt_deg=float(tilt_deg), amplitude=5e-4, law=law)

    shared = json.loads(ss.sweep(mine, tilt_deg=[1.0, 2.0], law=["coulomb", "coulomb-static"]).attrs["numbers"])
    assert shared == {"body_mass": 62.59e-3, "inner_mass": 9.48e-3, "drive.amplitude": 5e-4, "drive.omega": 65.4 * np.pi, "gravity": 9.81}
    one = json.loads(ss.sweep(mine, tilt_deg=1.0, law="coulomb").attrs["numbers"])
    assert one["friction.mu_plus"] == mine(1.0, "coulomb").friction.mu_plus


def test_a_robot_without_dimensions_has_no_meters_in_its_results(tmp_path, monkeypatch, capsys):
    """On the command line, in the dataset, in files and in reports; the same words say meters of a robot that has some."""
    monkeypatch.chdir(tmp_path)
    unit, rig = ["coulomb_robot", "alpha_plus=0.3..0.7:3", "alpha_minus=0.5..0.9:3"], ["piezo_rig", "law=coulomb", "tilt_deg=1..2:2"]
    for words, meters in ((unit, False), ([*rig, "amplitude=4e-4..5e-4:2"], True)):
        for command in ("map", "sweep"):
            assert main([command, *words, "--out", "grid.nc"]) == 0
            assert ("m/s" in capsys.readouterr().out) == meters
        assert ss.open_study("grid.nc").mean_velocity.attrs["units"] == ("m/s" if meters else "1")
        assert ("m/s" in study_page(ss.open_study("grid.nc"), "x").split("<main")[1].split('id="provenance"')[0]) == meters
    assert main(["report", "coulomb_robot", "alpha_plus=0.5", "alpha_minus=0.9", "--out", "run.html"]) == 0
    assert "its units of mass, length and time are 1" in (tmp_path / "run.html").read_text(encoding="utf-8")
    capsys.readouterr()
    assert main(["run", "coulomb_robot", "alpha_plus=0.5", "alpha_minus=0.9"]) == 0
    assert not re.search(r"\d (m/s|s|J)\b", capsys.readouterr().out)


def test_a_mechanism_that_nothing_drives_has_a_page_and_a_figure(tmp_path, capsys):
    law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    file = tmp_path / "belt.toml"
    file.write_text(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law).to_toml() + "\n[solve]\nduration = 20.0\n")
    assert main(["run", str(file), "--figure", str(tmp_path / "belt.png")]) == 0 and (tmp_path / "belt.png").stat().st_size > 10_000
    assert main(["report", str(file), "--out", str(tmp_path / "belt.html")]) == 0
    text = (tmp_path / "belt.html").read_text()
    assert "One run of one mechanism" in text and "duration = 20.0" in text and 'id="moments"' in text
    assert text.count("data:image/svg+xml") == 3 and outside_addresses(text) == []
    assert "0.1 m/s" in text and "0 N s/m" in text and "beam" not in text.split("<main")[1].split("<script")[0]
    charts = json.loads(re.search(r'id="charts">(.*?)</script>', text)[1])
    assert charts[0]["across"] == ["time t", "s"] and charts[0]["x"][-1] == 20.0
    assert min(charts[1]["curves"][0]["y"]) == pytest.approx(-1500, rel=1e-4)  # mN: where it breaks away


@pytest.fixture(scope="module")
def machines():
    """Runs of a chain, of a capsule with an elastic stop, and of one whose stop throws back."""
    chain, capsule, thrown = (ss.solve(m, periods=40) for m in (CHAIN, CAPSULE, Thrown(300.0, DRY)))
    return {"chain": chain, "capsule": capsule, "thrown": thrown}


def test_a_machine_of_several_bodies_has_a_page_with_a_row_for_each_of_its_parts(machines):
    for name, run in machines.items():
        text = run_page(run, name)
        for part in [*run.bodies, *run.contacts, *ss.energy(run).damping_of]:
            assert f'<th scope="row">{part}</th>' in text, part
        for body in run.bodies:
            told = f"{1e3 * ss.mean_velocity(run, body=body):.6g} mm/s".replace("-", "−")
            assert told in text, body
        assert "One run of one machine" in text and outside_addresses(text) == [] and 'id="equations"' in text
        assert text.count("data:image/svg+xml") == 4  # velocity, contacts, forces, phase


def test_the_losses_on_a_page_add_up_to_the_works(machines):
    for run in machines.values():
        balance = ss.energy(run)
        for of, whole in ((balance.friction_of, balance.friction), (balance.damping_of, balance.damping)):
            assert sum(of.values()) == pytest.approx(whole, rel=1e-12)


def test_the_moving_picture_of_a_machine_has_its_bodies_contacts_and_stops(machines):
    for run in machines.values():
        T, end = run.period_time, float(run.strobe_times[-1])
        found = moments(run, (end - T, end))
        assert [body["name"] for body in found["bodies"]] == list(run.bodies)
        for i, body in enumerate(found["bodies"]):
            way = run.at(end)["x"][i] - run.at(end - T)["x"][i]
            assert body["x"][-1] == pytest.approx(1e3 * way, abs=1e-4 * max(map(abs, body["x"])))
        for row in found["rows"][: len(run.contacts)]:
            stuck = sum(b - a for a, b, sign in row["stretches"] if sign == 0) / (1e3 * T)
            assert stuck == pytest.approx(ss.motion(run).contacts[row["name"]].stick_fraction, abs=1e-5)  # six digits of a time
    run = machines["thrown"]
    struck = moments(run, tuple(run.strobe_times[-2:]))["rows"][-1]
    assert len(struck["hits"]) == sum(e.kind == "hit" and e.t > run.strobe_times[-2] for e in run.events) > 0
    run = machines["capsule"]
    pressed = moments(run, tuple(run.strobe_times[-2:]))["rows"][-1]
    assert pressed["stretches"]
    for a, b, sign in pressed["stretches"]:
        x = run.at(run.strobe_times[-2] + 1e-3 * np.array([a, 0.5 * (a + b), b]))["x"]
        depth = x[:, 1] - x[:, 0] - run.model.gap
        assert sign == 2 and depth[1] > 0 and abs(depth[[0, 2]]).max() < 1e-5 * run.model.gap  # at six digits of a time


def test_a_body_that_flies_is_lifted_in_the_moving_picture():
    run = ss.solve(ss.presets.conveyor(throw_index=2.5), periods=40)
    (body,) = moments(run)["bodies"]
    lift, aloft = np.array(body["lift"]), ss.analysis.hops(run)
    # 480 instants of a period: a parabola is missed at its top by the square of half the step over that of half the flight
    assert lift.max() == pytest.approx(1e3 * aloft.height, rel=(0.5 / 480 / (0.5 * aloft.fraction)) ** 2 + 1e-5)
    assert lift.min() == 0.0 and (lift > 0).mean() == pytest.approx(aloft.fraction, abs=2 / 480)
    assert moments(ss.solve(ss.presets.stick_slip_stage(), periods=4))["bodies"][0]["lift"] is None


def test_a_forced_oscillator_has_a_page():
    law = ss.Coulomb(0.2, 0.2)
    run = ss.solve(ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.0, force=1.0, omega=0.7, friction=law), periods=20)
    assert "pattern " in run_page(run, "to and fro")


@pytest.mark.slow
def test_a_study_of_chains_has_a_report(tmp_path):
    """Types of each contact, a map for each, one of the velocity, and the fastest case once more, also of a machine that was given."""
    from stickslip.show.reports.study import study_page
    from stickslip.show.reports.study_figures import figures

    pair = {"phase": np.linspace(0.0, 3.0, 3), "stiffness": [1200.0, 2000.0]}
    grid = ss.sweep(ss.presets.two_modules, **pair, periods=60)
    captions = [one.caption for one in figures(grid) if "types" in one.caption]
    assert captions == [
        "Motion types of module 1.",
        "Motion types of module 2.",
    ]
    page = study_page(grid, "Two robots")
    assert "module 1: IV" in page and "IV | IV" in page and "The fastest moves" in page
    frequencies = ss.sweep(ss.presets.two_modules(), **{"modules.drive.omega": [200.0, 205.0]}, periods=60)
    assert "The fastest moves" in study_page(frequencies, "By frequency")
    assert [one.caption for one in figures(frequencies)] == ["Mean velocity."]
    turning = ss.sweep(ss.presets.servo, kp=[0.5, 1.0], duration=2.0)
    assert turning.mean_velocity.units == "rad/s" and "mean velocity [rad/s]" in study_page(turning, "A servo")


@each_row("tex", [r"\href{a}{b}", "\\", r"\frac{1}", "x_", "&", r"\end{cases}", r"\left x", r"\text{"])
def test_a_formula_that_no_page_can_show_is_refused_with_a_sentence(tex):
    with pytest.raises(ss.InputError, match="is no formula that a page can show") as refused:
        mathml(tex)
    assert len(str(refused.value).splitlines()) == 1
