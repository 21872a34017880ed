"""Checks of a law before it is traced: its methods accept the engine's arguments and return numbers."""

from __future__ import annotations

import contextlib
import dataclasses
import inspect
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.basics.contracts import Law, Model
from stickslip.basics.errors import InputError, Problems, StickslipError
from stickslip.engine.symbols import TraceError
from stickslip.models.friction.law_adapter import LawAdapter, adapted
from stickslip.models.machine_adapter import machine_of


def explained(work: Any, model: Model) -> Any:
    """Do some work on a user's law; what goes wrong in it is said as what to write."""
    law_name = machine_of(model).named_in_errors
    for law in machine_of(model).laws:
        check_signatures(law.law)
    try:
        return work(model)
    except TraceError as error:
        raise InputError(law_name, [str(error)]) from error
    except AttributeError as error:
        raise InputError(
            law_name,
            [
                f"{error}; while a law is traced it has its dataclass fields and methods and nothing else: compute in the method, "
                "or make it a field"
            ],
        ) from error
    except TypeError as error:
        hint = "call functions from stickslip.maths in a law, not from math or numpy, and return a number"
        raise InputError(law_name, [f"{error}; {hint}"]) from error
    except StickslipError:
        raise
    except (LookupError, ValueError, ArithmeticError, RecursionError) as error:
        raise InputError(law_name, [f"it raised {type(error).__name__}: {error} when it was called with symbols; {_PLAIN}"]) from error


_PLAIN = (
    "allowed are + - * / ** and the functions of stickslip.maths: no dictionary or list that is looked up by an argument, no text made of "
    "one, no array that is filled in; write where(condition, yes, no), or ss.friction.Tabulated for a table of friction against velocity"
)


ARGUMENTS = {
    "rate": ("v", "z", "load"), "force": ("v", "z", "zdot", "load"), "sliding": ("v", "load"), "breakaway": ("load",),
    "switches": ("v", "z", "load"), "scale": ("load",), "start": ("load",), "velocity_scale": (),
}  # fmt: skip


def _arguments(law: Law, name: str) -> tuple[str, ...]:
    """Arguments of a law's method: with modes if the law has any, and the holding force if the method takes it."""
    known = adapted(law)
    remembers = ("mode",) if known.switching and name in ("rate", "force", "switches") else ()
    return ARGUMENTS[name] + remembers + (("applied",) if name == "force" and known.needs_applied else ())


def check_signatures(law: Law) -> None:
    """A law's methods take what the engine gives, in that order."""
    problems = Problems(type(law).__name__)
    for name in ARGUMENTS:
        method = getattr(law, name, None)
        if not callable(method):
            continue
        expected = _arguments(law, name)
        given = tuple(p.name for p in inspect.signature(method).parameters.values() if p.default is p.empty)
        if len(given) != len(expected) or (set(given) == set(expected) and given != expected):
            problems.add(
                f"{name} takes ({', '.join(given)}); allowed is ({', '.join(expected)}), in this order; type def {name}(self, "
                f"{', '.join(expected)})"
            )
    problems.check()


_LARGEST = 1e290  # exp saturates at 5e299, and nothing of this size is a force
_BOTH = (
    "where(condition, a, b) computes both a and b, so that each must be finite on both sides of the condition: "
    "exp(-abs(v) / v_s) is, exp(-v / v_s) and 1 / v are not"
)


@contextlib.contextmanager
def finite(law: Law) -> Iterator[None]:
    """Runs plain Python with a law; infinite or undefined numbers become an error in words."""
    try:
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            yield
    except ArithmeticError as error:
        raise InputError(type(law).__name__, [f"it gives a number that is not finite ({error}); {_BOTH}"]) from error


def check_numbers(model: Model) -> None:
    """Call the law with plain floats of the first case; a law that returns NaN is said here, before any compiling."""
    explained(_check_numbers, model)


def _check_numbers(model: Model) -> None:
    from stickslip.basics.batch import cases_of

    case = cases_of(model, slice(1))[0]
    machine = machine_of(case)
    mechanics, speed = machine.mechanics, max(float(machine.velocity_scale), 1e-9)
    for law, load in zip(mechanics.laws, mechanics.loads(0.0, mechanics.start), strict=True):
        _check_law(law, float(load), speed)


def _check_law(law: LawAdapter, load: float, speed: float) -> None:
    look = _values_of_dynamic if law.dynamic else _values_of_set_valued
    for v in (0.0, 1e-2 * speed, -1e-2 * speed, 1e-6 * speed):
        try:
            values = look(law, v, load)
        except (ValueError, ZeroDivisionError, OverflowError) as error:
            values = {"rate or force" if law.dynamic else "sliding or breakaway": f"no number ({error})"}
        for what, value in values.items():
            if not isinstance(value, (int, float)) or not abs(value) < _LARGEST:
                numbers = {f.name: getattr(law.law, f.name) for f in dataclasses.fields(law.law)}
                raise InputError(
                    law.name,
                    [
                        f"{what}(v={v:.6g}, {_text(law.start(load)) if law.dynamic else ''}load={load:.6g}) is {value} with {numbers}; "
                        f"allowed is a finite number; check the law's formula and fields. {_BOTH}"
                    ],
                )


def _text(z: tuple[Any, ...]) -> str:
    """The inner states of a start, as an argument."""
    return f"z={z[0] if len(z) == 1 else z}, " if any(z) else "z=0, "


def _values_of_dynamic(law: LawAdapter, v: float, load: float) -> dict[str, Any]:
    modes, z = (0,) * law.modes, law.start(load)
    rate = law.rate(v, z, load, modes)
    bad = [r for r in rate if not isinstance(r, (int, float))]
    if bad:
        return {"rate": bad[0]}
    return {"rate": max(map(abs, rate), default=0.0), "force": law.force(v, z, rate, load, modes)}


def _values_of_set_valued(law: LawAdapter, v: float, load: float) -> dict[str, Any]:
    backward, forward = law.breakaway(load)
    return {"breakaway": forward if not math.isfinite(forward) else backward} | ({"sliding": law.sliding(v, load)} if v else {})
