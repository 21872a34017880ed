"""Checks of arguments of public functions against their annotations; each mismatch is reported in one sentence."""

from __future__ import annotations

import builtins
import contextlib
import dataclasses
import functools
import importlib
import inspect
import math
import os
import sys
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ParamSpec, TypeAlias, TypeVar

from stickslip.basics.constructors import check_arguments
from stickslip.basics.contracts import (
    EXECUTORS,
    DataFrame,
    DeclaresContact,
    DeclaresParts,
    DynamicLaw,
    Law as AnyLaw,
    Model as AnyModel,
    Numeric,
    OneContact,
    SetValuedLaw,
    is_executor,
)
from stickslip.basics.errors import InputError, NoBodies, OneContactNeeded, Problems, StickslipError, is_whole
from stickslip.basics.fields import checked_number, number
from stickslip.basics.quantities import allowed_in, example_of

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class Kind:
    """What an annotation means beyond its type: a test, and the words for what is allowed."""

    holds: Callable[[Any], bool]
    words: str


_DESCRIBED: dict[type, str] = {}


def described_as(words: str) -> Callable[[type[T]], type[T]]:
    """Decorate a class with what messages call it, and what to type for one: they are read where an argument should be of that class.

    Examples
    --------
    >>> @described_as("a grid; type for example Grid()")
    ... class Grid: ...
    >>> @explains_arguments
    ... def size(grid: Grid) -> int:
    ...     return len(grid.cells)
    >>> size(3)
    Traceback (most recent call last):
    ...
    stickslip.basics.errors.InputError: size: grid = 3; allowed is a grid; type for example Grid()
    """

    def noted(cls: type[T]) -> type[T]:
        _DESCRIBED[cls] = words
        return cls

    return noted


def _is_numbers(value: Any) -> bool:
    try:
        number(value)
    except ValueError:
        return False
    return True


def _is_law(value: Any) -> bool:
    return isinstance(value, (SetValuedLaw, DynamicLaw))


def _is_model(value: Any) -> bool:
    return isinstance(value, (DeclaresContact, DeclaresParts)) and not isinstance(value, type)


def _is_of(module: str, name: str, or_none: bool = False) -> Callable[[Any], bool]:
    """Whether a value is of a library's class; of one that nobody has imported there are no values."""
    return lambda value: (value is None and or_none) or (module in sys.modules and isinstance(value, getattr(sys.modules[module], name)))


ROBOT = "type for example ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)"
_MAKER = "a robot, a machine, or a function that makes one; type ss.presets.piezo_rig"
_GRID = "a dataset, such as ss.sweep, ss.map and ss.bifurcation return"
_PAGE = "a figure of matplotlib; type for example plt.figure()"
_AX = "axes of matplotlib; type for example plt.subplots()[1]"
#: Used in annotations for what has a type, but no class that says what to type.
Model = Annotated[AnyModel, Kind(_is_model, f"a Robot, a mechanism or a machine; {ROBOT}")]
Single = Annotated[OneContact, Kind(_is_model, f"a Robot or a mechanism; {ROBOT}")]
Maker = Annotated[AnyModel | Callable[..., Any], Kind(lambda value: callable(value) or _is_model(value), _MAKER)]
Law = Annotated[AnyLaw, Kind(_is_law, "a friction law; type for example ss.Coulomb(mu_plus=0.15, mu_minus=0.21)")]
LawOrModel = Annotated[
    AnyLaw | AnyModel,
    Kind(lambda value: _is_law(value) or _is_model(value), f"a friction law, a Robot, a mechanism or a machine; {ROBOT}"),
]
Executes = Annotated[Any, Kind(is_executor, EXECUTORS)]
Numbers = Annotated[Any, Kind(_is_numbers, "a number or an array of numbers")]
Recorded = Annotated[
    str | os.PathLike[str] | Mapping[str, Any] | DataFrame,
    Kind(
        lambda value: isinstance(value, (str, os.PathLike, Mapping, DataFrame)),
        'the path of a record, or a data frame; type for example ss.read("run.csv")',
    ),
]
if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

    Grid: TypeAlias = xr.Dataset
    Page: TypeAlias = Figure | SubFigure | None
    Ax: TypeAlias = Axes | None
else:
    Grid = Annotated[Any, Kind(_is_of("xarray", "Dataset"), _GRID)]
    Page = Annotated[Any, Kind(_is_of("matplotlib.figure", "FigureBase", or_none=True), _PAGE)]
    Ax = Annotated[Any, Kind(_is_of("matplotlib.axes", "Axes", or_none=True), _AX)]


def parameters_of(make: Callable[..., Any]) -> Any:
    """The parameters of a maker; `InputError` if Python cannot determine them."""
    try:
        return inspect.signature(make).parameters.values()
    except ValueError:  # a class of Python's own
        raise InputError("make", [f"{make!r} makes no robot; allowed is a function that makes one; type ss.presets.piezo_rig"]) from None


