"""Designs other than a grid: zipped columns, random designs and tables.

A design is a set of named columns along one dimension. `sweep` takes any number of them before its axes, and crosses them with the
axes: ``sweep(make, sobol(1024, amplitude=(1e-4, 8e-4), omega=(60, 300)), tilt_deg=[1.7, 2.7])``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, as_path
from stickslip.basics.fields import masked_in
from stickslip.basics.lazy_names import listing

if TYPE_CHECKING:
    from pathlib import Path


__all__ = ["SweepDesign", "latin_hypercube", "sobol", "table", "zipped"]
__dir__ = listing(__all__)


@dataclass(frozen=True, eq=False)
class SweepDesign:
    """Columns of values along one dimension.

    Parameters
    ----------
    dim : str
        Name of the dimension.
    columns : dict of arrays
        Values of each argument, one for each point.
    attributes : dict
        How it was made: kind, seed and bounds. They go into the dataset and the manifest.
    labels : array, optional
        Coordinate of the dimension; by default the points are numbered from 0.
    """

    dim: str
    columns: dict[str, Any]
    attributes: dict[str, Any] = field(default_factory=dict)
    labels: Any = None

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))


@explains_arguments
def zipped(dim: str = "case", /, **columns: Any) -> SweepDesign:
    """Columns combined value by value: point i has the i-th value of each.

    Parameters
    ----------
    dim : str
        Name of the dimension.
    **columns : sequences of one length
        Arguments of the maker.

    Returns
    -------
    SweepDesign
        One point for each row of values.

    Examples
    --------
    >>> import stickslip as ss
    >>> pairs = ss.designs.zipped(amplitude=[5.56e-4, 6.04e-4], tilt_deg=[1.7, 2.7])
    >>> grid = ss.sweep(ss.presets.piezo_rig, pairs, law="coulomb-static")
    >>> grid.mean_velocity.dims, grid.mean_velocity.values.round(6).tolist()
    (('case',), [0.002032, 0.003792])
    """
    import numpy as np

    arrays, problems = {}, Problems("design")
    for name, values in columns.items():
        try:
            arrays[name] = np.asarray(values)
        except ValueError:
            problems.add(f"{name} = {values!r} is not a flat list; type for example {name}=[1.0, 2.0]")
        if masked_in(values):
            problems.add(f"{name} has {masked_in(values)} masked values; leave them out, type {name}=array.compressed()")
    problems.check()
    if not arrays:
        problems.add("no columns are given; type for example zipped(amplitude=[4e-4, 5e-4], tilt_deg=[1.7, 2.7])")
    lengths = {name: a.shape for name, a in arrays.items()}
    if len(set(lengths.values())) > 1 or any(a.ndim != 1 or not a.size for a in arrays.values()):
        shapes = ", ".join(f"{name} {shape}" for name, shape in lengths.items())
        problems.add(f"the columns have the shapes {shapes}; allowed are flat ones of the same length, from one value on")
    problems.check()
    columns = {name: a.astype(float) if a.dtype.kind in "iuf" else a for name, a in arrays.items()}
    return SweepDesign(dim, columns, {"design": "zipped"})


@explains_arguments
def table(rows: Any, dim: str = "case") -> SweepDesign:
    r"""Arbitrary rows: a dict of columns, a pandas DataFrame, or the path of a CSV file whose first line names the columns.

    Parameters
    ----------
    rows : dict, DataFrame or path
        The columns; in a CSV file, a column that holds only numbers is numeric, any other is text.
    dim : str
        Name of the dimension.

    Returns
    -------
    SweepDesign
        A point for each row.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("rows.csv").write_text("amplitude,law\n4e-4,coulomb\n5e-4,lugre\n")
    >>> {name: column.tolist() for name, column in table("rows.csv").columns.items()}
    {'amplitude': [0.0004, 0.0005], 'law': ['coulomb', 'lugre']}
    """
    if isinstance(rows, str) or hasattr(rows, "__fspath__"):
        rows = _read(rows)
    elif hasattr(rows, "to_dict") and hasattr(rows, "columns"):
        rows = {str(name): rows[name].to_numpy() for name in rows.columns}
    if not isinstance(rows, Mapping):
        raise InputError("table", [f"rows = {rows!r}; allowed is a dict of columns, a DataFrame or the path of a CSV file"])
    made = zipped(dim, **{str(name): values for name, values in rows.items()})
    return SweepDesign(dim, made.columns, {"design": "table"})


def _read(path: str | Path) -> dict[str, list[Any]]:
    import csv

    try:
        with open(as_path(path, "table", "cases.csv"), newline="", encoding="utf-8") as file:
            lines = [line for line in csv.reader(file) if line]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(
            "table", [f"{str(path)!r} cannot be read: {why}; give the path of a CSV file with a line of names first"]
        ) from None
    if len(lines) < 2 or any(len(line) != len(lines[0]) for line in lines):
        raise InputError("table", [f"{str(path)!r} is not a table: allowed is a line of names, then lines with as many values"])
    return {name.strip(): _numbers([line[i] for line in lines[1:]]) for i, name in enumerate(lines[0])}


def _numbers(texts: list[str]) -> list[Any]:
    try:
        return [float(text) for text in texts]
    except ValueError:
        return [text.strip() for text in texts]


@explains_arguments
def sobol(count: int, seed: int = 0, dim: str = "case", **bounds: tuple[float, float]) -> SweepDesign:
    """A scrambled Sobol sequence: points that fill a box evenly; further points fill the gaps (Sobol 1967, Owen 1998).

    Parameters
    ----------
    count : int
        Number of points, best a power of 2.
    seed : int
        Seed of the scrambling, stored with the results. The same seed gives the same points.
    dim : str
        Name of the dimension.
    **bounds : (low, high)
        Range of each argument; (low, high, "log") spreads its logarithm.

    Returns
    -------
    SweepDesign
        `count` points, with seed and ranges among its attributes.

    Examples
    --------
    >>> points = sobol(4, seed=1, amplitude=(0.0, 1.0))
    >>> sorted(int(4 * a) for a in points.columns["amplitude"])
    [0, 1, 2, 3]
    """
    return _random("sobol", lambda n, d: sobol_cube(n, d, seed), count, seed, dim, bounds)


def sobol_cube(count: int, dimensions: int, seed: int) -> Array:
    """The first points of a scrambled Sobol sequence in the unit cube: array (count, dimensions); also the starts of searches and samples.

    Examples
    --------
    >>> sorted((4 * sobol_cube(4, 1, seed=1)[:, 0]).astype(int).tolist())  # one in each quarter
    [0, 1, 2, 3]
    """
    from scipy.stats import qmc

    points: Array = qmc.Sobol(dimensions, rng=seed).random_base2(max(math.ceil(math.log2(count)), 0))  # the sampler wants a power of 2
    return points[:count]


@explains_arguments
def latin_hypercube(count: int, seed: int = 0, dim: str = "case", **bounds: tuple[float, float]) -> SweepDesign:
    """A Latin hypercube: each argument has exactly one point in each of `count` equal strips (McKay, Beckman and Conover 1979).

    Parameters
    ----------
    count, seed, dim, **bounds
        As for `sobol`.

    Returns
    -------
    SweepDesign
        As from `sobol`.

    Examples
    --------
    >>> points = latin_hypercube(5, seed=1, amplitude=(0.0, 5.0), mu0=(1.0, 100.0, "log"))
    >>> sorted(int(a) for a in points.columns["amplitude"]), points.attributes["seed"]
    ([0, 1, 2, 3, 4], 1)
    """
    from scipy.stats import qmc

    return _random("latin_hypercube", lambda n, d: qmc.LatinHypercube(d, rng=seed).random(n), count, seed, dim, bounds)


def _random(kind: str, unit: Any, count: Any, seed: Any, dim: str, bounds: dict[str, Any]) -> SweepDesign:
    problems = Problems(kind)
    problems.whole("count", count, 1, example=1024, most=100_000_000)
    problems.whole("seed", seed, 0, example=1)
    if not bounds:
        problems.add("no ranges are given; type for example amplitude=(1e-4, 8e-4)")
    ranges = {name: _bounds(name, value, problems) for name, value in bounds.items()}
    problems.check()
    points = unit(count, len(ranges))
    columns = {name: scale(points[:, i]) for i, (name, scale) in enumerate(ranges.items())}
    ranges_given = {name: list(value) for name, value in bounds.items()}
    return SweepDesign(dim, columns, {"design": kind, "seed": seed, "bounds": ranges_given})


def _bounds(name: str, value: Any, problems: Problems) -> Any:
    """The map from the unit interval to the range of one argument."""
    try:
        low, high, *how = value
        low, high = float(low), float(high)
    except (TypeError, ValueError):
        low, high, how = math.nan, math.nan, []
    log = how == ["log"]
    if not (low < high < math.inf) or low == -math.inf or (how and not log) or (log and low <= 0):
        allowed = '(low, high) with low < high, or (low, high, "log") with 0 < low'
        problems.add(f"{name} = {value!r}; allowed is {allowed}; type for example {name}=(1e-4, 8e-4)")
        return None
    if log:
        return lambda u: low * (high / low) ** u
    return lambda u: low + (high - low) * u
