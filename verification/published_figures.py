"""The figures of notes/known-answers.md: ``python verification/published_figures.py docs/images``."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from known_answers import GHOSH, START, TANG, across, cycles, impacting, pecking, two_masses
from published_systems import DAMPING, LEINE, every_other

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

LOG = (  # lines of the log of COCO: mu, duration
    (0.0, 2.9149), (0.012507, 3.3792), (0.019517, 3.8079), (0.02281, 4.1473), (0.024546, 4.4867), (0.024967, 4.8968),
    (0.024459, 5.1514), (0.02198, 5.6605), (0.01788, 6.1696), (0.012454, 6.6787), (0.005918, 7.1877), (0.0, 7.5951),
)  # fmt: skip

SICONOS = (  # lines of its file, second period: time, angle and rate of the sleeve, angle and rate of the bird
    (0.14800, -0.10345, -0.0000, -0.29309, -7.6433), (0.15540, -0.10345, 0.0000, -0.35270, -8.5059),
    (0.16280, -0.10345, 0.0000, -0.41959, -9.6171), (0.17020, -0.10345, 0.0000, -0.49248, -8.3797),
    (0.17760, -0.10345, 0.0000, -0.52877, -1.2819), (0.18500, -0.10345, 0.0000, -0.51089, 6.0421),
    (0.19240, -0.10345, 0.0000, -0.44199, 12.3001), (0.19980, -0.10345, 0.0000, -0.33423, 16.3882),
    (0.20720, -0.10345, -0.0000, -0.20662, 17.5853), (0.21460, -0.10163, 3.6029, -0.07754, 17.0867),
    (0.22200, 0.06628, 25.4064, 0.03570, 15.0481), (0.22940, 0.10365, 0.0000, 0.10424, -6.2418),
    (0.23680, 0.05941, -11.2962, 0.06219, -5.1856), (0.24420, 0.02517, -0.5775, 0.01920, -6.1878),
    (0.25160, -0.03058, -10.0664, -0.02178, -5.3006), (0.25900, -0.05463, -2.3894, -0.06572, -6.0184),
    (0.26640, -0.10295, 0.2576, -0.10744, -6.2958), (0.27380, -0.10347, 0.0000, -0.15408, -6.3785),
    (0.28120, -0.10347, 0.0000, -0.20225, -6.6721), (0.28860, -0.10347, -0.0000, -0.25331, -7.1608),
)  # fmt: skip
FLIPS = (  # files of VIVID: forcing, frequency
    (0.324483, 0.854810), (0.325924, 0.839810), (0.333421, 0.824810), (0.347533, 0.810000), (0.349769, 0.808190), (0.352378, 0.806190),
    (0.355136, 0.804190), (0.358049, 0.802190),
)  # fmt: skip
FOLDS = (
    (0.361890, 0.799701), (0.362406, 0.799341), (0.362836, 0.799000), (0.363876, 0.797838), (0.364271, 0.796638), (0.364003, 0.795438),
    (0.363106, 0.794238), (0.361627, 0.793038), (0.359618, 0.791838),
)  # fmt: skip


def fold_of_cycles() -> plt.Figure:
    """Duration of the cycles against mu: both branches, settled runs, and what COCO printed."""
    fold, ends = TANG[0], np.sqrt(1.0 - np.array([0.0125, 0.025]) / TANG[0])  # durations change as the square root of the distance in mu
    near = (0.0125, *(fold * (1.0 - np.linspace(*ends, 30)[1:-1] ** 2)).tolist(), 0.025)
    away = np.linspace(0.0125, 0.0, 16)[1:].tolist()
    back = (0.025, *(fold * (1.0 - np.linspace(ends[1], 1.0, 60)[1:-1] ** 2)).tolist(), 0.0)
    up, down = cycles(near, *START), cycles(tuple(away), *START)
    beyond = cycles(back, *across(up[-1]))
    figure, ax = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    lower = [(*away[::-1], *near, fold), [*(o.duration for o in down[::-1] + up), TANG[1]]]
    upper = [(fold, *back), [TANG[1], *(o.duration for o in beyond)]]
    for branch, orbits in ((upper, beyond), (lower, up)):
        ax.plot(*branch, color=COLOURS[0], ls="-" if orbits[1].stable else "--", label="stable" if orbits[1].stable else "unstable")
    looked = [int(np.argmin(abs(np.array(back) - mu))) for mu in (0.025, 0.0248, 0.0242, 0.023, 0.02, 0.015, 0.01, 0.005)]
    runs = [(back[k], settled(back[k], beyond[k])) for k in looked]
    ax.plot(*zip(*runs, strict=True), ".", color=INK, ms=9, label="settled runs (brute force)")
    ax.plot(*zip(*LOG, strict=True), "o", mfc="none", mec=COLOURS[1], ms=8, label="printed by COCO")
    ax.plot(*TANG, "s", color=COLOURS[1], label="fold")
    ax.set(xlabel="μ", ylabel="duration of the cycle")
    ax.legend()
    return figure


def settled(mu: float, orbit: ss.dynamics.PeriodicOrbit) -> float:
    """Time between the last two hits of a long run that begins a little beside the cycle."""
    run = ss.dynamics.passage(impacting(mu), orbit.state * (1 + 1e-3), 0, 600.0)
    return run.events[-1].t - run.events[-2].t


def impact_duffing() -> plt.Figure:
    """Strobe points of the two masses against the frequency: branches over brute force."""
    flow = two_masses()
    guess = ss.dynamics.flow_orbit(flow.replace(w=1.47), [0.1, 0.0, 0.0, 0.0], 0, settle=60)
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


def curves_of_hits() -> plt.Figure:
    """Flips and folds of the motions that hit a wall every other period, over forcing and frequency."""
    figure, ax = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    drawn = {"flip": ((0.36, 0.345), [-1.7325, 0.1989], (0.8549, 0.8004)), "fold": ((0.37, 0.36), [-1.8115, 0.1224], (0.7998, 0.7917))}
    for (kind, ((begin, stop), guess, ends)), colour in zip(drawn.items(), ("tab:blue", "tab:green"), strict=True):
        flow = every_other(GHOSH[kind][0])
        start = ss.dynamics.flow_orbit(flow.replace(F=begin), guess, 0, periods=2, settle=100)
        branch = ss.continuation(flow, parameter="F", start=begin, stop=stop, guess=start, period=2)
        special = next(s for s in branch.special if s.kind == kind)
        parts = [ss.dynamics.special_curve(branch, special, "w", stop=end, step=0.005).values for end in ends]
        ax.plot(*np.concatenate([parts[0][::-1], parts[1]]).T, color=colour, label=f"{kind}s")
    for k, points in enumerate((FLIPS, FOLDS)):
        ax.plot(*np.array(points).T, "o", mfc="none", mec="tab:red", ms=7, label="_" if k else "computed by VIVID")
    w = np.linspace(0.7917, 0.8549, 200)
    ax.plot(np.sqrt((1 - w * w) ** 2 + (DAMPING * w) ** 2), w, "k:", label="free swing grazes the wall")
    ax.set(xlabel="forcing F", ylabel="frequency ω", xlim=(0.3, 0.38))
    ax.legend()
    return figure


def phases_of_pecking() -> plt.Figure:
    """Rates against angles of the woodpecker toy, sleeve and bird."""
    orbit = pecking()
    states = np.array([ss.dynamics.passage(orbit.model, orbit.state, orbit.mode, t).state for t in np.linspace(1e-9, orbit.duration, 1500)])
    figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.6), layout="constrained")
    for k, (ax, name) in enumerate(zip(axes, ("sleeve", "bird"), strict=True)):
        ax.plot(states[:, k], states[:, 3 + k], color="tab:blue", lw=1)
        ax.plot(*np.array(SICONOS)[:, [1 + 2 * k, 2 + 2 * k]].T, "o", mfc="none", mec="tab:red", ms=6, label="computed by Siconos")
        ax.plot(LEINE[k], LEINE[3 + k], "s", color="tab:orange", label="printed by Leine")
        ax.set(xlabel=f"angle of the {name} [rad]", ylabel="rate [rad/s]")
    axes[1].legend()
    return figure


def main(folder: str) -> None:
    """All figures, as PNG files."""
    figures = (
        (fold_of_cycles, "known_fold"),
        (impact_duffing, "known_duffing"),
        (phases_of_pecking, "known_woodpecker"),
        (curves_of_hits, "known_curves"),
    )
    for draw, name in figures:
        with publication():
            figure = draw()
            figure.savefig(Path(folder) / f"{name}.png", dpi=1280 / figure.get_figwidth())


if __name__ == "__main__":
    main(sys.argv[1])
