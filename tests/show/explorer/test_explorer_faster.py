"""“Make it faster” of the explorer: the best of the chosen sliders between their ends, what it costs, and what cannot be asked."""

import json

import pytest

import stickslip as ss
from rows import each_row
from stickslip.show.explorer import faster
from stickslip.show.explorer.faster import faster_of
from stickslip.show.explorer.machines import Shown
from stickslip.show.explorer.requests import Stopped, message
from stickslip.show.explorer.sliders import PARAMETERS


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """However busy the machine is, the search goes to its end."""
    monkeypatch.setattr(faster, "PATIENCE", 600.0)


class Ready:
    """Kernels that are there, or not."""

    def __init__(self, there=True):
        self.there = there

    def ready(self, *of):
        return self.there


def wish(*sliders, keep=(), law="coulomb", **more):
    given = {"channel": "faster", "id": 1, "sliders": list(sliders), "keep": list(keep)}
    return message(json.dumps({**given, **(more or {"state": {"law": law, "also": []}})}))


def row(found, name):
    return next((r["before"], r["after"]) for r in found["rows"] if r["name"] == name)


@pytest.mark.slow
def test_it_finds_what_optimise_finds_and_keeps_what_must_not_grow():
    asked = wish("amplitude", "omega", keep=["relative_acceleration"])
    found = faster_of(asked, Ready(), lambda: False)
    robot = asked.state.robot()
    ends = {f"drive.{name}": (PARAMETERS[name].low, PARAMETERS[name].high) for name in ("amplitude", "omega")}
    now = robot.drive.amplitude * robot.drive.omega**2
    best = ss.optimise(robot, over=ends, maximise="mean_velocity", subject_to={"relative_acceleration": (None, now)})
    before, after = row(found, "mean_velocity")
    assert before == pytest.approx(ss.periodic_orbit(robot).mean_velocity, rel=1e-6)
    # the population alone, without derivatives, comes as near as boxes of 2e-4 of the sliders allow
    assert after == pytest.approx(best["mean_velocity"], rel=1e-4)
    assert row(found, "relative_acceleration")[1] <= now * (1 + 1e-9)
    made = robot.replace({f"drive.{name}": value for name, value in found["values"].items()})
    assert after == pytest.approx(ss.periodic_orbit(made).mean_velocity, rel=1e-6)
    assert found["ends"] == ["amplitude"]


def test_backwards_it_goes_on_backwards():
    found = faster_of(wish("amplitude", state={"law": "coulomb", "also": [], "values": {"tilt_deg": -1.7}}), Ready(), lambda: False)
    before, after = row(found, "mean_velocity")
    assert after < before < 0.0


def test_what_is_fastest_already_is_left_and_told():
    most = {name: PARAMETERS[name].high for name in ("amplitude", "omega")}
    found = faster_of(wish(*most, state={"law": "coulomb", "also": [], "values": most}), Ready(), lambda: False)
    assert found["values"] == most
    assert "no faster setting was found" in found["notes"][0]


@pytest.mark.slow
def test_a_machine_of_several_bodies_goes_faster_in_opposite_phase():
    shown = Shown(ss.presets.two_modules())
    given = {"phases.1": 1.0, "modules.0.drive.amplitude": 6e-4, "modules.1.drive.amplitude": 6e-4}
    found = faster_of(wish("phases.1", machine=given), Ready(), lambda: False, shown)
    assert abs(found["values"]["phases.1"]) == pytest.approx(3.14159, abs=0.02)
    assert row(found, "mean_velocity")[1] > row(found, "mean_velocity")[0]
    assert "drive_power" not in [r["name"] for r in found["rows"]]


def test_it_waits_for_a_kernel_and_stops_when_nobody_waits():
    assert "preparing" in faster_of(wish("amplitude"), Ready(False), lambda: False)["waits"]
    with pytest.raises(Stopped):
        faster_of(wish("amplitude"), Ready(), lambda: True)


@each_row(
    ("given", "told"),
    [
        ({"sliders": []}, "no slider may move"),
        ({"sliders": "amplitude"}, "list of up to"),
        ({"sliders": ["a"] * 9}, "list of up to"),
        ({"sliders": ["amplitude"], "keep": ["speed"]}, "keep"),
        ({"sliders": ["u1"]}, "has no effect here"),
        ({"sliders": ["voltage", "\ud800"]}, "has no effect here"),
        ({"sliders": ["amplitude"], "machine": {}}, "shows a robot"),
    ],
)
def test_what_cannot_be_asked_is_told(given, told):
    with pytest.raises(ss.InputError, match=told):
        faster_of(message(json.dumps({"channel": "faster", "id": 1, **given})), Ready(), lambda: False)


def test_what_has_no_period_is_told():
    belt = ss.BlockOnBelt(mass=1.0, stiffness=100.0, friction=ss.Coulomb(0.1, 0.2), load=1.0, damping=0.1, speed=0.1)
    with pytest.raises(ss.InputError, match="no drive period"):
        faster_of(wish("speed", machine={}), Ready(), lambda: False, Shown(belt))
