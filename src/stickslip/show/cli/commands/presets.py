"""``stickslip presets``: published robots, with the arguments they take."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.lists import listing
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="List the presets, and the arguments of those that are named.",
    arguments=(argument("names", metavar="NAME", nargs="*", help="presets to explain (default: a line on each)"),),
    example="""\
$ stickslip presets coulomb_robot
coulomb_robot: The dimensionless Coulomb robot: w' = sinτ - r with r = alpha_plus forwards and -alpha_minus backwards.
  name         symbol  unit  default  meaning
  alpha_plus   α₊      -     needed   sliding friction forwards over drive force. Sliding friction over drive force, forwards and backwards: μ_± g/(Aμω^2).
  alpha_minus  α₋      -     needed   sliding friction backwards over drive force. Sliding friction over drive force, forwards and backwards: μ_± g/(Aμω^2).
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    return listing(asked)
