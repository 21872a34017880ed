"""Fit of mean velocities alone: velocities against settings as one problem, each evaluation a batch of settled runs."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.batch import stacked
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, SolveError
from stickslip.inverse.identification.parameters import OverParameters, Parameters
from stickslip.inverse.identification.targets import Target, of_body
from stickslip.solvers import solve

_PERIODS = 400  # in which a motion should settle; most do in far fewer
_STEP = 2e-5  # of the distance between the bounds: differences for derivatives


@dataclass(eq=False)
class MeansProblem(OverParameters):
    """Fit of mean velocities, the cases of all points side by side.

    Parameters
    ----------
    parameters : Parameters
    targets : tuple of Target
        All of kind "mean".
    rtol : float
        Relative tolerance of the solver.
    """

    parameters: Parameters
    targets: tuple[Target, ...]
    rtol: float = 1e-8
    solves: int = 0

    def rough(self) -> MeansProblem:
        """The same fit for the search: a looser tolerance."""
        return dataclasses.replace(self, rtol=max(self.rtol, 1e-6))

    def batch(self, points: Any, readings: Any = None) -> Any:
        """Mean velocities for many points (cases, numbers): array (records, cases); NaN where a point makes no model."""
        made = [self.parameters.models(point) for point in np.asarray(points, float)]
        good = np.array([models is not None for models in made], bool)
        means = np.full((len(self.targets), len(made)), np.nan)
        if good.any():
            means[:, good] = self._of_all([models for models in made if models is not None])
        return means

    def _of_all(self, made: list[list[Any]]) -> Any:
        """Mean velocities of the models of all records at some points, as one batch where they are of one kind: array (records, cases)."""
        try:
            whole = stacked("identify", [model for models in made for model in models])
        except InputError:
            return np.stack([self._velocities(stacked("identify", list(each)), len(made)) for each in zip(*made, strict=True)])
        return self._velocities(whole, len(made) * len(self.targets)).reshape(len(made), -1).T

    def _velocities(self, batch: Any, cases: int) -> Any:
        """Mean velocities of a batch; of a machine of several bodies those of the one that was measured."""
        self.solves += cases
        try:
            run = solve(batch, periods=_PERIODS, settle="auto", rtol=self.rtol, keep="summary")
        except (InputError, SolveError):
            return np.full(cases, np.nan)
        return np.broadcast_to(of_body(run, "mean_velocity", self.targets[0].body), (cases,))

    def ends(self, points: Any, readings: Any = None) -> tuple[Any, Any]:
        """The least and the greatest values for many points, which are the same."""
        means = self.batch(points)
        return means, means

    def slopes(self, point: Any, readings: Any = None) -> tuple[Any, Any]:
        """Derivatives of the least and the greatest values, which are the same: central differences, at bounds one-sided ones."""
        point = np.asarray(point, float)
        low, high = (self._step_away(point, side * _STEP) for side in (-1.0, 1.0))
        moved = np.array([np.where(np.arange(len(point)) == k, ends, point) for ends in (low, high) for k in range(len(point))])
        down, up = np.split(self.batch(moved), 2, axis=1)
        derivatives = np.nan_to_num((up - down) / (high - low))
        return derivatives, derivatives

    def _step_away(self, point: Array, step: float) -> Any:
        """Each number a step away, or where it was if it cannot be there."""
        moved = np.clip(point + step, 0.0, 1.0)
        allowed = [self.parameters.limits.allows(each) for each in np.where(np.eye(len(point), dtype=bool), moved, point)]
        return np.where(allowed, moved, point)
