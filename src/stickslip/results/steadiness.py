"""Whether a run has settled: what its mean velocity approaches, and how far from that it still is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Model, Numeric
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.state_layout import of_one_contact
from stickslip.models.turning_coordinates import TURN, lengths_of
from stickslip.results import recurrence
from stickslip.results.part_notes import APART

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


STEADY, UNSETTLED, IRREGULAR, UNKNOWN = 0, 1, 2, -1
#: What a code of steadiness says.
STEADINESS: dict[int, str] = {
    STEADY: "steady",
    UNSETTLED: "not settled",
    IRREGULAR: "does not repeat",
    UNKNOWN: "not known",
}


_LONGEST_SEARCH = 2000  # drive periods that `periodic_mean_velocity` runs at most, if no others are given
_MOST_SEARCHED = 10**6  # drive periods that are still recommended
_DECAYED = 1e-12  # what is left of a transient that has decayed, relative to what the drive does to a free body in a period
#: A mean velocity below this part of the motion's own velocity is judged against that part: that of a symmetric machine is zero.
_OF_MOTION = 1e-3
_HALF = 0.5 * TURN  # rad: what does not turn as far cannot have turned on
_ALIKE = 0.1  # bodies drift apart if their distance grows evenly, to this part


@dataclass(frozen=True)
class Steadiness:
    """Whether the mean velocity of a run is that of a steady motion.

    Parameters
    ----------
    code : int
        A code of `STEADINESS`: 0 steady, 1 not settled, 2 does not repeat, -1 not known.
    period : int
        Drive periods after which the motion repeats; 0 where it does not, or not yet.
    mean_velocity : float
        Over the window after settling [m/s].
    approached : float
        The mean velocity that it approaches by its last strobe points [m/s]: infinite where no end is in sight, not a number where it
        does not repeat or nothing is known.
    change : float
        By how much the velocity, averaged over a drive period, changed per period at the end of the run [m/s].
    tolerance : float
        How far the mean velocity may be from the approached one, relative to it or, where that is smaller than a thousandth of the
        velocity that the drive gives a body without friction, to this thousandth.
    advice : str
        What to type.

    Examples
    --------
    >>> import stickslip as ss
    >>> ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), periods=60).steadiness.word
    'steady'
    """

    code: int
    period: int
    mean_velocity: float
    approached: float
    change: float = float("nan")
    tolerance: float = recurrence.STEADY
    advice: str = ""

    @property
    def steady(self) -> bool:
        """Whether it is."""
        return self.code == STEADY

    @property
    def word(self) -> str:
        """The code in words."""
        return STEADINESS[self.code]

    @property
    def error(self) -> float:
        """Estimated distance of the mean velocity from its steady value [m/s]."""
        return abs(self.mean_velocity - self.approached)

    @property
    def note(self) -> str:
        """A sentence on what is not steady, and what to type; empty where there is nothing to say."""
        if self.code != UNSETTLED:
            return ""
        if not np.isfinite(self.change):
            return f"the run is too short to say whether the motion has settled; {self.advice}"
        if not np.isfinite(self.approached):
            far = "no steady value is in sight"
        else:
            far = f"it is about {self.error:.2g} m/s from its steady value"
        if self.period:
            return f"the motion repeats, but the mean velocity holds a part of the transient: {far}; {self.advice}"
        change = f"the mean velocity still changes by about {self.change:.2g} m/s in a drive period"
        return f"the motion has not settled: {change}, and {far}; {self.advice}"


def steadiness_codes(mean: ArrayLike, approached: ArrayLike, period: Any, free_velocity: Any, tolerance: Any) -> Any:
    """Codes of steadiness from mean velocities and those that they approach [m/s].

    Examples
    --------
    >>> steadiness_codes([1e-11, 1e-6, 0.1], [0.0, 0.0, 0.1], [1, 1, 1], 1.0, 1e-6).tolist()
    [0, 1, 0]
    """
    mean, approached = np.asarray(mean, float), np.asarray(approached, float)
    with np.errstate(invalid="ignore"):
        within = recurrence.steady(mean, approached, free_velocity, tolerance)  # the rule by which kernels end a run; it is never looser
        steady = (np.asarray(period) > 0) & (within | (abs(mean - approached) <= tolerance * _OF_MOTION * free_velocity))
    lasting = np.where(np.isnan(approached), IRREGULAR, UNSETTLED)
    return np.where(np.isfinite(mean), np.where(steady, STEADY, lasting), UNKNOWN).astype(np.int8)


def strobe_tolerance(method: str, rtol: float) -> float:
    """How close strobe points must come to count as one, in their scales: 30 rtol, at most 1e-3; for exact arcs 1e-8.

    Examples
    --------
    >>> strobe_tolerance("exact", 1e-4), strobe_tolerance("radau", 1e-4), round(strobe_tolerance("Rodas5P", 1e-6), 9)
    (1e-08, 0.001, 3e-05)
    """
    return 1e-8 if method == "exact" else min(30 * float(rtol), 1e-3)


def mean_tolerance(method: str, rtol: float) -> float:
    """The relative error allowed in a mean velocity that counts as steady: 1e-6, or the tolerance of the run."""
    return recurrence.STEADY if method == "exact" else max(recurrence.STEADY, float(rtol))


def outcome_of(model: Model, x: Array, v: Array, z: Array, method: str, rtol: float) -> tuple[Any, int, float]:
    """Way of the machine at the strobe points; after how many periods they repeat (0: not); the displacement per period approached [m].

    `x` and `v` are (periods + 1, bodies), `z` (periods + 1, contacts and controllers, states), NaN where one has fewer states than others.
    The start counts for nothing but the way: it is on no motion. See `recurrence.outcome`.
    """
    way, strobe, scales = _strobe_of(model, x, v, z)
    return way, *_outcome(strobe, scales, strobe_tolerance(method, rtol))


def repetition_of(run: Trajectory) -> tuple[Any, int, float]:
    """The same of a run with axes for its parts."""
    return outcome_of(run.model, run.strobe_x, run.strobe_v, run._strobe_inner, run.method, run.rtol)


def _outcome(strobe: ArrayLike, scales: Any, tolerance: float) -> tuple[int, float]:
    points = np.ascontiguousarray(strobe, float)[1:]
    last = len(points) - 1
    if last < 0:
        return 0, float("inf")
    count = min(last, recurrence.KEPT - 1)
    return recurrence.outcome(points, last, count, recurrence.LONGEST, scales, tolerance, tolerance)


def unsettled_note(codes: ArrayLike, errors: ArrayLike) -> list[str]:
    """A sentence on the cases of a batch or a sweep that have not settled, and what to type; none where there are none.

    Examples
    --------
    >>> unsettled_note([0, 1, 1], [1e-9, 2e-3, np.inf])[0][:64]
    '2 cases have not settled: their mean velocity is up to 0.002 m/s'
    """
    late = np.asarray(codes) == UNSETTLED
    number = int(late.sum())
    if not number:
        return []
    far = np.asarray(errors, float)[late]
    known = far[np.isfinite(far)]
    by = f"up to {known.max():.2g} m/s from its steady value" if len(known) else "not known to be near a steady value"
    who = "1 case has not settled: its" if number == 1 else f"{number} cases have not settled: their"
    endless = f" ({number - len(known)} of them without an end in sight)" if 0 < len(known) < number else ""
    return [f"{who} mean velocity is {by}{endless}, see steadiness and settling_error; type more periods"]


def is_steady(model: Model, row: dict[str, Any], method: str, rtol: float) -> bool:
    """Whether the displacement over a window is that of a steady motion: of the row of a case that repeats."""
    T = float(model.period)
    mean, approached = row["displacement"] / (row["window"] * T), row["limit"] / T
    return bool(steadiness_codes(mean, approached, row["period"], machine_of(model).free_velocity, mean_tolerance(method, rtol)) == STEADY)


def window_count(done: int, settle: int, period: int) -> int:
    """Drive periods in the window of the mean, of so many done: whole motion periods where a period is known."""
    count = max(done - settle, min(1, done))
    return count - count % (period or 1) if count > (period or 1) else count


def of_its_machine(what: str, run: Any) -> None:
    """`InputError` for a run whose columns are not those of the bodies of its machine."""
    if len(run.pieces.layout.bodies) != len(machine_of(run.model).mechanics.bodies):
        of_one_contact(what, run, f"a {type(run.model).__name__} has")


def steadiness_of_run(run: Trajectory) -> Steadiness:
    """The steadiness of a trajectory."""
    of_its_machine("run.steadiness", run)
    run = run.with_axes
    if run.model.period is None:
        first, last = run.window
        x = way_of_machine(run.model, run.at(np.array([first, last]))["x"])
        return Steadiness(UNKNOWN, 0, float((x[1] - x[0]) / (last - first)), float("nan"))
    t, T = run.strobe_times, run.period_time
    tolerance, known = mean_tolerance(run.method, run.rtol), run.known_period
    x, period, limit = (way_of_machine(run.model, run.strobe_x), int(known), float("nan")) if known else repetition_of(run)
    count = window_count(len(x) - 1, int(run.settle), period)
    mean = float((x[-1] - x[-1 - count]) / (t[-1] - t[-1 - count])) if count else float("nan")
    if known:
        return Steadiness(STEADY, period, mean, mean)
    code = int(steadiness_codes(mean, limit / T, period, machine_of(run.model).free_velocity, tolerance))
    return Steadiness(code, period, mean, limit / T, _change(x, T), tolerance, _advice(run.model, x, int(run.settle), period, limit))


def _strobe_of(model: Model, x: Array, v: Array, z: Array) -> tuple[Any, Any, Any]:
    """Way of the machine; strobe points (periods + 1, 1 + what must repeat) that begin with it; the scales of all but the first.

    Sizes are of velocities what the drive does to a body without friction, of inner states the law's scale or the largest value, and of
    positions, where motions depend on them, a period at such a velocity.
    """
    machine = machine_of(model)
    mechanics, speed = machine.mechanics, float(machine.free_velocity)
    way = way_of_machine(model, x)
    again = _coming_again(machine, x)
    turned = sorted(again)
    if mechanics.joined:
        apart: Any = x[:, [*turned, *(j for j in _that_matter(mechanics, x) if j not in again)]]
    else:
        rest = [j for j in range(x.shape[1]) if j not in again]
        whole = [x[:, rest[:1]] if turned else way] if _place_matters(mechanics, x, rest) else []
        apart = np.column_stack([x[:, turned], x[:, rest[1:]] - x[:, rest[:1]], *whole])
    inner = z.reshape(len(x), -1)
    there = ~np.isnan(inner[0])
    sizes = [_sizes(law, load, z.shape[2]) for law, load in zip(mechanics.laws, mechanics.loads(0.0, mechanics.start), strict=True)]
    parts = mechanics.controllers
    for part in parts.parts.values():
        own = [float(size) for size in part.scales]
        sizes.append(np.array([*own, *([np.nan] * (z.shape[2] - len(own)))]))
    typical = np.concatenate(sizes)[there] if sizes else np.empty(0)
    typical = np.where(np.isfinite(typical), typical, abs(inner[:, there]).max(axis=0, initial=0.0))
    strobe = np.column_stack([way, v, inner[:, there], apart])
    size = speed * float(model.period) / (2 * np.pi)
    scales = np.concatenate([np.full(v.shape[1], speed), typical, np.full(apart.shape[1], size)])
    lengths = np.full(len(scales), np.inf)
    first = len(scales) - apart.shape[1]
    lengths[first : first + len(turned)] = [again[j] for j in turned]
    return way, strobe, recurrence.scales_of(np.where(scales > 0, scales, 1.0), lengths)


def _coming_again(machine: MachineAdapter, x: Array) -> dict[int, float]:
    """The coordinates that came by a length after which everything comes again, by number: a turn, or a wave of a track."""
    if x.shape[1] != machine.mechanics.coordinates:  # bodies at prescribed distances share one
        return {}
    far = np.flatnonzero(np.ptp(x, axis=0) > _HALF if machine.wavelength is None else np.ones(x.shape[1], bool)).tolist()
    lengths = lengths_of(machine, far) if far else ()
    return {j: length for j, length in enumerate(lengths) if np.isfinite(length)}


def drifting_apart(run: Trajectory) -> str:
    """A sentence on bodies that drift apart, whose distance grew as much in the last quarter of a run as in the one before; or ""."""
    if run.model.period is None or len(run.body_columns) < 2 or machine_of(run.model).mechanics.joined:
        return ""
    x, names = run.strobe_x, list(run.body_columns)
    quarter = (len(x) - 1) // 4
    if quarter < 4:
        return ""
    grown = [x[-1 - k * quarter] - x[-1 - (k + 1) * quarter] for k in (0, 1)]
    speeds = grown[0] / (quarter * float(run.model.period))
    last, before = (np.ptp(each) for each in grown)
    if not (np.ptp(speeds) > APART * float(machine_of(run.model).free_velocity) and abs(last - before) < _ALIKE * last):
        return ""
    fast, slow = names[int(np.argmax(speeds))], names[int(np.argmin(speeds))]
    sentence = f"{fast} and {slow} drift apart, by {np.ptp(speeds):.3g} m/s: the mean velocity is that of the centre of mass"
    return f"{sentence}; type ss.mean_velocity(run, body={fast!r})"


def _sizes(law: Any, load: Numeric, states: int) -> Any:
    """Typical sizes of a law's inner states, NaN where it does not say; as many as the law with the most has."""
    typical = law.scale(load)
    own = [np.nan] * law.states if typical is None else [float(size) for size in typical]
    return np.array([*own, *([np.nan] * (states - law.states))])


