"""Mean velocities that are rounding, and are written as zero."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.models.machine_adapter import machine_of

#: Relative to the size of a machine's velocities: a mean velocity below this is rounding.
ROUNDING = 1e-9


def without_rounding(velocity: float, model: Model) -> float:
    """A mean velocity [m/s, or rad/s], or zero where it is rounding beside the velocities of the machine.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)
    >>> without_rounding(1.06e-17, robot), without_rounding(1.06e-3, robot)
    (0.0, 0.00106)
    """
    scale = machine_of(model).velocity_scale
    return 0.0 if scale is not None and abs(velocity) < ROUNDING * float(np.max(scale)) else float(velocity)
