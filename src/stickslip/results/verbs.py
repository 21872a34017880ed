"""What every result of a motion can be asked in the same words: its mean velocity, its motion, its table and its files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import explains_arguments

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class OfOneRun(ABC):
    """A result that is the motion of one run, such as a periodic orbit: what is asked of it is asked of its run."""

    @property
    @abstractmethod
    def run(self) -> Any:
        """The run."""

    @property
    def mean_velocity(self) -> float:
        """Mean velocity [m/s]."""
        return self.run.mean_velocity

    @property
    def motion(self) -> Any:
        """The motion, as `ss.motion` returns it."""
        return self.run.motion

    def to_xarray(self) -> xr.Dataset:
        """The columns of its run as an `xarray.Dataset` over time."""
        return self.run.to_xarray()

    def to_dataframe(self) -> pd.DataFrame:
        """The columns of its run as a `pandas.DataFrame`, a row for each instant."""
        return self.run.to_dataframe()

    @explains_arguments
    def save(self, path: str | Path) -> Path:
        """Write its run to a file, as `Trajectory.save` does; returns the path."""
        return self.run.save(path)
