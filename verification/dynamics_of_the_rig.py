"""The figures of docs/dynamics.md, and its table: section 5 of the paper judged by multipliers and exponents.

Run: python verification/dynamics_of_the_rig.py FOLDER [--table] [--window] [--basins] [--map]. Without options all of it, in
about 15 minutes on one core; the map takes most of that. Its grid is kept in FOLDER/chaos_map.nc and taken from there next time.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

import stickslip as ss

RIG = dict(tilt_deg=1.7, amplitude=6e-4)
#: Figure or sentence of section 5 -> arguments of the preset; amplitudes are inferred (the paper prints none).
CASES = {
    "5.2, ω = 46π": dict(omega=46 * math.pi),
    "5.2, ω = 52π": dict(omega=52 * math.pi),
    "5.2, ω = 65π": dict(omega=65 * math.pi),
    "5.2, ω = 80π": dict(omega=80 * math.pi),
    "Fig. 22, μ0 = .03": dict(mu0=0.03),
    "Fig. 23, μ0 = .04": dict(mu0=0.04),
    "5.3, μ0 = .05": dict(mu0=0.05),
    "5.3, μ0 = .10": dict(mu0=0.10),
    "5.3, μ0 = .21": dict(mu0=0.21),
    "not in it: A = .4 mm, μ0 = .05": dict(amplitude=4e-4, mu0=0.05),
    "not in it: A = .5 mm, μ0 = .04": dict(amplitude=5e-4, mu0=0.04),
    "not in it: μ0 = .038": dict(mu0=0.038),
}


def table() -> None:
    """Print the table in Markdown."""
    print("| case | verdict | largest multiplier | largest exponent per period |\n|---|---|---|---|")
    for name, case in CASES.items():
        found = ss.verdict(ss.presets.piezo_rig(**{**RIG, **case}), periods=2000 if "not in it: A" in name else 400, settle=400)
        kind = found.kind + (f", period {found.period}" if found.period else "")
        multiplier = "–" if found.orbit is None else f"{found.orbit.multipliers[0]:.4g}"
        exponent = found.exponents
        print(f"| {name} | {kind} | {multiplier} | {exponent.largest:.3f} ± {exponent.error:.3f} |".replace("-", "−"), flush=True)


def window(folder: Path) -> None:
    """The window of doubling: branches of period 1, 2 and 4 over the strobe points of brute force."""
    one = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.05, stop=0.034, **RIG)
    two = one.doubled()
    four = two.doubled()
    brute = ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=np.linspace(0.034, 0.05, 600), follow=False, settle=500, **RIG)
    for branch in (one, two, four):
        print(branch)
    ss.plot.continuation([one, two, four], diagram=brute).figure.savefig(folder / "dynamics_window.png", dpi=200)


def basins(folder: Path) -> None:
    """Two motions of one robot, and which start leads to which."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, f0=0.5)
    found = ss.basins(robot, v=np.linspace(-0.1, 0.1, 121), z=np.linspace(-2e-6, 2e-6, 61), settle=100)
    print(found)
    ss.plot.basins(found).figure.savefig(folder / "dynamics_basins.png", dpi=200)


def motions(folder: Path) -> None:
    """Period number and exponent around the paper's values."""
    import xarray as xr

    kept = folder / "chaos_map.nc"
    if not kept.exists():
        axes = dict(mu0=np.linspace(0.032, 0.08, 60), amplitude=np.linspace(3e-4, 9e-4, 80))
        found = ss.dynamics.chaos_map(ss.presets.piezo_rig, **axes, tilt_deg=1.7, settle=300, periods=150, workers=2, progress=True)
        found.to_netcdf(kept, engine="h5netcdf")
    grid = xr.load_dataset(kept, engine="h5netcdf")
    chaotic = ((grid.period == 0) & (grid.exponent > 3 * grid.error)).mean()
    shares = {p: round(float((grid.period == p).mean()), 3) for p in (1, 2, 4)}
    print(f"shares of period {shares}, chaotic {float(chaotic):.3f}, largest exponent {float(grid.exponent.max()):.3f}")
    branch = ss.continuation(ss.presets.piezo_rig, parameter="mu0", start=0.05, stop=0.0345, step=0.1, rtol=1e-8, **RIG)
    curves = [ss.dynamics.special_curve(branch, branch.special[0], "amplitude", stop, step=0.1) for stop in (9.5e-4, 2.5e-4)]
    ss.plot.chaos_map(grid, curves=curves).figure.savefig(folder / "dynamics_map.png", dpi=200)


def main() -> None:
    """Do what was asked."""
    made = argparse.ArgumentParser(description=__doc__)
    made.add_argument("folder", type=Path)
    for name in ("table", "window", "basins", "map"):
        made.add_argument(f"--{name}", action="store_true")
    asked = made.parse_args()
    everything = not (asked.table or asked.window or asked.basins or asked.map)
    if asked.table or everything:
        table()
    for wanted, draw in ((asked.window, window), (asked.basins, basins), (asked.map, motions)):
        if wanted or everything:
            draw(asked.folder)


if __name__ == "__main__":
    main()
