"""A study of 600 tiles whose process is killed (kill -9) at 200 random instants, and resumed each time: it must be the same to the bit.

``python verification/killed_studies.py`` prints how many kills fell where, and how long it took from the call of `sweep` to the first new
tile. As many studies are computed as are needed for the kills; each is compared file by file with one that nobody disturbed.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.studies.folder import StudyFolder

KILLS, SPAN = 200, 0.25  # how many, and the longest time after the first new tile [s]
AXES: dict[str, Any] = dict(amplitude=np.linspace(3e-4, 9e-4, 120), mu=np.linspace(0.1, 0.2, 50), tile=10)


def rig(amplitude: float, mu: float) -> ss.Robot:
    """A robot, or many."""
    return ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude, omega=205.46), ss.Coulomb(mu, 0.21))


def resumed(folder: Path, pipe: int) -> None:
    """Go on with a study; the time to its first new tile goes to a pipe."""
    began, write, told = time.monotonic(), StudyFolder.write, False

    def timed(study: StudyFolder, *tile: Any) -> None:
        nonlocal told
        write(study, *tile)
        if not told:
            told = True
            os.write(pipe, f"{time.monotonic() - began:.4f}\n".encode())

    StudyFolder.write = timed  # type: ignore[method-assign]
    ss.sweep(rig, **AXES, out=folder, resume=True)


def killed(folder: Path, longest: float, rng: np.random.Generator) -> tuple[bool, float]:
    """Resume in a process of its own and kill it at a random instant: whether it was killed, and the time to its first new tile."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        resumed(folder, writer)
        os._exit(0)
    os.close(writer)
    time.sleep(rng.uniform(0.0, longest))
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    with os.fdopen(reader) as pipe:
        text = pipe.read()
    return os.WIFSIGNALED(status), float(text) if text else float("nan")


def files(folder: Path) -> dict[str, bytes]:
    """Every file of a study; of the manifest without the instant at which it was begun."""
    found = {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    manifest = json.loads(found.pop("manifest.json"))
    del manifest["begun"], manifest["checksum"]
    return found | {"manifest": json.dumps(manifest).encode()}


def main() -> int:
    """Kill, resume, compare."""
    rng, place = np.random.default_rng(38), Path(tempfile.mkdtemp())
    ss.sweep(rig, **AXES, out=place / "whole")
    whole = files(place / "whole")
    kills, studies, same, waits, before, longest = 0, 0, 0, list[float](), 0, 0.5
    while kills < KILLS:
        study = place / f"study-{studies}"
        while kills < KILLS:
            was_killed, wait = killed(study, longest, rng)
            kills += was_killed
            before += was_killed and not np.isfinite(wait)
            waits += [wait] if np.isfinite(wait) else []
            longest = float(np.median(waits[-20:])) + SPAN if np.isfinite(wait) else 1.2 * longest  # so that half of the kills come later
            if not was_killed:
                break
        ss.sweep(rig, **AXES, out=study, resume=True)
        studies += 1
        same += files(study) == whole
        shutil.rmtree(study)
    shutil.rmtree(place)
    print(f"{kills} kills ({before} before the first new tile) of {studies} studies of 600 tiles: {same} the same to the bit")
    print(f"from the call to the first new tile: median {np.median(waits):.2f} s, longest {max(waits):.2f} s")
    return int(same != studies)


if __name__ == "__main__":
    sys.exit(main())
