"""What every test and every doctest shares: one kernel cache for the run, no windows, no litter."""

import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import pytest

CACHE = "STICKSLIP_CACHE_DIR"
# Kernel texts are read by the engine, never imported.
collect_ignore_glob = ["src/stickslip/engine/kernels/*"]
_made_here = pytest.StashKey[str]()
_began = pytest.StashKey[float]()


def pytest_configure(config):
    """Before any worker starts: they inherit the environment, and so one kernel cache."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    config.stash[_began] = time.time()
    if not os.environ.get(CACHE):
        config.stash[_made_here] = os.environ[CACHE] = tempfile.mkdtemp(prefix="stickslip-test-cache-")


def pytest_unconfigure(config):
    folder = config.stash.get(_made_here, None)
    if folder is not None:
        os.environ.pop(CACHE, None)
        shutil.rmtree(folder, ignore_errors=True)


def pytest_terminal_summary(terminalreporter, config):
    """Kernels that were compiled during this run, in whichever process, and the time that took."""
    began = config.stash[_began]
    spans = [(max(begin, began), end) for begin, end in map(_compiled, Path(os.environ[CACHE]).glob("*.py")) if end >= began]
    terminalreporter.write_line(f"kernels: {len(spans)} compiled in {sum(end - begin for begin, end in spans):.0f} s")


def _compiled(source):
    """When a kernel's text was written, which is just before it is compiled, and its last function; 0 if that is not there."""
    written = [file.stat().st_mtime for file in (source.parent / "__pycache__").glob(f"{source.stem}.*.nbc")]
    return source.stat().st_mtime, max(written, default=0.0)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """More than eight workers only compete for the kernels that one of them compiles."""
    return min(os.cpu_count() or 1, 8)


@pytest.fixture
def every_report(monkeypatch):
    """Progress is reported however soon it comes after the last report: a test that says stop does not race a fast machine."""
    monkeypatch.setattr("stickslip.sweeps.progress.PAUSE", 0.0)


@pytest.fixture(autouse=True)
def _tidy(request):
    """A doctest may write files: it runs in a folder of its own. Figures are closed after every test."""
    if isinstance(request.node, pytest.DoctestItem):
        request.getfixturevalue("monkeypatch").chdir(request.getfixturevalue("tmp_path"))
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
