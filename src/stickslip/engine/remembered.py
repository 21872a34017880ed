"""Caches of computed values, by the objects on which they depend."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from stickslip.basics.fields import is_frozen

T = TypeVar("T")
_NOTHING = object()  # in place of an answer that is not known


class Remembered(Generic[T]):
    """Answers by what they depend on: what was asked before costs nothing. Threads may share it.

    Parameters
    ----------
    most : int
        How many are kept; the oldest gives way to the next.

    Examples
    --------
    >>> squares = Remembered()
    >>> squares(3, lambda: 9), squares(3, lambda: 1 / 0), squares([3], lambda: 9)
    (9, 9, 9)
    >>> few = Remembered(most=10)
    >>> sum(few(k, lambda: k) for k in range(12)), len(few)
    (66, 10)
    """

    def __init__(self, most: int = 1024):
        self._known: dict[Any, T] = {}
        self._most = most

    def __len__(self) -> int:
        """How many are kept."""
        return len(self._known)

    def __call__(self, key: Any, find: Callable[[], T]) -> T:
        """The answer for a key, found now if it is new; that of a key that cannot be compared, such as a list, is found each time."""
        try:
            known: Any = self._known.get(key, _NOTHING)
        except TypeError:
            return find()
        if known is not _NOTHING:
            return known
        answer = find()
        for oldest in list(self._known)[: max(len(self._known) - self._most + 1, 0)]:
            self._known.pop(oldest, None)  # other threads may take it away as well
        self._known[key] = answer
        return answer


class OfFrozen(Generic[T]):
    """Answers about records: what was found of a record whose parts are all frozen is known as long as it lives.

    Examples
    --------
    >>> from stickslip.friction import Coulomb
    >>> names, law = OfFrozen(lambda law: [type(law).__name__]), Coulomb(mu_plus=0.15, mu_minus=0.21)
    >>> names(law), names(law) is names(law)
    (['Coulomb'], True)
    """

    def __init__(self, find: Callable[[Any], T]):
        self._find = find

    def __len__(self) -> int:
        """How many are kept."""
        return sum(self in answers for _, answers in list(_of_records.values()))

    def __call__(self, record: Any) -> T:
        """The answer for a record."""
        kept = _of_records.get(id(record))
        answers = kept[1] if kept is not None and kept[0]() is record else _place_of(record)
        if answers is None:
            return self._find(record)
        if self not in answers:
            answers[self] = self._find(record)
        return answers[self]


#: The frozen records about which something is known, by id, each with all answers about it.
_of_records: dict[int, tuple[weakref.ref[Any], dict[Any, Any]]] = {}


def _place_of(record: Any) -> dict[Any, Any] | None:
    """A place for answers about a frozen record, which goes with it; None for a record that may change, or has ``__slots__``."""
    if not is_frozen(record):
        return None
    key, answers, forget = id(record), dict[Any, Any](), _of_records.pop  # the name of the table is gone when Python ends
    try:
        alive = weakref.ref(record, lambda _: forget(key, None))
    except TypeError:  # it has __slots__
        return None
    _of_records[key] = alive, answers
    return answers
