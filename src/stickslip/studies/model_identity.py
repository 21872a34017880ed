"""The identity of the models of a study, tile by tile: what is computed, whoever made it.

The identity of a tile is a hash of the traced equations of its models, of everything else in them that is not a number, and of all numbers
of all of its cases with their initial states. What the engine does not trace, such as laws for plain numbers and flows, is identified by
its code and its data (`stickslip.basics.fingerprints`) and by some of its values; parts that cannot be compared are listed as unchecked.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import cases_of, made_model, numbers_by_name, some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves
from stickslip.basics.fingerprints import Fingerprint, fingerprint
from stickslip.engine.equation_identity import equation_hash
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.observables import by_time_of_computation as parted_observables
from stickslip.solvers.methods import SLOW
from stickslip.solvers.plain.composed_flows import composed
from stickslip.studies.models_of_points import Group, Made, groups_of_points, split_by_tile, starts_at
from stickslip.studies.space import Column, Space

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow
    from stickslip.studies.planning import Plan

MOST = 2**17  # models of a study that are all compared, if they are made one by one
_CHUNK = 2**16  # models that are made together
_SLIPS = (-0.3, -1e-2, -1e-4, 1e-4, 1e-2, 0.3)  # m/s
_LOADS = (0.7, 3.1)  # N
_INSTANTS = (0.0, 0.137, 0.31, 0.55, 0.83)  # of a period


class ModelIdentities:
    """The identities of the tiles of a plan.

    Parameters
    ----------
    plan : Plan
    every : int, optional
        Compare every so-many-th model of a tile; chosen by the plan if it is not given.
    keep : bool
        Keep models that a maker makes one by one when they are identified, for the tile to be solved with them (`made`).
    kinds : dict, optional
        What is known of the equations of models from other tiles of the study, and is noted here.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.studies.planning import SOLVER, planned
    >>> def of_tilt(tilt):
    ...     plan = planned(ss.presets.piezo_rig, (), dict(amplitude=[4e-4, 5e-4], tilt_deg=tilt), None, None, 1, **SOLVER)
    ...     return ModelIdentities(plan).of_tiles([0, 1])
    >>> of_tilt(1.7) == of_tilt(1.7), of_tilt(1.7) == of_tilt(1.8), len(set(of_tilt(1.7)))
    (True, False, 2)
    """

    def __init__(self, plan: Plan, every: int | None = None, keep: bool = False, kinds: dict[str, tuple[str, bool]] | None = None):
        self.plan, self.unchecked = plan, dict[str, None]()
        self._keep, self._kept = keep, dict[int, Made]()
        self.left_out: tuple[int, ...] = ()  # tiles of a folder whose models were not made again
        self._every = every
        self._kinds = {} if kinds is None else kinds

    @cached_property
    def every(self) -> int:
        """All models are compared (1), or every so-many-th one, if there are very many and each is made by a call of its own."""
        if self._every is not None:
            return self._every
        return -(-self.plan.space.cases // MOST) if self.plan.space.cases > MOST and self._one_by_one else 1

    @cached_property
    def _one_by_one(self) -> bool:
        """Whether each model is made by a call of its own."""
        return callable(self.plan.make) and not _takes_arrays(self.plan)

    def of_tiles(self, tiles: Iterable[int]) -> list[str]:
        """The identities of some tiles."""
        identities: list[str] = []
        waiting: dict[int, Array] = {}
        for k in tiles:
            waiting[k] = self.compared(self.plan.points(k).ravel())
            if sum(map(len, waiting.values())) >= _CHUNK:
                identities += self._of_points(waiting)
                waiting = {}
        return identities + (self._of_points(waiting) if waiting else [])

    def made(self, k: int) -> Made:
        """The models of a tile, made now unless they were kept, and the reasons for places without one; what was kept is given once."""
        points = self.plan.points(k)
        return self._kept.pop(k, None) or groups_of_points(self.plan.make, self.plan.space, points, starts_at(self.plan.start, points))

    def keep_only(self, tiles: Iterable[int]) -> None:
        """Let go of kept models of other tiles."""
        mine = set(tiles)
        self._kept = {k: made for k, made in self._kept.items() if k in mine}

    def of_places(self, places: dict[str, Array]) -> str:
        """The identity of the models at other places than those of the plan, which are given by their arguments."""
        count = len(next(iter(places.values())))
        columns = {name: Column(("place",), values) for name, values in places.items()}
        groups, _ = groups_of_points(self.plan.make, Space({"place": count}, columns, self.plan.space.fixed, {}), np.arange(count), None)
        return self.of_groups(groups, [count])[0]

    def compared(self, points: Array) -> Array:
        """Those points of a tile whose models are compared; the last one is among them."""
        return points if self.every == 1 else np.append(points[: -1 : self.every], points[-1:])

    def _of_points(self, tiles: dict[int, Array]) -> list[str]:
        """The identities of tiles that are given by their points."""
        points, counts = np.concatenate([*tiles.values()]), [len(points) for points in tiles.values()]
        made = groups_of_points(self.plan.make, self.plan.space, points, starts_at(self.plan.start, points))
        if self._keep and self.every == 1 and self._one_by_one:
            self._kept |= dict(zip(tiles, split_by_tile(made, counts), strict=True))
        return self.of_groups(made[0], counts)

    def of_groups(self, groups: list[Group], counts: list[int]) -> list[str]:
        """The identities of tiles with so many models each, in their order, which are made already; a refused case has no model."""
        ends = np.cumsum([0, *counts])
        parts: list[dict[str, list[tuple[Array, Array]]]] = [{} for _ in counts]
        values: list[list[list[str]]] = [[] for _ in counts]
        for group in groups:
            names, table = _table(group)
            kind, traced = self._kind(group.robot)
            kind = hashlib.sha256(f"{kind} {names}".encode()).hexdigest()
            at = np.asarray(group.at)
            order = np.argsort(at, kind="stable")
            cuts = np.searchsorted(at[order], ends)
            for k in np.flatnonzero(np.diff(cuts)).tolist():
                within = order[cuts[k] : cuts[k + 1]]
                if not traced and kind not in parts[k]:
                    values[k].append(self._checked_values(some_of(group.robot, within[:1])))
                parts[k].setdefault(kind, []).append((at[within] - ends[k], table[within]))
        return [_digest(tile, f"{count} {plain}") for tile, plain, count in zip(parts, values, counts, strict=True)]

    def _kind(self, model: Model) -> tuple[str, bool]:
        """The identity of everything in a model but its numbers, and whether its equations are traced."""
        numbers = {name for name, _ in leaves(model)}
        others = [(name, value) for name, value in leaves(model, kinds=True) if name not in numbers and name.rpartition(".")[2] != "notes"]
        content = fingerprint(others)
        known = None if content.unchecked else self._kinds.get(content.digest)
        if known is None:
            known = self._kinds[content.digest] = self._identified(model, others, content)
        return known

    def _identified(self, model: Model, others: list[tuple[str, Any]], content: Fingerprint) -> tuple[str, bool]:
        """The same, from the equations if they can be traced."""
        if (traced := self._traced(model)) is not None:
            return f"equations {traced} {fingerprint([(name, value) for name, value in others if _is_data(value)]).digest}", True
        self.unchecked.update(dict.fromkeys(content.unchecked))
        return f"code {content.digest}", False

    def _checked_values(self, model: Model) -> list[str]:
        """Values of the laws and drives of a model that is not traced; none if they differ from call to call."""
        values = _plain_values(model)
        if values == _plain_values(model):
            return values
        self.unchecked["values that differ from call to call"] = None
        return []

    def _traced(self, model: Model) -> str | None:
        observe = () if self.plan.options["method"] in SLOW else tuple(parted_observables(self.plan.options.get("observe"))[0].items())
        try:
            if not all(law.compiles for law in machine_of(model).laws):
                return None
            return equation_hash(model, observe)
        except Exception:  # of a flow, or as functions of the user's own may raise anything; the case then has a status that says so
            return None


def _table(group: Group) -> tuple[tuple[str, ...], Array]:
    """Names of the numbers of a group and of its initial values, and their values: array (cases, names)."""
    columns = {name: np.ravel(value) for name, value in numbers_by_name(group.robot).items()}
    columns |= {f"initial {name}": np.ravel(value) for name, value in _initial(group.robot).items()}
    columns |= {f"start {name}": np.ravel(value) for name, value in group.start.items()}
    names = tuple(sorted(columns))
    table = np.empty((len(group.at), len(names)))
    for i, name in enumerate(names):
        table[:, i] = columns[name]
    return names, table + 0.0  # minus zero is zero


def _initial(model: Model) -> dict[str, Any]:
    """Initial inner states that the laws give, where they can be computed for all models together."""
    try:
        mechanics = machine_of(model).mechanics
        loads = mechanics.loads(0.0, mechanics.start)
        begun = [law.start(load) for law, load in zip(mechanics.laws, loads, strict=True) if law.has_start]
    except Exception:  # of a flow, or of a user's own law, which may refuse anything; it is reported when the case is solved
        return {}
    return {f"{i}.{j}": state for i, states in enumerate(begun) for j, state in enumerate(states)}


def _digest(parts: dict[str, list[tuple[Array, Array]]], more: str) -> str:
    """The identity of a tile: a hash of the kinds of its models, and one of their numbers."""
    kinds, numbers = hashlib.sha256(more.encode()), hashlib.sha256()
    for kind in sorted(parts):
        at = np.concatenate([places for places, _ in parts[kind]])
        table = np.concatenate([rows for _, rows in parts[kind]])
        order = np.argsort(at, kind="stable")
        kinds.update(kind.encode() + np.ascontiguousarray(at[order], "<i8").tobytes())
        numbers.update(np.ascontiguousarray(table[order], "<f8").tobytes())
    return f"{kinds.hexdigest()[:16]}-{numbers.hexdigest()[:32]}"


def _is_data(value: Any) -> bool:
    """Whether a part of a model is plain data, which stands in no equation by itself."""
    if isinstance(value, (tuple, list)):
        return all(map(_is_data, value))
    return isinstance(value, (str, bool, int, float, np.ndarray))


def _takes_arrays(plan: Plan) -> bool:
    """Whether a maker makes many models in one call."""
    columns = plan.space.at(np.arange(min(2, plan.space.cases)))
    words = {name: values[0] for name, values in columns.items() if values.dtype.kind != "f"}
    numbers = {name: values for name, values in columns.items() if name not in words and not name.startswith("start.")}
    try:
        made_model("sweep", plan.make(**{**plan.space.fixed, **words, **numbers}))
    except (InputError, TypeError, ValueError):
        return False
    return True


# ---- values of what cannot be traced ----
def _plain_values(model: Any) -> list[str]:
    """Values of a model's laws and drives at some places, to nine digits: they change too if a file or a library that they use does."""
    values: list[str] = []
    try:
        model = cases_of(model)[0]
        if adapter_of(model).numbers_by_case:
            return _values_of_flow(model)
        machine = machine_of(model)
        for law in machine.laws:
            for load in _LOADS:
                values += _values(law.start, load) + ([] if law.dynamic else _values(law.breakaway, load))
                for v in _SLIPS:
                    values += _values(law.rate, v, law.start(load), load) if law.dynamic else _values(law.sliding, v, load)
        for _, drive in machine.inner_masses:
            for part in _INSTANTS:
                values += _values(drive.acceleration, part * float(model.period))
    except Exception:  # of a user's own code, which may refuse anything; it is reported when the case is solved
        return values
    return values


