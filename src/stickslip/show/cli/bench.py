"""``stickslip bench``: what friction laws do, alone, as tables, a figure or JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.models.friction.law_adapter import is_law
from stickslip.show.cli import show
from stickslip.show.cli.arguments import names_of, settings, subject
from stickslip.show.cli.outputs import Outcome
from stickslip.show.cli.study_files import found

#: Arguments of the bench itself; all other names are numbers of the laws.
OWN = ("load", "mass", "stiffness", "speed")


def act(asked: Any) -> Outcome:
    """Do the command."""
    laws, own = asked_laws(asked.laws)

    from stickslip.analysis.bench import bench

    done = bench(laws if len(laws) > 1 else laws[0], experiments=asked.only, progress=True, **own)
    written = [str(path) for path in (_drawn(done, asked.figure),) if path is not None]
    return Outcome({**done.to_dict(), "written": written}, "\n".join([done.table, *(f"written: {path}" for path in written)]))


def asked_laws(words: list[str], own: tuple[str, ...] = OWN, command: str = "bench") -> tuple[list[Any], dict[str, Any]]:
    """The laws with their numbers, and the arguments in the command's `own`; all errors are reported together."""
    from stickslip.models.friction import LAWS

    problems = Problems("arguments")
    given = settings([word for word in words if "=" in word], False, problems)
    names = [word for word in words if "=" not in word]
    names = list(LAWS) if names == ["all"] else names
    if not names:
        problems.add(f"no law is given; type for example stickslip {command} lugre; known: {', '.join(LAWS)}")
    numbers = {name: value for name, value in given.items() if name not in own}
    typed = {name: word for word in words if (name := word.partition("=")[0]) in numbers}
    made = [_law(name, typed, problems) for name in names]
    laws = [law for law, _ in made if law is not None]
    known = {name: None for law in laws for name in _numbers(law)} | {name: None for _, taken in made for name in taken}
    for name in numbers:
        if laws and name not in known:
            kinds = " or ".join(type(law).__name__ for law in laws)
            problems.add(f"{name!r} is not a number of {kinds}; {did_you_mean(name, [*known, *own])}")
    changed = [_changed(law, {k: v for k, v in numbers.items() if k in _numbers(law)}, problems) for law in laws]
    problems.check()
    return changed, {name: value for name, value in given.items() if name in own}


def _law(word: str, typed: dict[str, str], problems: Problems) -> tuple[Any, list[str]]:
    """The example of a law, or the law of a study file or of user code; and the typed names that its robot's maker took."""
    from stickslip.models.friction import LAWS

    if word.lower() in LAWS:
        return LAWS[word.lower()].example(), []
    if ":" not in word and not word.lower().endswith(".toml"):
        problems.add(f"{word!r} is not a law; {did_you_mean(word, LAWS)}; a law of your own is file.py:Name")
        return None, []
    try:
        return _own(word, typed)
    except InputError as error:
        problems.include(error)
        return None, []


def _own(word: str, typed: dict[str, str]) -> tuple[Any, list[str]]:
    """A law, a law made from its class and the typed numbers, or the law of a robot."""
    make = found(word).make

    if is_law(make):
        return (_instance(make, typed) if isinstance(make, type) else make), []
    taken = [name for name in typed if name in names_of(make)[1]]
    return subject(word, [typed[name] for name in taken]).robot().friction, taken


def _instance(kind: Any, typed: dict[str, str]) -> Any:
    """The example of a class of law, or an instance with the typed numbers."""
    if hasattr(kind, "example"):
        return kind.example()
    needed, known = names_of(kind)
    problems = Problems(kind.__name__)
    for name in needed:
        if name not in typed:
            problems.add(f"{name} is missing; {kind.__name__} has no default for it; type for example {name}=1.0")
    problems.check()
    return kind(**settings([word for name, word in typed.items() if name in known], False, problems))


def _numbers(law: Any) -> list[str]:
    return names_of(type(law))[1]


def _changed(law: Any, changes: dict[str, Any], problems: Problems) -> Any:
    if not changes:
        return law
    try:
        return law.replace(changes) if hasattr(law, "replace") else replace(law, **changes)
    except InputError as error:
        problems.include(error, f"{type(law).__name__}: ")
        return None


def _drawn(found: Any, path: Path | None) -> Path | None:
    if path is None:
        return None
    import matplotlib

    matplotlib.use("Agg")
    from stickslip.show import figures as plot

    return show.draw_to(path, plot.bench(found))
