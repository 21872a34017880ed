"""A record as a data frame and as a dataset, in the units of its file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.records.saving import adjacent

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from stickslip.records.channel import Channel


class RecordTables:
    """Tables of a `Record`."""

    channels: Mapping[str, Channel]
    source: dict[str, Any]
    synthetic: bool

    def to_dataframe(self) -> pd.DataFrame:
        """The channels as a `pandas.DataFrame` over their axis, in the units of the file, which ``frame.attrs["units"]`` holds.

        Raises
        ------
        InputError
            The channels are not sampled at the same times; `to_xarray` keeps each with its own.

        Examples
        --------
        >>> from stickslip.records import Record
        >>> frame = Record.of([0.0, 0.1], {"LDV [mm/s]": [1.0, 2.0]}).to_dataframe()
        >>> frame["LDV"].tolist(), frame.index.name, frame.attrs["units"]
        ([1.0, 2.0], 'time', {'time': 's', 'LDV': 'mm/s'})
        """
        import pandas as pd

        channels = list(self.channels.values())
        if others := [c.name for c in channels if not adjacent(c, channels[0])]:
            mistake = f"{', '.join(others)} and {channels[0].name} are not sampled at the same times, so they do not fit into one table"
            raise InputError("record", [f"{mistake}; type rec.to_xarray(), where each has its own times"])
        if not channels:
            return pd.DataFrame()
        axis = channels[0].axis_name or "axis"
        frame = pd.DataFrame({c.name: np.asarray(c.values) for c in channels}, index=pd.Index(np.asarray(channels[0].t), name=axis))
        frame.attrs["units"] = {axis: channels[0].axis_unit, **{c.name: c.unit for c in channels}}
        return frame

    def to_xarray(self) -> xr.Dataset:
        """The channels as an `xarray.Dataset`, in the units of the file; channels with times of their own have a dimension of their own.

        Examples
        --------
        >>> from stickslip.records import Record
        >>> data = Record.of([0.0, 0.1], {"LDV [mm/s]": [1.0, 2.0]}).to_xarray()
        >>> data.LDV.dims, data.LDV.attrs["units"], data.LDV.attrs["role"]
        (('time',), 'mm/s', 'velocity')
        """
        import xarray as xr

        axes: list[tuple[str, Channel]] = []
        data: dict[str, Any] = {}
        for c in self.channels.values():
            dim = next((name for name, first in axes if adjacent(c, first)), None)
            if dim is None:
                dim = _free(c.axis_name or "axis", {*self.channels, *(name for name, _ in axes)})
                axes.append((dim, c))
            data[c.name] = (dim, np.asarray(c.values), _described(c.unit, c.role))
        coords: dict[str, Any] = {name: (name, np.asarray(c.t), _described(c.axis_unit, None)) for name, c in axes}
        return xr.Dataset(data, coords, {"format": str(self.source.get("format", "")), "synthetic": int(self.synthetic)})


def _free(name: str, taken: set[str]) -> str:
    """The name, or with a number where it is taken."""
    return next(free for free in (name, *(f"{name}_{k}" for k in range(2, len(taken) + 3))) if free not in taken)


def _described(unit: str | None, role: str | None) -> dict[str, str]:
    return {name: text for name, text in (("units", unit), ("role", role)) if text is not None}
