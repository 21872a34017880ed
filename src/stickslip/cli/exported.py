"""``stickslip export-law``: a friction law as C, MATLAB, TOML, or attributes of a MuJoCo joint."""

from __future__ import annotations

from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser
from stickslip.cli.bench import asked_laws
from stickslip.errors import InputError

__all__ = ["act"]

_MORE = """\
LAW is the name of a friction law (see `stickslip laws`), a study file, whose law with its numbers is meant, or your own, as file.py:Name or
module:Name of a law or of a function that makes a robot. NAME=VALUE, such as mu_plus=0.2, sets a number of it. --speeds A..B, which is
needed for mujoco, and --load are the range of speed [m/s] and the load [N] for which the joint is to be right.

example: stickslip export-law lugre mu_plus=0.16 --as c --out friction.h"""


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    from stickslip.exporting import LANGUAGES, export_law

    made = parser(command, "Write a friction law as source code in another language, with its numbers.", robot=False, more=_MORE, code=True)
    made.add_argument("words", metavar="LAW | NAME=VALUE", nargs="*", default=[], help="a law, and numbers that are set")
    made.add_argument("--as", dest="language", metavar="LANGUAGE", default="c", help=f"{', '.join(LANGUAGES)} (default c)")
    made.add_argument("--name", metavar="NAME", help="name of the functions or the joint (default: the law's name)")
    made.add_argument("--load", metavar="N", type=float, help="for mujoco: load on the contact [N]")
    made.add_argument("--speeds", metavar="A..B", help="for mujoco: slowest and fastest [m/s]")
    made.add_argument("--armature", metavar="J", type=float, default=0.0, help="for mujoco: inertia of the rotor at the joint [kg m^2]")
    made.add_argument("--out", metavar="FILE", help="write the text there (default: print it)")
    asked = made.parse_intermixed_args(words)
    target = show.writable("--out", asked.out, (".c", ".h", ".m", ".toml", ".xml"))
    laws, _ = asked_laws(asked.words, own=(), command="export-law")
    if len(laws) != 1:
        raise InputError("export-law", [f"{len(laws)} laws are given; allowed is one; type for example stickslip export-law lugre"])
    found = export_law(
        laws[0], asked.language, name=asked.name, load=asked.load, speeds=_range(asked.speeds), armature=asked.armature
    )  # fmt: skip
    written = None if target is None else str(found.save(target))
    if asked.json:
        told = {"language": found.language, "name": found.name, "text": found.text}
        show.print_json({**told, "numbers": dict(found.numbers), "notes": found.notes, "written": written})
    else:
        print(found.text.rstrip("\n") if written is None else f"written to {written}")
    return 0


def _range(text: str | None) -> Any:
    """Two numbers of ``A..B``; the text itself, of which `export_law` says what is wrong, where it is none."""
    if text is None:
        return None
    try:
        low, high = map(float, text.split(".."))
    except ValueError:
        return text
    return low, high
