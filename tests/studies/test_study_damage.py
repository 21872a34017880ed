"""A study folder is what was written, or says what is damaged and what to type; nothing in it is changed without a word."""

from __future__ import annotations

import json
import shutil
from itertools import permutations

import h5py
import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from rows import each_row

AXES = dict(amplitude=np.linspace(3e-4, 7e-4, 6), law=["coulomb"], tilt_deg=[1.0, 1.7], tile=2)
RIG = ss.presets.piezo_rig


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "study"
    ss.sweep(RIG, **AXES, out=folder)
    return folder


@pytest.fixture
def study(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "study")
    return tmp_path / "study"


def opened(folder):
    with ss.open_study(folder) as grid:
        return grid.load()


def test_no_tile_passes_for_another(study):
    tiles = sorted((study / "tiles").iterdir())
    for one, other in permutations(tiles, 2):
        kept = one.read_bytes()
        one.write_bytes(other.read_bytes())
        with pytest.raises(ss.InputError, match=rf"{one.name}' is damaged .*delete it and resume"):
            opened(study)
        one.write_bytes(kept)
    assert len(tiles) == 6


def flipped(path, rng):
    """A copy of the bytes with one bit changed."""
    content = bytearray(path.read_bytes())
    bit = int(rng.integers(8 * len(content)))
    content[bit // 8] ^= 1 << bit % 8
    return bytes(content)


def silent(study, whole, flips, seed=0):
    """How often one changed bit is read as another result, without a word, and how often it is refused."""
    rng, truth, changed, refused = np.random.default_rng(seed), opened(whole), 0, 0
    parts = [*sorted((study / "tiles").iterdir()), study / "axes.nc", study / "manifest.json"]
    for i in range(flips):
        path = parts[i % len(parts)]
        kept = path.read_bytes()
        path.write_bytes(flipped(path, rng))
        try:
            changed += not opened(study).identical(truth)
        except ss.InputError as error:
            refused += 1
            assert "delete it" in str(error) or "install a newer stickslip" in str(error), error
        path.write_bytes(kept)
    return changed, refused


def test_a_flipped_bit_is_never_read_as_another_result(study, whole):
    changed, refused = silent(study, whole, 64)
    assert changed == 0 and refused > 16


@pytest.mark.slow
def test_no_flipped_bit_of_thousands_is_read_as_another_result(study, whole):
    changed, refused = silent(study, whole, 4000, seed=1)
    print(f"4000 flipped bits: {refused} refused, {changed} read as another result")
    assert changed == 0 and refused > 1000


@pytest.mark.parametrize("part", ["tiles/0000003.nc", "axes.nc", "manifest.json"])
def test_what_is_damaged_is_written_again_as_the_message_says(study, whole, part):
    path = study / part
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 16
    path.write_bytes(bytes(content[:-7]))
    with pytest.raises(ss.InputError, match=rf"{path.name}' .*delete it"):
        opened(study)
    path.unlink()
    ss.sweep(RIG, **AXES, out=study, resume=True)
    xr.testing.assert_identical(opened(study), opened(whole))


def test_damaged_axes_and_tiles_are_mended_by_resuming(study, whole):
    for part in ("tiles/0000003.nc", "axes.nc"):
        content = bytearray((study / part).read_bytes())
        content[-40] ^= 1
        (study / part).write_bytes(bytes(content[: len(content) // 2]))
    ss.sweep(RIG, **AXES, out=study, resume=True)
    xr.testing.assert_identical(opened(study), opened(whole))


@pytest.fixture
def old(study):
    """The folder as format 1 had it: no checksums."""
    for path in [*(study / "tiles").iterdir(), study / "axes.nc"]:
        path.write_bytes(path.read_bytes()[: -len("\nstickslip checksum \n") - 32])
    told = json.loads((study / "manifest.json").read_text())
    del told["checksum"]
    (study / "manifest.json").write_text(json.dumps({**told, "stickslip_format": 1}))
    return study


def test_a_folder_of_format_1_opens_with_notes_on_what_is_unchecked(old, whole):
    grid = opened(old)
    notes = json.loads(grid.attrs.pop("notes"))
    damage, models = notes
    assert damage == "kept by an earlier stickslip, without checksums: damage to the file may go unseen"
    assert "whether all results are of one model is unchecked" in models and set(notes.values()) == {12}
    xr.testing.assert_identical(grid, opened(whole))
    tiles = sorted((old / "tiles").iterdir())
    tiles[0].write_bytes(tiles[1].read_bytes())
    with pytest.raises(ss.InputError, match="tile 1 under the name of another"):
        opened(old)


def test_numbers_from_another_file_are_refused(old, tmp_path):
    (tmp_path / "raw").write_bytes(np.full(2, 7.0).tobytes())
    with h5py.File(old / "tiles" / "0000000.nc", "r+") as file:
        del file["mean_velocity"]
        file.create_dataset("mean_velocity", (2,), "f8", external=[(str(tmp_path / "raw"), 0, 16)])
    with pytest.raises(ss.InputError, match="lie in another file"):
        opened(old)


def test_a_folder_of_format_1_is_not_gone_on_with(old):
    with pytest.raises(ss.InputError, match=r"earlier stickslip \(format 1.*give another folder"):
        ss.sweep(RIG, **AXES, out=old, resume=True)


@each_row(
    "change",
    [
        {"shape": [6, 1, -2]}, {"shape": "6"}, {"tiles": 10**9}, {"cases_per_tile": 0}, {"columns": {"speed": "f8"}}, {"dims": ["a"]},
        {"stickslip_format": []}, {"attributes": None}, {"cases": 10**12}, {"study": 3},
    ],
)  # fmt: skip
def test_a_manifest_that_makes_no_sense_is_refused(old, change):
    path = old / "manifest.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(ss.InputError, match=r"study: .*manifest\.json"):
        ss.open_study(old)


@each_row("text", ["[]", "null", "[" * 100_000, '{"stickslip_format": 1}', "1", '{"stickslip_format": 1e400}'])
def test_a_manifest_that_is_none_is_refused(old, text):
    (old / "manifest.json").write_text(text)
    with pytest.raises(ss.InputError, match=r"study: .*manifest\.json"):
        ss.open_study(old)
