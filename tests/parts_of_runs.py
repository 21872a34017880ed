"""The columns of bodies, contacts and stops, made a second time from the dense output of single runs: the judge of those that lanes make.

A batch is made of two equal cases, so that it goes through lanes; a single run of as many periods takes the same steps, so that both are
the same motion. Here its last motion period is looked at densely, and no line of the lanes' observers is used.
"""

import numpy as np

import stickslip as ss
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.models.machine_adapter import machine_of

SAMPLES, NODES = 4001, 12


def twice(machine):
    """A batch of two cases that are alike."""
    numbers = {name: np.array([value, value]) for name, value in leaves(machine)}
    return replace_leaf(machine, {name: numbers[name] for name in list(numbers)[:1]})


def solved(machine, periods, lanes_only=None, **options):
    """The summary of two equal cases, and the single run of as many periods."""
    many = ss.solve(twice(machine), periods=periods, settle=periods // 2, keep="summary", **options, **(lanes_only or {}))
    ran = int(many.periods_run[0])
    return many, ss.solve(machine, periods=ran, settle=periods // 2, **options)


def _pieces_since(run, begin):
    """Ends of the pieces from an instant on."""
    t = np.unique(np.clip(run.pieces.t, begin, None))
    return t[:-1], np.diff(t)


def _top(run, begin, of):
    """Largest value of a function of the columns since an instant, one for each part: looked at on each piece, then nearer at the best."""
    left, length = _pieces_since(run, begin)
    theta = np.linspace(1e-9, 1.0 - 1e-9, max(SAMPLES // len(left), 12))
    t = (left[:, None] + length[:, None] * theta).ravel()
    step = np.repeat(length * (theta[1] - theta[0]), len(theta))
    piece = np.repeat(np.arange(len(left)), len(theta))
    values = of(run.at(t))
    found = []
    for column in values.T:
        best = int(np.argmax(column))
        middle, around, top = t[best], step[best], column[best]
        low, high = left[piece[best]], left[piece[best]] + length[piece[best]]
        for _ in range(5):
            near = np.clip(middle + around * np.linspace(-1, 1, 21), low + 1e-9 * (high - low), high - 1e-9 * (high - low))
            each = of(run.at(near))[:, len(found)]
            middle, around, top = near[np.argmax(each)], 0.12 * around, max(top, each.max())
        found.append(top)
    return np.array(found)


def _integral(run, begin, of):
    """Integral over time since an instant: Gauss's rule on each piece."""
    left, length = _pieces_since(run, begin)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    t = left[:, None] + 0.5 * length[:, None] * (nodes + 1)
    values = of(run.at(t.ravel())).reshape(*t.shape, -1)
    return np.einsum("ijk,j,i->k", values, weights, 0.5 * length)


def columns_of(run, period):
    """Every column with an axis of bodies, contacts or stops, from a single run whose motion has this period number (0: none)."""
    count = max(period, 1)
    begin = run.pieces.t[-1] - count * run.period_time
    told = ss.motion(run).contacts.values()
    work = _integral(run, begin, lambda at: at["friction_force"] * at["slip"])
    found = {
        "velocity_max": _top(run, begin, lambda at: at["v"]),
        "velocity_min": -_top(run, begin, lambda at: -at["v"]),
        "slip_max": _top(run, begin, lambda at: at["slip"]),
        "slip_min": -_top(run, begin, lambda at: -at["slip"]),
        "friction_power": work / (count * run.period_time),
    }
    found |= {name: np.array([getattr(m, name) for m in told]) for name in ("stick_fraction", "forward_fraction", "backward_fraction")}
    found |= {"motion_type": [m.type for m in told], "pattern": [m.pattern for m in told], "direction": [m.direction for m in told]}
    return found | hits_of(run, begin)


def hits_of(run, begin):
    """How often stops with restitution are hit in the last motion period, and the greatest impulse."""
    mechanics = machine_of(run.model).mechanics
    found = {"hits": [], "impulse_max": []}
    for stop in mechanics.stops:
        hits = [event for event in run.events if event.kind == "hit" and event.part == stop.name and event.t > begin + 1e-12]
        inverse = sum(h * h / float(m) for h, m in zip(stop.direction, mechanics.masses, strict=True))
        found["hits"].append(len(hits))
        found["impulse_max"].append(max((-(1 + float(stop.restitution)) * hit.velocity / inverse for hit in hits), default=0.0))
    return found
