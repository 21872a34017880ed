"""Runs: trajectories, their dense output, segments and events, steadiness, and their files."""

from stickslip.basics.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__, renamed={"flowrun": "ss.Trajectory, of flows as of machines"})
