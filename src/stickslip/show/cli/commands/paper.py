"""``stickslip paper``: reproduce the paper: tables, figures, claims and errata in one folder."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.basics.errors import InputError, as_path
from stickslip.show.cli import show
from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Reproduce the paper: its table, figures 6 to 30, claims and errata, as one offline HTML report.",
    arguments=(
        argument("--out", metavar="FOLDER", default="stickslip-paper", help="where to write it (default: ./stickslip-paper)"),
        argument("--fast", action="store_true", help="a subset that takes about a minute"),
    ),
    example="""\
$ stickslip paper --fast --out the-paper
Section 4, read with break-away at f₀, weight (M+m)g: 8 of 8 printed velocities and 4 of 4 types come out
(printed / computed; amplitudes inferred)
  1.7°  type   I / I    Coulomb 2.00 mm/s / 2.03204 mm/s  LuGre 1.80 mm/s / 1.78651 mm/s  measured 1.70 mm/s
  2.7°  type III / III  Coulomb 3.80 mm/s / 3.79239 mm/s  LuGre 3.70 mm/s / 3.69604 mm/s  measured 3.60 mm/s
  4.7°  type  II / II   Coulomb 4.00 mm/s / 3.97863 mm/s  LuGre 3.70 mm/s / 3.72669 mm/s  measured 4.00 mm/s
  5.7°  type  IV / IV   Coulomb 28.7 mm/s / 28.6890 mm/s  LuGre 28.1 mm/s / 28.1102 mm/s  measured 25.4 mm/s
  break-away at μ, weight (M+m)g: 7 of 8 velocities, 4 of 4 types
  break-away at f₀, weight Mg: 5 of 8 velocities, 4 of 4 types
  break-away at μ, weight Mg: 5 of 8 velocities, 3 of 4 types
Sections 5.2 to 6: 4 of 5 statements at once at A = 0.670 to 0.690 mm with break-away at f₀, weight (M+m)g
Section 5, by multipliers and exponents: 19 periodic, period 1, 1 periodic, period 2
Around it, 270 pairs of A and mu0: …
Claims: 16 confirmed, 8 confirmed in part, 3 not confirmed, 1 cannot be decided from the text
  confirmed                           2.2  The bristle model needs very small steps and long simulations.
                                           …
…
Errata: 20; figures: 17; … s
Report:  the-paper/report.html
Printed, computed and why, a screen for each figure: the-paper/side-by-side.html
Numbers: the-paper/numbers.json
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    folder = as_path(asked.out, "paper")
    _check(folder)

    from stickslip.show import paper

    print(f"this takes about {'a minute' if asked.fast else 'two minutes'} the first time", file=sys.stderr, flush=True)
    result = paper.reproduce(folder, fast=asked.fast, progress=show.stages())
    return Outcome(result.to_dict, result)


def _check(folder: Path) -> None:
    """Report an unusable folder before the work starts."""
    above = show.existing(folder)
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise InputError("--out", [f"{str(folder)!r} cannot be made or written; give another, such as --out ~/stickslip-paper"])
