"""`stickslip explore ROBOT`: a robot becomes the state of the page that shows it, or it is said what the page cannot show."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from urllib.parse import parse_qs

import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.fields import leaves
from stickslip.show.cli.commands.explore import _opened
from stickslip.show.explorer.exports import export
from stickslip.show.explorer.from_robot import hash_of, state_of
from stickslip.show.explorer.models import CONTACTS, DRIVES, FRICTION, TRACKS, robot
from stickslip.show.explorer.paper_figures import PRESETS
from stickslip.show.explorer.requests import DEFAULT
from stickslip.show.explorer.sliders import PARAMETERS

LAWS = [law for law in FRICTION if law != "tabulated"]


def numbers(robot):
    return {name: float(value) for name, value in leaves(robot)}


def test_the_pages_folded_track_knows_its_tilt():
    """It has the note of the preset where another law takes the place of the one that contains the incline."""
    values = {name: p.default for name, p in PARAMETERS.items()}
    made, same = robot("harmonic", "folded", "isotropic", "lugre", values), ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)
    assert made.track.folded == same.track.folded == pytest.approx(1.7 * math.pi / 180, rel=1e-15)
    assert any("the tilt of 1.7 degrees was folded" in note for note in made.replace(friction=ss.Coulomb(0.1, 0.2)).notes)
    assert robot("harmonic", "level", "isotropic", "lugre", values).track.folded == 0.0


@each_row("drive", DRIVES)
@pytest.mark.parametrize("track", TRACKS)
def test_a_robot_of_the_page_comes_back(drive, track):
    for contact in CONTACTS:
        for law in LAWS:
            made = replace(DEFAULT, drive=drive, track=track, contact=contact, law=law, also=()).robot()
            assert numbers(state_of(made).robot()) == pytest.approx(numbers(made), rel=1e-12)


@each_row("name", [name for name in PRESETS if name.startswith("figure")])
def test_the_robots_of_the_paper_keep_their_tilt(name):
    preset = PRESETS[name]["state"]
    asked = replace(DEFAULT, **{k: preset[k] for k in ("drive", "track", "law")}, also=(), values=DEFAULT.values | preset["values"])
    found = state_of(asked.robot())
    shown = {"mu0", "f0", "tilt_deg", "amplitude", "v_s"} & set(asked.active)
    assert found.track == "folded" and all(found.values[n] == pytest.approx(asked.values[n], rel=1e-12) for n in shown)


def test_the_study_file_of_a_page_opens_the_page_again(tmp_path):
    asked = replace(DEFAULT, drive="recorded", law="stribeck", also=(), values=DEFAULT.values | {"tilt_deg": -3.0, "mu0": 0.2, "f0": 0.33})
    (tmp_path / "study.toml").write_bytes(export("study.toml", asked))
    told = parse_qs(_opened(str(tmp_path / "study.toml"), [])[0].removeprefix("#"))
    assert told["drive"] == ["recorded"] and told["law"] == ["stribeck"] and told["track"] == ["folded"]
    assert [float(told[n][0]) for n in ("tilt_deg", "mu0", "f0")] == pytest.approx([-3.0, 0.2, 0.33], rel=1e-12)
    assert len(told["shape"][0].split(",")) == 10


def test_words_set_numbers():
    told = parse_qs(_opened("piezo_rig", ["law=coulomb", "tilt_deg=1.7", "amplitude=6e-4"])[0].removeprefix("#"))
    assert told["law"] == ["coulomb"] and float(told["amplitude"][0]) == 6e-4


@each_row(
    ("change", "said"),
    [
        ({"friction": ss.friction.Bristle.example()}, "no control for the friction law Bristle; it has"),
        ({"friction": ss.Coulomb(0.2, 0.3) + ss.Viscous(0.1, 0.1)}, "no control for the friction law Coulomb + Viscous"),
        ({"drive": ss.MultiHarmonic(omega=200.0, amplitudes=(1e-4, 1e-4, 1e-4), phases=(0.0, 0.1, 0.2))}, "no control for this drive"),
        ({"drive": ss.MultiHarmonic(omega=200.0, amplitudes=(1e-4, 1e-4), phases=(0.3, 0.1))}, "no control for this: drive.phases"),
        ({"body_mass": 1e5}, "body_mass = 1e+08 g; the page takes 0.01 g to 200000 g"),
    ],
)
def test_what_the_page_cannot_show_is_said(change, said):
    with pytest.raises(ss.InputError, match=re.escape(said)) as raised:
        state_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4).replace(**change))
    assert raised.value.what == "explore"


def test_a_mechanism_is_no_robot_of_the_page():
    with pytest.raises(ss.InputError, match="BlockOnBelt is not a robot on a track"):
        state_of(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0)))


def test_an_address_holds_what_matters():
    told = parse_qs(hash_of(DEFAULT).removeprefix("#"))
    assert set(told) == {"drive", "track", "contact", "law", "also", *DEFAULT.active}
