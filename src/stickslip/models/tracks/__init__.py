"""Tracks: level, inclined, with friction that varies in time or along the way.

`tracks` has what is common to them: `fold` and `folded_tilt` make one incline of several angles, `grip_of` is the factor of the friction.
"""

from stickslip.basics.lazy_names import listing
from stickslip.models.tracks.profiles import FrictionPatches, FrictionProfile, FrictionWave
from stickslip.models.tracks.tracks import TRACKS, Incline, Level, VaryingFriction, fold

__all__ = ["TRACKS", "FrictionPatches", "FrictionProfile", "FrictionWave", "Incline", "Level", "VaryingFriction", "fold"]
__dir__ = listing(__all__)
