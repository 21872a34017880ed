"""The Python of README and docs runs, block after block, as a reader would type it; the docs' build runs and shows the same."""

import sys
import traceback

import pytest

from house import PAGES, ROOT, blocks

sys.path.append(str(ROOT / "docs" / "_ext"))
from notebooks import notebook
from page_scripts import Script

PAGES_WITH_PYTHON = [page for page in PAGES if blocks(page, "python")]
#: Pages of the docs run in every build of the docs, which is a part of CI; here they run when asked for.
CASES = [
    pytest.param(page, marks=pytest.mark.slow if "docs" in page.relative_to(ROOT).parts else (), id=page.relative_to(ROOT).as_posix())
    for page in PAGES_WITH_PYTHON
]


@pytest.mark.parametrize("page", CASES)
def test_the_examples_on_a_page_run(page, tmp_path):
    script = Script(tmp_path)
    for block in blocks(page, "python"):
        try:
            script.run(block.text, str(page), block.line)
        except Exception as error:
            pytest.fail(f"{block}\n{''.join(traceback.format_exception(error))}", pytrace=False)


def test_what_a_block_prints_and_its_last_value_are_its_output(tmp_path):
    script = Script(tmp_path)
    assert script.run("x = 2\nprint('two')\nx + 1", "page").text == "two\n3"
    assert script.run("x = 5", "page").text == ""
    assert "<table" in script.run("import stickslip as ss\nss.presets.piezo_rig(1.7, 5e-4)", "page").html
    drawn = script.run("import matplotlib.pyplot as plt\nplt.plot([x])\nplt.xlabel('time [s]')", "page")
    assert len(drawn.figures) == 1 and drawn.text == ""


def test_a_warning_in_a_block_is_an_error_that_names_the_line(tmp_path):
    with pytest.raises(UserWarning) as raised:
        Script(tmp_path).run("x = 1\nimport warnings; warnings.warn('so not')", "page.md", 40)
    assert ("page.md", 41) in [(entry.filename, entry.lineno) for entry in traceback.extract_tb(raised.tb)]


def test_a_notebook_has_the_code_of_its_page_in_order():
    page = ROOT / "docs" / "tutorials" / "first-robot.md"
    cells = notebook(page.read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert code == [block.text.rstrip("\n") for block in blocks(page, "python")]
    fields = {"cell_type", "metadata", "source", "execution_count", "outputs"}  # what nbformat 4 wants of a code cell
    assert all(set(cell) == fields for cell in cells if cell["cell_type"] == "code")
    assert not any(".md)" in "".join(cell["source"]) for cell in cells)
