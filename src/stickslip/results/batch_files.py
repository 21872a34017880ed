"""Export of a batch: datasets, data frames, netCDF4, CSV, Excel and MATLAB files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.basics.arguments import explains_arguments

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from stickslip.results.datasets import FileColumns


class BatchFiles:
    """Files and tables of a `Summary`."""

    __slots__ = ()

    def to_xarray(self) -> xr.Dataset:
        """The columns as an `xarray.Dataset` with units, names and the batch's own labels."""
        from stickslip.results.datasets import summary_dataset

        return summary_dataset(self)

    def to_dataframe(self) -> pd.DataFrame:
        """The columns as a `pandas.DataFrame`, a row for each case (and body, contact or stop, where a machine has several)."""
        return self.to_xarray().to_dataframe()

    def _table(self) -> FileColumns:
        """The columns as files hold them, a row for each row of the data frame."""
        from stickslip.results.datasets import columns_of_batch

        return columns_of_batch(self)

    @explains_arguments
    def save(self, path: str | Path) -> Path:
        """Write the columns to a netCDF4 file (.nc), which `xarray.open_dataset` reads, or to .csv, .xlsx or .mat; returns its path.

        Examples
        --------
        >>> import stickslip as ss
        >>> many = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[4e-4, 5e-4], law="coulomb"), periods=20)
        >>> many.save("many.csv").read_text().splitlines()[0].split(",")[:3]
        ['case', 'drive.amplitude [m]', 'mean_velocity [m/s]']
        """
        from stickslip.results.storage import save_table

        return save_table(self, path, "batch", "many")
