"""Cost of a period of machines in coordinates of their own, beside machines of two bodies on a line, in one run.

Run: python benchmarks/places.py [--cases 256] [--rounds 7]

A line machine has two bodies on a spring, each with a contact (or the first alone); the others have two coordinates and one contact: a
pendulum on a cart whose load is given, or whose rail presses as the motion asks. All are pushed at the same frequency. Microseconds of
processor time per period, compiled, every period made: the least of the rounds, in which the machines take turns; steps of one run; and the
ratio to the line machine with two contacts. Compare ratios only.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.maths import cos, pi, sin
from whole import whole

G = 9.81


@dataclass(frozen=True, eq=False)
class Pushed(ss.Machine):
    """What all of them have."""

    push: float
    omega: float
    friction: Any

    @property
    def period(self) -> Any:
        """That of the push."""
        return 2 * pi / self.omega


@dataclass(frozen=True, eq=False)
class Line(Pushed):
    """Two bodies on a spring, the first of which is pushed."""

    both = True

    def bodies(self) -> dict[str, Any]:
        """Of one kilogram each."""
        return {"first": ss.Body(1.0, force=lambda t, x, v: self.push * sin(self.omega * t)), "second": ss.Body(1.0)}

    def contacts(self) -> dict[str, Any]:
        """On the plane."""
        return {name: ss.Contact(name, self.friction, load=0.65 * G) for name in ("first", "second")[: 2 if self.both else 1]}

    def links(self) -> dict[Any, Any]:
        """About as stiff as the weight of the pendulum."""
        return {("first", "second"): ss.Spring(20.0)}


class OneContact(Line):
    """The second body hangs."""

    both = False


@dataclass(frozen=True, eq=False)
class Given(Pushed):
    """A pendulum on a cart, whose load is the weight of both."""

    coordinates = ("x", "angle")

    def bodies(self) -> dict[str, Any]:
        """Cart and bob."""
        return {"cart": ss.Body(1.0), "bob": ss.Body(0.3)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Where both are."""
        return {"cart": (q["x"], 0.0), "bob": (q["x"] + 0.5 * sin(q["angle"]), -0.5 * cos(q["angle"]))}

    def forces(self, t: Any, q: Any, u: Any) -> dict[str, Any]:
        """The push."""
        return {"x": self.push * sin(self.omega * t)}

    def contacts(self) -> dict[str, Any]:
        """The rail."""
        return {"rail": ss.Contact("cart", self.friction, load=1.3 * G)}


class Rail(Given):
    """The rail presses as the motion asks."""

    def contacts(self) -> dict[str, Any]:
        """On both sides."""
        return {"rail": ss.Contact("cart", self.friction, hold="both")}


MACHINES = {"line, two contacts": Line, "line, one contact": OneContact, "places, load given": Given, "places, rail": Rail}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args()
    law, many = ss.Coulomb(0.1, 0.1), np.linspace(3.0, 6.0, given.cases)
    single, batch = {name: make(4.0, 5.0, law) for name, make in MACHINES.items()}, {n: m(many, 5.0, law) for n, m in MACHINES.items()}
    steps = {name: ss.solve(machine, periods=50).counts["steps"] / 50 for name, machine in single.items()}
    doings = {"one run": (single, 400, 1), "batch": (batch, 30, given.cases)}
    for what, (machines, periods, cases) in doings.items():
        cost = {name: np.inf for name in machines}
        for _ in range(given.rounds + 1):  # the first compiles
            for name, machine in machines.items():
                began = time.process_time()
                with whole():
                    run = ss.solve(machine, periods=periods, keep="summary", workers=1)
                cost[name] = min(cost[name], (time.process_time() - began) / periods / cases)
                assert np.all(np.isfinite(run.mean_velocity)), name
        for name, seconds in cost.items():
            ratio = seconds / cost["line, two contacts"]
            print(f"{what:8} {name:20} {1e6 * seconds:8.2f} us a period of {steps[name]:.1f} steps, {ratio:.2f} times")


if __name__ == "__main__":
    main()
