"""A drive frequency as a user gives it."""

from __future__ import annotations

from typing import Any

from stickslip.basics.errors import Problems
from stickslip.basics.fields import checked_number, describe, is_array
from stickslip.basics.quantities import between


def given_frequency(frequency: Any, name: str = "frequency") -> float:
    """The drive frequency that was given [Hz]; `InputError` says why a value is none.

    Examples
    --------
    >>> given_frequency(32.7)
    32.7
    """
    problems = Problems("record")
    value = checked_number(name, frequency, problems, between(1e-9, 1e9), "one frequency, 1e-9 to 1e9 Hz", f"{name}=32.7")
    if is_array(value):
        problems.add(f"{name} is {describe(value)}; allowed is one number; type for example {name}=32.7")
    problems.check()
    return float(value)
