"""One explorer for all files, and one page of it for each, which a test finds as it is at first."""

import contextlib

import pytest

from browsed import Page
from explorers import Explorer


@pytest.fixture(scope="session")
def explorer():
    made = Explorer()
    with contextlib.closing(made):
        yield made


@pytest.fixture(scope="module")
def kept_page(browser, explorer):
    made = Page(browser, explorer)
    with contextlib.closing(made.context):
        yield made


@pytest.fixture
def page(kept_page):
    yield kept_page.anew()
    assert kept_page.errors == [] and kept_page.outside == []
