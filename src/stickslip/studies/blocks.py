"""Blocks of the cases of a study, in which its results are written and read without being in memory as a whole."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

ROWS = 65536  # cases per block


def slabs(shape: tuple[int, ...]) -> Iterator[tuple[slice, ...]]:
    """Blocks of approximately `ROWS` elements that cover an array of this shape, cut along its longest dimension.

    Examples
    --------
    >>> [block[1] for block in slabs((2, 70_000))]
    [slice(0, 32768, None), slice(32768, 65536, None), slice(65536, 98304, None)]
    """
    axis, step = int(np.argmax(shape)) if shape else 0, _step(shape)
    for first in range(0, max(shape, default=1), step):
        yield (*(slice(None) for _ in shape[:axis]), *(slice(first, first + step) for _ in shape[:1]))


def shape_of_slab(shape: tuple[int, ...]) -> tuple[int, ...]:
    """The shape of such a block.

    Examples
    --------
    >>> shape_of_slab((2, 70_000)), shape_of_slab((3, 4)), shape_of_slab(())
    ((2, 32768), (3, 4), ())
    """
    axis = int(np.argmax(shape)) if shape else 0
    return tuple(max(min(n, _step(shape)) if i == axis else n, 1) for i, n in enumerate(shape))


def _step(shape: tuple[int, ...]) -> int:
    """The length of a block along the longest dimension."""
    return max(ROWS * max(shape, default=1) // max(math.prod(shape), 1), 1)
