"""Resolves typed names to the numbers of a machine."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from typing import Any

#: Ends of the names of a number that is one for each direction.
SIDES = ("_plus", "_minus")
_INDEX = re.compile(r"\[(\d+|\*)\]")


def numbers_meant(typed: str, known: Iterable[str]) -> tuple[str, ...]:
    """The numbers that a name stands for; those of all parts if it gives no index, those of both directions if it gives no side.

    Parameters
    ----------
    typed : str
        A name as in ``robot.replace``, with an index as "modules[1].drive.amplitude" or as "modules.1.drive.amplitude"; ``*`` stands for
        anything.
    known : iterable of str
        All names of numbers.

    Examples
    --------
    >>> known = ["modules.0.body_mass", "modules.1.body_mass", "link.stiffness", "phases.0", "phases.1"]
    >>> numbers_meant("modules[1].body_mass", known), numbers_meant("modules.body_mass", known), numbers_meant("phases", known)
    (('modules.1.body_mass',), ('modules.0.body_mass', 'modules.1.body_mass'), ('phases.0', 'phases.1'))
    >>> numbers_meant("friction.mu", ["friction.mu_plus", "friction.mu_minus", "friction.v_s"])
    ('friction.mu_plus', 'friction.mu_minus')
    """
    names, wanted = list(known), _INDEX.sub(r".\1", str(typed))
    if wanted in names:
        return (wanted,)
    return tuple(name for name in names if fnmatchcase(name, wanted) or _fits(wanted.split("."), name.split(".")))


def _fits(wanted: list[str], own: list[str]) -> bool:
    """Whether a name matches the typed one when indices that were not typed are left out."""
    if not own:
        return not wanted
    if wanted and fnmatchcase(own[0], wanted[0]) and _fits(wanted[1:], own[1:]):
        return True
    if len(wanted) == len(own) == 1 and own[0] in (wanted[0] + side for side in SIDES):
        return True
    return own[0].isdigit() and _fits(wanted, own[1:])


def unequal_sides(typed: str, meant: Iterable[str], numbers: Mapping[str, Any]) -> str:
    """What is wrong with one name for the numbers of both directions of a record in which they differ; empty if nothing is.

    Examples
    --------
    >>> unequal_sides("mu", ["mu_plus", "mu_minus"], {"mu_plus": 0.15, "mu_minus": 0.21})
    "'mu' stands for mu_plus = 0.15 and mu_minus = 0.21, which differ; type one of the two"
    >>> unequal_sides("mu", ["mu_plus", "mu_minus"], {"mu_plus": 0.2, "mu_minus": 0.2})
    ''
    """
    names = list(meant)
    if len(names) != 2 or not all(name.endswith(side) for name, side in zip(names, SIDES, strict=True)):
        return ""
    if numbers[names[0]] == numbers[names[1]]:
        return ""
    shown = (f"{name} = {numbers[name]}" if numbers[name] is None else f"{name} = {numbers[name]:g}" for name in names)
    return f"{typed!r} stands for {' and '.join(shown)}, which differ; type one of the two"


def pairs_in(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Numbers that are one for each direction: their common name, and those of both.

    Examples
    --------
    >>> pairs_in(["mu_plus", "mu_minus", "v_s"])
    {'mu': ('mu_plus', 'mu_minus')}
    """
    known = list(names)
    stems = [name.removesuffix(SIDES[0]) for name in known if name.endswith(SIDES[0])]
    both = {stem: (stem + SIDES[0], stem + SIDES[1]) for stem in stems}
    return {stem: pair for stem, pair in both.items() if pair[1] in known and stem not in known}
