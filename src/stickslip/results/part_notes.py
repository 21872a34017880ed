"""Remarks on what became of the bodies and contacts of a machine: bodies that move apart, and friction that is shared in many ways."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.status import Status
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


APART = 1e-3  # of the free velocity: bodies whose mean velocities differ by more may drift apart
_LOOKS = (0.137, 0.618, 0.911)  # instants of a period at which contacts are asked whether they move alike
_ALIKE = 1e-12  # of the largest of their accelerations
_MOVED_APART = (
    "bodies moved apart over the window of the mean: they drift apart, or have not settled; mean_velocity is that of the centre of mass, "
    "and body_velocity has each"
)


def shared_at_rest(run: Trajectory) -> str:
    """A sentence on contacts that rest at once and whose friction forces do not follow from the equations; or ""."""
    machine = machine_of(run.model)
    if not len(run.pieces.mode):
        return ""
    exact = np.array([not law.dynamic for law in machine.laws], bool)
    rows = machine.mechanics.rows(0.0, machine.mechanics.start)
    if _independent([row for row, rests in zip(rows, exact, strict=True) if rests]):
        return ""
    rests = (run.pieces.mode == 0) & exact
    for pattern in np.unique(rests, axis=0):
        several = _undetermined(np.array(rows, float), np.flatnonzero(pattern))
        if several:
            return _text([machine.mechanics.contacts[i] for i in several])
    return ""


def notes_of_cases(model: Model, columns: Mapping[str, Any]) -> dict[str, int]:
    """Sentences on cases of a batch, each with how many it is about."""
    if "status" not in columns:
        return {}
    good = np.ravel(np.asarray(columns["status"]) <= Status.REPEATS)
    counts = {_MOVED_APART: int(np.sum(good & _moved_apart(model, columns)))}
    for group in _groups(model) if "stick_fraction" in columns else []:
        names = [machine_of(model).mechanics.contacts[i] for i in group]
        counts[_text(names)] = int(np.sum(good & _rested_at_once(model, group, np.asarray(columns["stick_fraction"]))))
    return {sentence: count for sentence, count in counts.items() if count}


def _text(names: list[str]) -> str:
    return (
        f"{', '.join(names)} rest at once on one body: only the sum of their friction forces follows from the equations, and the forces "
        "that are given share it in proportion to what each can bear"
    )


def _groups(model: Model) -> list[tuple[int, ...]]:
    """Contacts under laws that rest exactly which act on the same coordinates."""
    machine = machine_of(model)
    rows = [tuple(map(abs, row)) for row in machine.mechanics.directions]
    resting = [i for i, law in enumerate(machine.laws) if not law.dynamic]
    groups = {tuple(k for k in resting if rows[k] == rows[i]) for i in resting}
    return sorted(group for group in groups if len(group) > 1)


def _independent(rows: Sequence[Sequence[float]]) -> bool:
    """Whether each contact brakes a coordinate that no other one brakes, so that all their slips are independent."""
    braked = Counter(c for row in rows for c, g in enumerate(row) if g)
    return all(any(g and braked[c] == 1 for c, g in enumerate(row)) for row in rows)


def _undetermined(rows: Any, held: Any) -> list[int]:
    """Of contacts at rest those whose slips follow from those of the others."""
    rank = np.linalg.matrix_rank
    if len(held) < 2 or rank(rows[held]) == len(held):
        return []
    return [int(i) for i in held if rank(rows[[k for k in held if k != i]]) == rank(rows[held])]


def _moved_apart(model: Model, columns: Mapping[str, Any]) -> Any:
    if "body_velocity" not in columns or model.period is None or machine_of(model).mechanics.joined:
        return False
    velocities = np.asarray(columns["body_velocity"])
    free = np.broadcast_to(np.asarray(machine_of(model).free_velocity, float), velocities.shape[:-1])
    return np.ravel(np.ptp(velocities, axis=-1) > APART * free)


def _rested_at_once(model: Model, group: tuple[int, ...], fraction: Any) -> Any:
    """Which cases had several of a group at rest at once: those that move alike, or rest for more than all the time together."""
    own = fraction[..., list(group)].reshape(-1, len(group))
    return np.any(own > 0, axis=1) & _move_alike(model, group) | (own.sum(axis=1) > 1.0)


def _move_alike(model: Model, group: tuple[int, ...]) -> Any:
    """Whether the slips of some contacts differ by a constant, in each case."""
    period = 1.0 if model.period is None else model.period
    rates = [[np.ravel(machine_of(model).mechanics.offset_rates(look * period)[i]) for i in group] for look in _LOOKS]
    alike: Any = True
    for first, *others in rates:
        alike = alike & np.logical_and.reduce([abs(first - other) <= _ALIKE * (abs(first) + abs(other)) for other in others])
    return alike
