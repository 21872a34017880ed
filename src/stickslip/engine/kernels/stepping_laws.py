"""A law over a prescribed motion, step by step: text that follows the functions of a law in its kernel, never imported."""
# ruff: noqa: F821
# mypy: ignore-errors


@njit(void(f1, float64))
def fill(room, value):
    """One number in all places of an array."""
    for i in range(len(room)):
        room[i] = value


@njit(void(f1, f1, f1, f1, f1))
def switch(guard, came, after, own, mode):
    """Where a guard has fallen that stood on the way here, what follows; the last of several counts."""
    for k in range(SWITCHES):
        if guard[k] <= 0.0 and came[k] > 0.0:
            first = k * (MODES + STATES)
            for i in range(MODES):
                mode[i] = after[first + i]
            for i in range(STATES):
                own[i] = after[first + MODES + i]


@njit(void(f2, f1, f1, f2, f1, f2, f2, f2))
def follow(rows, v, at, loads, steps, applied, z, out):
    """Each case alone: a step of each inner state at constant velocity, exact where its rate is linear in it; then the force.

    A law's memory switches at the end of a step, and at rest where the velocity passes zero.
    """
    own, mode = np.zeros(max(STATES, 1)), np.zeros(max(MODES, 1))
    f, J = np.zeros(max(STATES, 1)), np.zeros(max(STATES, 1))
    guard, came, after = np.zeros(max(SWITCHES, 1)), np.zeros(max(SWITCHES, 1)), np.zeros(max(SWITCHES, 1) * max(STATES + MODES, 1))
    force = np.zeros(1)
    fill(came, 1.0)
    for case in range(len(rows)):
        row, side = rows[case], 0.0
        fill(mode, 0.0)
        for i in range(STATES):
            own[i] = z[i, case]
        for k in range(len(v)):
            load = loads[k, case % loads.shape[1]]
            if SWITCHES > 0 and v[k] * side < 0.0:
                guards_of(row, own, mode, side, load, came)
                guards_of(row, own, mode, 0.0, load, guard)
                outcomes_of(row, own, mode, 0.0, load, after)
                switch(guard, came, after, own, mode)
                fill(came, 1.0)
            side = v[k] if v[k] != 0.0 else side
            if v[k] != 0.0 and steps[k] > 0.0:
                rates_of(row, own, mode, v[k], load, f, J)
                for i in range(STATES):
                    a = min(J[i] * steps[k], 30.0)
                    own[i] += steps[k] * f[i] * (math.expm1(a) / a if abs(a) > 1e-8 else 1.0)
            if SWITCHES > 0:
                guards_of(row, own, mode, v[k], load, guard)
                outcomes_of(row, own, mode, v[k], load, after)
                switch(guard, came, after, own, mode)
            force_of(row, own, mode, at[k], load, applied[k, case % applied.shape[1]], force)
            out[k, case] = force[0]
        for i in range(STATES):
            z[i, case] = own[i]
