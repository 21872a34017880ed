"""Force rigs with play in their drive train: the play comes out beside the friction, or it is said that the record does not tell it.

The truth is made here, by many small ways of a contact without mass between two flanks.
"""

import numpy as np
import pytest

import stickslip as ss
from stickslip.inverse.identification.law_forces import driven_force
from stickslip.inverse.identification.motions import PrescribedMotion
from stickslip.inverse.identification.uncertainty import faults
from stickslip.models.force_rig import ForceRig

LOAD, PLAY, MU, STATIC, SPEED, STIFFNESS = 40.0, 2e-4, 0.2, 0.3, 5e-4, 2e5
BOTH = {"friction.mu_minus": "friction.mu_plus"}
FREE = {"friction.mu_plus": (0.02, 0.6), "backlash": (0.0, 1e-3)}
RIGID = ss.machines.ForceRig(ss.Stribeck(0.1, 0.1, 0.15, 0.15, v_s=1e-3), backlash=1e-4)
ELASTIC = ss.machines.ForceRig(ss.Dahl(0.1, 0.1, sigma0=1e5), backlash=1e-4)


def stroke(t):
    return 1e-3 * (np.sin(np.pi * t + 0.7) + 0.2 * np.sin(2.3 * np.pi * t))


def rigid(way, speed):
    """Dry friction with a Stribeck dip over small ways of an actuator."""
    place, found = 0.0, []
    for d, v in zip(way, speed, strict=True):
        place = np.clip(place + d, -PLAY / 2, PLAY / 2)
        sliding = LOAD * (MU + (STATIC - MU) * np.exp(-((v / SPEED) ** 2)))
        found.append(np.sign(place) * sliding if abs(place) == PLAY / 2 and d * place > 0 else 0.0)
    return np.array(found)


def elastic(way, speed):
    """Bristles of Dahl, exact over each way; a flank that goes back is followed until they are unbent."""
    place, z, end, found = 0.0, 0.0, MU * LOAD / STIFFNESS, []
    for d in way:
        s = np.sign(d)
        if z * s < 0:
            unbent = end * np.log1p(abs(z) / end)
            followed = min(abs(d), unbent)
            z = s * end + (z - s * end) * np.exp(-followed / end) if followed < unbent else 0.0
            d -= s * followed
        reached = np.clip(place + d, -PLAY / 2, PLAY / 2)
        pushed, place = place + d - reached, reached
        z = s * end + (z - s * end) * np.exp(-abs(pushed) / end) if pushed else z
        found.append(STIFFNESS * z)
    return np.array(found)


def record(force, noise=0.05, blur=0.0, count=1500, fine=20, path=stroke):
    """A record of position and force, of which the latter was made on a finer grid."""
    t, rng = np.linspace(0.0, 4.0, count), np.random.default_rng(0)
    between = np.linspace(0.0, 4.0, (count - 1) * fine + 1)
    way = np.diff(path(between), prepend=path(-between[1]))
    F = force(way, way / between[1])[::fine]
    return ss.Record.of(
        t, {"x [m]": path(t) + blur * rng.normal(size=count), "F [N]": F + rng.normal(0, noise, count)}, roles={"F": "force"}
    )


def off(fit, truth):
    """Numbers whose intervals of 99.7 % do not hold the truth."""
    return {name: fit.interval(name, level=0.997) for name, true in truth.items()
            if not fit.interval(name, level=0.997)[0] <= true <= fit.interval(name, level=0.997)[1]}  # fmt: skip


@pytest.mark.parametrize("blur", [0.0, 1e-6])
def test_play_before_dry_friction_is_known_to_the_way_between_samples(blur):
    rec = record(rigid, blur=blur)
    free, tied = (
        FREE | {"friction.f_plus": (0.02, 0.9), "friction.v_s": (1e-4, 1e-2, "log")},
        BOTH | {"friction.f_minus": "friction.f_plus"},
    )
    fit = ss.identify(rec, RIGID, free=free, tied=tied, load=LOAD, starts=8, sensor={})
    assert off(fit, {"friction.mu_plus": MU, "friction.f_plus": STATIC, "friction.v_s": SPEED, "backlash": PLAY}) == {}
    between = np.max(abs(np.diff(stroke(np.linspace(0, 4, 1500)))))
    assert np.ptp(fit.interval("backlash")) < 4 * between + 60 * blur and faults(fit) == []


