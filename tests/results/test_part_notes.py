"""Remarks on a machine's bodies and contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import stickslip as ss
from stickslip.maths import cos, pi


@dataclass(frozen=True, eq=False)
class Gears(ss.Machine):
    """Two gears with play, which rub on nothing."""

    inertia: float
    period = property(lambda self: 2 * pi / 3)

    def bodies(self):
        return {
            "driving": ss.Body(self.inertia, force=lambda t, x, v: 1 + 2 * cos(3 * t)),
            "driven": ss.Body(self.inertia, force=lambda t, x, v: -1 - 0.1 * v),
        }

    def contacts(self):
        return {}

    def links(self):
        return {("driving", "driven"): ss.Spring(stiffness=100, damping=0.1, clearance=0.02)}


def test_a_run_and_a_batch_of_a_machine_without_contacts_have_notes():
    run = ss.solve(Gears(1.0), periods=5)
    batch = ss.solve(Gears(np.array([1.0, 2.0])), periods=5)
    for notes in (run.notes, batch.notes):
        assert notes and all(isinstance(note, str) for note in notes)
        assert not any("contact" in note or "friction" in note for note in notes)
