"""Robots drawn at random over every set-valued law and every drive: what exact solvers are measured with."""

from __future__ import annotations

import math

import numpy as np

import stickslip as ss
from registries import examples
from stickslip.basics.fields import leaves
from stickslip.models.friction.law_adapter import adapted

EXPONENTS = (0.5, 1.0, 1.5, 2.0, 3.0)
DRIVES = tuple(ss.drives.DRIVES)
LAWS = (*(name for name, law in examples(ss.friction.LAWS).items() if not adapted(law).dynamic), "sum")


def drive(rng, name):
    """A drive of some strength and some hertz."""
    amplitude, omega = 10 ** rng.uniform(-5, -3), 2 * math.pi * 10 ** rng.uniform(0.5, 2.5)
    period, speed = 2 * math.pi / omega, amplitude * omega
    match name:
        case "harmonic":
            return ss.Harmonic(amplitude, omega=omega)
        case "multiharmonic":
            return ss.MultiHarmonic(
                omega=omega, amplitudes=(amplitude, amplitude * rng.uniform(0.1, 0.5)), phases=(0.0, rng.uniform(-math.pi, math.pi))
            )
        case "recorded":
            parts = amplitude * rng.uniform(-1, 1, 5) / np.arange(1, 6) ** 2
            return ss.drives.Recorded(period=period, cosines=(0.0,) * 5, sines=tuple(map(float, parts)))
        case "twophase":
            return ss.drives.TwoPhase(stroke=amplitude, u1=speed * rng.uniform(0.2, 0.5), u2=speed * rng.uniform(0.5, 2))
        case "threephase":
            return ss.drives.ThreePhase(
                u1=speed, w1=speed * omega * rng.uniform(0.2, 0.5), w2=speed * omega, w3=speed * omega * rng.uniform(0.3, 0.6)
            )
        case "bangbang":
            return ss.drives.BangBang(a1=speed * omega * rng.uniform(0.2, 0.5), a2=speed * omega, period=period)
        case "pieces":
            d, a = period * rng.dirichlet(np.full(4, 3.0)), speed * omega * rng.uniform(-1, 1, 4)
            return ss.drives.Pieces(durations=tuple(map(float, d)), accelerations=tuple(map(float, a - (a @ d) / period)))
        case "sawtooth":
            return ss.drives.Sawtooth(stroke=amplitude, rise=period * rng.uniform(0.5, 0.9), fall=period * rng.uniform(0.1, 0.5))
        case "trapezoid":
            return ss.drives.Trapezoid(u1=speed * rng.uniform(0.1, 0.4), u2=speed, ramp=period * rng.uniform(0.02, 0.08), period=period)
        case "verticalvibration":
            return ss.drives.VerticalVibration(
                drive=ss.Harmonic(amplitude, omega=omega),
                amplitude=0.3 * 9.81 / omega**2,
                phase=rng.uniform(0, 3),
                harmonic=int(rng.integers(1, 3)),
            )
        case "reversed":
            return ss.drives.Reversed(drive=drive(rng, "trapezoid"))
    return ss.drives.DRIVES[name].example()  # of a drive that nobody draws numbers for


def law(rng, name, grip, speed, exponent):
    """A law whose friction coefficients are some parts of `grip` and whose velocities are parts of `speed`; `viscous` is per newton."""
    mu = grip * 10 ** rng.uniform(-1.2, -0.05, 2)
    f = mu * rng.uniform(1, 1.5, 2)
    v_s = speed * 10 ** rng.uniform(-2.3, -0.5)
    oil = grip / speed * 10 ** rng.uniform(-2, 0)
    sides = dict(mu_plus=mu[0], mu_minus=mu[1], f_plus=f[0], f_minus=f[1])
    match name:
        case "coulomb":
            return ss.Coulomb(**sides)
        case "viscous":
            return ss.Viscous(viscous_plus=oil, viscous_minus=1.3 * oil, quadratic_plus=oil / speed, quadratic_minus=0.0)
        case "coulombviscous":
            return ss.CoulombViscous(**sides, viscous=oil, quadratic=oil / speed)
        case "stribeck":
            return ss.Stribeck(**sides, v_s=v_s, exponent=exponent, viscous=0.1 * oil)
        case "tabulated":
            knots = tuple(float(v) for v in v_s * np.array([0.0, 1.0, 3.0, 10.0, 40.0]))
            fade = np.array([1.4, 1.2, 1.05, 1.0, 1.1])
            return ss.friction.Tabulated(speed=knots, mu_plus=tuple(map(float, mu[0] * fade)), mu_minus=tuple(map(float, mu[1] * fade)))
        case "sum":
            return law(rng, "stribeck", grip, speed, exponent) + law(rng, "viscous", grip, speed, exponent)
    made = ss.friction.LAWS[name].example()  # of a law that nobody draws numbers for, but for those that others have too
    return made.replace(**{n: value for n, value in {**sides, "v_s": v_s, "viscous": oil}.items() if hasattr(made, n)})


def robot(i, seed=12):
    """The i-th robot: laws in turn, drives in turn more slowly, exponents still more slowly; everything else by chance."""
    rng = np.random.default_rng((seed, i))
    name, shaken = LAWS[i % len(LAWS)], DRIVES[i // len(LAWS) % len(DRIVES)]
    exponent = EXPONENTS[(i // len(LAWS) // len(DRIVES) + i % len(LAWS)) % len(EXPONENTS)]
    inner = 10 ** rng.uniform(-5, -2)
    body = inner * 10 ** rng.uniform(0.2, 1.8)
    moved = drive(rng, shaken)
    frame = ss.Robot(body, inner, moved, ss.Coulomb(mu_plus=0.1, mu_minus=0.1), track=ss.Incline(0.0))
    speed = float(frame.velocity_scale * frame.mass_ratio)
    grip = speed * 2 * math.pi / float(frame.period) / 9.81  # friction that holds against the drive
    rubs = law(rng, name, grip, speed, exponent)
    scaled = {n: v * frame.total_mass * 9.81 for n, v in leaves(rubs) if n.split(".")[-1].startswith(("viscous", "quadratic"))}
    frame = frame.replace({"track.tilt": min(grip, 1.0) * rng.uniform(-0.1, 0.1) * int(rng.integers(2))})
    return frame.replace(friction=rubs.replace(**scaled) if name != "sum" else rubs.replace(scaled))


def unit(robot):
    """A mu: how far the body would swing without friction [m]."""
    return float(robot.velocity_scale * robot.mass_ratio * robot.period) / (2 * math.pi)
