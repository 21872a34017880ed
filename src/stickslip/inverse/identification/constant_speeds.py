"""A table of forces at constant speeds, a row each, as a motion; nobody knows when its rows were taken."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.inverse.identification.motions import PrescribedMotion
from stickslip.inverse.identification.weighting import weights_at
from stickslip.models.friction.law_adapter import LawAdapter

if TYPE_CHECKING:
    from stickslip.records.record import Record

_FEWEST = 4  # rows


def is_of_constant_speeds(rec: Record) -> bool:
    """Whether a record has a force and a velocity in rows without times."""
    each = [rec[role] for role in ("force", "velocity") if role in rec]
    return len(each) == 2 and "position" not in rec and all(c.axis_name == "sample" for c in each) and len(each[0]) == len(each[1])


def motion_at_constant_speeds(rec: Record, load: float | None, law: LawAdapter, label: str) -> PrescribedMotion:
    """The rows of a table as a motion, in the order of their speeds; rows at rest, or with a value that is missing, are left out.

    Examples
    --------
    >>> from stickslip.models.friction import Coulomb
    >>> from stickslip.models.friction.law_adapter import adapted
    >>> from stickslip.records import read
    >>> rec = read({"v [mm/s]": [2.0, -1.0, 0.0, 1.0, 3.0], "F [N]": [0.5, -0.4, 0.1, 0.4, 0.6]}, roles={"F": "force"})
    >>> motion = motion_at_constant_speeds(rec, 1.0, adapted(Coulomb(0.2)), "record 0")
    >>> motion.at.tolist(), motion.y.tolist(), motion.timeless
    ([-0.001, 0.001, 0.002, 0.003], [-0.4, 0.4, 0.5, 0.6], True)
    """
    if law.dynamic:
        why = f"a table of constant speeds has no times, and {law.name} has inner states, which need them"
        raise InputError("identify", [f"{why}; fit its steady curve, such as ss.Stribeck, or type rate=... [Hz] when reading a record"])
    v, F = rec["velocity"].si, rec["force"].si
    if load is None and "load" not in rec:
        raise InputError("identify", ['the table has no normal force; type load=... [N], or roles={"...": "load"} when reading'])
    N = np.full(len(v), float(load)) if load is not None else rec["load"].si
    good = np.isfinite(v) & np.isfinite(F) & (N > 0) & (v != 0)
    if (count := int(good.sum())) < _FEWEST:
        raise InputError("identify", [f"{label} has {count} rows with a speed other than zero and a force; allowed are {_FEWEST} or more"])
    order = np.flatnonzero(good)[np.argsort(v[good], kind="stable")]
    v, F, N, own = v[order], F[order], N[order], weights_at(rec, np.arange(len(good), dtype=float))[order]
    flipped = float(np.sum(F * v)) < 0
    t, cut = np.arange(count, dtype=float), "the speeds of its rows are taken as exact"
    if count < len(good):
        cut = f"of {len(good)} rows {len(good) - count} stand still or miss a value, and are left out; {cut}"
    return dataclasses.replace(PrescribedMotion(t, v, N, -F if flipped else F, 0, flipped, label, cut, own, at=v), timeless=True)
