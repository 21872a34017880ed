"""heyoka's Taylor method with its event detection, for one body under Coulomb friction: sliding is integrated, rest is waited out.

(Its Taylor series on the smooth approximation tanh(v/v0) are no way around events: far from v = 0 the series do not see the layer, and
steps pass over it.)
"""

import heyoka as hy
import numpy as np
from scipy.optimize import brentq


def mean_velocity(row):
    body, T = row["bodies"][0], row["period"]
    later = row["id"][0] in "JG"  # rows that this adapter has not been taught
    if len(row["bodies"]) > 1 or body["friction"]["law"] != "coulomb" or later:
        return None
    r, x, v = body["friction"], *hy.make_vars("x", "v")
    total = body["constant_force"] + sum(h["amplitude"] * hy.sin(h["omega"] * hy.time + h["phase"]) for h in body["forces"])

    def applied(t):
        return body["constant_force"] + sum(h["amplitude"] * np.sin(h["omega"] * t + h["phase"]) for h in body["forces"])

    equations = [(x, v), (v, (total - hy.par[0]) / body["mass"])]
    first = hy.taylor_adaptive(equations, [0.0, 0.0], pars=[0.0], tol=1e-15)  # away from v = 0, where the event would be found at once
    flow = hy.taylor_adaptive(equations, [0.0, 0.0], pars=[0.0], t_events=[hy.t_event(v)], tol=1e-15)
    places = []
    for end in (row["settle_periods"] * T, (row["settle_periods"] + row["window_periods"]) * T):
        while flow.time < end:
            if abs(flow.state[1]) < 1e-13 * row["velocity_unit"]:
                flow.state[1], f = 0.0, applied(flow.time)
                if -r["static_minus"] <= f <= r["static_plus"]:
                    t = np.linspace(flow.time, flow.time + T, 1001)
                    out = (applied(t) > r["static_plus"]) | (applied(t) < -r["static_minus"])
                    if not out.any():
                        break
                    k = int(out.argmax())
                    bound = r["static_plus"] if applied(t[k]) > 0 else -r["static_minus"]
                    instant = brentq(lambda s, b=bound: applied(s) - b, t[k - 1], t[k], xtol=1e-15)
                    if instant > end:
                        break
                    flow.time, f = instant, bound
                flow.pars[0] = first.pars[0] = r["plus"] if f > 0 else -r["minus"]
                first.time, first.state[:] = flow.time, flow.state
                first.propagate_for(1e-4 * T)
                flow.time, flow.state[:] = first.time, first.state
                flow.reset_cooldowns()
            flow.propagate_until(end)
        places.append(flow.state[0])
    return (places[1] - places[0]) / (row["window_periods"] * T)
