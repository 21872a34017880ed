"""The result of an atlas: motions over the grid, regions, borders, special points, branches, and the parts that were not reached."""

from __future__ import annotations

from collections import Counter
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.errors import InputError, no_attribute
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.dynamics.atlas.borders_followed import Border, FollowedBranch, PointOfBorder, same_place
from stickslip.dynamics.atlas.levels import RefinementLevel
from stickslip.dynamics.atlas.motions_on_the_grid import MotionThere, PointOfGrid
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane
from stickslip.dynamics.atlas.uncertain_places import UncertainPlaces, unseen_share
from stickslip.dynamics.attractors.attractor_continuation import OF_ATTRACTORS
from stickslip.dynamics.attractors.basins import wilson
from stickslip.dynamics.attractors.bifurcation_diagrams import state_attrs
from stickslip.dynamics.attractors.kinds_of_motion import UNDONE
from stickslip.dynamics.continuation.special_points.accuracy import certain
from stickslip.models.model_adapter import adapter_of

if TYPE_CHECKING:
    import xarray as xr

_ROWS = 24  # of a table in a notebook


@sealed
class Atlas(Drawn):
    """The motions of a machine over a plane of two numbers, and the borders between them; `plot` draws it.

    Parameters
    ----------
    plane : Plane
        The two numbers and the machines.
    points : dict of PointOfGrid
        What was found at each point of the grid, by its place.
    borders : tuple of Border
        Curves that separate motions, with their accuracy.
    special_points : tuple of PointOfBorder
        Special points, each with its accuracy: those of the branches that were followed, and where borders meet.
    branches : tuple of FollowedBranch
        Branches of periodic motions that were followed across the plane.
    notes : tuple of str
        What was not reached, and why.
    closer : tuple of Level
        The finer levels of the grid, in cells where places were in doubt.

    Examples
    --------
    >>> import stickslip as ss
    >>> atlas = ss.atlas(ss.presets.piezo_rig, over={"amplitude": [5e-4, 6e-4], "mu0": [0.17, 0.19]}, tilt_deg=1.7, law="coulomb")
    >>> atlas.regions, atlas.at(amplitude=5.9e-4, mu0=0.18)
    ({'I': 0.5, 'III': 0.5}, ('III',))
    """

    plane: Plane
    points: dict[Cell, PointOfGrid]
    borders: tuple[Border, ...]
    special_points: tuple[PointOfBorder, ...]
    branches: tuple[FollowedBranch, ...]
    notes: tuple[str, ...]
    closer: tuple[RefinementLevel, ...] = ()

    _drawn_by, _inches = "atlas", (4.4, 3.4)

    if not TYPE_CHECKING:  # a type checker would take every name for one of ours

        def __getattr__(self, name: str) -> Any:
            return no_attribute(self, name, {"found": "special_points"})

    @property
    def parameters(self) -> tuple[str, str]:
        """Names of the two numbers."""
        return self.plane.names

    @cached_property
    def regions(self) -> dict[str, float]:
        """Each region by the motions that coexist in it, and its share of the points of the grid; the largest first."""
        counts = Counter(point.label for point in self.points.values() if point.label)
        total = sum(counts.values())
        return {label: n / total for label, n in sorted(counts.items(), key=lambda item: (-item[1], item[0]))}

    @cached_property
    def map(self) -> xr.Dataset:
        """The grid as an `xarray.Dataset`.

        Over the two numbers: region, count (of motions; -1: not computed), unsettled (starts that have not settled within the limit),
        unsolved (starts that run away or could not be solved), doubt (why the motions
        are not sure, in words; empty where nothing speaks against them), unseen (the share of the starts that a motion may attract and
        yet be missed by all of these starts, with 95 % confidence). Over them and
        attractor: motion, period (0: none, -1: not there), mean_velocity [m/s], share of the starts with its 95 % interval
        share_low to share_high, and the strobe state.
        """
        import xarray as xr

        p, q = self.parameters
        axes = {n: (n, axis, self.plane.family.describe(n)) for n, axis in zip(self.parameters, self.plane.axes, strict=True)}
        columns: dict[str, Any] = {name: ((p, q), table, attributes) for name, (table, attributes) in self._by_point().items()}
        columns |= {name: ((p, q, "attractor"), table, attributes) for name, (table, attributes) in self._by_motion().items()}
        most = max((len(point.motions) for point in self.points.values()), default=0)
        return xr.Dataset(columns, {**axes, "attractor": np.arange(most)}, {"starts": self.plane.count, "notes": list(self.notes)})

    def _by_point(self) -> dict[str, tuple[Any, dict[str, str]]]:
        count, lost, moving = (np.full(self.plane.shape, UNDONE) for _ in range(3))
        region, doubt = np.full(self.plane.shape, "", object), np.full(self.plane.shape, "", object)
        unseen = np.full(self.plane.shape, np.nan)
        for cell, point in self.points.items():
            count[cell], lost[cell], region[cell] = len(point.motions), point.lost - point.unsettled, point.label
            moving[cell] = point.unsettled
            doubt[cell] = self._uncertain.of_points.get(self.plane.point(cell), "")
            unseen[cell] = unseen_share(self.plane.count + point.more)
        return {
            "region": (region.astype(str), {"long_name": "motions that coexist"}),
            "count": (count, {"units": "1", "long_name": "number of motions (-1: not computed)"}),
            "unsettled": (moving, {"units": "1", "long_name": "starts that have not settled (-1: not computed)"}),
            "unsolved": (lost, {"units": "1", "long_name": "starts that run away or could not be solved (-1: not computed)"}),
            "doubt": (doubt.astype(str), {"long_name": "reason why the motions are not sure"}),
            "unseen": (unseen, {"units": "1", "long_name": "largest share of a motion that no start reached, 95 %"}),
        }

    def _by_motion(self) -> dict[str, tuple[Any, dict[str, str]]]:
        shape = (*self.plane.shape, max((len(point.motions) for point in self.points.values()), default=0))
        motion, period = np.full(shape, "", object), np.full(shape, UNDONE)
        names = self.plane.at.names
        numbers = np.full((*shape, 4 + len(names)), np.nan)
        for cell, point in self.points.items():
            starts = self.plane.count + point.more
            for k, each in enumerate(point.motions):
                motion[(*cell, k)], period[(*cell, k)] = each.word, each.period
                V = each.mean_velocity if adapter_of(self.plane.sample).has_displacement else np.nan
                numbers[(*cell, k)] = [V, each.hits / starts, *wilson(each.hits, starts), *each.state]
        columns = OF_ATTRACTORS | {name: state_attrs(name, "on the strobe", self.plane.sample) for name in names}
        return {
            "motion": (motion.astype(str), {"long_name": "motion"}),
            "period": (period, {"units": "1", "long_name": "motion period (0: none, -1: absent)"}),
            **{name: (numbers[..., i], attributes) for i, (name, attributes) in enumerate(columns.items())},
        }

    @cached_property
    def special(self) -> xr.Dataset:
        """The special points as an `xarray.Dataset` over ``point``: the two numbers, their accuracy, kind, change, stable."""
        import xarray as xr

        columns: dict[str, Any] = {}
        for i, name in enumerate(self.parameters):
            columns[name] = ("point", [s.values[i] for s in self.special_points], self.plane.family.describe(name))
            columns[f"{name}_accuracy"] = ("point", [s.accuracy[i] for s in self.special_points])
        for name in ("kind", "change", "stable"):
            columns[name] = ("point", [getattr(s, name) for s in self.special_points])
        return xr.Dataset(columns)

    @explains_arguments
    def at(self, **values: float) -> tuple[str, ...]:
        """The attracting motions at a point of the plane: those of the nearest corner of its cell that no border separates from it.

        Parameters
        ----------
        **values
            The two numbers.

        Returns
        -------
        tuple of str

        Raises
        ------
        InputError
            For a point outside the grid, or one where nothing was computed.
        """
        here = self._parameter_point(values)
        level, free = self._uncertain.free(here)
        return level.points[free[0]].words if free else self._farther(here).words

    def _farther(self, here: tuple[float, float]) -> PointOfGrid:
        """The nearest point of the grid that no border separates from a place; where all around are, the nearest of all."""
        known = [cell for cell, point in self.points.items() if point.motions]
        if not known:
            raise InputError("Atlas.at", ["nothing was computed; make the atlas again"])
        near = sorted(known, key=lambda cell: self._uncertain.distance(self.plane.point(cell), here))
        free = (cell for cell in near[:_AROUND] if not self._uncertain.separated(self.plane.point(cell), here))
        return self.points[next(free, near[0])]

    @cached_property
    def _uncertain(self) -> UncertainPlaces:
        return UncertainPlaces((RefinementLevel(self.plane, self.points), *self.closer), self.borders, self.special_points)

    @explains_arguments
    def doubt(self, **values: float) -> str:
        """Why the motions that `at` gives at a point of the plane are not sure; empty where nothing speaks against them.

        A place is judged by the corners of its cell that no border separates from it: they must have the same motions, and none of them
        a doubt of its own (``map.doubt``). A motion that attracts few starts can be missing everywhere: ``map.unseen`` says how few.

        Parameters
        ----------
        **values
            The two numbers.

        Returns
        -------
        str

        Raises
        ------
        InputError
            For a point outside the grid.
        """
        return self._uncertain.at(self._parameter_point(values))

    def _parameter_point(self, values: dict[str, float]) -> tuple[float, float]:
        if set(values) != set(self.parameters):
            typed = ", ".join(f"{name}={self.plane.axes[i][0]:g}" for i, name in enumerate(self.parameters))
            raise InputError("Atlas.at", [f"{', '.join(values) or 'nothing'} was given; allowed are both numbers; type {typed}"])
        p, q = (float(values[name]) for name in self.parameters)
        for name, value, axis in zip(self.parameters, (p, q), self.plane.axes, strict=True):
            if not axis[0] <= value <= axis[-1]:
                raise InputError("Atlas.at", [f"{name} = {value!r}; allowed is a number from {axis[0]:g} to {axis[-1]:g}"])
        return p, q

    def coexisting(self) -> dict[Cell, tuple[MotionThere, ...]]:
        """The points of the grid at which several motions attract, with these motions."""
        return {cell: point.motions for cell, point in self.points.items() if len(point.motions) > 1}

    # ---- how it shows itself ----
    def _title(self) -> str:
        return f"Atlas over {' and '.join(self.parameters)}"

    def _facts(self) -> dict[str, Any]:
        counts = {"borders": len(self.borders), "branches": len(self.branches), "special points": len(self.special_points)}
        points = f"{len(self.points)} of {self.plane.cells}, {self.plane.count} starts at each"
        return {"points of the grid": points, "several motions at": f"{len(self.coexisting())} points"} | {
            n: str(k) for n, k in counts.items()
        }

    def _tables(self) -> list[list[tuple[str, ...]]]:
        regions: list[tuple[str, ...]] = [("region", "share"), *((label, f"{100 * share:.1f} %") for label, share in self.regions.items())]
        points = [("special point", *self.parameters, "accuracy", "what changes"), *self.rows()[:_ROWS]]
        return [regions, points] if self.special_points else [regions]

    def rows(self) -> list[tuple[str, ...]]:
        """The special points as text, with their certain digits."""
        known = [tuple(map(certain, s.values, s.accuracy)) for s in self.special_points]
        return [(s.kind, *at, f"{max(s.accuracy):.1g}", s.change) for s, at in zip(self.special_points, known, strict=True)]

    def __repr__(self) -> str:
        shares = ", ".join(f"{label} {100 * share:.0f} %" for label, share in list(self.regions.items())[:6])
        notes = "".join(f"\n  {note}" for note in self.notes)
        return (
            f"<Atlas over {' and '.join(self.parameters)}, {self.plane.shape[0]} × {self.plane.shape[1]} points: {shares}; "
            f"{len(self.borders)} borders, {len(self.special_points)} special points{notes}>"
        )


_AROUND = 12  # points of the grid around a place that are asked


def without_twins(plane: Plane, points: list[PointOfBorder]) -> tuple[PointOfBorder, ...]:
    """Special points, each once: of those at one place the most accurate."""
    kept: list[PointOfBorder] = []
    for point in sorted(points, key=lambda p: max(p.accuracy)):
        if not any(point.kind == other.kind and same_place(plane, point.values, other.values) for other in kept):
            kept.append(point)
    return tuple(sorted(kept, key=lambda p: (p.values[1], p.values[0])))
