"""Where a sweep is computed, and where its results go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from stickslip.basics.errors import Problems
from stickslip.studies.progress import Progress


@dataclass(frozen=True, eq=False)
class Execution:
    """The arguments of `sweep` that do not change its results; the docstring there says what they are.

    Examples
    --------
    >>> Execution(workers=2, tile=64).differing()
    ['workers', 'tile']
    """

    workers: int = 1
    out: str | Path | None = None
    resume: bool = False
    shard: tuple[int, int] | str | None = None
    tile: int | None = None
    client: Any = None
    retries: int = 3
    progress: Callable[[Progress], Any] | bool | None = None

    def check(self) -> None:
        """`InputError` for what does not go together."""
        problems = Problems("sweep")
        problems.whole("workers", self.workers, 1, example=2)
        if self.out is None and (self.resume or self.shard):
            problems.add("resume and shard are for a study folder; give one with out=, such as out='study'")
        problems.check()

    def differing(self) -> list[str]:
        """Names of those that are not the default."""
        given = {each.name: (getattr(self, each.name), each.default) for each in fields(self)}
        return [name for name, (value, usual) in given.items() if not (value is usual or (type(value) is type(usual) and value == usual))]
