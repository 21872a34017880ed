"""The public names of `stickslip.results`: read by type checkers, and by `__init__.py`, which loads each when it is first used."""

from .trajectory import Trajectory as Trajectory
