"""Which kernels are ready. One that is not is compiled once, in a process beside the server, so that the page never stands still."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

from stickslip.errors import StickslipError
from stickslip.explorer.asked import DEFAULT, State, state
from stickslip.fields import leaves

__all__ = ["Kernels", "main", "warm"]

Key = tuple[Any, ...]


def key_of(robot: Any, many: bool) -> Key:
    """What a robot's kernel depends on: its classes, the names of its numbers, and the fields that are no numbers."""
    numbers = {name for name, _ in leaves(robot)}
    return (many, *((name, None if name in numbers else str(value)) for name, value in leaves(robot, kinds=True)))


def warm(found: State, law: str, many: bool) -> None:
    """Solve a robot of this kind once, shortly: its kernel is compiled, or loaded from the cache."""
    import numpy as np

    from stickslip.solvers import solve

    changes = {"body_mass": found.values["body_mass"] * np.array([1.0, 1.01])} if many else {}
    with contextlib.suppress(StickslipError):  # a run that fails has its kernel too
        solve(found.robot(law, **changes), periods=2, rtol=1e-4, keep="summary" if many else "trajectory")


class Kernels:
    """The kernels that are ready, and a thread that prepares the others, the newest wish first.

    Parameters
    ----------
    beside : bool
        Compile in a process beside this one; else in this one, where other runs have to wait.
    """

    def __init__(self, beside: bool = True):
        self._beside = beside
        self._ready: set[Key] = set()
        self._wanted: dict[Key, tuple[State, str]] = {}
        self._changed = threading.Condition()
        self._listeners: list[Callable[[], None]] = []
        self._process: subprocess.Popen[str] | None = None
        self._ended = False
        self._thread = threading.Thread(target=self._work, name="kernels", daemon=True)
        self._thread.start()

    def ready(self, found: State, law: str, robot: Any, many: bool) -> bool:
        """Whether this kind of robot can be solved at once; if not, its kernel is being prepared from now on."""
        key = key_of(robot, many)
        with self._changed:
            if key in self._ready:
                return True
            self._wanted.pop(key, None)
            self._wanted[key] = (found, law)
            self._changed.notify_all()
        return False

    def listen(self, tell: Callable[[], None]) -> None:
        """Call this, from another thread, whenever a kernel has become ready."""
        self._listeners.append(tell)

    def begin(self) -> None:
        """Prepare what the page shows at first."""
        for law in reversed(DEFAULT.laws):
            for many in (True, False):
                self.ready(DEFAULT, law, DEFAULT.robot(law), many)

    def end(self) -> None:
        """Stop preparing."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        if self._process is not None:
            self._process.terminate()
            self._process.wait()

    def _work(self) -> None:
        while True:
            with self._changed:
                while not (self._wanted or self._ended):
                    self._changed.wait()
                if self._ended:
                    return
                key = min(reversed(self._wanted), key=lambda key: key[0])  # single runs first, of these the newest
                found, law = self._wanted[key]
            if self._beside:
                self._compile(found, law, key[0])
            if self._ended:
                return
            with contextlib.suppress(Exception):  # whoever solves such a robot next is told why
                warm(found, law, key[0])
            with self._changed:
                self._ready.add(key)
                self._wanted.pop(key, None)
            for tell in self._listeners:
                tell()

    def _compile(self, found: State, law: str, many: bool) -> None:
        """Let the process beside this one compile, and wait for it; where there is none, the kernel is compiled here."""
        table = {"drive": found.drive, "track": found.track, "contact": found.contact, "law": law, "also": [], "values": dict(found.values)}
        try:
            with self._changed:
                if self._ended:
                    return
                if self._process is None or self._process.poll() is not None:
                    self._process = _helper()
            talk = self._process
            assert talk.stdin is not None and talk.stdout is not None
            talk.stdin.write(json.dumps({"state": table, "many": many}) + "\n")
            talk.stdin.flush()
            talk.stdout.readline()
        except OSError:
            self._process = None


def _helper() -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "stickslip.explorer.kernels"]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, encoding="utf-8")


def main() -> None:
    """The process that compiles: reads states from its input, one a line, and answers each when its kernel is ready."""
    for line in sys.stdin:
        wish = json.loads(line)
        found = state(wish["state"])
        with contextlib.suppress(Exception):  # whoever solves such a robot next is told why
            warm(found, found.law, wish["many"])
        print("ready", flush=True)


if __name__ == "__main__":
    main()
