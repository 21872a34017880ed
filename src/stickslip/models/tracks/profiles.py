"""Friction that varies along the track: patches, waves, and measured profiles. Each is a factor on the friction at a place."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric, Track
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen, everywhere
from stickslip.basics.maths import cos, maximum, pi, sin, where
from stickslip.basics.quantities import positive, quantity

_MOST = 64  # edges, harmonics or points of a profile: each is a part of the equations
_LEVEL = "type for example track=ss.Level()"
_WAVELENGTH = quantity("wavelength of the track", "m", "L", example=0.01, rule=positive)
_FACTORS = quantity("factor on friction", "1", "f", example=(1.0, 0.2), rule=positive, allowed="a positive factor")


class AroundTrack(Frozen):
    """A track around another one: gravity is that of the track inside."""

    track: Any

    def _check(self, problems: Problems) -> None:
        if isinstance(self.track, type) or not (hasattr(self.track, "across") and hasattr(self.track, "along")):
            problems.add(f"track = {self.track!r}; allowed is a track, an object with across, along; {_LEVEL}")

    def across(self, gravity: Numeric) -> Any:
        """Component of gravity normal to the track [m/s^2]."""
        return self.track.across(gravity)

    def along(self, gravity: Numeric) -> Any:
        """Component of gravity along the track, forwards [m/s^2]."""
        return self.track.along(gravity)


class _Placed(AroundTrack):
    """Base of the tracks whose friction varies along them: friction that varies in time is that of the track inside."""

    @property
    def grip(self) -> Any:
        """Factor on the friction by time, of the track inside; None where there is none."""
        return getattr(self.track, "grip", None)

    def grip_at(self: Any, x: Numeric) -> Any:
        """Factor on the friction at a place [-]."""
        inner, own = place_grip_of(self.track), self._own(x)
        return own if inner is None else own * inner(x)


@dataclass(frozen=True, eq=False)
class FrictionPatches(_Placed):
    r"""A track with patches: between two edges all friction coefficients are multiplied by one factor.

    The factor multiplies the load that the law receives, as in `VaryingFriction`. Edges are events of the exact solver.

    Parameters
    ----------
    track : Level, Incline or any track
        The track that defines gravity.
    edges : tuple of float
        Where patches meet [m], in ascending order; an edge itself belongs to the patch behind it. Patches that repeat have their edges
        within one wavelength.
    factors : tuple of float
        Factor of each patch [-], positive: before the first edge, between edges, and behind the last; of patches that repeat the one
        behind each edge.
    wavelength : float, optional
        Distance after which the patches repeat [m]; without it they do not.

    Examples
    --------
    >>> from stickslip.tracks import Level
    >>> ice = FrictionPatches(Level(), edges=(0.01, 0.02), factors=(1.0, 0.2, 1.0))
    >>> [ice.grip_at(x) for x in (0.0, 0.015, 0.03)]
    [1.0, 0.2, 1.0]
    >>> tiles = FrictionPatches(Level(), edges=(0.0, 0.004), factors=(1.0, 0.5), wavelength=0.01)
    >>> [tiles.grip_at(x) for x in (0.002, 0.007, 0.012, -0.001)]
    [1.0, 0.5, 1.0, 0.5]
    """

    track: Any
    edges: tuple[float, ...] = field(metadata=quantity("edge of a patch", "m", "x", example=(0.01, 0.02)))
    factors: tuple[float, ...] = field(metadata=_FACTORS)
    wavelength: float | None = field(default=None, metadata=_WAVELENGTH)

    def _check(self, problems: Problems) -> None:
        super()._check(problems)
        count, least = len(self.edges), 1 if self.wavelength is None else 2
        wanted = count + (self.wavelength is None)
        if not least <= count <= _MOST:
            problems.add(f"edges has {count} numbers; allowed are {least} to {_MOST}; type edges=(0.01, 0.02)")
        elif len(self.factors) != wanted:
            problems.add(f"factors has {len(self.factors)} numbers for {count} edges; allowed are {wanted}; type factors={(1.0,) * wanted}")
        if not all(everywhere(a < b) for a, b in zip(self.edges, self.edges[1:], strict=False)):
            problems.add(f"edges = {self.edges!r}; allowed are places in ascending order; type edges=(0.01, 0.02)")
        elif self.wavelength is not None and count and not everywhere(self.edges[-1] - self.edges[0] < self.wavelength):
            problems.add(f"edges = {self.edges!r} do not lie within one wavelength of {self.wavelength!r} m; give a longer wavelength")

    def _own(self, x: Numeric) -> Any:
        if self.wavelength is None:
            factor_here = self.factors[0]
            for edge, factor in zip(self.edges, self.factors[1:], strict=True):
                factor_here = where(x >= edge, factor, factor_here)
            return factor_here
        factor_here = self.factors[-1]
        for first, last, factor in zip(self.edges, self.edges[1:], self.factors, strict=False):
            turn = pi / self.wavelength  # each sine changes its sign at its edge and at every wavelength from there: exact near the edge
            factor_here = where(sin(turn * (x - first)) * sin(turn * (last - x)) >= 0, factor, factor_here)
        return factor_here

    def mirrored(self) -> FrictionPatches:
        """The track with forwards and backwards exchanged."""
        edges = tuple(-edge for edge in self.edges[::-1])
        factors = self.factors[::-1] if self.wavelength is None else (*self.factors[-2::-1], self.factors[-1])
        return FrictionPatches(mirrored_track(self.track), edges, factors, self.wavelength)


@dataclass(frozen=True, eq=False)
class FrictionWave(_Placed):
    r"""A track whose friction varies along it as a sum of waves: by :math:`1 + \sum a_k\cos(2\pi kx/L) + b_k\sin(2\pi kx/L)`.

    Parameters
    ----------
    track : Level, Incline or any track
        The track that defines gravity.
    wavelength : float
        L, after which the friction repeats [m].
    cosines, sines : tuple of float
        a_1, a_2, … and b_1, b_2, … [-]; as many of one as of the other. The factor must stay positive.

    Examples
    --------
    >>> from stickslip.tracks import Level
    >>> track = FrictionWave(Level(), wavelength=0.01, cosines=(0.0,), sines=(0.3,))
    >>> round(track.grip_at(0.0025), 12), round(track.grip_at(0.0125), 12)
    (1.3, 1.3)
    """

    track: Any
    wavelength: float = field(metadata=_WAVELENGTH)
    cosines: tuple[float, ...] = field(metadata=quantity("coefficients of the cosines", "1", "a", example=(0.0, 0.1)))
    sines: tuple[float, ...] = field(metadata=quantity("coefficients of the sines", "1", "b", example=(0.3, 0.0)))

    def _check(self, problems: Problems) -> None:
        import numpy as np

        super()._check(problems)
        count = len(self.cosines)
        if count != len(self.sines) or not 1 <= count <= _MOST:
            counts = f"{count} cosines and {len(self.sines)} sines"
            problems.add(f"{counts}; allowed are as many of one as of the other, 1 to {_MOST}; type cosines=(0.0,), sines=(0.3,)")
            return
        points = np.linspace(0.0, 1.0, 64 * count, endpoint=False)
        least = np.min(
            sum(
                (
                    a[..., None] * np.cos(2 * np.pi * k * points) + b[..., None] * np.sin(2 * np.pi * k * points)
                    for k, (a, b) in enumerate(zip(*map(_arrays, (self.cosines, self.sines)), strict=True), 1)
                ),
                1.0,
            )
        )
        if not least > 0:
            problems.add(f"the factor falls to {least:.4g}; allowed is a factor that stays positive; make cosines and sines smaller")

    def _own(self, x: Numeric) -> Any:
        angle, factor = 2 * pi / self.wavelength * x, 1.0
        for k, (a, b) in enumerate(zip(self.cosines, self.sines, strict=True), 1):
            factor = factor + a * cos(k * angle) + b * sin(k * angle)
        return factor

    @classmethod
    def fitted(cls, track: Track, place: Any, factor: Numeric, wavelength: float, harmonics: int = 8) -> FrictionWave:
        """The wave that fits measured factors best, by least squares, over its mean.

        Parameters
        ----------
        track : track
            The track that defines gravity.
        place, factor : array (n,)
            Where it was measured [m], and friction there in any unit, positive.
        wavelength : float
            After which the track repeats [m].
        harmonics : int
            Number of harmonics; at least 2 harmonics + 1 measured points.

        Examples
        --------
        >>> import numpy as np
        >>> from stickslip.tracks import Level
        >>> x = np.linspace(0.0, 0.02, 50)
        >>> found = FrictionWave.fitted(Level(), x, 0.2 + 0.05 * np.sin(2 * np.pi * x / 0.01), wavelength=0.01, harmonics=1)
        >>> [round(b, 9) for b in found.sines]
        [0.25]
        """
        import numpy as np

        x, y = np.ravel(np.asarray(place, float)), np.ravel(np.asarray(factor, float))
        problems = Problems("FrictionWave.fitted")
        problems.whole("harmonics", harmonics, 1, example=8, most=_MOST)
        if not problems.mistakes and (len(x) != len(y) or len(x) < 2 * harmonics + 1 or not np.isfinite([x, y]).all()):
            problems.add(f"{len(x)} places and {len(y)} factors; allowed are as many finite numbers of each, {2 * harmonics + 1} or more")
        problems.check()
        angle = 2 * np.pi * np.outer(x, np.arange(1, harmonics + 1)) / wavelength
        mean, *waves = np.linalg.lstsq(np.hstack([np.ones((len(x), 1)), np.cos(angle), np.sin(angle)]), y, rcond=None)[0]
        parts = np.array(waves) / mean
        return cls(track, wavelength, tuple(map(float, parts[:harmonics])), tuple(map(float, parts[harmonics:])))

    def mirrored(self) -> FrictionWave:
        """The track with forwards and backwards exchanged."""
        return FrictionWave(mirrored_track(self.track), self.wavelength, self.cosines, tuple(-b for b in self.sines))


@dataclass(frozen=True, eq=False)
class FrictionProfile(_Placed):
    """A track whose friction was measured at some positions: linear between them, and constant before the first and after the last.

    Parameters
    ----------
    track : Level, Incline or any track
        The track that defines gravity.
    place : tuple of float
        Where it was measured [m], in ascending order, 2 to 64 of them. Each is a corner, and an event of the exact solver.
    factors : tuple of float
        Factor on the friction coefficients there [-], positive.

    Examples
    --------
    >>> from stickslip.tracks import Level
    >>> track = FrictionProfile(Level(), place=(0.0, 0.01, 0.02), factors=(1.0, 2.0, 1.5))
    >>> [round(track.grip_at(x), 12) for x in (-0.01, 0.005, 0.015, 0.03)]
    [1.0, 1.5, 1.75, 1.5]
    """

    track: Any
    place: tuple[float, ...] = field(metadata=quantity("place along the track", "m", "x", example=(0.0, 0.01, 0.02)))
    factors: tuple[float, ...] = field(metadata=_FACTORS)

    def _check(self, problems: Problems) -> None:
        super()._check(problems)
        count = len(self.place)
        if count != len(self.factors) or not 2 <= count <= _MOST:
            counts = f"{count} places and {len(self.factors)} factors"
            problems.add(f"{counts}; allowed are as many of one as of the other, 2 to {_MOST}; type place=(0.0, 0.01), factors=(1.0, 1.2)")
        if not all(everywhere(a < b) for a, b in zip(self.place, self.place[1:], strict=False)):
            problems.add(f"place = {self.place!r}; allowed are places in ascending order; type place=(0.0, 0.01)")

    def _own(self, x: Numeric) -> Any:
        factor, before = self.factors[0], 0.0
        for a, b, low, high in zip(self.place, self.place[1:], self.factors, self.factors[1:], strict=False):
            slope = (high - low) / (b - a)
            factor = factor + (slope - before) * maximum(x - a, 0.0)
            before = slope
        return factor - before * maximum(x - self.place[-1], 0.0)

    def mirrored(self) -> FrictionProfile:
        """The track with forwards and backwards exchanged."""
        return FrictionProfile(mirrored_track(self.track), tuple(-x for x in self.place[::-1]), self.factors[::-1])


def _arrays(values: tuple[Any, ...]) -> list[Any]:
    import numpy as np

    return [np.asarray(value, float) for value in values]


def place_grip_of(track: Track) -> Any:
    """The factor on the friction of a track as a function of the place; None where friction does not vary along it."""
    return getattr(track, "grip_at", None)


def mirrored_track(track: Any) -> Any:
    """A track with forwards and backwards, and so downhill and uphill, exchanged."""
    if hasattr(track, "mirrored"):
        return track.mirrored()
    if hasattr(track, "track"):
        return dataclasses.replace(track, track=mirrored_track(track.track))
    return dataclasses.replace(track, tilt=-track.tilt) if hasattr(track, "tilt") else track
