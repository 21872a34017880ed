"""Study files: a robot, or the function that makes one, with arguments and solver options, as TOML. Errors name their lines.

Such a file has a table ``[robot]`` (as `Robot.to_toml` writes it), or a table ``[mechanism]``, or a line ``make = "piezo_rig"``. The
table ``[arguments]`` corresponds to NAME=VALUE on a command line, and ``[solve]`` holds arguments of the solver. If ``make`` is
``"file.py:function"`` or ``"module:function"``, that code runs only with ``--allow-code``: a file from somebody else is data.
"""

from __future__ import annotations

import re
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, Problems, as_path, did_you_mean, is_one_of
from stickslip.show.cli.probing import of_solver

#: Arguments of the solver that a command line may set.
SOLVER = (
    "periods", "duration", "settle", "rtol", "method", "samples", "steps", "workers", "slip_ratio", "dwell", "start.x", "start.v", "start.z"
)  # fmt: skip
#: Whether a study file may name code in this command.
ALLOW_CODE: ContextVar[bool] = ContextVar("allow_code", default=False)
_FILES: set[str] = set()  # names under which user files are loaded as modules
_TABLES = ("robot", "mechanism", "machine", "make", "arguments", "solve", "identify", "optimise")


@dataclass(frozen=True)
class StudyFile:
    """The content of a study file, or a preset.

    Parameters
    ----------
    make : Robot or callable
        The robot or mechanism, or a function that makes it.
    arguments : dict
        Its arguments; text is parsed as on the command line.
    options : dict
        Arguments of the solver.
    optimise : object
        The table [optimise], unchanged.
    """

    make: Any
    arguments: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)
    optimise: Any = None


def study_named(name: str) -> StudyFile:
    """The preset, study file or function of this name."""
    from stickslip.models.presets import PRESETS

    if name in PRESETS:
        return StudyFile(PRESETS[name])
    if ":" in name:
        return StudyFile(imported(name))
    path = as_path(name, "robot")
    if path.suffix.lower() != ".toml" and not path.exists():
        near = did_you_mean(name, PRESETS)
        raise InputError("robot", [f"{name!r} is neither a preset nor a study file; give the path of a .toml file or a preset: {near}"])
    try:
        text = path.read_text(encoding="utf-8")
    except (UnicodeDecodeError, OSError) as error:
        why = "it is not text" if isinstance(error, UnicodeDecodeError) else error.strerror
        what = "give the path of a TOML file, such as `stickslip init study.toml` writes"
        raise InputError("study file", [f"{name!r} cannot be read: {why}; {what}"]) from None
    return _read(text, name, path.resolve().parent)


_MAKERS = "give module:function or file.py:function, of a function that returns a Robot"


def imported(name: str, folder: Path | None = None, who: str = "robot", what: str = _MAKERS) -> Any:
    """A user's function, as module:function or file.py:function; errors are of `who`, and end with `what` to give."""
    import importlib
    import sys

    where, _, function = name.rpartition(":")
    path = (folder or Path()) / as_path(where, who)
    if path.suffix == ".py":
        where = path.stem
        _make_room(where, path.resolve())
        sys.path.insert(0, str(path.resolve().parent))
    elif "" not in sys.path:
        sys.path.insert(0, "")
    try:
        module = importlib.import_module(where)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{where}.".startswith(f"{error.name}."):
            raise  # the module exists, but one of its imports does not
        raise InputError(who, [f"{name!r} cannot be imported ({error}); {what}"]) from None
    if path.suffix == ".py":
        _FILES.add(where)
    made = getattr(module, function, None)
    if not _is_usable(made):
        near = did_you_mean(function, [n for n, value in vars(module).items() if _is_usable(value) and not n.startswith("_")])
        raise InputError(who, [f"{name!r} cannot be imported: {where} has no function {function!r}; {near}"])
    return made


def _make_room(name: str, path: Path) -> None:
    """Make sure that a different module of this name, loaded before, is not taken for the file."""
    import sys

    old = getattr(sys.modules.get(name), "__file__", None)
    if name not in sys.modules or (old is not None and Path(old).resolve() == path):
        return
    if old is None or name not in _FILES:
        raise InputError("robot", [f"{path} has the name of a module that is loaded already ({name}); give the file another name"])
    del sys.modules[name]


def _is_usable(made: Any) -> bool:
    """Whether an object may be a maker, a robot, a mechanism, a machine, or a law."""
    return callable(made) or any(hasattr(made, name) for name in ("friction", "contacts", "breakaway", "rate"))


# ---- reading ----
def _read(text: str, name: str, folder: Path) -> StudyFile:
    """The study in a file's text; all errors are reported together, with their lines."""
    from stickslip.models.tables import document_of

    what = f"study file {name!r}"
    document = document_of(text, what)
    problems = Problems(what)
    for word in document:
        if word not in _TABLES and _made(document):
            problems.add(f"{word} is not known; {did_you_mean(word, _TABLES)}")
    make = _make(document, text, folder, problems)
    options = _options(document.get("solve", {}), make, problems)
    arguments = document.get("arguments", {})
    if not isinstance(arguments, dict):
        problems.add('arguments is not a table; type [arguments] and under it for example "drive.amplitude" = 5e-4')
    if problems.mistakes:
        raise InputError(what, located(problems.mistakes, lines_of(text)))
    return StudyFile(make, arguments, options, document.get("optimise"))


