"""States of a machine's controllers: integrated states, and numbers set at sampling instants."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from itertools import accumulate, pairwise
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import minimum, where
from stickslip.models.instant_forces import parts_of_forces

Named = Mapping[str, Any]
#: Attributes of a controller. The positions x and velocities v are given by the names of the bodies, z are its own states; all may
#: be floats, arrays of cases, or symbols while equations are traced. ``states`` are the names of its states, ``scales`` a typical size of
#: each, positive; ``sample`` is the time between its samples, which are at 0, dt, 2 dt, … [s], or None if it acts continuously;
#: ``start(t, x, v)`` are its states when it is switched on, a sample at that instant included, ``rates(t, x, v, z)`` their rates between
#: samples (0 where a state is held), ``sampled(t, x, v, z)`` the states after a sample, ``forces(t, x, v, z)`` forces on bodies by name.
#: Of several controllers that sample each has one state more, `TICKS`: how many samples of the fastest have passed since its own last one.
NEEDS = ("states", "sample", "scales", "start", "rates", "sampled", "forces")


TICKS = "ticks"


class Controllers:
    """All controllers of a machine; z are their states, one controller after another.

    Several that sample do so at multiples of the shortest of their times: each counts how many of those have passed since its last sample.

    Examples
    --------
    >>> import stickslip as ss
    >>> servo = ss.Joint.example().mechanics.controllers
    >>> servo.names, servo.counts, servo.count
    (('control',), (1,), 1)
    """

    def __init__(self, parts: Mapping[str, Any]):
        self.parts = dict(parts)
        self.names = tuple(self.parts)
        sampling = [name for name, part in self.parts.items() if part.sample is not None]
        self._counting = frozenset(sampling if len(sampling) > 1 else ())
        self.states = tuple((*part.states, *((TICKS,) if name in self._counting else ())) for name, part in self.parts.items())
        self.counts = tuple(map(len, self.states))
        self.count = sum(self.counts)
        self._borders = tuple(pairwise(accumulate(self.counts, initial=0)))

    @property
    def sample(self) -> Any:
        """The shortest time between samples of a controller [s]; None if all act continuously."""
        times = [part.sample for part in self.parts.values() if part.sample is not None]
        return reduce(minimum, times) if times else None

    @property
    def scales(self) -> tuple[Any, ...]:
        """A typical size of each state."""
        return self._with_ticks(lambda part: part.scales, 1.0)

    def start(self, t: Numeric, x: Named, v: Named) -> tuple[Any, ...]:
        """Their states when they are switched on."""
        return self._with_ticks(lambda part: part.start(t, x, v), 0.0)

    def rates(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> tuple[Any, ...]:
        """Rates of their states between samples."""
        return tuple(rate for _, part, own, ticks in self._owned(z) for rate in (*part.rates(t, x, v, own), *(0.0 for _ in ticks)))

    def sampled(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> tuple[Any, ...]:
        """Their states after a sample; those of a continuous controller are unchanged."""
        new: list[Any] = []
        for _, part, own, ticks in self._owned(z):
            if part.sample is None:
                new += own
            elif not ticks:
                new += part.sampled(t, x, v, own)
            else:
                due = ticks[0] > part.sample / self.sample - 1.5  # this one is as many as are between its own
                new += [where(due, after, before) for after, before in zip(part.sampled(t, x, v, own), own, strict=True)]
                new.append(where(due, 0.0, ticks[0] + 1.0))
        return tuple(new)

    def forces(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> list[tuple[str, Any]]:
        """Each force with the body that it acts on."""
        own = (forces.items() for _, forces in self.forces_by_name(t, x, v, z))
        return [(body, force) for forces in own for body, _, force in parts_of_forces(forces)]

    def forces_by_name(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> list[tuple[str, Named]]:
        """Forces on bodies by the name of the controller."""
        return [(name, part.forces(t, x, v, own)) for name, part, own, _ in self._owned(z)]

    def _owned(self, z: Sequence[Any]) -> list[tuple[str, Any, tuple[Any, ...], tuple[Any, ...]]]:
        """Each controller by its name, with its own states, and its count of ticks where it has one."""
        owned = []
        for (name, part), (first, last) in zip(self.parts.items(), self._borders, strict=True):
            own, counts = tuple(z[first:last]), int(name in self._counting)
            owned.append((name, part, own[: len(own) - counts], own[len(own) - counts :]))
        return owned

    def _with_ticks(self, values: Callable[[Any], Sequence[Any]], ticks: float) -> tuple[Any, ...]:
        """What all controllers have of something, with the same of their counts."""
        return tuple(value for name, part in self.parts.items() for value in (*values(part), *((ticks,) if name in self._counting else ())))


NO_CONTROLLERS = Controllers({})
