"""``stickslip export-law``: a friction law as C, MATLAB, TOML, or attributes of a MuJoCo joint."""

from __future__ import annotations

from typing import Any

from stickslip.basics.errors import InputError
from stickslip.show.cli.arguments import ends
from stickslip.show.cli.bench import asked_laws
from stickslip.show.cli.outputs import Outcome


def act(asked: Any) -> Outcome:
    """Do the command."""
    from stickslip.show.export import export_law

    laws, _ = asked_laws(asked.laws, own=(), command="export-law")
    if len(laws) != 1:
        raise InputError("export-law", [f"{len(laws)} laws are given; allowed is one; type for example stickslip export-law lugre"])
    found = export_law(
        laws[0], asked.language, name=asked.name, load=asked.load, speeds=_range(asked.speeds), armature=asked.armature
    )  # fmt: skip
    written = None if asked.out is None else str(found.save(asked.out))
    told = {"language": found.language, "name": found.name, "text": found.text}
    record = {**told, "numbers": dict(found.numbers), "notes": found.notes, "written": written}
    return Outcome(record, found.text.rstrip("\n") if written is None else f"written to {written}")


def _range(text: str | None) -> Any:
    """Two numbers of ``A..B``; other text is returned unchanged, and `export_law` reports the error."""
    try:
        return text and ends(text)
    except ValueError:
        return text
