"""Runs of several bodies and contacts made by hand: polynomials that can be integrated and differentiated on paper."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

import stickslip as ss
from stickslip.models.state_layout import BodyStates, ContactStates, StateLayout
from stickslip.results.dense_output import PolynomialPieces
from stickslip.results.trajectory import Trajectory

T = np.array([0.0, 0.5, 0.75, 1.0])
#: v.head, v.tail, l.tail, z.head.0, z.head.1, z.tail.0
STATES = ("v.head", "v.tail", "l.tail", "z.head.0", "z.head.1", "z.tail.0")
LAYOUT = StateLayout(
    (BodyStates("head", velocity=0, way=0), BodyStates("tail", velocity=1, way=0, factor=0.5, position=2)),
    (
        ContactStates("head", (1.0, 0.0), (3, 4), (0,)),
        ContactStates("tail", (0.0, 1.0), (5,)),
        ContactStates("belt", (1.0, -1.0), memory=(1,)),
    ),
    ways=(0,),
)
MODE = np.array([[1, 1, -1], [0, 0, -1], [0, 1, -1]], np.int8)


@dataclass(frozen=True)
class Pair:
    """What a trajectory asks of a machine beside its forces."""

    friction: ss.Coulomb = field(default_factory=lambda: ss.Coulomb(0.2, 0.3))
    impulses: tuple = ()
    period: float | None = 1.0
    velocity_scale: float = 1.0
    load: float = 1.0
    notes: tuple = ()

    def to_toml(self):
        return "a pair"


def coefficients(seed=0, degree=4):
    """Random polynomials (pieces, states, powers) whose states join at the nodes."""
    c = np.random.default_rng(seed).normal(size=(len(T) - 1, len(STATES), degree + 1))
    for before, after in itertools.pairwise(c):
        after[:, 0] = before.sum(axis=1)
    return c


def ways(c):
    """The way of the head at the start of each piece, integrated exactly."""
    steps = np.diff(T) * (c[:, 0] / np.arange(1, c.shape[2] + 1)).sum(axis=1)
    return np.concatenate([[3.0], 3.0 + np.cumsum(steps)[:-1]])[:, None]


def pieces(c=None, mode=MODE, memory=((1, 7), (1, 7), (2, 7)), layout=LAYOUT):
    c = coefficients() if c is None else c
    return PolynomialPieces(T, mode, ways(c), c, np.array(memory), layout)


def pair_run(made=None, model=None, **more):
    return Trajectory(model or Pair(), made or pieces(), periods=1, settle=0, rtol=1e-6, method="by hand", samples=20, **more)


def state(c, number, piece):
    """A state on a piece as a polynomial in time, made and evaluated by NumPy."""
    return np.polynomial.Polynomial(c[piece, number], domain=T[piece : piece + 2], window=[0, 1])


def glued(runs):
    """Runs of one body each that know nothing of one another, by name, as one run of several bodies: every node cuts all of them."""
    t = np.unique(np.concatenate([run.pieces.t for run in runs.values()]))
    states, ways, modes, bodies, contacts = [], [], [], [], []
    for i, (name, run) in enumerate(runs.items()):
        own, index = run.pieces, np.clip(np.searchsorted(run.pieces.t, t[:-1], side="right") - 1, 0, len(run.pieces.mode) - 1)
        begin, h = own.t[index], np.diff(own.t)[index]
        parts = zip(own.coefficients[index], (t[:-1] - begin) / h, np.diff(t) / h, strict=True)
        first, inner = sum(map(len, states)), own.coefficients.shape[1] - 1
        states.append(np.array([[_restricted(c, a, b) for c in piece] for piece, a, b in parts]).transpose(1, 0, 2))
        ways.append(own.evaluate(t[:-1], index)[0][:, 0])
        modes.append(own.mode[index, 0])
        bodies.append(BodyStates(name, first, way=i))
        direction = tuple(float(j == i) for j in range(len(runs)))
        contacts.append(ContactStates(name, direction, tuple(range(first + 1, first + 1 + inner))))
    layout = StateLayout(tuple(bodies), tuple(contacts), tuple(body.velocity for body in bodies))
    c = np.concatenate(states).transpose(1, 0, 2)
    return PolynomialPieces(t, np.array(modes).T, np.array(ways).T, c, layout=layout)


def _restricted(c, a, b):
    """The coefficients of the same polynomial in s where theta = a + b s."""
    found = np.zeros(len(c))
    for k in range(len(c) - 1, -1, -1):
        found = np.concatenate([[0.0], found[:-1]]) * b + found * a
        found[0] += c[k]
    return found


def forces(model, mode, t, x, v, z, zdot, memory):
    """Stands for the forces of several contacts: numbers with their axes, and what they were given."""
    return {
        "acceleration": 10 * v + 1, "friction_force": mode * 2.0 + 100 * np.arange(mode.shape[1]), "slip": mode * 0.5,
        "load": np.ones(mode.shape) * np.where(np.arange(mode.shape[1]) == 1, 1.0 - t[:, None], 4.0),
    }  # fmt: skip
