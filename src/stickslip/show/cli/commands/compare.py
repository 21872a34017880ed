"""``stickslip compare``: compare a measured record with friction laws."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.show.cli import recorded, show
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import FIGURES, RECORDS, ROBOT, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Compare a record with several laws, aligned in phase: mean velocity, type, rms over the cycle.",
    more="example: stickslip compare piezo_rig tilt_deg=1.7 amplitude=5.56e-4 --record run.csv --laws coulomb,lugre --report out.html",
    arguments=(
        *ROBOT,
        argument("--record", metavar="FILE", required=True, help="the measured record"),
        argument("--laws", metavar="A,B", help="laws (default: those whose numbers the robot has; of others they are fitted)"),
        *RECORDS,
        argument("--report", metavar="FILE", ends=(".html",), help="write an offline HTML page (.html)"),
        argument("--figure", metavar="FILE", ends=FIGURES, help="draw record and laws (.png, .svg or .pdf)"),
    ),
    example="""\
$ stickslip run piezo_rig tilt_deg=1.7 amplitude=5.56e-4 periods=40 --data run.csv
piezo_rig tilt_deg=1.7 amplitude=0.000556
  mean velocity      0.001786509 m/s
…
  made by            stickslip 0.1.0, Taylor12 at rtol 1e-06
$ stickslip compare piezo_rig tilt_deg=1.7 amplitude=5.56e-4 --record run.csv
piezo_rig tilt_deg=1.7 amplitude=0.000556
         mean velocity [m/s]  type        rms [m/s]    R²
record   0.001786506          IV
Coulomb  0.002035336          III         0.0004846    0.99273
LuGre    0.001786509          I           …
noise of the record 1.7e-08 m/s; over the cycle LuGre is closest
note: the first 2 drive periods differ from the later ones and are not compared with steady motion; --settle 0 takes them as steady
note: the record is synthetic
note: the record's type is IV, LuGre I: a record counts as at rest below a speed, a law with inner states below a part of its sliding force, so one motion may get two types; judge by rms and R²
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    _check_robot(asked.robot)
    study = subject(asked.robot, asked.settings, solver=())

    from stickslip.inverse.identification import compare

    with recorded.in_words_of_the_shell():
        rec = recorded.opened_record(asked.record, asked)
        comparison = compare(rec, study.robot(), laws=_laws(asked.laws, study), settle=recorded.settle(asked))
    if asked.report is not None:
        comparison.report(asked.report)
    if asked.figure is not None:
        show.draw_to(asked.figure, comparison.plot().figure)
    record = {
        "robot": study.title(),
        "rows": comparison.to_table(),
        "noise": comparison.noise,
        "best": comparison.best.label,
        "notes": list(comparison.notes),
    }
    written = [f"written to {path}" for path in (asked.report, asked.figure) if path is not None]
    return Outcome(record, "\n".join([study.title(), recorded.in_command_words(str(comparison)), *written]))


def _check_robot(name: str) -> None:
    """Check that the model is a robot: a law alone gives a force for a prescribed motion, which `identify` fits and ranks."""
    from stickslip.basics.lazy_names import typed_name
    from stickslip.models.friction import LAWS
    from stickslip.models.presets import PRESETS

    if name.lower() not in LAWS or name in PRESETS:
        return
    robot, fit = "piezo_rig tilt_deg=1.7 amplitude=5.56e-4", f"ss.identify(rec, {typed_name(LAWS[name.lower()].__name__)}, free={{...}})"
    said = f"{name!r} is a law, not a robot; give a robot, such as {robot}; laws are fitted to records of force with"
    typed = f"stickslip identify {name} --record FILE --free NAME=A..B, and ranked in Python: ss.identification.rank([{fit}, ...])"
    raise InputError("compare", [f"{said} {typed}"])


def _laws(text: str | None, study: Any) -> dict[str, Any] | list[str] | None:
    """Laws by name: those suited to the robot, or what its preset makes of them (law=NAME); None where none is typed."""
    if text is None:
        return None
    from stickslip.models.friction import LAWS

    names = [law for law in text.split(",") if law]
    takes = callable(study.make) and "law" in inspect.signature(study.make).parameters
    if not takes or all(law.lower() in LAWS for law in names):
        return names
    return {law: law if law.lower() in LAWS else study.make(**{**study.arguments, "law": law}) for law in names}
