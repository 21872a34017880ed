"""Fewer cases than a full product, where one factor has nothing to do with the other."""

from itertools import cycle, islice


def each_once(*factors):
    """Rows in which every value of every factor stands at least once, shifted so that like does not always meet like."""
    longest = max(len(factor) for factor in factors)
    return list(zip(*(islice(cycle(list(factor)), shift, shift + longest) for shift, factor in enumerate(factors)), strict=True))
