"""Limits on unpacking: a file that declares, or hides, far more numbers than it has bytes is refused beforehand."""

from __future__ import annotations

import math
import os

from stickslip.basics.errors import InputError

#: The environment variable that says how many bytes a file may have, and may unpack to.
VARIABLE = "STICKSLIP_LARGEST"
#: Without it: bytes of any file, of what a small file unpacks to, and how often its own size a larger one may unpack to.
_CEILING, _SMALL, _RATIO = 4e9, 1e8, 100.0


def allowed_bytes() -> float | None:
    """The bytes that the environment variable allows; None where it says nothing."""
    text = os.environ.get(VARIABLE, "").strip()
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 1 <= value < math.inf:
        raise InputError("read", [f"{VARIABLE} = {text[:40]!r}; allowed is a number of bytes; set it for example to 8e9"])
    return value


def largest_file() -> float:
    """The bytes that a file may have."""
    return allowed_bytes() or _CEILING


def bytes_in_words(size: float) -> str:
    """A number of bytes in words.

    Examples
    --------
    >>> bytes_in_words(2700), bytes_in_words(6.4e9)
    ('2.7 kB', '6.4 GB')
    """
    for factor, unit in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size:.0f} bytes"


class Allowance:
    """How many bytes of numbers the rest of a file may unpack to.

    Parameters
    ----------
    doing : str
        What is being done, for the error.
    packed : int
        Bytes of the file.

    Examples
    --------
    >>> allowed = Allowance("read", 2700)
    >>> allowed.take(6.4e9, "'v0'")
    Traceback (most recent call last):
    stickslip.basics.errors.InputError: read: 'v0' unpacks a file of 2.7 kB to 6.4 GB; allowed is 100 MB; if the file is to be trusted, set the environment variable STICKSLIP_LARGEST=6.4e+09 (bytes) or more
    """  # noqa: E501

    def __init__(self, doing: str, packed: int):
        self._doing, self._packed = doing, packed
        self.limit = allowed_bytes() or min(_CEILING, max(_SMALL, _RATIO * packed))
        self._taken = 0.0

    def take(self, size: float, what: str) -> None:
        """Count bytes before they are made; `InputError` where they are too many."""
        self._taken += size
        self.check(self._taken, what)

    def check(self, size: float, what: str) -> None:
        """Refuse bytes that are needed for a moment alone, where they are too many."""
        if size > self.limit:
            packed, unpacked, limit = map(bytes_in_words, (self._packed, size, self.limit))
            excess = f"{what} unpacks a file of {packed} to {unpacked}; allowed is {limit}"
            raise InputError(self._doing, [f"{excess}; if the file is to be trusted, {_typed(size)}"])

    def check_file(self) -> None:
        """Refuse a file that is itself too large."""
        if self._packed > (most := largest_file()):
            excess = f"the file has {bytes_in_words(self._packed)}; allowed is {bytes_in_words(most)}"
            raise InputError(self._doing, [f"{excess}; cut it, or {_typed(self._packed)}"])


def _typed(size: float) -> str:
    """A suggested limit for a file of this size, rounded up to two digits."""
    step = 10.0 ** (math.floor(math.log10(size)) - 1)
    return f"set the environment variable {VARIABLE}={math.ceil(size / step) * step:.2g} (bytes) or more"
