"""The figures of the pages on identification: from a raw file to intervals, what a sensor does, and why error bars are large.

Run: python examples/friction_figures.py
"""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
RIG = ss.presets.piezo_rig
TRUTH = {"mu0": 0.17, "f0": 0.22}
FREE = {"mu0": (0.05, 0.5), "f0": (0.05, 0.6)}


def save(fig: Any, name: str) -> None:
    """Write one figure into docs/images."""
    fig.savefig(IMAGES / name, dpi=160, pil_kwargs={"optimize": True})
    plt.close(fig)


def bars(ax: Any, rows: list[tuple[str, float, tuple[float, float]]], truth: float) -> None:
    """Intervals one below another, with the truth as a line."""
    ax.axvline(truth, color=INK, linewidth=0.8, linestyle=(0, (2, 2)))
    for k, (_, value, (low, high)) in enumerate(rows):
        ax.plot([low, high], [k, k], color=COLOURS[k % 6], linewidth=3, solid_capstyle="butt")
        ax.plot([value], [k], "o", color=COLOURS[k % 6], markersize=5)
    ax.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    ax.set_ylim(len(rows) - 0.5, -0.5)


def from_file_to_intervals() -> None:
    """Record, fit, residuals over phase, and their correlation: the law of the record, and a simpler one."""
    record = ss.virtual_rig(RIG(tilt_deg=1.7, amplitude=5e-4, **TRUTH), noise=1e-3, seed=0)
    known = {"tilt_deg": 1.7, "amplitude": 5e-4, "starts": 16}
    right = ss.identify(record, RIG, free=FREE, **known)
    wrong = ss.identify(record, RIG, free={"mu0": (0.05, 0.5)}, law="coulomb", **known)
    with publication():
        fig, axs = plt.subplots(2, 3, figsize=(10.0, 5.0), layout="constrained")
        for row, (fit, name) in zip(axs, ((right, "the record's law, LuGre"), (wrong, "a simpler law, Coulomb")), strict=True):
            ss.plot.fitted(fit, ax=row[0])
            ss.plot.residuals(fit, ax=row[1])
            ss.plot.autocorrelation(fit, ax=row[2])
            row[1].set_title(name, fontsize=8)
            row[2].set_ylim(-0.3, 1.0)
        save(fig, "what-friction.png")


def what_a_sensor_does() -> None:
    """Intervals of the kinetic coefficient with an ideal sensor and with one in the model, for three zeros."""
    rows = []
    for offset in (0.0, 3e-4, 1e-3):
        records = [
            ss.virtual_rig(RIG(tilt_deg=3.0, amplitude=A, **TRUTH), noise=2e-3, seed=i, offset=offset) for i, A in enumerate((5e-4, 7e-4))
        ]
        known = {"tilt_deg": 3.0, "amplitude": [5e-4, 7e-4], "free": FREE, "starts": 16}
        for sensor, name in (({}, "ideal"), (None, "in the model")):
            fit = ss.identify(records, RIG, sensor=sensor, **known)
            rows.append((f"zero {1e3 * offset:g} mm/s, sensor {name}", fit.values["mu0"], fit.interval("mu0")))
    with publication():
        fig, ax = plt.subplots(figsize=(6.0, 2.6), layout="constrained")
        bars(ax, rows, TRUTH["mu0"])
        ax.set_xlabel(r"kinetic friction coefficient $\mu_0$, 95 % interval; dashed: the truth")
        save(fig, "sensor.png")


def loop(load: float, seed: int) -> ss.Record:
    """A force loop by a load cell whose zero is off by 0.4 N."""
    rng, t = np.random.default_rng(seed), np.linspace(0, 3, 600)
    v = 2e-3 * np.cos(2 * np.pi * t + 0.1)
    x = np.concatenate([[0.0], np.cumsum(v[1:] * np.diff(t))])
    F = np.where(v > 0, 0.30, -0.35) * load + 0.4 + rng.normal(0, 0.05, len(t))
    return ss.Record.of(t, {"x [m]": x, "F [N]": F, "N [N]": np.full(len(t), load)}, roles={"F": "force", "N": "load"})


def why_so_large() -> None:
    """What one loop determines is a line; a second one under another load makes it a point."""
    free = {"mu_plus": (0.2, 0.45), "mu_minus": (0.2, 0.45)}
    one = ss.identify(loop(10.0, 1), ss.Coulomb, free=free, sensor={"offset": None}, starts=4)
    two = ss.identify([loop(10.0, 1), loop(25.0, 2)], ss.Coulomb, free=free, sensor={"offset": None}, starts=4)
    (_, total, _), *_ = one.combinations
    with publication():
        fig, (plane, ax) = plt.subplots(1, 2, figsize=(8.0, 2.9), layout="constrained")
        x = np.array([0.2, 0.45])
        plane.plot(x, total - x, color=COLOURS[0], linewidth=2, label="one loop: the sum alone")
        plane.errorbar(
            two.values["mu_plus"], two.values["mu_minus"], 10 * two.errors["mu_minus"], 10 * two.errors["mu_plus"],
            fmt="o", color=COLOURS[1], markersize=4, label="two loads (10 standard errors)",
        )  # fmt: skip
        plane.plot([0.30], [0.35], "+", color=INK, markersize=11, label="truth")
        plane.set(xlabel=r"$\mu_+$", ylabel=r"$\mu_-$", xlim=(0.2, 0.45), ylim=(0.2, 0.45))
        plane.legend(loc="lower left", fontsize=6.5)
        bars(ax, [(name, f.values["mu_plus"], f.interval("mu_plus")) for name, f in (("one loop", one), ("two loads", two))], 0.30)
        ax.set_xlabel(r"$\mu_+$, 95 % interval (from bound to bound: not determined)")
        save(fig, "why-so-large.png")


if __name__ == "__main__":
    from_file_to_intervals()
    what_a_sensor_does()
    why_so_large()
