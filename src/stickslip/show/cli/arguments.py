"""The words after a command: one parser class and one grammar, NAME=VALUE, for all commands."""

from __future__ import annotations

import argparse
import inspect
import re
from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any, NoReturn

from stickslip.basics.errors import InputError, Problems, did_you_mean, other_words
from stickslip.basics.typed_numbers import in_unit
from stickslip.models.naming import axis_of, example_for
from stickslip.show.cli.declaring import commands_in, declaration
from stickslip.show.cli.probing import probe, probe_axes
from stickslip.show.cli.show import writable
from stickslip.show.cli.study_files import ALLOW_CODE, SOLVER, study_named


class _Allow(argparse.Action):
    """``--allow-code`` is valid for one command only."""

    def __call__(self, *_: Any) -> None:
        ALLOW_CODE.set(True)


class Parser(argparse.ArgumentParser):
    """argparse with our own error messages; `files` maps arguments that name files to their option and extensions."""

    def __init__(self, **how: Any):
        super().__init__(**how)
        self.files: dict[str, tuple[Any, Sequence[str]]] = {}

    def error(self, message: str) -> NoReturn:
        """Raise an `InputError`, with the closest option as a suggestion."""
        name = self.prog.removeprefix("stickslip ")
        raise InputError(name, [f"{self._in_our_words(message)} (type {self.prog} --help)"])

    def _in_our_words(self, message: str) -> str:
        """Translate a message of argparse into the given value, the allowed ones and what to type."""
        if match := re.search(r"unrecognized arguments: (\S+)", message):
            options = [option for option in self._option_string_actions if option.startswith("--")]
            if match[1].startswith("-"):
                return f"{match[1]} is not an option; {did_you_mean(match[1], options)}"
            return f"{match[1]!r} is an unexpected argument; options are {', '.join(options)}"
        if match := re.search(r"arguments are required: (.+)", message):
            missing = match[1].split(", ")
            robot = f"give a preset or a study file, such as {self.prog} piezo_rig tilt_deg=1.7 amplitude=5.56e-4"
            verb = "is" if len(missing) == 1 else "are"
            return f"{' and '.join(missing)} {verb} missing; {robot if 'ROBOT' in missing else f'type for example {self._example()}'}"
        if match := re.search(r"argument (\S+?)(?:/\S+)?: expected (?:one|at least one) argument", message):
            return f"{match[1]} needs a value: {match[1]} {self._metavar(match[1])}"
        if match := re.search(r"argument (\S+?)(?:/\S+)?: invalid (int|float) value: (.+)", message):
            return f"{match[1]} {match[3]}; allowed is a {'whole number' if match[2] == 'int' else 'number'}"
        return message

    def _example(self) -> str:
        """An example of this command's usage."""
        command = self.prog.removeprefix("stickslip ")
        typed = [line for line, _ in commands_in(declaration(command).example) if line.split()[1] == command]
        return typed[0] if typed else f"{self.prog} --help"

    def _metavar(self, option: str) -> str:
        action = self._option_string_actions[option]
        return str(action.metavar or action.dest.upper())


def parser(command: str) -> Parser:
    """The parser of a command, from what its file in ``cli/commands`` declares.

    Examples
    --------
    >>> parser("run").prog
    'stickslip run'
    """
    declared, plain = declaration(command), argparse.RawDescriptionHelpFormatter
    end = "\n\n".join(part.rstrip("\n") for part in (declared.more, declared.example) if part)
    made = Parser(prog=f"stickslip {command}", description=declared.about, epilog=end, allow_abbrev=False, formatter_class=plain)
    made.register("action", "allow", _Allow)
    for each in declared.arguments:
        action = made.add_argument(*each.names, **{name: copy(value) for name, value in each.how.items()})
        made.files |= {action.dest: (each.names[0] if action.option_strings else action.metavar, each.ends)} if each.ends else {}
    return made


