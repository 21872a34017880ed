"""``stickslip export-fmu``: a robot or machine as a unit of FMI 3, for Simulink, OpenModelica and fmpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import ROBOT, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Write a robot or machine as a unit of FMI 3 (.fmu), which Simulink, OpenModelica, fmpy and others run without Python.",
    more="""\
The unit has Co-Simulation, whose steps are those of `stickslip run`, and Model Exchange. Its sources are in it, and a library for this
platform if gcc or clang is there. --inputs are what the importer sets while it runs: "force", "torque on joint" and the like, or numbers of
the machine; all other numbers are parameters. rtol=, start.x= and start.v= are those of `stickslip run`.

example: stickslip export-fmu servo --inputs control.target --out servo.fmu""",
    arguments=(
        *ROBOT,
        argument("--inputs", metavar="A,B,...", help="forces and numbers that are inputs (default: all forces)"),
        argument("--outputs", metavar="A,B,...", help="outputs (default: all)"),
        argument("--name", metavar="NAME", help="name of the model (default: that of the machine's class)"),
        argument("--sources", action="store_true", help="write the sources alone, without a library for this platform"),
        argument("--out", metavar="FILE", ends=(".fmu",), help="the file (default: NAME.fmu)"),
    ),
    example="""\
$ stickslip export-fmu servo --inputs control.target --sources --out servo.fmu
servo.fmu: sources, exact steps
inputs: control.target
outputs: x.joint, v.joint, a.joint, integral.control, mode, events
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    study = subject(asked.robot, asked.settings, solver=("rtol", "method", "start.x", "start.v", "start.z"), strict=False)

    from stickslip.show.export import export_fmu

    made = export_fmu(
        study.robot(),
        asked.out,
        inputs=_names(asked.inputs),
        outputs=_names(asked.outputs),
        name=asked.name,
        binary=False if asked.sources else None,
        **study.options,
    )
    record = {
        "written": str(made.path), "name": made.name, "inputs": made.inputs, "outputs": made.outputs, "parameters": made.parameters,
        "method": made.method, "platform": made.platform,
    }  # fmt: skip
    lines = [
        f"{made.path}: {'sources' if made.platform is None else f'library for {made.platform} and sources'}, {made.method} steps",
        f"inputs: {', '.join(made.inputs) or 'none'}",
        f"outputs: {', '.join(made.outputs)}",
    ]
    return Outcome(record, "\n".join(lines))


def _names(text: str | None) -> list[str] | None:
    return None if text is None else [name.strip() for name in text.split(",") if name.strip()]
