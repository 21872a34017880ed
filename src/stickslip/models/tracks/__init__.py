"""Tracks: level, inclined or moving friction profiles."""

from stickslip.models.tracks.tracks import (
    TRACKS,
    Incline,
    Level,
    VaryingFriction,
    VaryingInTime,
    fold,
    folded_tilt,
    grip_of,
    law_was_replaced,
    without_its_law,
)

__all__ = [
    "TRACKS",
    "Incline",
    "Level",
    "VaryingFriction",
    "VaryingInTime",
    "fold",
    "folded_tilt",
    "grip_of",
    "law_was_replaced",
    "without_its_law",
]
