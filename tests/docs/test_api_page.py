"""Every public name is on the page of the API, listed there or not."""

import sys

from house import ROOT

sys.path.append(str(ROOT / "docs" / "_ext"))
from api_pages import completed


def test_a_public_name_that_the_page_does_not_list_is_in_the_section_of_its_package():
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    function, result = ".. autofunction:: stickslip.energy\n", ".. autoclass:: stickslip.analysis.Motion\n   :members:\n"
    whole = completed(page.replace(function, "").replace(result, ""))
    section = whole.partition("\n## Analyse\n")[2].partition("\n## ")[0]
    assert function.strip() in section and result.strip() in section
    assert completed(whole) == whole
