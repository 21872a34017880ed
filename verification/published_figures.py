"""The figures of docs/known-answers.md: ``python verification/published_figures.py docs/images``."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from known_answers import START, TANG, across, cycles, impacting, two_masses

import stickslip as ss

LOG = (  # lines of the log of COCO: mu, duration
    (0.0, 2.9149), (0.012507, 3.3792), (0.019517, 3.8079), (0.02281, 4.1473), (0.024546, 4.4867), (0.024967, 4.8968),
    (0.024459, 5.1514), (0.02198, 5.6605), (0.01788, 6.1696), (0.012454, 6.6787), (0.005918, 7.1877), (0.0, 7.5951),
)  # fmt: skip


def fold_of_cycles() -> plt.Figure:
    """Duration of the cycles against mu: both branches, settled runs, and what COCO printed."""
    up = cycles((0.0125, 0.02, 0.023, 0.0242, 0.0248, 0.025), *START)
    down = cycles((0.01, 0.005, 0.0), *START)
    beyond = cycles((0.025, 0.0248, 0.0242, 0.023, 0.02, 0.015, 0.01, 0.005, 0.0), *across(up[-1]))
    figure, ax = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    lower = [(0.0, 0.005, 0.01, 0.0125, 0.02, 0.023, 0.0242, 0.0248, 0.025, TANG[0]), [o.duration for o in down[::-1] + up] + [TANG[1]]]
    upper = [(TANG[0], 0.025, 0.0248, 0.0242, 0.023, 0.02, 0.015, 0.01, 0.005, 0.0), [TANG[1]] + [o.duration for o in beyond]]
    for branch, orbits in ((lower, up), (upper, beyond)):
        ax.plot(*branch, color="tab:blue", ls="-" if orbits[1].stable else "--", label="stable" if orbits[1].stable else "unstable")
    for orbit, mu in zip(beyond, (0.025, 0.0248, 0.0242, 0.023, 0.02, 0.015, 0.01, 0.005), strict=False):
        ax.plot(mu, settled(mu, orbit), "k.", ms=9, label="_" if mu < 0.025 else "settled runs (brute force)")
    ax.plot(*zip(*LOG, strict=True), "o", mfc="none", mec="tab:red", ms=8, label="printed by COCO")
    ax.plot(*TANG, "s", color="tab:orange", label="fold")
    ax.set(xlabel="μ", ylabel="duration of the cycle")
    ax.legend()
    return figure


def settled(mu: float, orbit: ss.FlowOrbit) -> float:
    """Time between the last two hits of a long run that begins a little beside the cycle."""
    run = ss.passage(impacting(mu), orbit.state * (1 + 1e-3), 0, 600.0)
    return run.events[-1].t - run.events[-2].t


def impact_duffing() -> plt.Figure:
    """Strobe points of the two masses against the frequency: branches over brute force."""
    flow = two_masses()
    guess = ss.flow_orbit(flow.replace(w=1.47), [0.1, 0.0, 0.0, 0.0], 0, settle=60)
    branch = ss.continuation(flow, parameter="w", start=1.47, stop=1.355, guess=guess)
    diagram = ss.bifurcation(
        flow,
        parameter="w",
        values=np.linspace(1.356, 1.47, 58),
        settle=200,
        points=24,
        follow=False,
        start={"x1": 0.1, "x2": 0.0, "v1": 0.0, "v2": 0.0},
    )
    return ss.plot.continuation([branch, branch.switched(stop=1.355)], diagram=diagram, observable="x1").figure


def main(folder: str) -> None:
    """Both figures, as PNG files."""
    for draw, name in ((fold_of_cycles, "known_fold"), (impact_duffing, "known_duffing")):
        draw().savefig(Path(folder) / f"{name}.png", dpi=160)


if __name__ == "__main__":
    main(sys.argv[1])
