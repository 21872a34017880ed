"""The kernels that are ready. Missing ones are compiled once, in a separate process, so that the page remains responsive."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.errors import StickslipError
from stickslip.basics.fields import leaves
from stickslip.models.machine_adapter import machine_of
from stickslip.show.explorer.machines import Shown
from stickslip.show.explorer.models import DRIVES, FRICTION
from stickslip.show.explorer.requests import DEFAULT, State, state

#: Seconds without a request after which the server counts as idle.
QUIET = 8.0
Key = tuple[Any, ...]
Subject = State | Shown
Helper = subprocess.Popen[str]


def key_of(robot: Model, many: bool) -> Key:
    """The key of a robot's kernel: its classes, the names of its numbers, and the fields that are not numbers."""
    numbers = {name for name, _ in leaves(robot)}
    return (many, *((name, None if name in numbers else str(value)) for name, value in leaves(robot, kinds=True)))


def compiling(shown: State, law: str) -> str:
    """The message of a page while a kernel is being prepared."""
    what = f"{FRICTION[law].label} × {DRIVES[shown.drive].label}"
    return f"preparing {what}: compiled once, which takes some seconds, and kept for later"


def warm(subject: Subject, law: str, many: bool) -> None:
    """Solve a robot of this kind once, over a short time, so that its kernel is compiled, or loaded from the cache."""
    import numpy as np

    from stickslip.solvers import solve

    changes = {"body_mass": subject.values["body_mass"] * np.array([1.0, 1.01])} if many and isinstance(subject, State) else {}
    with contextlib.suppress(StickslipError):  # a run that fails also has its kernel compiled
        model = subject.robot(law, **changes)
        of_its_own = 2.0 * float(machine_of(model).time_scale or 1.0)
        length: dict[str, Any] = {"periods": 2} if model.period is not None else {"duration": of_its_own}
        solve(model, **length, rtol=1e-4, keep="summary" if many else "trajectory")


