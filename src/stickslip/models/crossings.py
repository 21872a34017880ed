"""Events of a user: functions of the state whose passages through zero are looked for in a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.basics.errors import InputError, Problems

_TYPE = 'events={"passes the mark": lambda s: s.x - 1.0}'
_WORDS: dict[str, dict[str, Any]] = {"rises": {"direction": 1}, "falls": {"direction": -1}, "ends": {"terminal": True}}


@dataclass(frozen=True, eq=False)
class Crossing:
    """A function of the state that passes zero.

    Parameters
    ----------
    function : callable
        The function.
    direction : int
        1 where it rises, -1 where it falls, 0 for both.
    terminal : bool
        Whether a run ends there.

    Examples
    --------
    >>> Crossing(lambda s: s.x, 1, False).takes(-1, 1), Crossing(lambda s: s.x, 1, False).takes(1, -1)
    (True, False)
    """

    function: Callable[..., Any]
    direction: int
    terminal: bool

    def takes(self, before: int, after: int) -> bool:
        """Whether a passage with these signs before and after it is one."""
        return self.direction == 0 or (after > before) - (after < before) == self.direction


def checked_crossings(what: str, events: Any, taken: Iterable[str] = ()) -> dict[str, Crossing]:
    """Events by name; `InputError` where one is none, or has a name of a part of the machine.

    Examples
    --------
    >>> events = checked_crossings("solve", {"at rest": lambda s: s.v, "mark": (lambda s: s.x - 1.0, "rises", "ends")})
    >>> [(each.direction, each.terminal) for each in events.values()]
    [(0, False), (1, True)]
    """
    if events is None:
        return {}
    if not isinstance(events, Mapping):
        raise InputError(what, [f"events = {events!r}; allowed is a dict of functions by name; type for example {_TYPE}"])
    problems, checked = Problems(what), dict[str, Crossing]()
    for name, each in events.items():
        if not isinstance(name, str) or not name or name in taken:
            problems.add(f"events has {name!r}; allowed is a name that no contact and no stop has; type for example {_TYPE}")
            continue
        function, *words = each if isinstance(each, tuple) and each else (each,)
        if not callable(function) or any(word not in _WORDS for word in words) or {"rises", "falls"} <= set(words):
            allowed = 'allowed is a function of the state, alone or with "rises" or "falls", and with "ends" where a run ends there'
            problems.add(f'events[{name!r}] = {each!r}; {allowed}; type for example (lambda s: s.x - 1.0, "rises", "ends")')
            continue
        options: dict[str, Any] = {"direction": 0, "terminal": False}
        for word in words:
            options |= _WORDS[word]
        checked[name] = Crossing(function, **options)
    problems.check()
    return checked
