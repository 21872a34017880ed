"""Motion types of runs: rest, presliding, types I to IV, or other."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np

from stickslip.analysis.flow_motion import flow_motion
from stickslip.analysis.oscillation import DWELL, SLIP_RATIO, Oscillation, oscillation
from stickslip.analysis.run_segments import Segments, WatchedContact, pieces_within, raw_segments, watched_contacts
from stickslip.analysis.steady import is_run, needs_run, of_a_record, period_number
from stickslip.basics.arguments import described_as, explains_arguments
from stickslip.basics.contracts import Law
from stickslip.basics.errors import InputError
from stickslip.basics.fields import everywhere
from stickslip.basics.notebook_display import Drawn
from stickslip.models.friction import Coulomb
from stickslip.models.friction.law_adapter import adapted, law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.records.motion_type import motion as measured_motion
from stickslip.records.record import Record
from stickslip.results.segments import intervals_of, type_of
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.results.verbs import OfOneRun

_FEW = 4  # contacts whose patterns a printed run names
_FAST, _KINETIC = 1e3, 1e-6  # a speed [m/s] beyond all that fades, and how near friction over load must be to the coefficient there


@described_as("what ss.motion returns; type ss.motion(run)")
@dataclass(frozen=True)
class Motion(Drawn):
    """The motion at the end of a run, judged on its last motion period.

    Parameters
    ----------
    type : str
        "rest"; "presliding" (moves, but never slips); "I" (both directions, two stick intervals), "II" (one direction, one
        stick interval), "III" (both directions, one stick interval), "IV" (never sticks); "other".
    pattern : str
        Signs of the velocity within the motion period in order, starting at a "+" that follows another sign: "+0-0". The pattern of a
        motion that never goes forwards starts at a "-". If several starts are possible, the pattern that sorts first is taken.
    period : int or None
        Drive periods until the motion repeats; None if none was found (then the type is that of the last drive period).
    direction : int
        Sign of the net motion; 0 at rest and in presliding. A mirrored motion has the same type and direction -1.
    margin : float
        Distance from the nearest border between types, 0 on the border: the smaller of the shortest interval in drive periods and the
        relative distance of the applied force from break-away, where that decides the type. Under a dynamic law an elastic interval counts
        as rest if it lasts `dwell`; there the margin is the difference between its length and `dwell`.
    stick_fraction, forward_fraction, backward_fraction : float
        Fractions of the motion period.
    intervals : tuple of (start, length, sign)
        In the order of the pattern, in drive periods; start is counted from the beginning of the motion period, a multiple of the
        drive period.
    slip_ratio, dwell : float or None
        The thresholds that were used; None for a set-valued law, which needs none.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.results.dense_output import HarmonicArcs
    >>> from stickslip.results.trajectory import Trajectory
    >>> robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    >>> at_rest = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77)
    >>> m = ss.motion(Trajectory(robot, at_rest, periods=1, settle=0, rtol=1e-6, method="by hand"))
    >>> m.type, m.pattern, m.direction, m.twin
    ('rest', '0', 0, 'rest')
    """

    type: str
    pattern: str
    period: int | None
    direction: int
    margin: float
    stick_fraction: float
    forward_fraction: float
    backward_fraction: float
    intervals: tuple[tuple[float, float, int], ...]
    slip_ratio: float | None = None
    dwell: float | None = None
    _twin: Callable[[], str | None] | None = field(default=None, repr=False, compare=False)

    _drawn_by, _inches = "pattern", (4.4, 1.0)

    def _facts(self) -> dict[str, Any]:
        return {
            "type": self.type,
            "pattern": self.pattern.replace("-", "−"),
            "repeats after": "not found" if self.period is None else f"{self.period} drive period{'s' * (self.period != 1)}",
            "margin": f"{self.margin:.3g} (0 is the border to another type)",
            "forward, backward, stick": ", ".join(self._parts),
        }

    def __str__(self) -> str:
        return self._text()

    @property
    def brief(self) -> str:
        """The type in a word or two, as a printed run has it."""
        return f"type {self.type}" if self.type in ("I", "II", "III", "IV") else self.type

    @property
    def _parts(self) -> tuple[str, ...]:
        return tuple(f"{100 * part:.1f} %" for part in (self.forward_fraction, self.backward_fraction, self.stick_fraction))

    @cached_property
    def twin(self) -> str | None:
        """Motion type of the same robot with Coulomb friction, with its own break-away (solved on first access); None if it has none."""
        return self.type if self._twin is None else self._twin()


@described_as("what ss.motion returns; type ss.motion(run)")
@dataclass(frozen=True)
class Motions(Drawn):
    """The motion that a machine of several contacts ends in: that of each contact. The machine as a whole has no motion type.

    Parameters
    ----------
    contacts : dict of Motion
        By name; types and patterns are those of the slip velocity of that contact.
    anchored : tuple of str
        Names of the contacts that never move in the window of the mean; those whose laws have inner states never slip there.
    period : int or None
        Drive periods until the motion of the whole machine repeats; None if none was found.
    direction : int
        Sign of the mean velocity of the centre of mass, or of the principal body.
    principal : str, optional
        Name of the contact of the machine's principal body, if it has one: type, pattern and what else a `Motion` has are its own then.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.motion(ss.solve(ss.Chain.example(), periods=60))
    >>> {name: each.pattern for name, each in found.contacts.items()}, found.anchored, found.period
    ({'module 1': '+-', 'module 2': '+0-0'}, (), 1)
    """

    contacts: dict[str, Motion]
    anchored: tuple[str, ...]
    period: int | None
    direction: int
    principal: str | None = None

    _drawn_by, _inches = "pattern", (4.4, 1.6)

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("contact", "pattern", "forward", "backward", "stick")
        return [[head, *((name, m.pattern.replace("-", "−"), *m._parts) for name, m in self.contacts.items())]]

    def __str__(self) -> str:
        return self._text()

    @property
    def brief(self) -> str:
        """The type of the principal body's contact, or the patterns of a few contacts, as a printed run has them."""
        if self.principal is not None:
            return self.contacts[self.principal].brief
        few = len(self.contacts) <= _FEW
        return ", ".join(f"{name} {m.pattern}" for name, m in self.contacts.items()) if few else f"of {len(self.contacts)} contacts"

    def __getattr__(self, name: str) -> Any:
        if name in Motion.__dataclass_fields__ or name == "twin":
            if self.principal is not None:
                return getattr(self.contacts[self.principal], name)
            names = ", ".join(map(repr, self.contacts))
            raise AttributeError(f"a machine of several contacts has no {name} as a whole; type motion.contacts[name].{name}, of {names}")
        raise AttributeError(f"Motions has no {name!r}")


