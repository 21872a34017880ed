"""Bodies on oil: nothing holds them at rest."""

import numpy as np

import stickslip as ss
from stickslip.basics.status import Status


def test_bodies_that_nothing_holds_move_from_rest_where_forces_begin_slowly():
    """The last bodies of a row begin to move as high powers of time, which rounding hides: some ended there, with their steps used up.

    Oil is a dead band that nobody leaves, which other steps solve: ways differ by some of their tolerances.
    """
    count, rng = 40, np.random.default_rng(11)
    oil, wide, stroke = 1e-3 * 10.0 ** rng.uniform(-1, 1, count), 1e3, 6.8e-4
    springs = (ss.Spring(0.27, damping=0.003, length=0.03), ss.Spring(4.4, length=0.03), ss.Spring(0.24, damping=0.0012, length=0.02))
    link = (ss.machines.Gait(ss.MultiHarmonic(4.7, (stroke, 0.3 * stroke), (0.0, 2.9)), lag=-1.3, length=0.02), *springs)

    def solved(law, **how):
        return ss.solve(ss.Chain(ss.machines.Bodies(mass=0.018, count=5, friction=law), link=link), periods=4, **how)

    found, band = solved(ss.Viscous(oil, 2.0 * oil)), oil * wide / (0.018 * 9.81)
    other = solved(ss.friction.DeadBand(mu_plus=band, mu_minus=2.0 * band, width=wide), rtol=1e-9)
    assert np.all(np.asarray(found.status) == Status.FINISHED)
    apart = abs(np.asarray(found.displacement) - np.asarray(other.displacement))
    assert np.max(apart) < 1e-8 * stroke
