"""The figures of the pages on optimal drives. Run: python examples/optimal_drives.py (two minutes)"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import stickslip as ss
from stickslip.show.figures.style import COLOURS, DASHES, INK, publication

IMAGES = Path(__file__).parents[1] / "docs" / "images"
MILLI = 1e3
STROKE = 1.4e-3  # m
MU, UP, DOWN, L = 0.1315, 0.15, 0.25, 0.01  # the robot of the verge gait
UNCERTAIN = {"friction.mu_minus": ("uniform", 0.22, 0.28)}


# ---- the fastest drive for a tilt ----
def over_a_period(axes: list[plt.Axes]) -> None:
    """Relative acceleration and velocity of the body, for a sine and for three pieces within its stroke and acceleration."""
    rig = ss.presets.piezo_rig(tilt_deg=3.0, amplitude=STROKE / 2, law="coulomb")
    limits = {"stroke": (None, STROKE), "relative_acceleration": (None, rig.drive.amplitude * rig.drive.omega**2)}
    best = ss.optimise(rig, over={"drive": ss.optimisation.waveform(pieces=3)}, maximise="mean_velocity", subject_to=limits)
    for robot, name, colour, dashes in zip((rig, best.model), ("sine", "three pieces"), COLOURS, DASHES, strict=False):
        t = np.linspace(0.0, robot.period, 1001)
        run = ss.solve(robot, periods=60, settle=50)
        axes[0].plot(MILLI * t, robot.drive.acceleration(t + 0.0 * t), color=colour, linestyle=dashes, label=name)
        V = MILLI * ss.mean_velocity(run)
        axes[1].plot(MILLI * t, MILLI * run.at(50 * robot.period + t)["v"], color=colour, linestyle=dashes, label=f"mean {V:.2f} mm/s")
    axes[0].set_ylabel("relative acceleration (m/s²)")
    axes[1].set_ylabel("velocity $v$ (mm/s)")
    for ax in axes:
        ax.axhline(0.0, color=INK, linewidth=0.5)
        ax.set_xlabel("time $t$ (ms)")
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


# ---- the verge gait ----
def three_phases(W: np.ndarray) -> np.ndarray:
    """The fastest motion of three phases that never slips back: w1 on the verge of it, w2 = w3 = W; for W of 40 m/s^2 and more."""
    g = 9.81
    w1 = DOWN * g / MU
    u1, u3 = np.sqrt(2 * L * w1 * W / (w1 + W)), np.sqrt(L * W)
    v2 = (MU * W - UP * g) * (u1 + u3) / W
    v3 = v2 - (MU * W + UP * g) * u3 / W
    a2, a3, a1 = MU * W - UP * g, MU * W + UP * g, (DOWN + UP) * g
    T = u1 / w1 + (u1 + u3) / W + u3 / W
    return (v2**2 / (2 * a2) + (v2**2 - v3**2) / (2 * a3) + v3**2 / (2 * a1)) / T


def along_the_acceleration(ax: plt.Axes) -> None:
    """Mean velocity over the largest relative acceleration: verge gait, three phases, sine."""
    W = np.linspace(40.0, 200.0, 81)
    robot = ss.Robot(1.0 - MU, MU, ss.Harmonic(amplitude=L / 2, omega=100.0), ss.Coulomb(UP, DOWN))
    verges = [ss.drives.Pieces.verge(w, L, MU, UP, DOWN) for w in W]
    p = DOWN / (UP + DOWN)
    verge = [p**2 * d.period * (MU**2 * w**2 - UP**2 * 9.81**2) / (4 * MU * w) for d, w in zip(verges, W, strict=True)]
    sine = ss.sweep(robot, **{"drive.omega": np.sqrt(W / (L / 2))}).mean_velocity
    rows = (("verge gait", verge), ("three phases", three_phases(W)), ("sine", sine))
    for (name, V), colour, dashes in zip(rows, COLOURS, DASHES, strict=False):
        ax.plot(W, MILLI * np.asarray(V), color=colour, linestyle=dashes, label=name)
    ax.set_xlabel("largest relative acceleration (m/s²)")
    ax.set_ylabel("mean velocity $V$ (mm/s)")
    ax.legend(loc="upper left")


def one_period_of_it(ax: plt.Axes) -> None:
    """Velocity of the body and relative velocity over a period."""
    drive = ss.drives.Pieces.verge(60.0, L, MU, UP, DOWN)
    robot = ss.Robot(1.0 - MU, MU, drive, ss.Coulomb(UP, DOWN))
    run, t = ss.solve(robot, periods=30, settle=20), np.linspace(0.0, drive.period, 1201)
    ax.plot(MILLI * t, MILLI * run.at(20 * drive.period + t)["v"], color=COLOURS[0], label="body $v$")
    ax.plot(
        MILLI * t, MILLI * 0.5 * drive.velocity(t + 0.0 * t), color=COLOURS[1], linestyle=DASHES[1], label="inner mass, relative, halved"
    )
    for edge in np.cumsum(drive.durations)[:-1]:
        ax.axvline(MILLI * edge, color=INK, linewidth=0.5, linestyle=":")
    ax.axhline(0.0, color=INK, linewidth=0.5)
    ax.set_xlabel("time $t$ (ms)")
    ax.set_ylabel("velocity (mm/s)")
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


# ---- robust drives ----
def two_optima() -> list[ss.optimisation.Optimum]:
    """The fastest three phases for friction as it is thought, and those whose 5 % quantile is largest."""
    robot = ss.Robot(1.0 - MU, MU, ss.drives.ThreePhase.example(), ss.Coulomb(UP, DOWN))
    over = {"drive.u1": (0.01, 1.0), "drive.w1": (1.0, 60.0), "drive.w2": (1.0, 60.0), "drive.w3": (1.0, 60.0)}
    asked = dict(over=over, maximise="mean_velocity", subject_to={"stroke": (None, L)})
    return [ss.optimise(robot, **asked), ss.optimise(robot, **asked, robust=UNCERTAIN, quantile=0.05)]


def along_friction(ax: plt.Axes, found: list[ss.optimisation.Optimum]) -> None:
    """Mean velocity of both over the backward coefficient of friction."""
    mu = np.linspace(0.21, 0.29, 161)
    for best, name, colour, dashes in zip(found, ("nominal optimum", "robust optimum"), COLOURS, DASHES, strict=False):
        V = ss.sweep(best.model, **{"friction.mu_minus": mu}).mean_velocity
        ax.plot(mu, MILLI * V, color=colour, linestyle=dashes, label=name)
        fresh = ss.optimisation.propagate(best.model, UNCERTAIN, samples=2048, seed=99).quantile(0.05)
        ax.axhline(MILLI * fresh, color=colour, linewidth=0.6, linestyle=":")
        print(f"{name}: {MILLI * best['mean_velocity']:.3f} mm/s, 5 % quantile {MILLI * fresh:.3f}")
    ax.axvspan(0.22, 0.28, color=INK, alpha=0.08, linewidth=0)
    ax.set_xlabel(r"friction coefficient backwards $\mu_-$")
    ax.set_ylabel("mean velocity $V$ (mm/s)")
    ax.legend(loc="lower right")


def fastest(ax: plt.Axes) -> None:
    """Which numbers matter for the nominal optimum of a machine: a tornado."""
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    spread = {
        "friction.mu_plus": (0.15, "3%"),
        "friction.mu_minus": (0.21, "3%"),
        "drive.amplitude": (8e-4, "1%"),
        "body_mass": (0.06259, "1%"),
    }
    ss.plot.tornado(ss.optimisation.propagate(rig, spread, samples=512, indices=True), ax=ax)


# ---- two modules ----
def best_phases(stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The best phase between 0 and 180 degrees for each stiffness, and the mean velocity with it."""
    found = [
        ss.optimise(ss.presets.two_modules(stiffness=float(k)), over={"phases[1]": (0.0, np.pi)}, maximise="mean_velocity")
        for k in stiffness
    ]
    return np.array([each.model.phases[1] for each in found]), np.array([each["mean_velocity"] for each in found])