class Kernels:
    """The kernels that are ready, and a thread that prepares the others.

    The newest request comes first. When idle, the kernels of the presets are compiled in advance.

    Parameters
    ----------
    separate : bool
        Whether to compile in a separate process; otherwise in this one, where other runs have to wait.
    """

    def __init__(self, separate: bool = True):
        self._separate = separate
        self._ready: set[Key] = set()
        self._wanted: dict[Key, tuple[Subject, str]] = {}
        self._later: dict[Key, tuple[Subject, str]] = {}
        self._states: list[State] = []  # that may follow: their kernels have no keys yet
        self._compiled: set[Key] = set()
        self._doing: Key | None = None
        self._asked = time.monotonic()
        self._changed = threading.Condition()
        self._listeners: list[Callable[[], None]] = []
        self._processes: dict[bool, Helper] = {}
        self._ended = False
        self._thread = threading.Thread(target=self._work, name="kernels", daemon=True)
        self._thread.start()

    def ready(self, subject: Subject, law: str, robot: Model, many: bool) -> bool:
        """Whether this kind of robot can be solved immediately; if not, preparation of its kernel is requested."""
        key = key_of(robot, many)
        with self._changed:
            self._asked = time.monotonic()
            if key in self._ready:
                return True
            self._wanted.pop(key, None)
            self._wanted[key] = (subject, law)
            if self._doing != key:
                self._drop(later=True)
            self._changed.notify_all()
        return False

    def listen(self, tell: Callable[[], None]) -> None:
        """Register a function that is called, from another thread, whenever a kernel has become ready."""
        self._listeners.append(tell)

    def begin(self, later: Iterable[State] = ()) -> None:
        """Prepare the kernels of the initial page and, when idle, those of the states that may follow."""
        with self._changed:
            if self._separate:
                self._states += later
        for law in reversed(DEFAULT.laws):
            for many in (True, False):
                self.ready(DEFAULT, law, DEFAULT.robot(law), many)

    def end(self) -> None:
        """Stop preparing."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
            self._drop(later=True)
            self._drop(later=False)

    def _drop(self, later: bool) -> None:
        """End one of the separate processes."""
        if (process := self._processes.pop(later, None)) is not None:
            killed(process)

    def _work(self) -> None:
        while (chosen := self._next()) is not None:
            key, (subject, law), later = chosen
            separate = self._separate and isinstance(subject, State)
            if separate and key not in self._compiled and not self._compile(subject, law, key[0], later):  # type: ignore[arg-type]
                continue  # interrupted by a request
            if later:  # in the cache on disk; loading it here would delay the curves
                with self._changed:
                    self._compiled.add(key)
                    self._later.pop(key, None)
                continue
            if self._ended:
                return
            with contextlib.suppress(Exception):  # the next solve of such a robot reports the error
                warm(subject, law, key[0])
            with self._changed:
                self._ready.add(key)
                self._wanted.pop(key, None)
            for tell in self._listeners:
                tell()

    def _next(self) -> tuple[Key, tuple[Subject, str], bool] | None:
        """The next kernel to prepare, and whether it is only in advance of a request; None at the end."""
        with self._changed:
            while True:
                if self._ended:
                    return None
                if self._wanted:  # single runs first, and among these the newest
                    key = min(reversed(self._wanted), key=lambda key: key[0])
                    return key, self._wanted[key], False
                if (self._later or self._states) and (left := self._asked + QUIET - time.monotonic()) > 0:
                    self._changed.wait(left)
                    continue
                self._plan()
                if self._later:
                    key = self._doing = next(iter(self._later))
                    return key, self._later[key], True
                self._drop(later=True)  # nothing is left to do
                self._changed.wait()

    def _plan(self) -> None:
        """Note the kernels of the states that may follow, single runs first; those that are ready are done."""
        wishes = [(many, s, law) for many in (False, True) for s in self._states for law in s.laws]
        self._later |= {key_of(s.robot(law), many): (s, law) for many, s, law in wishes}
        self._states.clear()
        for key in self._ready & self._later.keys():
            del self._later[key]

    def _compile(self, subject: State, law: str, many: bool, later: bool) -> bool:
        """Compile in a separate process, and wait for it; if none is available, it is compiled here. False if interrupted."""
        try:
            with self._changed:
                if self._ended or (later and self._wanted):
                    return False
                process = self._processes.get(later)
                if process is None or process.poll() is not None:
                    process = self._processes[later] = _helper(later)
            assert process.stdin is not None and process.stdout is not None
            process.stdin.write(json.dumps({"state": state_table(subject, law), "many": many}) + "\n")
            process.stdin.flush()
            if process.stdout.readline():
                return True
        except (OSError, ValueError):  # it was ended, or no second process is available
            pass
        return not later


def killed(process: subprocess.Popen[Any]) -> None:
    """End a separate process, and close its pipes."""
    process.kill()
    process.wait()
    for pipe in (process.stdin, process.stdout):
        assert pipe is not None
        with contextlib.suppress(OSError):
            pipe.close()


def state_table(of_page: State, law: str) -> dict[str, Any]:
    """A state with one law as the table that `state` reads."""
    return {**vars(of_page), "law": law, "also": [], "values": dict(of_page.values)}


def _helper(later: bool) -> Helper:
    """A process that compiles; one for `later` has the lowest priority."""
    command = [sys.executable, "-m", "stickslip.show.explorer.kernels", *(["later"] if later else [])]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, encoding="utf-8")


def main() -> None:
    """Run the compiling process: it reads states from its input, one per line, and answers each when its kernel is ready."""
    if hasattr(os, "nice"):
        os.nice(10 if "later" in sys.argv else 5)  # the page's first picture comes before it
    for line in sys.stdin:
        wish = json.loads(line)
        of_page = state(wish["state"])
        with contextlib.suppress(Exception):  # the next solve of such a robot reports the error
            warm(of_page, of_page.law, wish["many"])
        print("ready", flush=True)


if __name__ == "__main__":
    main()
