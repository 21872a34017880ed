"""``stickslip bench``: friction laws on the test bench: how each behaves by itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.models.friction.law_adapter import is_law
from stickslip.show.cli import show
from stickslip.show.cli.arguments import names_of, settings, subject
from stickslip.show.cli.declaring import CODE, FIGURES, argument, command
from stickslip.show.cli.outputs import Outcome
from stickslip.show.cli.study_files import study_named

if TYPE_CHECKING:
    from argparse import Namespace


#: Arguments of the bench itself; all other names are numbers of the laws.
OWN = ("load", "mass", "stiffness", "speed")


@command(
    about="Perform the standard experiments of the friction literature on one or more laws.",
    more="""\
LAW is the name of a friction law (see `stickslip laws`), `all`, a study file, whose law with its numbers is meant, or your own, as
file.py:Name or module:Name of a law or of a function that makes a robot. NAME=VALUE, such as mu_plus=0.2, is set in every law that has
it, and in every robot of a file or function; what is not set is as in the law's example. load, mass, stiffness and speed are those of
the experiments.

example: stickslip bench lugre dahl mu_plus=0.16 mu_minus=0.16 --figure laws.png""",
    arguments=(
        *CODE,
        argument("laws", metavar="LAW | NAME=VALUE", nargs="*", default=[], help="laws, and numbers that are set"),
        argument("--figure", metavar="FILE", ends=FIGURES, help="draw all experiments (.png, .svg or .pdf)"),
        argument("--only", action="append", metavar="NAME", help="perform only this experiment (may be repeated)"),
    ),
    example="""\
$ stickslip bench coulomb mu_plus=0.15 mu_minus=0.15 f_plus=0.2 f_minus=0.2
Coulomb, load 1 N, mass 1 kg
experiment              number                       value        meaning
steady friction         static or slow, forwards     0.2 N        largest static friction force forwards
steady friction         static or slow, backwards    0.2 N        the same for motion backwards
steady friction         fall with speed              0.05 N       from there to the least in sliding forwards
frictional lag          lag                          0 N          rising minus falling velocity, mean over the swing of the velocity, at 150 rad/s
pre-sliding hysteresis  contact stiffness            unbounded    slope of the force over the displacement of a fresh contact
pre-sliding hysteresis  loss of the loop             9e-07 J      over +-1.5e-06 m, slowly
pre-sliding hysteresis  gap of the inner loop        -            force after an inner loop minus the force before it; 0 is memory of reversal points
loss per cycle          loss per cycle               6e-06 J      at an amplitude of 1e-05 m, slowly
loss per cycle          share of full sliding        1            the same by that of sliding all the way
loss per cycle          exponent at small amplitude  1            loss ~ amplitude to this power, between the two smallest
break-away              break-away, slow             0.2 N        largest friction before sliding, force rising by 0.008 N/s
break-away              break-away, fast             0.2 N        the same by 0.8 N/s
stick-slip              stick-slip                   yes          whether the mass stays still for a part of each cycle
stick-slip              its period                   9.572 s      from one passage of the pull's speed to the next
stick-slip              peak velocity                0.04313 m/s  in the last cycle
stick-slip              share at rest                0.7389       of a cycle, slower than 0.01 of the pull
drift below break-away  drift                        0 m          displacement per period of 1 s, mean of the last 20
frictional lag: the law has no memory: the same curve up and down, at every frequency
pre-sliding hysteresis: Rest is a mode of its own here, not a small velocity: there is no pre-sliding: the force jumps to the other side at a reversal, and reversals are not remembered
break-away: Rest is a mode of its own here, not a small velocity: break-away is the static limit, at every force rate
drift below break-away: the mass starts with a push, to show whether it comes to rest; it does, exactly
""",
)
def act(asked: Namespace) -> Outcome:
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
    make = study_named(word).make

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


def _drawn(bench_result: Any, path: Path | None) -> Path | None:
    if path is None:
        return None
    import matplotlib

    matplotlib.use("Agg")
    from stickslip.show import figures as plot

    return show.draw_to(path, plot.bench(bench_result))
