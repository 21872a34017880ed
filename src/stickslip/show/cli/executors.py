"""``--executor``: where a long command computes, besides the threads of ``workers=``."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

from stickslip.basics.contracts import EXECUTORS
from stickslip.basics.errors import InputError
from stickslip.show.cli.study_files import imported

_KIND = "processes"
_ALLOWED = "allowed is processes:N, or module:function (file.py:function) that makes an executor; type for example --executor processes:8"


def executor_asked(text: str | None) -> dict[str, Any]:
    """The arguments `executor` and `workers` of a long call from the text of ``--executor``; none without it.

    ``processes:8`` are eight processes of this computer, begun again if one is killed; ``module:function`` is called for an executor.

    Examples
    --------
    >>> executor_asked(None), executor_asked("processes:8")["workers"]
    ({}, 8)
    """
    if text is None:
        return {}
    kind, _, rest = text.rpartition(":")
    if _KIND in (kind, text):
        if not (rest.isdecimal() and 1 <= int(rest) <= 1024):
            raise InputError("--executor", [f"{text!r} has no number of processes from 1 to 1024; {_ALLOWED}"])
        count = int(rest)
        return {"executor": partial(ProcessPoolExecutor, count, multiprocessing.get_context("spawn")), "workers": count}
    if not kind:
        raise InputError("--executor", [f"{text!r} is not known; {_ALLOWED}"])
    made = imported(text, who="--executor", what=_ALLOWED)
    if not callable(made):
        raise InputError("--executor", [f"{text!r} is no function; allowed is {EXECUTORS}"])
    return {"executor": made}
