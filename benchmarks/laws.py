"""What each law, and each contact of a chain, costs: microseconds per drive period and case in a batch, and its ratio to LuGre, in one run.

    python benchmarks/laws.py [--cases 512] [--periods 100] [--rtol 1e-4]

A user's law is LuGre written as the README shows, against the built-in one. CPU time of one thread is counted: with every period made, and
as users call it, where a motion that has come back to the same bits is not computed again.
"""

from __future__ import annotations

import argparse
import time
from contextlib import nullcontext
from dataclasses import dataclass

import numpy as np

import stickslip as ss
from stickslip.maths import exp, pi, where
from whole import whole


@dataclass(frozen=True)
class OwnLuGre:
    """LuGre as a user writes it."""

    mu_plus: float
    mu_minus: float
    f_plus: float
    f_minus: float
    sigma0: float
    sigma1: float
    sigma2: float
    v_s: float

    def rate(self, v, z, load):
        mu, f = where(v > 0, self.mu_plus, self.mu_minus), where(v > 0, self.f_plus, self.f_minus)
        return v - self.sigma0 * abs(v) * z / (load * (mu + (f - mu) * exp(-((v / self.v_s) ** 2))))

    def force(self, v, z, zdot, load):
        return self.sigma0 * z + self.sigma1 * zdot + self.sigma2 * v

    def scale(self, load):
        return 0.5 * (self.mu_plus + self.mu_minus) * load / self.sigma0

    def velocity_scale(self):
        return self.v_s


def laws() -> dict[str, object]:
    """Every law on the paper's rig, with the same coefficients where it has them."""
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4).friction
    same = dict(mu_plus=rig.mu_plus, mu_minus=rig.mu_minus, f_plus=rig.f_plus, f_minus=rig.f_minus)
    bristle = dict(sigma0=rig.sigma0, sigma1=rig.sigma1, sigma2=rig.sigma2, v_s=rig.v_s)
    return {
        "LuGre": rig,
        "LuGre, a user's own": OwnLuGre(**same, **bristle),
        "elasto-plastic": ss.friction.ElastoPlastic(**same, **bristle, z_ba=0.7 * rig.mu_plus * 0.7 / rig.sigma0),
        "GMS, 4 elements": ss.friction.GMS(**same, sigma0=rig.sigma0, v_s=rig.v_s, attraction=100.0, sigma2=rig.sigma2),
        "Dahl, exponent 1/2": ss.Dahl(rig.mu_plus, rig.mu_minus, rig.sigma0, exponent=0.5),
        "Dahl": ss.Dahl(rig.mu_plus, rig.mu_minus, rig.sigma0),
        "Coulomb, closed arcs": ss.Coulomb(**same),
        "Coulomb + viscous": ss.CoulombViscous(**same, viscous=rig.sigma2),
        "Stribeck": ss.Stribeck(**same, v_s=rig.v_s),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=512)
    parser.add_argument("--periods", type=int, default=100)
    parser.add_argument("--rtol", type=float, default=1e-4)
    asked = parser.parse_args()
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.linspace(1e-4, 8e-4, asked.cases))
    robots = {name: rig.replace(friction=law, track=ss.Level()) for name, law in laws().items()}
    contacts = dict.fromkeys(robots, 1)
    one, spring = robots["LuGre"], ss.Spring(stiffness=1200.0, damping=0.4)
    for count in (2, 5):
        for phase in (0.0, 0.4):
            name = f"{count} modules, {f'{phase} pi apart' if phase else 'in step'}"
            contacts[name] = count
            robots[name] = ss.Chain((one,) * count, spring, tuple(phase * pi * i for i in range(count)))
    for robot in robots.values():
        ss.solve(robot, periods=2, rtol=asked.rtol)
    best = {name: [np.inf, np.inf] for name in robots}
    for _ in range(3):
        for name, robot in robots.items():
            for k, way in enumerate((whole(), nullcontext())):
                with way:
                    begin = time.process_time()
                    ss.solve(robot, periods=asked.periods, rtol=asked.rtol)
                    best[name][k] = min(best[name][k], (time.process_time() - begin) / asked.cases / asked.periods / contacts[name] * 1e6)
    print(f"{'law':26s} {'us per period':>13s} {'of LuGre':>9s} {'as users call it':>17s}")
    for name, (every, called) in best.items():
        print(f"{name:26s} {every:13.2f} {every / best['LuGre'][0]:9.2f} {called:17.2f}")


if __name__ == "__main__":
    main()
