"""Notices: what a long call says while it works, by the logger ``stickslip`` of Python's `logging`.

Without further ado they are lines on stderr, in a notebook below the cell. ``logging.getLogger("stickslip").setLevel("WARNING")``
silences them, and handlers of that logger, or of the root, have them too.
"""

from __future__ import annotations

import functools
import logging
import sys
from typing import Any


@functools.cache
def logger() -> logging.Logger:
    """The logger, with a handler that prints unless somebody has configured one.

    Examples
    --------
    >>> logger().name, logger().isEnabledFor(logging.INFO)
    ('stickslip', True)
    """
    own = logging.getLogger("stickslip")
    if not own.handlers:
        own.addHandler(_Lines())
    if own.level == logging.NOTSET:
        own.setLevel(logging.INFO)
    return own


def notify(sentence: str) -> None:
    """Hand a sentence to the logger, at level INFO.

    Parameters
    ----------
    sentence : str
        What happens, for a person who waits.
    """
    logger().info(sentence)


class _Lines(logging.Handler):
    """Sentences as lines, where they are not printed by a handler of the root."""

    def emit(self, record: logging.LogRecord) -> None:
        if not any(getattr(handler, "stream", None) in (sys.stderr, sys.stdout) for handler in logging.getLogger().handlers):
            print(record.getMessage(), file=_out(), flush=True)


def _out() -> Any:
    """The stream: stderr, which a notebook shows in red, and therefore not there."""
    return sys.stdout if type(sys.stderr).__module__.startswith("ipykernel") else sys.stderr
