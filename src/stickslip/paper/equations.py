"""The paper's equations as they are solved here: read off the code where it can be traced, set right where the paper has an erratum."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.engine.latex import aligned, latex, written
from stickslip.nondimensional import dimensionless, ratios
from stickslip.paper.cases import EXPERIMENTS, rig
from stickslip.tracks import fold

__all__ = ["Equation", "equations"]


@dataclass(frozen=True)
class Equation:
    """One of the paper's equations.

    Parameters
    ----------
    number : str
        Its number in the paper; several where they are one system here.
    title : str
        What it says.
    latex : str
        The equation.
    traced : bool
        Whether it was read off the code that computes it, in this run.
    remark : str
        What differs from what is printed, or what a letter means.
    """

    number: str
    title: str
    latex: str
    traced: bool
    remark: str = ""


def equations() -> tuple[Equation, ...]:
    """All that the results rest on, in the paper's order."""
    return (*_robot(), *_beam(), *_incline(), *_dimensionless())


def _robot() -> tuple[Equation, ...]:
    robot = rig(EXPERIMENTS[0])
    coulomb = latex(rig(EXPERIMENTS[0], law="coulomb").friction)
    return (
        Equation(
            "2.1, 2.2",
            "Body, inner mass, and how it is driven",
            r"M\,\ddot x = F - R, \qquad m\,(\ddot x + \ddot\xi) = -F, \qquad \xi = A \sin \omega t",
            False,
        ),
        Equation("2.4", "Coulomb friction", coulomb, True, "N = (M+m)g. At rest the force is what holds the body, within its limits."),
        Equation(
            "2.3, 2.5, 2.6",
            "The robot with LuGre friction",
            latex(robot),
            True,
            "The rate of the bristle is 0 at v = 0, where the paper leaves it undefined.",
        ),
    )


def _beam() -> tuple[Equation, ...]:
    beam = (
        r"EI\,\frac{\partial^4 u}{\partial x^4} + c\,\frac{\partial u}{\partial t} + \rho A_1\,\frac{\partial^2 u}{\partial t^2} = "
        r"\frac{\partial}{\partial x}\left[T(t)\,\left(\delta(x)-\delta(x-l_0)\right)\right]"
    )
    steady = (
        r"u(L,t) = \frac{\hat T L^2}{EI}\sum_i \frac{\varphi_i(1)\,\varphi_i'(l_0/L)}{m_i}\,"
        r"\frac{\omega_0^2\,\sin(\omega t-\psi_i)}{\sqrt{(\omega_i^2-\omega^2)^2+(2\zeta_i\omega_i\omega)^2}}, \qquad "
        r"\omega_0^2 = \frac{EI}{\rho A_1 L^4}"
    )
    frequencies = r"1+\cos b\,\cosh b + R\,b\,(\cos b\,\sinh b-\sin b\,\cosh b) = 0, \qquad \omega_i = b_i^2\,\omega_0"
    shapes = (
        r"\varphi_i(s) = \cosh b_i s-\cos b_i s-\frac{\cosh b_i+\cos b_i}{\sinh b_i+\sin b_i}\,(\sinh b_i s-\sin b_i s), \qquad s = x/L"
    )
    return (
        Equation(
            "3.1",
            "The beam",
            beam,
            False,
            "Printed with u_xx for u_tt, with a plus between the couples, and with a factor 2 that is in T already.",
        ),
        Equation(
            "3.2", "The couple of both patches", r"T(t) = d_{31}\,(h_1+h_2)\,b\,E_2\,V(t)", False, "E₂ is Young's modulus of the patch."
        ),
        Equation("3.4", "Its modes", shapes, False),
        Equation("3.5", "Its frequencies", frequencies, False, "R = m/(ρA₁L). The boundary conditions of the paper lead to this; b = βL."),
        Equation("3.7", "The tip, steady", steady, False, "mᵢ is the modal mass 1 + Rφᵢ(1)²/4; tan ψᵢ = 2ζᵢωᵢω/(ωᵢ² − ω²)."),
    )


def _incline() -> tuple[Equation, ...]:
    lines = []
    for letter, name in (("\\mu", r"\mu_{0}"), ("f", "f_{0}")):
        forward, backward = written(fold, coefficient=name, tilt=r"\theta")
        lines += [rf"{letter}_{{+}} &= {forward}", rf"{letter}_{{-}} &= {backward}"]
    return (
        Equation(
            "3.8, 4.1",
            "The incline, folded into the coefficients",
            aligned(lines),
            True,
            "The friction forces are these times (M+m)g, printed as Mg. Exact for Coulomb friction, another model for LuGre friction.",
        ),
    )


def _dimensionless() -> tuple[Equation, ...]:
    ks = written(ratios, mu0=r"\mu_{0}", f0="f_{0}", tilt=r"\theta")
    named = aligned([rf"k_{{{i + 1}}} &= {k}" for i, k in enumerate(ks)])
    form = latex(dimensionless(rig(EXPERIMENTS[0])))
    return (
        Equation("5.1", "The same without dimensions", form, True, "Units: A, Aω, 1/ω; μ = m/(M+m). The paper prints ẏ for v̇ once."),
        Equation("5.2", "The ratios of the coefficients", named, True, "The paper prints f₀ for μ₀ in k₃."),
    )
