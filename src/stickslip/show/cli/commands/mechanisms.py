"""``stickslip mechanisms``: test benches: a mass with a spring and one contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.lists import listing
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="List the mechanisms, and the arguments of those that are named.",
    arguments=(argument("names", metavar="NAME", nargs="*", help="mechanisms to explain (default: a line on each)"),),
    example="""\
$ stickslip mechanisms pulled_mass
pulled_mass: A mass pulled by a spring: the experiment in which stick-slip was first measured.
  name       symbol  unit   default  meaning
  mass       m       kg     needed   Mass m.
  stiffness  k       N/m    needed   Stiffness k of the spring.
  speed      u       m/s    needed   Speed u of its far end.
  friction                  needed   Friction law of the mass on the track.
  load       N       N      1        Normal force; with 1 the coefficients of the law are forces.
  damping    c       N s/m  0        Damping c of the spring.
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    return listing(asked)
