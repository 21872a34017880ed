"""``stickslip compare``: a measured record beside what friction laws give."""

from __future__ import annotations

from stickslip.cli import recorded, show
from stickslip.cli.arguments import parser, subject

__all__ = ["act"]

_MORE = "example: stickslip compare piezo_rig tilt_deg=1.7 amplitude=5.525e-4 --record run.csv --laws coulomb,lugre --report out.html"


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "A record and several laws on one phase: mean velocity, type, rms over the cycle.", more=_MORE)
    made.add_argument("--record", metavar="FILE", required=True, help="the measured record")
    made.add_argument("--laws", metavar="A,B", default="coulomb,lugre", help="laws (default: coulomb,lugre)")
    recorded.add_options(made)
    made.add_argument("--report", metavar="FILE", help="write an offline HTML page (.html)")
    made.add_argument("--figure", metavar="FILE", help="draw record and laws (.png, .svg or .pdf)")
    asked = made.parse_intermixed_args(words)
    report, figure = show.writable("--report", asked.report, (".html",)), show.writable("--figure", asked.figure, (".png", ".svg", ".pdf"))
    study = subject(asked.robot, asked.settings, solver=())
    rec = recorded.opened(asked.record, asked)

    from stickslip.identifying import compare

    found = compare(rec, study.robot(), laws=[law for law in asked.laws.split(",") if law], settle=recorded.settle(asked))
    if report is not None:
        found.report(report)
    if figure is not None:
        found.plot().figure.savefig(figure)
    if asked.json:
        show.print_json(
            {"robot": study.title(), "rows": found.to_table(), "noise": found.noise, "best": found.best.label, "notes": list(found.notes)}
        )
    else:
        print(study.title())
        print(found)
    return 0
