"""Every page with Python can be downloaded as a Jupyter notebook: its text in Markdown cells, its blocks in code cells."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

FOLDER = "_downloads/notebooks"
_CODE = re.compile(r"^```(?:python|\{drawn\}[^\n]*)\n(?P<code>.*?)^```$", re.M | re.S)
_PICTURE = re.compile(r"!\[[^\]]*\]\([^)]*\)")
_LINK = re.compile(r"\[([^\]]+)\]\((?!https?:)[^)\s]*\)")  # within the documentation: a notebook stands alone


def notebook(text: str) -> dict[str, Any]:
    """The notebook (nbformat 4.4) of a page written in Markdown."""
    cells, end = [], 0
    for found in _CODE.finditer(text):
        cells += [_prose(text[end : found.start()]), _cell("code", found["code"], execution_count=None, outputs=[])]
        end = found.end()
    cells.append(_prose(text[end:]))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {
        "cells": [cell for cell in cells if cell["source"]],
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 4,
    }


def has_code(text: str) -> bool:
    """Whether a page has Python that runs."""
    return bool(_CODE.search(text))


def _prose(text: str) -> dict[str, Any]:
    return _cell("markdown", _LINK.sub(r"\1", _PICTURE.sub("", text)))


def _cell(kind: str, text: str, **more: Any) -> dict[str, Any]:
    return {"cell_type": kind, "metadata": {}, "source": text.strip("\n").splitlines(keepends=True), **more}


def offer(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Write the notebook of a page, and a link to it below the page's title."""
    source = Path(app.env.doc2path(page)) if doctree is not None else Path()
    if source.suffix != ".md" or not has_code(text := source.read_text(encoding="utf-8")):
        return
    file = Path(app.outdir) / FOLDER / f"{page.replace('/', '-')}.ipynb"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(notebook(text), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    way = "../" * page.count("/") + f"{FOLDER}/{file.name}"
    link = f'</h1>\n<p class="notebook"><a href="{way}" download>Download this page as a Jupyter notebook</a></p>'
    context["body"] = context["body"].replace("</h1>", link, 1)


def setup(app: Sphinx) -> dict[str, bool]:
    """Write notebooks when pages are written."""
    app.connect("html-page-context", offer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
