"""The figures of the pages on moving tracks: a piezo stage and a conveyor. Run: python examples/moving_tracks.py [stage_laws ...]"""

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

IMAGES = Path(__file__).parent.parent / "docs" / "images"
NANO, MICRO, MILLI = 1e9, 1e6, 1e3


def cycles(ax: plt.Axes) -> None:
    """Three cycles of the tip and of the slider under two laws."""
    for law, name, colour in (("coulomb", "Coulomb", COLOURS[0]), ("lugre", "LuGre", COLOURS[1])):
        stage = ss.presets.stick_slip_stage(law=law)
        run = ss.solve(stage, periods=13)
        t = np.linspace(10.0, 13.0, 1500) * stage.period
        start = float(run.at(t[0])["x"])
        ax.plot((t - t[0]) * MILLI, (run.at(t)["x"] - start) * MICRO, color=colour, label=name)
    ax.plot((t - t[0]) * MILLI, stage.along.position(t) * MICRO, color=INK, linewidth=0.5, alpha=0.6, label="tip")
    ax.set_xlabel("time $t$ (ms)")
    ax.set_ylabel("position (µm)")
    ax.legend(loc="upper left")
    ax.set_title("three cycles")


def by_stroke(ax: plt.Axes) -> None:
    """Step against the stroke of the tip."""
    strokes = np.linspace(0.1e-6, 5e-6, 60)
    for law, name, colour in (("coulomb", "Coulomb", COLOURS[0]), ("lugre", "LuGre", COLOURS[1])):
        grid = ss.sweep(ss.presets.stick_slip_stage, stroke=strokes, law=law, periods=60)
        ax.plot(strokes * MICRO, grid.mean_velocity * 1e-3 * MICRO, color=colour, label=name)
    ax.set_xlabel("stroke $L$ (µm)")
    ax.set_ylabel("step in a cycle (µm)")
    ax.legend(loc="upper left")
    ax.set_title("step against stroke")


PRESLIDING = {"sigma0": 1e7, "v_s": 2e-3, "f_plus": None, "f_minus": None}
#: Laws with one friction coefficient, and but for Coulomb's with one stiffness of the contact.
LAWS = {
    "Coulomb": ss.Coulomb(0.1, 0.1),
    "LuGre": ss.LuGre(0.1, 0.1, sigma1=100.0, sigma2=0.0, **PRESLIDING),
    "elasto-plastic": ss.friction.ElastoPlastic(0.1, 0.1, sigma1=100.0, sigma2=0.0, z_ba=1.4e-7, **PRESLIDING),
    "GMS": ss.friction.GMS(0.1, 0.1, attraction=1e5, **PRESLIDING),
}


def smooth(stroke: np.ndarray | float) -> ss.MultiHarmonic:
    """Two harmonics, sin u - sin 2u / 4 times an amplitude, from -stroke/2 to stroke/2; largest where cos u = (1 - sqrt 3) / 2."""
    turn = (1 - np.sqrt(3)) / 2
    amplitude = 0.5 * stroke / (np.sqrt(1 - turn**2) * (1 - turn / 2))
    return ss.MultiHarmonic(frequency=1000.0, amplitudes=(amplitude, 0.25 * amplitude), phases=(0.0, np.pi))


def steps(ax: plt.Axes, tip: Callable[[np.ndarray], object], title: str, most: float, laws: int) -> None:
    """Step against the stroke of a waveform under the first of the laws."""
    strokes = np.linspace(most / 40, most, 40)
    for (name, law), colour in list(zip(LAWS.items(), COLOURS, strict=False))[:laws]:
        grid = ss.solve(ss.MovingTrack(mass=0.02, along=tip(strokes), friction=law, load=20.0), periods=120, keep="summary")
        ax.plot(strokes * MICRO, grid.mean_velocity * 1e-3 * MICRO, color=colour, label=name)
    ax.set_xlabel("stroke $L$ (µm)")
    ax.set_ylabel("step in a cycle (µm)")
    ax.legend(loc="upper left")
    ax.set_title(title)


def loops(ax: plt.Axes) -> None:
    """Friction against how far the slider is from the tip, in a small stroke that makes no step."""
    t = np.linspace(40.0, 41.0, 2000) * 1e-3
    for (name, law), colour in list(zip(LAWS.items(), COLOURS, strict=False))[1:]:
        run = ss.solve(ss.MovingTrack(mass=0.02, along=smooth(1e-6), friction=law, load=20.0), periods=42)
        at = run.at(t)
        apart = at["x"] - run.model.along.position(t)
        ax.plot((apart - apart.mean()) * NANO, at["friction_force"], color=colour, label=name)
    ax.set_xlabel("slider from tip, about the mean (nm)")
    ax.set_ylabel("friction force (N)")
    ax.legend(loc="upper left")
    ax.set_title("smooth waveform, stroke 1 µm")


