"""Friction from a log that is dropped on the page: what is proposed, what is fitted, and what a hostile page or file gets."""

import json
import re
import threading
import time
from urllib.parse import quote
from urllib.request import Request, urlopen

import numpy as np
import pytest

from browsed import Page
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.show.explorer.frames import unpacked
from stickslip.show.explorer.log_choices import choices_of
from stickslip.show.explorer.log_fits import Fitters
from stickslip.show.explorer.log_uploads import plan_response, record_response, unpacked_records
from stickslip.show.explorer.upload_reading import Reader

F, V_S = 3.4, 8e-4  # the truth of the rig, with a kinetic friction of 2.4 N


def rig_rows(seconds=6.0, seed=0):
    """A rig without any unit, as a student exports it."""
    rng, t = np.random.default_rng(seed), np.arange(0, seconds, 0.004)
    x, v = 3.8e-3 * np.sin(4.4 * t), 3.8e-3 * 4.4 * np.cos(4.4 * t)
    force = np.where(v > 0, 2.4, -2.4) + np.sign(v) * (F - 2.4) * np.exp(-((v / V_S) ** 2)) + rng.normal(0, 0.03, len(t))
    return "\n".join(["time,weg,kraft", *(f"{a:.4f},{1e3 * b:.6f},{c:.4f}" for a, b, c in zip(t, x, force, strict=True))])


@pytest.fixture(scope="module")
def page(browser, explorer):
    made = Page(browser, explorer, width=380, height=800)
    made.open()
    yield made
    assert made.errors == [] and made.outside == []
    made.context.close()


def drop(page, files):
    page.page.evaluate(
        """files => { const data = new DataTransfer();
             for (const [name, text] of Object.entries(files)) data.items.add(new File([text], name));
             window.dispatchEvent(new DragEvent("drop", {dataTransfer: data, bubbles: true, cancelable: true})); }""",
        files,
    )


def test_a_drop_and_a_click_give_friction_whose_intervals_hold_the_truth(page, tmp_path, monkeypatch, capsys):
    files = {"rig.csv": rig_rows(4.0), "again.csv": rig_rows(3.0, 1)}
    drop(page, files)
    page.page.locator("#fit-columns [data-state=check]", has_text="kraft").wait_for()
    assert page.page.get_by_label("unit of kraft").input_value() == "N"
    assert page.page.get_by_label("role of weg").input_value() == "position"
    page.page.locator("#fit-start").click()
    page.page.locator("#fit-result:not([hidden])").wait_for()
    rows = "body => [...body.rows].map(row => [row.cells[0].firstChild.data, row.cells[2].innerText])"
    cells = page.page.locator("#fit-rows tbody").evaluate(rows)
    intervals = {name: re.match(r"(\S+) to (\S+)", text).groups() for name, text in cells}
    assert all(float(intervals[name][0]) < truth < float(intervals[name][1]) for name, truth in {"mu": 2.4, "f": F, "v_s": V_S}.items())
    others = page.page.locator("#fit-lists li", has_text=re.compile("^coulomb: ")).inner_text()
    assert "neighbours correlated" in others  # why another law is not supported
    drawn = page.page.locator("#fit-pictures img")
    assert drawn.count() == 6 and all(drawn.nth(k).evaluate("image => image.decode().then(() => image.naturalWidth)") > 0 for k in range(6))
    assert page.page.locator("#fit-pictures figcaption", has_text="again.csv").count() == 3
    assert page.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    exec(page.page.locator("#fit-python").inner_text(), {})  # the Python makes the same numbers
    assert " to ".join(intervals["v_s"]) in capsys.readouterr().out


def test_a_fit_can_be_stopped_and_the_page_stays_usable_meanwhile(page):
    drop(page, {"long.csv": rig_rows(30.0)})
    page.page.locator("#fit-name", has_text="long.csv").wait_for()
    page.page.locator("#fit-columns [data-state=check]").first.wait_for()
    page.page.locator("#fit-start").click()
    with page.change():
        page.slide("tilt_deg", 1.2)
    assert page.page.locator("#fit-stop").is_visible()
    page.page.locator("#fit-stop").click()
    page.page.locator("#fit-said", has_text="stopped").wait_for()
    assert page.page.locator("#fit-start").is_enabled() and page.page.locator("#fit-result").is_hidden()


