"""Whether a motion that does not repeat is chaotic: its largest Lyapunov exponent."""

from __future__ import annotations

from typing import Any

from stickslip.basics.errors import InputError
from stickslip.show.explorer.effort import affordable
from stickslip.show.explorer.kernels import Kernels, compiling
from stickslip.show.explorer.requests import IsCancelled, Message, Stopped

#: Drive periods over which the exponent is averaged, and those before; distance of the two neighbouring motions, and tolerance.
_PERIODS, _SETTLE, _APART, _RTOL = 400, 200, 1e-6, 1e-8
#: An exponent that exceeds so many of its standard errors is positive, and the motion chaotic.
_ERRORS = 3.0


def exponent_of(asked: Message, kernels: Kernels, stop: IsCancelled) -> tuple[dict[str, Any], dict[str, Any]]:
    """The largest exponent per drive period, its standard error, and whether it is positive."""
    from stickslip.dynamics.exponents.motion_exponents import largest_exponents

    state, robot = asked.state, asked.state.robot()
    header = {"kind": "exponent", "law": state.law}
    if not kernels.ready(state, state.law, robot, True):
        return header | {"kind": "waits", "waits": compiling(state, state.law)}, {}
    if affordable(robot, _PERIODS) < _PERIODS:
        raise InputError("exponent", ["the bristles oscillate too fast for an exponent on this page"])
    exponents, errors = largest_exponents(robot, _PERIODS, settle=_SETTLE, rtol=_RTOL, apart=_APART, progress=lambda _: not stop())
    if stop():
        raise Stopped
    exponent, error = float(exponents[0]), float(errors[0])
    return header | {"exponent": exponent, "error": error, "chaotic": exponent > _ERRORS * error}, {}
