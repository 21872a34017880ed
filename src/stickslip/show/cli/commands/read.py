"""``stickslip read``: read a measured record: channels, rate, gaps, noise, motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.show.cli import recorded, show
from stickslip.show.cli.declaring import FIGURES, RECORDS, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_FREQUENCY = "; if it is, type frequency=... [Hz]"  # advice for the Python functions; this command measures without a frequency


@command(
    about="Read a measured record: channels, units, rate, gaps, noise, drive frequency, motion.",
    more="example: stickslip read run.csv --unit LDV=m/s --unit t=s --figure spectrum.png",
    arguments=(
        argument("file", metavar="FILE", help="a record in any format that ss.read reads: text, MATLAB, HDF5, UFF58, TDMS, XLSX, ..."),
        *RECORDS,
        argument(
            "--figure", metavar="FILE", ends=FIGURES, help="draw the spectrum of the velocity, or of another channel (.png, .svg or .pdf)"
        ),
    ),
    example="""\
$ stickslip run coulomb_robot alpha_plus=0.5 alpha_minus=0.9 periods=20 --data run.csv
coulomb_robot alpha_plus=0.5 alpha_minus=0.9
  mean velocity      0.1941414
…
  made by            stickslip 0.1.0, exact
$ stickslip read run.csv
SYNTHETIC: computed, not measured
text, 11 channels
  x [m], position: 8081 values at 63.662 Hz, 0 to 24.4425, noise …
  v [m/s], velocity: 8081 values at 63.662 Hz, -0.0599271 to 0.684841, noise …
  mode [1]: 8081 values at 63.662 Hz, -1 to 1, noise …
  acceleration [m/s^2], acceleration: 8081 values at 63.662 Hz, -1.11291 to 0.5, noise …
  xi [m]: 8081 values at 63.662 Hz, -2 to 2, noise …
  xi_rate [m/s], drive: 8081 values at 63.662 Hz, -2 to 2, noise …
  xi_acceleration [m/s^2]: 8081 values at 63.662 Hz, -2 to 2, noise …
  friction_force [N], force: 8081 values at 63.662 Hz, -0.9 to 0.5, noise …
  drive_force [N]: 8081 values at 63.662 Hz, -1 to 1, noise …
  actuator_force [N]: 8081 values at 63.662 Hz, -0.95 to 0.75, noise …
  actuator_power [W]: 8081 values at 63.662 Hz, -1 to 1.19543, noise …
drive frequency …
note: the columns are those of a run of stickslip: computed, not measured
mean velocity: 0.1941386 m/s
motion type: I (pattern +0-0; slower than 0.00745 m/s counts as rest, shorter than 0.03 drive periods does not)
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    with recorded.in_words_of_the_shell():
        rec = recorded.opened_record(asked.file, asked)
    measures = _measured(rec, recorded.settle(asked))
    if asked.figure is not None:
        measures["figure"] = _draw(rec, asked.figure)
    lines = [
        recorded.in_command_words(str(rec.summary)).replace(_FREQUENCY, ""),
        *(f"{name}: {recorded.in_command_words(text)}" for name, text in measures.items()),
    ]
    return Outcome(_record(rec, measures), "\n".join(lines))


def _measured(rec: Any, settle: int | str) -> dict[str, Any]:
    """The measures that this record allows; those with missing inputs are left out."""
    from stickslip.basics.units import quantity_of
    from stickslip.records.settling import settled

    measures: dict[str, Any] = {}
    try:
        rec, _, said = settled(rec, settle)
        if said:
            measures["start"] = said.replace("compared with steady motion;", "measured;")
        turns = quantity_of(rec["velocity"].unit) == "angular velocity"
        measures["mean velocity"] = show.quantity_text(rec.mean_velocity, "rad/s" if turns else "m/s")
        if not turns:  # the types are those of a robot on its track
            measures["motion type"] = rec.motion.verdict
    except InputError:
        pass
    return measures


def _record(rec: Any, measures: dict[str, Any]) -> dict[str, Any]:
    from dataclasses import asdict

    return {**asdict(rec.summary), "measures": measures, "source": {k: str(v) for k, v in rec.source.items()}}


def _draw(rec: Any, path: Any) -> str:
    """Draw a spectrum and return its description, or the reason why there is none."""
    from matplotlib.figure import Figure

    from stickslip.records.channel import ROLES
    from stickslip.show import figures as plot

    ranked = sorted(rec.channels.values(), key=lambda c: ROLES.index(c.role) if c.role in ROLES else len(ROLES))
    why = "no channel can be used"
    for c in ranked:
        try:
            with plot.publication():
                figure = Figure(figsize=(5.0, 3.0), layout="constrained")
                plot.record_spectrum(rec, c.name, ax=figure.subplots())
                show.draw_to(path, figure)
        except InputError as error:
            why = error.problems[0] if c is ranked[0] else why
        else:
            return f"spectrum of {c.name}, written to {path}"
    return f"left out: {why}"
