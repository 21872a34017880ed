"""``stickslip check``: solve one robot with several methods and count the certain digits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli import show
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import ROBOT, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Solve one robot with several methods and report how many digits of its mean velocity are certain.",
    arguments=(
        *ROBOT,
        argument("--no-scipy", action="store_true", help="leave out scipy's integrator, which takes most of the time"),
    ),
    example="""\
$ stickslip check piezo_rig tilt_deg=1.7 amplitude=5.56e-4 law=coulomb-static periods=40
piezo_rig tilt_deg=1.7 amplitude=0.000556 law=coulomb-static
judge           setting           periods  mean velocity [m/s]  difference [m/s]  time [s]
exact arcs      no tolerance      40       2.032038697782e-03   +0.0e+00          …      the reference
closed formula  periodic motion   3        2.032038697782e-03   +0.0e+00          …      against a run until the strobe point repeats
scipy dop853    rtol 1e-11        12       2.032038697780e-03   -1.6e-15          …      against the reference over the same 12 periods
RK4             2000 per period   40       2.035635669148e-03   +3.6e-06          …
RK4             10000 per period  40       2.035297461162e-03   +3.3e-06          …
RK4             50000 per period  40       2.035404788403e-03   +3.4e-06          …

energy balance: worst residual 5.8e-15 of the largest energy exchanged in a period
11 digits of the mean velocity 2.0320386978e-03 m/s are certain: our exact arcs, the closed formula and scipy agree to 1.6e-15 m/s.
The RK4 rows show what fixed steps give; they do not count.
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    study = subject(asked.robot, asked.settings, solver=("periods", "duration", "rtol", "start.x", "start.v", "start.z"), strict=False)
    robot = study.robot()

    from stickslip.analysis.checking import check

    result = check(robot, scipy=not asked.no_scipy, progress=show.stages(quiet=True), **study.options)
    return Outcome({"robot": study.title(), **result.to_dict()}, f"{study.title()}\n{result}")
