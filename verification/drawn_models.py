"""Random robots and mechanisms of given kinds: every law, drive, track and mechanism, two decades wide in most of their numbers.

What is drawn are ratios: friction over the force of the drive, the Stribeck velocity over the velocity that the drive gives to a free
body, the deflection at which a bristle slides over the way of that body. So most of them move, and few are all of one sort.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.basics.fields import replace_leaf
from stickslip.mechanisms import MECHANISMS
from stickslip.models.mechanics import lists_parts

Array = Any  # numpy.ndarray


@dataclass(frozen=True)
class Kind:
    """What a batch shares: which law (or sum), and which drive and track, or which mechanism."""

    law: str
    drive: str = ""
    track: str = ""
    mechanism: str = ""
    number: int = 0

    def __str__(self) -> str:
        return f"{self.law} · {self.mechanism or f'{self.drive} · {self.track}'}"


@dataclass(frozen=True)
class Draw:
    """Generators of what a kind is and of its numbers, how many cases to draw, and their sizes."""

    choice: Any
    rng: Any
    count: int
    load: Array = 1.0
    mass: Array = 1.0
    velocity: Array = 1.0  # of the body if it were free [m/s]
    omega: Array = 1.0
    mu: Array = 1.0
    bend: Array = 1.0  # deflection at which a bristle slides [m]
    least: Array = 1.0  # part of the load that is always there

    def uniform(self, low: float, high: float) -> Array:
        return self.rng.uniform(low, high, self.count)

    def wide(self, low: float, high: float) -> Array:
        """Uniform on a scale of logarithms."""
        return np.exp(self.uniform(np.log(low), np.log(high)))

    @property
    def force(self) -> Array:
        """What moves the body, in size [N]."""
        return self.mass * self.velocity * self.omega

    def sometimes(self, value: Array) -> Array:
        """A value in four cases of five, else zero."""
        return np.where(self.uniform(0, 1) < 0.2, 0.0, value)

    def shares(self, parts: int) -> tuple[Array, ...]:
        """Positive numbers that sum to one."""
        found = self.rng.uniform(0.2, 1.0, (parts, self.count))
        return tuple(found / found.sum(axis=0))

    def some(self, value: Callable[[], Any]) -> Any:
        """A value, or None for the whole kind."""
        return None if self.choice.random() < 0.3 else value()


# laws --------------------------------------------------------------------------------------------------------------


def _exponent(d: Draw) -> Array:
    """Half the cases 1 or 2, which laws write down in their own way, half of them anything from 1/2 to 3."""
    return np.where(d.uniform(0, 1) < 0.5, d.rng.integers(1, 3, d.count).astype(float), d.uniform(0.5, 3.0))


#: How a number of a law is drawn, by its name; those that follow from others are in `law_of`.
NUMBERS: dict[str, Callable[[Draw], Any]] = {
    "v_s": lambda d: d.velocity * d.wide(3e-3, 1.0),
    "width": lambda d: d.velocity * d.wide(1e-3, 0.1),
    "exponent": _exponent,
    "sigma0": lambda d: d.mu * d.load / d.bend,
    "sigma1": lambda d: np.sqrt(d.mu * d.load / d.bend * d.mass) * d.wide(0.1, 2.0),
    "sigma2": lambda d: d.force / d.velocity * d.wide(1e-3, 0.5),
    "attraction": lambda d: d.mu * d.load * d.omega * d.wide(1.0, 100.0),
    "z_ba": lambda d: d.bend * d.least * d.uniform(0.1, 0.8),  # or the contact were elastic where it should slide
    "z_ba_minus": lambda d: d.some(lambda: d.bend * d.least * d.uniform(0.1, 0.8)),
    "mu0": lambda d: d.mu,
    "a": lambda d: d.mu * d.wide(0.02, 0.1),
    "b": lambda d: d.mu * d.wide(0.02, 0.2),
    "Dc": lambda d: d.bend,
    "v0": lambda d: d.velocity * d.wide(3e-3, 1.0),
    "evolution": lambda d: str(d.choice.choice(["aging", "slip"])),
    "bristles": lambda d: int(d.choice.integers(3, 9)),
    "seed": lambda d: int(d.choice.integers(100)),
    **dict.fromkeys(("viscous", "viscous_plus", "viscous_minus"), lambda d: d.force / d.velocity * d.sometimes(d.wide(1e-3, 0.5))),
    **dict.fromkeys(("quadratic", "quadratic_plus", "quadratic_minus"), lambda d: d.force / d.velocity**2 * d.wide(1e-3, 0.5)),
}  # fmt: skip
SUMS = {
    "stribeck+viscous": ("stribeck", "viscous"),
    "lugre+viscous": ("lugre", "viscous"),
    "gms+viscous": ("gms", "viscous"),
    "tabulated+coulomb": ("tabulated", "coulomb"),
}
LAW_NAMES = (*ss.friction.LAWS, *SUMS)


def law_of(name: str, d: Draw) -> Any:
    """A law of this name with drawn numbers."""
    if name in SUMS:
        first, second = (law_of(part, d) for part in SUMS[name])
        return first + second
    kind = ss.friction.LAWS[name]
    names = [f.name for f in dataclasses.fields(kind)]
    given = _table(d) if "speed" in names else _coefficients(d, names)
    if "weights" in names:
        parts = int(d.choice.integers(1, 5))
        given |= {"stiffness": d.shares(parts), "weights": d.shares(parts)}
    return kind(**given, **{n: NUMBERS[n](d) for n in names if n not in given})


def _coefficients(d: Draw, names: list[str]) -> dict[str, Any]:
    """Friction coefficients: backwards from as much to twice as much as forwards, static up to 1.6 times as much as kinetic."""
    mu = {"plus": d.mu, "minus": d.mu * np.where(d.uniform(0, 1) < 0.3, 1.0, d.uniform(1.0, 2.0))}
    found = {f"mu_{side}": value for side, value in mu.items() if f"mu_{side}" in names}
    if "f_plus" in names:
        found |= {f"f_{side}": d.some(lambda v=value: v * d.uniform(1.0, 1.6)) for side, value in mu.items()}
    return found


def _table(d: Draw) -> dict[str, Any]:
    knots = int(d.choice.integers(2, 7))
    speed = np.cumsum([d.velocity * d.wide(3e-3, 0.5) for _ in range(knots)], axis=0)
    sides = {side: tuple(d.mu * d.uniform(0.7, 1.5) for _ in range(knots)) for side in ("plus", "minus")}
    first = 0.0 * d.velocity if d.choice.random() < 0.7 else speed[0]
    static = {f"f_{side}": d.some(lambda m=mu[0]: m * d.uniform(1.0, 1.4)) for side, mu in sides.items()}
    return {"speed": (first, *speed[1:]), "mu_plus": sides["plus"], "mu_minus": sides["minus"], **static}


# drives and tracks -------------------------------------------------------------------------------------------------


def _sums_of_harmonics(d: Draw, parts: int) -> tuple[Array, ...]:
    return tuple(5e-4 * d.wide(0.1, 1.0) / (k + 1) * np.sign(d.uniform(-1, 1)) for k in range(parts))


def _harmonic(d: Draw) -> Any:
    return ss.Harmonic(amplitude=5e-4 * d.wide(0.1, 10), omega=205.0 * d.wide(0.1, 10))


def _multi(d: Draw) -> Any:
    parts = int(d.choice.integers(2, 4))
    return ss.MultiHarmonic(
        omega=205.0 * d.wide(0.1, 10), amplitudes=_sums_of_harmonics(d, parts), phases=tuple(d.uniform(0, 6.28) for _ in range(parts))
    )


def _two_phase(d: Draw) -> Any:
    u1 = 0.05 * d.wide(0.1, 10)
    return ss.drives.TwoPhase(stroke=1e-2 * d.wide(0.1, 10), u1=u1, u2=u1 * d.wide(0.3, 10))


def _three_phase(d: Draw) -> Any:
    w1 = 10.0 * d.wide(0.1, 10)
    return ss.drives.ThreePhase(u1=0.1 * d.wide(0.1, 10), w1=w1, w2=w1 * d.wide(0.5, 10), w3=w1 * d.wide(0.3, 3))


def _bang_bang(d: Draw) -> Any:
    a1 = 20.0 * d.wide(0.1, 10)
    return ss.drives.BangBang(a1=a1, a2=a1 * d.wide(0.3, 5), period=0.03 * d.wide(0.1, 10))


def _pieces(d: Draw) -> Any:
    parts, period = int(d.choice.integers(2, 6)), 0.05 * d.wide(0.1, 10)
    shares = d.choice.dirichlet(np.full(parts, 3.0))
    strengths = [20.0 * d.uniform(-1.0, 1.0) * d.wide(0.3, 3) for _ in range(parts)]
    mean = sum(s * a for s, a in zip(shares, strengths, strict=True))
    return ss.drives.Pieces(durations=tuple(s * period for s in shares), accelerations=tuple(a - mean for a in strengths))


def _sawtooth(d: Draw) -> Any:
    period, part = 0.1 * d.wide(0.1, 10), d.uniform(0.5, 0.95)
    return ss.drives.Sawtooth(stroke=1e-2 * d.wide(0.1, 10), rise=part * period, fall=(1 - part) * period)


def _trapezoid(d: Draw) -> Any:
    u1, period = 0.05 * d.wide(0.1, 10), 0.1 * d.wide(0.1, 10)
    u2 = u1 * d.wide(0.3, 8)
    return ss.drives.Trapezoid(u1=u1, u2=u2, ramp=period * np.minimum(u1, u2) / (u1 + u2) * d.uniform(0.1, 0.95), period=period)


def _recorded(d: Draw) -> Any:
    parts = int(d.choice.integers(1, 5))
    return ss.drives.Recorded(period=0.03 * d.wide(0.1, 10), cosines=_sums_of_harmonics(d, parts), sines=_sums_of_harmonics(d, parts))


def _vertical(d: Draw) -> Any:
    """Mostly one vertical vibration, for every third kind one inside another; some take the body off the track."""
    drive, n = drive_of(str(d.choice.choice(["harmonic", "harmonic", "twophase", "trapezoid"])), d), int(d.choice.integers(1, 3))
    for _ in range(1 if d.choice.random() < 0.67 else 2):
        depth = d.uniform(0.0, 0.55)  # of the weight of the inner mass; its share is up to one half
        amplitude = depth * 9.81 / (n * 2 * np.pi / drive.period) ** 2
        drive = ss.drives.VerticalVibration(drive, amplitude=amplitude, phase=d.uniform(0, 6.28), harmonic=n)
    return drive


def _reversed(d: Draw) -> Any:
    return ss.drives.Reversed(drive_of(str(d.choice.choice([name for name in DRIVES if name != "reversed"])), d))


DRIVES: dict[str, Callable[[Draw], Any]] = {
    "harmonic": _harmonic, "multiharmonic": _multi, "twophase": _two_phase, "threephase": _three_phase, "bangbang": _bang_bang,
    "pieces": _pieces, "sawtooth": _sawtooth, "trapezoid": _trapezoid, "recorded": _recorded, "verticalvibration": _vertical,
    "reversed": _reversed,
}  # fmt: skip
TRACKS = ("level", "incline", "varying friction", "varying friction on an incline")


def drive_of(name: str, d: Draw) -> Any:
    """A drive of this name."""
    return DRIVES[name](d)


def track_of(name: str, d: Draw) -> Any:
    """A track; on one in a hundred inclines the body slides down by itself."""
    track = ss.Incline(tilt=np.arctan(d.mu * d.uniform(-1.01, 1.01))) if "incline" in name else ss.Level()
    if "varying" not in name:
        return track
    return ss.tracks.VaryingFriction(track, depth=d.uniform(0.0, 0.95), harmonic=int(d.choice.integers(1, 4)), phase=d.uniform(0, 6.28))


# models ------------------------------------------------------------------------------------------------------------


def model_of(kind: Kind, count: int, seed: int) -> Any:
    """A batch of one kind: the same for the same arguments, and the same kind for any count."""
    d = Draw(np.random.default_rng([seed, kind.number, 1]), np.random.default_rng([seed, kind.number]), count)
    return _mechanism(kind, d) if kind.mechanism else _robot(kind, d)


def _sized(d: Draw, mass: Array, velocity: Array, omega: Array, load: Array) -> Draw:
    """Friction from a hundredth of the force of the drive to more than it can overcome; bristles from soft to stiff."""
    mu = d.wide(0.01, 1.3) * mass * velocity * omega / load
    return dataclasses.replace(d, mass=mass, velocity=velocity, omega=omega, load=load, mu=mu, bend=velocity / omega * d.wide(1e-3, 3e-2))


def _robot(kind: Kind, d: Draw) -> Any:
    total, ratio, drive = 0.07 * d.wide(0.1, 10), d.wide(0.01, 0.5), drive_of(kind.drive, d)
    gravity = 9.81 if d.choice.random() < 0.8 else 9.81 * d.wide(0.1, 2.0)
    d = _sized(d, total, ratio * drive.velocity_scale, 2 * np.pi / drive.period, total * gravity)
    track = track_of(kind.track, d)
    lifts = getattr(drive, "vertical_acceleration", None) is not None
    d = dataclasses.replace(d, least=(1.0 - getattr(track, "depth", 0.0)) * (0.4 if lifts else 1.0))
    law = law_of(kind.law, d)
    return ss.Robot(body_mass=total * (1 - ratio), inner_mass=total * ratio, gravity=gravity, drive=drive, friction=law, track=track)


def _mechanism(kind: Kind, d: Draw) -> Any:
    mass, omega, load = d.wide(0.1, 10), d.wide(0.1, 10), d.wide(0.1, 10)
    velocity, made = d.wide(0.01, 1.0), MECHANISMS[kind.mechanism]
    damping = mass * omega * np.where(d.uniform(0, 1) < 0.3, 0.0, d.wide(1e-3, 0.3))
    sized = _sized(d, mass, velocity, omega, load)
    own = {"stiffness": mass * omega**2, "mass": mass, "damping": damping, "load": load, "friction": law_of(kind.law, sized)}
    if kind.mechanism == "forced_oscillator":
        force = sized.force
        return made(
            **own, force=force, omega=omega * d.wide(0.3, 3), bias=force * np.where(d.uniform(0, 1) < 0.5, 0.0, d.uniform(-0.5, 0.5))
        )
    return made(**own, speed=velocity * np.where(d.uniform(0, 1) < 0.2, -1.0, 1.0))


# kinds -------------------------------------------------------------------------------------------------------------


def kinds(count: int = 120, least: int = 6, seed: int = 1) -> list[Kind]:
    """Kinds in which every law, drive, track and bench occurs at least `least` times, if there are enough of them."""
    rng = np.random.default_rng(seed)
    benches = [name for name, made in MECHANISMS.items() if not lists_parts(made) for _ in range(least)]
    robots = max(count - len(benches), 0)
    laws, drives, tracks = (_deck(rng, names, robots) for names in (LAW_NAMES, tuple(DRIVES), TRACKS))
    found = [Kind(law, drive, track) for law, drive, track in zip(laws, drives, tracks, strict=True)]
    found += [Kind(law, mechanism=bench) for law, bench in zip(_deck(rng, LAW_NAMES, len(benches)), benches, strict=True)]
    return [dataclasses.replace(kind, number=k) for k, kind in enumerate(found[:count])]


def _deck(rng: Any, names: tuple[str, ...], count: int) -> list[str]:
    """Names in random order, each as often as the others to within one."""
    return [str(name) for _ in range(-(-count // len(names))) for name in rng.permutation(names)][:count]


def case_of(kind: Kind, seed: int, numbers: dict[str, float]) -> Any:
    """One model of a kind with given numbers: to look at a case again."""
    return replace_leaf(model_of(kind, 1, seed), numbers)