def way_of_machine(model: Model, x: Numeric) -> Any:
    """Position of the principal body, or of the centre of mass where there is none, from those of the bodies (..., bodies) [m]."""
    mechanics = machine_of(model).mechanics
    q = np.stack(mechanics.coordinates_of(tuple(np.moveaxis(np.asarray(x), -1, 0))), axis=-1)
    return q @ np.array([float(share) for share in mechanics.shares])


def _that_matter(mechanics: Any, x: Array) -> list[int]:
    """Coordinates of a machine's own on which something depends: not those along which it just goes on."""
    gone = np.ptp(x, axis=0)
    return [j for j in range(mechanics.coordinates) if _differs(mechanics, x[-1], np.where(np.arange(len(gone)) == j, gone, 0.0))]


def _place_matters(mechanics: Any, x: Array, bodies: list[int]) -> bool:
    """Whether forces or loads change when these bodies are moved together as far as they went."""
    if not bodies or not mechanics.knows_place:
        return False
    far = np.zeros(mechanics.coordinates)
    far[bodies if len(bodies) < x.shape[1] else slice(None)] = float(np.ptp(x[:, bodies]))
    return _differs(mechanics, x[-1], far)


def _differs(mechanics: Any, x: Array, far: Array) -> bool:
    """Whether forces, loads or heights are others where coordinates are moved by so much, or by a part of it."""
    still, none = (0.0,) * mechanics.coordinates, (0.0,) * len(mechanics.contacts)
    q, T = mechanics.coordinates_of(x), float(mechanics.period)
    for part in (1.0, 0.37):
        for t in np.linspace(0.0, T, 8, endpoint=False):
            here, there = (
                np.array(
                    [
                        *mechanics.accelerations(t, at, still, none), *mechanics.loads(t, at), *mechanics.control_answers(t, at, still),
                        *(height for height, _ in mechanics.heights(t, at, still).values()),
                    ],
                    float,
                )
                for at in (q, tuple(value + part * by for value, by in zip(q, far, strict=True)))
            )  # fmt: skip
            if np.any(abs(here - there) > 1e-6 * np.max(abs(here), initial=0.0)):
                return True
    return False


