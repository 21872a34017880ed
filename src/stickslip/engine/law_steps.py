"""A dynamic law over a prescribed motion, compiled: exponential steps of its inner states, and its force after each."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves
from stickslip.engine import cache
from stickslip.engine.kernel_text import KernelSource, function, kernel_text
from stickslip.engine.kinds import kind_of
from stickslip.engine.lanes import plain_name
from stickslip.engine.law_as_written import traced_as_written
from stickslip.engine.remembered import Remembered
from stickslip.engine.symbols import Sym, TraceError
from stickslip.engine.traced_law import TracedLaw
from stickslip.engine.write import Writer
from stickslip.models.friction.law_adapter import LawAdapter

_known = Remembered["LawSteps | None"](most=100)


def law_steps(law: LawAdapter) -> LawSteps | None:
    """The compiled steps of a law, whose numbers may be arrays with one for each case; None of one that is solved in plain Python alone.

    Inner states whose rates depend on one another are not stepped here.
    """
    return _known(kind_of(law.law), lambda: _compiled(law))


def _compiled(law: LawAdapter) -> LawSteps | None:
    if not (law.dynamic and law.compiles) or law.random:
        return None
    try:
        traced = traced_as_written(law.law)
        return LawSteps(traced) if traced.alone else None
    except (InputError, TraceError, TypeError, ValueError):  # it does with its arguments what only numbers can do
        return None


class LawSteps:
    """Compiled steps of a law over a prescribed motion.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.models.friction.law_adapter import adapted
    >>> law = adapted(ss.Dahl(0.3, 0.3, sigma0=1e5))
    >>> t, z = np.linspace(0.0, 1.0, 101), np.zeros((1, 1))
    >>> slow, load, none = np.full(101, 1e-6), np.ones((101, 1)), np.zeros((101, 1))
    >>> F = law_steps(law)(law, np.diff(t, prepend=0.0), slow, slow, load, none, z)
    >>> bool(abs(F[-1, 0] - 0.3 * (1 - np.exp(-1e5 * 1e-6 / 0.3))) < 1e-15)
    True
    """

    def __init__(self, law: TracedLaw):
        self.names = law.names
        label = law.law.name
        sizes = {"STATES": len(law.z), "MODES": len(law.mode), "SWITCHES": len(law.switches)}
        text = "\n".join([*(f"{name} = {size}" for name, size in sizes.items()), *_functions(law), kernel_text("stepping_laws")])
        kind = "void(f2, f1, f1, f2, f1, f2, f2, f2, f2)"
        source = KernelSource(text, {"follow": kind})
        self._follow = cache.load(source, f"law_{plain_name(label)}", f"{label} (over a prescribed motion)")["follow"]

    def __call__(self, law: LawAdapter, steps: Any, v: Any, at: Any, load: Any, applied: Any, z: Any, mode: Any = None) -> Any:
        """Friction forces after steps of given lengths [s] and mean velocities [m/s], at velocities `at`: array (steps, cases) [N].

        Loads and forces applied are arrays (steps, cases), or with one column for all. The inner states z, array (states, cases), are
        brought to the end; the memories begin as `mode` has them, array (modes, cases), or at zero.
        """
        known, cases = dict(leaves(law.law)), z.shape[1]
        rows = np.array([np.broadcast_to(known[name], cases) for name in self.names], float).reshape(len(self.names), cases)
        out = np.empty((len(v), cases))
        mode = np.zeros((law.modes, cases)) if mode is None else mode
        given = [np.require(each, float, "CW") for each in (rows.T, v, at, load, steps, applied, mode)]
        self._follow(*given, z, out)
        return out


def _functions(law: TracedLaw) -> list[str]:
    """Functions of the law for the loop: rates with their slopes, guards, the states after them, and the force."""
    at = "row, z, mode, v, load"
    outcomes = [end for _, modes, z in law.switches for end in (*modes, *z)]
    rates = {"f": law.rates, "J": [row[i] for i, row in enumerate(law.slopes)]}
    return [
        _function(law, "rates_of", f"{at}, f, J", rates),
        _function(law, "guards_of", f"{at}, out", {"out": [guard for guard, _, _ in law.switches]}),
        _function(law, "outcomes_of", f"{at}, out", {"out": outcomes}),
        _function(law, "force_of", f"{at}, applied, out", {"out": [law.response]}),
    ]


def _function(law: TracedLaw, name: str, takes: str, fills: dict[str, Any]) -> str:
    """One function, which fills arrays."""
    w = Writer(prefix="p")
    bind = {number: f"row[{i}]" for i, number in enumerate(law.names)} | {word: word for word in ("v", "load", "applied")}
    bind |= {s.name: f"z[{i}]" for i, s in enumerate(law.z)} | {s.name: f"mode[{i}]" for i, s in enumerate(law.mode)}
    ends: dict[str, Sym] = {f"{array}[{i}]": root for array, roots in fills.items() for i, root in enumerate(roots)}
    lines = [f"{target} = 1.0 * {w.value(root, bind)}" for target, root in ends.items()]
    kinds = ", ".join("float64" if word in ("v", "load", "applied") else "f1" for word in takes.split(", "))
    return function(name, takes, [*w.lines, *lines], f"void({kinds})")