def described_arguments(make: Callable[..., Any]) -> dict[str, Mapping[str, Any]]:
    """The descriptions of a maker's arguments: those of its fields, or those in its annotations ``Annotated[float, quantity(...)]``.

    Examples
    --------
    >>> from stickslip.presets import piezo_rig
    >>> described_arguments(piezo_rig)["sigma0"]["unit"]
    'N/m'
    """
    if isinstance(make, type) and dataclasses.is_dataclass(make):
        return {field.name: field.metadata for field in dataclasses.fields(make)}
    made = inspect.unwrap(make)
    hints = _hints(made) if hasattr(made, "__annotations__") and hasattr(made, "__globals__") else {}
    extras = {name: getattr(hint, "__metadata__", ()) for name, hint in hints.items()}
    return {name: description for name, annotations in extras.items() for description in annotations if isinstance(description, Mapping)}


def checked_arguments(make: Callable[..., Any], given: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """The numbers among the arguments of a maker, checked against their descriptions; mistakes are added to `problems`."""
    rules = _rules(make)
    return {name: checked_number(name, value, problems, *rules[name]) for name, value in given.items() if name in rules}


def checked_numbers(make: Callable[..., Any], **given: Any) -> dict[str, Any]:
    """The same of a maker that has no other mistakes to report with them; an `InputError` says what is wrong with all of them.

    Examples
    --------
    >>> import stickslip as ss
    >>> checked_numbers(ss.presets.cart_pole, frequency=0.5)
    {'frequency': 0.5}
    """
    problems = Problems(make.__name__)
    numbers = checked_arguments(make, given, problems)
    problems.check()
    return numbers


@functools.lru_cache(maxsize=64)
def _rules(make: Callable[..., Any]) -> dict[str, tuple[Any, str, str, str | None]]:
    """Rules for the numbers among a maker's arguments: rule, its description, an example, and the unit."""
    described = {name: description for name, description in described_arguments(make).items() if description}
    return {
        n: (description.get("rule"), allowed_in(description), f"{n}={example_of(description)}", description.get("unit"))
        for n, description in described.items()
    }


def explains_arguments(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function so that its exceptions name the arguments that do not match their annotations.

    It costs nothing unless an exception is raised. Errors of this package, such as those of the function's own checks, keep their text.

    Examples
    --------
    >>> @explains_arguments
    ... def half(x: float) -> float:
    ...     return x / 2
    >>> half("3")
    Traceback (most recent call last):
    ...
    stickslip.basics.errors.InputError: half: x = '3'; allowed is a finite number
    >>> half(y=3.0)
    Traceback (most recent call last):
    ...
    stickslip.basics.errors.InputError: half: 2 problems
      - 'y' is not an argument; known: x
      - x is missing; type x=...
    """

    @functools.wraps(function)
    def explained(*args: P.args, **kwargs: P.kwargs) -> T:
        try:
            return function(*args, **kwargs)
        except (OneContactNeeded, NoBodies) as error:
            raise InputError(function.__name__, error.problems) from error
        except StickslipError:
            raise
        except Exception as error:
            _check_names(function, args, kwargs)
            if problems := wrong_kinds(function, args, kwargs):
                raise InputError(function.__name__, problems) from error
            raise

    return explained


def _check_names(function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
    """Report misspelt and missing arguments with a suggestion; any other mismatch with the signature remains Python's own TypeError."""
    signature = inspect.signature(function)
    try:
        signature.bind(*args, **kwargs)
    except TypeError:
        _check_places(function.__name__, list(signature.parameters.values()), args)
        described = lambda: _in_examples(function) | described_arguments(function)  # noqa: E731
        check_arguments(function.__name__, dict(signature.parameters), args, kwargs, described, "not an argument")


def _in_examples(function: Callable[..., Any]) -> dict[str, Mapping[str, Any]]:
    """What the examples of a function's docstring type for its arguments, by name; what is a variable there helps nobody."""
    import ast
    import doctest

    given: dict[str, Mapping[str, Any]] = {}
    for example in doctest.DocTestParser().get_examples(inspect.getdoc(function) or ""):
        for call in ast.walk(ast.parse(example.source)):
            if isinstance(call, ast.Call) and function.__name__ in (getattr(call.func, "attr", ""), getattr(call.func, "id", "")):
                typed = {word.arg: word.value for word in call.keywords if word.arg and not isinstance(word.value, ast.Name)}
                given = {name: {"example": ast.unparse(value)} for name, value in typed.items()} | given
    return given


def _check_places(what: str, known: list[inspect.Parameter], args: tuple[Any, ...]) -> None:
    """Report surplus positional values, each with the keyword that it probably stands for."""
    places = [p.name for p in known if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if len(args) <= len(places) or any(p.kind is p.VAR_POSITIONAL for p in known):
        return
    named = [p.name for p in known if p.kind is p.KEYWORD_ONLY]
    typed = ", ".join(f"{name}={_short(value)}" for name, value in zip(named, args[len(places) :], strict=False))
    allowed = f"allowed without a name is {', '.join(places) or 'nothing'}"
    raise InputError(what, [f"{len(args)} values are given without a name; {allowed}" + (f"; type {typed}" if typed else "")])


def wrong_kinds(function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> list[str]:
    """A sentence for each argument that does not match its annotation; empty if the arguments do not fit the signature."""
    try:
        given = inspect.signature(function).bind(*args, **kwargs).arguments
    except TypeError:
        return []
    hints = _hints(function)
    more = next((p.name for p in inspect.signature(function).parameters.values() if p.kind is p.VAR_KEYWORD), None)
    values = {name: value for name, value in given.items() if name != more}
    annotated = [(name, value, hints[name]) for name, value in values.items() if name in hints]
    annotated += [(name, value, hints[more]) for name, value in given.get(more, {}).items() if more in hints] if more else []
    return [f"{name} = {_short(value)}; allowed is {_words(hint)}" for name, value, hint in annotated if not _fits(value, hint)]


@functools.lru_cache(maxsize=256)
def _hints(function: Callable[..., Any]) -> dict[str, Any]:
    """The annotations, without those that cannot be evaluated."""
    function = inspect.unwrap(function)  # a wrapper's annotations are evaluated among the names of what it wraps
    hints = {}
    for name, text in function.__annotations__.items():
        with contextlib.suppress(NameError, AttributeError, TypeError):
            hints[name] = eval(text, {}, _Names(function.__globals__)) if isinstance(text, str) else text
    return hints


class _Names(dict[str, Any]):
    """The names of a module, and public names that it imports for type checkers only."""

    def __missing__(self, name: str) -> Any:
        return getattr(builtins, name) if hasattr(builtins, name) else getattr(importlib.import_module("stickslip"), name)


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _fits(value: Any, hint: Any) -> bool:
    """Whether a value, its items included, matches an annotation."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is Annotated:
        return all(kind.holds(value) for kind in inner[1:] if isinstance(kind, Kind))
    if origin in (typing.Union, types.UnionType):
        return any(_fits(value, one) for one in inner)
    if origin is typing.Literal:
        return any(value is one or (isinstance(value, str) and value == one) for one in inner)
    if hint in (None, type(None)):
        return value is None
    plain = _PLAIN.get(hint)
    if plain is not None:
        return plain[0](value)
    if origin in _MANY or hint in _MANY:
        return _fits_many(value, origin or hint, inner)
    if isinstance(hint, type):
        return isinstance(value, hint)
    return True


def _fits_many(value: Any, origin: Any, inner: tuple[Any, ...]) -> bool:
    if origin in (dict, Mapping):
        return isinstance(value, Mapping) and (not inner or all(_fits(k, inner[0]) and _fits(v, inner[1]) for k, v in value.items()))
    if origin is Callable or origin is type:
        return callable(value)
    if isinstance(value, (str, bytes, Mapping)) or not hasattr(value, "__len__") or getattr(value, "ndim", 1) == 0:
        return False
    if origin is tuple and inner and inner[-1] is not Ellipsis:
        return len(value) == len(inner) and all(map(_fits, value, inner))
    return not inner or all(_fits(item, inner[0]) for item in value)


def _words(hint: Any) -> str:
    """A description of the values that an annotation allows."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is Annotated:
        return next((kind.words for kind in inner[1:] if isinstance(kind, Kind)), "anything")
    if origin in (typing.Union, types.UnionType):
        return " or ".join(dict.fromkeys(map(_words, inner)))
    if origin is typing.Literal:
        return " or ".join(map(repr, inner))
    if hint in _PLAIN:
        return _PLAIN[hint][1]
    if origin in _MANY or hint in _MANY:
        of = {dict: inner[1:], Mapping: inner[1:], Callable: (), type: ()}.get(
            origin or hint, [one for one in inner if one is not Ellipsis][:1]
        )
        return _MANY[origin or hint] + (f", each {_words(of[0])}" if of and of[0] is not Any else "")
    if hint in _DESCRIBED:
        return _DESCRIBED[hint]
    return (
        f"a {hint.__name__}" if isinstance(hint, type) and hint is not type(None) else "None" if hint in (None, type(None)) else "anything"
    )


def _is_real(value: Any) -> bool:
    try:
        plain = not isinstance(value, (bool, str, bytes, complex)) and getattr(getattr(value, "dtype", None), "kind", "f") in "iufO"
        return plain and getattr(value, "ndim", 0) == 0 and math.isfinite(float(value))
    except (TypeError, ValueError, OverflowError):
        return False


_PLAIN: dict[Any, tuple[Callable[[Any], bool], str]] = {
    Any: (lambda value: True, "anything"),
    bool: (lambda value: isinstance(value, bool), "True or False"),
    int: (is_whole, "a whole number"),
    float: (_is_real, "a finite number"),
    str: (lambda value: isinstance(value, str), "text"),
    os.PathLike: (lambda value: isinstance(value, os.PathLike), "a path"),
    Numeric: (_is_numbers, "a number or an array of numbers"),
}
_MANY: dict[Any, str] = {
    dict: "a dict", Mapping: "a dict", list: "a list", tuple: "a tuple", Iterable: "a list", Sequence: "a list", Callable: "a function",
    type: "a class",
}  # fmt: skip
