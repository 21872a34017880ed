"""Libraries that not everybody installs: asked for where they are needed, and missed with a sentence that says what to type."""

from __future__ import annotations

import importlib
from typing import Any

from stickslip.errors import InputError


def library(doing: str, name: str, sentence: str) -> Any:
    """The module of an optional library.

    Parameters
    ----------
    doing : str
        The function that needs it, as errors begin.
    name : str
        What is imported, such as ``dask.distributed``.
    sentence : str
        What is told where it is missing: what needs it, and what to type.

    Raises
    ------
    InputError
        With that sentence where it cannot be imported.

    Examples
    --------
    >>> library("export", "json", "it is part of Python").loads("[1]")
    [1]
    >>> library("export", "no_such_module", "Parquet needs it; type pip install no_such_module")
    Traceback (most recent call last):
    stickslip.errors.InputError: export: Parquet needs it; type pip install no_such_module
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(doing, [sentence]) from None
