"""The commands that README and docs show run, page by page, as a reader would type them."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from house import PAGES, ROOT, blocks
from stickslip.show.cli import main

#: Tested by themselves: the explorer serves until it is stopped, the paper takes minutes.
ELSEWHERE = ("stickslip explore", "stickslip paper")
FITTED = """
[identify]
make = "piezo_rig"
records = ["a.csv", "b.csv"]
[identify.arguments]
tilt_deg = 1.7
amplitude = [5e-4, 8e-4]
[identify.free]
mu0 = [0.05, 0.5]
"""

MINE = """
from dataclasses import dataclass
from stickslip.maths import where

@dataclass(frozen=True)
class Mine:
    mu: float

    def sliding(self, v, load):
        return where(v > 0, self.mu, -self.mu) * load + 0.5 * v

    def breakaway(self, load):
        return -self.mu * load, self.mu * load
"""


def commands(page):
    """The lines of a page's shell blocks that call stickslip and are not transcripts."""
    lines = "\n".join(block.text for block in blocks(page, "bash")).replace("\\\n", " ").splitlines()
    return [line.partition("  #")[0].strip() for line in lines if line.startswith("stickslip ")]


def typed(line):
    """The words of a line, patterns of files filled in. Maps are made small: how many values a range has changes no grammar."""
    words = [re.sub(r":\d{2,}\b", ":2", word) for word in shlex.split(line)[1:]]
    return [name for word in words for name in (sorted(map(str, Path().glob(word))) if "*" in word else [word])]


def prepared(page):
    """Files that a page speaks of."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
    Path("study.toml").write_text(FITTED if page.stem == "identification" else robot.to_toml(), encoding="utf-8")
    if page.stem == "identification":
        for name, amplitude in (("a.csv", 5e-4), ("b.csv", 8e-4)):
            rec = ss.virtual_rig(robot.replace({"drive.amplitude": amplitude}), noise=1e-4, seed=1, periods=8)
            rec.save(name)
    if page.stem == "what-friction":  # its own Python code writes them
        for i, amplitude in enumerate((5e-4, 8e-4)):
            rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, mu0=0.17, f0=0.22), noise=1e-3, seed=i, periods=8)
            columns = np.column_stack([rec["velocity"].time, 1e3 * rec["velocity"].si])
            np.savetxt(f"run{i}.csv", columns, delimiter=",", header="t [s],LDV [mm/s]", comments="")
    if page.stem == "bench":  # a law of the reader's own
        Path("mine.py").write_text(MINE, encoding="utf-8")
    if page.stem.endswith(("-its-log", "-its-csv")):  # the first block of its own Python code writes the file
        exec(blocks(page, "python")[0].text, {})
    if page.stem == "on-a-cluster":
        for k in (1, 2):
            words = ["piezo_rig", "law=coulomb", "tilt_deg=0..6:9", "amplitude=1e-4..8e-4:9", "--tile", "40"]
            assert main(["sweep", *words, "--out", f"part{k}", "--shard", f"{k}/2"]) == 0


SHOWN = {page.relative_to(ROOT).as_posix(): page for page in PAGES if [c for c in commands(page) if not c.startswith(ELSEWHERE)]}


#: Pages whose commands take seconds each.
SLOW = ("docs/bench.md", "docs/tutorials/servo-from-its-log.md", "docs/tutorials/rig-from-its-csv.md")


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in SHOWN])
def test_the_commands_on_a_page_run(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    prepared(SHOWN[name])
    for line in commands(SHOWN[name]):
        if not line.startswith(ELSEWHERE):
            capsys.readouterr()
            assert main(typed(line)) == 0, f"{line}\n{capsys.readouterr().err}"


def test_there_are_pages_with_commands():
    assert len(SHOWN) > 5 and commands(ROOT / "docs" / "explorer.md")
