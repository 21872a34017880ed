"""Would the tests notice a wrong formula? 300 fixed mutants of laws, drives, mechanisms, forces, robot and tracks, one at a time.

Run: python verification/mutants.py [--count N] [--only WORD] [--workers N]

A mutant is one formula with one thing changed: a sign, an operation, a factor of ten, forwards for backwards, the two branches of a
`where`. It is tested by what needs no compiler: first by the doctests of its own file, then by the tests below that take less than
a second each. Which mutants are taken depends on their text alone, so the sample stays the same while other code changes. Those that
no test can notice because they compute the same stand in mutants.json, each with the reason. Exit code 1 if any other survives.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.abc
import importlib.util
import json
import os
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
from mutating import FORMULAS, ROOT, SOURCE, Mutant, every, mutated

#: Tests by the folder that they are mostly about; those of other folders come last.
ABOUT = {
    "friction": ("formulas", "laws"),
    "drives": ("formulas", "drives", "cantilever", "piezo_beam"),
    "mechanisms": ("formulas", "mechanisms"),
}
NAMES = ("formulas", "laws", "drives", "mechanisms", "tracks", "plain", "cantilever", "piezo_beam")
SLOWEST, PATIENCE = 1.0, 600  # seconds of a test, and of a mutant: one that runs without end counts as killed
NO_TESTS, ENDLESS = 5, -1  # exit codes
PRELOADED = ["numpy", "scipy.integrate", "scipy.optimize", "scipy.stats", "scipy.linalg", "scipy.signal", "xarray", "mpmath", "sympy"]


class Mutated(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports one module from its changed syntax, and no compiler at all."""

    def __init__(self, mutant: Mutant | None):
        self.mutant = mutant
        self.module = "" if mutant is None else "stickslip." + mutant.file[:-3].replace("/", ".").removesuffix(".__init__")

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        if name.split(".")[0] in ("numba", "llvmlite"):
            raise ImportError(f"{name} is left out")
        if self.mutant is None or name != self.module:
            return None
        return importlib.util.spec_from_file_location(name, SOURCE / self.mutant.file, loader=self)

    def exec_module(self, module: Any) -> None:
        assert self.mutant is not None
        exec(compile(mutated(self.mutant.file, self.mutant.change)[0], str(SOURCE / self.mutant.file), "exec"), module.__dict__)


class Tests:
    """Keeps the tests that are given, in their order, and notes how long each took and the first that failed."""

    def __init__(self, order: dict[str, float] | None):
        self.order, self.passed, self.failed = order, {}, ""

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        if self.order is not None:
            items[:] = sorted((i for i in items if i.nodeid in self.order), key=lambda i: self.order[i.nodeid])

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.when == "call" and report.passed:
            self.passed[report.nodeid] = report.duration
        self.failed = self.failed or (report.nodeid if report.failed else "")


def run(mutant: Mutant | None, order: dict[str, float] | None, answer: Path) -> None:
    """In a process of its own: test one mutant, write down what came of it, and end."""
    sys.meta_path.insert(0, Mutated(mutant))
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1), os.dup2(quiet, 2)
    signal.alarm(PATIENCE if mutant else 0)
    tests = Tests(order)
    doctests = [str(p.relative_to(ROOT)) for g in FORMULAS for p in SOURCE.glob(g)]
    files = {name: f"tests/test_{name}.py" for name in NAMES}
    if mutant is None:
        parts = [[*files.values(), *doctests]]
    else:  # the nearest first
        near = ABOUT.get(mutant.file.partition("/")[0], ("tracks", "drives"))
        parts = [[f"src/stickslip/{mutant.file}"], [files[name] for name in near], [files[name] for name in NAMES if name not in near]]
    try:
        importlib.import_module(Mutated(mutant).module or "stickslip")  # before pytest, which imports files by their paths
        for part in parts:
            code = int(pytest.main([*part, "-q", "-p", "no:cacheprovider", "--tb=no", *(["-x"] if mutant else [])], plugins=[tests]))
            if code not in (0, NO_TESTS):
                break
    except BaseException as error:
        code, tests.failed = 1, repr(error)
    answer.write_text(json.dumps([code, tests.failed, tests.passed]))
    os._exit(0)


def tested(mutants: list[Mutant | None], order: dict[str, float] | None, workers: int) -> Iterator[tuple[Any, int, str, dict[str, float]]]:
    """Each mutant with the exit code of its tests, the test that failed, and the seconds of those that passed."""
    folder, open_ones, left = Path(tempfile.mkdtemp()), {}, list(enumerate(mutants))
    while left or open_ones:
        if left and len(open_ones) < workers:
            number, mutant = left.pop(0)
            child = os.fork()
            if child == 0:
                run(mutant, order, folder / str(number))
            open_ones[child] = number, mutant
            continue
        child, _ = os.wait()
        number, mutant = open_ones.pop(child)
        said = folder / str(number)
        yield (mutant, *(json.loads(said.read_text()) if said.exists() else (ENDLESS, "", {})))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="mutants (300)")
    parser.add_argument("--workers", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", default="", help="mutants whose name contains this")
    given = parser.parse_args()
    os.chdir(ROOT), sys.path.insert(0, str(ROOT / "src"))
    os.environ["STICKSLIP_CACHE_DIR"] = tempfile.mkdtemp()  # nothing is compiled, and an empty cache is looked through at once
    for name in PRELOADED:
        importlib.import_module(name)
    ((_, _, failed, passed),) = tested([None], None, 1)
    if not passed:
        sys.exit(f"no test runs without a compiler: {failed}")
    order = {name: seconds for name, seconds in passed.items() if seconds < SLOWEST}
    known = json.loads((ROOT / "verification" / "mutants.json").read_text(encoding="utf-8"))
    there = every()
    chosen = [m for m in there if given.only in m.name][: given.count]
    print(f"{len(order)} tests in {sum(order.values()):.0f} s; {len(chosen)} of {len(there)} mutants", flush=True)
    began, ends = time.perf_counter(), Counter[str]()
    for mutant, code, failed, _ in tested(list(chosen), order, given.workers):
        verdict = (
            "no answer"
            if code == ENDLESS
            else "killed"
            if code not in (0, NO_TESTS)
            else "the same"
            if mutant.name in known
            else "SURVIVES"
        )
        ends[verdict] += 1
        print(
            f"{verdict:9} {mutant.name}  {failed.rpartition('::')[2] if code not in (0, NO_TESTS) else known.get(mutant.name, '')}",
            flush=True,
        )
    print(f"{'; '.join(f'{n} {verdict}' for verdict, n in ends.items())}, in {time.perf_counter() - began:.0f} s")
    return 1 if ends["SURVIVES"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
