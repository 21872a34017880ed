"""``stickslip fit``: friction from a log in one command: what each column is taken for, parameters with intervals, figures, Python."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import Problems
from stickslip.show.cli import recorded
from stickslip.show.cli.arguments import settings
from stickslip.show.cli.declaring import RECORDS, SENSOR, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_HERE = ("--unit", "--role", "--columns", "--rate", "--scale", "--separator", "--decimal")


@command(
    about="Fit friction to a log: says what each column is taken for and why, fits laws, and reports parameters with intervals.",
    more="""\
example: stickslip fit servo.log --out servo
         stickslip fit rig.csv --unit Kraft=N --unit Weg=mm --set load=20 --law stribeck
         stickslip fit servo.csv --set kp=38 --set motor_constant=2.1 --set resistance=3 --set inertia=0.023 --set gravity_torque=1.5
         stickslip fit robot.csv --set amplitude=0.5mm --set tilt_deg=0 --set body_mass=60g --set inner_mass=10g --asymmetric

A force over a motion is a friction rig, a torque or a current over an angle a joint, a commanded angle beside the measured one a servo,
a velocity alone a shaken robot.""",
    arguments=(
        argument("files", metavar="FILE", nargs="+", help="a log in any format that ss.read reads; several are fitted together"),
        argument("--machine", metavar="NAME", help="rig, slider, joint, servo or robot (default: what the file has)"),
        argument("--law", metavar="NAME", help="one law, such as stribeck (default: several are compared)"),
        argument(
            "--set",
            action="append",
            metavar="NAME=VALUE",
            default=[],
            help="what is known, in SI units or with its unit: load=20, amplitude=0.5mm; amplitude=5e-4,8e-4 for two files",
        ),
        argument("--asymmetric", action="store_true", help="a coefficient for each direction"),
        SENSOR,
        argument("--starts", type=int, default=16, metavar="N", help="starting points of each search (default 16)"),
        *(each for each in RECORDS if each.names[0] in _HERE),
        argument("--out", metavar="FOLDER", help="write figures, report and Python there"),
    ),
    example="""\
$ stickslip run coulomb_robot alpha_plus=0.1 alpha_minus=0.1 periods=20 --data run.csv
…
$ stickslip fit run.csv --law coulomb --machine slider --sensor ideal --starts 2
                 taken as …
…
machine          slider: a body under a measured force, with a mass that is fitted too …
law              coulomb …
symmetry         one coefficient for both directions …
reading: the columns are those of a run of stickslip: computed, not measured

Coulomb fitted to 1 record, 8041 values; 1 parameter free
  mu = 0.09902 ± 0.00015 N   95 % 0.09872 to 0.09932
…
  symmetry: mu: mean of both directions 0.09902 ± 0.00015 N, half difference 0.00007 ± 0.00015 N: one coefficient for both is enough
…
verdict: coulomb is supported: what is left is noise
figures, report and Python: --out FOLDER
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    from stickslip.inverse.logs import fit
    from stickslip.show.cli.commands.identify import sensor_typed

    problems = Problems("fit")
    numbers = settings(asked.set, True, problems)
    sensor = sensor_typed(asked.sensor, problems)
    problems.check()
    reading = {
        "columns": None if asked.columns is None else [part.strip() for part in asked.columns.split(",")],
        "rate": asked.rate,
        "scale": recorded.pairs(asked.scale, "--scale"),
        "separator": {"tab": "\t", "\\t": "\t", "space": " "}.get(asked.separator or "", asked.separator or None),
        "decimal": asked.decimal,
    }
    with recorded.in_words_of_the_shell():
        made = fit(
            asked.files, machine=asked.machine, law=asked.law, numbers=numbers, asymmetric=asked.asymmetric, sensor=sensor,
            units=recorded.pairs(asked.unit, "--unit"), roles=recorded.pairs(asked.role, "--role"), starts=asked.starts,
            progress=True, **{name: value for name, value in reading.items() if value},
        )  # fmt: skip
    written = [str(path) for path in made.save(asked.out)] if asked.out is not None else []
    text = recorded.in_command_words(str(made.report()))
    ends = [f"written to {', '.join(written)}"] if written else ["figures, report and Python: --out FOLDER"]
    return Outcome(lambda: _numbers(made, written), "\n".join([text, *ends]))


def _numbers(made: Any, written: list[str]) -> dict[str, Any]:
    """The result as JSON."""
    from dataclasses import asdict

    from stickslip.show.cli.commands.identify import numbers_of

    return {
        "machine": made.machine, "law_name": made.law, "proposals": [asdict(each) for each in made.proposals], "verdict": made.verdict,
        "supported": made.supported, "symmetry": [str(each) for each in made.symmetry], "open": list(made.questions), "next": list(made.next),
        "python": made.python, "written": written, **numbers_of(made.fit, made.fit.intervals, 0.95, "auto"),
    }  # fmt: skip
