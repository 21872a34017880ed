"""Special points and curves in figures: one mark and one name for each kind."""

from __future__ import annotations

_KINDS = {
    "flip": ("s", "flip"), "fold": ("D", "fold"), "neimark-sacker": ("o", "Neimark-Sacker"), "torus": ("o", "torus"),
    "grazing": ("v", "grazing"), "hopf": ("^", "birth of a limit cycle"), "type-border": ("|", "border of types"),
    "branch-point": ("X", "branch point"), "cusp": ("<", "cusp"), "fold-flip": ("p", "fold-flip"),
    "R1": ("$1$", "1:1 resonance"), "R2": ("$2$", "1:2 resonance"), "R3": ("$3$", "1:3 resonance"), "R4": ("$4$", "1:4 resonance"),
    "fold-neimark-sacker": ("h", "fold-Neimark-Sacker"), "flip-neimark-sacker": ("8", "flip-Neimark-Sacker"),
    "triple-point": ("*", "triple point"),
}  # fmt: skip


def marker_of(kind: str) -> str:
    """The marker of a special point; a star for kinds without their own.

    Examples
    --------
    >>> marker_of("flip"), marker_of("cusp")
    ('s', '<')
    """
    return _KINDS[kind][0] if kind in _KINDS else "*"


def name_of(kind: str) -> str:
    """The name in a legend.

    Examples
    --------
    >>> name_of("type-border"), name_of("R2")
    ('border of types', '1:2 resonance')
    """
    return _KINDS[kind][1] if kind in _KINDS else kind


def name_once(kind: str, named: set[str]) -> str | None:
    """The name at its first occurrence, then None: a legend has one line for each kind.

    Examples
    --------
    >>> told: set[str] = set()
    >>> name_once("fold", told), name_once("fold", told)
    ('fold', None)
    """
    new = kind not in named
    named.add(kind)
    return name_of(kind) if new else None
