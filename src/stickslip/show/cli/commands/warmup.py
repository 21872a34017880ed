"""``stickslip warmup``: compile the usual kernels now instead of at their first use."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stickslip.show.cli.declaring import command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Compile the usual kernels now, for every later process.",
    example="""\
$ stickslip warmup
8 kernels are ready
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    times = {}
    for name, work in _kernels().items():
        begin = time.perf_counter()
        work()
        times[name] = time.perf_counter() - begin
        print(f"{name}: {times[name]:.1f} s", file=sys.stderr, flush=True)
    return Outcome({"seconds": times}, f"{len(times)} kernels are ready")


def _kernels() -> dict[str, Callable[[], Any]]:
    """The kernels of the presets: single runs and batches, loose and tight tolerances, exact, and fixed steps."""
    import numpy as np

    from stickslip.models.presets import piezo_rig
    from stickslip.solvers import solve

    def work(law: str, **options: Any) -> Callable[[], Any]:
        amplitude = np.array([5e-4, 6e-4]) if options.get("keep") == "summary" else 5e-4  # a single case uses the single-run kernel
        return lambda: solve(piezo_rig(tilt_deg=1.7, amplitude=amplitude, law=law), periods=2, **options)

    kernels: dict[str, Callable[[], Any]] = {}
    for keep, many in (("trajectory", "one case"), ("summary", "many cases")):
        for rtol in (1e-6, 1e-4):
            kernels[f"LuGre, {many}, rtol {rtol:g}"] = work("lugre", keep=keep, rtol=rtol)
        kernels[f"Coulomb, {many}"] = work("coulomb", keep=keep)
    return kernels | {f"{law}, fixed steps": work(law, method="rk4") for law in ("lugre", "coulomb")}
