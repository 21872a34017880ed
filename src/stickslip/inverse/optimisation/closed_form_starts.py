"""Where a search may begin: drives that are known in closed form to be good."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import StickslipError
from stickslip.basics.fields import leaves
from stickslip.inverse.optimisation.unknowns import Unknowns
from stickslip.inverse.optimisation.waveforms import unknowns_of_pieces
from stickslip.models.drives import Pieces
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of

_SLIDES = 1e-3  # at which friction is asked for [m/s]


def closed_starts(space: Unknowns) -> Array:
    """Unknowns near closed optima, for a robot of one body: array (starts, unknowns).

    The machine as it is, with its own drive's numbers at the corners of their bounds (the fastest motions of two and three phases are
    there), and the verge gait for a waveform of three pieces or more.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.inverse.optimisation.unknowns import Varied
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> closed_starts(Unknowns(robot, [Varied("drive.amplitude", ("drive.amplitude",), 2e-4, 8e-4)], None)).round(6).tolist()
    [[0.5], [1.0]]
    """
    own = dict(leaves(space.model))
    rows = []
    for at_end in (False, True):
        row = np.full(space.count, 0.5)
        for each, part in zip(space.varied, space.slices, strict=True):
            if each.form is None:
                is_drive = ".drive." in f".{each.leaves[0]}"
                value = each.high if at_end and is_drive else float(own[each.leaves[0]])
                value = _push(space.model) if at_end and each.leaves[0] == "drive.w1" else value
                row[part] = each.unknown(value)
            elif each.form.kind == "pieces" and (verge := _verge(space, each.form.count)) is not None:
                row[part] = verge
        rows.append(row)
    return np.unique(np.array(rows), axis=0)


def _coefficients(model: Any) -> tuple[float, float]:
    """Sliding friction forwards and backwards over the load."""
    load, law = model.load(0.0, 0.0), law_of(model)
    ahead, back = (abs(float(law.sliding(v, load))) / load for v in (_SLIDES, -_SLIDES))
    return ahead, back


def _push(model: Any) -> float:
    """The relative acceleration at which the body rests on the verge of slipping back [m/s^2]."""
    try:
        return _coefficients(model)[1] * model.gravity / model.mass_ratio
    except (StickslipError, AttributeError, TypeError):
        return np.inf


def _verge(space: Unknowns, count: int) -> Array | None:
    """The unknowns of the verge gait; None where friction is not known, or the limits leave it none."""
    scales = space.scales
    if count < 3 or scales is None or not np.isfinite(scales.stroke) or machine_of(space.model).drive is None:
        return None
    try:
        ahead, back = _coefficients(space.model)
        model = space.model
        drive = Pieces.verge(scales.acceleration, scales.stroke, model.mass_ratio, ahead, back, model.gravity)
        return unknowns_of_pieces(drive, count, scales)
    except (StickslipError, AttributeError, TypeError):
        return None
