"""The Python on a page as one script: its blocks run in order, each with what it prints and draws.

The build of the docs (``executed.py``) and the tests (``tests/docs/test_docs_examples.py``) run pages by this module alone, as a reader
would who types one block after the other.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import io
import os
import sys
import types
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LARGEST_SVG = 400_000  # bytes; a map has a shape for every point, and is kept as pixels instead


@dataclass(frozen=True)
class Output:
    """What a block printed, its last expression's value as text or as its HTML, and the figures it left open."""

    text: str
    figures: tuple[Any, ...]
    html: str = ""


class Script:
    """Runs the blocks of one page in a module and a folder of their own."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.module = types.ModuleType("page")  # a class defined on the page belongs to a module that exists

    def run(self, code: str, file: str, line: int = 1) -> Output:
        """Run one block; `file` and `line` are where a traceback points."""
        import matplotlib as mpl

        mpl.use("Agg")
        import matplotlib.pyplot as plt

        plt.close("all")
        tree = ast.increment_lineno(ast.parse(code, file), line - 1)
        printed = io.StringIO()
        with self._as_main(), contextlib.redirect_stdout(printed), warnings.catch_warnings():
            warnings.simplefilter("error")
            value = self._executed(tree, file)
        figures = tuple(plt.figure(number) for number in plt.get_fignums())
        if value is None or figures or isinstance(value, (str, os.PathLike)):
            return Output(printed.getvalue().rstrip("\n"), figures)
        if type(value).__module__.startswith("stickslip.") and hasattr(value, "_repr_html_"):  # as a notebook shows it
            return Output(printed.getvalue().rstrip("\n"), figures, value._repr_html_())
        return Output(f"{printed.getvalue()}{value!r}", figures)

    def _executed(self, tree: ast.Module, file: str) -> Any:
        """The value of the last line, if that is an expression."""
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, file, "exec"), self.module.__dict__)
        return last and eval(compile(ast.Expression(last.value), file, "eval"), self.module.__dict__)

    @contextlib.contextmanager
    def _as_main(self):
        """In the page's folder, with the page's module where pickles and dataclasses look for it."""
        before, other = Path.cwd(), sys.modules.get("page")
        os.chdir(self.folder)
        sys.modules["page"] = self.module
        try:
            yield
        finally:
            os.chdir(before)
            if other is None:
                del sys.modules["page"]
            else:
                sys.modules["page"] = other


def saved(figure: Any, folder: Path, key: str) -> Path:
    """The figure as a file named by `key`: SVG, or PNG where that would be large."""
    import matplotlib as mpl

    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{hashlib.sha256(key.encode()).hexdigest()[:16]}.svg"
    how = dict(bbox_inches="tight", facecolor="white")
    with mpl.rc_context({"svg.hashsalt": "docs", "svg.fonttype": "path"}):
        figure.savefig(file, metadata={"Date": None}, dpi=180, **how)
    if file.stat().st_size > LARGEST_SVG:
        file.unlink()
        file = file.with_suffix(".png")
        figure.savefig(file, dpi=144, **how)
    return file


def in_words(figure: Any) -> str:
    """A figure for those who do not see it: titles and axis labels."""
    words = []
    for axes in figure.axes:
        title, x, y = axes.get_title(), axes.get_xlabel(), axes.get_ylabel()
        words += [f"{title}: {y} against {x}" if title else f"{y} against {x}"] if x and y else [title or y or x]
    return "Figure: " + "; ".join(dict.fromkeys(part for part in words if part)) if any(words) else "Figure drawn by the lines above"