@explains_arguments
def motion(
    run: Trajectory | Record | OfOneRun,
    slip_ratio: float = SLIP_RATIO,
    dwell: float = DWELL,
    frequency: float | None = None,
    threshold: float | None = None,
) -> Motion | Motions | Oscillation:
    """The motion at the end of a run; at the thresholds that stand here it is the attribute ``run.motion``.

    A set-valued law rests exactly, and no threshold is needed. A dynamic law never rests: there the body counts as stuck while the
    elastic part of the friction is below `slip_ratio` of its steady sliding value for at least `dwell` of a drive period.
    `threshold_table` shows how much the type depends on the two.

    Parameters
    ----------
    run : Trajectory, periodic orbit or Record
        A batch has the same results in its columns (`many.motion_type`).
    slip_ratio : float
        Between 0 and 1.
    dwell : float
        In drive periods, 0 or more; of a machine without a period in its own periods.
    frequency, threshold : float, optional
        Of a Record only: the frequency of its drive [Hz], and the velocity below which it rests [m/s]; else they come from the record.

    Returns
    -------
    Motion, or Motions of a machine that lists its contacts; Oscillation of a machine without a period; FlowMotion of a flow;
    MeasuredMotion of a Record

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.motion(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=40))
    >>> found.type, found.pattern, found.period
    ('I', '+0-0', 1)
    """
    if isinstance(run, Record):
        measured: Any = measured_motion(run, frequency, threshold, dwell)
        return measured
    of_a_record("motion", run, frequency=frequency, threshold=threshold)
    if isinstance(run, OfOneRun):
        return run.motion if (slip_ratio, dwell) == (SLIP_RATIO, DWELL) else motion(run.run, slip_ratio, dwell)
    if isinstance(run, Trajectory) and not run.pieces.layout.bodies:
        of_flow: Any = flow_motion(run)
        return of_flow
    _check(run, slip_ratio, dwell)
    if isinstance(run, Trajectory) and run.model.period is None:
        is_run("motion", run)
        return oscillation(run, slip_ratio, dwell)
    is_run("motion", run)
    motions = _of_contacts(run.with_axes, slip_ratio, dwell)
    if not run.pieces.layout.single:
        return motions
    (alone,) = motions.contacts.values()
    return dataclasses.replace(alone, _twin=partial(_twin_type, run)) if machine_of(run.model).has_inner_states else alone