def test_the_model_takes_the_frequency_of_a_record_on_a_click_and_one_field_takes_all_numbers_by_their_names(page):
    t = np.arange(0, 1.5, 1e-3)
    rows = "\n".join(f"{a:.4f},{3 + 20 * np.sin(2 * np.pi * 58 * a):.5f}" for a in t)
    drop(page, {"v.csv": f"t [s],v [mm/s]\n{rows}"})
    page.page.locator("#record-frequency", has_text="58 Hz, the model 32.7 Hz").wait_for()
    with page.change():
        page.page.locator("#record-frequency-take").click()
    assert float(page.page.locator("input[name=omega]").input_value()) == pytest.approx(2 * np.pi * 58, rel=1e-4)
    assert page.page.locator("#record-frequency").is_hidden()
    fields = page.page.locator("#fit-numbers input")
    page.page.locator("#fit-said", has_text="One field takes all of them: amplitude=5e-4 tilt_deg=1.7").wait_for()
    for typed, said in (("amplitude=0,5 mm, tilt_deg=x", "tilt_deg is not a number"), ("amplitud=0.5", "amplitud is not known")):
        fields.nth(0).fill(typed)
        fields.nth(0).blur()
        page.page.locator("#fit-said", has_text=said).wait_for()
        assert fields.nth(0).input_value() == typed
    fields.nth(0).fill("--set amplitude=0,5 mm --set tilt_deg=1.7")
    fields.nth(0).blur()
    page.page.locator("#fit-said:not([data-state=busy])", has_text=re.compile("^$")).wait_for(state="attached")
    assert [fields.nth(k).input_value() for k in range(5)] == ["0.5 mm", "1.7", "", "", ""]


# what is proposed ---------------------------------------------------------------------------------------------------


@each_row(
    ("text", "wish", "machine", "problem"),
    [("time_s,pos_mm,F_N\n0,0,1\n1,2,-1\n2,0,1\n", {}, "rig", ""),
     ("time_s,pos_mm,F_N\n0,0,1\n1,2,-1\n2,0,1\n", {"machine": "slider"}, "slider", ""),
     ("time_ms,pos_deg,cur_mA,foo\n0,0,1,1\n1,2,-1,2\n2,0,1,3\n", {}, "joint", ""),
     ("time_ms,pos_deg,cur_mA,foo\n0,0,1,1\n1,2,-1,2\n2,0,1,3\n", {"roles": {"cur_mA": "unused"}}, "", "no machine suits the file"),
     ("t,v,temp\n" + "\n".join(f"{k},{k % 4},1" for k in range(64)), {}, "robot", "amplitude and tilt_deg are missing"),
     ("t,v,temp\n" + "\n".join(f"{k},{k % 4},1" for k in range(64)), {"numbers": {"amplitude": 1e-3, "tilt_deg": 1}}, "robot", "")],
)  # fmt: skip
def test_a_log_is_proposed_with_its_machine_and_what_is_missing(text, wish, machine, problem):
    header, _ = unpacked(plan_response("a.csv", text.encode(), wish))
    assert header["machine"] == machine and header["problem"].startswith(problem) and bool(header["problem"]) == bool(problem)


def test_the_process_that_fits_gets_every_number_of_the_record():
    wish = {"units": {"kraft": "mN", "weg": "mm", "time": "ms"}}
    (record,) = unpacked_records(record_response("../../a.csv", rig_rows(0.1).encode(), wish))
    assert record.source["path"] == "a.csv" and [c.unit for c in record.channels.values()] == ["mm", "mN"]
    cells = np.array([line.split(",") for line in rig_rows(0.1).splitlines()[1:]], float)
    found = np.stack([record["weg"].t, record["weg"].values, record["kraft"].values], axis=1)
    assert np.array_equal(found, cells) and record["kraft"].si == pytest.approx(1e-3 * cells[:, 2])


