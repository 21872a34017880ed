"""The formats of records: by which bytes a file is known, and which function reads it. A new format is a line here, and its reader."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.records.bam_logs import is_log


@dataclass(frozen=True)
class Format:
    """A format of files.

    Parameters
    ----------
    names : tuple of str
        What it is called, as errors list it.
    known_by : callable
        Whether bytes are of this format.
    read_by : str
        Module and function of `stickslip.records` that makes a `Raw` of the bytes, imported when a file of the format is read.
    takes : tuple of str
        What that function takes after the bytes: ``allowance`` (how much may be unpacked of a file from anywhere), or what the user
        says: ``byte_order``, ``separator``, ``decimal``, ``episode``.
    apart : bool
        Whether it is read in a process of its own, since its library may crash on a damaged file or go on for ever (`records.apart`).
    library : str
        What it needs of ``pip install "stickslip[io]"``, if it is read apart.
    """

    names: tuple[str, ...]
    known_by: Callable[[bytes], bool]
    read_by: str
    takes: tuple[str, ...] = ("allowance",)
    apart: bool = False
    library: str = ""

    def reader(self) -> Callable[..., Any]:
        """The function that reads it."""
        module, _, name = self.read_by.partition(".")
        function: Callable[..., Any] = getattr(importlib.import_module(f"stickslip.records.{module}"), name)
        return function


def _is_hdf5(data: bytes) -> bool:
    return b"\x89HDF\r\n\x1a\n" in (data[:8], data[512:520])


def _is_matlab(data: bytes) -> bool:
    return data[:10] == b"MATLAB 5.0" or data[126:128] in (b"IM", b"MI") or _is_matlab4(data)


def _is_matlab4(data: bytes) -> bool:
    """Whether the bytes begin with the header of a version 4 matrix: type, rows, columns, imaginary flag, length of the name."""
    if len(data) < 21:
        return False
    for order in ("<", ">"):
        kind, rows, cols, imaginary, length = (int(x) for x in np.frombuffer(data[:20], f"{order}i4"))
        if kind in (*range(0, 60, 10), *range(1000, 1060, 10)) and rows > 0 and cols > 0 and imaginary in (0, 1) and 1 < length < 64:
            return data[20 + length - 1 : 20 + length] == b"\0"
    return False


def _is_uff(data: bytes) -> bool:
    return re.match(rb"\s*-1[ \t]*\r?\n\s*\d+b?\s", data[:400]) is not None


#: The formats in the order in which they are looked for; what is none of the others is text.
FORMATS = [
    Format(("HDF5",), _is_hdf5, "hierarchical.parse_hdf5"),
    Format(("netCDF",), lambda data: data[:4] in (b"CDF\x01", b"CDF\x02"), "hierarchical.parse_netcdf3"),
    Format(("MATLAB",), _is_matlab, "matlab_files.parse", apart=True),
    Format(("TDMS",), lambda data: data[:4] == b"TDSm", "extras.parse_tdms"),
    Format(("XLSX",), lambda data: data[:4] == b"PK\x03\x04", "spreadsheets.parse_xlsx", apart=True, library="openpyxl"),
    Format(("MCAP",), lambda data: data[:8] == b"\x89MCAP0\r\n", "robot_logs.parse_mcap"),
    Format(("ROS bag",), lambda data: data[:9] == b"#ROSBAG V", "robot_logs.parse_bag"),
    Format(("ROS 2 bag",), lambda data: data[:16] == b"SQLite format 3\0", "ros2_bags.parse", apart=True),
    Format(("Parquet",), lambda data: data[:4] == b"PAR1", "robot_logs.parse_parquet", ("allowance", "episode")),
    Format(("UFF58",), _is_uff, "uff.parse", ("byte_order",)),
    Format(("BAM's JSON",), is_log, "bam_logs.parse"),
    Format(("CSV", "TSV", "TXT", "JSON"), lambda data: True, "text.parse", ("separator", "decimal")),
]


def format_of(data: bytes) -> Format:
    """The format of the bytes of a file.

    Examples
    --------
    >>> format_of(b"TDSm").names, format_of(b"t [s]; v [m/s]").names
    (('TDMS',), ('CSV', 'TSV', 'TXT', 'JSON'))
    """
    return next(known for known in FORMATS if known.known_by(data))


def formats_in_words() -> str:
    """All formats as an error lists them.

    Examples
    --------
    >>> formats_in_words()
    "CSV, TSV, TXT, JSON, BAM's JSON, UFF58, Parquet, ROS 2 bag, ROS bag, MCAP, XLSX, TDMS, MATLAB, netCDF and HDF5"
    """
    *names, last = [name for known in reversed(FORMATS) for name in known.names]
    return f"{', '.join(names)} and {last}"
