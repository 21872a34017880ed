"""The paper's equations as solved here: traced from the code where possible, corrected where the paper has an erratum."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.engine.latex import aligned, latex, written
from stickslip.models.nondimensional import dimensionless, ratios
from stickslip.models.tracks.tracks import fold
from stickslip.show.paper.cases import EXPERIMENTS, rig
from stickslip.show.paper.sentences import texts

__all__ = ["Equation", "equations"]


@dataclass(frozen=True)
class Equation:
    """One of the paper's equations.

    Parameters
    ----------
    number : str
        Its number in the paper; several numbers for equations that form one system here.
    title : str
        Its subject.
    latex : str
        The equation.
    traced : bool
        Whether it was traced from the code in this run.
    remark : str
        Differences from the printed equation, or the meaning of a symbol.
    """

    number: str
    title: str
    latex: str
    traced: bool
    remark: str = ""


def equations() -> tuple[Equation, ...]:
    """All equations on which the results rest, in the paper's order."""
    traced = {
        "coulomb": latex(rig(EXPERIMENTS[0], law="coulomb").friction),
        "lugre": latex(rig(EXPERIMENTS[0])),
        "folded": _folded(),
        "dimensionless": latex(dimensionless(rig(EXPERIMENTS[0]))),
        "ratios": _ratios(),
    }
    return tuple(Equation(**{"latex": traced.get(key), "traced": key in traced, **text}) for key, text in texts("equations").items())


def _folded() -> str:
    lines = []
    for letter, name in (("\\mu", r"\mu_{0}"), ("f", "f_{0}")):
        forward, backward = written(fold, coefficient=name, tilt=r"\theta")
        lines += [rf"{letter}_{{+}} &= {forward}", rf"{letter}_{{-}} &= {backward}"]
    return aligned(lines)


def _ratios() -> str:
    ks = written(ratios, mu0=r"\mu_{0}", f0="f_{0}", tilt=r"\theta")
    return aligned([rf"k_{{{i + 1}}} &= {k}" for i, k in enumerate(ks)])
