"""Where a sweep is computed, and where its results go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from stickslip.basics.errors import Problems
from stickslip.basics.executors import Workers
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
    executor: Any = None

    def check(self) -> None:
        """`InputError` for what does not go together."""
        problems = Problems("sweep")
        Workers(self.workers, self.executor, self.retries).note(problems)
        if self.client is not None and self.executor is not None:
            problems.add("client is Dask's, and executor any other; give one of them")
        if self.out is None and (self.resume or self.shard):
            problems.add("resume and shard are for a study folder; give one with out=, such as out='study'")
        problems.check()

    def crew(self) -> Workers:
        """Where the tiles are computed."""
        if self.client is None:
            return Workers(self.workers, self.executor, self.retries)
        from stickslip.studies.cluster import workers_of

        return workers_of(self.client, self.workers, self.retries)

    def checked_crew(self) -> Workers:
        """The same, after `check`."""
        self.check()
        return self.crew()

    def differing(self) -> list[str]:
        """Names of those that are not the default."""
        given = {each.name: (getattr(self, each.name), each.default) for each in fields(self)}
        return [name for name, (value, usual) in given.items() if not (value is usual or (type(value) is type(usual) and value == usual))]
