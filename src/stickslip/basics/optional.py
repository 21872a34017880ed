"""Optional libraries, imported where they are needed; if one is missing, the error says what to type."""

from __future__ import annotations

import importlib
from typing import Any

from stickslip.basics.errors import InputError


def library(doing: str, name: str, sentence: str) -> Any:
    """The module of an optional library.

    Parameters
    ----------
    doing : str
        The function that needs it, with which the error begins.
    name : str
        The module to import, such as ``dask.distributed``.
    sentence : str
        Text of the error if it is missing: what needs it, and what to type.

    Raises
    ------
    InputError
        With that sentence if it cannot be imported.

    Examples
    --------
    >>> library("export", "json", "it is part of Python").loads("[1]")
    [1]
    >>> library("export", "no_such_module", "Parquet needs it; type pip install no_such_module")
    Traceback (most recent call last):
    stickslip.basics.errors.InputError: export: Parquet needs it; type pip install no_such_module
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(doing, [sentence]) from None
