"""Which traced motions have closed arcs: the acceleration is a sin(omega t) + a constant, another one in each mode; and other constants.

The equations of a kind are looked through once, and what comes out is conditions and numbers as expressions of a case. Their values for
all rows of a batch are a few products of columns (`rows_with`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.maths import pi
from stickslip.engine.kinds import kind_of
from stickslip.engine.remembered import Remembered
from stickslip.engine.sums import Terms, difference, rate_of, terms_of
from stickslip.engine.symbols import Sym
from stickslip.engine.trace import System, trace
from stickslip.engine.values import values_of

_ROUNDING = 1e-14  # relative: how near an angular frequency must come to 2 pi over the period
_SUMS = 1e-12  # relative: how near two products of the same numbers are


@dataclass(frozen=True, eq=False)
class Closed:
    """The closed arcs of a kind of model: what must vanish for them to hold, and their numbers; all are expressions of a case.

    Parameters
    ----------
    vanishing : dict
        Coefficients that must be zero, by what they stand in front of, in words.
    sines : tuple of (rate, amplitude)
        The terms sin(rate t) of the acceleration.
    numbers : dict
        resist_plus, resist_minus, hold_plus, hold_minus, along and period.
    """

    vanishing: tuple[tuple[str, Sym], ...]
    sines: tuple[tuple[Sym, Sym], ...]
    numbers: dict[str, Sym]

    @np.errstate(all="ignore")  # what is not a number is the status of its row
    def rows_with(self, known: dict[str, Array]) -> ArcNumbers:
        """Values for all rows of a batch, whose numbers are columns or single floats."""
        roots = [*(c for _, c in self.vanishing), *(s for pair in self.sines for s in pair), *self.numbers.values()]
        graph = self.numbers["period"].graph
        computed = values_of(graph, known, roots)
        numbers = {name: computed[node.number] for name, node in self.numbers.items()}
        broken = [why for why, c in self.vanishing if np.any(abs(computed[c.number]) > 0)]  # not a number breaks nothing: it is a status
        drive, omega = 0.0, 2 * pi / numbers["period"]
        for rate, amplitude in self.sines:
            a, r = computed[amplitude.number], computed[rate.number]
            fits = abs(r * numbers["period"] - 2 * pi) <= 2 * pi * _ROUNDING
            if np.any(np.logical_not(fits) & (abs(a) > 0)):
                broken.append("sines of another period")
            drive, omega = drive + np.where(fits, a, 0.0), np.where(fits, r, omega)
        if np.any(drive < 0):
            broken.append("a sine of another phase")
        return ArcNumbers(tuple(dict.fromkeys(broken)), {"drive": drive, "omega": omega, **numbers})


@dataclass(frozen=True, eq=False)
class ArcNumbers:
    """The numbers of closed arcs row by row, and what keeps some of them from being the motion, in words."""

    broken: tuple[str, ...]
    numbers: dict[str, Array]


_arcs: Remembered[Closed] = Remembered()
_forces: Remembered[tuple[list[tuple[Sym, Sym]], Sym] | None] = Remembered()


def closed_of(model: Model) -> Closed:
    """The closed arcs of the kind of a driven model with a set-valued law."""
    return _arcs(kind_of(model), lambda: _closed(trace(model)))


def _closed(eq: System) -> Closed:
    """Look through the equations: forwards, backwards and at the limits of rest they may differ by constants alone."""
    assert eq.contact is not None
    graph, contact = eq.graph, eq.contact
    forwards, backwards, push, pull = map(terms_of, (contact.forwards, contact.backwards, contact.push, -contact.pull))
    vanishing = [(_words(eq, key), c) for other in (backwards, push, pull) for key, c in difference(graph, other, forwards).items() if key]
    vanishing += [("jumps of the velocity", jumps[0]) for _, jumps in eq.impulses] + [("a contact that moves", eq.offset)]
    sines = []
    for key, c in forwards.items():
        wave = rate_of(graph, key, eq.t)
        if wave is not None and wave[0] == "sin":
            sines.append((wave[1], c))
        elif key:
            vanishing.append(("a sine of another phase" if wave else _words(eq, key), c))
    free = terms_of(eq.free)
    zero = graph.constant(0.0)

    def constant(terms: Terms, sign: float) -> Sym:
        return graph.multiply(graph.constant(sign), terms.get((), zero))

    numbers = {
        "resist_plus": constant(forwards, -1.0), "resist_minus": constant(backwards, 1.0), "hold_plus": constant(push, -1.0),
        "hold_minus": constant(pull, 1.0), "along": constant(free, 1.0), "period": eq.period,
    }  # fmt: skip
    kept = tuple((why, c) for why, c in vanishing if not (c.op == "constant" and c.value == 0))
    return Closed(kept, tuple(sines), numbers)


def _words(eq: System, key: tuple[int, ...]) -> str:
    """The dependencies of a product of nodes, in words."""
    graph = eq.graph
    names = frozenset().union(*(graph.varies(graph.nodes[number]) for number in key))
    if "v" in names:
        return "the speed"
    return "time in another way than one sine" if "t" in names else "a condition"


def steady_force(model: Model, known: dict[str, Array]) -> Array | None:
    """Forces on the body besides friction and the drive's inertia [N], row by row; None if they are not constant."""
    parts = _forces(kind_of(model), lambda: _force_pairs(trace(model)))
    if parts is None:
        return None
    pairs, whole = parts
    computed = values_of(whole.graph, known, [*(s for pair in pairs for s in pair), whole])
    for a, b in ((computed[offered.number], computed[driven.number]) for offered, driven in pairs):
        if np.any(abs(a - b) > _SUMS * (abs(a) + abs(b))):
            return None
    return computed[whole.number]


def _force_pairs(eq: System) -> tuple[list[tuple[Sym, Sym]], Sym] | None:
    """Coefficients that all forces and the drive's inertia must have alike, and the difference of their constants."""
    if eq.inertia is None:
        return None
    graph, zero = eq.graph, eq.graph.constant(0.0)
    offered, driven = terms_of(graph.multiply(eq.mass, eq.free)), terms_of(eq.inertia)
    pairs = [(offered.get(key, zero), driven.get(key, zero)) for key in {**offered, **driven} if key]
    pairs.append((eq.offset, zero))  # what moves the contact does work too
    return pairs, graph.subtract(offered.get((), zero), driven.get((), zero))
