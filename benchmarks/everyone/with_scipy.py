"""SciPy as most people would use it: LSODA, with sign(v) replaced by tanh(v/v0). No set-valued friction, no restitution."""

import numpy as np
from scipy.integrate import solve_ivp

V0 = 1e-4  # of the row's velocity unit


def applied(body, t, x):
    gravity = body.get("gravity_torque", 0.0) * np.sin(x)
    return body["constant_force"] + sum(h["amplitude"] * np.sin(h["omega"] * t + h["phase"]) for h in body["forces"]) - gravity


def mean_velocity(row):
    if any("restitution" in stop for stop in row["stops"]):
        return None
    n, bodies = len(row["bodies"]), row["bodies"]

    def rhs(t, y):
        x, v, z = y[:n], y[n : 2 * n], y[2 * n :]
        f, dz = np.array([applied(body, t, q) for body, q in zip(bodies, x, strict=True)]), np.zeros(n)
        for link in row["springs"] + row["stops"]:
            i, j = link["between"]
            apart, rate = (x[i], v[i]) if j is None else (x[i] - x[j], v[i] - v[j])
            e = max(apart - link["gap"], 0.0) if "gap" in link else apart
            pull = link["stiffness"] * e + link.get("damping", 0.0) * rate
            f[i] -= pull
            if j is not None:
                f[j] += pull
        for i, r in ((i, b["friction"]) for i, b in enumerate(bodies) if b["friction"]):
            side = "plus" if v[i] > r.get("surface", 0.0) else "minus"
            if r["law"] == "coulomb":
                f[i] -= r[side] * np.tanh((v[i] - r.get("surface", 0.0)) / (V0 * row["velocity_unit"]))
            else:
                g = r[side] + (r[f"static_{side}"] - r[side]) * np.exp(-((v[i] / r["v_s"]) ** 2))
                dz[i] = v[i] - r["sigma0"] * abs(v[i]) / g * z[i]
                f[i] -= r["sigma0"] * z[i] + r["sigma1"] * dz[i] + r["sigma2"] * v[i]
        return np.concatenate([v, f / [b["mass"] for b in bodies], dz])

    ends = row["period"] * np.array([row["settle_periods"], row["settle_periods"] + row["window_periods"]])
    begun = [b.get(name, 0.0) for name in ("position", "velocity", "deflection") for b in bodies]
    done = solve_ivp(rhs, (0, ends[1]), begun, method="LSODA", t_eval=ends, rtol=1e-6, atol=1e-12, max_step=row["period"] / 20)
    x = done.y[row["of_body"]]
    return (x[1] - x[0]) / (ends[1] - ends[0])
