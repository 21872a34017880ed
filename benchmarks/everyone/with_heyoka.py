"""heyoka's Taylor method with its event detection, for one body under Coulomb friction: sliding is integrated, rest is waited out.

(Its Taylor series on the smooth approximation tanh(v/v0) are no way around events: far from v = 0 the series do not see the layer, and
steps pass over it.)
"""

import heyoka as hy
import numpy as np
from scipy.optimize import brentq


def mean_velocity(row):
    body, T = row["bodies"][0], row["period"]
    if len(row["bodies"]) > 1 or row["stops"] or body["friction"]["law"] != "coulomb":
        return None
    r, x, v = body["friction"], *hy.make_vars("x", "v")
    belt = r.get("surface", 0.0)

    def applied(t, x, v, sin):
        pull = sum(spring["stiffness"] * x + spring["damping"] * v for spring in row["springs"])
        given = sum(h["amplitude"] * sin(h["omega"] * t + h["phase"]) for h in body["forces"])
        return body["constant_force"] + given - body.get("gravity_torque", 0.0) * sin(x) - pull

    def moves(t, x):  # how far the force on a body that goes with the belt is beyond what friction holds
        f = applied(t, x, belt, np.sin)
        return np.maximum(f - r["static_plus"], -r["static_minus"] - f)

    def breaks_away(t0, x0, end):  # the first instant at which friction holds it no longer, if there is one
        beyond = lambda t: moves(t, x0 + belt * (t - t0))  # noqa: E731
        for k in range(int(np.ceil((end - t0) / T)) if belt else 1):  # without a belt each period is as the last one
            t = np.minimum(np.linspace(t0 + k * T, t0 + (k + 1) * T, 1001), end)
            out = beyond(t) > 0
            if out.any():
                j = int(out.argmax())
                yield brentq(beyond, t[j - 1], t[j], xtol=1e-15) if j else t[0]
                return

    equations = [(x, v), (v, (applied(hy.time, x, v, hy.sin) - hy.par[0]) / body["mass"])]
    start = [body.get("position", 0.0), body.get("velocity", 0.0)]
    first = hy.taylor_adaptive(equations, start, pars=[0.0], tol=1e-15)  # away from rest, where the event would be found at once
    flow = hy.taylor_adaptive(equations, start, pars=[0.0], t_events=[hy.t_event(v - belt)], tol=1e-15)
    places = []
    for end in (row["settle_periods"] * T, (row["settle_periods"] + row["window_periods"]) * T):
        while flow.time < end:
            if abs(flow.state[1] - belt) < 1e-13 * row["velocity_unit"]:
                t0, x0 = flow.time, flow.state[0]
                instant = next(breaks_away(t0, x0, end), end)
                flow.time, flow.state[:] = instant, (x0 + belt * (instant - t0), belt)
                if instant == end:  # it rests until then
                    break
                flow.pars[0] = first.pars[0] = r["plus"] if applied(instant, flow.state[0], belt, np.sin) > 0 else -r["minus"]
                first.time, first.state[:] = flow.time, flow.state
                first.propagate_for(1e-4 * T)
                flow.time, flow.state[:] = first.time, first.state
                flow.reset_cooldowns()
            flow.propagate_until(end)
        places.append(flow.state[0])
    return (places[1] - places[0]) / (row["window_periods"] * T)
