"""Equations as MathML, which browsers render themselves: no script, no font, no network (decision 2026-11-21)."""

from __future__ import annotations

import re

from stickslip.basics.errors import InputError

_OPERATOR = r"\\(?:arcsin|arctan|sinh|cosh|sin|cos|tanh|tan|cot|exp|log|min|max|operatorname\{\w+\})(?![a-z])"
#: An index below a letter with dots, which TeX places beside it.
_DOTTED = re.compile(r"<munderover>\s*(<mi>[^<]*</mi>)\s*((?:(?!munderover).)*?)\s*(<mo[^>]*>[¨˙]</mo>)\s*</munderover>", re.S)


def _spaced(tex: str) -> str:
    """Add the thin spaces around sin, cos, ... that TeX adds and MathML does not."""
    tex = re.sub(rf"(?<=[\w}})])\s*({_OPERATOR})", r"\\,\1", tex)
    return re.sub(rf"({_OPERATOR})\s*(?=[A-Za-z\\|])", r"\1\\,", tex)


def mathml(tex: str, as_block: bool = False) -> str:
    r"""A formula as MathML, for an HTML page. Opening and closing bars of absolute values are marked, as browsers take them for operators.

    Parameters
    ----------
    tex : str
        LaTeX, as from `stickslip.latex`; ``aligned`` and ``cases`` are allowed.
    as_block : bool
        Whether it is a displayed formula.

    Raises
    ------
    InputError
        It is not LaTeX, or uses commands that docutils does not know.

    Examples
    --------
    >>> "<msub>" in mathml(r"\mu_{+}"), "://" in mathml("x")
    (True, False)
    """
    from docutils.utils.math.latex2mathml import tex2mathml

    try:
        markup = tex2mathml(_spaced(tex).replace(r"\dots", r"\ldots"), as_block=as_block)
    except (ValueError, LookupError, AttributeError) as error:  # its MathError, and what it meets in LaTeX that ends too early
        why = f" ({error})" if isinstance(error, ValueError) else ""
        raise InputError("formula", [
            f"{tex.strip()[:200]!r} is no formula that a page can show{why}; allowed are letters, indices and the usual commands "
            r"of LaTeX for mathematics; write for example quantity('stiffness', 'N/m', r'\sigma_{0}')"
        ]) from None  # fmt: skip
    markup = markup.replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "")
    markup = _DOTTED.sub(r"<msub><mover>\1\3</mover>\2</msub>", markup)
    return markup.replace('<mo class="mathopen">|', '<mo form="prefix">|').replace("<mo>|", '<mo form="postfix">|')
