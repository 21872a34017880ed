"""A measured record that was dropped on the page: read by `stickslip.read`; its velocity or its drive is returned."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError, Problems, StickslipError
from stickslip.show.explorer.frames import encoded
from stickslip.show.explorer.requests import MOST_HARMONICS
from stickslip.show.explorer.sliders import PARAMETERS

#: Largest file, and largest number of samples sent to a page: the last ones, as it draws the end of a record.
MOST_BYTES, MOST_SAMPLES = 20_000_000, 400_000
#: Largest number of samples of a drive, and the largest ratio of its mean to its standard deviation without a remark.
MOST_DRIVE, _DRIFT = 20_000, 0.02
_LONGEST_NAME = 80  # letters
#: Numbers of harmonics of a drive; the first is that of the sawtooth, whose kernel is often ready.
_COUNTS = (5, 10, 20, MOST_HARMONICS)


def velocity_response(name: str, data: bytes) -> bytes:
    r"""The response to a file: times from `start` in steps of `step` [s], velocities [m/s], and two numbers of the whole record.

    These are its mean [m/s], and the frequency with which it repeats [Hz], None if it does not.

    Examples
    --------
    >>> from stickslip.show.explorer.frames import unpacked
    >>> rows = "".join(f"{i}.0;{2 * (i % 2)}.0\n" for i in range(5))
    >>> header, arrays = unpacked(velocity_response("record.csv", f"t [ms];v [mm/s]\n{rows}".encode()))
    >>> round(header["mean"], 9), round(header["step"], 9), arrays["v"].size
    (0.001, 0.001, 5)
    """
    record = read_upload(name, data)
    if "velocity" not in record and "drive" in record:
        return encoded({"mean": None, "notes": ["it has no velocity of the body, but a drive"]})
    t, v, notes = _velocity(record)
    good = np.isfinite(t) & np.isfinite(v)
    t, v = t[good], v[good]
    if t.size < 2 or not np.all(np.diff(t) > 0):
        raise InputError("record", [f"it has {t.size} samples with a time and a velocity, or times that do not rise"])
    mean = float(np.trapezoid(v, t) / (t[-1] - t[0]))
    t, v = t[-MOST_SAMPLES:], v[-MOST_SAMPLES:]
    even = np.linspace(t[0], t[-1], t.size)
    header = {"start": float(t[0]), "step": float((t[-1] - t[0]) / (t.size - 1)), "mean": mean, "notes": notes, "frequency": _line(t, v)}
    return encoded(header, {"v": np.interp(even, t, v)})


def _line(t: Any, v: Any) -> float | None:
    """The frequency of the strongest line of a velocity [Hz], of which there are at least two periods; None if it has none."""
    try:
        hertz = _frequency(t, v)
    except StickslipError:
        return None
    return hertz if hertz * (t[-1] - t[0]) > 2 else None


def file_name(name: str) -> str:
    """The name of a file without folders, and not too long for a sentence."""
    return re.split(r"[/\\]", name)[-1][-_LONGEST_NAME:]


def read_upload(name: str, data: bytes, **options: Any) -> Any:
    """The record in these bytes; `options` are those of `read`."""
    from stickslip.records.reading import read_bytes

    suffix = Path(name).suffix.lower()
    if not re.fullmatch(r"\.[a-z0-9]{1,5}", suffix):
        raise InputError("record", [f"{name[-40:]!r} has no known file extension; allowed is for example .csv, .mat or .uff"])
    return read_bytes(data, f"record{suffix}", **options)


def _velocity(record: Any) -> tuple[Any, Any, list[str]]:
    """Times and velocities of the channel with the velocity of the body, and the assumptions made."""
    channels = [record[name] for name in record]
    candidates = [c for c in channels if c.role == "velocity"] or [c for c in channels if c.unit is None][:1]
    if not candidates:
        listed = ", ".join(f"{c.name} [{c.unit}]" for c in channels)
        raise InputError("record", [f"none of its channels is a velocity of the body: {listed}; name the column v and give its unit"])
    channel = candidates[0]
    notes = [] if channel.unit else [f"{channel.name} has no unit: taken as m/s"]
    notes += [] if channel.axis_unit else ["time has no unit: taken as s"]
    v = channel.si if channel.unit else np.asarray(channel.values, float)
    t = channel.time if channel.axis_unit else np.asarray(channel.t, float)
    return np.asarray(t, float), np.asarray(v, float), notes


def drive_response(name: str, data: bytes) -> bytes:
    r"""The response to a file whose motion will drive the robot: amplitude (half the stroke) [m], omega [rad/s], and the shape.

    The drive is the velocity of the inner mass relative to the body: the channel with that role, or absolute less convected velocity, as
    in the paper. If a record has only some other velocity, that one is taken, and a note says so.

    Examples
    --------
    >>> from stickslip.show.explorer.frames import unpacked
    >>> v = [0.1 * np.cos(2 * np.pi * 50 * i * 1e-4) for i in range(1000)]
    >>> rows = "".join(f"{i / 10},{v[i]:.9g}\n" for i in range(1000))
    >>> header, arrays = unpacked(drive_response("record.csv", f"t [ms],drive [m/s]\n{rows}".encode()))
    >>> round(header["omega"], 3), round(header["amplitude"], 9), len(header["shape"][0])
    (314.159, 0.00031831, 5)
    """
    from stickslip.models.drives import Recorded

    t, v, notes = _relative_velocity(read_upload(name, data))
    good = np.isfinite(t) & np.isfinite(v)
    t, v = t[good][-MOST_DRIVE:], v[good][-MOST_DRIVE:]
    period, mean = 1 / _frequency(t, v), float(np.mean(v))
    if abs(mean) > _DRIFT * float(np.std(v)):
        notes.append(f"its mean of {mean:.4g} m/s is subtracted, as the drive has to return")
    kept = t >= t[-1] - int((t[-1] - t[0]) / period + 1e-6) * period
    drive = Recorded.from_samples(t[kept], velocity=_periodic(t[kept], v[kept], period), period=period, tolerance=1e-2)
    if drive.order > MOST_HARMONICS:
        drive = Recorded.from_samples(t[kept], velocity=_periodic(t[kept], v[kept], period), period=period, order=MOST_HARMONICS)
    amplitude, omega = 0.5 * float(drive.stroke), 2 * np.pi / period
    _check("amplitude", amplitude, problems := Problems("record"))
    _check("omega", omega, problems)
    problems.check()
    count = next(n for n in _COUNTS if n >= drive.order)  # each number of harmonics needs its own kernel: only a few are allowed
    shape = [[c / amplitude for c in side] + [0.0] * (count - len(side)) for side in drive.coefficients]
    return encoded({"amplitude": amplitude, "omega": omega, "shape": shape, "notes": [*notes, *(drive.notes or ())]})


def _check(name: str, value: float, problems: Problems) -> None:
    p = PARAMETERS[name]
    if not p.least <= value <= p.most:
        problems.add(f"its drive has {p.label} {p.shown(value)}; allowed is {p.allowed()}")


def _relative_velocity(record: Any) -> tuple[Any, Any, list[str]]:
    """Times and velocities of the drive, and the assumptions made."""
    if "drive" not in record and "absolute velocity" in record and "velocity" in record:
        record = record.relative_velocity()
    if "drive" in record:
        return np.asarray(record["drive"].time, float), np.asarray(record["drive"].si, float), []
    t, v, notes = _velocity(record)
    return t, v, [*notes, "it has no channel named drive: its velocity is taken as that of the inner mass relative to the body"]


def _frequency(t: Any, v: Any) -> float:
    """The drive frequency [Hz]."""
    from stickslip.records.record import Record

    return float(Record.of(t, {"drive [m/s]": v - np.mean(v)}).drive_frequency().value)


def _periodic(t: Any, v: Any, period: float) -> Any:
    """Velocities without their drift over whole periods, so that the position is periodic."""
    from stickslip.records.tones import harmonics

    line, _ = harmonics(t, v, 1 / period)
    return v - line[0] - line[1] * (t - t.mean()) / np.ptp(t)
