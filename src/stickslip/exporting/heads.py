"""The head of an exported law: which law, units, signs, and how its step is made."""

from __future__ import annotations

from stickslip.engine.traced_law import TracedLaw

__all__ = ["head"]

_UNITS = (
    "SI units: v [m/s] (of a joint rad/s), load and friction force [N] (of a joint with load 1: N m).",
    "The friction force opposes sliding: it has the sign of v, and is subtracted in the equation of motion.",
)
_STEP = (
    "v and load are constant within a step: give their means. Inner states go by exponential Rosenbrock-Euler steps,",
    "z + dt phi1(dt J) f with phi1(x) = (exp(x) - 1)/x, which are stable for any stiffness.",
)
_EXACT = "The rates of this law are linear in its states, so that this is exact for the v and load that are held."
_SECOND = "The error of a step is of third order in dt."
_MODES = (
    "The memory switches within a step where a guard falls to zero, found by halving; where v comes to zero or changes its side",
    "between steps, it switches as at the instant of v = 0.",
)
_SET_VALUED = (
    "The law is set-valued: at rest friction balances the other forces, between the limits of breakaway. force() takes what would hold",
    "it; step() takes `needed`, the force that would leave the body at rest at the end of a time step, applied + mass v / dt, and gives",
    "the one that acts in this step: the body then stops, and stays, up to rounding. The error is of first order in dt.",
)
_APPLIED = ("Near rest the law balances the other forces: `applied` is the friction force that would keep v constant.",)


def head(law: TracedLaw, name: str, version: str) -> list[str]:
    """The sentences at the head of a file."""
    told = [f"{name}: the friction law {law.law.name}, written by stickslip {version} from its own equations.", *_UNITS]
    if not law.law.dynamic:
        return [*told, *_SET_VALUED]
    told += _APPLIED if law.law.needs_applied else ()
    if law.z:
        told += [*_STEP, _EXACT if law.exact else _SECOND]
    return [*told, *(_MODES if law.switches else ())]
