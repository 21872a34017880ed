"""How small changes grow over stretches of a motion of any model: in lanes of one kernel, or along the passages of a flow."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.derivatives.tangents import Directions, changes_along, jacobians_of
from stickslip.dynamics.flows.flow_stretches import Passage, passage
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, flow_map
from stickslip.engine.tangent import tangent_and_volume
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.plain.composed_flows import composed, mode_of_strobe_state

_BRIEFLY = 1e-6  # of the time of a motion: over which its rates are differences


@sealed
class Growth:
    """Growth in several stretches.

    Parameters
    ----------
    matrices : array (stretches, states, states)
        Derivatives of the ends by the beginnings, without shifts of cyclic states; of bodies in scales.
    volumes : array (stretches,)
        Logarithms of the growth of a volume; of a flow NaN, and -inf where a switch wipes out a direction.
    """

    matrices: Array
    volumes: Array


def growth_in_stretches(at: Coordinates, model: Model, begins: Array, rtol: float, span: Array | None = None) -> Growth:
    """The growth over a period from each of some states, or over spans of time, right at the switches."""
    if not at.in_lanes:
        T = np.full(len(begins), float(model.period)) if span is None else span
        done = [_passage(model, state, time) for state, time in zip(begins, T.tolist(), strict=True)]
        volumes = np.array([-np.inf if each.rank_deficient else np.nan for each in done])
        return Growth(np.array([at.drifts.without(each.monodromy) for each in done]), volumes)
    scales = at.scales[: at.smooth]
    count, d = len(begins), len(scales)
    how = Directions(rtol=rtol, span=None if span is None else np.repeat(span, d), made=tangent_and_volume)
    changes = changes_along(model, np.repeat(begins, d, axis=0), np.tile(np.diag(scales), (count, 1)), how=how)
    return Growth((changes.change / scales).reshape(count, d, d).transpose(0, 2, 1), changes.volume[::d])


def derivatives_after(at: Coordinates, models: Model, states: Array, periods: int, rtol: float) -> Array:
    """Derivatives of the states of the cases of a batch after some periods, as the matrices of `Growth`: array (cases, states, states)."""
    if not at.in_lanes:
        flows = zip(cases_of(models), states, strict=True)
        return np.stack([at.drifts.without(_passage(flow, state, periods * float(flow.period)).monodromy) for flow, state in flows])
    scales = at.scales[: at.smooth]
    return jacobians_of(models, states, periods, rtol) * (scales / scales[:, None])


def rates_at(at: Coordinates, model: Model, states: Array, time: float) -> Array:
    """The rates of some states of a model without a period, times a typical time, without shifts of cyclic states; of bodies in scales."""
    if not at.in_lanes:
        fields = composed(model).fields  # type: ignore[arg-type]
        along = [fields[mode_of_strobe_state(model, state)](0.0, list(state[:-1])) for state in states]  # type: ignore[arg-type]
        return np.array([np.delete(np.array(each, float), at.drifts.free) for each in along]) * time
    h, d = _BRIEFLY * time, at.smooth
    soon, later = (flow_map(model, states, k * h).state[:, :d] for k in (1.0, 2.0))
    rates: Array = (4.0 * soon - 3.0 * states[:, :d] - later) / (2.0 * h)
    rates[:, 0] -= np.asarray(machine_of(model).far_end_velocity, float)
    return np.asarray(rates * time / at.scales[:d])


def _passage(flow: Any, state: Array, duration: float) -> Passage:
    return passage(flow, state[:-1], mode_of_strobe_state(flow, state), duration)
