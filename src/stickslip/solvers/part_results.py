"""Results of a batch solver for each body, contact and stop of a machine, and the columns computed from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.variables import VARIABLES
from stickslip.models.machine_adapter import MachineAdapter
from stickslip.results.segments import type_of

#: Columns that only machines have that list their parts.
_OF_EACH_BODY = ("body_velocity", "body_displacement")
OF_SEVERAL = (*_OF_EACH_BODY, "slip_max", "slip_min", "hits", "impulse_max", "stop_force_max")
#: Columns about the motion type of a contact.
OF_TYPE = ("motion_type", "pattern", "direction", *(_FRACTIONS := ("margin", "stick_fraction", "forward_fraction", "backward_fraction")))


def _no_stops() -> Array:
    return np.empty((0, 0))


@dataclass(frozen=True, eq=False)
class RawParts:
    """For each case, and each of its bodies, contacts or stops; all but what is said to be otherwise over the last motion period."""

    displacement: Array  # (cases, bodies), over the window of the mean [m]
    v_max: Array  # (cases, bodies)
    v_min: Array
    wide_max: Array  # (cases, bodies), over the window
    wide_min: Array
    slip_max: Array  # (cases, contacts)
    slip_min: Array
    slipped: Array  # (cases, contacts): integral of the slip velocity over `slipped_over` [m]
    slipped_over: Array  # (cases,) [drive periods]
    seg_count: Array  # (cases, contacts)
    seg_time: Array  # (cases, contacts, segments) [s]
    seg_code: Array
    margin_force: Array  # (cases, contacts)
    friction_power: Array | None = None  # (cases, contacts) [W]; None where it is not measured
    hits: Array = field(default_factory=_no_stops)  # (cases, stops): how often they are hit, or begin to be pressed
    impulse_max: Array = field(default_factory=_no_stops)  # (cases, stops) [N s]; NaN of an elastic one
    stop_force_max: Array = field(default_factory=_no_stops)  # (cases, stops) [N]; NaN of one with restitution


#: What solvers that know one body on one contact alone find of these, by name, with one number for each case.
OF_ONE_CONTACT = ("v_max", "v_min", "wide_max", "wide_min", "seg_count", "seg_time", "seg_code", "margin_force")


def parts_of_one(raw: Mapping[str, Any], rest: Any, T: Any) -> RawParts:
    """The parts of cases of one body on one contact, from arrays by the names of `OF_ONE_CONTACT`, displacement and window.

    `rest` is the velocity at which the contact does not slip [m/s], such as that of a belt; `T` the length of a drive period [s].
    """
    of_contact = {name: np.asarray(raw[name])[:, None] for name in OF_ONE_CONTACT}
    displacement, window = np.asarray(raw["displacement"]), np.asarray(raw["window"])
    slipped = displacement - rest * window * T
    highest, lowest = (of_contact[name] - np.reshape(rest, (-1, 1)) for name in ("v_max", "v_min"))
    return RawParts(
        **of_contact, displacement=displacement[:, None], slip_max=highest, slip_min=lowest, slipped=slipped[:, None], slipped_over=window,
    )  # fmt: skip


def per_case(few: Array, values: Array) -> Array:
    """One value for each case, in as many dimensions as others have."""
    return few.reshape(-1, *[1] * (np.ndim(values) - 1))


def columns_of_parts(cases: Any) -> dict[str, Callable[[], Any]]:
    """Functions for the columns with an axis of bodies, contacts or stops, by name; only for parts that the machine has.

    `cases` knows what is of a case as a whole: raw results, T [s], and what is known of them (see `gather`).
    """
    raw: RawParts = cases.raw.parts
    counts = {"body": raw.displacement.shape[1], "contact": raw.seg_count.shape[1], "stop": raw.hits.shape[1]}

    def of_type(name: str) -> Any:
        return cases.types[name]

    columns: dict[str, Callable[[], Any]] = {name: partial(of_type, name) for name in OF_TYPE}
    columns |= {
        "body_velocity": lambda: cases.over_time(raw.displacement),
        "body_displacement": lambda: cases.known(raw.displacement),
        "velocity_max": lambda: cases.extreme(raw.v_max, raw.wide_max, np.maximum),
        "velocity_min": lambda: cases.extreme(raw.v_min, raw.wide_min, np.minimum),
        "slip_max": lambda: cases.known(raw.slip_max),
        "slip_min": lambda: cases.known(raw.slip_min),
        "friction_power": lambda: cases.known(raw.friction_power),
        "impulse_max": lambda: cases.known(raw.impulse_max),
        "stop_force_max": lambda: cases.known(raw.stop_force_max),
        "hits": lambda: np.where(cases.good[:, None] & np.isfinite(raw.hits), raw.hits, -1).astype(np.int32),
    }
    if raw.friction_power is None:
        del columns["friction_power"]
    return {name: make for name, make in columns.items() if counts[_dim(name)] > 0}


def types_of(cases: Any) -> dict[str, Any]:
    """The columns about the motion type of each contact. Net motion below a part of the largest slip velocity has no direction."""
    raw: RawParts = cases.raw.parts
    contacts = raw.seg_count.shape[1]

    def of_each(values: Array) -> Array:
        return np.repeat(values, contacts)

    def flat(values: Array) -> Array:
        return values.reshape(-1, *values.shape[2:])

    T, good, highest, lowest = of_each(cases.T), of_each(cases.good), flat(raw.slip_max), flat(raw.slip_min)
    floor = max(1e-12, cases.rtol) * abs(np.maximum(highest, -lowest)) * T * of_each(raw.slipped_over)
    types = type_of(
        flat(raw.seg_count), flat(raw.seg_time) / T[:, None], flat(raw.seg_code), of_each(cases.raw.period), flat(raw.margin_force),
        flat(raw.slipped), cases.dwell, (highest > 0) | (lowest < 0), floor,
    )  # fmt: skip
    types["motion_type"] = types["motion_type"].where(good, "unsolved")
    types |= {name: np.where(good, types[name], np.nan) for name in _FRACTIONS}
    return {name: values.reshape((len(cases.T), contacts)) for name, values in types.items()}


def of_own_parts(columns: dict[str, Callable[[], Any]], machine: MachineAdapter) -> dict[str, Callable[[], Any]]:
    """Functions for the columns of a machine; for one body on one contact, or the principal ones, without their axis."""
    own, without = machine.own, left_out(machine)

    def of_the_own(make: Callable[[], Any], part: int) -> Array:
        return np.asarray(make())[:, part]

    kept = {name: make for name, make in columns.items() if name not in without}
    return {name: partial(of_the_own, make, own[_dim(name)]) if _dim(name) in own else make for name, make in kept.items()}


def left_out(machine: MachineAdapter) -> tuple[str, ...]:
    """Columns that a machine of one body on one contact does not have, or one with a principal body, whose mean velocity says it all."""
    return (_OF_EACH_BODY if machine.own else ()) if machine.names_parts else OF_SEVERAL


def _dim(name: str) -> str:
    return VARIABLES[name].dims[0]


def nothing(bodies: int, contacts: int, stops: int) -> RawParts:
    """Of a case that could not be solved."""
    sizes = {name: bodies for name in ("displacement", "v_max", "v_min", "wide_max", "wide_min")}
    sizes |= dict.fromkeys(("slip_max", "slip_min", "slipped", "friction_power"), contacts)
    sizes |= dict.fromkeys(("hits", "impulse_max", "stop_force_max"), stops)
    segments = {
        "seg_count": np.zeros((1, contacts), int),
        "seg_time": np.zeros((1, contacts, 1)),
        "seg_code": np.zeros((1, contacts, 1), np.int8),
        "margin_force": np.full((1, contacts), np.inf),
    }
    return RawParts(**{name: np.full((1, size), np.nan) for name, size in sizes.items()}, **segments, slipped_over=np.ones(1))
