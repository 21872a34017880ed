"""A measured record: its channels, where they come from, and what there is to remark."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Numbers, described_as, explains_arguments
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.units import quantity_of
from stickslip.records import measures, modes, motion_type, saving, segments_and_masks, settling
from stickslip.records.channel import MEASURED, ROLES, Channel
from stickslip.records.record_tables import RecordTables

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from stickslip.records.overview import Overview


#: Sensitivities of sensors, as their data sheets give them, by what they measure.
_SENSITIVITIES = {"velocity": "100 mm/s/V", "absolute velocity": "100 mm/s/V", "position": "1 mm/V", "force": "50 N/V", "load": "50 N/V",
                  "acceleration": "100 mV/g"}  # fmt: skip


@described_as('a Record; type for example ss.read("run.csv")')
@sealed
@dataclass(frozen=True, eq=False, repr=False)
class Record(Drawn, RecordTables):
    """A measured record (or a synthetic one, made by `virtual_rig`). It is never changed; methods return new records.

    Parameters
    ----------
    channels : mapping of str to Channel
    notes : tuple of str
        What a user should know: units that are missing, gaps, damaged lines.
    source : dict
        Its origin: path, format, size and hash of the file, and other information in the file.
    synthetic : bool
        True if no sensor was involved.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(2000) / 2000
    >>> rec = Record.of(t, {"velocity [mm/s]": 5 * np.sin(2 * np.pi * 20 * t) + 2})
    >>> rec["velocity"].unit, round(rec.mean_velocity, 6), round(rec.drive_frequency().value, 6)
    ('mm/s', 0.002, 20.0)
    """

    channels: Mapping[str, Channel]
    notes: tuple[str, ...] = ()
    source: dict[str, Any] = field(default_factory=dict)
    synthetic: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", MappingProxyType(dict(self.channels)))
        object.__setattr__(self, "notes", tuple(self.notes))

    @classmethod
    @explains_arguments
    def of(cls, t: Numbers, columns: Mapping[str, Numbers], roles: dict[str, str] | None = None, synthetic: bool = False) -> Record:
        """A record from arrays: times [s], and columns named with their units, such as ``{"v [m/s]": v}``."""
        from stickslip.basics.units import unit_of_heading
        from stickslip.records.raw import RawColumn
        from stickslip.records.roles import roles_of

        channels = {}
        named = roles_of([RawColumn(*unit_of_heading(text), np.asarray(values)) for text, values in columns.items()], roles or {})
        for text, values in columns.items():
            name, unit = unit_of_heading(text)
            if name in channels:
                raise InputError("Record", [f"columns names {name!r} twice, the second time as {text!r}; give each a name of its own"])
            if np.shape(values) != np.shape(t):
                raise InputError("Record", [f"{name} has shape {np.shape(values)} and t has {np.shape(t)}; give arrays of one length"])
            channels[name] = Channel(name, np.array(values, float), unit, np.array(t, float), "time", "s", named.get(name))
        return cls(channels, (), {"format": "arrays"}, synthetic)

    @explains_arguments
    def __getitem__(self, key: str) -> Channel:
        """The channel of this name, or the only one with this role."""
        if key in self.channels:
            return self.channels[key]
        key = "velocity" if key == "convected velocity" else key
        channels = [c for c in self.channels.values() if c.role == key]
        if len(channels) == 1:
            return channels[0]
        if channels:
            names = ", ".join(repr(c.name) for c in channels)
            typed = f'roles={{"{channels[0].name}": "{key}"}} (--role {channels[0].name}={key})'
            raise InputError(
                "record", [f"{len(channels)} channels may be the {key}: {names}; give the name of one, or type {typed} when reading"]
            )
        raise InputError("record", [self._missing(key)])

    def _missing(self, key: str) -> str:
        names = ", ".join(repr(n) for n in self.channels)
        if key in ROLES:
            said = f"no channel is known to be the {key}; the channels are {names}"
            wanted = MEASURED.get(key, (key,))
            fitting = [c for c in self.channels.values() if quantity_of(c.unit) in wanted]
            bare = [c for c in self.channels.values() if quantity_of(c.unit) is None]
            if fitting:
                return f'{said}; type ss.read(path, roles={{"{fitting[0].name}": "{key}"}}) with the right one'
            volts = [c.name for c in self.channels.values() if quantity_of(c.unit) == "voltage"]
            if volts and not bare:
                typed = f'ss.read(path, scale={{"{volts[0]}": "{_SENSITIVITIES.get(key, "100 mm/s/V")}"}})'
                return f"{said}; {volts[0]!r} is in volts: type {typed} with the sensitivity from the sensor's data sheet"
            if not bare:
                return f"{said}, and none of them is in a unit of {' or '.join(wanted)}; take a record that has one"
            unit = {"position": "mm", "force": "N", "load": "N", "acceleration": "m/s^2", "pressure": "bar", "voltage": "V"}.get(key, "m/s")
            first = bare[0].name
            return f'{said}; type ss.read(path, units={{"{first}": "{unit}"}}, roles={{"{first}": "{key}"}}) with the right one'
        return f"has no channel {key!r}; {did_you_mean(key, [*self.channels, *ROLES])}"

    def __contains__(self, key: str) -> bool:
        return key in self.channels or any(c.role == key for c in self.channels.values())

    def __iter__(self) -> Any:
        return iter(self.channels)

    # ---- new records ----
    def replace(self, **changes: Any) -> Record:
        """A copy with some fields changed."""
        return dataclasses.replace(self, **changes)

    @explains_arguments
    def between(self, start: float, end: float) -> Record:
        """The part from `start` to `end` [s]."""
        cut = {}
        for name, c in self.channels.items():
            keep = (c.time >= start) & (c.time <= end)
            cut[name] = dataclasses.replace(c, values=c.values[keep], t=c.t[keep])
        if not any(len(c) for c in cut.values()):
            raise InputError("record", [f"has no sample between {start:g} and {end:g} s"])
        return self.replace(channels=cut, notes=self._notes_of(cut), source={**self.source, "between": [start, end]})

    def _notes_of(self, part: dict[str, Channel]) -> tuple[str, ...]:
        """The notes, those on gaps and missing values as they are in a part of the record."""
        from stickslip.records.roles import remarks

        with np.errstate(all="ignore"):  # a damaged record holds any number
            of_all, of_part = remarks(list(self.channels.values())), remarks(list(part.values()))
        kept = [note for note in self.notes if note not in of_all]
        return (*kept, *(dict.fromkeys(of_part) if len(kept) < len(self.notes) else ()))

    @explains_arguments
    def derived(self, heading: str, values: Numbers, like: str, role: str | None = None) -> Record:
        """The record with one more channel, computed from others: ``rec.derived("mu [1]", F / N, like="Friction", role="force")``."""
        from stickslip.basics.units import unit_of_heading as split

        name, unit = split(heading)
        made = dataclasses.replace(self[like], name=name, unit=unit, values=np.asarray(values), role=role)
        return self.replace(channels={**self.channels, name: made}, notes=(*self.notes, f"{name} is computed from other channels"))

    def relative_velocity(self) -> Record:
        """The record with the drive's velocity, found as in the paper: absolute velocity of the inner mass minus that of the body."""
        inner, body = self["absolute velocity"], self["velocity"]
        if len(inner) != len(body) or not np.allclose(inner.time, body.time, rtol=0.0, atol=1e-3 / abs(body.rate)):
            raise InputError("record", ["absolute and convected velocity are not sampled at the same times; resample one of them"])
        return self.derived("relative velocity [m/s]", inner.si - body.si, like=body.name, role="drive")

    segments = explains_arguments(segments_and_masks.segments)
    masked = explains_arguments(segments_and_masks.masked)
    averaged = explains_arguments(segments_and_masks.averaged)
    joined = explains_arguments(segments_and_masks.joined)
    save = explains_arguments(saving.save)

    # ---- measures ----
    drive_frequency = explains_arguments(settling.drive_frequency)
    period = explains_arguments(measures.period)
    modes = explains_arguments(modes.modes)

    @property
    def summary(self) -> Overview:
        """Rate, gaps, noise, clipping and drive frequency of every channel, as numbers and as text."""
        from stickslip.records.overview import overview

        return overview(self)

    @explains_arguments
    def settled(self, settle: int | str = "auto", frequency: float | None = None) -> Record:
        """The steady part of the record: without the first `settle` drive periods, "auto" those that differ from the later ones.

        A note says how many were left out.
        """
        kept, _, said = settling.settled(self, settle, frequency)
        return kept if said is None else kept.replace(notes=(*kept.notes, said.partition(" and are not compared")[0]))

    @property
    def mean_velocity(self) -> float:
        """Mean steady velocity over whole drive periods [m/s]; `ss.mean_velocity` takes a frequency."""
        return measures.mean_velocity(self).value

    @cached_property
    def motion(self) -> motion_type.MeasuredMotion:
        """Type and intervals of the mean cycle, and what the noise leaves open; `ss.motion` takes a frequency and thresholds."""
        return motion_type.motion(self)

    @property
    def motion_type(self) -> str:
        """The motion type; if the noise leaves it undecided, the possible ones, such as "I or IV"."""
        return str(self.motion.type)

    @explains_arguments
    def stick_intervals(
        self, frequency: float | None = None, threshold: float | None = None, dwell: float = 0.03
    ) -> tuple[tuple[float, float], ...]:
        """Intervals at rest, as (start, length) in drive periods."""
        m = motion_type.motion(self, frequency, threshold, dwell)
        return tuple((start, length) for start, length, sign in m.intervals if sign == 0)

    @explains_arguments
    def spectrum(self, channel: str = "velocity") -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Amplitude spectrum of a channel: frequencies [Hz] and amplitudes [SI]."""
        from stickslip.records.tones import spectrum

        return spectrum(self[channel])

    def __repr__(self) -> str:
        kind = "synthetic record" if self.synthetic else "Record"
        return f"<{kind}: {', '.join(f'{c.name} [{c.unit or chr(63)}]' for c in self.channels.values())}; {len(self.notes)} notes>"

    _drawn_by = "record"

    def _title(self) -> str:
        return "Synthetic record" if self.synthetic else "Record"

    def _facts(self) -> dict[str, Any]:
        return self.summary.facts

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [self.summary.table]
