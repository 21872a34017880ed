"""Write one file of each format as this version writes it: ``python tests/golden/write.py``; what is there is never written again."""

import json
from pathlib import Path

import numpy as np

import stickslip as ss
from stickslip.dynamics.atlas.atlas_study import _FORMAT as ATLAS
from stickslip.engine.equation_identity import equation_hash
from stickslip.results.storage import FORMAT
from stickslip.studies.manifest import FORMAT as STUDY

HERE = Path(__file__).parent
PLANE = {
    "over": {"tilt_deg": [1.0, 2.0], "amplitude": [4e-4, 6e-4]},
    "law": "coulomb",
    "starts": 1,
    "settle": 5,
    "limit": 10,
    "refine": 0,
    "branches": 2,
}


def main():
    """Write what is missing, with the numbers that a reader has to find in it."""
    numbers = {}
    for law in ("coulomb", "lugre"):
        run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law=law), periods=3, samples=20)
        name = f"run-{law}-format-{FORMAT}.nc"
        if not (HERE / name).exists():
            run.save(HERE / name)
            numbers[name] = {"x": float(run.x[-1]), "v": float(run.v[-1]), "events": len(run.events)}
    if not (HERE / "record.csv").exists():
        t = np.arange(50) / 1000
        ss.Record.of(t, {"v [mm/s]": np.sin(40 * t), "F1 [N]": np.cos(40 * t)}).save(HERE / "record.csv")
        numbers["record.csv"] = {"v": float(np.sin(40 * t[-1])), "F1": float(np.cos(40 * t[-1]))}
    if not (HERE / "robot.toml").exists():
        (HERE / "robot.toml").write_text(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4).to_toml())
    if not (folder := HERE / f"study-format-{STUDY}").exists():
        grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=[1.0, 1.7], law="coulomb", out=folder)
        ss.studies.export(grid, HERE / f"grid-format-{STUDY}.nc")
        numbers[folder.name] = numbers[f"grid-format-{STUDY}.nc"] = {"mean_velocity": grid.mean_velocity.values.tolist()}
    if not (folder := HERE / f"atlas-format-{ATLAS}").exists():
        made = ss.atlas(ss.presets.piezo_rig, out=folder, **PLANE)
        (folder / "plane.json").write_text(json.dumps(PLANE) + "\n")
        robot = ss.presets.piezo_rig(tilt_deg=1.0, amplitude=4e-4, law=PLANE["law"])
        numbers[folder.name] = {"regions": made.regions, "equations": equation_hash(robot)}
    if not (HERE / "run.csv").exists():
        run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=1, settle=0, samples=20)
        for name in ("run.csv", "run.mat", "run.xlsx"):
            ss.studies.export(run, HERE / name)
            numbers[name] = {"x": run.x.tolist(), "v": run.v.tolist()}
    known = json.loads((HERE / "numbers.json").read_text()) if (HERE / "numbers.json").exists() else {}
    (HERE / "numbers.json").write_text(json.dumps(known | numbers, indent=1) + "\n")


if __name__ == "__main__":
    main()
