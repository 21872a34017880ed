"""The Python of README and docs runs, block after block, as a reader would type it."""

import sys
import traceback
import types

import pytest

from house import PAGES, ROOT, blocks

PAGES_WITH_PYTHON = [page for page in PAGES if blocks(page, "python")]


@pytest.mark.parametrize("page", PAGES_WITH_PYTHON, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_the_examples_on_a_page_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    script = types.ModuleType("page")  # a class defined on the page belongs to a module that exists
    monkeypatch.setitem(sys.modules, "page", script)
    for block in blocks(page, "python"):
        source = "\n" * (block.line - 1) + block.text  # a traceback then shows the page and its line
        try:
            exec(compile(source, str(page), "exec"), script.__dict__)
        except Exception as error:
            where = error.with_traceback(error.__traceback__.tb_next)
            pytest.fail(f"{block}\n{''.join(traceback.format_exception(where))}", pytrace=False)
