"""How a case ended: one number and one sentence for it, the same in kernels, in solvers, in files and on the screen."""

from __future__ import annotations

from enum import IntEnum
from typing import Any


class Status(IntEnum):
    """How a case ended; it was solved where the number is at most `Status.REPEATS`.

    Numbers from 100 on are of a sweep. They stand in files, so a number once given is never given another meaning.

    Examples
    --------
    >>> Status(6).sentence, Status.LOST == 6, f"{Status.LOST}"
    ('contact lost: the load fell to zero', True, '6')
    """

    sentence: str

    def __new__(cls, number: int, sentence: str) -> Status:
        """A member is its number."""
        member = int.__new__(cls, number)
        member._value_ = number
        member.sentence = sentence
        return member

    FINISHED = 0, "finished"
    REPEATS = 1, "stopped: the strobe point repeats"
    BUDGET = 2, "step budget used up"
    TOO_SMALL = 3, "step size too small"
    NOT_A_NUMBER = 4, "not a number"
    BAD_INPUT = 5, "bad input for this case"
    LOST = 6, "contact lost: the load fell to zero"
    SWITCHES = 8, "as many switches as were allowed"
    CHATTERS = 9, "its switches accumulate: it chatters, or comes to rest in ever shorter jumps"
    RETURNED = 10, "came back to the section"
    UNBRAKED = 11, "the friction of a contact no longer acts against its slip, so that no force that holds it follows"
    PAINLEVE = 12, "friction presses back on its contact so strongly that no load, or more than one, follows from the motion (Painlevé)"
    FAILED = 100, "error in the law or the solver for this case"
    NOT_COMPUTED = 101, "not computed"
    FILLED = 102, "not computed: filled from computed neighbours of one motion type"


#: Where equations end, and a run with them, which keeps what it has come to.
ENDS = frozenset({Status.LOST, Status.PAINLEVE})

#: What a status code says, of all that there are.
STATUS: dict[int, str] = {int(status): status.sentence for status in Status}


INTERRUPTED = "interrupted at t = "


def interrupted_at(t: float) -> str:
    """The status of one run that was interrupted at a time [s].

    Examples
    --------
    >>> interrupted_at(1.5)
    'interrupted at t = 1.5 s'
    """
    return f"{INTERRUPTED}{float(t):.6g} s"


def code_counts(codes: Any, sentences: dict[int, str] = STATUS) -> dict[str, int]:
    """How many there are of each code, by what it says.

    Examples
    --------
    >>> code_counts([0, 6, 0])
    {'finished': 2, 'contact lost: the load fell to zero': 1}
    """
    import numpy as np

    distinct, counts = np.unique(codes, return_counts=True)
    return {sentences.get(code, f"status {code}"): count for code, count in zip(distinct.tolist(), counts.tolist(), strict=True)}