def _of_contacts(run: Trajectory, slip_ratio: float, dwell: float) -> Motions:
    """The motion of each contact of a machine."""
    period = period_number(run)
    watched = watched_contacts(run)
    motions = {name: _motion(each, slip_ratio, dwell) for name, each in watched.items()}
    still = tuple(name for name, each in watched.items() if _never_moves(run, each, motions[name]))
    net = run.steadiness.mean_velocity
    machine = machine_of(run.model)
    floor = (float(run.rtol) if machine.has_inner_states else 1e-12) * float(machine.free_velocity)
    own = list(motions)[machine.own["contact"]] if "contact" in machine.own else None
    return Motions(motions, still, period, int(np.sign(net)) if abs(net) > floor else 0, own)


def _never_moves(run: Trajectory, watched: WatchedContact, motion: Motion) -> bool:
    """Whether a contact rests all through the window of the mean; one with inner states, which never rests, whether it never slips."""
    if watched.law.has_slip_ratio:
        return motion.type in ("rest", "presliding")
    return not np.any(watched.modes[pieces_within(run.pieces, *run.window)[1]])


def _way(watched: WatchedContact, count: int) -> float:
    """Way that a contact slips over the last `count` drive periods [m]: that of its bodies, less what it rubs on."""
    run = watched.run
    direction = np.array(machine_of(run.model).mechanics.slips_of[watched.number])
    x, since = run.strobe_x, run.strobe_times[-1] - count * run.period_time * (1 + 1e-12)
    inside = run.t >= since
    velocity = watched.slip[inside] - run.v[inside] @ direction
    return float((x[-1] - x[max(len(x) - 1 - count, 0)]) @ direction + np.trapezoid(velocity, run.t[inside]))


def _motion(watched: WatchedContact, slip_ratio: float, dwell: float) -> Motion:
    """The motion of one contact."""
    period = period_number(watched.run)
    raw = raw_segments(watched, period or 1, slip_ratio)
    dynamic = watched.law.dynamic
    return Motion(
        **_typed(raw, period, dwell, watched),
        period=period,
        intervals=_intervals(raw, dwell),
        slip_ratio=slip_ratio if dynamic else None,
        dwell=dwell if dynamic else None,
        _twin=(lambda: None) if dynamic else None,
    )


def _check(run: Trajectory, slip_ratio: float, dwell: float) -> None:
    problems = []
    if isinstance(run, Summary):
        problems.append("run is the summary of a batch, which holds its types already; type many.motion_type (many.pattern, many.margin)")
    if not 0 < slip_ratio < 1:
        problems.append(f"slip_ratio = {slip_ratio!r}; allowed is a fraction between 0 and 1; type for example slip_ratio=0.75")
    if not dwell >= 0:
        problems.append(f"dwell = {dwell!r}; allowed is 0 or more, in drive periods; type for example dwell=0.03")
    if problems:
        raise InputError("motion", problems)


def _typed(raw: Segments, period: int | None, dwell: float, watched: WatchedContact) -> dict[str, Any]:
    run, count, dynamic = watched.run, period or 1, watched.law.dynamic
    net, speed = _way(watched, count), machine_of(run.model).velocity_scale
    floor = (float(run.rtol) if dynamic else 1e-12) * speed * run.period_time * count
    v = watched.slip[run.t >= run.pieces.t[-1] - count * run.period_time]
    moving = np.ptp(v) > (0.0 if dynamic else 1e-9 * speed)
    types = type_of(*raw.rows(), [period or 0], [raw.margin_force], [net], dwell, moving=[moving], net_floor=floor)
    return {name.removeprefix("motion_"): column[0].item() for name, column in types.items()}


