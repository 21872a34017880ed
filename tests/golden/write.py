"""Write one file of each format as this version writes it: ``python tests/golden/write.py``; what is there is never written again."""

import json
from pathlib import Path

import numpy as np

import stickslip as ss
from stickslip.results.storage import FORMAT

HERE = Path(__file__).parent


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
    known = json.loads((HERE / "numbers.json").read_text()) if (HERE / "numbers.json").exists() else {}
    (HERE / "numbers.json").write_text(json.dumps(known | numbers, indent=1) + "\n")


if __name__ == "__main__":
    main()
