"""The virtual rig: synthetic records of a known truth, with what a real bench adds to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stickslip.errors import Problems
from stickslip.fields import Record as Fields
from stickslip.fields import at_least, positive
from stickslip.maths import cos, pi, sin
from stickslip.records import Channel, Record
from stickslip.solvers import solve

__all__ = ["DistortedHarmonic", "virtual_rig"]

_OVER = 8  # the sensor's bandwidth is applied to this many times more samples
CHANNELS = ("velocity", "absolute velocity", "position", "drive", "force", "acceleration")


@dataclass(frozen=True, eq=False)
class DistortedHarmonic(Fields):
    r"""A harmonic drive with a second and a third harmonic: what an amplifier or a beam adds.

    .. math:: \xi(t) = A\,(\sin\omega t + h_2\sin 2\omega t + h_3\sin 3\omega t)

    Parameters
    ----------
    amplitude : float
        A [m].
    omega : float
        [rad/s]
    second, third : float
        Parts of A [-].
    """

    amplitude: float
    omega: float
    second: float = 0.0
    third: float = 0.0

    _rules: ClassVar[dict[str, Any]] = {
        "amplitude": (at_least(0.0), "zero or more [m]"),
        "omega": (positive, "a positive angular frequency [rad/s]"),
    }

    @property
    def period(self) -> Any:
        """Period [s]."""
        return 2 * pi / self.omega

    def position(self, t: Any) -> Any:
        """Relative position [m]."""
        w = self.omega * t
        return self.amplitude * (sin(w) + self.second * sin(2 * w) + self.third * sin(3 * w))

    def velocity(self, t: Any) -> Any:
        """Relative velocity [m/s]."""
        w = self.omega * t
        return self.amplitude * self.omega * (cos(w) + 2 * self.second * cos(2 * w) + 3 * self.third * cos(3 * w))

    def acceleration(self, t: Any) -> Any:
        """Relative acceleration [m/s^2]."""
        w = self.omega * t
        return -self.amplitude * self.omega**2 * (sin(w) + 4 * self.second * sin(2 * w) + 9 * self.third * sin(3 * w))

    @property
    def velocity_scale(self) -> Any:
        """A omega [m/s]."""
        return self.amplitude * self.omega

    @property
    def specific_energy(self) -> Any:
        """Half the squared velocity scale [J/kg]."""
        return 0.5 * self.velocity_scale**2

    @property
    def stroke(self) -> Any:
        """Twice the amplitude of the fundamental [m]."""
        return 2 * self.amplitude


def virtual_rig(
    robot: Any,
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
    """A synthetic record of a robot, always labelled so.

    Parameters
    ----------
    robot : Robot
        The truth; with a richer law, or gravity on an incline, than the one that will be fitted.
    noise : float
        Standard deviation of white noise on every velocity channel [m/s]; the same part of the range on other channels.
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
        Of the sensor: a first-order low-pass [Hz].
    harmonics : tuple of float
        Second and third harmonic of the drive, as parts of its amplitude.
    resolution : float
        Step between neighbouring numbers of the digitizer [SI unit of the channel]; 0 for none.
    offset : float
        Of the velocity channels [m/s].
    rtol : float
        Of the solver.

    Returns
    -------
    Record
        With ``synthetic=True``, and the truth in its `source`.

    Examples
    --------
    >>> import stickslip as ss
    >>> rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), noise=1e-4, seed=1)
    >>> rec.synthetic, len(rec["velocity"]), round(rec.mean_velocity() * 1e3, 1)
    (True, 2000, 1.7)
    """
    _check(noise, periods, settle, samples, channels, bandwidth, resolution)
    if any(harmonics):
        robot = robot.replace(drive=DistortedHarmonic(robot.drive.amplitude, robot.drive.omega, *harmonics))
    run = solve(robot, periods=settle + periods + 1, settle=settle, rtol=rtol, samples=8, keep="trajectory")
    T = run.period_time
    t = np.arange(round(periods * samples)) / samples * T
    seen = _seen(run, (settle + phase % 1.0) * T, t, T / samples, bandwidth, channels)
    rng, made = np.random.default_rng(seed), {}
    for name in channels:
        y, unit = seen[name], _UNITS[name]
        level = noise if unit == "m/s" else noise * float(np.ptp(y)) / max(float(np.ptp(seen["velocity"])), 1e-300)
        y = y + (offset if unit == "m/s" else 0.0) + level * rng.normal(size=len(t))
        made[name] = Channel(name, np.round(y / resolution) * resolution if resolution else y, unit, t, "time", "s", name)
    return Record(made, (_LABEL,), {"format": "virtual rig", **_truth(robot, run, noise, seed, bandwidth, resolution)}, synthetic=True)


_UNITS = {"velocity": "m/s", "absolute velocity": "m/s", "position": "m", "drive": "m/s", "force": "N", "acceleration": "m/s^2"}
_LABEL = "SYNTHETIC: made by a virtual rig, not measured"


def _check(noise: float, periods: int, settle: int, samples: float, channels: Any, bandwidth: Any, resolution: float) -> None:
    problems = Problems("virtual_rig")
    for name, value, least in (("noise", noise, 0), ("periods", periods, 1), ("settle", settle, 0), ("samples", samples, 4)):
        if not isinstance(value, (int, float, np.number)) or not least <= value < np.inf:
            problems.add(f"{name} = {value!r}; allowed is {least} or more; type for example {name}={max(least, 20)}")
    for name in channels:
        if name not in CHANNELS:
            problems.add(f"channels names {name!r}; allowed are {', '.join(CHANNELS)}")
    if bandwidth is not None and not bandwidth > 0:
        problems.add(f"bandwidth = {bandwidth!r}; allowed is a positive frequency [Hz], or None")
    if not resolution >= 0:
        problems.add(f"resolution = {resolution!r}; allowed is 0 or more")
    problems.check()


def _seen(run: Any, start: float, t: Any, step: float, bandwidth: float | None, channels: Any) -> dict[str, Any]:
    """What ideal sensors of the given bandwidth show."""
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
    return {
        "velocity": at["v"],
        "absolute velocity": at["v"] + at["xi_rate"],
        "position": at["x"] - at["x"][0],
        "drive": at["xi_rate"],
        "force": at["friction_force"],
        "acceleration": at["acceleration"],
    }


def _truth(robot: Any, run: Any, noise: float, seed: int, bandwidth: float | None, resolution: float) -> dict[str, Any]:
    from stickslip.fields import leaves

    kept = {"noise": noise, "seed": seed, "bandwidth": bandwidth, "resolution": resolution, "rtol": run.rtol}
    return {"law": type(robot.friction).__name__, "truth": {name: float(value) for name, value in leaves(robot)}, **kept}
