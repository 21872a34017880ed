"""A measured record that was dropped on the page: read by `stickslip.read`, and its velocity handed back."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.explorer.frames import written

__all__ = ["MOST_BYTES", "velocity_of"]

#: Largest file, and most samples that a page gets: the last ones, as it draws the end of a record.
MOST_BYTES, MOST_SAMPLES = 20_000_000, 400_000


def velocity_of(name: str, data: bytes) -> bytes:
    r"""The answer to a file: times from `start` in steps of `step` [s], velocities [m/s], and the mean of the whole record.

    Examples
    --------
    >>> from stickslip.explorer.frames import read
    >>> rows = "".join(f"{i}.0;{2 * (i % 2)}.0\n" for i in range(5))
    >>> header, arrays = read(velocity_of("record.csv", f"t [ms];v [mm/s]\n{rows}".encode()))
    >>> round(header["mean"], 9), round(header["step"], 9), arrays["v"].size
    (0.001, 0.001, 5)
    """
    from stickslip.records import read

    suffix = Path(name).suffix.lower()
    if not re.fullmatch(r"\.[a-z0-9]{1,5}", suffix):
        raise InputError("record", [f"{name[-40:]!r} does not say by its ending what it is; allowed is for example .csv, .mat or .uff"])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"record{suffix}"
        path.write_bytes(data)
        record = read(path)
    t, v, notes = _velocity(record)
    good = np.isfinite(t) & np.isfinite(v)
    t, v = t[good], v[good]
    if t.size < 2 or not np.all(np.diff(t) > 0):
        raise InputError("record", [f"it has {t.size} samples with a time and a velocity, or times that do not rise"])
    mean = float(np.trapezoid(v, t) / (t[-1] - t[0]))
    t, v = t[-MOST_SAMPLES:], v[-MOST_SAMPLES:]
    even = np.linspace(t[0], t[-1], t.size)
    header = {"start": float(t[0]), "step": float((t[-1] - t[0]) / (t.size - 1)), "mean": mean, "notes": notes}
    return written(header, {"v": np.interp(even, t, v)})


def _velocity(record: Any) -> tuple[Any, Any, list[str]]:
    """Times and velocities of the channel that is the velocity of the body, and what was assumed for it."""
    channels = [record[name] for name in record]
    found = [c for c in channels if c.role == "velocity"] or [c for c in channels if c.unit is None][:1]
    if not found:
        listed = ", ".join(f"{c.name} [{c.unit}]" for c in channels)
        raise InputError("record", [f"none of its channels is a velocity of the body: {listed}; name the column v and give its unit"])
    channel = found[0]
    notes = [] if channel.unit else [f"{channel.name} has no unit: taken as m/s"]
    notes += [] if channel.axis_unit else ["time has no unit: taken as s"]
    v = channel.si if channel.unit else np.asarray(channel.values, float)
    t = channel.time if channel.axis_unit else np.asarray(channel.t, float)
    return np.asarray(t, float), np.asarray(v, float), notes
