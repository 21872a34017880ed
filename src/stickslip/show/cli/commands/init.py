"""``stickslip init``: write a commented study file to start from."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems, as_path, did_you_mean
from stickslip.basics.quantities import also_in
from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.models.naming import axis_of, example_for
from stickslip.show.cli.arguments import names_of, subject
from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.docstrings import first_line, meanings
from stickslip.show.cli.outputs import Outcome
from stickslip.show.cli.study_files import study_named

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Write a commented study file to start from: a preset, or a robot with any law and drive.",
    arguments=(
        argument("file", metavar="FILE", nargs="?", ends=(".toml",), help="the .toml file to write (default: on stdout)"),
        argument("--preset", metavar="NAME", help="begin with this preset (default piezo_rig)"),
        argument("--set", action="append", metavar="NAME=VALUE", default=[], help="a number of the preset (may be repeated)"),
        argument("--law", metavar="NAME", help="with this law, its numbers an example (see `stickslip laws`)"),
        argument("--drive", metavar="NAME", help="with this drive, its numbers an example (see `stickslip drives`)"),
        argument("--force", action="store_true", help="overwrite an existing file"),
    ),
    example="""\
$ stickslip init study.toml --law coulomb
written to study.toml; try: stickslip run study.toml
$ stickslip run study.toml drive.amplitude=6e-4
study.toml drive.amplitude=0.0006
  mean velocity      0.004769897 m/s
  motion type        III  (pattern +-0)
  repeats after      1 drive period of 0.030581 s
  margin             0.0703  (0 is the border to another type)
  parts of a period  forward 60.3 %, backward 32.6 %, stick 7.0 %
  velocity           -0.004426147 m/s to 0.0163772 m/s
  energy per period  drive 1.931e-05 J, gravity 3.059e-06 J, friction 2.237e-05 J
  energy balance     worst residual 8.5e-14
  status             finished, 200 periods (100 to settle)
  made by            stickslip 0.1.0, exact
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    target = None if asked.file is None else as_path(asked.file, "init", "study.toml")
    if target is not None and target.exists() and not asked.force:
        raise InputError("FILE", [f"{str(target)!r} is there already; give another name, or type --force to write over it"])
    text = commented(_robot(asked))
    if target is None:
        return Outcome({"written": None, "text": text}, text.removesuffix("\n"))
    write_whole(target, text, unwritable("init"))
    typed = f'"{target}"' if " " in str(target) else target
    return Outcome({"written": str(target), "text": text}, f"written to {target}; try: stickslip run {typed}")


def _robot(asked: Namespace) -> Any:
    """The requested robot; all unknown names are reported together."""
    from stickslip.show.cli.lists import things

    problems, changes = Problems("init"), {}
    asked_for = (("friction", asked.law, things("laws")), ("drive", asked.drive, things("drives")))
    for field, word, known in asked_for:
        if word is not None and word not in known:
            problems.add(f"--{'law' if field == 'friction' else 'drive'} {word}: {did_you_mean(word, known)}")
        elif word is not None:
            changes[field] = known[word].example()
    problems.check()
    preset, typed = asked.preset or "piezo_rig", [word.partition("=")[0] for word in asked.set]
    needed, known_names = names_of(study_named(preset).make)
    usual = [f"{name}={example_for(name):.6g}" for name in needed if axis_of(name) and name not in typed]
    if "friction" in changes and "incline" in known_names and "incline" not in typed:
        usual.append("incline=gravity")  # a law without the folded incline of the preset needs gravity instead
    return subject(preset, [*asked.set, *usual], solver=()).robot().replace(**changes)


def commented(robot: Any) -> str:
    """A robot as the text of a study file, with unit and meaning after every number.

    Examples
    --------
    >>> import stickslip as ss
    >>> text = commented(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4))
    >>> print(text.splitlines()[4].rstrip())
    body_mass = 0.06259              # [kg] Mass M of the body.
    >>> ss.Robot.from_toml(text).drive.amplitude
    0.0005
    """
    from stickslip.basics.fields import leaves

    head = [
        "# A study file: stickslip run FILE, or check, sweep, map, identify, optimise, report. Units are SI, angles radians.",
        "# The numbers are those of an example: replace them by yours, the tilt of the track too.",
        "",
    ]
    body = _table(robot, "robot")
    name, value = next(iter(leaves(robot.drive)), ("amplitude", 1.0))
    end = (Path(__file__).parents[1] / "templates" / "study_end.txt").read_text(encoding="utf-8")
    return "\n".join([*head, *body]) + "\n" + end.format(name=name, low=0.8 * value, high=1.2 * value)


def _table(record: Any, where: str, kinds: dict[str, Any] | None = None, listed: bool = False) -> list[str]:
    """The lines of a table, or of an element of an array of tables, with its subtables; `kinds` are the alternatives to this kind."""
    import dataclasses

    import tomli_w

    from stickslip.models.tables import kinds_of
    from stickslip.models.tracks import Incline, Level

    described, lines, inner = meanings(type(record)), [_remarked(f"[[{where}]]" if listed else f"[{where}]", first_line(type(record)))], []
    kinds = kinds or {}
    names = {cls: name for name, cls in kinds.items()}
    if type(record) in names and len(kinds) > 1:
        lines.append(_remarked(f'kind = "{names[type(record)]}"', _others(where.rpartition(".")[2], kinds)))
    if type(record) is Level:
        lines += _of_level_track(record, meanings(Incline)["tilt"]["meaning"])
    known = kinds_of(type(record))
    for field in dataclasses.fields(record):
        value = getattr(record, field.name)
        if dataclasses.is_dataclass(value):
            inner += ["", *_table(value, f"{where}.{field.name}", known.get(field.name, {}))]
        elif field.name in known and isinstance(value, tuple):
            for part in value:
                inner += ["", *_table(part, f"{where}.{field.name}", known[field.name], listed=True)]
        elif value is not None:
            words = described.get(field.name, {"unit": "", "meaning": ""})
            unit = f"[{words['unit']}] " if words["unit"] else ""
            also = also_in(value, words["unit"]) if isinstance(value, float) else ""
            lines.append(_remarked(_assigned(tomli_w, field.name, value), unit + (f"{also}. " if also else "") + words["meaning"]))
    return lines + inner


def _of_level_track(track: Any, tilt: str) -> list[str]:
    """Comments for a level track: its folded tilt, or how to replace it by an incline."""
    if track.folded:
        meaning = f"[rad] the {math.degrees(track.folded):.4g} degrees that the friction above contains already"
        line = _remarked(f"folded = {track.folded!r}", meaning)
        return [line, "# for gravity along the track instead: stickslip init --set incline=gravity"]
    instead = _remarked('# kind = "incline"', "instead, for gravity along the track, with the next line:")
    return [instead, _remarked("# tilt = 0.035", f"[rad] {tilt}")]


def _assigned(tomli_w: Any, name: str, value: Any) -> str:
    """``name = value`` on one line."""
    if isinstance(value, tuple):
        return f"{name} = [{', '.join(repr(float(v)) if isinstance(v, float) else str(v) for v in value)}]"
    return str(tomli_w.dumps({name: value})).strip()


def _remarked(line: str, remark: str) -> str:
    return f"{line:<32} # {remark}" if remark else line


def _others(part: str, kinds: dict[str, Any]) -> str:
    """Where the other kinds are listed."""
    command = {"friction": "laws", "drive": "drives"}.get(part)
    return f"`stickslip {command}` lists all" if command else ", ".join(kinds)
