"""Orthonormal frames that matrices carry along, compiled for each number of dimensions: what exponents are made of."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.engine import cache
from stickslip.engine.kernel_text import KernelSource, kernel_text


def carried(matrices: Array, frame: Array) -> tuple[Array, Array]:
    """The frame (n, n) that some matrices (count, n, n) make of another, one after the other, and by how much its directions grow in each.

    Each frame is made orthonormal by Householder's reflections.

    Returns
    -------
    frame : array (n, n)
    sizes : array (count, n)

    Examples
    --------
    >>> turned, sizes = carried(np.array([[[2.0, 1.0], [0.0, 3.0]]] * 2), np.eye(2))
    >>> sizes.tolist()
    [[2.0, 3.0], [2.0, 3.0]]
    """
    count, n = matrices.shape[:2]
    Q, sizes = np.array(frame, float, order="C"), np.empty((count, n))
    _kernel(n)(np.ascontiguousarray(matrices), Q, sizes)
    return Q, sizes


@lru_cache(64)
def _kernel(n: int) -> Any:
    source = KernelSource(f"STATES = {n}\n{kernel_text('frames')}", {"carry_on": "void(f3, f2, f2)"})
    return cache.load(source, "frames", f"frames of {n} direction{'s' if n > 1 else ''}")["carry_on"]
