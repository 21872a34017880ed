"""Libraries that not everybody installs: where one is missing, the error says what to type, and that this exists."""

import re
import sys
import tomllib

import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from house import ROOT
from rows import each_row
from stickslip.dynamics.periodic.ball_arithmetic import flint_for
from stickslip.inverse.identification.sampling import sample
from stickslip.show.explorer.widget import _widget_class
from stickslip.studies.cluster import connected

EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]


def exported(path):
    ss.studies.export(xr.Dataset({"v": ("t", np.arange(3.0))}), path)


def read(path):
    path.write_bytes({".xlsx": b"PK\x03\x04", ".tdms": b"TDSm"}[path.suffix] + bytes(60))
    ss.read(path)


def clustered(path):
    connected("tcp://127.0.0.1:1")


def certified(path):
    flint_for("certify")


def shown(path):
    _widget_class.__wrapped__()


def sampled(path):
    sample(None, 100)  # it asks for its library before anything else


@each_row(
    ("name", "door", "file", "extra"),
    [
        ("pyarrow", exported, "grid.parquet", "parquet"),
        ("zarr", exported, "grid.zarr", "zarr"),
        ("openpyxl", exported, "grid.xlsx", "io"),
        ("openpyxl", read, "log.xlsx", "io"),
        ("nptdms", read, "log.tdms", "io"),
        ("dask.distributed", clustered, "", "dask"),
        ("flint", certified, "", "certify"),
        ("emcee", sampled, "", "bayes"),
        ("anywidget", shown, "", "widget"),
    ],
)
def test_a_missing_library_is_told_with_what_to_type(name, door, file, extra, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)  # Python's own way to say: not here
    with pytest.raises(ss.InputError) as told:
        door(tmp_path / file)
    assert f'type pip install "stickslip[{extra}]"' in str(told.value)


def test_every_extra_that_is_told_of_exists():
    texts = [p.read_text(encoding="utf-8") for p in (ROOT / "src" / "stickslip").rglob("*.py")]
    told = {extra for text in texts for found in re.findall(r"stickslip\[([a-z,]+)\]", text) for extra in found.split(",")}
    assert told and told <= set(EXTRAS)


def test_nobody_else_says_what_to_install():
    """`stickslip.basics.optional.library` is the one place that turns a failed import into an error; files of users are another matter."""
    asking = re.compile(r"except (ImportError|ModuleNotFoundError)[^\n]*:\n\s+raise")
    paths = (ROOT / "src" / "stickslip").rglob("*.py")
    others = [p.name for p in paths if p.name != "optional.py" and asking.search(p.read_text(encoding="utf-8"))]
    assert not others, f"{others}: ask stickslip.basics.optional.library"
