"""Export of a run: data frames, CSV, Excel and MATLAB files, datasets, and files that `stickslip.load` reads back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.basics.arguments import explains_arguments

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from stickslip.results.datasets import FileColumns


class RunFiles:
    """Files and tables of a `Trajectory`."""

    __slots__ = ()

    def _table(self) -> FileColumns:
        """The columns as files hold them."""
        from stickslip.results.datasets import columns_for_file

        return columns_for_file(self)

    def to_xarray(self) -> xr.Dataset:
        """The columns as an `xarray.Dataset` over time, with units, names and provenance."""
        from stickslip.results.datasets import trajectory_dataset

        return trajectory_dataset(self)

    def to_dataframe(self) -> pd.DataFrame:
        """The columns as a `pandas.DataFrame`, a row for each instant; ``frame.attrs["units"]`` holds their units.

        Of a machine of several bodies the columns are called "x.head", those of several inner states "z_0".

        Examples
        --------
        >>> import stickslip as ss
        >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=2)
        >>> frame = run.to_dataframe()
        >>> list(frame.columns[:3]), frame.attrs["units"]["v"], len(frame) == len(run.t)
        (['t', 'x', 'v'], 'm/s', True)
        """
        import pandas as pd

        from stickslip.results.datasets import flat_columns

        columns = flat_columns(self)
        frame = pd.DataFrame({name: values for name, (values, _) in columns.items()})
        frame.attrs.update(units={name: unit for name, (_, unit) in columns.items()}, status=getattr(self, "status", ""))
        return frame

    @explains_arguments
    def to_csv(self, path: str | Path) -> Path:
        """Write the columns to a CSV file, names with units in its first line, every digit kept; returns its path."""
        from stickslip.results.storage import to_csv

        return to_csv(self, path)

    @explains_arguments
    def to_excel(self, path: str | Path) -> Path:
        """Write the columns to an Excel workbook (.xlsx), names with units in its first line; returns its path.

        Numbers have 16 digits there. A second sheet gives the meaning of each column, a third the status, the method and the robot.
        Needs openpyxl:
        ``pip install "stickslip[io]"``.
        """
        from stickslip.results.storage import to_excel

        return to_excel(self, path)

    @explains_arguments
    def to_mat(self, path: str | Path) -> Path:
        """Write the columns to a MATLAB file; returns its path."""
        from stickslip.results.storage import to_mat

        return to_mat(self, path)

    @explains_arguments
    def save(self, path: str | Path) -> Path:
        """Write the run to a netCDF4 file (.nc) that `stickslip.load` reads back, or its columns to .csv, .xlsx or .mat.

        Returns the path.
        """
        from stickslip.results.storage import save

        return save(self, path)