def _made(document: dict[str, Any]) -> bool:
    return any(name in document for name in ("robot", "mechanism", "machine", "make"))


def _make(document: dict[str, Any], text: str, folder: Path, problems: Problems) -> Any:
    """The robot, the mechanism, or the function that makes one; None, with a problem noted, if it cannot be made."""
    from stickslip.models.robot import Robot

    try:
        if "machine" in document:
            why = "machine holds the numbers of a class of your own, which a study file cannot name"
            how = 'keep the machine in a Python file, in a function that returns it: make = "mine.py:rig" then runs rig with --allow-code'
            raise InputError("machine", [f"{why}; {how}"])
        if "make" in document:
            return _function(str(document["make"]), folder)
        return _mechanism(document, text) if "mechanism" in document else Robot.from_toml(text)
    except InputError as error:
        problems.include(error)
        return None


def _mechanism(document: dict[str, Any], text: str) -> Any:
    from stickslip.models.machines import MECHANISMS

    table = document["mechanism"]
    kind = table.get("kind") if isinstance(table, dict) else None
    if not is_one_of(kind, MECHANISMS):
        near = did_you_mean(str(kind), MECHANISMS)
        raise InputError("mechanism", [f'mechanism.kind = {kind!r}; {near}; type for example kind = "pulled_mass" under [mechanism]'])
    return MECHANISMS[str(kind)].from_toml(text)


def _function(name: str, folder: Path) -> Any:
    from stickslip.models.presets import PRESETS

    if name in PRESETS:
        return PRESETS[name]
    if ":" not in name:
        near = did_you_mean(name, PRESETS)
        raise InputError("make", [f"make = {name!r} is neither a preset nor code as file.py:function; {near}"])
    if not ALLOW_CODE.get():
        raise InputError("make", [code_refused("make", name)])
    return imported(name, folder)


def code_refused(key: str, name: str) -> str:
    """The reason why the code named in a study file does not run."""
    return f"{key} = {name!r} names Python code, which could do anything you can; read it first, and if you trust it type --allow-code"


def _options(table: Any, make: Any, problems: Problems) -> dict[str, Any]:
    """The known arguments of the solver; unknown names and invalid values are noted."""
    names = {name.partition(".")[0] for name in SOLVER}
    if not isinstance(table, dict):
        problems.add(f"solve = {table!r} is not a table; type [solve] and under it for example periods = 200")
        return {}
    for option in table:
        if option not in names:
            problems.add(f"solve.{option} is not known; {did_you_mean(option, names)}")
    known = {k: v for k, v in table.items() if k in names}
    if problems.mistakes and known:  # otherwise the command reports it, together with its own errors
        problems.mistakes += [f"solve.{p}" for p in of_solver(_stand_in(make), known)]
    return known


def _stand_in(make: Any) -> Any:
    """A robot for the check of the options if the file has none."""
    from stickslip.models.presets import coulomb_robot

    return coulomb_robot(0.5, 0.9) if make is None or callable(make) else make


# ---- lines ----
def lines_of(text: str) -> dict[str, int]:
    r"""The line numbers of the tables and keys of a TOML text.

    Examples
    --------
    >>> lines_of('[robot]\nbody_mass = 1\n\n[robot.drive]\nkind = "harmonic"')
    {'robot': 1, 'robot.body_mass': 2, 'robot.drive': 4, 'robot.drive.kind': 5}
    """
    table = ""
    numbers: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        head = re.match(r"\s*\[([^\[\]]+)\]", line)
        key = re.match(r"""\s*["']?([\w.-]+)["']?\s*=""", line)
        if head:
            table = head[1].replace(" ", "")
            numbers.setdefault(table, number)
        elif key:
            numbers.setdefault(f"{table}.{key[1]}".lstrip("."), number)
    return numbers


def located(sentences: list[str], lines: dict[str, int]) -> list[str]:
    """The sentences with the line of their subject, or of the table in which it is missing; in the order of the lines.

    Examples
    --------
    >>> located(["robot.inner_mass is missing", "robot.body_mass = -1"], {"robot": 1, "robot.body_mass": 3})
    ['line 1: robot.inner_mass is missing', 'line 3: robot.body_mass = -1']
    """
    marked = [(_line(s, lines), s) for s in sentences]
    return [f"line {line}: {s}" if line else s for line, s in sorted(marked, key=lambda pair: pair[0] or 0)]


def _line(sentence: str, lines: dict[str, int]) -> int | None:
    named = re.match(r"\[?([\w.]+)", sentence)
    path = named[1].split(".") if named else []
    return next((lines[".".join(path[:n])] for n in range(len(path), 0, -1) if ".".join(path[:n]) in lines), None)
