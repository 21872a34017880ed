"""Whether a change made anything slower: two versions of the sources, in turn, in one run on one machine.

    python benchmarks/before_after.py 2282772 HEAD [--runs 10] [--only import]

Processes of the two versions follow one another on one pinned core, A B B A A B ...; each makes all calls, warmed up, and prints the CPU
seconds of each. Imports and compilation have processes of their own. Python's own compilation of the sources (.pyc) is done before, as
where a package is installed. A row is the median of the ratios pair by pair, new over old, with the second smallest and the second
largest; and the ratio of the least of each, on which other work on the machine has the smallest part.
Needs git and the packages that both versions import; with --python OLD NEW each has an interpreter of its own, with packages of its own.
"""

from __future__ import annotations

import pin  # noqa: F401  # isort: skip  # one core, for these processes too

import argparse
import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RIG = "import numpy as np, stickslip as ss\nfrom time import process_time\nrig = ss.presets.piezo_rig\n"
LAWS = """A = np.linspace(4e-4, 8e-4, 512)
friction = rig(tilt_deg=1.7, amplitude=6e-4).friction
same = dict(mu_plus=friction.mu_plus, mu_minus=friction.mu_minus, f_plus=friction.f_plus, f_minus=friction.f_minus)
bristle = dict(sigma0=friction.sigma0, sigma1=friction.sigma1, sigma2=friction.sigma2, v_s=friction.v_s)
"""


EMPTY = 'import os, tempfile\nos.environ["STICKSLIP_CACHE_DIR"] = tempfile.mkdtemp()\n'


def timed(setup: str, work: str, repeat: int = 3) -> str:
    """A program that does the work once to warm up, and prints the least of some measurements."""
    body = "\n".join("    " + line for line in work.splitlines())
    return (
        f"{RIG}{setup}def work():\n{body}\nwork()\nspent = []\n"
        f"for _ in range({repeat}):\n    begin = process_time(); work(); spent.append(process_time() - begin)\nprint(min(spent))"
    )


def batch(law: str, periods: int, rtol: float = 1e-4) -> str:
    """512 robots of one law."""
    return timed(
        LAWS + f"robot = rig(tilt_deg=0.0, amplitude=A).replace(friction={law})\n",
        f'ss.solve(robot, periods={periods}, keep="summary", rtol={rtol})',
    )


def briefly(model: str, more: str = "") -> str:
    """Two periods of one model again and again: what a call of `solve` costs apart from its steps."""
    return timed(LAWS + f"model = {model}\n", f"for _ in range(100): ss.solve(model, {more or 'periods=2'})", 5)


def new_laws(law: str) -> str:
    """Two periods under a class of law of its own each time: what a kind costs when it is met, without compilation."""
    return timed(
        LAWS + f"law, robot = {law}, rig(tilt_deg=0.0, amplitude=6e-4)\n",
        "for _ in range(10):\n"
        '    own = type("Own", (type(law),), {"__module__": "__main__"})\n'
        "    ss.solve(robot.replace(friction=own(**{name: getattr(law, name) for name in law.__dataclass_fields__})), periods=2)",
        4,
    )


def machines(preset: str) -> str:
    """A batch of a machine of the presets."""
    return timed(f"model = ss.presets.{preset}\n", 'ss.solve(model, periods=20, keep="summary")')


def compiled(law: str) -> str:
    """The kernels of one law, in an empty cache folder."""
    asked = f'robot = rig(tilt_deg=0.0, amplitude=A).replace(friction={law})\nss.solve(robot, periods=1, keep="summary")\n'
    return f"{EMPTY}{RIG}{LAWS}begin = process_time()\n{asked}print(process_time() - begin)"


def clocked(work: str) -> str:
    """A program that prints the time of its work, done once."""
    return f"import time\nbegin = time.process_time()\n{work}\nprint(time.process_time() - begin)"


