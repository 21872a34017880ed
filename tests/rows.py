"""A table of one claim is one test: its rows are subtests, each run and reported by itself, whatever became of those before it."""

from __future__ import annotations

import functools
import inspect
from contextlib import ExitStack


def short(value):
    """The text that names a value in a report."""
    return value if isinstance(value, str) and len(value) < 40 else getattr(value, "__name__", None) or repr(value)[:40]


def each_row(names, rows, ids=None):
    """Like pytest.mark.parametrize, with one item for the whole table; for cheap rows that may share what fixtures give.

    Of `monkeypatch` and `tmp_path` each row has its own. Numerical cases that take time stay items of their own.
    """
    names = [name.strip() for name in names.split(",")] if isinstance(names, str) else list(names)
    rows = [row if len(names) > 1 else (row,) for row in rows]
    words = [str(word) for word in ids] if ids is not None else [", ".join(map(short, row)) for row in rows]
    assert rows and len(words) == len(rows)

    def decorated(test):
        asked = inspect.signature(test).parameters
        assert set(names) <= set(asked), f"{test.__name__} takes {', '.join(asked)}"

        @functools.wraps(test)
        def whole(subtests, **given):
            for number, (word, row) in enumerate(zip(words, rows, strict=True)):
                with subtests.test(word), ExitStack() as stack:
                    own = given | dict(zip(names, row, strict=True))
                    if "tmp_path" in given:
                        own["tmp_path"] = given["tmp_path"] / f"row{number}"
                        own["tmp_path"].mkdir()
                    if "monkeypatch" in given:
                        own["monkeypatch"] = stack.enter_context(given["monkeypatch"].context())
                    test(**own)

        fixtures = [inspect.Parameter("subtests", inspect.Parameter.POSITIONAL_OR_KEYWORD)]
        fixtures += [parameter for name, parameter in asked.items() if name not in names]
        whole.__signature__ = inspect.Signature(fixtures)
        return whole

    return decorated
