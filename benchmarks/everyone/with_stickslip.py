"""stickslip as an adapter: a row becomes a machine."""

import math
from dataclasses import dataclass
from typing import Any

import stickslip as ss
from stickslip.maths import sin


def force_on(body):
    gravity = body.get("gravity_torque", 0.0)

    def force(t, x, v):
        driven = sum(f["amplitude"] * sin(f["omega"] * t + f["phase"]) for f in body["forces"])
        return body["constant_force"] + driven - (gravity * sin(x) if gravity else 0.0)

    return force


@dataclass(frozen=True, eq=False)
class Rows(ss.Machine):
    row: Any
    gravity: float = 9.81

    @property
    def period(self):
        return self.row["period"]

    def bodies(self):
        bodies = enumerate(self.row["bodies"])
        return {str(i): ss.Body(b["mass"], force=force_on(b), position=b.get("position", 0.0)) for i, b in bodies}

    def contacts(self):
        rubbing = [(i, b["friction"]) for i, b in enumerate(self.row["bodies"]) if b["friction"]]
        return {str(i): ss.Contact(str(i), law(f), load=1.0, on=f.get("surface")) for i, f in rubbing}

    def links(self):
        named = (((str(s["between"][0]), None if s["between"][1] is None else str(s["between"][1])), s) for s in self.row["springs"])
        return {ends: ss.Spring(s["stiffness"], s["damping"]) for ends, s in named}

    def stops(self):
        return {tuple(map(str, s["between"])): ss.Stop(**{k: v for k, v in s.items() if k != "between"}) for s in self.row["stops"]}


def law(friction):
    """Friction forces in newton are coefficients under a load of 1 N."""
    given = dict(mu_plus=friction["plus"], mu_minus=friction["minus"], f_plus=friction["static_plus"], f_minus=friction["static_minus"])
    if friction["law"] == "coulomb":
        return ss.Coulomb(**given)
    return ss.LuGre(**given, **{name: friction[name] for name in ("sigma0", "sigma1", "sigma2", "v_s")})


def mean_velocity(row):
    periods = row["settle_periods"] + row["window_periods"]
    start = {"v": {str(i): b.get("velocity", 0.0) for i, b in enumerate(row["bodies"])}}
    run = ss.solve(Rows(row), periods=periods, settle=row["settle_periods"], rtol=1e-11, start=start)
    x = [run.bodies[str(row["of_body"])].x[abs(run.t - k * row["period"]).argmin()] for k in (row["settle_periods"], periods)]
    return (x[1] - x[0]) / (row["window_periods"] * row["period"]) if math.isfinite(x[1]) else math.nan
