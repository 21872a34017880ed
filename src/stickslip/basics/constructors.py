"""What a constructor or a function is called with: the names of its arguments, and which are unknown or missing."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import Problems, did_you_mean, other_words
from stickslip.basics.quantities import example_of

if TYPE_CHECKING:
    import inspect


def arguments_of(cls: type) -> dict[str, inspect.Parameter]:
    """The arguments of a class by name: of a record its fields, or those of its own constructor.

    Examples
    --------
    >>> from stickslip.drives import Harmonic
    >>> list(arguments_of(Harmonic))
    ['amplitude', 'omega', 'frequency', 'notes', 'phase']
    """
    return dict(_parameters_of(cls.__init__))  # type: ignore[misc]


@functools.lru_cache(maxsize=512)
def _parameters_of(made: Any) -> tuple[tuple[str, inspect.Parameter], ...]:
    """The parameters of a constructor without ``self``; cached, because `inspect.signature` is slow."""
    import inspect

    return tuple(inspect.signature(made).parameters.items())[1:]


@functools.lru_cache(maxsize=512)
def names_and_needed(made: Any) -> tuple[frozenset[str], tuple[tuple[int, str], ...]]:
    """Names of all arguments of a constructor; positions and names of the required ones."""
    known = [p for _, p in _parameters_of(made)]
    needed = ((i, p) for i, p in enumerate(known) if p.default is p.empty and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL))
    return frozenset(p.name for p in known), tuple((i, p.name) for i, p in needed)


def check_arguments(
    what: str,
    known: dict[str, inspect.Parameter],
    args: Any,
    kwargs: Any,
    described: Callable[[], Mapping[str, Mapping[str, Any]]],
    not_known: str = "not a field",
) -> None:
    """Report unknown and missing arguments; the suggestion for a missing one is the example in its description."""
    problems = Problems(what)
    takes_any = any(p.kind is p.VAR_KEYWORD for p in known.values()) and not_known != "not a field"
    for name in kwargs if not takes_any else ():
        if name not in known:
            hint = other_words(name, kwargs[name], known) or did_you_mean(name, known)
            problems.add(f"{name!r} is {not_known}; {hint}")
    for p in list(known.values())[len(args) :]:
        if p.default is p.empty and p.name not in kwargs and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL):
            problems.add(f"{p.name} is missing; type {p.name}={_example_in(p.name, described().get(p.name, {}))}")
    problems.check()


#: Examples of parts, by the name of the argument.
_PARTS = {"friction": "ss.Coulomb(0.15, 0.21)", "drive": "ss.Harmonic(amplitude=5e-4, frequency=32.7)"}


def _example_in(name: str, description: Mapping[str, Any]) -> str:
    """An example of a number or a part; dots if there is none."""
    return example_of(description) if description.get("example") is not None else _PARTS.get(name, "...")
