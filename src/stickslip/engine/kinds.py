"""Kinds of models: all that their equations depend on but numbers, as the key of what is cached about them.

Functions of a model may read what is no part of it: a global name, an attribute of a class, a variable of the function around them. So
a kind has an edition: whenever a solver begins, all that the functions of a kind read is compared with what it was (`References`). Where
that differs, or cannot all be compared, the first model of the kind is asked again, with the same arguments; where it answers otherwise
than before, what is cached about its kind is outdated, and the edition is the next.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves
from stickslip.basics.references import References
from stickslip.engine.remembered import OfFrozen
from stickslip.engine.symbolic import is_written_out
from stickslip.models.declaration import answers, answers_of, calls, instants, same_answers
from stickslip.models.machine_adapter import forget_mechanics, fresh_mechanics, machine_of

_NUMBER = object()  # in a kind, where there is a number; None is a field that has none


class Editions:
    """How often functions have changed, by the key of what is cached about them.

    Parameters
    ----------
    most : int, optional
        How many keys are kept; all if not given.

    Examples
    --------
    >>> factor, editions = [2.0], Editions()
    >>> f = lambda: {"f": (factor[0],)}
    >>> make = lambda: First(f, f, (f,))
    >>> editions.check("f", make), editions.check("f", make), editions.of("f")
    (False, False, 1)
    >>> factor[0] = 3.0
    >>> editions.check("f", make), editions.of("f")
    (True, 2)
    """

    def __init__(self, most: int | None = None):
        self._known: dict[Any, tuple[First, Any, int, References]] = {}
        self._most, self._count = most, itertools.count(1)

    def of(self, key: Any) -> int:
        """The edition of a key; 0 if it is not known."""
        known = self._known.get(key)
        return 0 if known is None else known[2]

    def check(self, key: Any, make: Callable[[], First]) -> bool:
        """Whether functions answer otherwise than before; what raises an error is not kept."""
        known = self._known.get(key)
        if known is None:
            first = make()
            self._keep(key, first, first.check())
            return False
        first, before, _, read = known
        if read.complete and read.unchanged():
            return False
        now = first.ask()
        if now.keys() == before.keys() and all(same_answers(before[name], answer) for name, answer in now.items()):
            if read.complete:
                self._known[key] = first, before, known[2], References(*first.reading)
            return False
        first.check()
        self._keep(key, first, now)
        return True

    def _keep(self, key: Any, first: First, answers: Any) -> None:
        if self._most is not None:
            for oldest in list(self._known)[: max(len(self._known) - self._most + 1, 0)]:
                self._known.pop(oldest, None)
        self._known[key] = first, answers, next(self._count), References(*first.reading)


@dataclass(frozen=True)
class First:
    """The functions that are asked for a key: what they answer, the same with a check that they answer it twice, and what has them."""

    ask: Callable[[], Any]
    check: Callable[[], Any]
    reading: tuple[Any, ...]


_editions = Editions()


def _parts_of(model: Model) -> tuple[Any, ...]:
    parts = tuple(leaves(model, kinds=True, number_as=lambda name, value: value if is_written_out(name, value) else _NUMBER))
    if not isinstance(getattr(model, "coordinates", None), tuple):
        return parts
    return (*parts, *machine_of(model).mechanics.natures)  # numbers decide which rows vary with the place


_known_parts: OfFrozen[tuple[Any, ...]] = OfFrozen(_parts_of)


def kind_of(model: Model) -> tuple[Any, ...]:
    """The parts of a model that determine its equations: classes, names of the numbers, fields that are not numbers, and the edition."""
    return _with_edition(_parts_of(model))


def known_kind(model: Model) -> tuple[Any, ...]:
    """The same; of a frozen record it is known as long as it lives."""
    return _with_edition(_known_parts(model))


def _with_edition(parts: tuple[Any, ...]) -> tuple[Any, ...]:
    try:
        return (*parts, _editions.of(parts))
    except TypeError:  # a field that cannot be compared: nothing is cached about this kind
        return parts


def edition_of(model: Model) -> int | None:
    """How often functions of a model's kind have changed; None where nothing is cached about it."""
    try:
        return _editions.of(_known_parts(model))
    except TypeError:
        return None


def check_functions(model: Model) -> None:
    """Notice functions that have changed since the kind was met; `InputError` for functions that give another value each time.

    Examples
    --------
    >>> import stickslip as ss
    >>> check_functions(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4))
    """
    parts = _known_parts(model)
    try:
        changed = _editions.check(parts, lambda: _first_of(cases_of(model, slice(1))[0]))
    except TypeError:
        answers_of(cases_of(model, slice(1))[0])
        return
    if changed:
        forget_mechanics()


def _first_of(case: Any) -> First:
    try:
        return _asked(case)
    except InputError:
        raise
    except (TypeError, AttributeError, LookupError, NameError) as error:
        mistake = f"one of its functions raised {type(error).__name__}: {error} when it was called with numbers"
        allowed = "allowed are functions of time, positions and velocities that return a number for all of them"
        raise InputError(type(case).__name__, [f"{mistake}; {allowed}; type for example lambda t, x, v: -2.0 * x"]) from error
    except Exception:  # outside of its domain: said where the run comes to it
        return First(dict, dict, (case,))


def _asked(case: Any) -> First:
    at = instants(case, fresh_mechanics(case), 1)[0]
    return First(lambda: answers(calls(fresh_mechanics(case), at)), lambda: answers_of(case), (case,))