def asked(command: str, words: list[str]) -> Any:
    """The parsed arguments of a command; output files are checked before the work."""
    made, declared = parser(command), declaration(command)
    mixed = any(action.nargs == "*" for action in made._actions)  # positional words of two kinds, with options between them
    read = made.parse_intermixed_args if mixed else made.parse_args
    parsed: Any = made.parse_known_args(words)[0] if declared.open_ended else read(words)
    for name, (option, ends) in made.files.items():
        setattr(parsed, name, writable(option, getattr(parsed, name), ends))
    parsed.command, parsed.typed = command, " ".join(["stickslip", command, *words])
    parsed.words = words
    return parsed


def value(text: str, unit: str = "") -> Any:
    """The value after the = sign: a whole number, a number, a multiple of pi, a number with a unit, none, or a word.

    Examples
    --------
    >>> value("200"), value("5e-4"), round(value("65.4pi"), 3), value("lugre"), value("none"), value("0.55mm", "m")
    (200, 0.0005, 205.46, 'lugre', None, 0.00055)
    """
    text = text.strip()
    if re.fullmatch(r"[+-]?\d+", text):
        return int(text)
    multiple = re.fullmatch(r"([+-]?[\d.]*(?:e[+-]?\d+)?)\s*\*?\s*pi", text, re.IGNORECASE)
    try:
        if multiple:
            return float({"": "1", "+": "1", "-": "-1"}.get(multiple[1], multiple[1])) * 3.141592653589793
        return float(text)
    except ValueError:
        return None if text.lower() == "none" else in_unit(text, unit) if unit else text


def range_ends(text: str) -> tuple[float, float]:
    """Both numbers of A..B.

    Examples
    --------
    >>> range_ends("1e-3..2")
    (0.001, 2.0)
    """
    low, high = map(float, text.split(".."))
    return low, high


def values(text: str, unit: str = "") -> Any:
    """As `value`, for a sweep, where a..b:n, a..b:n:log and a,b,c are several values.

    Examples
    --------
    >>> values("1..3:3"), values("1..100:3:log"), values("4,5"), values("1mm..3mm:3", "m")
    ([1.0, 2.0, 3.0], [1.0, 10.0, 100.0], [4, 5], [0.001, 0.002, 0.003])
    """
    spread = re.fullmatch(r"(.+?)\.\.(.+?):(\d+)(:log)?", text)
    if spread:
        first, last, count = value(spread[1], unit), value(spread[2], unit), int(spread[3])
        if isinstance(first, (int, float)) and isinstance(last, (int, float)) and count >= 1:
            steps = max(count - 1, 1)
            if spread[4]:
                return _by_a_factor(text, first, last, count)
            return [first + (last - first) * (i / steps) if i < steps or count == 1 else float(last) for i in range(count)]
        raise ValueError(f"{text!r} is not a range; allowed is a..b:n, such as 4e-4..8e-4:9")
    if ".." in text:
        raise ValueError(f"{text!r} does not say how many values; add their number, such as {text}:9")
    if "," in text:
        return [value(part, unit) for part in text.split(",") if part.strip()]
    return value(text, unit)


def _by_a_factor(text: str, first: float, last: float, count: int) -> list[float]:
    """Values that grow by a constant factor."""
    if not first * last > 0:
        raise ValueError(f"{text!r} is not a range by a factor; allowed are two numbers of one sign, such as 0.03..0.21:60:log")
    inner = [first * (last / first) ** (i / max(count - 1, 1)) for i in range(1, count - 1)]
    return [float(first), *inner, float(last)][:count]


def units_of(make: Any) -> Callable[[str], str]:
    """A function from the name of a number to the unit in which its maker takes it; "" if unknown."""
    return lambda name: (axis_of(name, make) or ("", ""))[1]


def named_words(words: list[str], problems: Problems, wanted: str, before: str = "") -> Iterator[tuple[str, str]]:
    """The names and texts of NAME=TEXT words; other words, and names given twice, are noted as problems."""
    names = set()
    for word in words:
        name, _, text = word.partition("=")
        if not name or not text:
            problems.add(f"{before}{word!r} is not {wanted}")
        elif name in names:
            problems.add(f"{before}{name} is given twice")
        else:
            names.add(name)
            yield name, text


