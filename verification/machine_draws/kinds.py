"""The kinds of random machines: which sorts there are, how often each is drawn, and with which laws."""

from __future__ import annotations

from typing import Any

import numpy as np

from machine_draws.capsules import capsule
from machine_draws.chains import chain
from machine_draws.drawing import LAWS, Kind, asks
from machine_draws.gaits import worm
from machine_draws.joints import joint
from machine_draws.robots import robot
from machine_draws.rows import row
from machine_draws.tracks import conveyor, stage

#: What draws a machine of each sort from the name of a law, and how many kinds of 250 it makes.
SORTS: dict[str, tuple[Any, int]] = {
    "chain": (chain, 50), "worm": (worm, 35), "row": (row, 40), "capsule": (capsule, 40), "stage": (stage, 20),
    "conveyor": (conveyor, 30), "joint": (joint, 20), "robot": (robot, 15),
}  # fmt: skip


def kinds(count: int, seed: int) -> list[Kind]:
    """So many kinds, all sorts in turn, each with all laws as often as any other to within one."""
    rng = np.random.default_rng(seed)
    decks = {sort: [str(law) for _ in range(count // len(_laws(sort)) + 1) for law in rng.permutation(_laws(sort))] for sort in SORTS}
    places = sorted(((i + 0.5) / often, sort) for sort, (_, often) in SORTS.items() for i in range(count))
    return [Kind(sort, decks[sort].pop(), number) for number, (_, sort) in enumerate(places[:count])]


def _laws(sort: str) -> list[str]:
    """The laws that a sort takes: those of feet know nothing of one another."""
    return [law for law in LAWS if sort != "worm" or not asks(law)]
