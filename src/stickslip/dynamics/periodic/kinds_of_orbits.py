"""What periodic orbits answer in one way for bodies on contacts and in another for the modes of a flow: here alone they differ.

Bodies have contacts that stick and slip, and small changes of their state go in lanes of one kernel. A flow has modes, and its derivative
comes with the passage once around.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.contact_modes import pressed_stops
from stickslip.analysis.oscillation import kind_of_cycle
from stickslip.basics.contracts import Array
from stickslip.dynamics.derivatives.tangents import jacobian_of, not_followed, orders_differ
from stickslip.dynamics.flows.flow_stretches import passage, touches
from stickslip.dynamics.periodic.newton import STEP
from stickslip.dynamics.stroboscopic.differences import at_limits
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.models.rounding import without_rounding
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

if TYPE_CHECKING:
    from stickslip.dynamics.flows.flow_stretches import Passage
    from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
    from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates
    from stickslip.results.trajectory import Trajectory

NEUTRAL = 1e-8  # how far from 1 a multiplier of 1 may be computed
_SIGNS = {1: "+", 0: "0", -1: "-"}
_FIRST = {True: "0+-", False: "+-0"}  # with which sign a pattern begins, if it can: that of a cycle, and that of a driven motion
_JOINED, _COUNTED = " | ", ", "  # the patterns of several contacts; what a motion touches
_TOUCHES = {"hit": "hit", "take-off": "takes off"}
_JUST_AFTER = 1e-12  # of a cycle: rounding must not leave out the switch with which it ends
_NOT_CROSSED = "a switch is touched without being crossed: the map has no derivative there"
_BY_TANGENT = "tangent of the system along the orbit, through every switch"


class OfBodies:
    """An orbit of a robot or machine."""

    def mode(self, orbit: PeriodicOrbit) -> None:
        """Its modes follow from its state."""

    def passage(self, orbit: PeriodicOrbit) -> Any:
        """There is none: `AttributeError`."""
        raise AttributeError("an orbit of a machine has no passage; type orbit.run for its motion, orbit.monodromy for its derivative")

    def derivative(self, orbit: PeriodicOrbit) -> Array:
        """By the tangent of the system, or by differences where small changes are not followed."""
        if not_followed(orbit.model):
            return orbit._jacobian(STEP)
        return jacobian_of(orbit.model, orbit.strobe_state, rtol=orbit.rtol, **orbit._length)

    def remarks(self, orbit: PeriodicOrbit) -> tuple[str, ...]:
        """None: `evidence` says what limits its multipliers."""
        return ()

    def lost(self, orbit: PeriodicOrbit) -> int:
        """How many directions are wiped out at one instant."""
        return 0 if not_followed(orbit.model) else int(resting(orbit.run).max())

    def evidence(self, orbit: PeriodicOrbit) -> str:
        """How the multipliers were found."""
        model, state = orbit.model, orbit.strobe_state
        if why := not_followed(model):
            sizes = orbit.at.scales[orbit.at.free]
            moved = abs(orbit.monodromy - orbit._jacobian(4 * STEP)) / sizes[:, None] * sizes
            return f"central differences of the strobe map, as {why}; with steps four times as long the matrix changes by {moved.max():.1e}"
        if not np.isfinite(orbit.monodromy).all():
            return _NOT_CROSSED
        if names := orbit.run._columns.thrown_together:
            return f"{' and '.join(names)} land at one instant and are thrown up: motions beside do so one by one, and the map jumps"
        source = _BY_TANGENT
        if self._is_neutral(orbit):
            source += "; a contact that rests all the time may rest anywhere nearby, which adds a multiplier of 1"
        if limits := at_limits(model, state):
            stand = "stands" if len(limits) == 1 else "stand"
            source += f"; one-sided: {', '.join(limits)} {stand} at a limit of the law, and the derivative is that from within it"
        if orders_differ(model, state, rtol=orbit.rtol, **orbit._length):
            return f"{source}; one-sided: contacts switch at one instant, and their order under perturbations matters"
        return source

    def _is_neutral(self, orbit: PeriodicOrbit) -> bool:
        """Whether disturbances that do not die out only move what rests all the time to another place at rest."""
        free = sum(pattern == "0" for pattern in orbit.patterns.values())
        return orbit.stability == "neutral" and bool(np.sum(abs(orbit.multipliers) >= 1.0 - NEUTRAL) <= free)

    def events(self, orbit: PeriodicOrbit) -> Any:
        """Those of its run."""
        return orbit.run.events

    def patterns(self, orbit: PeriodicOrbit) -> dict[str, str]:
        """Of each contact."""
        modes, first = np.asarray(orbit.run.pieces.mode), _FIRST[orbit.is_cycle]

        def begins(pattern: str) -> tuple[int, str]:
            return first.index(pattern[0]), "" if orbit.is_cycle else pattern

        return {name: min(_turned(modes[:, i]), key=begins) for i, name in enumerate(orbit.run.contacts)}

    def pattern(self, orbit: PeriodicOrbit) -> str:
        """Of a driven motion that of `motion`, of a cycle that of the first contact."""
        return next(iter(orbit.patterns.values())) if orbit.is_cycle else str(orbit.motion.pattern)

    def type(self, orbit: PeriodicOrbit) -> str:
        """Of a driven motion that of `motion`; of a cycle by its patterns."""
        if not orbit.is_cycle:
            return str(orbit.motion.type)
        return kind_of_cycle(list(orbit.patterns.values()), machine_of(orbit.model).has_inner_states)

    def words(self, orbit: PeriodicOrbit) -> dict[str, Any]:
        """The type; where the model names its contacts the pattern of each."""
        return {"patterns": orbit.patterns} if orbit.at.named else {"motion_type": orbit.type}

    def label(self, orbit: PeriodicOrbit) -> str:
        """A name that is the same all along a region of parameters: the type, of several contacts the pattern of each."""
        return orbit.type if len(orbit.patterns) < 2 else _JOINED.join(orbit.patterns.values())

    def signature(self, orbit: PeriodicOrbit) -> str:
        """Its pattern if rest is exact, else its type, which depends on thresholds; and the parts that it touches.

        Of a machine of several bodies the patterns of all contacts; where laws never rest exactly its reversals say all that is sharp.
        """
        dynamic = machine_of(orbit.model).has_tolerance
        if orbit.at.named:
            return ("" if dynamic else _JOINED.join(orbit.patterns.values())) + _touched(orbit)
        return (orbit.type if dynamic else orbit.pattern) + _touched(orbit)

    def grazes(self, before: str, after: str) -> bool:
        """Whether a slide is cut in two where its velocity touches zero."""
        before, after = before.partition(_COUNTED)[0], after.partition(_COUNTED)[0]
        changed = [(a, b) for a, b in zip(before.split(_JOINED), after.split(_JOINED), strict=True) if a != b]
        return all(_is_cut(a, b) for a, b in changed)

    def numbers(self, orbit: PeriodicOrbit) -> tuple[str, ...]:
        """Names of its single numbers."""
        single = () if orbit.at.named else ("pattern",) if orbit.is_cycle else ("pattern", "margin")
        return ("mean_velocity", "stable", *single, "residual", *(("amplitude", "duration") if orbit.is_cycle else ()))

    def facts(self, orbit: PeriodicOrbit) -> dict[str, str]:
        """What its page says first."""
        if orbit.is_cycle:
            return {"type": orbit.type, "duration": f"{orbit.duration:.9g} s"}
        patterns = orbit.patterns if len(orbit.patterns) > 1 else {"motion type": orbit.type, "pattern": orbit.pattern}
        return {
            "mean velocity": self._way(orbit),
            **{name: text.replace("-", "−") for name, text in patterns.items()},
            "repeats after": f"{orbit.period} drive period{'s' * (orbit.period != 1)}",
        }

    def summary(self, orbit: PeriodicOrbit) -> str:
        """What it is, printed in a line."""
        if orbit.is_cycle:
            return f"{orbit.duration:.10g} s, type {orbit.type}"
        kind = ", ".join(f"{name} {pattern}" for name, pattern in orbit.patterns.items()) if orbit.at.named else f"type {orbit.type}"
        return f"period {orbit.period}, {kind}, V = {self._way(orbit)}"

    def _way(self, orbit: PeriodicOrbit) -> str:
        return f"{without_rounding(orbit.mean_velocity, orbit.model):.9g} {unit_of_part('v', orbit.model, '')}"

    def begins(self, orbit: PeriodicOrbit) -> str:
        """What stands before its state where it is printed."""
        return "begins at " if orbit.is_cycle else "strobe state "


class OfModes:
    """An orbit of a flow that switches."""

    def mode(self, orbit: PeriodicOrbit) -> Any:
        """In which it begins."""
        return mode_of_strobe_state(orbit.model, orbit.strobe_state)

    def passage(self, orbit: PeriodicOrbit) -> Passage:
        """Once around; of a cycle that begins behind a switch with the one with which it ends."""
        length = orbit.duration if orbit.on_section is None else orbit.duration * (1.0 + _JUST_AFTER)
        return passage(orbit.model, orbit.state, orbit.mode, length, rtol=orbit.rtol, method=orbit.method)

    def derivative(self, orbit: PeriodicOrbit) -> Array:
        """That of the passage."""
        return orbit.passage.monodromy

    def remarks(self, orbit: PeriodicOrbit) -> tuple[str, ...]:
        """Where a guard is touched."""
        return () if np.isfinite(orbit.monodromy).all() else (touches(orbit.passage),)

    def lost(self, orbit: PeriodicOrbit) -> int:
        """Whether a switch wipes out a direction."""
        return int(orbit.passage.rank_deficient)

    def evidence(self, orbit: PeriodicOrbit) -> str:
        """How the multipliers were found."""
        if not np.isfinite(orbit.monodromy).all():
            return _NOT_CROSSED
        return _BY_TANGENT if orbit.passage.method == "exact" else f"{_BY_TANGENT}; by SciPy's integrator on plain Python"

    def events(self, orbit: PeriodicOrbit) -> Any:
        """Those of the passage: instant, mode before, mode after."""
        return orbit.passage.events

    def patterns(self, orbit: PeriodicOrbit) -> dict[str, str]:
        """None: its modes say what contacts do."""
        return {}

    def pattern(self, orbit: PeriodicOrbit) -> tuple[Any, ...]:
        """The modes in order."""
        return tuple(after for _, _, after in orbit.events) or (orbit.mode,)

    def type(self, orbit: PeriodicOrbit) -> str:
        """That of `motion`."""
        return str(orbit.motion.type)

    def words(self, orbit: PeriodicOrbit) -> dict[str, str]:
        """The modes in order."""
        return {"pattern": " ".join(map(str, orbit.pattern))}

    def label(self, orbit: PeriodicOrbit) -> str:
        """The modes in turn, once if it goes through them twice; where there is one mode, the number of switches."""
        turns, period = [str(after) for _, _, after in orbit.events], orbit.period
        once = next(turns[: len(turns) // k] for k in range(period, 0, -1) if len(turns) % k == 0 and turns == turns[: len(turns) // k] * k)
        if len(orbit.model.modes) == 1:
            return f"{len(once)} switch{'es' * (len(once) != 1)}"
        return f"modes {' '.join(min((once[i:] + once[:i] for i in range(len(once))), default=[str(orbit.mode)]))}"

    def signature(self, orbit: PeriodicOrbit) -> str:
        """Its switches."""
        return f"{len(orbit.events)} switches to {', '.join(map(str, orbit.pattern))}" if orbit.events else "no switch"

    def grazes(self, before: str, after: str) -> bool:
        """Whether there are more or fewer switches among the same modes: they begin where a guard is touched."""
        modes = [set(word.partition(" to ")[2].split(", ")) - {""} for word in (before, after)]
        return modes[0] <= modes[1] or modes[1] <= modes[0]

    def numbers(self, orbit: PeriodicOrbit) -> tuple[str, ...]:
        """Names of its single numbers."""
        return (*(("mean_velocity",) if orbit.model.cyclic else ()), "stable", "residual", "duration")

    def facts(self, orbit: PeriodicOrbit) -> dict[str, str]:
        """What its page says first."""
        return {"duration": f"{orbit.duration:.9g}", "switches": str(len(orbit.events))}

    def summary(self, orbit: PeriodicOrbit) -> str:
        """What it is, printed in a line."""
        return f"{orbit.duration:.9g} long, {len(orbit.events)} switches"

    def begins(self, orbit: PeriodicOrbit) -> str:
        """What stands before its state where it is printed."""
        return f"mode {orbit.mode!r}, "


def kind_of_orbit(at: Coordinates) -> OfBodies | OfModes:
    """What orbits of these coordinates answer."""
    return OfBodies() if at.in_lanes else OfModes()


def _turned(mode: Array) -> list[str]:
    """The signs of a closed motion in order, beginning with each of them."""
    signs = [_SIGNS[int(m)] for m in mode]
    kept = [sign for before, sign in pairwise([signs[-1], *signs]) if sign != before] or signs[:1]
    return ["".join(kept[k:] + kept[:k]) for k in range(len(kept))]


def _touched(orbit: PeriodicOrbit) -> str:
    """How often in the motion each stop is hit, or begins to be pressed, and each contact takes off: ", inner-body hit twice"."""
    run = orbit.run
    end = float(run.pieces.t[-1])
    counts = Counter(f"{event.part} {_TOUCHES[event.kind]}" for event in run.events if event.kind in _TOUCHES)
    counts.update({f"{name} pressed": sum(start > 0.0 for start, _ in of) for name, of in pressed_stops(run, 0.0, end).items()})
    times = ("", "once", "twice", "three times or more")
    return "".join(f"{_COUNTED}{name} {times[min(count, 3)]}" for name, count in sorted(counts.items()) if count)


def _is_cut(before: str, after: str) -> bool:
    """Whether one of two patterns has a slide in two parts that the other has in one."""
    long, short = sorted((before, after), key=len, reverse=True)
    for side in "+-":
        if any(
            side + gap + side in long + long and side + gap + side not in short + short for gap in ("0", "-" if side == "+" else "+")
        ) and (long.count(side) > short.count(side)):
            return True
    return False


def resting(run: Trajectory) -> Array:
    """How many directions are forgotten on each piece of a run: as many as independent slips of its contacts rest."""
    mode, machine = np.asarray(run.pieces.mode), machine_of(run.model)
    if machine.has_inner_states:
        return np.zeros(len(mode), int)
    rows, (patterns, number) = np.array(machine.mechanics.directions), np.unique(mode == 0, axis=0, return_inverse=True)
    ranks = np.array([np.linalg.matrix_rank(rows[pattern]) if pattern.any() else 0 for pattern in patterns])
    return ranks[np.ravel(number)]
