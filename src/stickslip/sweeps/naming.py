"""What the axes of a sweep are called."""

from __future__ import annotations

__all__ = ["AXES", "axis_of"]

#: What the axes of a sweep are called on a plot, and their units: by the last part of a dotted name.
AXES: dict[str, tuple[str, str]] = {
    "amplitude": ("amplitude of the inner mass A", "m"),
    "omega": ("angular frequency ω", "rad/s"),
    "frequency": ("frequency", "Hz"),
    "voltage": ("voltage on the patches", "V"),
    "length": ("length of the beam L", "m"),
    "thickness": ("thickness of the beam h1", "m"),
    "patch_length": ("length of the patches l0", "m"),
    "tip_mass": ("tip mass m", "kg"),
    "damping": ("damping ratio of the beam ζ", "1"),
    "tilt_deg": ("tilt of the track θ", "degrees"),
    "tilt": ("tilt of the track θ", "rad"),
    "mu0": ("kinetic friction coefficient μ0", "1"),
    "f0": ("static friction coefficient f0", "1"),
    "mu_plus": ("kinetic friction coefficient forwards μ+", "1"),
    "mu_minus": ("kinetic friction coefficient backwards μ-", "1"),
    "f_plus": ("static friction coefficient forwards f+", "1"),
    "f_minus": ("static friction coefficient backwards f-", "1"),
    "sigma0": ("bristle stiffness σ0", "N/m"),
    "sigma1": ("bristle damping σ1", "N s/m"),
    "sigma2": ("viscous friction σ2", "N s/m"),
    "v_s": ("Stribeck velocity v_s", "m/s"),
    "speed": ("speed of the belt or of the pull u", "m/s"),
    "stiffness": ("stiffness of the spring k", "N/m"),
    "mass": ("mass m", "kg"),
    "body_mass": ("mass of the body M", "kg"),
    "inner_mass": ("inner mass m", "kg"),
    "gravity": ("acceleration of gravity g", "m/s^2"),
    "alpha_plus": ("sliding friction forwards over drive force α+", "1"),
    "alpha_minus": ("sliding friction backwards over drive force α-", "1"),
    "start.x": ("position at the start x", "m"),
    "start.v": ("velocity at the start v", "m/s"),
    "start.z": ("inner state at the start z", "m"),
    "force.amplitude": ("force on the inner mass A", "N"),
    "parts.amplitude": ("force on the inner mass A", "N"),
    "force.phase": ("phase of the force φ", "rad"),
    "parts.phase": ("phase of the force φ", "rad"),
    "force.period": ("period of the force T", "s"),
    "parts.period": ("period of the force T", "s"),
    "force.mean": ("mean of the force", "N"),
    "parts.mean": ("mean of the force", "N"),
    "duty": ("part of the period for which the force is on", "1"),
    "drive.stiffness": ("stiffness of the spring k", "N/m"),
    "drive.damping": ("damping c", "N s/m"),
    "link.damping": ("damping c", "N s/m"),
    "stops.gap": ("gap of the stop", "m"),
    "stops.restitution": ("restitution e", "1"),
    "stops.stiffness": ("stiffness of the stop", "N/m"),
    "stops.damping": ("damping of the stop", "N s/m"),
    "pulse": ("force of the pulses", "N"),
    "damper": ("damping c", "N s/m"),
    "force_ratio": ("force over sliding friction α", "1"),
    "damping_ratio": ("damping ratio ξ", "1"),
    "mass_ratio": ("mass ratio γ", "1"),
    "stop_stiffness": ("stiffness of the stop over that of the spring β", "1"),
    "gap": ("gap of the stop δ", "m"),
}


def axis_of(name: str) -> tuple[str, str] | None:
    """What a number is called and its unit: by its whole name, by its last two words, or by the last; None where nobody knows.

    Examples
    --------
    >>> axis_of("drive.amplitude"), axis_of("drive.force.parts.1.amplitude")
    (('amplitude of the inner mass A', 'm'), ('force on the inner mass A', 'N'))
    """
    words = [word for word in str(name).split(".") if not word.isdigit()]
    return AXES.get(str(name)) or AXES.get(".".join(words[-2:])) or AXES.get(words[-1] if words else "")
