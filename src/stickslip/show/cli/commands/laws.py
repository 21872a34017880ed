"""``stickslip laws``: friction laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.lists import listing
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="List the laws, and the arguments of those that are named.",
    arguments=(argument("names", metavar="NAME", nargs="*", help="laws to explain (default: a line on each)"),),
    example="""\
$ stickslip laws coulomb
coulomb: Anisotropic Coulomb friction, a set-valued law: Eq. 2.4 of the paper.
  name      symbol  unit  default   meaning
  mu_plus   μ₊      -     needed    kinetic friction coefficient forwards. Kinetic friction coefficient forwards (v > 0, downhill) and backwards; one alone, or mu=, is that of both directions.
  mu_minus  μ₋      -     needed    kinetic friction coefficient backwards. Kinetic friction coefficient forwards (v > 0, downhill) and backwards; one alone, or mu=, is that of both directions.
  f_plus    f₊      -     optional  static friction coefficient forwards. Static (break-away) coefficients; None means the kinetic ones, which is Eq. 2.4 to the letter.
  f_minus   f₋      -     optional  static friction coefficient backwards. Static (break-away) coefficients; None means the kinetic ones, which is Eq. 2.4 to the letter.
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    return listing(asked)
