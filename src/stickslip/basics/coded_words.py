"""Columns of words as codes and a table, because text for every contact of a million machines would take gigabytes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class CodedWords:
    """Words of any shape; `numpy.asarray` gives them as text.

    Parameters
    ----------
    codes : array of int
    table : tuple of str
        The word of each code.

    Examples
    --------
    >>> words = CodedWords(np.array([[0, 1], [1, 1]], np.uint8), ("rest", "II"))
    >>> np.asarray(words).tolist(), words.shape
    ([['rest', 'II'], ['II', 'II']], (2, 2))
    >>> words[0].tolist(), words.where([[True, False], [True, True]], "unsolved")[0].tolist()
    (['rest', 'II'], ['rest', 'unsolved'])
    """

    codes: Any
    table: tuple[str, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the codes."""
        return tuple(self.codes.shape)

    def reshape(self, shape: tuple[int, ...]) -> CodedWords:
        """The same words in another shape."""
        return CodedWords(self.codes.reshape(shape), self.table)

    def where(self, kept: Any, other: str) -> CodedWords:
        """These words where `kept`, and another one elsewhere."""
        table = (*self.table, other)
        return CodedWords(np.where(kept, self.codes, len(self.table)).astype(np.min_scalar_type(len(table))), table)

    def __getitem__(self, index: Any) -> Any:
        return np.asarray(self.table or ("",))[self.codes[index]]

    def joined(self, others: list[CodedWords]) -> CodedWords:
        """These words and others after them, along the first axis."""
        parts = [self, *others]
        table = tuple(dict.fromkeys(word for part in parts for word in part.table))
        codes = np.empty((sum(part.shape[0] for part in parts), *self.shape[1:]), np.min_scalar_type(len(table)))
        first = 0
        for part in parts:
            new = np.array([table.index(word) for word in part.table], codes.dtype)
            codes[first : first + part.shape[0]] = new[part.codes]
            first += part.shape[0]
        return CodedWords(codes, table)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        words = self[...]
        return words if dtype is None else words.astype(dtype)
