"""``stickslip merge``: merge the shards of a sweep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.outputs import Outcome, study_written

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Merge the shards of one study, as if it had been one run.",
    arguments=(
        argument("folders", metavar="FOLDER", nargs="+", help="study folders of the shards"),
        argument("--out", metavar="FOLDER", required=True, help="the study folder to make"),
        argument("--partial", action="store_true", help="tiles may be missing"),
    ),
    example="""\
$ stickslip sweep coulomb_robot alpha_plus=0.4,0.5,0.6,0.7 alpha_minus=0.9 --tile 2 --out part1 --shard 1/2
alpha_plus  mean velocity  type      pattern  period [drive periods]  margin
0.4         0.2915743      I         +0-0     1                       0.0236
0.5         0.1941414      I         +0-0     1                       0.0708
0.6         -              unsolved           none                    -
0.7         -              unsolved           none                    -
coulomb_robot: 4 cases: 2 settled, 2 not computed; written to part1
$ stickslip sweep coulomb_robot alpha_plus=0.4,0.5,0.6,0.7 alpha_minus=0.9 --tile 2 --out part2 --shard 2/2
alpha_plus  mean velocity  type      pattern  period [drive periods]  margin
0.4         -              unsolved           none                    -
0.5         -              unsolved           none                    -
0.6         0.1181625      I         +0-0     1                       0.117
0.7         0.06152274     I         +0-0     1                       0.166
coulomb_robot: 4 cases: 2 settled, 2 not computed; written to part2
$ stickslip merge part1 part2 --out whole
coulomb_robot: alpha_plus 4; written to whole
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    from stickslip.studies import merge

    return study_written(merge(asked.folders, asked.out, asked.partial), asked.out)
