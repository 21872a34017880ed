"""The folder with measured records, and the tests that need it."""

import os
from pathlib import Path

import pytest

FOLDER = os.environ.get("STICKSLIP_DATA")
needs_data = pytest.mark.skipif(not FOLDER, reason="set STICKSLIP_DATA to the folder with measured records")
LOOPS = "frictionmodelsjl_test_data_2.txt"
LDV = "okubo_LDV_frontcenter_S200V.csv"
CYLINDER = {"1 bar": ("zillen_O-ring257_1bar.csv", 7.17), "7 bar": ("zillen_O-ring257_7bar.csv", 12.39)}
CYLINDER_COLUMNS = ["t [ms]", "laser raw [V]", "pressure raw [V]", "force raw [V]", "laser [mm]", "pressure [bar]", "force [N]"]
MODE = "vibrationtesting_case1.mat"


def path(name):
    return Path(FOLDER or ".") / name