def which_phase(left: plt.Axes, right: plt.Axes) -> None:
    """Mean velocity over phase and stiffness with the best phase, and what it gains over modules in phase."""
    grid = ss.sweep(ss.presets.two_modules, phase=np.linspace(0.0, np.pi, 73), stiffness=np.geomspace(100.0, 1e4, 81))
    together = float(grid.mean_velocity.isel(phase=0, stiffness=0))  # modules in phase leave the spring alone
    times = np.maximum(grid.mean_velocity.T / together, 0.1)
    drawn = left.pcolormesh(
        np.degrees(grid.phase), grid.stiffness, times, cmap="viridis", norm=LogNorm(0.25, 11.0), shading="gouraud", rasterized=True
    )
    bar = left.figure.colorbar(drawn, ax=left, label="times the speed in phase", extend="min")
    bar.set_ticks([0.3, 1, 3, 10], labels=["0.3", "1", "3", "10"])
    stiffness = np.geomspace(100.0, 1e4, 33)
    phase, V = best_phases(stiffness)
    left.plot(
        np.degrees(phase),
        stiffness,
        "o",
        color="white",
        markersize=3,
        markeredgecolor=INK,
        markeredgewidth=0.5,
        label="best phase",
        clip_on=False,
    )
    left.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0))
    left.set_xticks([0, 45, 90, 135, 180])
    left.set_xlabel("phase of the second module (degrees)")
    left.set_ylabel("stiffness $k$ (N/m)")
    left.set_yscale("log")
    opposite = ss.sweep(ss.presets.two_modules, phase=np.pi, stiffness=stiffness).mean_velocity
    for each, name, colour, dashes in zip((V, opposite), ("best phase", "opposite phase"), COLOURS, DASHES, strict=False):
        right.plot(stiffness, each / together, color=colour, linestyle=dashes, label=name)
    right.axhline(1.0, color=INK, linewidth=0.5)
    right.set_xscale("log")
    right.set_yscale("log")
    right.set_yticks([0.5, 1, 2, 5, 10], labels=["0.5", "1", "2", "5", "10"])
    right.set_xlabel("stiffness $k$ (N/m)")
    right.set_ylabel("times the speed in phase")
    right.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    for k, each, v in zip(stiffness, phase, V, strict=True):
        print(f"k = {k:8.1f} N/m: {np.degrees(each):6.1f} degrees, {MILLI * v:.3f} mm/s, {v / together:.2f} times in phase")


def saved(name: str, draw: object, width: float = 7.0, height: float = 2.4) -> None:
    """Draw two panels and save them."""
    with publication():
        figure, axes = plt.subplots(1, 2, figsize=(width, height))
        draw(axes)
        figure.savefig(IMAGES / name, dpi=200)
        plt.close(figure)


def main() -> None:
    """All figures."""
    saved("fastest-drive.png", over_a_period)
    saved("verge-gait.png", lambda axes: (one_period_of_it(axes[0]), along_the_acceleration(axes[1])))
    found = two_optima()
    saved("robust-drives.png", lambda axes: (along_friction(axes[0], found), fastest(axes[1])), width=7.4)
    saved("which-phase.png", lambda axes: which_phase(*axes))


if __name__ == "__main__":
    main()
