"""Who judges a result, draws it and writes its report: results ask here, and the packages that are built on results answer."""

from __future__ import annotations

TYPE_CHECKING = False  # as in `typing`, whose import would take a third of that of this package
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Provider = Callable[[str], Callable[..., Any]]

_PROVIDERS: dict[str, Provider] = {}
_ON_DEMAND: list[Callable[[], object]] = []


def provide(kind: str, provider: Provider) -> None:
    """Register what returns the functions of a kind ("number", "figure", "report") by their names."""
    _PROVIDERS[kind] = provider


def on_demand(load: Callable[[], object]) -> None:
    """Register what to call, once, when a function is wanted before anybody provides it."""
    _ON_DEMAND.append(load)


def presenter(kind: str, name: str) -> Callable[..., Any]:
    """The function that computes a number of a run, draws a figure, or writes a report.

    Examples
    --------
    >>> import stickslip as ss
    >>> presenter("figure", "energy") is ss.plot.energy
    True
    """
    while kind not in _PROVIDERS and _ON_DEMAND:
        _ON_DEMAND.pop()()
    return _PROVIDERS[kind](name)
