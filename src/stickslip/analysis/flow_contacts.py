"""What the contacts of a flow do in a run: the work that friction takes, and the stretches of sticking and sliding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.run_segments import pieces_within
from stickslip.basics.arguments import described_as
from stickslip.basics.contracts import Array
from stickslip.basics.errors import NoBodies
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.maths import bisected
from stickslip.basics.notebook_display import Drawn
from stickslip.models.flow_contacts import contact_columns

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

_NODES = 10  # of Gauss and Legendre on each step, as for the steps of machines
_LOOKS, _HALVINGS = 9, 52  # samples of a slip on each step, between which its zeros are bisected


@described_as("what ss.energy returns of a run of a flow with contacts; type ss.energy(ss.solve(flow, duration=10.0))")
@sealed
@dataclass(frozen=True, eq=False)
class FrictionWork(Drawn):
    r"""What friction takes at the contacts of a flow in each period, :math:`\int R\,w\,dt`, in the flow's own unit of force times length.

    A flow has no masses and no springs that it declares, so there is no kinetic and potential energy to balance these works with.
    A run without a period is one row; so is what a run has left over behind its last whole period.

    Parameters
    ----------
    friction : array (periods,)
        Work that friction takes at all contacts.
    friction_of : dict of array (periods,)
        The same at each contact, by its name.
    settle : int
        How many periods belong to settling.
    """

    friction: Array
    friction_of: dict[str, Array]
    settle: int

    _drawn_by = "energy"
    unit = ""

    @property
    def works(self) -> dict[str, Array]:
        """What a figure stacks for each period, negative where energy is taken."""
        return {f"friction of {name}" if len(self.friction_of) > 1 else "friction": -work for name, work in self.friction_of.items()}

    stored = None

    def _facts(self) -> dict[str, Any]:
        shown = {"friction": self.friction} | ({n: -work for n, work in self.works.items()} if len(self.friction_of) > 1 else {})
        return {f"work of {name}, a period": f"{float(np.mean(work[self.settle :])):.6g}" for name, work in shown.items()}

    def __repr__(self) -> str:
        return f"<FrictionWork of {len(self.friction)} periods; last: {self.friction[-1]:.4g}>"


def friction_work(run: Trajectory) -> FrictionWork:
    """What friction takes at each contact of a flow: `NoBodies` of a flow without contacts, which has no forces.

    The forces are those of the law on the dense output; of a contact at rest, whose slip is zero, nothing is taken.
    """
    if not run.model.contacts:
        why = "a flow without contacts has no forces and no masses, and so no energy"
        raise NoBodies("energy", [f"{why}; type ss.SwitchingFlow(..., contacts=...) where friction acts, or ss.motion(run) for its motion"])
    ends = run.pieces.t[[0, -1]]
    borders = ends
    if run.model.period is not None:
        whole = run.strobe_times
        borders = whole if ends[1] - whole[-1] <= 1e-9 * run.period_time else np.append(whole, ends[1])
    edges = np.unique(np.concatenate([run.pieces.t, borders]))
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    t, index = (middle[:, None] + half[:, None] * nodes).ravel(), np.repeat(run._index(middle), _NODES)
    owner = np.minimum(np.searchsorted(borders, middle, side="right") - 1, len(borders) - 2)
    taken = {}
    for name, column in contact_columns(run.model, t, run.pieces.states(t, index), run.pieces.mode[index]).items():
        slides = column.mode != 0  # a contact at rest has a slip of rounding
        power = np.where(slides, column.friction_force * column.slip, 0.0).reshape(-1, _NODES)
        taken[name] = np.bincount(owner, (power @ weights) * half, len(borders) - 1)
    return FrictionWork(sum(taken.values(), np.zeros(len(borders) - 1)), taken, min(int(run.settle), len(borders) - 1))


def flow_contact_modes(run: Trajectory, start: float, end: float) -> dict[str, tuple[Array, Array]]:
    """Ends and signs of each contact's stretches over a span: +1 forwards, 0 at rest, -1 backwards.

    Under a law with inner states, which never rests, the sign is that of the slip velocity, located to the last bit.
    """
    edges, index = pieces_within(run.pieces, start, end)
    resting = {name: k for k, name in enumerate(n for n, c in run.model.contacts.items() if not c.law(*run.model.given_once).dynamic)}
    sides = np.array([label[1] for label in run.model.labels.values()]).reshape(len(run.model.labels), -1)
    return {
        name: (edges, sides[run.pieces.mode[index], resting[name]]) if name in resting else _sides_of_slip(run, name, edges, index)
        for name in run.model.contacts
    }


def _sides_of_slip(run: Trajectory, name: str, edges: Array, index: Array) -> tuple[Array, Array]:
    """Ends and signs of the stretches of one contact by its slip velocity."""

    def forwards(t: Array, piece: Array) -> Array:
        return np.asarray(contact_columns(run.model, t, run.pieces.states(t, piece), run.pieces.mode[piece])[name].slip > 0.0)

    t = edges[:-1, None] + np.diff(edges)[:, None] * np.linspace(0.0, 1.0, _LOOKS)
    ahead = forwards(t.ravel(), np.repeat(index, _LOOKS)).reshape(t.shape)
    row, col = np.nonzero(ahead[:, 1:] != ahead[:, :-1])
    low, high = t[row, col], t[row, col + 1]
    if len(row):
        low, high = bisected(lambda at: forwards(at, index[row]) == ahead[row, col], low, high, _HALVINGS)
    begins = np.concatenate([edges[:-1], high])
    order = np.argsort(begins, kind="stable")
    signs = np.where(np.concatenate([ahead[:, 0], ahead[row, col + 1]]), 1, -1)[order]
    return np.append(begins[order], edges[-1]), signs
