"""What a rival is: a name, a ladder of settings, a function that runs one rung."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from problem import Problem

#: (mean velocities [m/s], CPU seconds); compiling is not counted
Outcome = tuple[np.ndarray, float]


@dataclass(frozen=True)
class Rival:
    """One row of the table."""

    name: str
    pip: str
    settings: tuple[Any, ...]  # from loose to tight: its work-precision curve
    run: Callable[[Problem, Any], Outcome]
    module: str = "numpy"  # what must be importable
    cases: int = 512  # at most so many of the 512, evenly spread
    cases_stiff: int = 0  # the same at mu0 = 0.03, 0: as `cases`
    settings_stiff: tuple[Any, ...] = ()  # if other settings are best there
    skip_stiff: str = ""  # why it is not run at mu0 = 0.03
    alone: bool = False  # takes part in "one case alone"

    def available(self) -> str | None:
        """None if it can run, else the reason it cannot, with what to type."""
        try:
            importlib.import_module(self.module)
        except ImportError:
            return f"not installed: pip install {self.pip}"
        except OSError as error:  # a compiled part that does not load
            return f"installed, but does not load ({error}): pip install --force-reinstall {self.pip}"
        return None

    def ladder(self, stiff: bool) -> tuple[Any, ...]:
        """The settings for this problem."""
        return self.settings_stiff if stiff and self.settings_stiff else self.settings

    def most_cases(self, stiff: bool) -> int:
        """How many of the 512 cases it is given."""
        return self.cases_stiff if stiff and self.cases_stiff else self.cases
