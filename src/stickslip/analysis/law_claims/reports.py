"""The result of checking a law."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, did_you_mean


@dataclass(frozen=True)
class Claim:
    """One claim about a law.

    Parameters
    ----------
    name : str
        The claim in words.
    passed : bool or None
        Whether it holds; None if it is only measured, or could not be tested.
    value : float
        The measured value.
    meaning : str
        The meaning of the value.
    remedy : str
        The remedy if the claim does not hold.
    """

    name: str
    passed: bool | None
    value: float
    meaning: str
    remedy: str = ""

    def __str__(self) -> str:
        mark = {True: "holds", False: "FAILS", None: "-"}[self.passed]
        return f"{mark:6}{self.name:34}{self.value:9.2g}  {self.meaning}"


@cache
def _texts() -> dict[str, dict[str, str]]:
    return tomllib.loads(Path(__file__).with_name("claims.toml").read_text(encoding="utf-8"))


def claim_of(key: str, passed: bool | None, value: float, **values: Any) -> Claim:
    """A claim in the words of ``claims.toml``."""
    text = _texts()[key]
    return Claim(text["name"], passed, value, text["meaning"].format(**values), text.get("remedy", ""))


@dataclass(frozen=True)
class LawReport:
    """The claims about one law, and whether they hold; `print` shows them as a table.

    Parameters
    ----------
    law : str
        Name of the law.
    claims : tuple of Claim
        In the order in which they were checked.
    """

    law: str
    claims: tuple[Claim, ...]

    @property
    def failures(self) -> tuple[Claim, ...]:
        """The claims that do not hold."""
        return tuple(claim for claim in self.claims if claim.passed is False)

    @property
    def passed(self) -> bool:
        """Whether no claim fails."""
        return not self.failures

    def __getitem__(self, name: str) -> Claim:
        """The claim of this name."""
        claims = {claim.name: claim for claim in self.claims}
        if name not in claims:
            raise InputError("check_law", [f"has no claim {name!r}; {did_you_mean(name, claims)}"])
        return claims[name]

    def __str__(self) -> str:
        return "\n".join([self.law, *(f"  {claim}" for claim in self.claims)])
