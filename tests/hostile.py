"""What an attacker types: damaged texts, strange values, and a call that is given a time and a memory."""

from __future__ import annotations

import contextlib
import math
import re
import resource
import signal
import sys
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

import stickslip as ss
from stickslip.basics.errors import StickslipError

__all__ = ["Outcome", "damaged", "guarded", "limits", "strange", "warm"]

#: Time that one call may take [s]; a call that takes longer is counted and no failure: a long run may be asked for.
PATIENCE = 2.0
#: Address space that may be taken beside what is in use [bytes].
ROOM = 6_000_000_000


class TooLong(BaseException):
    """The call took longer than it may; no `except Exception` catches it."""


@contextlib.contextmanager
def guarded(seconds=PATIENCE):
    """Warnings are errors within, and a time limit ends it."""

    def stop(*_):
        raise TooLong

    def unraisable(info):  # where the limit strikes in a finalizer
        if not issubclass(info.exc_type, TooLong):
            told(info)

    told, sys.unraisablehook = sys.unraisablehook, unraisable
    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds, 0.5)  # again, where a finalizer swallowed the first
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
        sys.unraisablehook = told


def warm():
    """Load what calls load when they are first made: an import that is broken off leaves half a module."""
    import h5netcdf  # noqa: F401
    import matplotlib.pyplot
    import scipy.stats  # noqa: F401
    import xarray  # noqa: F401

    for law in ("coulomb", "lugre"):
        run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law=law), periods=3)
    ss.plot.velocity(run)
    matplotlib.pyplot.close("all")


