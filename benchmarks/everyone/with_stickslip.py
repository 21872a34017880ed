"""stickslip as an adapter: a row becomes a machine."""

import math
from dataclasses import dataclass
from typing import Any

import stickslip as ss
from stickslip.maths import sin


@dataclass(frozen=True, eq=False)
class Rows(ss.Machine):
    row: Any
    gravity: float = 9.81

    @property
    def period(self):
        return self.row["period"]

    def bodies(self):
        def force(body):
            return lambda t, x, v: body["constant_force"] + sum(f["amplitude"] * sin(f["omega"] * t + f["phase"]) for f in body["forces"])

        return {str(i): ss.Body(body["mass"], force=force(body)) for i, body in enumerate(self.row["bodies"])}

    def contacts(self):
        return {str(i): ss.Contact(str(i), law(b["friction"]), load=1.0) for i, b in enumerate(self.row["bodies"]) if b["friction"]}

    def links(self):
        return {tuple(map(str, s["between"])): ss.Spring(s["stiffness"], s["damping"]) for s in self.row["springs"]}

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
    run = ss.solve(Rows(row), periods=periods, settle=row["settle_periods"], rtol=1e-9)
    x = [run.bodies[str(row["of_body"])].x[abs(run.t - k * row["period"]).argmin()] for k in (row["settle_periods"], periods)]
    return (x[1] - x[0]) / (row["window_periods"] * row["period"]) if math.isfinite(x[1]) else math.nan
