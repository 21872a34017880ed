"""Which models the maps of this package accept, and the messages for the others."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.analysis.state_order import order_of
from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves
from stickslip.basics.forward_ad import slopes_of, variables
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, largest_size
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of, is_model


def needs_model(what: str, model: Model, driven: bool = True, batch: bool = False, flows: bool = False, sections: bool = False) -> None:
    """Say what to type where something else than one robot (or, with `batch`, than one or many) was given; `flows` may be given too.

    With `sections` a machine or flow without a period is looked at on a section.
    """
    if not is_model(model):
        raise InputError(
            what, [f"{model!r} is not a model; allowed is a Robot; type ss.{what}(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4))"]
        )
    flow = not adapter_of(model).has_bodies
    if flow and not flows:
        taken = (
            "type ss.solve, ss.periodic_orbit, ss.continuation, ss.basins, ss.atlas, ss.bifurcation, ss.lyapunov or ss.verdict, "
            "which take a flow"
        )
        raise InputError(what, [f"it is a flow without bodies and contacts; allowed are machines; {taken}"])
    if not batch and any(np.ndim(value) for _, value in leaves(model)):
        kind = "flow" if flow else "robot"
        mistake = f"the {kind} is a batch (some of its numbers are arrays); allowed is one {kind}; type each number as a single value"
        raise InputError(what, [mistake])
    if flow:
        if not sections:
            _needs_period(what, model)
        return
    driven = driven and not (sections and model.period is None)
    if driven and model.period is None:
        why = f"{type(model).__name__} has no period, so it has no strobe; allowed are models with a periodic drive"
        raise InputError(what, [f"{why}; for its limit cycle type ss.periodic_orbit(machine), to follow it ss.continuation"])
    if driven and _drifts(model):
        kind = type(model).__name__
        raise InputError(what, [f"the equations of {kind} have positions in them, but with these numbers bodies can be shifted together "
                                "and no force changes (by a link of stiffness 0, or as nothing joins two groups of them): they drift "
                                "apart and never come back; allowed are bodies that links hold together; give it a link, or a stiffness "
                                "that is not 0"])  # fmt: skip


def _needs_period(what: str, flow: Any) -> None:
    """The same of the period of a flow that switches."""
    if flow.period is None:
        hint = (
            "its equations need not depend on time: give it the time between two looks, such as SwitchingFlow(..., period=0.5), of which "
            "rests and motions that repeat after a multiple of it are found; for a cycle type "
            "ss.dynamics.flow_orbit(flow, state, mode, duration=...), for exponents ss.dynamics.lyapunov_of_flow(flow, state)"
        )
        raise InputError(what, [f"SwitchingFlow has no period, so it has no strobe; allowed are flows with a period; {hint}"])


def _drifts(model: Model) -> bool:
    """Whether some of the positions that are coordinates can be shifted, and no acceleration, no load and no height changes.

    Of a batch the first case is asked.
    """
    order, one = order_of(model), cases_of(model, slice(1))[0]
    mechanics, random = machine_of(one).mechanics, np.random.default_rng(20261122)
    if mechanics.stops or mechanics.coordinates == 1:  # one alone has nothing to drift apart from
        return False
    speed, rows = coordinates(one).speed, []
    for power in (0, 0, 1, 2, 3, 4):  # stops act far away
        y = list(random.uniform(-speed, speed, order.states))
        positions = variables(*(y[order.places]))
        y[order.places] = [position * (10.0**power * largest_size(machine_of(one).time_scale)) for position in positions]
        q, u, _ = order.split(y, 0.0)
        t = float(random.uniform(0.0, 1.0)) * float(one.period)
        free = mechanics.accelerations(t, q, u, (0.0,) * len(mechanics.contacts))
        heights = mechanics.heights(t, q, u) if mechanics.flying else {}
        forces = [*free, *mechanics.loads(t, q, u), *mechanics.control_answers(t, q, u), *(height for height, _ in heights.values())]
        rows += [[float(slope) for slope in slopes_of(force, len(positions))] for force in forces]
    G = np.nan_to_num(np.array(rows)).reshape(len(rows), len(order.kept))
    sizes = np.linalg.norm(G, axis=0)
    if not np.all(sizes > 0.0):
        return True
    return bool(len(sizes) and np.linalg.svd(G / sizes, compute_uv=False)[-1] < 1e-9)
