"""The surroundings of section 5: period number and largest exponent over amplitude and kinetic coefficient, and period doublings."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.interruption import in_threads
from stickslip.dynamics.attractors.kinds_of_motion import CHAOTIC
from stickslip.show.paper.cases import AMPLITUDE_5
from stickslip.show.paper.solved_runs import Tell
from stickslip.show.paper.words import millimetres, plain

__all__ = ["FULL", "ParameterMap", "around"]

#: Points of the map along the kinetic coefficient and the amplitude, in the fast subset and in the full run.
FAST_SIZE, SIZE = (18, 15), (60, 48)
#: The same map at full resolution (about half an hour on two cores).
FULL = (
    "stickslip lyapunov piezo_rig tilt_deg=1.7 mu0=0.03..0.21:288:log amplitude=2.5e-4..9.5e-4:281 settle=1000 periods=400 "
    "workers=2 --out around.nc --figure around.png"
)
_RTOL = 1e-7


@dataclass(frozen=True, eq=False)
class ParameterMap:
    """The map and the curves on it.

    Parameters
    ----------
    grid : xarray.Dataset
        From `stickslip.dynamics.chaos_map`, over mu0 and amplitude.
    flips : tuple of float
        Values of mu0 at which the motion of period one doubles its period at the amplitude taken for section 5.3.
    curves : tuple of Curve
        The curve of these flips in (mu0, amplitude).
    accuracies : tuple of float
        Accuracy of each flip.
    """

    grid: Any
    flips: tuple[float, ...]
    curves: tuple[Any, ...]
    accuracies: tuple[float, ...]

    @property
    def rounded_flips(self) -> list[str]:
        """The flips, to their certain digits."""
        from stickslip.dynamics.continuation.special_points.accuracy import certain

        return [certain(value, accuracy) for value, accuracy in zip(self.flips, self.accuracies, strict=True)]

    @cached_property
    def shares(self) -> dict[str, float]:
        """Fractions of the map: period one, two, higher, chaotic, and what is neither, most of it not settled within the limit."""
        period, chaotic = self.grid.period.values, self.chaotic
        return {
            "period 1": float(np.mean(period == 1)),
            "period 2": float(np.mean(period == 2)),
            "higher periods": float(np.mean(period > 2)),
            "chaotic": float(np.mean(chaotic)),
            "not settled": float(np.mean((period == 0) & ~chaotic)),
        }

    @cached_property
    def chaotic(self) -> Any:
        """The mask of chaotic motions, by the rule of `stickslip.dynamics.chaos_map`."""
        return self.grid.motion.values == CHAOTIC

    @property
    def largest(self) -> dict[str, float]:
        """The largest exponent and its place."""
        flat = np.where(self.chaotic, self.grid.exponent.values, -np.inf)
        i, j = np.unravel_index(int(np.argmax(flat)), flat.shape)
        return {
            "exponent": float(flat[i, j]), "error": float(self.grid.error[i, j]), "mu0": float(self.grid.mu0[i]),
            "amplitude": float(self.grid.amplitude[j]),
        }  # fmt: skip

    @property
    def where(self) -> str:
        """That place in words."""
        return f"A = {millimetres(self.largest['amplitude'], 3)}, μ₀ = {plain(self.largest['mu0'], 3)}"

    def as_data(self) -> dict[str, Any]:
        """The results as plain data, SI units."""
        names = ("period", "exponent", "error", "mean_velocity")
        return {
            "mu0": self.grid.mu0.values, "amplitude": self.grid.amplitude.values, **{n: self.grid[n].values for n in names},
            "shares": self.shares, "largest": self.largest, "flips": self.flips, "flips_amplitude": AMPLITUDE_5,
            "flip_accuracies": self.accuracies,
            "flip_curves": [{p: c.values[:, i] for i, p in enumerate(c.parameters)} for c in self.curves],
            "settle": self.grid.attrs["settle"], "periods": self.grid.attrs["periods"], "full_resolution": FULL,
        }  # fmt: skip


def around(fast: bool, tell: Tell) -> ParameterMap:
    """Compute the map, and follow the flips of the paper's rig in two parameters."""
    from stickslip.dynamics.attractors.period_maps import chaos_map
    from stickslip.models.presets import piezo_rig

    what, (n, m) = "mapping what lies around section 5", FAST_SIZE if fast else SIZE
    stop, run = in_threads()
    with ThreadPoolExecutor(1) as pool, stop.on_error():
        followed = pool.submit(run, _flips)  # continuation is sequential: meanwhile the map keeps the other cores busy
        grid = chaos_map(
            piezo_rig, mu0=np.geomspace(0.03, 0.21, n), amplitude=np.linspace(2.5e-4, 9.5e-4, m), tilt_deg=1.7,
            settle=300, periods=60 if fast else 100, rtol=_RTOL, workers=min(os.cpu_count() or 1, 8),
            progress=lambda now: tell(what, int(now.done), now.cases),
        )  # fmt: skip
        tell("following the flips of section 5", 0, 1)
        return ParameterMap(grid, *followed.result())


def _flips() -> tuple[tuple[float, ...], tuple[Any, ...], tuple[float, ...]]:
    """The flips at the paper's amplitude, the curve of the first one upwards and downwards in it, and their accuracy."""
    from stickslip.dynamics.continuation.branches import continuation
    from stickslip.dynamics.continuation.two_parameters import special_curve
    from stickslip.models.presets import piezo_rig

    branch = continuation(piezo_rig, parameter="mu0", start=0.05, stop=0.0345, step=0.1, rtol=1e-8, tilt_deg=1.7, amplitude=AMPLITUDE_5)
    flips = [s for s in branch.special if s.kind == "flip"]
    curves = tuple(special_curve(branch, flips[0], "amplitude", stop, step=0.1) for stop in (9.5e-4, 2.5e-4)) if flips else ()
    return tuple(s.value for s in flips), curves, tuple(s.accuracy for s in flips)
