"""Measures of stages and conveyors: step per cycle, throw index, and hops of the conveyed body."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.contact_modes import FLIGHT, contact_modes
from stickslip.analysis.steady import is_run, mean_velocity
from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.batch import flat, labels_of
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

_LOOKS, _HALVINGS = 720, 60  # instants of a period; steps of the golden section between two of them
_PARTS, _NODES = 8, 12  # of a period, and of each of its parts: Gauss's rule integrates twenty harmonics to rounding
_GOLDEN = (5**0.5 - 1) / 2


@explains_arguments
def step_per_cycle(run: Trajectory) -> float:
    """Displacement per drive period: the mean velocity times the period.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    float
        [m]

    Examples
    --------
    >>> import stickslip as ss
    >>> round(step_per_cycle(ss.solve(ss.presets.stick_slip_stage(), periods=10)), 15)
    5.013157895e-06
    """
    return float(mean_velocity(run) * run.period_time)


@explains_arguments
def throw_index(machine: Model) -> Any:
    r"""Throw index of a contact: :math:`\Gamma = 1 - N_{\min}/\bar N`, from the smallest and the mean load in a period.

    Where it is above 1 the load falls to zero in each period. For a trough that swings harmonically with the amplitude A at an angle
    :math:`\beta` to a level track it is :math:`A\omega^2\sin\beta/g`.

    Parameters
    ----------
    machine : MovingTrack, Robot or another machine with a period
        A single one or a batch. With several contacts, that of the principal body counts, else the first. A load that depends on position
        is evaluated at the initial one.

    Returns
    -------
    float or array
        [-], 0 where the load does not vary.

    Examples
    --------
    >>> import stickslip as ss
    >>> round(float(throw_index(ss.presets.conveyor(throw_index=2.5))), 12)
    2.5
    """
    if machine.period is None:
        raise InputError("throw_index", [f"{type(machine).__name__} has no period, and so no cycle; allowed is a machine with a period"])
    batch = machine_of(flat(machine))
    mechanics, number = batch.mechanics, batch.own.get("contact", 0)
    labels = labels_of(machine)
    T = np.broadcast_to(np.asarray(batch.model.period, float), (labels.cases,))

    def load(phase: Numeric) -> Any:
        return np.broadcast_to(np.asarray(mechanics.loads(phase * T, mechanics.start)[number], float), T.shape)

    looks = np.array([load(k / _LOOKS) for k in range(_LOOKS)])
    low = (np.argmin(looks, axis=0) - 1.0) / _LOOKS
    high = low + 2 / _LOOKS
    for _ in range(_HALVINGS):
        a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        falls = load(a) > load(b)
        low, high = np.where(falls, a, low), np.where(falls, high, b)
    least = np.minimum(load(0.5 * (low + high)), looks.min(axis=0))
    return (1.0 - least / _mean(load, batch, T)).reshape(labels.shape)[()]


def _mean(load: Any, batch: Any, T: Any) -> Any:
    """Mean load over a period, by Gauss's rule between the instants at which it is not smooth [N]."""
    cuts = [np.broadcast_to(np.asarray(s, float), T.shape) / T for s in batch.unsorted_breaks]
    edges = np.sort(np.array([*cuts, *(np.full(T.shape, k / _PARTS) for k in range(_PARTS + 1))]), axis=0)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    total = np.zeros(T.shape)
    for first, last in itertools.pairwise(edges):
        half = 0.5 * (last - first)
        total += half * sum(w * load(first + half * (1.0 + s)) for s, w in zip(nodes, weights, strict=True))
    return total


@dataclass(frozen=True)
class Hops:
    """The hops of a contact over a span of a run.

    Parameters
    ----------
    fraction : float
        Fraction of the time in flight [-].
    landings : int
        Number of landings.
    speed : float
        Largest normal velocity at a landing [m/s]; 0 without landings.
    height : float
        Largest height above the track [m].

    Examples
    --------
    >>> Hops(fraction=0.4, landings=2, speed=0.1, height=5e-4).landings
    2
    """

    fraction: float
    landings: int
    speed: float
    height: float


@explains_arguments
def hops(run: Trajectory, contact: str | None = None) -> Hops:
    """The hops of a contact over the last motion period of a run, or its last drive periods where it does not repeat.

    A run without a period counts as a whole.

    Parameters
    ----------
    run : Trajectory
        The run of a machine with a contact that takes off and lands, such as a `MovingTrack` with a normal motion.
    contact : str, optional
        Name of the contact; the first one that can fly, if not given.

    Returns
    -------
    Hops

    Examples
    --------
    >>> import stickslip as ss
    >>> found = hops(ss.solve(ss.presets.conveyor(throw_index=2.5), periods=40))
    >>> found.landings, round(found.fraction, 9)
    (1, 0.857309824)
    """
    is_run("hops", run)
    flying = [name for name, law in zip(run.contacts, machine_of(run.model).laws, strict=True) if law.flies]
    name = str(contact or next(iter(flying), ""))
    if name not in flying:
        allowed = f"allowed is {', '.join(map(repr, flying))}" if flying else "none of its contacts can; type ss.presets.conveyor()"
        raise InputError("hops", [f"contact = {contact!r} does not fly and land in a run of {type(run.model).__name__}; {allowed}"])
    start, end = _span(run)
    stretches = [(a, b) for a, b, sign in contact_modes(run, start, end)[name] if sign == FLIGHT]
    landings = [event for _, event in run._columns.flights if event.kind == "landing" and event.part == name and start < event.t <= end]
    return Hops(
        sum(b - a for a, b in stretches) / (end - start),
        len(landings),
        max((-(event.velocity or 0.0) for event in landings), default=0.0),
        max((_height(run, name, a, b) for a, b in stretches), default=0.0),
    )


def _span(run: Trajectory) -> tuple[float, float]:
    """The last motion period, or the last drive period where none was found, with a moment before: what lands at its end lands once."""
    from stickslip.analysis.steady import period_number

    if run.model.period is None:
        return float(run.pieces.t[0]), float(run.pieces.t[-1])
    end, T = float(run.strobe_times[-1]), run.period_time
    return end - T * min(period_number(run) or 1, len(run.strobe_times) - 1), end


def gaps(run: Trajectory, at: dict[str, Any]) -> dict[str, Any]:
    """How high each contact that can fly is above what it rubs on [m], at the instants of ``run.with_axes.at``."""
    flying = [(i, name) for i, (name, law) in enumerate(zip(run.contacts, machine_of(run.model).laws, strict=True)) if law.flies]
    return {name: at["z"].reshape(len(at["t"]), len(run.contacts), -1)[:, i, 0] for i, name in flying}


def _height(run: Trajectory, name: str, start: float, end: float) -> float:
    """The largest gap within a stretch [m]: at its samples, and at the top of the parabola through the largest of them."""
    t = np.linspace(start, end, 1025)
    gap = gaps(run, run.with_axes.at(t))[name]
    k = int(np.clip(np.argmax(gap), 1, len(t) - 2))
    bend, slope = gap[k - 1] - 2 * gap[k] + gap[k + 1], gap[k + 1] - gap[k - 1]
    return float(max(gap[k] - slope**2 / (8 * bend) if bend < 0 else gap[k], gap.max()))