def _change(x: Array, T: float) -> float:
    """Change of the velocity per drive period at the end, averaged over two periods each time [m/s]."""
    return float(abs(x[-1] - 2 * x[-3] + x[-5]) / (4 * T)) if len(x) > 4 else float("nan")


def _advice(model: Model, way: Any, settle: int, period: int, limit: float) -> str:
    """What to type for a steady mean, from the way at the strobe points and the displacement per period that it approaches [m].

    The steady motion itself is recommended only where the transient decays, with as many periods as it needs for that.
    """
    periods, word = len(way) - 1, "robot" if machine_of(model).drive is not None else type(model).__name__.lower()
    needed = _periods_needed(way, period, limit, float(machine_of(model).free_velocity) * float(model.period))
    if needed is None:
        itself = ""
    else:
        longer = f", periods={needed}" if needed > _LONGEST_SEARCH else ""
        itself = f", or ss.analysis.periodic_mean_velocity({word}{longer}) for the steady motion itself"
    if period and settle < periods - 2 * period:
        return f"type settle={periods - 2 * period}{itself}"
    return f"type more periods, such as periods={10 * periods}{itself}"


def _periods_needed(way: Any, period: int, limit: float, size: float) -> int | None:
    """Drive periods until a geometric transient has decayed, with a margin of two; None where it does not decay or takes too long."""
    window = (len(way) - 1) // 3
    window -= window % (period or 2)
    if window < 2 or not np.isfinite(limit):
        return None
    earlier, later = (abs((way[-1 - k * window] - way[-1 - (k + 1) * window]) / window - limit) for k in (1, 0))
    if not later < 0.9 * earlier:
        return None if later > _DECAYED * size else len(way) - 1
    decades = np.log(max(later / (_DECAYED * size), 1.0)) / np.log(earlier / max(later, 1e-300))
    needed = 2 * (len(way) - 1 + window * float(decades))
    return int(np.ceil(needed / 1000) * 1000) if needed < _MOST_SEARCHED else None
