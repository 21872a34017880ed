"""Friction forces of a law over a prescribed motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Law, Numeric
from stickslip.engine.law_steps import law_steps
from stickslip.inverse.identification.play import force_through_play
from stickslip.models.force_rig import ForceRig
from stickslip.models.friction.law_adapter import LawAdapter, adapted

if TYPE_CHECKING:
    from stickslip.inverse.identification.motions import PrescribedMotion

_NUDGE = 1e-6
_SWITCHES, _HALVINGS = 4, 50  # of each memory within a step, after which it goes on without; to find when one is
_SLIDES, _FAR, _SLOW = 40, 10.0, 1e-3  # a slide: its steps, its length in strokes, its speed in root mean squares of the motion's


@dataclass(frozen=True, eq=False)
class Stepped:
    """Instants [s], the mean slip velocity over the interval that ends at each [m/s], and that at the instants."""

    t: Any
    v: Any
    at: Any


def slide(t: Array, v: Array) -> tuple[Any, float]:
    """Durations [s] and speed [m/s] of a slow slide, longer than any stroke of a motion, that brings inner states to its end."""
    moved = v * np.diff(t, prepend=t[0])
    if not moved.any():
        return np.zeros(0), 0.0
    speed = _SLOW * float(np.sqrt(np.mean(v**2)))
    return np.geomspace(np.mean(abs(moved)), _FAR * np.ptp(np.cumsum(moved)), _SLIDES) / speed, speed


def driven_force(
    law: Law, motion: PrescribedMotion, cases: int = 1, reading: dict[str, Any] | None = None, applied: float | None = None
) -> Any:
    """Friction force of a law at every sample of a motion: array (samples, cases) [N].

    Between samples the velocity is constant. Inner states follow by exponential steps, which are exact where their rate is linear in
    them; a law's discrete memory switches within a step, where a guard falls to zero. A law that holds a body (a set-valued one at rest,
    Karnopp's in its band) gives there `applied`, within its break-away, or whatever was measured where that is None. `reading` may have
    a preload, and a start: from -1, as after a slow slide backwards, by 0, unbent, to 1, as after one forwards.

    Of a `ForceRig` it is the force at the actuator; where that is open, as where a flank is reached, that on the side of `applied`. A start
    from -1/2 to 1/2 is then the place in the play, and beyond them the contact is bent on a flank.
    """
    reading = reading or {}
    load = np.add.outer(motion.load, reading.get("preload", np.zeros(1)))
    measured = (motion.force if applied is None else np.full(len(motion.t), applied))[:, None]
    if isinstance(law, ForceRig):
        return _rig_force(law, motion, load, measured, cases, reading, float(np.sign(applied or 0.0)))
    known = adapted(law)
    open_ = motion.still | motion.turning if motion.rigid and "delay" in reading else motion.still
    at = motion.at if known.dynamic else np.where(open_, 0.0, motion.at)
    return law_force(known, Stepped(motion.t, motion.v, at), load, measured, cases, reading.get("start"))


def _rig_force(rig: ForceRig, motion: PrescribedMotion, load: Any, measured: Any, cases: int, reading: dict[str, Any], side: float) -> Any:
    """Force at the actuator of a rig."""
    start = np.broadcast_to(np.asarray(reading.get("start", 0.0), float), (cases,))
    offset = np.clip(2 * start, -1.0, 1.0)
    if not rig.law.dynamic:
        steps, at = np.diff(motion.t, prepend=motion.t[0]), np.where(motion.still, 0.0, motion.at)
        samples = float("delay" in reading)
        return force_through_play(rig.law, steps, motion.v, at, load, rig.backlash, offset, side, cases, motion.blur, samples, motion.smear)
    stepped, bent = Stepped(motion.t, motion.v, motion.at), np.sign(start) * np.maximum(abs(start) - 0.5, 0.0)
    inner = _begun(rig.law, stepped, load[0], cases, bent)
    z = np.concatenate([inner, (0.5 * rig.backlash * offset)[None, :]])
    flank = np.concatenate([np.sign(bent)[None, :], np.zeros((rig.law.modes, cases))])
    return _followed(rig.behind_play, stepped, load, measured, z, begun=flank)[0]


def law_force(known: LawAdapter, motion: Stepped, load: Any, measured: Any, cases: int, start: Any = None) -> Any:
    """The same from loads and from what would be borne at rest: columns [N]."""
    if not known.dynamic:
        return _set_valued(known, motion.at[:, None], load, measured, cases)
    return _followed(known, motion, load, measured, _begun(known, motion, load[0], cases, start))[0]


def _begun(known: LawAdapter, motion: Stepped, load: Array, cases: int, start: Any) -> Any:
    """Inner states at the first sample: array (states, cases)."""
    unbent = _wide(known.start(load), cases)
    if start is None or not np.any(start):
        return unbent
    back, forth = (_slid(known, motion, load, unbent, side) - unbent for side in (-1.0, 1.0))
    back = np.where(back * forth > 0, -back, back)  # an age, which has no direction, is less to one side and more to the other
    return unbent + abs(start) * np.where(start > 0, forth, back)


def _slid(known: LawAdapter, motion: Stepped, load: Array, z: Array, side: float) -> Any:
    """Inner states after a slow slide to a side."""
    durations, speed = slide(motion.t, motion.v)
    v = np.full(len(durations), side * speed)
    return _followed(known, Stepped(np.cumsum(durations), v, v), load + np.zeros((len(v), 1)), np.zeros((len(v), 1)), z, durations)[1]


def _followed(
    known: LawAdapter, motion: Stepped, load: Any, measured: Any, z: Any, steps: Any = None, begun: Any = None
) -> tuple[Any, Any]:
    """Forces, array (samples, cases), and the inner states after the last: compiled, or in plain Python of a law that asks for it.

    Memories begin as `begun` has them, array (modes, cases), or at zero.
    """
    steps = np.diff(motion.t, prepend=motion.t[0]) if steps is None else steps
    compiled = law_steps(known)
    if compiled is None:
        return _step_by_step(known, motion, load, measured, z, steps, begun)
    end = z.copy()
    return compiled(known, steps, motion.v, motion.at, load, measured, end, begun), end


def _step_by_step(
    known: LawAdapter, motion: Stepped, load: Array, measured: Any, z: Array, steps: Any, begun: Any = None
) -> tuple[Any, Any]:
    cases = z.shape[1]
    out = np.empty((len(motion.t), cases))
    mode = tuple(np.zeros(cases) for _ in range(known.modes)) if begun is None else tuple(np.array(each) for each in begun)
    nudge = _nudges(known, load.mean(axis=0), cases)
    side, last = 0.0, None
    one = load.shape[1] == 1
    columns = motion.v.tolist(), motion.at.tolist(), load[:, 0].tolist() if one else load, steps.tolist(), measured
    for k, (v, v_here, N, h, given) in enumerate(zip(*columns, strict=True)):
        if mode and side and v * side <= 0:
            z, mode = _passed_rest(known, side, N, z, mode)
            last = _guards(known, 0.0, N, z, mode)
        side = v
        if v != 0 and h > 0 and z.size:
            step = _remembered if mode else _stepped
            z, mode, last = step(known, v, N, np.full(cases, h), z, mode, nudge, last)
        out[k] = known.response(v_here, tuple(z), N, mode, given)[0]
    return out, z


def _nudges(law: LawAdapter, load: Numeric, cases: int) -> Any:
    """Small steps of the inner states: array (states, cases)."""
    typical = law.scale(load)
    return _NUDGE * abs(_wide((1e-6,) * law.states if typical is None else typical, cases))


def _wide(parts: tuple[Any, ...], cases: int) -> Any:
    """A number, or one for each case, of each inner state: array (states, cases)."""
    return np.array([np.broadcast_to(part, cases) for part in parts], float).reshape(len(parts), cases)


def _stepped(law: LawAdapter, v: float, N: Any, h: Array, z: Any, mode: Any, nudge: Any, last: Any = None) -> tuple[Any, Any, Any]:
    """Inner states after steps of lengths h (cases,) at constant velocity."""
    f, ahead = (_wide(law.rate(v, tuple(at), N, mode), z.shape[1]) for at in (z, z + nudge))
    slope = (ahead - f) / nudge
    a = np.minimum(slope * h, 30.0)
    small = abs(a) < 1e-8
    return z + h * f * np.where(small, 1.0, np.expm1(a) / np.where(small, 1.0, a)), mode, last


def _remembered(law: LawAdapter, v: float, N: Any, h: Array, z: ArrayLike, mode: Any, nudge: Any, last: Any) -> tuple[Any, Any, Any]:
    """The same with a memory that switches where guards fall to zero, one after the other; `last` are the guards after the step before."""
    for n in range(_SWITCHES * law.modes + 1):
        end = _stepped(law, v, N, h, z, mode, nudge)[0]
        after = _guards(law, v, N, end, mode)
        if not (after <= 0).any() or n == _SWITCHES * law.modes:
            break
        before = _guards(law, v, N, z, mode)
        stood = np.ones_like(after) if last is None else last
        fallen = (after <= 0) & ((before > 0) | (after < before) | ((after == before) & (stood > 0)))
        if not fallen.any():
            break
        part = np.where(fallen & (before > 0), before / np.where(fallen & (before > 0), before - after, 1.0), np.where(fallen, 0.0, 2.0))
        which = np.argmin(part, axis=0)
        t = np.where(part.min(axis=0) > 0, _zero(law, v, N, h, z, mode, nudge, which), 0.0)
        t = np.where(fallen.any(axis=0), t, 0.0)
        z, h = _stepped(law, v, N, t, z, mode, nudge)[0], h - t
        z, mode = _chosen(law, v, N, z, mode, np.where(fallen.any(axis=0), which, -1))
    return end, mode, after


def _zero(law: LawAdapter, v: float, N: Any, h: Array, z: ArrayLike, mode: Any, nudge: Any, which: Any) -> Any:
    """When a guard of each case is zero on its step, by halving."""
    low, high = np.zeros_like(h), h + 0.0
    for _ in range(_HALVINGS):
        t = 0.5 * (low + high)
        guard = np.take_along_axis(_guards(law, v, N, _stepped(law, v, N, t, z, mode, nudge)[0], mode), which[None], axis=0)[0]
        low, high = np.where(guard > 0, t, low), np.where(guard > 0, high, t)
    return high


def _guards(law: LawAdapter, v: float, N: Any, z: Any, mode: Any) -> Any:
    """The guards of a law's memory: array (switches, cases)."""
    return np.array([np.broadcast_to(guard, z.shape[1]) for guard, _, _ in law.switches(v, tuple(z), N, mode)], float)


