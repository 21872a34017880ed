"""``stickslip read``: the contents of a measured record, and measurements on it."""

from __future__ import annotations

from typing import Any

from stickslip.basics.errors import InputError
from stickslip.show.cli import recorded, show
from stickslip.show.cli.outputs import Outcome

_FREQUENCY = "; if it is, type frequency=... [Hz]"  # advice for the Python functions; this command measures without a frequency


def act(asked: Any) -> Outcome:
    """Do the command."""
    with recorded.in_words_of_the_shell():
        rec = recorded.opened(asked.file, asked)
    found = _measured(rec, recorded.settle(asked))
    if asked.figure is not None:
        found["figure"] = _draw(rec, asked.figure)
    lines = [recorded.typed(str(rec.summary)).replace(_FREQUENCY, ""), *(f"{name}: {recorded.typed(text)}" for name, text in found.items())]
    return Outcome(_record(rec, found), "\n".join(lines))


def _measured(rec: Any, settle: int | str) -> dict[str, Any]:
    """The measures that this record allows; those with missing inputs are left out."""
    from stickslip.records.settling import settled

    found: dict[str, Any] = {}
    try:
        rec, _, said = settled(rec, settle)
        if said:
            found["start"] = said.replace("compared with steady motion;", "measured;")
        found["mean velocity"] = show.quantity(rec.mean_velocity(), "m/s")
        found["motion type"] = rec.motion().verdict
    except InputError:
        pass
    return found


def _record(rec: Any, found: dict[str, Any]) -> dict[str, Any]:
    from dataclasses import asdict

    return {**asdict(rec.summary), "measures": found, "source": {k: str(v) for k, v in rec.source.items()}}


def _draw(rec: Any, path: Any) -> str:
    """Draw a spectrum and return its description, or the reason why there is none."""
    from matplotlib.figure import Figure

    from stickslip.records.channel import ROLES
    from stickslip.show import figures as plot

    ranked = sorted(rec.channels.values(), key=lambda c: ROLES.index(c.role) if c.role in ROLES else len(ROLES))
    why = "no channel can be used"
    for c in ranked:
        try:
            with plot.publication():
                figure = Figure(figsize=(5.0, 3.0), layout="constrained")
                plot.record_spectrum(rec, c.name, ax=figure.subplots())
                show.draw_to(path, figure)
        except InputError as error:
            why = error.problems[0] if c is ranked[0] else why
        else:
            return f"spectrum of {c.name}, written to {path}"
    return f"left out: {why}"
