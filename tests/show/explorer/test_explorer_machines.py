"""The explorer's page of a machine: what it draws are the numbers of a run, and every number of the machine has a slider."""

import contextlib
import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pytest

import stickslip as ss
from browsed import Page
from every import every_machine, with_bodies
from explorers import Explorer, answer
from rows import each_row
from stickslip.basics.fields import leaves
from stickslip.basics.number_names import numbers_meant
from stickslip.models.naming import axis_of
from stickslip.show.cli.commands.explore import _opened
from stickslip.show.explorer.effort import effort
from stickslip.show.explorer.machines import Shown, sliders_of
from stickslip.show.explorer.requests import message
from stickslip.show.explorer.server import machine_page

AXE = Path(__file__).parents[2] / "vendor" / "axe.min.js"
CHAIN = every_machine["Chain, set-valued laws"][0]


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("chain") / "chain.toml"
    path.write_text(CHAIN.to_toml() + "\n[solve]\nperiods = 60\n", encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def explorer(file):
    made = Explorer(str(file))
    with contextlib.closing(made):
        yield made


# ---- what is shown ----
@each_row("name", with_bodies)
def test_every_number_of_every_machine_has_a_slider_around_its_value(name):
    model = every_machine[name][0]
    found = {p.name: p for p in sliders_of(model)}
    numbers = {n: float(v) for n, v in leaves(model)}
    meant = {n: p.default for name, p in found.items() for n in numbers_meant(name, numbers)}
    assert meant == numbers and all(name in numbers or name.startswith("*.") for name in found)
    assert all(p.low <= p.default <= p.high and p.low < p.high and p.label for p in found.values())
    assert sum(map(len, Shown(model).groups.values())) == len(found)


def test_parts_are_counted_from_one_as_bodies_are():
    page = machine_page(Shown(CHAIN))
    assert "<legend>module 1</legend>" in page and "<legend>module 2</legend>" in page and "<legend>modules.0" not in page


def test_a_field_says_its_range_its_words_and_its_unit():
    @dataclass(frozen=True, eq=False)
    class Sledge(ss.Machine):
        mass: float = field(default=0.3, metadata={"range": (0.1, 5.0), "label": "mass of the sledge", "unit": "kg"})
        stiffness: float = 2.0

        def bodies(self):
            return {"sledge": ss.Body(self.mass)}

        def links(self):
            return {("sledge", None): ss.Spring(self.stiffness)}

    mass, stiffness = sliders_of(Sledge())
    assert (mass.low, mass.high, mass.label, mass.unit) == (0.1, 5.0, "mass of the sledge", "kg")
    assert (stiffness.label, stiffness.unit) == ("stiffness", "")  # what somebody's own number means nobody else knows


def test_a_number_means_what_its_own_field_says_and_not_what_its_name_means_elsewhere():
    belt = {p.name: p for p in sliders_of(every_machine["BlockOnBelt"][0])}
    assert (belt["damping"].symbol, belt["damping"].label, belt["damping"].unit) == ("c", "damping", "N s/m")
    assert axis_of("damping", ss.presets.piezo_beam_rig) == ("damping ratio of the beam ζ", "1")
    assert axis_of("damping", ss.presets.two_modules) == ("damping c", "N s/m")
    assert axis_of("drive.damping", ss.presets.capsubot()) == ("damping c", "N s/m")
    assert axis_of("link.length", ss.Chain.example()) == ("length at rest ℓ", "m")
    assert axis_of("drive.damping") is None and axis_of("amplitude", ss.presets.worm) == ("amplitude of the distances A", "m")


def test_a_batch_and_a_machine_without_a_time_are_not_shown():
    with pytest.raises(ss.InputError, match=r"a batch of shape \(2,\); allowed is one"):
        Shown(CHAIN.replace({"phases.1": [0.1, 0.2]}))

    @dataclass(frozen=True, eq=False)
    class Sliding(ss.Machine):
        mass: float = 1.0

        def bodies(self):
            return {"block": ss.Body(self.mass)}

        def contacts(self):
            return {"block": ss.Contact("block", ss.Coulomb(0.1, 0.1))}

    with pytest.raises(ss.InputError, match="so a run needs a duration; type duration"):
        Shown(Sliding())
    assert Shown(Sliding(), options={"duration": 2.0}).length(Sliding(), True) == {"duration": 2.0}


def test_what_the_page_of_robots_has_no_control_for_opens_the_page_of_machines(file):
    place, shown = _opened(str(file), ["phases.1=0.5"])
    assert place == "" and shown.model.phases == (0.0, 0.5) and shown.options["periods"] == 60
    place, shown = _opened("piezo_rig", ["tilt_deg=1.7", "amplitude=5e-4"])
    assert place.startswith("#drive=harmonic") and shown is None


def test_the_effort_of_a_machine_is_that_of_its_stiffest_contact():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
    stiff = robot.replace({"friction.sigma0": 4e6})
    pair = ss.Chain((robot, stiff), ss.Spring(1200.0))
    assert effort(pair) == pytest.approx(effort(stiff)) and effort(robot)[0] < effort(stiff)[0]
    with pytest.raises(ss.InputError, match="bristles oscillate"):
        Shown(pair).length(pair.replace({"modules.0.friction.sigma0": 1e12}), True)


def test_garbage_for_numbers_is_said():
    for given, said in [
        ([1], "allowed is a table"),
        ({"phases.1": "x"}, "allowed is a number"),
        ({"phases.1": True}, "allowed is a number"),
        ({"phases.1": 1e999}, "allowed is a number"),
        ({str(i): 1.0 for i in range(501)}, "up to 500 numbers"),
    ]:
        with pytest.raises(ss.InputError, match=said):
            message(json.dumps({"channel": "curves", "id": 1, "machine": given}))
    with pytest.raises(ss.InputError, match=r"'phase.1'.*did you mean 'phases.1'"):
        Shown(CHAIN).with_values({"phase.1": 0.3})


# ---- the server ----
def test_the_server_answers_with_the_numbers_of_the_run(explorer):
    with explorer.page() as page:
        page.send(json.dumps({"channel": "curves", "id": 1, "fine": True, "machine": {"phases.1": 0.5}}))
        header, _ = answer(page)
        run = ss.solve(CHAIN.replace({"phases.1": 0.5}), periods=60)
        assert header["mean_velocity"] == pytest.approx({name: ss.mean_velocity(run, body=name) for name in run.bodies}, rel=1e-12)
        assert [row["name"] for row in header["picture"]["rows"]] == list(run.contacts)
        page.send(json.dumps({"channel": "curves", "id": 2, "machine": {"modules.0.body_mass": -1.0, "phase.1": 1.0}}))
        header, _ = answer(page)
        assert header["kind"] == "problems" and "phase.1" in header["problems"][0]
        page.send(json.dumps({"channel": "curves", "id": 3, "machine": {"modules.0.body_mass": -1.0}}))
        assert "a positive mass" in answer(page)[0]["problems"][0]


def test_a_report_and_a_study_file_can_be_taken_home(explorer, tmp_path):
    told = quote(json.dumps({"link.stiffness": 700.0}))
    status, _, body = explorer.ask(f"/machine/study.toml?machine={told}")
    assert status == 200 and ss.Chain.from_toml(body.decode()).link.stiffness == 700.0 and "periods = 60" in body.decode()
    status, headers, body = explorer.ask(f"/machine/report.html?machine={told}")
    assert status == 200 and b"One run of one machine" in body and "attachment" in headers["content-disposition"]
    for path, code in [("/machine/robot.py", 404), ("/machine/study.toml?machine=[]", 400), ("/machine/study.toml?machine={", 400)]:
        assert explorer.ask(path)[0] == code


# ---- the page ----
def opened(page, hash="", **options):
    return page.anew(**options).open(hash).page


def settled(page, act):
    """Do something, and wait for the long run that follows it."""
    before = int(page.locator("html").get_attribute("data-drawn").split()[0])
    act()
    wanted = "n => { const [id, fine] = (document.documentElement.dataset.drawn ?? '').split(' '); return id > n && fine; }"
    page.wait_for_function(wanted, arg=before)


def mean(page):
    return float(page.locator("#means dd").first.inner_text().split()[0].replace("−", "-"))


def test_a_slider_moves_the_picture_and_the_address_keeps_it(kept_page):
    page = opened(kept_page)
    assert mean(page) == pytest.approx(1e3 * ss.mean_velocity(ss.solve(CHAIN, periods=60)), rel=1e-3)  # four digits
    first = page.locator(".trace").first.get_attribute("points")
    slider = page.locator("[id='p-phases.1']")
    settled(page, lambda: slider.fill("0.5"))
    wanted = ss.solve(CHAIN.replace({"phases.1": 0.5}), periods=60)
    assert mean(page) == pytest.approx(1e3 * ss.mean_velocity(wanted), rel=1e-3)
    assert page.locator(".trace").first.get_attribute("points") != first
    page.wait_for_function("() => location.hash === '#phases.1=0.5'")
    slid = mean(page)
    opened(kept_page, "phases.1=0.5")
    assert slider.input_value() == "0.5" and mean(page) == slid
    settled(page, lambda: page.locator("#reset-all").click())
    assert page.locator(".trace").first.get_attribute("points") == first


def test_a_link_with_numbers_that_are_not_here_says_so(page):
    """Those of an older version, of another machine, or damaged ones."""
    shown = opened(page, "phases.1=0.5&drive.frequency=3&link.stiffness=much")
    told = shown.locator("#left-out")
    assert told.is_visible() and "The link says drive.frequency, link.stiffness: no such number is here" in told.inner_text()
    assert shown.locator("[id='p-phases.1']").input_value() == "0.5"
    assert not opened(page, "phases.1=0.5").locator("#left-out").is_visible()


def test_numbers_that_only_change_together_have_one_slider():
    """The frequency of a chain's drives, and that of both motions of a conveyor: one alone would be refused."""
    shown = Shown(CHAIN)
    assert "*.omega" in shown.numbers and not any(name.endswith("drive.omega") for name in shown.numbers)
    assert shown.with_values({"*.omega": 210.0}).period == pytest.approx(2 * np.pi / 210.0, rel=1e-15)
    assert next(iter(shown.groups)) == "" and "*.omega" in Shown(ss.presets.conveyor()).numbers


def test_what_is_typed_may_lie_beyond_the_slider_and_what_is_wrong_is_said(page):
    page = opened(page)
    typed = page.locator("[id='n-link.stiffness']")
    settled(page, lambda: typed.fill("5000"))
    assert float(page.locator("[id='p-link.stiffness']").get_attribute("max")) == 5000.0
    amplitude = page.locator("[id='n-modules.0.drive.amplitude']")
    shown = CHAIN.modules[0].drive.amplitude * 1e3
    assert float(amplitude.input_value()) == pytest.approx(shown, rel=1e-5)  # in mm, as the unit behind it says
    settled(page, lambda: amplitude.fill("0.5"))
    assert float(page.locator("[id='p-modules.0.drive.amplitude']").input_value()) == pytest.approx(5e-4)
    page.wait_for_function("() => location.hash.includes('modules.0.drive.amplitude=0.0005')")
    typed.fill("-3")
    page.wait_for_function("() => document.getElementById('said').textContent.includes('zero or more')")
    typed.fill("x")
    assert typed.get_attribute("aria-invalid") == "true"


def test_the_bars_of_the_page_are_the_stretches_of_the_run(page):
    page = opened(page)
    run = ss.solve(CHAIN, periods=60)
    T = run.period_time
    for i, name in enumerate(run.contacts):
        bars = page.locator(".bars > svg").nth(i)
        widths = {
            kind: sum(bars.locator(f".{kind}").evaluate_all("all => all.map(r => r.width.baseVal.value)"))
            for kind in ("fore", "back", "stick")
        }
        told = ss.motion(run).contacts[name]
        shares = {"fore": told.forward_fraction, "back": told.backward_fraction, "stick": told.stick_fraction}
        assert widths == pytest.approx({kind: 640 * share for kind, share in shares.items()}, abs=0.05)
    tick, place = page.locator(".ticks small").last.evaluate("tick => [tick.textContent, tick.style.left]")
    assert 100 * float(re.match(r"[\d.]+", tick)[0]) / float(place[:-1]) == pytest.approx(1e3 * T, rel=1e-5) and tick.endswith("ms")


def test_the_picture_moves_bodies_by_one_measure(page):
    page = opened(page)
    places = []
    for k in (0, 120, 300):
        page.locator("#moving input").fill(str(k))
        places.append(page.locator(".bodybox").evaluate_all("all => all.map(b => b.transform.baseVal[0].matrix.e)"))
    run = ss.solve(CHAIN, periods=60)
    t = run.strobe_times[-2] + run.period_time * np.array([0, 120, 300]) / 479
    moved, drawn = np.diff(run.at(t)["x"], axis=0), np.diff(np.array(places), axis=0)
    assert drawn / moved == pytest.approx(np.full((2, 2), (drawn / moved)[0, 0]), rel=1e-3)  # six digits of each displacement


@each_row("width", [1200, 380])
def test_bodies_have_their_names_and_numbers_of_several_parts_are_told_apart(page, width):
    page = opened(page, width=width, height=800)
    names = page.locator(".stage text").evaluate_all("all => all.map(t => [t.textContent, t.getBoundingClientRect().left])")
    assert [name for name, _ in sorted(names, key=lambda each: each[1])] == ["module 2", "module 1"], "plus is to the right"
    inside = page.locator(".stage").evaluate(
        "s => [...s.querySelectorAll('text')].map((t, i) => [t, s.querySelectorAll('rect')[i]].map(e => e.getBoundingClientRect()))"
        ".every(([t, r]) => t.left > r.left && t.right < r.right && t.top > r.top && t.bottom < r.bottom)"
    )
    assert inside
    assert page.locator(".names", has_text="bar: ").is_visible(), "the scale is said"
    labels = [label.strip() for label in page.locator("#faster-sliders label").all_inner_texts()]
    assert len(set(labels)) == len(labels) and "mass of the body, module 2" in labels and "phase of the drive 2" in labels


@pytest.mark.parametrize(("scheme", "width"), [("light", 1200), ("dark", 380)])
def test_axe_finds_nothing_and_nothing_sticks_out(page, scheme, width):
    page = opened(page, color_scheme=scheme, width=width, height=800)
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
    assert [(v["id"], v["nodes"][0]["html"]) for v in found["violations"]] == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_joint_is_shown_in_its_own_quantities(browser):
    """A dial with a hand for the angle and one for the target, error and torque; nothing in metres."""
    made = Explorer("servo")
    with contextlib.closing(made):
        page = opened(Page(browser, made))
        assert page.locator(".stage .hand, .stage .wanted").count() == 2
        shown = page.locator("#now").inner_text()
        assert re.search(r"error at the end\s+0\.02834 rad\b", shown) and re.search(r"largest torque applied\s+0\.5 N m\b", shown)
        assert "m/s" not in shown.replace("rad/s", "") and "track" not in shown
        rows = page.locator(".live .row > span").evaluate_all("all => all.map(el => el.firstChild?.textContent)")
        assert rows[:4] == ["angle", "error", "torque", "velocity"]
