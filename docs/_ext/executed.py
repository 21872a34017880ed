"""Pages show what their Python prints and draws: every ``python`` block runs when the documentation is built.

A page's blocks are one script. What a block prints stands below it, and so do the figures that it leaves open. The directive ``drawn`` is a
block whose figure stands above it, with a description as its argument. An exception or a warning in a block is a warning of the build,
which CI takes as an error. Outputs are never kept in the repository, so none can be out of date.
"""

from __future__ import annotations

import os
import re
import tempfile
import time
import traceback
from pathlib import Path

from docutils import nodes
from notebooks import has_code
from page_scripts import Script, in_words, saved
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

_LOG = logging.getLogger(__name__)
FOLDER = "drawn"  # in the folder of the doctrees, from where Sphinx copies what pages show
BEFORE_IMAGES_ARE_COLLECTED = 400
APART = 9  # about the number of stretches


class Drawn(SphinxDirective):
    """A figure with the lines that draw it."""

    has_content = True
    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """The lines; their figure is added when they have run."""
        code = "\n".join(self.content)
        block = nodes.literal_block(code, code, language="python", alt=self.arguments[0])
        self.set_source_info(block)
        return [block]


def deal(app: Sphinx, env: BuildEnvironment, pages: list[str]) -> None:
    """Spread the pages that run over the list, of which each process of Sphinx has a stretch: tutorials, all slow, are neighbours."""
    run = [page for page in pages if (path := Path(env.doc2path(page))).suffix == ".md" and has_code(path.read_text(encoding="utf-8"))]
    run = [page for first in range(APART) for page in run[first::APART]]
    rest = [page for page in pages if page not in run]
    pages[:] = [page for _, page in sorted(((k + 0.5) / len(part), page) for part in (run, rest) for k, page in enumerate(part))]


def execute(app: Sphinx, doctree: nodes.document) -> None:
    """Run the page's blocks and put their outputs into the page."""
    page = app.env.docname
    source = Path(app.env.doc2path(page))
    blocks = [node for node in doctree.findall(nodes.literal_block) if node.get("language") == "python"]
    if source.suffix != ".md" or not blocks:
        return
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        script = Script(Path(folder))
        for number, block in enumerate(blocks):
            try:
                add(block, *outputs(app, block, script, source, number))
            except Exception:
                _LOG.warning("the Python on this page fails: %s", traceback.format_exc(limit=-3), location=block)
                break
    _LOG.info("%s: %d blocks run in %.1f s", page, len(blocks), time.perf_counter() - started)


def outputs(
    app: Sphinx, block: nodes.literal_block, script: Script, source: Path, number: int
) -> tuple[list[nodes.Node], list[nodes.image]]:
    """What a block prints and its last value, and its figures, as nodes."""
    output = script.run(block.astext(), str(source), (block.line or 1) + 1)
    if "alt" in block and not output.figures:
        raise ValueError("no figure is open after these lines")
    folder = Path(app.env.doctreedir) / FOLDER
    pictures = []
    for k, figure in enumerate(output.figures):
        file = saved(figure, folder, f"{app.env.docname} {number} {k} {block.astext()}")
        uri = Path(os.path.relpath(file, source.parent)).as_posix()
        pictures.append(nodes.image(uri=uri, alt=block.get("alt") or in_words(figure), classes=["drawn"]))
    shape = ["output", *(["aligned"] if len(re.findall(r"^\S.*\S {3,}\S", output.text, re.M)) > 2 else [])]  # columns do not wrap
    text = [nodes.literal_block(output.text, output.text, language="none", classes=shape)] if output.text else []
    html = [nodes.raw("", f'<div class="output html">{output.html}</div>', format="html")] if output.html else []
    return [*text, *html], pictures


def add(block: nodes.literal_block, below: list[nodes.Node], pictures: list[nodes.image]) -> None:
    """Put outputs below the block; the figure of a ``drawn`` block stands above it."""
    place = block.parent
    if "alt" in block:
        place.insert(place.index(block), pictures[-1:])
    place.insert(place.index(block) + 1, below if "alt" in block else [*below, *pictures])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive, and the event at which a page has been read."""
    app.add_directive("drawn", Drawn)
    app.connect("env-before-read-docs", deal)
    app.connect("doctree-read", execute, priority=BEFORE_IMAGES_ARE_COLLECTED)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
