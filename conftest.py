"""What every test and every doctest shares: one kernel cache for the run, no windows, no litter."""

import os
import shutil
import sys
import tempfile

import pytest

CACHE = "STICKSLIP_CACHE_DIR"
# Kernel texts are read by the engine, never imported.
collect_ignore_glob = ["src/stickslip/engine/kernels/*"]
_made_here = pytest.StashKey[str]()


def pytest_configure(config):
    """Before any worker starts: they inherit the environment, and so one kernel cache."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    if not os.environ.get(CACHE):
        config.stash[_made_here] = os.environ[CACHE] = tempfile.mkdtemp(prefix="stickslip-test-cache-")


def pytest_unconfigure(config):
    folder = config.stash.get(_made_here, None)
    if folder is not None:
        os.environ.pop(CACHE, None)
        shutil.rmtree(folder, ignore_errors=True)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """More than eight workers only compete for the kernels that one of them compiles."""
    return min(os.cpu_count() or 1, 8)


@pytest.fixture(autouse=True)
def _tidy(request):
    """A doctest may write files: it runs in a folder of its own. Figures are closed after every test."""
    if isinstance(request.node, pytest.DoctestItem):
        request.getfixturevalue("monkeypatch").chdir(request.getfixturevalue("tmp_path"))
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
