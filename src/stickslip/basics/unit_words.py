"""Units that are words, or symbols without prefixes: their SI values with the powers of m, kg, s, A and rad."""

from __future__ import annotations

import math

_ONE, _TIME, _LENGTH, _FORCE = (0, 0, 0, 0, 0), (0, 0, 1, 0, 0), (1, 0, 0, 0, 0), (1, 1, -2, 0, 0)
_MASS, _PRESSURE, _ANGLE, _TURNING, _TORQUE = (0, 1, 0, 0, 0), (-1, 1, -2, 0, 0), (0, 0, 0, 0, 1), (0, 0, -1, 0, 1), (2, 1, -2, 0, 0)
_VELOCITY, _ACCELERATION = (1, 0, -1, 0, 0), (1, 0, -2, 0, 0)
_INCH, _POUND, _GRAVITY = 0.0254, 0.45359237, 9.80665
_LBF = _POUND * _GRAVITY

#: Word -> (factor to SI, powers). Those of three letters and more are found in any case, and as plurals.
WORDS: dict[str, tuple[float, tuple[int, ...]]] = {
    **dict.fromkeys(("1", "-"), (1.0, _ONE)),
    "%": (1e-2, _ONE),
    **dict.fromkeys(("sec", "secs", "second", "sekunde", "sekunden"), (1.0, _TIME)),
    **dict.fromkeys(("msec", "millisecond"), (1e-3, _TIME)),
    **dict.fromkeys(("usec", "microsecond"), (1e-6, _TIME)),
    **dict.fromkeys(("min", "minute"), (60.0, _TIME)),
    **dict.fromkeys(("h", "hr", "hour"), (3600.0, _TIME)),
    **dict.fromkeys(("meter", "metre"), (1.0, _LENGTH)),
    **dict.fromkeys(("millimeter", "millimetre"), (1e-3, _LENGTH)),
    **dict.fromkeys(("micron", "micrometer", "micrometre"), (1e-6, _LENGTH)),
    **dict.fromkeys(("in", "inch", "inches", '"'), (_INCH, _LENGTH)),
    **dict.fromkeys(("mil", "thou"), (1e-3 * _INCH, _LENGTH)),
    **dict.fromkeys(("ft", "feet", "foot"), (12 * _INCH, _LENGTH)),
    "ips": (_INCH, _VELOCITY),
    "mps": (1.0, _VELOCITY),
    "mph": (0.44704, _VELOCITY),
    **dict.fromkeys(("kph", "kmh"), (1 / 3.6, _VELOCITY)),
    **dict.fromkeys(("g0", "gn"), (_GRAVITY, _ACCELERATION)),
    **dict.fromkeys(("newton",), (1.0, _FORCE)),
    "lbf": (_LBF, _FORCE),
    "ozf": (_LBF / 16, _FORCE),
    **dict.fromkeys(("kip", "klbf", "kips"), (1e3 * _LBF, _FORCE)),
    **dict.fromkeys(("kgf", "kp"), (_GRAVITY, _FORCE)),
    "gf": (1e-3 * _GRAVITY, _FORCE),
    "dyn": (1e-5, _FORCE),
    **dict.fromkeys(("lb", "lbs", "lbm"), (_POUND, _MASS)),
    "psi": (_LBF / _INCH**2, _PRESSURE),
    "ksi": (1e3 * _LBF / _INCH**2, _PRESSURE),
    "atm": (101325.0, _PRESSURE),
    **dict.fromkeys(("deg", "degree", "°"), (math.pi / 180, _ANGLE)),
    **dict.fromkeys(("radian",), (1.0, _ANGLE)),
    **dict.fromkeys(("rev", "revolution", "turn"), (2 * math.pi, _ANGLE)),
    **dict.fromkeys(("rpm", "1/min", "u/min"), (2 * math.pi / 60, _TURNING)),
    "rps": (2 * math.pi, _TURNING),
    **dict.fromkeys(("lbf*in", "lb*in", "in*lb", "in*lbf"), (_LBF * _INCH, _TORQUE)),
    **dict.fromkeys(("lbf*ft", "lb*ft", "ft*lb", "ft*lbf"), (12 * _LBF * _INCH, _TORQUE)),
    **dict.fromkeys(("oz*in", "ozf*in", "in*oz", "in*ozf"), (_LBF * _INCH / 16, _TORQUE)),
    **dict.fromkeys(("volt",), (1.0, (2, 1, -3, -1, 0))),
    **dict.fromkeys(("millivolt",), (1e-3, (2, 1, -3, -1, 0))),
    **dict.fromkeys(("ampere", "amp"), (1.0, (0, 0, 0, 1, 0))),
    "hertz": (1.0, (0, 0, -1, 0, 0)),
    "pascal": (1.0, _PRESSURE),
}
