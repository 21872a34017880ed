"""The virtual rig: synthetic records with known parameters and the imperfections of a real bench."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import Problems, is_one_of
from stickslip.basics.fields import checked_number
from stickslip.basics.quantities import between
from stickslip.models.drives import Harmonic, MultiHarmonic
from stickslip.models.machine_adapter import machine_of
from stickslip.models.robot import Robot
from stickslip.records import Channel, Record
from stickslip.solvers import solve

_OVER = 8  # the sensor's bandwidth is applied to this many times more samples
MOST_SAMPLES = 1e7
_OF_THE_DRIVE = ("absolute velocity", "drive")
CHANNELS = ("velocity", "absolute velocity", "position", "drive", "force", "acceleration")


@explains_arguments
def virtual_rig(
    robot: Robot,
    *,
    noise: float = 0.0,
    seed: int = 0,
    periods: int = 20,
    settle: int = 60,
    samples: float = 100.0,
    channels: tuple[str, ...] | list[str] = ("velocity",),
    phase: float = 0.0,
    bandwidth: float | None = None,
    harmonics: tuple[float, float] = (0.0, 0.0),
    resolution: float = 0.0,
    offset: float = 0.0,
    rtol: float = 1e-9,
) -> Record:
    """A synthetic record of a robot, always labelled as such.

    Parameters
    ----------
    robot : Robot
        The true robot; its law may be richer than the one that will be fitted, and its incline may have gravity.
    noise : float
        Standard deviation of white noise on every velocity channel [m/s]; the same fraction of the range on other channels.
    seed : int
    periods : int
        Drive periods in the record.
    settle : int
        Drive periods before it begins.
    samples : float
        Samples per drive period.
    channels : sequence of str
        Of "velocity", "absolute velocity" (of the inner mass), "position", "drive" (relative velocity), "force" (friction), "acceleration".
    phase : float
        Drive phase of the first sample, in drive periods.
    bandwidth : float, optional
        Bandwidth of the sensor, a first-order low-pass filter [Hz].
    harmonics : tuple of float
        Second and third harmonic of a harmonic drive, as fractions of its amplitude, such as an amplifier or a beam adds.
    resolution : float
        Quantisation step of the digitiser [SI unit of the channel]; 0 for none.
    offset : float
        Offset of the velocity channels [m/s].
    rtol : float
        Relative tolerance of the solver.

    Returns
    -------
    Record
        With ``synthetic=True``, and the truth in its `source`.

    Examples
    --------
    >>> import stickslip as ss
    >>> rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), noise=1e-4, seed=1)
    >>> rec.synthetic, len(rec["velocity"]), round(rec.mean_velocity * 1e3, 1)
    (True, 2000, 1.7)
    """
    problems = Problems("virtual_rig")
    _check_sampling(noise, periods, settle, samples, problems)
    _check_sensors(channels, bandwidth, resolution, robot, problems)
    _check_harmonics(harmonics, robot, problems)
    problems.check()
    if any(harmonics):
        robot = robot.replace(drive=MultiHarmonic(robot.drive.omega, tuple(robot.drive.amplitude * part for part in (1.0, *harmonics))))
    run = solve(robot, periods=settle + periods + 1, settle=settle, rtol=rtol, samples=8, keep="trajectory")
    T = run.period_time
    t = np.arange(round(periods * samples)) / samples * T
    columns = _recorded(run, (settle + phase % 1.0) * T, t, T / samples, bandwidth, channels)
    rng, made = np.random.default_rng(seed), {}
    for name in channels:
        y, unit = columns[name], _UNITS[name]
        level = noise if unit == "m/s" else noise * float(np.ptp(y)) / max(float(np.ptp(columns["velocity"])), 1e-300)
        y = y + (offset if unit == "m/s" else 0.0) + level * rng.normal(size=len(t))
        made[name] = Channel(name, np.round(y / resolution) * resolution if resolution else y, unit, t, "time", "s", name)
    return Record(made, (_LABEL,), {"format": "virtual rig", **_truth(robot, run, noise, seed, bandwidth, resolution)}, synthetic=True)


_UNITS = {"velocity": "m/s", "absolute velocity": "m/s", "position": "m", "drive": "m/s", "force": "N", "acceleration": "m/s^2"}
_LABEL = "SYNTHETIC: made by a virtual rig, not measured"


def _check_sampling(noise: float, periods: int, settle: int, samples: float, problems: Problems) -> None:
    """Note numbers of which no record can be made."""
    for name, value, least in (("noise", noise, 0), ("periods", periods, 1), ("settle", settle, 0), ("samples", samples, 4)):
        if not isinstance(value, (int, float, np.number)) or not least <= value < np.inf:
            problems.add(f"{name} = {value!r}; allowed is {least} or more; type for example {name}={max(least, 20)}")
    if not problems.mistakes and periods * samples > MOST_SAMPLES:
        count = f"periods = {periods!r} with samples = {samples!r} are {periods * samples:.3g} samples"
        problems.add(f"{count}; allowed are {MOST_SAMPLES:.0e} in all")


def _check_sensors(channels: Any, bandwidth: Any, resolution: float, robot: Model, problems: Problems) -> None:
    """Note channels that there are not, and sensors that cannot be."""
    drive, what = machine_of(robot).drive, type(robot).__name__
    there = [name for name in CHANNELS if drive is not None or name not in _OF_THE_DRIVE]
    for name in channels:
        if not is_one_of(name, there):
            without = "" if drive is not None else f" and the {what} has no drive that moves an inner mass"
            problems.add(f"channels names {name!r}{without}; allowed are {', '.join(there)}")
    if bandwidth is not None:
        checked_number("bandwidth", bandwidth, problems, between(1e-9, 1e12), "a positive frequency [Hz], or None", "bandwidth=500.0")
    checked_number("resolution", resolution, problems, between(0.0, 1e9), "0 or more", "resolution=1e-5")


def _check_harmonics(harmonics: Any, robot: Model, problems: Problems) -> None:
    """Note harmonics that are no two parts, or of a drive that is no sine."""
    drive = machine_of(robot).drive
    if np.shape(harmonics) != (2,) or not np.isfinite(np.asarray(harmonics, float)).all():
        problems.add(f"harmonics = {harmonics!r}; allowed are two parts of the amplitude; type for example harmonics=(0.05, 0.02)")
    elif any(harmonics) and not _is_one_sine(drive):
        problems.add(
            f"harmonics = {harmonics!r} and the drive is {type(drive).__name__}; allowed is a Harmonic as it is; leave harmonics out, "
            "or give the robot a drive with them: ss.MultiHarmonic(frequency=32.7, amplitudes=(5e-4, 1e-4))"
        )


def _is_one_sine(drive: Any) -> bool:
    """Whether a drive is A sin(omega t) in what it does, and not in name only."""
    if not isinstance(drive, Harmonic):
        return False
    t = np.array([0.13, 0.57, 0.81]) * 2 * np.pi / drive.omega
    return bool(np.allclose(drive.acceleration(t), Harmonic.acceleration(drive, t), rtol=1e-12, atol=0.0))


def _recorded(run: Any, start: float, t: Array, step: float, bandwidth: float | None, channels: Any) -> dict[str, Any]:
    """The readings of ideal sensors of the given bandwidth."""
    if bandwidth is None:
        return _columns(run.at(np.minimum(start + t, run.pieces.t[-1])))
    from scipy.signal import lfilter

    before = int(min(start / step, 8 / (bandwidth * step) + 10))
    fine = start + step * (np.arange((len(t) + before) * _OVER) / _OVER - before)
    columns = _columns(run.at(np.clip(fine, run.pieces.t[0], run.pieces.t[-1])))
    keep = np.exp(-2 * np.pi * bandwidth * step / _OVER)
    return {
        name: lfilter([1 - keep], [1, -keep], y, zi=[keep * y[0]])[0][before * _OVER :: _OVER]
        for name, y in columns.items()
        if name in (*channels, "velocity")
    }


def _columns(at: dict[str, Any]) -> dict[str, Any]:
    of_drive = {"absolute velocity": at["v"] + at["xi_rate"], "drive": at["xi_rate"]} if "xi_rate" in at else {}
    position = at["x"] - at["x"][0]
    return {"velocity": at["v"], "position": position, "force": at["friction_force"], "acceleration": at["acceleration"], **of_drive}


def _truth(robot: Any, run: Any, noise: float, seed: int, bandwidth: float | None, resolution: float) -> dict[str, Any]:
    from stickslip.basics.fields import leaves

    kept = {"noise": noise, "seed": seed, "bandwidth": bandwidth, "resolution": resolution, "rtol": run.rtol}
    return {"law": type(robot.friction).__name__, "truth": {name: float(value) for name, value in leaves(robot)}, **kept}