@contextlib.contextmanager
def limits():
    """No more memory than `ROOM` beside what is in use."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (pages + ROOM, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


class Outcome(Counter):
    """How calls ended, and what was wrong with those that did not end in one of our sentences."""

    def __init__(self):
        super().__init__()
        self.wrong = {}

    def of(self, call, name, given, seconds=PATIENCE):
        """Make a call and count how it ends."""
        try:
            with guarded(seconds):
                call()
            self["done"] += 1
        except StickslipError:
            self["in words"] += 1
        except TooLong:
            self["too long"] += 1
        except TypeError as error:
            if re.search(r"takes \d+ positional|missing \d+ required|unexpected keyword|multiple values for|takes from \d", str(error)):
                self["no such argument"] += 1
            else:
                self._note(name, error, given)
        except Exception as error:
            self._note(name, error, given)

    def _note(self, name, error, given):
        trace = error.__traceback__
        while trace.tb_next is not None:
            trace = trace.tb_next
        if trace.tb_frame.f_code.co_name == "<lambda>":  # in a function of the caller's
            self["caller's own"] += 1
            return
        self["wrong"] += 1
        where = f"{trace.tb_frame.f_code.co_filename.rpartition('/')[2]}:{trace.tb_lineno}"
        self.wrong.setdefault((name, type(error).__name__, where), f"{str(error)[:120]} given {given}"[:400])

    @property
    def tried(self):
        """Calls in all."""
        return self.total()

    def told(self):
        """What was wrong, a line for each place."""
        return "\n".join(f"{name}: {kind} at {where}: {text}" for (name, kind, where), text in self.wrong.items())


# ---- values ----
def numbers(rng):
    return rng.choice([0, -1, 1, 3, 0.5, -0.5, 1e-3, 1e-300, 1e300, -1e300, 10**400, math.nan, math.inf, -math.inf, 5e-324, 1e9, 2**63])


def arrays(rng):
    shape = rng.choice([(0,), (1,), (2,), (3,), (2, 3), (1, 1, 1), (5, 0)])
    array = np.full(shape, float(rng.choice([0.0, 1e-3, -1.0, math.nan, math.inf, 1e300])))
    kind = rng.randrange(9)
    if kind == 0:
        return array.astype(object)
    if kind == 1:
        return array.astype(str)
    if kind == 2:
        return array.astype(complex)
    if kind == 3:
        return array.astype(bool) if np.isfinite(array).all() else array
    if kind == 4:
        return np.ma.masked_array(array, mask=True)
    if kind == 5:
        import xarray as xr

        return xr.DataArray(array, dims=[f"d{i}" for i in range(array.ndim)])
    if kind == 6:
        return array.tolist()
    return array


THINGS = [
    None, True, False, "", "a", "auto", "v", "1e-3", "é" * 300, "../../etc/passwd", "a\0b", "nan", b"bytes", 1j, complex(math.nan, 0), [],
    (),
    {}, [None], ["a", "b"], [1, "a"], [[1], [2, 3]], {"v": 1}, {"v": "a"}, {1: 2}, {"": None}, {"x": [1, 2]}, set(), {1, 2}, range(3),
    range(0),
    object(), int, print, lambda: 1, lambda *a, **k: None, Ellipsis, NotImplemented, slice(1), np.float64("nan"), np.int64(3),
    np.bool_(True),
    np.array(3.0), np.array(None), np.datetime64("2020-01-01"), np.str_("a"), [[[[[]]]]], (1,) * 50, "x" * 5000, iter([1, 2]),
]  # fmt: skip


def strange(rng):
    """Any value: a number, an array, or a thing of another kind."""
    return rng.choice([numbers, arrays, lambda r: r.choice(THINGS), lambda r: r.choice(THINGS)])(rng)


# ---- texts ----
def damaged(text, rng, words=()):
    """The text with some damage: characters lost, doubled, changed, lines swapped, words and values replaced."""
    for _ in range(rng.choice([1, 1, 2, 3, 8])):
        at, end = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        end = min(end, at + rng.choice([1, 1, 2, 5, 40]))
        lines = text.split("\n")
        k = rng.randrange(len(lines))
        match rng.randrange(9):
            case 0:
                text = text[:at] + text[end:]
            case 1:
                text = text[:end] + text[at:end] * rng.choice([1, 2, 50]) + text[end:]
            case 2:
                text = text[:at] + rng.choice("[]{}=\"'#.,-_0e\n\t\\ \0é\ud83d ") + text[end:]
            case 3:
                text = "\n".join(lines[:k] + lines[k + 1 :])
            case 4:
                text = "\n".join([*lines[:k], lines[rng.randrange(len(lines))], *lines[k:]])
            case 5:
                name, mark, _ = lines[k].partition("=")
                if mark:
                    lines[k] = f"{name}= {rng.choice(VALUES)}"
                text = "\n".join(lines)
            case 6 if words:
                name, mark, rest = lines[k].partition("=")
                if mark:
                    lines[k] = f"{rng.choice(words)} ={rest}"
                text = "\n".join(lines)
            case 7:
                text = text[: max(at, 1)]
            case _:
                lines.insert(k, rng.choice(LINES))
                text = "\n".join(lines)
    return text


VALUES = [
    "1", "-1", "0", "nan", "inf", "-inf", "1e400", "1e-400", "9" * 400, "9" * 5000, "true", "false", '"a"', '""', "[]", "[[]]", "[1, 2]",
    "[1, 'a']",
    "{}", "{a = 1}", "{kind = 'harmonic'}", "1979-05-27", "07:32:00", "'\\'", '"""a\nb"""', "[nan]", "[1e300, 1]", "0x10", "1_000",
    "[" * 500,
    '"file.py:f"', '"os:system"', '"piezo_rig"', '"harmonic"', '"lugre"', '"\\u0000"', '"~nobody/x"', "[0.1, 0.2, 0.3]", "2",
]  # fmt: skip
LINES = [
    "[robot]", "[[robot]]", "[robot.drive]", "[robot.drive.drive]", "[robot.friction]", "[robot.track]", "[mechanism]", "[solve]",
    "[arguments]",
    "[identify]", "[identify.free]", "make = 'piezo_rig'", "make = 3", "kind = 'sum'", "kind = 'lugre'", "periods = 3", "start = {x = 1}",
    "[a.b.c]",
    "start.v = 'a'", "robot = 3", "solve = 3", "arguments = [1]", "identify = 1", "rtol = []", "settle = {}", "method = ['exact']",
    "mechanism = []",
]  # fmt: skip
