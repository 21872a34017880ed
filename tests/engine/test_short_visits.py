"""Events that come and go within one step."""

import numpy as np

import stickslip as ss


def test_short_visits_to_the_other_side_are_not_missed():
    """Slips that hardly leave a dead band: the work of friction is as exact as the tolerance, however short the visits are.

    Two equal bodies under a gait slip by half its speed each, and all that moves the pair is friction. Errors are 6 to 8 tolerances of the
    way; visits that are missed make them more than a thousand.
    """
    count, rng = 200, np.random.default_rng(5)
    amplitude, omega = 5e-4, 6.0
    beyond, mu = 10.0 ** rng.uniform(-8, -2, count), 1e-7 * rng.uniform(0.2, 1.0, count)
    law = ss.DeadBand(mu_plus=mu, mu_minus=2 * mu, width=0.5 * amplitude * omega * (1 - beyond))
    pair = ss.Chain(ss.Bodies(mass=(0.03, 0.03), count=2, friction=law), link=ss.Gait(ss.Harmonic(amplitude, omega), lag=0.0, length=0.05))
    ways = {rtol: np.asarray(ss.solve(pair, periods=4, rtol=rtol).displacement) for rtol in (1e-7, 1e-8, 1e-10)}
    for rtol in (1e-7, 1e-8):
        assert np.max(abs(ways[rtol] - ways[1e-10])) < 20 * rtol * np.max(abs(ways[1e-10]))
