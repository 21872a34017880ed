"""Resolves typed names to the numbers of a machine."""

from __future__ import annotations

import re
from collections.abc import Iterable
from fnmatch import fnmatchcase

_INDEX = re.compile(r"\[(\d+|\*)\]")


def numbers_meant(typed: str, known: Iterable[str]) -> tuple[str, ...]:
    """The numbers that a name stands for; those of all parts if it gives no index.

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
    return own[0].isdigit() and _fits(wanted, own[1:])
