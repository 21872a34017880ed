"""``stickslip lyapunov``: exponents with their errors, and the verdict on the motion."""

from __future__ import annotations

from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser, subject, value

__all__ = ["act"]


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(
        command,
        "Lyapunov exponents per drive period, and what kind of motion it is: periodic, quasi-periodic or chaotic.",
    )
    made.add_argument("--figure", metavar="FILE", help="draw how they converge (.png, .svg or .pdf)")
    asked = made.parse_intermixed_args(words)
    figure = show.writable("--figure", asked.figure, (".png", ".svg", ".pdf"))
    settle, rest = _settle(asked.settings)
    study = subject(asked.robot, rest, solver=("periods", "rtol", "start.x", "start.v", "start.z"))

    from stickslip.dynamics.exponents import verdict

    found = verdict(study.robot(), **settle, **study.options)
    l = found.exponents  # noqa: E741
    if figure is not None:
        from stickslip import plot

        plot.convergence(l).figure.savefig(figure)
    record = {
        "robot": study.title(), "kind": found.kind, "period": found.period, "why": found.why, "spectrum": l.spectrum, "errors": l.errors,
        "largest": l.largest, "error": l.error, "unit": l.unit, "periods": l.steps, "note": l.note,
        "multipliers": None if found.orbit is None else [[m.real, m.imag] for m in map(complex, found.orbit.multipliers)],
        "written": str(figure) if figure else None,
    }  # fmt: skip
    if asked.json:
        show.print_json(record)
    else:
        print(f"{study.title()}\n{show.facts(_rows(found, record))}")
    return 0


def _settle(words: list[str]) -> tuple[dict[str, Any], list[str]]:
    """``settle=`` apart from the rest: here it comes before the periods, not out of them."""
    mine = [word for word in words if word.startswith("settle=")]
    return dict([("settle", value(word.partition("=")[2])) for word in mine]), [word for word in words if word not in mine]


def _rows(found: Any, record: dict[str, Any]) -> list[tuple[str, str]]:
    l = found.exponents  # noqa: E741
    rows = [("motion", found.kind + (f", period {found.period}" if found.period else ""))]
    rows += [
        (f"exponent {i + 1}", f"{mean:.6g} ± {error:.1g} per {l.unit}")
        for i, (mean, error) in enumerate(zip(l.spectrum, l.errors, strict=True))
    ]
    if found.orbit is not None:
        rows.append(("multipliers", ", ".join(f"{m:.6g}" for m in found.orbit.multipliers)))
    rows += [
        ("evidence", found.why),
        *([("note", l.note)] if l.note else []),
        *([("written", record["written"])] if record["written"] else []),
    ]
    return rows