def settings(words: list[str], many: bool, problems: Problems, units: Callable[[str], str] = lambda name: "") -> dict[str, Any]:
    """NAME=VALUE words as a dict, with numbers converted to the units of their names; errors are noted."""
    given: dict[str, Any] = {}
    for name, text in named_words(words, problems, "NAME=VALUE; type for example amplitude=5.56e-4"):
        if not many and (".." in text or ("," in text)):
            example = f"{name}={example_for(name):.6g}"
            problems.add(f"{name}={text} is several values; that is for `stickslip sweep`; here give one, such as {example}")
        else:
            try:
                given[name] = values(text, units(name)) if many else value(text, units(name))
            except ValueError as error:
                problems.add(f"{name}: {error}")
    return given


def section_asked(asked: Any) -> dict[str, Any]:
    """The arguments `section` and `turns` of an analysis, where they were given.

    Examples
    --------
    >>> section_asked(argparse.Namespace(section="v,0.1,-1", turns=None))
    {'section': ('v', 0.1, -1.0)}
    """
    given: dict[str, Any] = {} if asked.turns is None else {"turns": asked.turns}
    if asked.section is None:
        return given
    name, *numbers = asked.section.split(",")
    try:
        return {"section": (name, *map(float, numbers)), **given}
    except ValueError:
        what = f"--section {asked.section}; allowed is a state, alone or with the value that it passes and 1 (rises) or -1 (falls)"
        raise InputError("section", [f"{what}; type for example --section v,0.1,1"]) from None


@dataclass(frozen=True)
class Subject:
    """The robot or function that a command works on, with its arguments.

    Parameters
    ----------
    name : str
        The preset or file.
    make : callable or Robot
        As `sweep` takes it.
    arguments : dict
        The arguments that were set.
    options : dict
        Arguments of the solver.
    """

    name: str
    make: Any
    arguments: dict[str, Any]
    options: dict[str, Any] = field(default_factory=dict)

    def robot(self) -> Any:
        """The robot itself."""
        from stickslip.models.model_adapter import is_model

        made = _builder(self.make)(self.arguments)
        if not is_model(made):
            raise InputError(
                self.name,
                [f"it returns {made!r}; allowed is a Robot, a mechanism, a machine or a flow; type for example return ss.Robot(...)"],
            )
        return made

    @property
    def dimensionless(self) -> bool:
        """Whether the robots are dimensionless, with all units 1."""
        from stickslip.models.presets import DIMENSIONLESS

        return getattr(self.make, "__name__", "") in DIMENSIONLESS

    def title(self) -> str:
        """The robot and its settings, as typed on the command line."""
        return " ".join([self.name, *(f"{k}={v:.10g}" if isinstance(v, float) else f"{k}={v}" for k, v in self.arguments.items())])


def subject(
    name: str, words: list[str], many: bool = False, solver: tuple[str, ...] = SOLVER, own: tuple[str, ...] = (), strict: bool = True
) -> Subject:
    """The preset or study file of this name with its settings; all errors are reported together.

    Entries of the file's [arguments] with a name in `own` are left to the command. A command that is not `strict` takes only the options
    that it knows from the file's [solve]; the others are for other commands.
    """
    problems = Problems("arguments")
    study = study_named(name)
    if own or not strict:
        kept = {n: v for n, v in study.options.items() if strict or n in {word.partition(".")[0] for word in solver}}
        study = replace(study, arguments={n: v for n, v in study.arguments.items() if n not in own}, options=kept)
    units = units_of(study.make)
    given = {**_from_file(study.arguments, words, many, problems, units), **settings(words, many, problems, units)}
    needed, known = names_of(study.make)
    tried = {word.partition("=")[0] for word in words} | set(study.arguments)
    for missing in (n for n in needed if n not in tried):
        problems.add(f"{missing} is missing; {name} has no default for it; type for example {missing}={example_for(missing):.6g}")
    options = {k: v for k, v in given.items() if k in solver}
    arguments = {k: v for k, v in given.items() if k not in solver}
    for word in arguments:
        if not _takes(study.make, known, word):
            problems.add(f"{word!r} is not known; {_in_other_words(word, arguments[word], known) or did_you_mean(word, [*known, *solver])}")
    axes = {k: options.pop(k) for k in list(options) if many and k.startswith("start.") and isinstance(options[k], list)}
    options = _start({**study.options, **options})
    known_ones = {k: v for k, v in arguments.items() if _takes(study.make, known, k)}
    timed = "duration" in solver and (strict or "duration" in options)  # a command that is not strict chooses the duration itself
    for sentence in (probe_axes if many else probe)(
        _builder(study.make), known_ones, [n for n in needed if n not in given], {**_kept(solver), **options}, timed
    ):
        problems.add(sentence)
    problems.check()
    return Subject(name, study.make, {**arguments, **axes}, options)