def closed(load: np.ndarray, against: float) -> np.ndarray:
    """The step where the slider comes to rest on the tip before it turns; NaN elsewhere."""
    back, forth = (0.1 * load + against) / 0.02, (0.1 * load - against) / 0.02
    with np.errstate(divide="ignore"):
        step = 5e-6 / 0.95e-3 * 1e-3 - 0.5 * back * 0.05e-3**2 * (1 + back / forth)
        return np.where((forth > 0) & (0.05e-3 * back <= 0.95e-3 * forth), step, np.nan)


def by_load(ax: plt.Axes) -> None:
    """Step against the preload, with and without a force against it."""
    fine, loads = np.linspace(2.0, 60.0, 400), np.linspace(6.0, 60.0, 10)
    for against, colour in ((0.0, COLOURS[0]), (0.5, COLOURS[1])):
        ax.plot(fine, closed(fine, against) * MICRO, color=colour, label=f"{against:g} N against it")
        grid = ss.sweep(ss.presets.stick_slip_stage, load=loads, force=-against, periods=60)
        ax.plot(loads, grid.mean_velocity * 1e-3 * MICRO, "o", color=colour, markersize=3.5, markeredgecolor="white")
    ax.set_xlabel("preload $N$ (N)")
    ax.set_ylabel("step in a cycle (µm)")
    ax.legend(loc="lower right")
    ax.set_title("step against preload")


def hop(ax: plt.Axes) -> None:
    """Two cycles of a part that hops: its velocity, and its height over the track."""
    feeder = ss.presets.conveyor(throw_index=2.5)
    run = ss.solve(feeder, periods=32)
    t = np.linspace(30.0, 32.0, 2000) * feeder.period
    at, shown = run.at(t), (t - t[0]) * MILLI
    ax.plot(shown, feeder.along.velocity(t) * MILLI, color=INK, linewidth=0.5, alpha=0.6, label="track")
    ax.plot(shown, at["v"] * MILLI, color=COLOURS[0], label="part")
    ax.set_xlabel("time $t$ (ms)")
    ax.set_ylabel("velocity along (mm/s)")
    height = ax.twinx()
    height.fill_between(shown, at["z"][:, 0] * MILLI, color=COLOURS[1], alpha=0.35, linewidth=0)
    height.set_ylabel("height over the track (mm)")
    height.set_ylim(0.0, 3.0 * float(at["z"][:, 0].max()) * MILLI)
    ax.legend(loc="upper center", ncols=2)
    ax.set_ylim(-300.0, 400.0)
    ax.set_title("two cycles at $\\Gamma = 2.5$")


def by_index(ax: plt.Axes) -> None:
    """Speed against the throw index."""
    indices = np.linspace(0.2, 3.2, 90)
    for angle, colour in zip((20.0, 30.0, 40.0), COLOURS, strict=False):
        grid = ss.sweep(ss.presets.conveyor, throw_index=indices, angle_deg=angle, periods=300)
        ax.plot(indices, grid.mean_velocity * MILLI, color=colour, label=f"$\\beta$ = {angle:g}°")
    ax.set_xlabel("throw index $\\Gamma$")
    ax.set_ylabel("speed (mm/s)")
    ax.legend(loc="upper left")
    ax.set_title("speed against throw index")


def by_angle(ax: plt.Axes) -> None:
    """Speed against the angle of the swing."""
    angles = np.linspace(5.0, 70.0, 90)
    for index, colour in zip((0.9, 1.5, 2.5), COLOURS, strict=False):
        grid = ss.sweep(ss.presets.conveyor, throw_index=index, angle_deg=angles, periods=300)
        ax.plot(angles, grid.mean_velocity * MILLI, color=colour, label=f"$\\Gamma$ = {index:g}")
    ax.set_xlabel("angle $\\beta$ (degrees)")
    ax.set_ylabel("speed (mm/s)")
    ax.legend(loc="upper right")
    ax.set_title("speed against angle")


def presliding(ax: plt.Axes) -> None:
    """Steps of a sawtooth."""
    steps(ax, lambda stroke: ss.drives.Sawtooth(stroke, rise=0.95e-3, fall=0.05e-3), "sawtooth", 2e-6, 3)


def rounded(ax: plt.Axes) -> None:
    """Steps of the smooth waveform."""
    steps(ax, smooth, "smooth waveform", 10e-6, 4)


FIGURES = {
    "stage": (cycles, by_stroke, by_load),
    "stage_laws": (presliding, rounded, loops),
    "conveyor": (hop, by_index, by_angle),
}


def main() -> None:
    """Draw the figures, or those that are named."""
    for name, panels in FIGURES.items():
        if sys.argv[1:] and name not in sys.argv[1:]:
            continue
        with publication():
            figure, axes = plt.subplots(1, 3, figsize=(10.2, 3.0), layout="constrained")
            for ax, panel in zip(axes, panels, strict=True):
                panel(ax)
            figure.savefig(IMAGES / f"{name}.png", dpi=200)


if __name__ == "__main__":
    main()
