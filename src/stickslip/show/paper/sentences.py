"""Sentences of the report: templates in ``sentences.toml``, in the order of the paper, filled with the numbers of a run."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from stickslip.basics.phrases import listed
from stickslip.show.paper.words import millimetres, percent, plain, speed
from stickslip.show.reports.html import grouped

__all__ = ["filled", "texts"]


@cache
def _all_texts() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("sentences.toml").read_text(encoding="utf-8"))


def texts(kind: str) -> Any:
    """The templates of a kind, such as "claims", by their keys."""
    return _all_texts()[kind]


@cache
def _environment() -> Any:
    from jinja2 import Environment, StrictUndefined

    made = Environment(undefined=StrictUndefined, trim_blocks=True)
    made.globals |= {say.__name__: say for say in (grouped, listed, millimetres, percent, plain, speed, then)}
    return made


def then(loop: Any) -> str:
    """The separator after an entry of a list in a sentence."""
    return "" if loop.last else " and " if loop.revindex == 2 else ", "


def filled(template: Any, values: dict[str, Any]) -> Any:
    """A filled template, or all templates of a list or a table.

    Examples
    --------
    >>> filled(["{% for n in numbers %}{{ n }}{{ then(loop) }}{% endfor %}", "{{ percent(0.5) }}"], {"numbers": [1, 2, 3]})
    ('1, 2 and 3', '50 %')
    """
    if isinstance(template, str):
        return _environment().from_string(template).render(values)
    if isinstance(template, dict):
        return {key: filled(text, values) for key, text in template.items()}
    return tuple(filled(text, values) for text in template)
