r"""The equations of a law, a robot, a flow or any machine as LaTeX: their plain Python called with letters, a law once a direction."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stickslip.basics.arguments import LawOrModel, explains_arguments
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.latex_flows import lines_of_flow
from stickslip.engine.latex_laws import lines_of_law
from stickslip.engine.latex_motion import lines_of_motion
from stickslip.engine.letters import symbol
from stickslip.engine.tex import letters_of, text_of
from stickslip.models.friction.law_adapter import is_law
from stickslip.models.model_adapter import adapter_of, is_model


@explains_arguments
def latex(model: LawOrModel) -> str:
    r"""The equations of a friction law, robot, machine or flow as LaTeX, derived from the code that solves them.

    Parameters
    ----------
    model : Coulomb, LuGre or any law; Robot, mechanism or machine; SwitchingFlow
        Of what moves: the equation of motion of each body with the jumps of its velocity, the forces of links and elastic stops,
        prescribed distances and hits, and for each contact the load where it is no number of its own, and the law. Where the contact
        moves, the law's v is the slip velocity w. Of a flow the rates of its states by modes, where each mode is left for which other
        (dots for one that a function chooses), and slip, load and law of its contacts.

    Returns
    -------
    str
        An ``aligned`` block: the friction force R and the rates of the inner states for v > 0 and v < 0; for a set-valued law the
        sliding forces and the interval of forces at rest. Memories of a law are written as m, the force that would hold the body as R_0.
        Bodies and contacts have their names as index, or their numbers where the names are numbered; lines that are the same for several
        contacts are written once, with the index i. A field of a user-defined class may name its symbol: ``field(metadata={"symbol":
        "m_1"})``.

    Raises
    ------
    InputError
        If it is neither, or if its drive is not a formula, such as a record.

    Examples
    --------
    >>> import stickslip as ss
    >>> print(ss.latex(ss.Coulomb(mu_plus=0.15, mu_minus=0.21)))
    \begin{aligned}
    R &= N \mu_{+}, && v > 0 \\
    R &= - N \mu_{-}, && v < 0 \\
    - N \mu_{-} \le R &\le N \mu_{+}, && v = 0
    \end{aligned}
    >>> print(ss.latex(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")))
    \begin{aligned}
    \left(M + m\right) \ddot x &= A \omega^{2} m \sin{\left(\omega t \right)} - R \\
    N &= g \left(M + m\right) \\
    R &= N \mu_{+}, && v > 0 \\
    R &= - N \mu_{-}, && v < 0 \\
    - N \mu_{-} \le R &\le N \mu_{+}, && v = 0
    \end{aligned}
    """
    if is_model(model):
        return aligned(lines_of_motion(model) if adapter_of(model).has_bodies else lines_of_flow(model))
    if not is_law(model):
        given = f"{type(model).__name__} given; allowed is a friction law, a robot, a machine or a flow"
        raise InputError("latex", [f"{given}; type for example ss.latex(robot.friction)"])
    traced = replace_leaf(model, letters_of(model, [name for name, _ in leaves(model)]).symbols)
    return aligned(lines_of_law(traced, symbol("N"), "v"))


def aligned(lines: list[str]) -> str:
    """Lines as one block."""
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"


def written(function: Callable[..., Any], **names: str) -> list[str]:
    r"""The results of a plain Python function as LaTeX, one text for each returned number; `names` are its arguments' symbols.

    Examples
    --------
    >>> from stickslip.tracks import fold
    >>> print(*written(fold, coefficient=r"\mu_{0}", tilt=r"\theta"), sep="\n")
    \mu_{0} \cos{\left(\theta \right)} - \sin{\left(\theta \right)}
    \mu_{0} \cos{\left(\theta \right)} + \sin{\left(\theta \right)}
    """
    symbols = {name: symbol(text) for name, text in names.items()}
    values = function(**symbols)
    return [text_of(value) for value in (values if isinstance(values, tuple) else (values,))]
