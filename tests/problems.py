"""Problems with known answers. Every number is derived twice, by two methods (see docs/truth.md for how)."""

from __future__ import annotations

import math

import stickslip as ss

#: LuGre runs of the paper's rig from rest, mean velocity over periods 100 to 200 [m/s]: name -> (preset arguments, V).
#: P5 never slides. P10 is the true incline with isotropic LuGre.
LUGRE = {
    "P1": (dict(tilt_deg=1.7, amplitude=0.5525e-3), 0.001741322),
    "P2": (dict(tilt_deg=2.7, amplitude=0.6032e-3), 0.003681683),
    "P3": (dict(tilt_deg=4.7, amplitude=0.4564e-3), 0.003695830),
    "P4": (dict(tilt_deg=5.7, amplitude=1.487e-3), 0.028110215),
    "P6 3e-4": (dict(tilt_deg=1.7, amplitude=3e-4), 0.0000195318880),
    "P6 4e-4": (dict(tilt_deg=1.7, amplitude=4e-4), 0.000683535),
    "P6 5e-4": (dict(tilt_deg=1.7, amplitude=5e-4), 0.001500794),
    "P6 6e-4": (dict(tilt_deg=1.7, amplitude=6e-4), 0.002344920),
    "P6 8e-4": (dict(tilt_deg=1.7, amplitude=8e-4), 0.004280813),
    "P7 30": (dict(tilt_deg=1.7, amplitude=6e-4, omega=30 * math.pi), 1.02210871e-7),
    "P7 46": (dict(tilt_deg=1.7, amplitude=6e-4, omega=46 * math.pi), 1.11589088e-5),
    "P7 52": (dict(tilt_deg=1.7, amplitude=6e-4, omega=52 * math.pi), 5.526111e-4),
    "P7 65": (dict(tilt_deg=1.7, amplitude=6e-4, omega=65 * math.pi), 2.268605e-3),
    "P7 80": (dict(tilt_deg=1.7, amplitude=6e-4, omega=80 * math.pi), 4.156988e-3),
    "P8 .03": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.03), 0.012385126),
    "P8 .04": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.04), 0.011746793),
    "P8 .05": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.05), 0.011252310),
    "P8 .10": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.10), 0.006013796),
    "P8 .21": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.21), 0.001597403),
    "P10 1.7": (dict(tilt_deg=1.7, amplitude=0.553e-3, incline="gravity"), 0.001871385),
    "P10 2.7": (dict(tilt_deg=2.7, amplitude=0.6032e-3, incline="gravity"), 0.003888559),
    "P10 4.7": (dict(tilt_deg=4.7, amplitude=0.4564e-3, incline="gravity"), 0.003852650),
    "P10 5.7": (dict(tilt_deg=5.7, amplitude=1.487e-3, incline="gravity"), 0.028674381),
}


def lugre(name: str) -> ss.Robot:
    """The robot of a row of `LUGRE`."""
    return ss.presets.piezo_rig(**LUGRE[name][0])


def velocity_unit(robot: ss.Robot) -> float:
    """A mu omega, the velocity of the body if there were no friction [m/s]."""
    return float(robot.velocity_scale * robot.mass_ratio)


def paper_batch(count: int = 512, mu0: float = 0.18) -> ss.Robot:
    """The paper's rig at many amplitudes."""
    import numpy as np

    return ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.linspace(4e-4, 8e-4, count), mu0=mu0)


def random_robots(count: int, seed: int = 1) -> ss.Robot:
    """Robots two decades wide around the paper's in every number: masses, A, omega, mu, f, sigma, v_s."""
    import numpy as np

    rng = np.random.default_rng(seed)

    def wide(middle: float) -> np.ndarray:
        return middle * 10 ** rng.uniform(-1, 1, count)

    total = wide(72.07e-3)
    inner = total * np.minimum(0.131539 * 10 ** rng.uniform(-1, 1, count), 0.9)
    mu, skew, rise = wide(0.18), 1 + wide(0.4), 1 + wide(0.17)
    law = ss.LuGre(mu, mu * skew, mu * rise, mu * skew * rise, sigma0=wide(4e5), sigma1=wide(100.0), sigma2=wide(0.04), v_s=wide(2e-3))
    return ss.Robot(total - inner, inner, ss.Harmonic(amplitude=wide(5e-4), omega=wide(205.46)), law)