def _chosen(law: LawAdapter, v: float, N: Any, z: Any, mode: Any, which: Any) -> tuple[Any, Any]:
    """Inner states and memory after a switch of each case; -1: none."""
    old = z, mode
    for i, (_, new_mode, new_z) in enumerate(law.switches(v, tuple(old[0]), N, old[1])):
        own = which == i
        mode = tuple(np.where(own, new, was) for new, was in zip(new_mode, mode, strict=True))
        if new_z is not None:
            z = np.where(own, _wide(new_z, z.shape[1]), z)
    return z, mode


def _passed_rest(law: LawAdapter, came: float, N: Any, z: Array, mode: Any) -> tuple[Any, Any]:
    """The memory where the velocity comes to zero or passes it: after every switch whose guard falls only there."""
    before, now = (_guards(law, v, N, z, mode) for v in (came, 0.0))
    for i, (_, new_mode, new_z) in enumerate(law.switches(0.0, tuple(z), N, mode)):
        fallen = (now[i] <= 0) & (before[i] > 0)
        mode = tuple(np.where(fallen, new, old) for new, old in zip(new_mode, mode, strict=True))
        if new_z is not None:
            z = np.where(fallen, _wide(new_z, z.shape[1]), z)
    return z, mode


def _set_valued(law: LawAdapter, v: Array, N: Any, F: Any, cases: int) -> Any:
    moving = v != 0
    sliding = np.broadcast_to(law.sliding(np.where(moving, v, 1.0), N), (len(v), cases))
    backward, forward = law.breakaway(N)
    return np.where(moving, sliding, np.clip(F, backward, forward))
