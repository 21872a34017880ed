"""Arguments of an optimisation, from the command line or the table [optimise] of a study file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.typed_numbers import has_unit
from stickslip.show.cli.arguments import named_words, value

if TYPE_CHECKING:
    from argparse import Namespace


#: Keys of [optimise] that hold one word or number each.
NUMBERS = ("maximise", "minimise", "quantile", "starts", "seed")
_FORMS = ("pieces", "fourier", "spline")


def asked_for(asked: Namespace, table: Any) -> dict[str, Any]:
    """Arguments of `optimise`, from a study file's table and the options, which take precedence; all errors are reported together."""
    problems = Problems("optimise")
    table = _checked_table(table, problems)
    arguments: dict[str, Any] = {name: table[name] for name in NUMBERS if name in table}
    given = {name: getattr(asked, name) for name in NUMBERS if getattr(asked, name) is not None}
    if {"maximise", "minimise"} & set(given):
        arguments = {name: word for name, word in arguments.items() if name not in ("maximise", "minimise")}
    arguments |= given
    if not {"maximise", "minimise"} & set(arguments):
        arguments["maximise"] = "mean_velocity"
    arguments["starts"] = None if arguments.get("starts") == "none" else arguments.get("starts", "closed")
    for key, option, read in (("over", "over", _over), ("subject_to", "limit", _ends), ("robust", "uncertain", _distribution)):
        words = {**table.get(key, {}), **_words(option, getattr(asked, option), problems)}
        kept = {name: _read(option, name, word, read, problems) for name, word in words.items()}
        arguments[key] = kept if kept or key == "over" else None
    problems.check()
    return arguments


def _checked_table(table: Any, problems: Problems) -> dict[str, Any]:
    """The table, with its keys and the types of their values checked."""
    tables = ("over", "subject_to", "robust")
    table = {} if table is None else table
    if not isinstance(table, dict):
        problems.add(f'optimise = {table!r} is not a table; type [optimise.over] and under it for example "drive.amplitude" = [2e-4, 8e-4]')
        return {}
    for key, given in table.items():
        if key not in (*NUMBERS, *tables):
            problems.add(f"optimise.{key} is not known; {did_you_mean(key, [*NUMBERS, *tables])}")
        elif key in tables and not isinstance(given, dict):
            problems.add(f"optimise.{key} = {given!r} is not a table; type [optimise.{key}]")
    return {key: given for key, given in table.items() if key not in tables or isinstance(given, dict)}


def _words(option: str, words: list[str], problems: Problems) -> dict[str, str]:
    """NAME=WORD options as a dict."""
    wanted, example = _EXAMPLES[option]
    return dict(named_words(words, problems, f"{wanted}; type for example --{option} {example}", f"--{option} "))


_EXAMPLES = {
    "over": ("NAME=A..B or NAME=pieces:N", "drive.amplitude=2e-4..8e-4"),
    "limit": ("NAME=A..B", "stroke=..0.01"),
    "uncertain": ("NAME=A..B or NAME=MEAN+-DEVIATION", "friction.mu_plus=0.15+-0.01"),
}


def _read(option: str, name: str, word: Any, read: Callable[[str], Any], problems: Problems) -> Any:
    """A word of the command line, or the corresponding value in a file: a list stands for a tuple."""
    if isinstance(word, list):
        return tuple(word)
    try:
        return read(str(word))
    except (ValueError, InputError):
        problems.add(f"--{option} {name}={word} is not {_EXAMPLES[option][0]}; type for example --{option} {_EXAMPLES[option][1]}")
        return None


def _over(text: str) -> Any:
    """Two bounds, or a waveform."""
    kind, _, count = text.partition(":")
    if kind in _FORMS:
        from stickslip.inverse.optimisation import waveform

        return waveform(**{kind: int(count)})
    return _ends(text)


def _ends(text: str) -> tuple[float | str | None, float | str | None]:
    """A..B, where either may be missing."""
    low, dots, high = text.partition("..")
    if not dots:
        raise ValueError(text)
    return tuple(_bound(end) if end else None for end in (low, high))  # type: ignore[return-value]


def _bound(text: str) -> float | str:
    """A number, or text with a unit, which the search converts: it knows the unit of the bounded quantity."""
    return text.strip() if has_unit(text) else _number(text)


def _distribution(text: str) -> Any:
    """A..B is uniform, MEAN+-DEVIATION normal; the deviation may be in per cent of the mean."""
    mean, sign, deviation = text.partition("+-")
    if not sign:
        low, _, high = text.partition("..")
        return ("uniform", _number(low), _number(high))
    return (_number(mean), deviation) if deviation.endswith("%") else ("normal", _number(mean), _number(deviation))


def _number(text: str) -> float:
    number = value(text)
    if isinstance(number, (int, float)):
        return float(number)
    raise ValueError(text)


def search_table(best: Any) -> dict[str, Any]:
    """The table [optimise] of a study file that repeats the search.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> best = ss.optimise(robot, over={"drive.amplitude": (2e-4, 8e-4)}, maximise="mean_velocity", subject_to={"stroke": (None, 1e-3)})
    >>> search_table(best)["over"], search_table(best)["subject_to"]
    ({'drive.amplitude': [0.0002, 0.0008]}, {'stroke': '..0.001'})
    """
    asked = best.search
    table: dict[str, Any] = {"maximise" if asked.maximised else "minimise": best.of, "starts": asked.starts or "none", "seed": asked.seed}
    table |= {} if asked.quantile is None else {"quantile": asked.quantile}
    table["over"] = {name: list(what) if isinstance(what, tuple) else f"{what.kind}:{what.count}" for name, what in asked.over.items()}
    table["subject_to"] = {name: "..".join("" if end is None else repr(end) for end in ends) for name, ends in asked.subject_to.items()}
    table["robust"] = {name: list(said) for name, said in asked.robust.items()}
    return {key: part for key, part in table.items() if part != {}}
