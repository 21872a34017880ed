"""The widget for notebooks: what Python answers, its page part in a browser, and a notebook that was run."""

from __future__ import annotations

import json
from importlib import resources

import pytest

import stickslip as ss
from rows import each_row

pytest.importorskip("anywidget", reason='anywidget is not installed: pip install "stickslip[widget]"')

ROBOT = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
HOSTILE = '<img src="x" onerror="document.title = \'run\'">'


def told(w, values, fine=True):
    w.state = {"values": values, "fine": fine, "id": json.dumps(values)}
    return w.answer


# ---- what Python answers ----
def test_it_draws_what_solve_computes():
    w = ss.widget(ROBOT, periods=60)
    answer = told(w, {"drive.amplitude": 6e-4})
    run = ss.solve(ROBOT.replace({"drive.amplitude": 6e-4}), periods=60)
    assert answer["mean_velocity"]["body"] == ss.mean_velocity(run)
    [body] = [each for each in answer["picture"]["bodies"] if each["name"] == "body"]
    assert max(body["v"]) == pytest.approx(1e3 * run.v[run.t > 59 * run.period_time].max(), rel=1e-3)  # 480 instants: half a step off
    assert w.machine == ROBOT.replace({"drive.amplitude": 6e-4})


def test_sliders_are_those_of_the_described_numbers():
    w = ss.widget(ROBOT, ["friction.mu_plus", "drive.amplitude"])
    assert [each["name"] for each in w.sliders] == ["friction.mu_plus", "drive.amplitude"]
    amplitude = w.sliders[1]
    assert amplitude["unit"] == "mm" and amplitude["value"] == pytest.approx(0.5525) and amplitude["low"] < 0.5525 < amplitude["high"]
    chain = ss.widget(ss.Chain.example()).sliders
    assert len(chain) == 18 and {"modules.0", "modules.1", "link", "phases"} <= {each["part"] for each in chain}


def test_values_may_be_set_from_python_with_units():
    w = ss.widget(ROBOT)
    w.values = {"drive.amplitude": "0.6 mm"}
    assert w.values == {"drive.amplitude": 6e-4} and w.answer["id"] is None
    with pytest.raises(ss.InputError, match=r"'drive.amplitud' is not known; did you mean 'drive.amplitude'"):
        w.values = {"drive.amplitud": 1.0}
    assert w.values == {"drive.amplitude": 6e-4}


def test_what_a_page_may_send_is_answered_in_words():
    w = ss.widget(ROBOT)
    for values in ({"nothing": 1.0}, {"drive.amplitude": HOSTILE}, {"drive.amplitude": None}, {"body_mass": -1.0}, [1], None):
        w.state = {"values": values, "fine": True, "id": repr(values)}
        assert w.answer["error"] and w.answer["id"] == repr(values)
    assert "error" not in told(w, {})


def test_names_that_are_not_numbers_are_told():
    with pytest.raises(ss.InputError, match=r"numbers: 'amplitude' is not a number of Robot; did you mean 'drive.amplitude'"):
        ss.widget(ROBOT, numbers=["amplitude"])
    with pytest.raises(ss.InputError, match="batch"):
        ss.widget(ROBOT.replace({"drive.amplitude": [1e-4, 2e-4]}))


# ---- the page part in a browser ----
PAGE = """<!doctype html><meta charset="utf-8"><title>quiet</title><style>%s</style><div id="here"></div><script type="module">
const told = %s, heard = {};
window.sent = [];
window.model = {
  get: (name) => told[name],
  set: (name, value) => { told[name] = value; },
  save_changes: () => window.sent.push(told.state),
  on: (name, act) => { heard[name] = act; }, off: (name) => { delete heard[name]; },
  answer: (answer) => { told.answer = answer; heard["change:answer"](); },
};
const widget = (await import(URL.createObjectURL(new Blob([%s], { type: "text/javascript" })))).default;
window.away = widget.render({ model: window.model, el: document.getElementById("here") });
</script>"""


@pytest.fixture(scope="module")
def page(browser):
    return browser.new_page()


