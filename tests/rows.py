"""A table of one claim is one test: its rows are subtests, each of which is run and told by itself, whatever became of those before it."""

from __future__ import annotations

import functools
import inspect


def short(value):
    """What a value is told by."""
    return value if isinstance(value, str) and len(value) < 40 else getattr(value, "__name__", None) or repr(value)[:40]


def each_row(names, rows, ids=None):
    """Like pytest.mark.parametrize, with one item for the whole table: for rows that take milliseconds and share what fixtures give.

    Of `monkeypatch` and `tmp_path` each row has its own.
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
            given |= {"subtests": subtests} if "subtests" in asked else {}
            for number, (word, row) in enumerate(zip(words, rows, strict=True)):
                with subtests.test(word):
                    own = dict(given)
                    if "tmp_path" in given:
                        own["tmp_path"] = given["tmp_path"] / f"row{number}"
                        own["tmp_path"].mkdir()
                    if "monkeypatch" in given:
                        with given["monkeypatch"].context() as own["monkeypatch"]:
                            test(**own, **dict(zip(names, row, strict=True)))
                    else:
                        test(**own, **dict(zip(names, row, strict=True)))

        kept = [p for name, p in asked.items() if name not in (*names, "subtests")]
        whole.__signature__ = inspect.Signature([inspect.Parameter("subtests", inspect.Parameter.POSITIONAL_OR_KEYWORD), *kept])
        return whole

    return decorated
