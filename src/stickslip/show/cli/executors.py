"""``--executor``: where a long command computes, besides the threads of ``workers=``."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import EXECUTORS, process_count
from stickslip.basics.errors import InputError
from stickslip.show.cli.study_files import imported

_ALLOWED = "allowed is processes:N, or module:function (file.py:function) that makes an executor; type for example --executor processes:8"


def executor_asked(text: str | None) -> dict[str, Any]:
    """The argument `executor` of a long call from the text of ``--executor``; none without it.

    ``processes:8`` are eight processes of this computer, of which each is begun again if it is killed; ``module:function`` is called for an
    executor.

    Examples
    --------
    >>> executor_asked(None), executor_asked("processes:8")
    ({}, {'executor': 'processes:8'})
    """
    if text is None:
        return {}
    if process_count(text) is not None:
        return {"executor": text}
    kind = text.rpartition(":")[0]
    if text.partition(":")[0] == "processes":
        raise InputError("--executor", [f"{text!r} has no number of processes from 1 to 1024; {_ALLOWED}"])
    if not kind:
        raise InputError("--executor", [f"{text!r} is not known; {_ALLOWED}"])
    made = imported(text, who="--executor", what=_ALLOWED)
    if not callable(made):
        raise InputError("--executor", [f"{text!r} is no function; allowed is {EXECUTORS}"])
    return {"executor": made}