ELASTO_PLASTIC = "ss.friction.ElastoPlastic(**same, **bristle, z_ba=0.7 * friction.mu_plus * 0.7 / friction.sigma0)"
GMS = "ss.friction.GMS(**same, sigma0=friction.sigma0, v_s=friction.v_s, attraction=100.0, sigma2=friction.sigma2)"
FLOW = """ss.SwitchingFlow(
    {0: lambda t, y: (y[1], -9.81)}, {0: (ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1])),)}, states=("height", "v")
)"""
OSCILLATOR = """from stickslip.maths import cos
F, r = 0.3, 0.7
def offered(t, y): return -y[0] + cos(r * t)
def after(t, y): return 1 if offered(t, y) > F else -1 if offered(t, y) < -F else 0
def stop(t, y): return y[0], 0.0
flow = ss.SwitchingFlow(
    {1: lambda t, y: (y[1], offered(t, y) - F), -1: lambda t, y: (y[1], offered(t, y) + F), 0: lambda t, y: (0.0 * y[0], 0.0)},
    {1: (ss.Switch(lambda t, y: y[1], after, stop),), -1: (ss.Switch(lambda t, y: -y[1], after, stop),),
     0: (ss.Switch(lambda t, y: F - offered(t, y), 1), ss.Switch(lambda t, y: F + offered(t, y), -1))},
    2 * np.pi / r, states=("x", "v"))
"""
BRANCH = 'ss.continuation(rig, parameter="amplitude", start=5e-4, stop=6e-4, tilt_deg=1.7, law="coulomb")'
#: Calls, which are timed one after the other in one process.
CALLS = {
    "LuGre, 512 robots": batch("friction", 60),
    "LuGre, 512 robots, 1e-7": batch("friction", 30, 1e-7),
    "elasto-plastic, 512 robots": batch(ELASTO_PLASTIC, 40),
    "GMS, 512 robots": batch(GMS, 30),
    "Coulomb, 512 robots, closed arcs": batch("ss.Coulomb(**same)", 1000),
    "Stribeck, 512 robots, Taylor arcs": batch("ss.Stribeck(**same, v_s=friction.v_s)", 30),
    "one LuGre run": timed("robot = rig(tilt_deg=1.7, amplitude=6e-4)\n", "for _ in range(20): ss.solve(robot, periods=60).v"),
    "one Coulomb run": timed(
        'robot = rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")\n', "for _ in range(20): ss.solve(robot, periods=60).v"
    ),
    "solve, Coulomb": briefly('rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")'),
    "solve, LuGre": briefly("rig(tilt_deg=1.7, amplitude=6e-4)"),
    "solve, LuGre, summary": briefly("rig(tilt_deg=1.7, amplitude=6e-4)", 'periods=2, keep="summary"'),
    "solve, Stribeck": briefly("rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=ss.Stribeck(**same, v_s=friction.v_s))"),
    "solve, a new robot each time": timed(
        "robot = rig(tilt_deg=1.7, amplitude=6e-4)\n",
        "for k in range(100): ss.solve(robot.replace(inner_mass=robot.inner_mass * (1 + 1e-6 * k)), periods=2)",
        5,
    ),
    "solve, a new law each time, Coulomb": new_laws("ss.Coulomb(**same)"),
    "solve, a new law each time, LuGre": new_laws("friction"),
    "solve, two modules": briefly("ss.presets.two_modules(amplitude=6e-4)"),
    "solve, a belt": briefly("ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))", "duration=2.0"),
    "solve, a flow": briefly(FLOW, 'duration=2.0, start={"height": 1.0}'),
    "two modules, 512 cases": machines("two_modules(amplitude=np.linspace(5e-4, 7e-4, 512))"),
    "conveyors, 512 cases": machines("conveyor(throw_index=np.linspace(2.4, 2.6, 512))"),
    "one run on a belt": timed(
        "belt = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))\n",
        "for _ in range(10): ss.solve(belt, duration=100.0).v",
    ),
    "a map, 96 x 96": timed("", "ss.map(rig, amplitude=np.linspace(4e-4, 8e-4, 96), omega=np.linspace(150.0, 250.0, 96), tilt_deg=1.7)", 2),
    "a sweep of Coulomb robots": timed("", 'ss.sweep(rig, amplitude=np.linspace(4e-4, 8e-4, 4096), tilt_deg=1.7, law="coulomb")'),
    "a flow's orbit": timed(OSCILLATOR, "ss.periodic_orbit(flow).multipliers"),
    "a flow's period, its derivatives": timed(OSCILLATOR, "for _ in range(100): ss.dynamics.passage(flow, [1.0, 0.5], 1, 2 * np.pi / r)"),
    "orbit and multipliers": timed("", "for A in (5e-4, 6e-4, 7e-4): ss.periodic_orbit(rig(tilt_deg=1.7, amplitude=A)).multipliers"),
    "continuation": timed("", BRANCH),
    "exponents": timed("", "ss.lyapunov(rig(tilt_deg=1.7, amplitude=4e-4, mu0=0.05), periods=60)", 2),
    "basins": timed(
        "", "ss.basins(rig(tilt_deg=1.7, amplitude=8e-4, mu0=0.05), v=np.linspace(-0.1, 0.1, 24), z=np.linspace(-1e-6, 1e-6, 2))", 1
    ),
}
#: What needs a process of its own: it begins with an import.
FRESH = {
    "compile, Coulomb": compiled("ss.Coulomb(**same)"),
    "compile, LuGre": compiled("friction"),
    "compile, Stribeck": compiled("ss.Stribeck(**same, v_s=friction.v_s)"),
    "compile, elasto-plastic": compiled(ELASTO_PLASTIC),
    "compile, GMS": compiled(GMS),
    "compile, Dahl": compiled("ss.Dahl(friction.mu_plus, friction.mu_minus, friction.sigma0)"),
    "import": clocked("import stickslip"),
    "import and solve's module": clocked("import stickslip as ss; ss.solve; ss.Robot"),
    "stickslip --help": clocked(
        'import contextlib, io, runpy, sys\nsys.argv[1:] = ["--help"]\n'
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n"
        '    runpy.run_module("stickslip", run_name="__main__")'
    ),
}


