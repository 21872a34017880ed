"""Would the tests notice a wrong formula? 300 fixed mutants of laws, drives, mechanisms, forces, robot and tracks, one at a time.

Run: python verification/mutants.py [--count N] [--only WORD] [--again FILE] [--near] [--keep] [--workers N]

A mutant is one formula with one thing changed: a sign, an operation, a factor of ten, forwards for backwards, the two branches of a
`where`. Tests are collected once, without a compiler; then each mutant is a process of its own, in which the functions of its file get
their changed code, and which runs the tests that take less than a second: the doctests of the file first, then tests of its kind. Which
mutants are taken depends on their text alone, so the sample stays the same while other code changes. Those that no test can notice stand
in mutants.json, each with the reason. Exit code 1 if any other survives. `--near` runs the nearest tests only, which is quicker and finds
fewer; `--keep` writes the score to mutation_scores.json: when, of which commit, how many of how many mutants, and which survived.
"""

from __future__ import annotations

import argparse
import functools
import importlib
import importlib.abc
import inspect
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
from mutating import FORMULAS, ROOT, SOURCE, Mutant, every, mutated

TESTS = ("formulas", "laws", "rate_state", "drives", "recorded", "mechanisms", "tracks", "plain", "cantilever", "piezo_beam")
NEAR = {
    "friction": ("formulas", "laws", "rate_state"),
    "drives": ("formulas", "recorded", "drives", "cantilever", "piezo_beam"),
    "machines": ("mechanisms",),
}
say = functools.partial(print, file=sys.__stderr__, flush=True)  # standard output is the tests'
SLOWEST, PATIENCE = 1.0, 300  # seconds of processor time of a test and of a mutant; one that runs without end counts as killed


def _file_of(name: str) -> str:
    """Where the tests of one thing are."""
    return str(next((ROOT / "tests").rglob(f"test_{name}.py")).relative_to(ROOT))


def _near(mutant: Mutant) -> tuple[str, ...]:
    """The tests of a mutant's kind, by the folder of `models` in which it stands."""
    return NEAR.get(mutant.file.split("/")[1], ("tracks", "drives"))


class NoCompiler(importlib.abc.MetaPathFinder):
    """A Python without a compiler."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        if name.split(".")[0] == "llvmlite":
            raise ImportError(f"{name} is left out")


def functions(owner: Any, module: str) -> Iterator[FunctionType]:
    """The functions of a module and of its classes, inside whatever they are wrapped in."""
    for thing in list(vars(owner).values()):
        inner = getattr(thing, "__func__", None) or getattr(thing, "fget", None) or getattr(thing, "func", None) or thing
        inner = inspect.unwrap(inner) if callable(inner) else inner
        if isinstance(inner, type) and inner.__module__ == module and inner is not owner:
            yield from functions(inner, module)
        elif isinstance(inner, FunctionType) and inner.__module__ == module:
            yield inner


def codes(code: CodeType) -> Iterator[CodeType]:
    """The code of every function inside a code."""
    for inside in code.co_consts:
        if isinstance(inside, CodeType):
            yield inside
            yield from codes(inside)


def change(mutant: Mutant) -> bool:
    """Give the functions of the mutant's file their changed code; whether there is one that changes."""
    name = "stickslip." + mutant.file[:-3].replace("/", ".").removesuffix(".__init__")
    tree, changed = mutated(mutant.file, mutant.change)[0], False
    new = {(c.co_qualname, c.co_firstlineno): c for c in codes(compile(tree, str(SOURCE / mutant.file), "exec"))}
    for function in functions(importlib.import_module(name), name):
        code = new.get((function.__code__.co_qualname, function.__code__.co_firstlineno), function.__code__)
        function.__code__, changed = code, changed or code != function.__code__
    return changed


