"""Special points and curves in figures: one mark and one name for each kind."""

from __future__ import annotations

__all__ = ["marker_of", "name_of", "name_once"]

_KINDS = {
    "flip": ("s", "flip"), "fold": ("D", "fold"), "neimark-sacker": ("o", "Neimark-Sacker"), "torus": ("o", "torus"),
    "grazing": ("v", "grazing"), "hopf": ("^", "birth of a limit cycle"), "type-border": ("|", "border of types"),
}  # fmt: skip


def marker_of(kind: str) -> str:
    """The marker of a special point; a star for kinds without one of their own.

    Examples
    --------
    >>> marker_of("flip"), marker_of("cusp")
    ('s', '*')
    """
    return _KINDS[kind][0] if kind in _KINDS else "*"


def name_of(kind: str) -> str:
    """The name in a legend.

    Examples
    --------
    >>> name_of("type-border"), name_of("cusp")
    ('border of types', 'cusp')
    """
    return _KINDS[kind][1] if kind in _KINDS else kind


def name_once(kind: str, told: set[str]) -> str | None:
    """The name when it comes for the first time, and None from then on: a legend has one line for each kind.

    Examples
    --------
    >>> told: set[str] = set()
    >>> name_once("fold", told), name_once("fold", told)
    ('fold', None)
    """
    new = kind not in told
    told.add(kind)
    return name_of(kind) if new else None