def test_files_of_one_machine_are_fitted_together_whatever_their_columns_are_called():
    parts = {"a.csv": rig_rows(0.2).encode(), "b.csv": rig_rows(0.1, 1).replace("kraft", "F [N]").encode()}
    together, wish = b"".join(parts.values()), {"files": [[name, len(data)] for name, data in parts.items()]}
    header, _ = unpacked(plan_response("a.csv", together, wish))
    assert header["machine"] == "rig" and not header["problem"] and header["units"] == {"time": "s", "weg": "mm", "kraft": "N"}
    assert [c["name"] for c in header["channels"]] == ["time", "weg", "kraft", "F"]
    sent = unpacked_records(record_response("a.csv", together, wish | {"units": header["units"]}))
    assert [record.source["path"] for record in sent] == ["a.csv", "b.csv"] and [len(record["force"].si) for record in sent] == [50, 25]
    with pytest.raises(InputError, match="other lengths"):
        plan_response("a.csv", together[:-1], wish)
    damaged = {"files": [["a.csv", len(together) - 3], ["b.csv", 3]]}
    with pytest.raises(InputError, match=r"b\.csv: "):
        plan_response("a.csv", together[:-3] + b"abc", damaged)


def test_robots_of_several_files_have_their_own_amplitudes():
    rows = ["t [s],v [mm/s]\n" + "\n".join(f"{k / 1000},{np.sin(2 * np.pi * f * k / 1000):.6f}" for k in range(400)) for f in (50, 60)]
    wish = {"files": [["a.csv", len(rows[0])], ["b.csv", len(rows[1])]], "numbers": {"amplitude": [5e-4, 8e-4], "tilt_deg": 2}}
    header, _ = unpacked(plan_response("a.csv", "".join(rows).encode(), wish))
    fields = {field["name"]: field for field in header["numbers"]}
    assert not header["problem"] and fields["amplitude"]["each"] and fields["frequency"]["assumed"] == "50 Hz, 60 Hz"
    with pytest.raises(InputError, match="amplitude has 3 numbers and there are 2 files"):
        plan_response("a.csv", "".join(rows).encode(), wish | {"numbers": {"amplitude": [1.0, 2.0, 3.0]}})


# what is hostile ----------------------------------------------------------------------------------------------------


@each_row(
    "wish",
    [None, [], {"units": []}, {"units": {"a": 1}}, {"numbers": {"a": 300 * "1"}}, {"numbers": {"a": True}}, {"law": ["lugre"]},
         {"machine": 300 * "a"},
     {"roles": {f"c{k}": "force" for k in range(100)}}, {"numbers": {"a": []}}, {"files": [["a.csv"]]}, {"files": [["a.csv", -1]]},
     {"files": 40 * [["a.csv", 0]]}, {"files": "a.csv"}],
)  # fmt: skip
def test_choices_that_are_none_are_refused(wish):
    with pytest.raises(InputError):
        choices_of(wish)


def test_a_file_that_cannot_be_read_reaches_no_fit(explorer):
    for name, data, choices in (("a.csv", b"no numbers", {}), ("a.mat", b"\x00" * 200, {}), ("a.csv", rig_rows(0.1).encode(), "no table")):
        address = f"http://127.0.0.1:{explorer.port}/fit/{name}?choices={quote(json.dumps(choices))}"
        with urlopen(Request(address, data, {"Cookie": explorer.cookie}, method="POST"), timeout=60) as reply:
            header, _ = unpacked(reply.read())
        assert header["kind"] == "problems" and header["problems"]


def test_a_fit_that_is_ended_says_so_and_leaves_no_process_and_the_next_one_is_made():
    fitters, reader = Fitters(), Reader(60.0)
    wish = {"units": {"kraft": "N", "weg": "mm", "time": "s"}, "law": "coulomb", "name": "a.csv"}
    record = reader.read("record", "a.csv", rig_rows(1.0).encode(), wish)
    reader.end()
    child = fitters.taken()
    child.start()
    process = child._running._process
    timer = threading.Timer(0.2, child.end)
    timer.start()
    began = time.monotonic()
    header, _ = unpacked(fitters.fit(child, wish, record))
    assert header["kind"] == "problems" and time.monotonic() - began < 60 and process.wait(60) != 0
    header, _ = unpacked(fitters.fit(fitters.taken(), wish, record))
    assert header["kind"] == "fit" and header["law"] == "coulomb"
    fitters.close()
    assert fitters.taken() is None