class Mutants:
    """A plugin of pytest that runs the collected tests once for each mutant instead of once."""

    def __init__(self, mutants: list[Mutant], known: dict[str, str], workers: int):
        self.mutants, self.known, self.workers = mutants, known, workers
        self.failed, self.seconds, self.ends = "", dict[str, float](), Counter[str]()
        self.survivors: list[str] = []
        self.folder = Path(tempfile.mkdtemp())

    def pytest_runtest_setup(self, item: Any) -> None:
        self.began = time.process_time()

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.when == "call" and report.passed:
            self.seconds[report.nodeid] = time.process_time() - self.began
        self.failed = self.failed or (report.nodeid if report.failed else "")

    def pytest_runtestloop(self, session: Any) -> bool:
        seconds = next(self.answers([None], session.items))[1]["seconds"]
        items = sorted((i for i in session.items if seconds.get(i.nodeid, SLOWEST) < SLOWEST), key=lambda i: seconds[i.nodeid])
        say(f"{len(items)} tests in {sum(seconds[i.nodeid] for i in items):.0f} s, {len(self.mutants)} mutants")
        for mutant, answer in self.answers(list(self.mutants), items):
            verdict = "killed" if answer["failed"] else "the same" if mutant.name in self.known else "SURVIVES"
            self.ends[verdict] += 1
            self.survivors += [mutant.name] if verdict == "SURVIVES" else []
            say(f"{verdict:9} {mutant.name}  {answer['failed'].rpartition('::')[2] or self.known.get(mutant.name, '')}")
        return True

    def answers(self, mutants: list[Mutant | None], items: list[Any]) -> Iterator[tuple[Any, dict[str, Any]]]:
        """What came of each mutant, several at a time; None is the unchanged code."""
        left, running = list(enumerate(mutants)), {}
        while left or running:
            if left and len(running) < self.workers:
                number, mutant = left.pop(0)
                child = os.fork()
                if child == 0:
                    self.run(mutant, items, self.folder / str(number))
                running[child] = number, mutant
                continue
            number, mutant = running.pop(os.wait()[0])
            said = self.folder / str(number)
            yield mutant, json.loads(said.read_text()) if said.exists() else {"failed": f"no answer within {PATIENCE} s"}
            said.unlink(missing_ok=True)

    def run(self, mutant: Mutant | None, items: list[Any], answer: Path) -> None:
        """In a process of its own: run the tests up to the first that fails, write down what came of it, and end."""
        if mutant is not None:
            signal.setitimer(signal.ITIMER_PROF, PATIENCE)
            items = items if change(mutant) else []  # what reaches no test survives
            near = tuple(_file_of(name) for name in _near(mutant))
            items = sorted(items, key=lambda i: 0 if i.nodeid.startswith(f"src/stickslip/{mutant.file}") else 2 - i.nodeid.startswith(near))
        for item, after in pairwise([*items, None]):
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=after)
            if mutant is not None and self.failed:
                break
        answer.write_text(json.dumps({"failed": self.failed if mutant is not None else "", "seconds": self.seconds}))
        os._exit(0)


def _keep(mutants: Mutants, there_are: int, only: str, tests: str) -> None:
    """Add the score of a run to those that are kept."""
    path = ROOT / "verification" / "mutation_scores.json"
    scores = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=ROOT).stdout.strip()
    run = sum(mutants.ends.values())
    scores.append({
        "date": time.strftime("%Y-%m-%d"), "commit": commit, "mutants": there_are, "only": only, "run": run, "tests": tests,
        "killed": mutants.ends["killed"], "the same": mutants.ends["the same"], "survived": mutants.survivors,
    })  # fmt: skip
    path.write_text(json.dumps(scores, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="mutants (300)")
    parser.add_argument("--workers", type=int, default=2, help="processes (2)")
    parser.add_argument("--only", default="", help="mutants whose name contains this")
    parser.add_argument("--again", type=Path, help="mutants that are lines of this file, or survived in it: the output of a run")
    parser.add_argument("--near", action="store_true", help="run the nearest tests only")
    parser.add_argument("--keep", action="store_true", help="write the score to mutation_scores.json")
    given = parser.parse_args()
    names = {line.rpartition("SURVIVES ")[2].strip() for line in given.again.read_text().splitlines()} if given.again else None
    os.chdir(ROOT), sys.path.insert(0, str(ROOT / "src")), sys.meta_path.insert(0, NoCompiler())
    os.environ["STICKSLIP_CACHE_DIR"] = tempfile.mkdtemp()
    known = json.loads((ROOT / "verification" / "mutants.json").read_text(encoding="utf-8"))
    there_are = every()
    wanted = [m for m in there_are if given.only in m.name and (names is None or m.name in names)][: given.count]
    mutants = Mutants(wanted, known, given.workers)
    tests, formulas = TESTS, [str(p.relative_to(ROOT)) for g in FORMULAS for p in SOURCE.glob(g)]
    if given.near:
        tests, formulas = sorted({name for m in wanted for name in _near(m)}), sorted({f"src/stickslip/{m.file}" for m in wanted})
    files = [_file_of(name) for name in tests] + formulas
    began = time.perf_counter()
    pytest.main([*files, "-q", "-p", "no:cacheprovider", "--tb=no", "--capture=no"], plugins=[mutants])
    say(f"{'; '.join(f'{n} {verdict}' for verdict, n in mutants.ends.items())}, in {time.perf_counter() - began:.0f} s")
    if given.keep and mutants.ends:
        _keep(mutants, len(there_are), given.only, "nearest" if given.near else "all")
    return 0 if mutants.ends and not mutants.ends["SURVIVES"] else 1


if __name__ == "__main__":
    raise SystemExit(main())
