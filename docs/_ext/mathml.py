"""Equations as MathML, which browsers draw themselves: no script, no font, no network (decision 2026-11-21)."""

import re

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

_OPERATOR = r"\\(?:arcsin|arctan|sin|cos|tanh|tan|cot|exp|log|min|max|operatorname\{\w+\})(?![a-z])"


def spaced(tex: str) -> str:
    """Put the thin spaces around sin, cos, ... that TeX would put there and MathML does not."""
    tex = re.sub(rf"(?<=[\w}})])\s*({_OPERATOR})", r"\\,\1", tex)
    return re.sub(rf"({_OPERATOR})\s*(?=[A-Za-z\\|])", r"\1\\,", tex)


def mathml(tex: str, as_block: bool = False) -> str:
    """One formula as MathML. The bars of an absolute value are told apart: browsers take both for a binary operator."""
    markup = tex2mathml(spaced(tex).replace(r"\dots", r"\ldots"), as_block=as_block)
    return markup.replace('<mo class="mathopen">|', '<mo form="prefix">|').replace("<mo>|", '<mo form="postfix">|')


def inline(translator: HTML5Translator, node: nodes.math) -> None:
    """Write one formula within a line."""
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def block(translator: HTML5Translator, node: nodes.math_block) -> None:
    """Write one displayed formula, or several in rows."""
    tex = node.astext()
    if r"\\" in tex and r"\begin{" not in tex:
        tex = rf"\begin{{aligned}}{tex}\end{{aligned}}"
    translator.body.append(translator.starttag(node, "div", CLASS="math"))
    translator.body.append(mathml(tex, as_block=True))
    translator.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer as ``html_math_renderer = "mathml"``."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
