"""Descriptions of arguments from the docstring of a class or function, without its markup."""

from __future__ import annotations

import inspect
import re
from typing import Any

_LETTERS = {
    "omega": "ω", "xi": "ξ", "mu": "μ", "sigma": "σ", "theta": "θ", "zeta": "ζ", "sin": "sin", "cos": "cos", "le": "≤",
    "quad": " ",
    "varphi": "φ", "eta": "η", "dots": "…", "tau": "τ", "alpha": "α", "pm": "±",
}  # fmt: skip


def without_markup(text: str) -> str:
    r"""Text without the markup of reStructuredText and LaTeX.

    Examples
    --------
    >>> without_markup(r"Eq. 2.2: :math:`\xi(t) = A \sin(\omega t)`, see `solve`; ``None`` is none")
    'Eq. 2.2: ξ(t) = A sin(ω t), see solve; None is none'
    """
    text = re.sub(r":\w+:`([^`]*)`", lambda m: re.sub(r"\\([A-Za-z]+)", lambda c: _LETTERS.get(c[1], c[1]), m[1]), text)
    return " ".join(text.replace("`", "").split())


def first_line(thing: Any) -> str:
    """The first line of the docstring."""
    return without_markup((inspect.getdoc(thing) or "").partition("\n")[0])


def meanings(thing: Any) -> dict[str, dict[str, str]]:
    """Type, unit and meaning of every argument in the section Parameters.

    Examples
    --------
    >>> from stickslip.presets import piezo_rig
    >>> meanings(piezo_rig)["sigma1"]
    {'type': 'float or array', 'unit': 'N s/m', 'meaning': 'LuGre numbers (Eq. 5.3).'}
    """
    text = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[^\n]*\n-+\n|\Z)", inspect.getdoc(thing) or "", re.M | re.S)
    described: dict[str, dict[str, str]] = {}
    for entry in re.finditer(r"^(\S[^\n]*)\n((?:[ ]+[^\n]*\n?|\n)*)", text[1] if text else "", re.M):
        names, _, kind = entry[1].partition(" : ")
        described |= _entries([n.strip().lstrip("*") for n in names.split(",")], kind.strip(), entry[2])
    return described


def _entries(names: list[str], kind: str, text: str) -> dict[str, dict[str, str]]:
    """Arguments that are described together; their units stand in brackets, one for all or one for each."""
    bracket = re.search(r"\s*\[([^\]]*)\]", text)
    units = [u.strip() for u in bracket[1].split(",")] if bracket else [""]
    units = units if len(units) == len(names) else [", ".join(units)] * len(names)
    meaning = without_markup(text.replace(bracket[0], "", 1) if bracket else text)
    choice = re.fullmatch(r"\{(.*)\}", kind)
    if choice:
        meaning = f"one of {', '.join(c.strip().strip(chr(34)) for c in choice[1].split(','))}: {meaning}"
    return {name: {"type": kind, "unit": unit, "meaning": meaning} for name, unit in zip(names, units, strict=True)}