def mounted(page, w, **changes):
    """The widget on a page; the requests that it makes, and the errors."""
    assets = resources.files("stickslip.show.explorer").joinpath("assets")
    script, style = (assets.joinpath(f"widget.{ending}").read_text(encoding="utf-8") for ending in ("js", "css"))
    told = {name: getattr(w, name) for name in ("title", "sliders", "state", "answer")} | changes
    asked, errors = [], []
    page.on("request", lambda request: asked.append(request.url) if not request.url.startswith("blob:") else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.set_content(PAGE % (style, _in_a_page(told), _in_a_page(script)))
    page.wait_for_function("window.away !== undefined")
    return asked, errors


def _in_a_page(value):
    return json.dumps(value).replace("<", "\\u003c")


def test_a_moved_slider_asks_and_the_answer_is_drawn(page):
    w = ss.widget(ROBOT, ["drive.amplitude", "friction.mu_plus"])
    asked, errors = mounted(page, w)
    assert page.locator("input[type=range]").count() == 2 and page.locator("path.curve").count() == 3
    before = page.locator("path.curve").first.get_attribute("d")
    page.evaluate(
        "() => { const slide = document.querySelector('input[type=range]');"
        " for (const value of [0.6, 0.65, 0.7]) { slide.value = value; slide.dispatchEvent(new Event('input')); } }"
    )
    [first] = page.evaluate("window.sent")  # one question at a time: the others wait for the answer
    assert first["values"]["drive.amplitude"] == pytest.approx(6e-4) and first["fine"] is False
    w.state = first
    page.evaluate("answer => window.model.answer(answer)", w.answer)
    assert page.locator("path.curve").first.get_attribute("d") != before
    last = page.evaluate("window.sent")[-1]
    assert last["values"]["drive.amplitude"] == pytest.approx(7e-4) and len(page.evaluate("window.sent")) == 2
    w.state = last
    page.evaluate("answer => window.model.answer(answer)", w.answer)
    assert f"{1e3 * w.answer['mean_velocity']['body']:.4g}"[:5] in page.locator(".said").inner_text()
    assert asked == [] and errors == []


def test_a_typed_number_asks_and_a_wrong_one_is_marked(page):
    w = ss.widget(ROBOT, ["drive.amplitude"])
    mounted(page, w)
    typed = page.locator("input[type=text]")
    for text in ("abc", ""):
        typed.fill(text)
        typed.dispatch_event("change")
        assert typed.get_attribute("aria-invalid") == "true" and page.evaluate("window.sent") == []
    typed.fill("0,6")
    typed.dispatch_event("change")
    assert page.evaluate("window.sent")[0]["values"]["drive.amplitude"] == pytest.approx(6e-4)
    assert typed.get_attribute("aria-invalid") == "false"


def test_a_mean_velocity_of_what_turns_is_in_radians(page):
    w = ss.widget(ss.Joint.example())
    mounted(page, w)
    [(name, v)] = w.answer["mean_velocity"].items()
    text = page.locator(".said").inner_text()
    assert float(text.split(f"{name} ")[1].split(" rad/s")[0].replace("−", "-")) == pytest.approx(v, rel=0.01)


def test_text_is_never_html(page):
    w = ss.widget(ROBOT, ["drive.amplitude"])
    sliders = [w.sliders[0] | {"label": HOSTILE, "symbol": HOSTILE, "unit": HOSTILE}]
    picture = w.answer["picture"] | {"bodies": [each | {"name": HOSTILE} for each in w.answer["picture"]["bodies"]], "unit": HOSTILE}
    facts = [(HOSTILE, HOSTILE)]
    answer = w.answer | {"picture": picture, "facts": facts, "status": HOSTILE, "mean_velocity": {HOSTILE: 1.0}}
    mounted(page, w, title=HOSTILE, sliders=sliders, answer=answer)
    page.evaluate("text => window.model.answer({ id: null, error: text })", HOSTILE)
    assert HOSTILE in page.locator("#here").inner_text() and page.locator("#here img").count() == 0 and page.title() == "quiet"


@each_row("width", [380, 1280])
def test_nothing_is_cut_off(page, width):
    page.set_viewport_size({"width": width, "height": 900})
    mounted(page, ss.widget(ss.Chain.example()))
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    left = "[...document.querySelectorAll('svg')].every(s => [...s.querySelectorAll('text')].every(t => t.getBBox().x >= 0))"
    assert page.evaluate(left)


# ---- a notebook ----
def test_a_notebook_with_the_widget_runs(tmp_path):
    nbformat, nbclient = (pytest.importorskip(name, reason=f"{name} is not installed") for name in ("nbformat", "nbclient"))
    lines = (
        "import stickslip as ss\nw = ss.widget(ss.presets.piezo_rig(tilt_deg=1.7, amplitude='0.5 mm', law='coulomb'))\nw",
        "w.values = {'drive.amplitude': '0.6 mm'}\nprint(w.machine.drive.amplitude)",
    )
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(each) for each in lines])
    nbclient.NotebookClient(book, timeout=240, resources={"metadata": {"path": str(tmp_path)}}).execute()
    view = "application/vnd.jupyter.widget-view+json"
    [id] = [out.data[view]["model_id"] for out in book.cells[0].outputs if view in out.get("data", {})]
    state = book.metadata.widgets["application/vnd.jupyter.widget-state+json"]["state"][id]["state"]
    assert book.cells[1].outputs[0].text == "0.0006\n"
    assert state["answer"]["mean_velocity"]["body"] > 0 and "drive.amplitude" in [each["name"] for each in state["sliders"]]