def _takes(make: Any, known: Sequence[str], name: str) -> bool:
    """Whether a maker takes a name. Names that stand for the numbers of several parts are only for `replace`, not for a function."""
    from stickslip.basics.number_names import numbers_meant

    return name in known or (not callable(make) and bool(numbers_meant(name, known)))


def _in_other_words(word: str, value: Any, known: Sequence[str]) -> str | None:
    """The suggestion for a number that the robot has under another name, or in another unit."""
    one = value[0] if isinstance(value, list) and value else value
    if word.rpartition(".")[2] == "tilt_deg" and "track.tilt" not in known and "drive.omega" in known:
        return 'this robot\'s track is level; a study file has an incline under [robot.track], as kind = "incline" and tilt = 0.03 [rad]'
    return other_words(word, one, known)


def _from_file(arguments: dict[str, Any], words: list[str], many: bool, problems: Problems, units: Callable[[str], str]) -> dict[str, Any]:
    """The [arguments] of a study file that the command line does not set itself."""
    typed = {word.partition("=")[0] for word in words}
    rest = {name: v for name, v in arguments.items() if name not in typed}
    plain = {name: v for name, v in rest.items() if not isinstance(v, (str, list)) or (many and isinstance(v, list))}
    several = [f"{name}={','.join(map(str, v))}" if isinstance(v, list) else f"{name}={v}" for name, v in rest.items() if name not in plain]
    return {**plain, **settings(several, many, problems, units)}


def names_of(make: Any) -> tuple[list[str], list[str]]:
    """The required arguments, and all arguments."""
    if callable(make):
        parameters = inspect.signature(make).parameters
        return [p.name for p in parameters.values() if p.default is p.empty], list(parameters)
    from stickslip.basics.fields import leaves

    return [], [path for path, _ in leaves(make)]


def axes_among(command: str, arguments: dict[str, Any], count: int, example: str) -> tuple[list[str], dict[str, Any]]:
    """The names of the arguments with several values, of which there must be `count`, and the other arguments."""
    many = [name for name, value in arguments.items() if isinstance(value, list)]
    if len(many) != count:
        given = f"{' and '.join(many)} {'has' if len(many) == 1 else 'have'} several" if many else "no argument has several"
        allowed = f"allowed {'is exactly one' if count == 1 else 'are exactly two'}, as NAME=a..b:n"
        raise InputError(command, [f"{given} values; {allowed}; type for example {example}"])
    return many, {name: value for name, value in arguments.items() if name not in many}


def _builder(make: Any) -> Callable[[dict[str, Any]], Any]:
    return (lambda arguments: make(**arguments)) if callable(make) else make.replace


def _kept(solver: tuple[str, ...]) -> dict[str, Any]:
    """Options of a command that takes `samples`: it keeps the curves, which may be too large."""
    return {"keep": "trajectory"} if "samples" in solver else {}


def _start(options: dict[str, Any]) -> dict[str, Any]:
    """Options with start.v and similar ones collected in `start`."""
    start = {**options.pop("start", {}), **{k.partition(".")[2]: options.pop(k) for k in list(options) if k.startswith("start.")}}
    return {**options, **({"start": start} if start else {})}
