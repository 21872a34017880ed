"""What every test and every doctest shares: one kernel cache for the run, no windows, no litter."""

import contextlib
import gc
import importlib
import os
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

import pytest

CACHE = "STICKSLIP_CACHE_DIR"
PROPERTIES_OF = ("stickslip.solvers", "stickslip.analysis")
NO_BYTECODE, BYTECODE = "PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX"
# Kernel texts are read by the engine, never imported.
collect_ignore_glob = ["src/stickslip/engine/kernels/*"]
_made_here = pytest.StashKey[str]()
_bytecode = pytest.StashKey[str]()
_began = pytest.StashKey[float]()


def pytest_configure(config):
    """Before any worker starts: they inherit the environment, and so one kernel cache."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    # Matrices here have ten rows: a second thread of OpenBLAS only spins, on a core that another worker needs.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    config.stash[_began] = time.time()
    if not os.environ.get(CACHE):
        config.stash[_made_here] = os.environ[CACHE] = tempfile.mkdtemp(prefix="stickslip-test-cache-")
    if os.environ.pop(NO_BYTECODE, "") and BYTECODE not in os.environ:
        # Else each process that a test starts would compile all modules anew, for four seconds.
        config.stash[_bytecode] = os.environ[BYTECODE] = tempfile.mkdtemp(prefix="stickslip-test-bytecode-")


def pytest_unconfigure(config):
    for key, name in ((_made_here, CACHE), (_bytecode, BYTECODE)):
        folder = config.stash.get(key, None)
        if folder is not None:
            os.environ.pop(name, None)
            shutil.rmtree(folder, ignore_errors=True)


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Modules and test items stay until the end: Python need not look for garbage among these million objects again and again.

    Afterwards it looks less often than it would: what tests make goes without it, almost all of it.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(20_000, 20, 20)
        gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collect_file(file_path, parent):
    """A module of ours is imported as users do before its doctests are collected.

    pytest makes a second module of a file that nobody has imported: its classes are not those that the package knows, and it hides the
    function of its name in its package.
    """
    source = Path(__file__).parent / "src"
    if file_path.suffix == ".py" and file_path.is_relative_to(source / "stickslip"):
        name = ".".join(file_path.relative_to(source).with_suffix("").parts).removesuffix(".__init__")
        if not name.endswith("__main__"):
            with contextlib.suppress(Exception):  # pytest imports it again, and says what is wrong with it
                importlib.import_module(name)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems():
    """Hypothesis also tries the constants of our sources: it reads those files alone whose numbers its tests draw, and not a thousand."""
    providers = sys.modules.get("hypothesis.internal.conjecture.providers")
    with contextlib.suppress(AttributeError):  # it is not asked for, or a version that reads no sources
        providers._seen_modules.update(id(module) for name, module in list(sys.modules.items()) if not name.startswith(PROPERTIES_OF))


def pytest_terminal_summary(terminalreporter, config):
    """Kernels that were compiled during this run, in whichever process."""
    from stickslip.engine.cache import ENDING

    made = [file for file in Path(os.environ[CACHE]).glob(f"*{ENDING}") if file.stat().st_mtime >= config.stash[_began]]
    terminalreporter.write_line(f"kernels: {len(made)} compiled")
    errors = [str(report.longrepr) for report in terminalreporter.stats.get("error", ()) if isinstance(report, pytest.CollectReport)]
    if files := sorted(set(filter(None, map(unreadable, errors)))):
        terminalreporter.write_line("These files of ours keep test modules from being collected:\n" + "\n".join(files))
    elif errors:
        tell_what_is_forgotten(terminalreporter)


def unreadable(error):
    """The file of ours, its line and why, where an error at collection is that Python cannot import it."""
    places = re.findall(r"^(?:E +File \")?(?:\S*/)?(src/stickslip/\S+\.py)(?::|\", line )(\d+)", error, re.MULTILINE)
    why = re.findall(r"^E +((?:\w*ImportError|ModuleNotFoundError|\w*SyntaxError|IndentationError|NameError): .*)$", error, re.MULTILINE)
    return f"{places[-1][0]}, line {places[-1][1]}: {why[-1]}" if places and why else None


def tell_what_is_forgotten(terminalreporter):
    """Below errors at collection, which an unfinished law, drive or machine causes in many modules: what it lacks."""
    try:
        from registries import all_that_is_forgotten

        sentences = all_that_is_forgotten()
    except Exception:  # stickslip itself cannot be imported, and the errors above say why
        return
    if sentences:
        terminalreporter.write_line("The errors may come from what these lack:\n" + "\n".join(sentences))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """More than eight workers only compete for the kernels that one of them compiles."""
    return min(os.cpu_count() or 1, 8)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """A file stays with one worker: what its tests share, such as kernels, a server or a browser, is made once."""
    if config.getoption("dist") == "load":  # what `-n` means; another way may be asked for with --dist
        from xdist.scheduler import LoadFileScheduling

        return LoadFileScheduling(config, log)
    return None


@pytest.fixture(scope="module")
def browser():
    """Chromium, for the tests of a file."""
    from explorers import started_chromium

    with started_chromium() as made:
        yield made


@pytest.fixture
def every_report(monkeypatch):
    """Progress is reported however soon it comes after the last report: a test that says stop does not race a fast machine."""
    monkeypatch.setattr("stickslip.studies.progress.PAUSE", 0.0)


@pytest.fixture(autouse=True)
def _tidy(request):
    """A doctest may write files: it runs in a folder of its own. Figures are closed after every test."""
    if isinstance(request.node, pytest.DoctestItem):
        request.getfixturevalue("monkeypatch").chdir(request.getfixturevalue("tmp_path"))
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


#: Read by a type checker; nothing runs it.
collect_ignore = ["tests/typed_calls.py"]
