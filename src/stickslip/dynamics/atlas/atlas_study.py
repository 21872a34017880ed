"""The study folder of an atlas: its definition, its grid points and the curves followed; every file is written atomically."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.jsontext import as_plain
from stickslip.dynamics.atlas.borders_followed import Border, BordersOfBranch, FollowedBranch, PointOfBorder
from stickslip.dynamics.atlas.motions_on_the_grid import Look, MotionThere, PointOfGrid
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane
from stickslip.studies.folder import COMMAND, MANIFEST, check_new, make_study_folder, put_file
from stickslip.studies.manifest import differences, digest, identity, unchecked
from stickslip.studies.model_identity import ModelIdentities
from stickslip.studies.planning import SOLVER, Plan, planned

T = TypeVar("T")
_FORMAT = 4  # 4 has the identities of the models with each result
_ANEW = "delete it, and it is computed again"
_DRAWN = "others at each point, at four scales"  # how starts are drawn: those of earlier versions were others


class AtlasStudy:
    """A folder that is being worked on; without a path nothing is kept.

    Parameters
    ----------
    path : path, optional
        The folder.
    plane : Plane
    look : Look
    resume : bool
        Whether to go on with what is there.
    """

    def __init__(self, path: str | Path | None, plane: Plane, look: Look, resume: bool = False):
        self.folder = None if path is None else Path(path).expanduser()
        self._planes = [plane]
        if self.folder is not None:
            plan = _plan_of(plane, look)
            if plan.own:
                why = "out is not known of a flow, whose functions no file holds"
                raise InputError("atlas", [f"{why}; leave it out: the atlas is kept in memory"])
            self._models = ModelIdentities(plan, 1)
            self._begin(self.folder, _identity(plan, self._models, plane, look), resume)

    def _begin(self, folder: Path, mine: dict[str, str], resume: bool) -> None:
        manifest = folder / MANIFEST
        if manifest.exists():
            theirs = _read(manifest, dict)
            if theirs.get("content") != "atlas":
                raise InputError("atlas", [f"{str(folder)!r} is the folder of a sweep; give another folder"])
            if theirs.get("stickslip_format") != _FORMAT:
                why = "which did not record the models of each result"
                raise InputError("atlas", [f"{str(folder)!r} was begun by an earlier stickslip, {why}; give another folder"])
            if differing := differences(mine, theirs.get("identity", {})):
                raise InputError("atlas", [f"{str(folder)!r} is the folder of another atlas: {reason}" for reason in differing])
            if not resume:
                already = f"{str(folder)!r} holds results of this atlas already"
                raise InputError("atlas", [f"{already}; type resume=True (--resume) to go on, or give another folder"])
            return
        check_new("atlas", folder, (COMMAND,), "the folder of an atlas")
        make_study_folder(folder)
        made = {"stickslip_format": _FORMAT, "content": "atlas", "study": digest(mine), "identity": mine, "unchecked": self.unchecked}
        put_file(manifest, json.dumps(made, indent=1, ensure_ascii=False).encode())

    @property
    def unchecked(self) -> list[str]:
        """What is not compared when the atlas is resumed, in sentences."""
        return [] if self.folder is None else unchecked(self._models)

    # ---- the grid ----
    def keep_points(self, first: int, points: dict[Cell, PointOfGrid], level: int = 0) -> None:
        """Keep a part of the grid, or of one of its finer levels."""
        self._keep(f"points-{level}-{first:06d}.json", _rows_of(points), self._places_of_rows(level))

    def points(self, level: int = 0) -> dict[Cell, PointOfGrid]:
        """The points of the grid, or of one of its finer levels, that are there."""
        kept = self._all(f"points-{level}-*.json", _points_of, self._places_of_rows(level))
        return {cell: point for points in kept for cell, point in points.items()}

    def keep_grid(self, grid: dict[Cell, PointOfGrid], missed: int, level: int = 0, asked: Iterable[Cell] = ()) -> None:
        """Keep a whole level after motions were taken over from neighbours, with the points that were asked for."""
        value = {"missed": missed, "asked": sorted(asked), "points": _rows_of(grid)}
        self._keep(f"grid-{level}.json", value, lambda kept: self._places_of_rows(level)(kept["points"]))

    def grid(self, level: int = 0, asked: Iterable[Cell] = ()) -> tuple[dict[Cell, PointOfGrid], int] | None:
        """The whole level, if it is there and the same points were asked for."""
        kept = next(self._all(f"grid-{level}.json", _level_of, lambda kept: self._places_of_rows(level)(kept["points"])), None)
        return kept[:2] if kept and kept[2] == sorted(asked) else None

    def _places_of_rows(self, level: int) -> Callable[[Any], list[Any]]:
        """The function that gives the two numbers at the points of a level as they stand in a file."""
        while len(self._planes) <= level:
            self._planes.append(self._planes[-1].halved)
        return lambda rows: [self._planes[level].point((int(row["cell"][0]), int(row["cell"][1]))) for row in rows]

    # ---- what was followed ----
    def keep_outcome(self, name: str, outcome: BordersOfBranch) -> None:
        """Keep what came of a motion that was followed."""
        self._keep(f"followed-{name}.json", asdict(outcome), self._places_of_outcome)

    def outcome(self, name: str) -> BordersOfBranch | None:
        """The same, if it is there."""
        return next(self._all(f"followed-{name}.json", _outcome_of, self._places_of_outcome), None)

    def _places_of_outcome(self, kept: Any) -> list[Any]:
        """The two numbers at the points of the branch and of the borders in a file, in their order."""
        branch, names = kept["branch"], self._planes[0].names
        along = [] if branch is None else [(value, branch["other"]) for value in branch["values"]]
        along = [pair if branch["parameter"] == names[0] else pair[::-1] for pair in along]
        borders = [pair for border in kept["borders"] for pair in border["values"]]
        return [*along, *borders, *(point["values"] for point in kept["points"])]

    # ---- files ----
    def _keep(self, name: str, value: Any, places: Callable[[Any], list[Any]]) -> None:
        if self.folder is not None:
            value = as_plain(value)
            kept = {"models": self._models_at(places(value)), "result": value}
            put_file(self.folder / name, json.dumps(kept, ensure_ascii=False).encode())

    def _all(self, names: str, made: Callable[[Any], T], places: Callable[[Any], list[Any]]) -> Iterator[T]:
        """The values read from all files with such a name, in the order of the names; their models must be those of today."""
        if self.folder is not None:
            for path in sorted(self.folder.glob(names)):
                value, models, where = _read(path, lambda kept: (made(kept["result"]), kept["models"], places(kept["result"])))
                if models != self._models_at(where):
                    what = f"{str(path)!r} holds results of other models: the robot has other numbers or another kind there"
                    raise InputError("atlas", [f"{what}; give another folder"])
                yield value

    def _models_at(self, places: list[Any]) -> str:
        """The identity of the models at some points of the plane."""
        return self._models.of_places(dict(zip(self._planes[0].names, np.array(places, float).reshape(-1, 2).T, strict=True)))


def _read(path: Path, made: Callable[[Any], T]) -> T:
    try:
        return made(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError) as error:
        raise InputError("atlas", [f"{str(path)!r} cannot be read: {error}; {_ANEW}"]) from None


def _plan_of(plane: Plane, look: Look) -> Plan:
    """The sweep over the points of the grid."""
    axes = {name: axis.tolist() for name, axis in zip(plane.names, plane.axes, strict=True)}
    # returns of a machine without a period take times that are their own
    length = {"duration": float(look.settle)} if plane.sample.period is None else {"periods": look.settle}
    options = {**SOLVER, **length, "rtol": look.rtol}
    return planned(plane.family.make, (), {**plane.family.fixed, **axes}, None, None, None, **options)


def _identity(plan: Plan, models: ModelIdentities, plane: Plane, look: Look) -> dict[str, str]:
    """The identity of an atlas, which all of its results share: that of a sweep over the plane, the starts, and how far they go."""
    sweep = identity(plan, 1, models.of_tiles(range(plan.tiles)))
    return {
        **sweep,
        "starts": json.dumps([_DRAWN, as_plain(plane.starts)]),
        **({} if plane.asked == (None, 1) else {"section": json.dumps([as_plain(plane.asked[0]), plane.asked[1]])}),
        "limit": f"{look.limit} drive periods for what has not settled",
    }


def _level_of(stored: dict[str, Any]) -> tuple[dict[Cell, PointOfGrid], int, list[Cell]]:
    return _points_of(stored["points"]), int(stored["missed"]), [(int(i), int(j)) for i, j in stored["asked"]]


def _rows_of(points: dict[Cell, PointOfGrid]) -> list[dict[str, Any]]:
    return [{"cell": cell, **asdict(point)} for cell, point in points.items()]


def _points_of(rows: list[dict[str, Any]]) -> dict[Cell, PointOfGrid]:
    return {(int(row["cell"][0]), int(row["cell"][1])): _point_of(row) for row in rows}


def _point_of(row: dict[str, Any]) -> PointOfGrid:
    motions = tuple(MotionThere(**_frozen(m)) for m in row["motions"])
    return PointOfGrid(motions, int(row["lost"]), str(row["refused"]), int(row["more"]), int(row["unsettled"]))


def _outcome_of(stored: dict[str, Any]) -> BordersOfBranch:
    branch, points = stored["branch"], tuple(PointOfBorder(**_frozen(row)) for row in stored["points"])
    borders = [_frozen(row) | {"special": tuple(PointOfBorder(**_frozen(each)) for each in row["special"])} for row in stored["borders"]]
    return BordersOfBranch(
        branch and FollowedBranch(**_frozen(branch)), points, tuple(Border(**row) for row in borders), tuple(stored["refused"])
    )


def _frozen(value: Any) -> Any:
    """The contents of a file, with lists as tuples."""
    if isinstance(value, dict):
        return {name: _frozen(part) for name, part in value.items()}
    return tuple(map(_frozen, value)) if isinstance(value, list) else value