@pytest.mark.parametrize("blur", [0.0, 2e-6])
def test_play_before_bristles_has_an_error(blur):
    fit = ss.identify(
        record(elastic, blur=blur), ELASTIC, free=FREE | {"friction.sigma0": (1e4, 1e7, "log")}, tied=BOTH, load=LOAD, starts=8
    )
    assert off(fit, {"friction.mu_plus": MU, "friction.sigma0": STIFFNESS, "backlash": PLAY}) == {}
    assert fit.errors["backlash"] < 0.01 * PLAY and faults(fit) == []


def test_play_that_a_record_does_not_cross_is_not_determined():
    one_way = ss.Record.of(t := np.linspace(0, 4, 1500), {"x [m]": 1e-3 * t, "F [N]": 8.0 + np.random.default_rng(0).normal(0, 0.05, 1500)},
                           roles={"F": "force"})  # fmt: skip
    fit = ss.identify(one_way, ForceRig(ss.Coulomb(0.1, 0.1), 1e-4), free=FREE, tied=BOTH, load=LOAD, starts=4, sensor={})
    assert fit.undetermined == ("backlash",) and fit.interval("backlash") == (0.0, 1e-3)
    assert any("backlash is not determined" in w for w in fit.warnings)
    short = record(rigid, path=lambda t: 0.4 * PLAY * np.sin(2 * np.pi * t))
    fit = ss.identify(short, ForceRig(ss.Coulomb(0.1, 0.1), 1e-4), free=FREE, tied=BOTH, load=LOAD, starts=4, sensor={})
    assert "friction.mu_plus" in fit.undetermined
    low, high = fit.interval("backlash")  # wider than the strokes, and that is all
    assert 0.75 * PLAY < low < PLAY and high == 1e-3


MANY = (
    ss.Stribeck(0.2, 0.3, 0.25, 0.4, v_s=1e-3),
    ss.LuGre(0.2, 0.3, 0.25, 0.4, sigma0=1e5, sigma1=10.0, sigma2=1.0, v_s=1e-3),
    ss.friction.GMS.example(),
    ss.friction.ResetIntegrator(0.2, 0.3, 0.25, 0.4, sigma0=1e5, sigma1=0.0),
)


@pytest.mark.parametrize("law", MANY, ids=lambda law: type(law).__name__)
def test_without_play_the_force_is_that_of_the_law(law):
    """But at samples beside a reversal, where it is open on which flank a rigid contact is."""
    t = np.linspace(0, 4, 1000)
    v = np.diff(stroke(t), prepend=stroke(-t[1])) / t[1]
    motion = PrescribedMotion(t, v, np.full(1000, LOAD), np.zeros(1000), 0, False, "")
    alone, moved = (driven_force(model, motion, applied=1e9)[:, 0] for model in (law, ForceRig(law, 0.0)))
    turns = np.convolve(abs(np.diff(np.sign(v), append=0.0)), np.ones(3), "same") > 0
    assert (~turns).sum() > 900 and abs(moved - alone)[1:][~turns[1:]].max() < 1e-9 * abs(alone).max()


def test_what_is_no_force_rig_is_said():
    with pytest.raises(ss.InputError, match="Karnopp, which balances the forces at rest; allowed is any other law"):
        ForceRig(ss.friction.Karnopp.example(), 1e-4)
    with pytest.raises(ss.InputError, match="backlash = -1"):
        ForceRig(ss.Coulomb(0.1, 0.1), -1.0)
    with pytest.raises(ss.InputError, match="is not a model"):
        ss.solve(RIGID, duration=1.0)