#: The environment of every measurement; with PYTHONDONTWRITEBYTECODE each import would compile all sources.
SURROUNDINGS = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def measure(python: str, tree: Path, cache: Path, programs: list[str]) -> list[float]:
    """Seconds that some programs print, one after the other in one process, with the sources of one version."""
    env = {**SURROUNDINGS, "PYTHONPATH": str(tree / "src"), "STICKSLIP_CACHE_DIR": str(cache), "NUMBA_NUM_THREADS": "1"}
    together = f"for program in {programs!r}: exec(program, {{'__name__': '__main__'}})"
    done = subprocess.run([python, "-c", together], env=env, capture_output=True, text=True, cwd=tree)
    if done.returncode:
        sys.exit(f"{tree}: {done.stderr[-2000:]}")
    return [float(number) for number in done.stdout.split()]


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("old")
    asked.add_argument("new")
    asked.add_argument("--runs", type=int, default=10)
    asked.add_argument("--only", default="", help="measurements whose name contains this")
    asked.add_argument("--python", nargs=2, default=[sys.executable] * 2, metavar=("OLD", "NEW"), help="their interpreters")
    given = asked.parse_args()
    with tempfile.TemporaryDirectory() as work:
        trees = [Path(work) / name for name in ("old", "new")]
        for tree, version, python in zip(trees, (given.old, given.new), given.python, strict=True):
            subprocess.run(["git", "-C", ROOT, "worktree", "add", "--quiet", "--detach", tree, version], check=True)
            subprocess.run([python, "-m", "compileall", "-q", tree / "src"], env=SURROUNDINGS, check=True)
        try:
            asked_for = [{name: program for name, program in CALLS.items() if given.only in name}]
            asked_for += [{name: program} for name, program in FRESH.items() if given.only in name]
            for works in filter(None, asked_for):
                runs: list[list[list[float]]] = []
                with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C: what is complete is reported
                    for k in range(given.runs):
                        seconds = {}
                        for tree, python in list(zip(trees, given.python, strict=True))[:: -1 if k % 2 else 1]:
                            seconds[tree] = measure(python, tree, Path(work) / f"cache-{tree.name}", list(works.values()))
                        runs.append([seconds[tree] for tree in trees])
                for k, name in enumerate(works if runs else ()):
                    report(name, [(old[k], new[k]) for old, new in runs])
        finally:
            for tree in trees:
                subprocess.run(["git", "-C", ROOT, "worktree", "remove", "--force", tree], check=True)


def report(name: str, pairs: list[tuple[float, ...]]) -> None:
    """One row."""
    ratios = sorted(new / old for old, new in pairs)
    low, high = ratios[min(1, len(ratios) - 1)], ratios[max(len(ratios) - 2, 0)]
    old, new = (statistics.median(side) for side in zip(*pairs, strict=True))
    least = min(new for _, new in pairs) / min(old for old, _ in pairs)
    print(f"{name:36} {statistics.median(ratios):6.3f}  ({low:.3f} to {high:.3f})  {least:6.3f}   {old:.4f} s -> {new:.4f} s", flush=True)


if __name__ == "__main__":
    main()
