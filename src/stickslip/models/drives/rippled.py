"""A drive with the harmonics that its actuator adds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.errors import Problems
from stickslip.basics.quantities import quantity
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.drives.fourier import series
from stickslip.models.drives.harmonic import Harmonic
from stickslip.models.drives.within import with_drives
from stickslip.models.drives.wrapper import Around

_SAMPLES = 64  # instants of a period at which a drive that does not name its stroke is asked for its position


@dataclass(frozen=True, eq=False)
class Rippled(Around):
    r"""A drive with higher harmonics added: :math:`\xi(t) + \sum_{k \ge 2} (s_k \sin k\omega t + c_k \cos k\omega t)`.

    Parameters
    ----------
    drive : any drive
    sines, cosines : tuple of float
        Amplitudes of the second harmonic, the third, and so on [m].

    Examples
    --------
    >>> bent = Rippled(Harmonic(amplitude=1e-3, omega=200.0), sines=(0.0,), cosines=(2e-5,))
    >>> round(bent.position(0.0), 9), round(bent.acceleration(0.0), 9)
    (2e-05, -3.2)
    """

    drive: Any
    sines: tuple[float, ...] = field(metadata=quantity("sine of a harmonic", "m", "s", example=(1e-5,)))
    cosines: tuple[float, ...] = field(metadata=quantity("cosine of a harmonic", "m", "c", example=(1e-5,)))

    def _check(self, problems: Problems) -> None:
        super()._check(problems)
        if len(self.sines) != len(self.cosines):
            problems.add(f"{len(self.sines)} sines and {len(self.cosines)} cosines; allowed is the same number of each")

    def _of(self, what: str, t: Any) -> Any:
        orders = range(2, len(self.sines) + 2)
        pairs = [(c, s) for c, s in zip(self.cosines, self.sines, strict=True)]
        if what == "velocity":
            pairs = [(k * self.omega * s, -k * self.omega * c) for k, (c, s) in zip(orders, pairs, strict=True)]
        if what == "acceleration":
            pairs = [(-((k * self.omega) ** 2) * c, -((k * self.omega) ** 2) * s) for k, (c, s) in zip(orders, pairs, strict=True)]
        cosines, sines = ((0.0, *(pair[i] for pair in pairs)) for i in (0, 1))
        return super()._of(what, t) + series(self.omega * t, cosines, sines)

    @classmethod
    def example(cls) -> Rippled:
        """A sine with two per cent of second harmonic."""
        return cls(Harmonic.example(), sines=(1e-5,), cosines=(0.0,))


def with_ripple(record: Any, sines: tuple[float, ...], cosines: tuple[float, ...]) -> Any:
    """A machine whose drives have the same higher harmonics, in parts of the amplitude of each (half of its stroke).

    Examples
    --------
    >>> import stickslip as ss
    >>> rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
    >>> with_ripple(rig, sines=(0.02,), cosines=(0.0,)).drive.sines
    (1e-05,)
    """

    def rippled(drive: Any) -> Rippled:
        size = _amplitude(drive)
        return Rippled(drive, tuple(size * s for s in sines), tuple(size * c for c in cosines))

    return with_drives(record, rippled)


def _amplitude(drive: Any) -> float:
    """Half of the stroke of a drive [m]."""
    stroke = drive_of(drive).stroke
    if stroke is None:
        places = [float(drive.position(drive.period * k / _SAMPLES)) for k in range(_SAMPLES)]
        stroke = max(places) - min(places)
    return 0.5 * float(stroke)
