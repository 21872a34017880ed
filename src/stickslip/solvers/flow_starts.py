"""The mode in which a switching flow begins: it follows from guards and contacts; one that is given may not contradict them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.models.flow_contacts import SIGNS
from stickslip.models.switching_flow import knows_mode
from stickslip.solvers.plain.composed_flows import mode_of_state

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow

_ROUNDING = 1e-9  # of the states' sizes: within such a change of the state a guard or a slip may be zero
_SAYS = "the mode at the start follows from the state where it is not given; leave mode= out"


def starting_modes(flow: SwitchingFlow, states: Array, given: Any = None, one: bool = False) -> list[Any]:
    """The mode in which each start (cases, n) begins, a mode of the fields or one that was given.

    Where none is given it is the first of the fields, unless the state is beyond one of its guards whose reset would change the state at
    t = 0: then the first within whose guards the state is.

    Parameters
    ----------
    flow : SwitchingFlow
        Of single numbers, or with a case for each start.
    states : array (cases, n)
    given : mode, optional
    one : bool
        Whether all starts are of the flow as it is.

    Raises
    ------
    InputError
        For a start that is in no mode, a mode that contradicts the state, and contacts for which friction does not brake.

    Examples
    --------
    >>> import stickslip as ss
    >>> back = ss.Switch(lambda t, y: y[0] - 1.0, "far", lambda t, y: (y[0], -y[1]))
    >>> flow = ss.SwitchingFlow({"far": lambda t, y: (y[1], 0.0), "near": lambda t, y: (y[1], -1.0)}, {"far": (back,)})
    >>> starting_modes(flow, np.array([[2.0, 0.3], [0.5, 0.3]]), one=True)
    ['far', 'near']
    """
    cases = [flow] * len(states) if one else cases_of(flow)
    modes: list[Any] = []
    for case, y in zip(cases, states, strict=True):
        own = y[: len(y) - len(case.inner)]
        mode = _by_state(case, own) if given is None else given
        base = case.labels[mode][0] if knows_mode(case.labels, mode) else mode
        _check_reset(case, mode, base, own)
        if given is not None:
            _check_given(case, given, base, y, own)
        modes.append(mode)
    if len(states):
        mode_of_state(cases[0], states[0], mode=modes[0])  # which says what no contact can do
    return modes


def places_of_starts(flow: SwitchingFlow, states: Array) -> Array:
    """The same of many starts (cases, n) of one flow as analyses take modes: places, below zero where contacts are for the state to say."""
    fields = list(flow.fields)
    if all(switch.reset is None for switch in flow.switches.get(fields[0], ())):
        return np.full(len(states), -1.0 if flow.contacts else 0.0)
    own = states[:, : states.shape[1] - len(flow.inner)]
    places = np.array([fields.index(_by_state(flow, y)) for y in own], float)
    return -1.0 - places if flow.contacts else places


def changed_at_once(flow: SwitchingFlow, states: Array) -> Array:
    """Which of many starts (cases, n) of one flow lie within the guards of no mode, so that a reset makes others of them at t = 0."""
    own, plain = states[:, : states.shape[1] - len(flow.inner)], flow.plain
    if all(switch.reset is None for switches in plain.switches.values() for switch in switches):
        return np.zeros(len(own), bool)
    return np.array([_at_once(plain, _by_state(flow, y), y) is not None for y in own], bool)


def _by_state(flow: SwitchingFlow, y: Array) -> Any:
    """The mode of the fields at a state: the first; if a switch would change the state at once, the first within its guards."""
    first, plain = next(iter(flow.fields)), flow.plain
    if _at_once(plain, first, y) is None:
        return first
    return next((mode for mode in plain.fields if _beyond(plain, mode, y) is None), first)


def _check_reset(flow: SwitchingFlow, mode: Any, base: Any, y: Array) -> None:
    """`InputError` for a start beyond a guard of its mode whose switch would change the state at t = 0."""
    plain = flow.plain
    changes = _at_once(plain, base, y)
    if changes is None:
        return
    k, value, after = changes
    within = [each for each in plain.fields if _beyond(plain, each, y) is None]
    typed = f"type mode={within[0]!r}, in which it is within the guards" if within else "give another start"
    start = f"the run begins in mode {mode!r} at {y.tolist()}, beyond the guard of switches[{base!r}][{k}], which is {value:.6g} there"
    mistake = f"{start}: at t = 0 its reset would make {after.tolist()} of the start"
    allowed = "allowed is a start at which the guards of its mode are positive"
    raise InputError("solve", [f"{mistake}; {allowed}; {typed}, or start={after.tolist()} for the state after the reset"])


def _check_given(flow: SwitchingFlow, mode: Any, base: Any, states: Array, y: Array) -> None:
    """`InputError` for a mode that was given in which the state is not, by more than rounding: beyond a guard, or with another slip."""
    plain, moved = flow.plain, _moved(y)
    for k, switch in enumerate(plain.switches.get(base, ())):
        values = [_called(switch.guard, each) for each in (y, *moved)]
        if all(value is not None and value[0] < 0.0 for value in values):
            guard = f"the guard of switches[{base!r}][{k}] is {values[0][0]:.6g} there"  # type: ignore[index]
            mistake = f"mode = {mode!r} contradicts the start {y.tolist()}: {guard}, and a mode ends where a guard falls through zero"
            raise InputError("solve", [f"{mistake}; {_SAYS}"])
    if not knows_mode(flow.labels, mode):
        return
    resting = [name for name, contact in plain.contacts.items() if not contact.law().dynamic]
    for name, side in zip(resting, flow.labels[mode][1], strict=True):
        slips = [float(np.ravel(plain.contacts[name].slip(0.0, each))[0]) for each in (y, *moved)]
        actual = 1 if min(slips) > 0.0 else -1 if max(slips) < 0.0 else None
        if actual is not None and actual != side:
            does = mode_of_state(flow, states, mode=base)
            slip = f"the slip of {name!r} is {slips[0]:.6g} there, which is {name}{SIGNS[actual]}"
            raise InputError("solve", [f"mode = {mode!r} contradicts the start {y.tolist()}: {slip}; {_SAYS}, or type mode={does!r}"])


def _moved(y: Array) -> list[Array]:
    """The state with each of its numbers a little smaller and larger."""
    steps = _ROUNDING * np.diag(np.maximum(abs(y), 1e-3 * max(float(abs(y).max(initial=0.0)), 1e-300)))
    return [*(y + steps), *(y - steps)]


def _at_once(flow: SwitchingFlow, mode: Any, y: Array) -> tuple[int, float, Array] | None:
    """The switch beyond whose guard a start is, its guard, and what its reset makes of the start; None where nothing changes."""
    beyond = _beyond(flow, mode, y)
    if beyond is None:
        return None
    k, value = beyond
    switch = flow.switches[mode][k]
    after = y if switch.reset is None else _called(switch.reset, y)
    return None if after is None or not np.any(after != y) else (k, value, after)


def _beyond(flow: SwitchingFlow, mode: Any, y: Array) -> tuple[int, float] | None:
    """The first switch of a mode whose guard is below zero at a start, and its guard."""
    values = [(k, _called(switch.guard, y)) for k, switch in enumerate(flow.switches.get(mode, ()))]
    return next(((k, float(g[0])) for k, g in values if g is not None and g[0] < 0.0), None)


def _called(f: Any, y: Array) -> Array | None:
    """What a function gives at a start, as an array; None where that is not known."""
    try:
        return np.atleast_1d(np.array(f(0.0, y.copy()), float))
    except Exception:  # said where the run comes to it
        return None
