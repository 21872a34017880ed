"""``stickslip export-law``: a friction law as C, MATLAB, TOML or attributes of a MuJoCo joint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.show.cli.arguments import range_ends
from stickslip.show.cli.commands.bench import asked_laws
from stickslip.show.cli.declaring import CODE, argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Write a friction law as source code in another language, with its numbers.",
    more="""\
LAW is the name of a friction law (see `stickslip laws`), a study file, whose law with its numbers is meant, or your own, as file.py:Name or
module:Name of a law or of a function that makes a robot. NAME=VALUE, such as mu_plus=0.2, sets a number of it. --speeds A..B, which is
needed for mujoco, and --load are the range of speed [m/s] and the load [N] for which the joint is to be right.

example: stickslip export-law lugre mu_plus=0.16 --as c --out friction.h""",
    arguments=(
        *CODE,
        argument("laws", metavar="LAW | NAME=VALUE", nargs="*", default=[], help="a law, and numbers that are set"),
        argument("--as", metavar="LANGUAGE", default="c", dest="language", help="c, matlab, octave, toml, mujoco (default c)"),
        argument("--name", metavar="NAME", help="name of the functions or the joint (default: the law's name)"),
        argument("--load", metavar="N", type=float, help="for mujoco: load on the contact [N]"),
        argument("--speeds", metavar="A..B", help="for mujoco: slowest and fastest [m/s, of a hinge rad/s]"),
        argument("--armature", metavar="J", type=float, default=0.0, help="for mujoco: inertia of the rotor at the joint [kg m^2]"),
        argument("--out", metavar="FILE", ends=(".c", ".h", ".m", ".toml", ".xml"), help="write the text there (default: print it)"),
    ),
    example="""\
$ stickslip export-law coulomb mu_plus=0.16 mu_minus=0.16 f_plus=0.2 f_minus=0.2 --as mujoco --speeds 1e-3..0.1
<!-- Coulomb under a load of 1, over speeds from 0.001 to 0.1 m/s both ways. For a hinge read rad/s for m/s and N m for N. Largest error of steady friction 0, 0.00% of the law's largest there, at 0.001 m/s. Not in it: break-away, up to 0.2 N. -->
<joint name="coulomb" frictionloss="0.16" damping="0" armature="0"/>
$ stickslip export-law lugre --as toml
[robot.friction]
kind = "lugre"
mu_plus = 0.15
mu_minus = 0.21
f_plus = 0.18
f_minus = 0.24
sigma0 = 400000.0
sigma1 = 100.0
sigma2 = 0.04
v_s = 0.002
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    from stickslip.show.export import export_law

    laws, _ = asked_laws(asked.laws, own=(), command="export-law")
    if len(laws) != 1:
        raise InputError("export-law", [f"{len(laws)} laws are given; allowed is one; type for example stickslip export-law lugre"])
    exported = export_law(
        laws[0], asked.language, name=asked.name, load=asked.load, speeds=_range(asked.speeds), armature=asked.armature
    )  # fmt: skip
    written = None if asked.out is None else str(exported.save(asked.out))
    parts = {"language": exported.language, "name": exported.name, "text": exported.text}
    record = {**parts, "numbers": dict(exported.numbers), "notes": exported.notes, "written": written}
    return Outcome(record, exported.text.rstrip("\n") if written is None else f"written to {written}")


def _range(text: str | None) -> Any:
    """Two numbers of ``A..B``; other text is returned unchanged, and `export_law` reports the error."""
    try:
        return text and range_ends(text)
    except ValueError:
        return text