def _intervals(raw: Segments, dwell: float) -> tuple[tuple[float, float, int], ...]:
    if not (abs(raw.code) == 2).any():
        return ((0.0, float(raw.time.sum()), 0),)
    merged = intervals_of(*raw.rows(), dwell)
    return tuple((float(a), float(b), int(s)) for a, b, s in zip(merged.start[0], merged.length[0], merged.sign[0], strict=True) if b > 0)


def coulomb_twin(model: Any, static: bool = False) -> Any:
    """The same robot with Coulomb friction at the kinetic coefficients of its law (Eq. 2.4); None if the law has none.

    With `static` it breaks away at the static coefficients of its law, if the law has any: the limit of stiff bristles.
    A robot whose motion is made of closed arcs already, by its equations, is its own twin.
    """
    from stickslip.solvers.closed_arcs import handles

    law = model.friction
    if handles(model) is None:
        return model
    if not _has_kinetic(law):
        return None
    friction = Coulomb(mu_plus=law.mu_plus, mu_minus=law.mu_minus)  # contains a folded incline, too
    limits = [getattr(law, name, None) for name in ("f_plus", "f_minus")] if static else [None]
    if not any(f is None or isinstance(f, tuple) for f in limits):
        friction = dataclasses.replace(friction, f_plus=limits[0], f_minus=limits[1])
    return dataclasses.replace(model, friction=friction)


def _has_kinetic(law: Law) -> bool:
    """Whether a law names one kinetic coefficient for each direction; a set-valued one is asked whether it slides so at speed."""
    named: list[Any] = [getattr(law, name, None) for name in ("mu_plus", "mu_minus")]
    if any(mu is None or isinstance(mu, tuple) for mu in named):
        return False
    if adapted(law).dynamic:
        return True
    sides = ((_FAST, named[0]), (-_FAST, -named[1]))
    return all(everywhere(abs(adapted(law).sliding(v, 2.0) - adapted(law).sliding(v, 1.0) - mu) <= _KINETIC) for v, mu in sides)


def _twin_type(run: Trajectory) -> str | None:
    """The twin's type, from the exact borders where they apply; else it is solved."""
    from stickslip.analysis.closed_form import coulomb_type
    from stickslip.solvers import solve
    from stickslip.solvers.closed_arcs import dimensionless_arcs, handles

    twin = coulomb_twin(run.model, static=True)
    if twin is None:
        return None
    if handles(twin) is None and getattr(twin.friction, "f_plus", None) is None:
        arcs = dimensionless_arcs(twin)
        if arcs.drive[0] > 0 and min(arcs.resist_plus[0], arcs.resist_minus[0]) > 0:
            return str(coulomb_type(arcs.resist_plus / arcs.drive, arcs.resist_minus / arcs.drive)[0])
    return motion(solve(twin, periods=run.periods, settle=run.settle, keep="trajectory")).type


def threshold_table(
    run: Trajectory,
    slip_ratios: tuple[float, ...] = (0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 0.95),
    dwells: tuple[float, ...] = (0.01, 0.02, 0.03, 0.05, 0.08),
) -> list[dict[str, Any]]:
    """How the motion type of a run depends on the two thresholds.

    Returns
    -------
    list of dict
        One row for each pair: slip_ratio, dwell, type, pattern. A set-valued law needs no thresholds and gives one row, with None for both.
    """
    run = needs_run("threshold_table", run, "its types and patterns are those of one velocity")
    if not law_of(run.model).dynamic:
        m = motion(run)
        return [{"slip_ratio": None, "dwell": None, "type": m.type, "pattern": m.pattern}]
    watched, period, rows = WatchedContact(run), period_number(run), []
    for slip_ratio in slip_ratios:
        raw = raw_segments(watched, period or 1, slip_ratio)
        for dwell in dwells:
            typed = _typed(raw, period, dwell, watched)
            rows.append({"slip_ratio": slip_ratio, "dwell": dwell, "type": typed["type"], "pattern": typed["pattern"]})
    return rows
