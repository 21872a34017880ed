"""A friction law whose motion is prescribed by a record: what force does it give? Many parameter sets at once."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.inverse.identification.motions import PrescribedMotion
from stickslip.inverse.identification.parameters import OverParameters, Parameters

_STEP = 1e-5


@dataclass(eq=False)
class DrivenProblem(OverParameters):
    """Fit of a law's force over prescribed motions, or of what a machine must be given for them.

    All derivatives, and all places of a multistart, are one batch.

    Parameters
    ----------
    parameters : Parameters
    targets : tuple of PrescribedMotion or MachineLog
    level : float
        Standard deviation of the force, the same for all samples [N].
    thin : int
        The multistart looks at every so many-th sample.
    holds : bool
        Whether a contact may be held and then bears what is measured.
    """

    resolution: ClassVar[float] = 1e-4  # singular values of the derivatives, which are of first order, below this are zero

    parameters: Parameters
    targets: tuple[PrescribedMotion, ...]
    level: float
    thin: int = 1
    holds: bool = False
    solves: int = 0
    remembers: bool = False
    values: Any = None  # measured values that replace those of the targets (bootstrap)

    @property
    def y(self) -> Any:
        """All measured values."""
        return np.concatenate([m.y for m in self.targets]) if self.values is None else self.values

    @property
    def sigma(self) -> Any:
        """Standard deviation of each value."""
        return np.concatenate([self.level / np.sqrt(m.weight * np.ones(m.count)) for m in self.targets])

    def with_values(self, y: ArrayLike) -> DrivenProblem:
        """The same fit for other measured values."""
        return dataclasses.replace(self, values=y)

    @property
    def has_noise(self) -> bool:
        """Whether the motion, or the load, of a record carries noise."""
        return any(t.has_noise for t in self.targets)

    def redrawn(self, k: int) -> DrivenProblem:
        """The same fit over the motions that other noise of their sensors, the k-th, would have shown."""
        return dataclasses.replace(self, targets=tuple(t.redrawn(k + 100 * i) if t.has_noise else t for i, t in enumerate(self.targets)))

    def finer(self) -> DrivenProblem:
        """The same fit with shorter steps of laws with inner states where the motion turns; itself where no step is long."""
        targets = tuple(m.finer() for m in self.targets)
        return self if targets == self.targets else dataclasses.replace(self, targets=targets)

    def rough(self) -> DrivenProblem:
        """The same fit with fewer samples, for the search."""
        if self.values is not None:
            return self
        return dataclasses.replace(self, targets=tuple(m.rough(self.thin) for m in self.targets), thin=1)

    def ends(self, places: Array, readings: Sequence[Mapping[str, Any]]) -> tuple[Any, Any]:
        """The least and the greatest force that the contact may bear, for many places (cases, parameters) and readings of the sensors.

        They differ where it is held, and after gaps of the record, in which nobody knows how it moved: it may come from behind or from the
        front. Arrays (values, cases), NaN where a place makes no law; one and the same where nothing is open.
        """
        places = np.asarray(places, float)
        good, batches = self.parameters.batches(places)
        own = [{what: np.broadcast_to(value, len(places))[good] for what, value in r.items()} for r in readings]
        self.solves += int(good.sum()) * len(self.targets)
        determined = not self.holds and not any(m.open for m in self.targets)
        forces = self._forces(good, batches, own, (0.0,) if determined else (-1.0, 1.0))
        return forces[0], forces[-1]

    def _forces(self, good: Any, batches: Any, readings: Any, sides: tuple[float, ...]) -> list[Any]:
        """Forces where what is not known of the contact makes them least (side -1) or greatest (1)."""
        forces = [np.full((len(self.y), len(good)), np.nan) for _ in sides]
        if good.any():
            each, cases = zip(batches, self.targets, readings, strict=True), int(good.sum())
            with np.errstate(all="ignore"):
                made = [m.given(law, cases, r, sides) for law, m, r in each]
            for whole, parts in zip(forces, zip(*made, strict=True), strict=True):
                whole[:, good] = np.concatenate(parts)
        return forces

    def slopes(self, point: Array, readings: Sequence[Mapping[str, Any]]) -> tuple[Any, Any]:
        """Derivatives of both ends by differences, all parameters in one batch."""
        point = np.asarray(point, float)
        allowed = self.parameters.limits.allows
        sign = np.array([1.0 if max(ahead) <= 1.0 and allowed(ahead) else -1.0 for ahead in point + np.diag(np.full(len(point), _STEP))])
        least, most = self.ends(np.concatenate([point[None, :], point + np.diag(sign * _STEP)]), readings)
        derivatives = [
            np.nan_to_num((moved[:, 1:] - moved[:, :1]) / (sign * _STEP)) for moved in ((least,) if most is least else (least, most))
        ]
        return derivatives[0], derivatives[-1]