def _values_of_flow(flow: SwitchingFlow) -> list[str]:
    """Values of the functions of a flow that names its states."""
    n = len(flow.states or ())
    y, fields = [0.3 + 0.1 * i for i in range(n + len(flow.inner))], composed(flow).fields
    return [text for mode in fields if n for t in _INSTANTS for text in _values(fields[mode], t, list(y))]


def _values(function: Any, *arguments: Any) -> list[str]:
    return [f"{value:.9e}" for value in np.ravel(np.asarray(function(*arguments), float))]


def model_differences(mine: list[str], theirs: list[str], cases: int) -> list[str]:
    """The differences between the models of two studies with the same tiles, as sentences.

    Examples
    --------
    >>> model_differences(["a-1", "a-2"], ["a-1", "a-3"], 100)
    ['the robot has other numbers or another kind: the numbers of its models differ in 1 of 2 tiles, first in cases 100 to 199']
    """
    others = [k for k, (a, b) in enumerate(zip(mine, theirs, strict=False)) if a != b]
    if not others and len(mine) == len(theirs):
        return []
    if not others:
        return [f"it has {len(theirs)} tiles, now it has {len(mine)}"]
    k = others[0]
    pairs = [(mine[i].partition("-"), theirs[i].partition("-")) for i in others]
    kinds, numbers = (any(a[part] != b[part] for a, b in pairs) for part in (0, 2))
    what = " and ".join(word for word, differs in (("the equations", kinds), ("the numbers", numbers)) if differs)
    where = f"{len(others)} of {len(mine)} tiles, first in cases {k * cases} to {(k + 1) * cases - 1}"
    return [f"the robot has other numbers or another kind: {what} of its models differ in {where}"]
