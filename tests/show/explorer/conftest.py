"""One page of a module's explorer, which each test finds as it is at first."""

import contextlib

import pytest

from browsed import Page


@pytest.fixture(scope="module")
def kept_page(browser, explorer):
    made = Page(browser, explorer)
    with contextlib.closing(made.context):
        yield made


@pytest.fixture
def page(kept_page):
    yield kept_page.anew()
    assert kept_page.errors == [] and kept_page.outside == []
