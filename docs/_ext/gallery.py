"""The directive ``drawn``: a few lines of Python and the figure that they draw, drawn when the documentation is built.

The last figure that is open when the lines have run is the one that is shown. A page's blocks follow each other in one script, as a reader
would type them. The text for those who do not see the picture is the directive's argument. Whatever goes wrong is an error of the build.
"""

from __future__ import annotations

import hashlib
import time
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

_LOG = logging.getLogger(__name__)
FOLDER = "drawn"  # in the folder of the doctrees, from where Sphinx copies what pages show


class Drawn(SphinxDirective):
    """A figure with its code."""

    has_content = True
    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        """The picture, and below it the lines that made it."""
        code = "\n".join(self.content) + "\n"
        where = f"{self.env.docname}, line {self.lineno}"
        started = time.perf_counter()
        try:
            file = drawn(code, self.env.temp_data.setdefault("drawn", {}), Path(self.env.doctreedir) / FOLDER, where)
        except Exception as error:
            raise self.error(f"{where}: {type(error).__name__}: {error}") from error
        _LOG.info("%s: drawn in %.1f s", where, time.perf_counter() - started)
        source = Path(self.env.srcdir) / self.env.doc2path(self.env.docname, base=False)
        uri = Path(*[".."] * len(source.parent.relative_to(self.env.srcdir).parts), relative(file, Path(self.env.srcdir)))
        picture = nodes.image(uri=uri.as_posix(), alt=self.arguments[0], classes=["drawn"])
        return [picture, nodes.literal_block(code, code, language="python")]


def relative(file: Path, folder: Path) -> Path:
    """The way from a folder to a file, wherever it is."""
    import os

    return Path(os.path.relpath(file, folder))


def drawn(code: str, script: dict, folder: Path, where: str) -> Path:
    """Run the lines in a page's script and write the figure they leave open as SVG."""
    import os
    import tempfile

    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    plt.close("all")
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as away:  # what the lines write is no part of the documentation
        os.chdir(away)
        try:
            exec(compile(code, where, "exec"), script)
        finally:
            os.chdir(before)
    if not plt.get_fignums():
        raise ValueError("no figure is open after these lines")
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{hashlib.sha256(code.encode()).hexdigest()[:16]}.svg"
    with mpl.rc_context({"svg.hashsalt": "gallery", "svg.fonttype": "path"}):
        plt.figure(plt.get_fignums()[-1]).savefig(file, metadata={"Date": None}, dpi=180, bbox_inches="tight", facecolor="white")
    plt.close("all")
    return file


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("drawn", Drawn)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
