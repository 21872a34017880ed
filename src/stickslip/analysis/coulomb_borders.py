"""The exact borders of the Coulomb robot's motion types, on any plane: signed functions that are zero on them, and their curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip.analysis.closed_form import border_ii_i, border_ii_iii, border_iii_iv, first_slide, long_slide
from stickslip.basics.arguments import Grid, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed

if TYPE_CHECKING:
    import xarray as xr


_FINE = 601  # points of each axis of the field on which curves are traced


@sealed
@dataclass(frozen=True, eq=False)
class BorderPiece:
    """A piece of a border on a plane.

    Parameters
    ----------
    types : (str, str)
        The motion types on its two sides.
    x, y : arrays
        Its points, in the units of the axes.
    """

    types: tuple[str, str]
    x: Array
    y: Array


def border_functions(alpha_plus: Array, alpha_minus: Array) -> dict[tuple[str, str], Array]:
    """For each border a function of the alphas that is zero on it, and NaN where the border is none.

    Of a+ and a-, the smaller and the larger of the two: rest to II where a+ = 1; II to I where a- = 1;
    II to III where √(1-a+²) - √(1-a-²) = a+(2π - asin a- - asin a+); I to III where √(1-a+²) + √(1-a-²) = a+(π + asin a- - asin a+);
    III to IV where a+ = sin δ/√(δ² + (1 - δ cot δ)²), δ = πa-/(a+ + a-).

    Examples
    --------
    >>> on = border_functions(0.406899269748192, 2 * 0.406899269748192)
    >>> abs(float(on["I", "III"])) < 1e-12
    True
    """
    plus, minus = np.broadcast_arrays(np.asarray(alpha_plus, float), np.asarray(alpha_minus, float))
    small, large = np.minimum(plus, minus), np.maximum(plus, minus)
    inside = large <= 1.0
    cut = np.minimum(small, 1.0), np.minimum(large, 1.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        fourth = small - border_iii_iv(large / small)
    return {
        ("rest", "II"): small - 1.0,
        ("II", "I"): np.where(small >= border_ii_iii(1.0), large - border_ii_i(), np.nan),
        ("II", "III"): np.where(inside, long_slide(*cut), np.nan),
        ("I", "III"): np.where(inside, first_slide(*cut), np.nan),
        ("III", "IV"): fourth,
    }


@explains_arguments
def coulomb_borders(grid: Grid, x: str | None = None, y: str | None = None) -> list[BorderPiece]:
    """The exact borders of the motion types of the robot with Coulomb friction, over the plane of a map.

    The columns alpha_plus and alpha_minus of the dataset give the effect of the two axes; between its points they are interpolated
    (their logarithms by cubic splines), so the curves are much finer than the map. Under a dynamic law the borders are those of the same
    robot with Coulomb friction at the kinetic coefficients, which the borders of the law approach as its bristles become stiffer.

    Parameters
    ----------
    grid : Dataset
        From `sweep` or `map`, over two axes of numbers.
    x, y : str, optional
        The axes; by default the dimensions in their order.

    Returns
    -------
    list of BorderPiece

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> grid = ss.map(ss.presets.piezo_rig, amplitude=np.linspace(2e-4, 8e-4, 30), tilt_deg=np.linspace(0.5, 4, 30), law="coulomb")
    >>> curve = next(b for b in ss.dynamics.coulomb_borders(grid) if b.types == ("III", "IV"))
    >>> round(float(np.interp(1.7, curve.y, curve.x)), 6)  # the amplitude at which resting ends, TRUTH P9
    0.000647
    """
    first, second = plane_of(grid, x, y)
    lacking = [name for name in ("alpha_plus", "alpha_minus") if name not in grid]
    if lacking:
        raise InputError(
            "coulomb_borders", [f"the dataset has no {' and '.join(lacking)}: its robots have no Coulomb twin with a harmonic drive"]
        )
    import contourpy

    fine_x, fine_y, plus = _field(grid, "alpha_plus", first, second)
    minus = _field(grid, "alpha_minus", first, second)[2]
    borders = []
    for types, values in border_functions(plus, minus).items():
        lines = contourpy.contour_generator(fine_x, fine_y, np.ma.masked_invalid(values)).lines(0.0)
        borders += [BorderPiece(types, *np.asarray(line).T) for line in lines if len(line) > 1]
    return borders


def plane_of(grid: xr.Dataset, x: str | None = None, y: str | None = None) -> tuple[str, str]:
    """Names of the two axes of a map; `InputError` if it has not two of numbers."""
    of_cases = next((name for name in ("mean_velocity", "status") if name in grid), None)
    if of_cases is None:
        has = ", ".join(str(name) for name in grid.data_vars)
        raise InputError("map", [f"the dataset has no mean_velocity and no status; type grid[name].plot() for one of {has}"])
    dims = [str(d) for d in grid[of_cases].dims]
    first = x or next((d for d in dims if d != y), "")
    second = y or next((d for d in dims if d != first), "")
    if sorted(dims) != sorted((first, second)) or any(grid[d].dtype.kind not in "iuf" for d in dims):
        listed = ", ".join(dims) or "none"
        raise InputError(
            "map", [f"the dataset has the axes {listed}; allowed are two of numbers; choose with grid.sel(...) or grid.isel(...)"]
        )
    return first, second


def _field(grid: xr.Dataset, name: str, x: str, y: str) -> tuple[Array, Array, Array]:
    """A positive column on a fine grid: array over (y, x)."""
    from scipy.interpolate import RectBivariateSpline

    known = grid[name].broadcast_like(grid["mean_velocity"]).transpose(x, y)
    a, b = np.asarray(grid[x].values, float), np.asarray(grid[y].values, float)
    order_a, order_b = np.argsort(a), np.argsort(b)
    a, b = a[order_a], b[order_b]
    with np.errstate(invalid="ignore", divide="ignore"):
        values = np.log(np.asarray(known.values, float)[np.ix_(order_a, order_b)])
    fine_a, fine_b = (np.unique(np.concatenate([axis, np.linspace(axis[0], axis[-1], _FINE)])) for axis in (a, b))
    if len(a) < 2 or len(b) < 2 or not np.isfinite(values).all():
        return a, b, np.exp(values).T
    spline = RectBivariateSpline(a, b, values, kx=min(3, len(a) - 1), ky=min(3, len(b) - 1))
    return fine_a, fine_b, np.exp(spline(fine_a, fine_b)).T
