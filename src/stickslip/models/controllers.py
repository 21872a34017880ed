"""States of a machine's controllers: integrated states, and numbers set at sampling instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate, pairwise
from typing import Any

from stickslip.basics.contracts import Numeric

Named = Mapping[str, Any]
#: Attributes of a controller. The positions x and velocities v are given by the names of the bodies, z are its own states; all may
#: be floats, arrays of cases, or symbols while equations are traced. ``states`` are the names of its states, ``scales`` a typical size of
#: each, positive; ``sample`` is the time between its samples, which are at 0, dt, 2 dt, … [s], or None if it acts continuously;
#: ``start(t, x, v)`` are its states when it is switched on, a sample at that instant included, ``rates(t, x, v, z)`` their rates between
#: samples (0 where a state is held), ``sampled(t, x, v, z)`` the states after a sample, ``forces(t, x, v, z)`` forces on bodies by name.
NEEDS = ("states", "sample", "scales", "start", "rates", "sampled", "forces")


class Controllers:
    """All controllers of a machine; z are their states, one controller after another.

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
        self.states = tuple(tuple(part.states) for part in self.parts.values())
        self.counts = tuple(map(len, self.states))
        self.count = sum(self.counts)
        self._borders = tuple(pairwise(accumulate(self.counts, initial=0)))

    @property
    def sample(self) -> Any:
        """The time between samples of the first sampled controller [s]; None if all act continuously."""
        return next((part.sample for part in self.parts.values() if part.sample is not None), None)

    @property
    def scales(self) -> tuple[Any, ...]:
        """A typical size of each state."""
        return tuple(size for part in self.parts.values() for size in part.scales)

    def start(self, t: Numeric, x: Named, v: Named) -> tuple[Any, ...]:
        """Their states when they are switched on."""
        return tuple(value for part in self.parts.values() for value in part.start(t, x, v))

    def rates(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> tuple[Any, ...]:
        """Rates of their states between samples."""
        return tuple(rate for part, own in self._owned(z) for rate in part.rates(t, x, v, own))

    def sampled(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> tuple[Any, ...]:
        """Their states after a sample; those of a continuous controller are unchanged."""
        return tuple(value for part, own in self._owned(z) for value in (own if part.sample is None else part.sampled(t, x, v, own)))

    def forces(self, t: Numeric, x: Named, v: Named, z: Sequence[Any]) -> list[tuple[str, Any]]:
        """Each force with the body that it acts on."""
        return [pair for part, own in self._owned(z) for pair in part.forces(t, x, v, own).items()]

    def _owned(self, z: Sequence[Any]) -> list[tuple[Any, tuple[Any, ...]]]:
        return [(part, tuple(z[first:last])) for part, (first, last) in zip(self.parts.values(), self._borders, strict=True)]


NO_CONTROLLERS = Controllers({})
