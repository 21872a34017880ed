"""What all files of this folder draw with: a case is drawn from its seed, its kind and its number alone."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from drawn_models import LAW_NAMES, Draw, law_of

import stickslip as ss
from stickslip.basics.batch import rows_of
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.models.drives.shifted import Shifted
from stickslip.models.friction.law_adapter import adapted

#: Bonds that form again by chance are plain Python, which is the judge itself: there is nothing to hold it against.
LAWS = tuple(sorted(set(LAW_NAMES) - {"bristle"}))


@dataclass(frozen=True)
class Kind:
    """Cases with the same equations: a sort of machine, its law, and the number from which its other choices are drawn."""

    machine: str
    law: str
    number: int

    def __str__(self) -> str:
        return f"{self.machine} · {self.law}"


@dataclass(frozen=True)
class Cases:
    """Drawn machines of one kind: the first of them, and the numbers of all, a row for each."""

    model: Any
    names: tuple[str, ...]
    rows: Any

    def all(self) -> Any:
        """All as one batch."""
        return self._with(self.rows.T)

    def one(self, i: int) -> Any:
        """One of them."""
        return self._with(self.rows[i].tolist())

    def _with(self, values: Any) -> Any:
        return replace_leaf(self.model, dict(zip(self.names, values, strict=True)))


def drawn(make: Any, kind: Kind, count: int, seed: int, first: int = 0) -> Cases:
    """Some cases of a kind, from the first one on."""
    models = [make(kind.law, _draw(kind, case, seed)) for case in range(first, first + count)]
    names = [tuple(name for name, _ in leaves(model)) for model in models]
    assert len(set(names)) == 1, f"{kind}: a number of a case decides what its equations are"
    return Cases(models[0], names[0], np.concatenate([rows_of(model, names[0]) for model in models]))


def _draw(kind: Kind, case: int, seed: int) -> Draw:
    return Draw(np.random.default_rng([seed, kind.number, 1]), np.random.default_rng([seed, kind.number, 2, case]), 1)


def sized(d: Draw, mass: Any, velocity: Any, omega: Any, load: Any, least: float = 1.0) -> Draw:
    """Friction from a fiftieth of what moves the body to more than that can overcome; bristles that bend a part of its way."""
    mu = d.wide(0.02, 1.3) * mass * velocity * omega / load
    bend = velocity / omega * d.wide(2e-3, 3e-2)
    return dataclasses.replace(d, mass=mass, velocity=velocity, omega=omega, load=load, mu=mu, bend=bend, least=least)


def friction(name: str, d: Draw) -> Any:
    """A law of a name."""
    return law_of(name, d)


def remembers(name: str) -> bool:
    """Whether a law of this name has switches."""
    return adapted(_example(name)).switching


def has_states(name: str) -> bool:
    """Whether a law of this name has inner states."""
    return adapted(_example(name)).dynamic


def asks(name: str) -> bool:
    """Whether a law of this name asks for the force that would hold its contact: of several contacts of one body nobody knows it."""
    return adapted(_example(name)).needs_applied


def _example(name: str) -> Any:
    one = np.random.default_rng(0)
    return law_of(name, Draw(one, one, 1))


def motion(d: Draw, stroke: Any, period: Any, jumps: bool = False) -> Any:
    """A motion with about this stroke, at another phase half the time."""
    kinds = [_sine, _two_sines, _two_pieces, _pieces, *([_saw] if jumps else [])]
    found = kinds[int(d.choice.integers(len(kinds)))](d, stroke, period)
    return Shifted(found, d.uniform(-1.0, 1.0)) if d.choice.random() < 0.5 else found


def _sine(d: Draw, stroke: Any, period: Any) -> Any:
    return ss.Harmonic(amplitude=stroke / 2, omega=2 * np.pi / period)


def _two_sines(d: Draw, stroke: Any, period: Any) -> Any:
    return ss.MultiHarmonic(amplitudes=(0.4 * stroke, 0.12 * stroke), phases=(0.0 * stroke, d.uniform(-3.0, 3.0)), omega=2 * np.pi / period)


def _two_pieces(d: Draw, stroke: Any, period: Any) -> Any:
    first, size = d.uniform(0.2, 0.8), 8 * stroke / period**2
    return ss.drives.Pieces(durations=(first * period, (1 - first) * period), accelerations=(size * (1 - first), -size * first))


def _pieces(d: Draw, stroke: Any, period: Any) -> Any:
    shares, sizes = d.shares(4), [d.uniform(-1.0, 1.0) for _ in range(4)]
    mean, size = sum(s * a for s, a in zip(shares, sizes, strict=True)), 20 * stroke / period**2
    return ss.drives.Pieces(durations=tuple(s * period for s in shares), accelerations=tuple(size * (a - mean) for a in sizes))


def _saw(d: Draw, stroke: Any, period: Any) -> Any:
    rise = d.uniform(0.55, 0.95)
    return ss.drives.Sawtooth(stroke=stroke, rise=rise * period, fall=(1 - rise) * period)
