"""A step along the tangent of a curve, corrected by Newton's method across it: branches and curves of special points go by it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.dynamics.periodic.newton import Residuals, Root

P = TypeVar("P")
SHORTEST = 1e-6  # the last step that is tried
TOO_SHORT, OUTSIDE = "no step was small enough", "it left the admissible region"


def tangent_of(J: Array, towards: Array) -> Array:
    """The direction in which the residual does not change, on the side of `towards`."""
    direction = np.linalg.svd(J)[2][-1]
    return direction * (1.0 if direction @ towards >= 0 else -1.0)


def in_plane(residuals: Residuals, guess: Array, across: Array) -> Residuals:
    """Residuals, and how far points are from the plane through a guess across a direction."""
    return lambda U: np.column_stack([residuals(U), (U - guess) @ across])


def step_along(
    here: Any, step: float, corrected: Callable[[Array, float], Root], accepted: Callable[[Root, float], P | str],
    failed: Callable[[Root], str], refused: Callable[[InputError, Array], str],
) -> tuple[Root, P, float] | str:  # fmt: skip
    """The next point of a curve, by steps that are halved; or why there is none.

    Parameters
    ----------
    here : Point or CurvePoint
        Where the curve is, `u`, and its direction, `tangent`.
    step : float
        The first step that is tried.
    corrected : callable
        The point near a guess, across the tangent, given the step too.
    accepted : callable
        The point of the curve, or a sentence that says why the step is too long.
    failed, refused : callable
        What is said where Newton's method finds no point near by, and where the parameters beyond are refused.
    """
    why = ""
    while step >= SHORTEST:
        try:
            root = corrected(here.u + step * here.tangent, step)
        except InputError as error:
            why = refused(error, here.u + 2 * step * here.tangent)
        else:
            near = root.good and np.linalg.norm(root.at - here.u) <= 2 * step
            point = accepted(root, step) if near else failed(root)
            if not isinstance(point, str):
                return root, point, step
            why = point
        step *= 0.5
    return why
