"""A plane of two numbers of a machine: its grid, the machines on it, and the starts from which each of them is run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.executors import HERE
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.attractors.basins import from_rest, grid_of, start_axes
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, state_at_rest
from stickslip.models.naming import in_its_unit

Cell = tuple[int, int]
_COUNTS = (24, 16)  # values where an axis is given by its two ends
_MORE = 4  # times the starts: further ones, where a motion was missed by the first
_WIDTHS = (2.0, 4.0)  # of the scatter of the starts, in scales, in turn


@sealed
class Plane:
    """Two numbers, their values, and how machines are made and started there.

    Parameters
    ----------
    family : Family
        Makes the machine at a point.
    axes : (array, array)
        Values of the two numbers, rising.
    starts : int or dict
        How many starts, or the grid of them as `basins` takes it.
    asked : (section, turns)
        Where motions without a period are looked at, as `basins` takes it.
    """

    family: Family
    axes: tuple[Array, Array]
    starts: int | dict[str, Any]
    asked: tuple[Any, int] = (None, 1)

    @property
    def names(self) -> tuple[str, str]:
        """The two numbers."""
        first, second = self.family.parameters
        return first, second

    @property
    def shape(self) -> tuple[int, int]:
        """How many values each has."""
        return len(self.axes[0]), len(self.axes[1])

    @property
    def cells(self) -> int:
        """How many points the grid has."""
        return self.shape[0] * self.shape[1]

    def cell(self, k: int) -> Cell:
        """The place of a point in the grid; its points are numbered row by row."""
        return k // self.shape[1], k % self.shape[1]

    def point(self, cell: Cell) -> tuple[float, float]:
        """The two numbers at a point of the grid."""
        return float(self.axes[0][cell[0]]), float(self.axes[1][cell[1]])

    @cached_property
    def at(self) -> Coordinates:
        """Coordinates of strobe states; their scales are the largest of the corners and the middle."""
        known = [coordinates(robot) for robot in self._probed or [self.sample]]
        return replace(known[0], scales=np.max([at.scales for at in known], axis=0))

    @property
    def _probed(self) -> list[Any]:
        """The machines at the middle and the corners, where there are any."""
        (m, n) = self.shape
        probes = [(m // 2, n // 2), (0, 0), (m - 1, 0), (0, n - 1), (m - 1, n - 1)]
        return [robot for cell in probes if (robot := self.family.made(*self.point(cell))) is not None]

    @cached_property
    def _section(self) -> Any:
        """The section as it is asked for everywhere in the plane: by one and the same state."""
        section, turns = self.asked
        states = self.states(state_at_rest(self.sample, self.at)[0], (0, 0))
        at = on_section(self.sample, self.at, section=section, turns=turns, states=states, what="atlas")
        return at.section.name if section is None else section

    def on(self, model: Any, states: Array, owner: Array) -> Coordinates:
        """The coordinates of a batch of its machines, with a section where they have no period, from their starts.

        `owner` says which cases stand at one point.
        """
        if model.period is not None:
            return on_section(model, self.at, section=self.asked[0], turns=self.asked[1], what="atlas")
        return on_section(model, self.at, section=self._section, turns=self.asked[1], states=states, groups=owner, what="atlas")

    @property
    def sample(self) -> Any:
        """A machine of the plane; `InputError` where none of its corners and its middle is one."""
        return next(iter(self._probed), None) or self.family.robot(*self.point((0, 0)))

    @cached_property
    def halved(self) -> Plane:
        """The same plane with a value between any two neighbouring ones; its point (2 i, 2 j) is the point (i, j) of this one."""
        first, second = (np.insert(axis, np.arange(1, len(axis)), 0.5 * (axis[:-1] + axis[1:])) for axis in self.axes)
        return Plane(self.family, (first, second), self.starts, self.asked)

    def states(self, rest: Array, cell: Cell) -> Array:
        """The starts of the machine at a point, whose state of rest is given: array (starts, coordinates).

        Scattered starts are others at each point, so that the grid as a whole begins from many; a motion that one of them reaches is
        tried at the neighbours.
        """
        if isinstance(self.starts, dict):
            return from_rest(grid_of(self._start_axes), self.at.names, rest)
        scattered = self.starts - 1
        return np.vstack([rest, self._scattered(rest, 1 + scattered * self.number(cell), scattered)])

    def more_states(self, rest: Array, cell: Cell) -> Array:
        """Further scattered starts at a point, four times as many: array (starts, coordinates)."""
        more = _MORE * self.count
        return self._scattered(rest, 1 + self.count * self.cells + more * self.number(cell), more)

    def number(self, cell: Cell) -> int:
        """The number of a point of the grid, row by row."""
        return cell[0] * self.shape[1] + cell[1]

    def _scattered(self, rest: Array, first: int, count: int) -> Array:
        """Some states of an even scatter (Halton's sequence) about rest."""
        from scipy.stats import qmc

        d = self.at.smooth
        spread = qmc.Halton(d, scramble=False).fast_forward(first).random(count)
        states = np.tile(rest, (count, 1))
        states[:, :d] += np.resize(_WIDTHS, count)[:, None] * (2 * spread - 1) * self.at.scales[:d]
        return states

    @cached_property
    def _start_axes(self) -> dict[str, Array]:
        return start_axes("atlas", self.at, self.starts if isinstance(self.starts, dict) else {}, 1, None, HERE)[0]

    @cached_property
    def count(self) -> int:
        """How many starts each point of the grid has."""
        return self.starts if isinstance(self.starts, int) else int(np.prod([len(axis) for axis in self._start_axes.values()]))


def plane_over(
    what: str, make: Model | Callable[..., Any], over: Any, starts: Any, fixed: dict[str, Any], check: Callable[[Problems], None],
    asked: tuple[Any, int] = (None, 1),
) -> Plane:  # fmt: skip
    """The plane over two numbers, checked with everything else that was given; `InputError` with all that is wrong."""
    problems = Problems(what)
    axes = _axes(make, over, problems)
    if isinstance(starts, bool) or not isinstance(starts, (int, np.integer, dict)) or (not isinstance(starts, dict) and starts < 1):
        problems.add(f"starts = {starts!r}; allowed is a whole number from 1, or a grid as ss.basins takes it; type starts=5")
    check(problems)
    problems.check()
    first, second = axes.values()
    plane = Plane(family(what, make, tuple(axes), fixed), (first, second), starts, asked)
    needs_model(what, plane.sample, flows=True, sections=True)
    if isinstance(starts, dict):
        if "phase" in starts:
            raise InputError(what, ["phase is not part of the strobe state, by which motions are distinguished; leave it out"])
        _ = plane.count
    return plane


_TYPE = 'type over={"amplitude": (2e-4, 8e-4), "tilt_deg": (0.5, 4.0)}'


def _axes(make: Model | Callable[..., Any], over: Any, problems: Problems) -> dict[str, Array]:
    if not isinstance(over, dict) or len(over) != 2 or not all(isinstance(name, str) for name in over):
        problems.add(f"over = {over!r}; allowed are two numbers of the machine by name, each with its range; {_TYPE}")
        return {}
    typed = {name: in_its_unit(name, value, make, problems, f"over[{name!r}]") for name, value in over.items()}
    return {name: _axis(name, value, count, problems) for (name, value), count in zip(typed.items(), _COUNTS, strict=True)}


def _axis(name: str, value: Any, count: int, problems: Problems) -> Array:
    """The values of one number: those of a list, or evenly between the two of a tuple."""
    given = floats(value)
    if given.ndim != 1 or len(given) < 2 or not np.isfinite(given).all() or not np.all(np.diff(given) > 0):
        allowed = "a pair (least, largest) or a list of two or more rising finite numbers"
        problems.add(f"over[{name!r}] = {value!r}; allowed is {allowed}; {_TYPE}")
        return np.zeros(2)
    return np.linspace(given[0], given[1], count) if isinstance(value, tuple) and len(given) == 2 else given
