"""``stickslip drives``: drives of the inner mass."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.lists import listing
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="List the drives, and the arguments of those that are named.",
    arguments=(argument("names", metavar="NAME", nargs="*", help="drives to explain (default: a line on each)"),),
    example="""\
$ stickslip drives twophase
twophase: Relative velocity +u_1 for L/u_1, then -u_2 for L/u_2; it begins with the phase of +u1.
  name    symbol  unit  default   meaning
  stroke  L       m     optional  Stroke L of the inner mass.
  u1      u₁      m/s   optional  relative speed forwards. Relative speeds forwards and backwards.
  u2      u₂      m/s   optional  relative speed backwards. Relative speeds forwards and backwards.
  t1              s     optional  Durations of the phases. Give any three of stroke, u1, u2, t1, t2 that determine the rest; more must agree with stroke = u1 t1 = u2 t2.
  t2              s     optional  Durations of the phases. Give any three of stroke, u1, u2, t1, t2 that determine the rest; more must agree with stroke = u1 t1 = u2 t2.
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    return listing(asked)
