"""A friction law as a MuJoCo joint can represent it (dry friction and damping, equal in both directions), with the resulting error."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from stickslip.analysis.bench.setup import Setup
from stickslip.analysis.bench.velocity import force_at_speed
from stickslip.basics.errors import InputError
from stickslip.models.friction.law_adapter import adapted

_COUNT = 41  # speeds in each direction: a factor of 1.26 apart over four decades
_ROUNDING = 1e-9  # relative to the largest force: rounding of the linear programme


def joint_friction(law: Any, load: float, speeds: tuple[float, float], units: tuple[str, str]) -> tuple[dict[str, float], tuple[str, ...]]:
    """Friction and damping with the smallest maximum error (a linear programme) at geometrically spaced speeds.

    `units` are those of velocity and friction in what is said of them.

    Returns
    -------
    tuple of dict, tuple
        frictionloss [N], or [N m] for a hinge; damping [N s/m], or [N m s/rad]; error, the largest one of the steady friction force over
        the range, in both directions [N]; worst, the velocity at which it occurs; largest, the largest steady friction of the law
        there [N]. And sentences on properties of the law that the joint lacks.
    """
    from scipy.optimize import linprog

    bench = Setup(law, load, 1.0)
    ratio = (speeds[1] / speeds[0]) ** (1.0 / (_COUNT - 1))
    velocities = [side * speeds[0] * ratio**k for side in (1.0, -1.0) for k in range(_COUNT)]
    forces = [math.copysign(1.0, v) * force_at_speed(bench, v) for v in velocities]
    if not all(map(math.isfinite, forces)):
        still = max(abs(v) for v, force in zip(velocities, forces, strict=True) if not math.isfinite(force))
        why, above = f"at |v| = {still:.3g} {units[0]} the law has no steady friction", f"speeds=({2 * still:.3g}, {20 * still:.3g})"
        raise InputError("export_law", [f"speeds = {speeds}: {why}; type a range above it, for example {above}"])
    size, fast = max(map(abs, forces)) or 1.0, speeds[1]
    rows = [(sign, sign * abs(v) / fast, -1.0) for sign in (1.0, -1.0) for v in velocities]
    limits = [sign * force / size for sign in (1.0, -1.0) for force in forces]
    dry, viscous, _ = linprog([0.0, 0.0, 1.0], A_ub=rows, b_ub=limits, bounds=[(0, None)] * 3, method="highs").x
    dry, viscous = (float(part) if part > _ROUNDING else 0.0 for part in (dry, viscous))
    frictionloss, damping = dry * size, viscous * size / fast
    errors = [abs(frictionloss + damping * abs(v) - force) for v, force in zip(velocities, forces, strict=True)]
    worst = max(range(len(errors)), key=errors.__getitem__)
    fitted = {"frictionloss": frictionloss, "damping": damping, "error": errors[worst], "worst": velocities[worst]}
    return fitted | {"largest": max(map(abs, forces))}, tuple(_lost(bench, forces, units[1]))


def _lost(bench: Setup, forces: list[float], force: str) -> list[str]:
    """The properties of the law that the joint lacks."""
    apart = max(abs(a - b) for a, b in zip(forces[:_COUNT], forces[_COUNT:], strict=True))
    lacking = [f"forward and backward friction, which differ by up to {apart:.4g} {force}"] if apart > 1e-9 * max(map(abs, forces)) else []
    held = max(map(abs, bench.holds))
    if held > max(forces[0], forces[_COUNT]) * (1 + 1e-9):
        lacking.append(f"{'break-away' if bench.set_valued else 'friction at lower speeds'}, up to {held:.4g} {force}")
    if adapted(bench.law).states:
        lacking.append("the law's inner states: pre-sliding and lag")
    return lacking


def written_for_mujoco(fitted: Mapping[str, float], lost: tuple[str, ...], name: str, about: str, velocity: str) -> str:
    """The joint's attributes as XML, with a comment; `velocity` is the unit of the worst velocity."""
    notes = f" Not in it: {'; '.join(lost)}." if lost else ""
    share = f", {fitted['error'] / fitted['largest']:.2%} of the law's largest there" if fitted["largest"] else ""
    remark = f"{about} Largest error of steady friction {fitted['error']:.4g}{share}, at {fitted['worst']:.4g} {velocity}.{notes}"
    attributes = " ".join(f'{what}="{fitted[what]:.9g}"' for what in ("frictionloss", "damping", "armature"))
    return f'<!-- {remark.replace("--", "- -")} -->\n<joint name="{name}" {attributes}/>\n'
