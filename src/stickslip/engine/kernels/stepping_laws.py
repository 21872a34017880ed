"""A law over a prescribed motion, step by step: text that follows the functions of a law in its kernel, never imported."""
# ruff: noqa: F821
# mypy: ignore-errors

LOCATED = 60  # halvings, and as many chords in turn, of a step in which a guard falls
MOST = 4 * SWITCHES + 1  # switches within a step, after which it goes on without


@typed(void(f1, float64))
def fill(room, value):
    """One number in all places of an array."""
    for i in range(len(room)):
        room[i] = value


@typed(void(f1, f1, f1, f1, f1))
def switch(guard, came, after, own, mode):
    """Where a guard has fallen that stood on the way here, what follows; the last of several counts."""
    for k in range(SWITCHES):
        if guard[k] <= 0.0 and came[k] > 0.0:
            first = k * (MODES + STATES)
            for i in range(MODES):
                mode[i] = after[first + i]
            for i in range(STATES):
                own[i] = after[first + MODES + i]


@typed(void(f1, f1, f1, float64, float64, float64, f1, f1))
def advanced(row, own, mode, v, load, h, f, J):
    """A step of each inner state at constant velocity, exact where its rate is linear in it."""
    rates_of(row, own, mode, v, load, f, J)
    for i in range(STATES):
        a = min(J[i] * h, 30.0)
        own[i] += h * f[i] * (math.expm1(a) / a if abs(a) > 1e-8 else 1.0)


@typed(void(f1, f1))
def put(room, values):
    """The same numbers in another array."""
    for i in range(len(values)):
        room[i] = values[i]


@typed(int64(f1, f1, f1))
def first_fallen(before, after, last):
    """The guard that falls to zero first on a step, by its values at both ends; -1 if none does.

    One that stands at or below zero as the step begins has fallen if it falls further, or if it stays and stood above zero at the end of
    the step before; if it rises it has not.
    """
    which, least = -1, 2.0
    for k in range(SWITCHES):
        if after[k] <= 0.0 and (before[k] > 0.0 or after[k] < before[k] or (after[k] == before[k] and last[k] > 0.0)):
            part = before[k] / (before[k] - after[k]) if before[k] > 0.0 else 0.0
            if part < least:
                which, least = k, part
    return which


@typed(float64(f1, f1, f1, float64, float64, float64, int64, f1, f1, f1, f1, f1))
def zero_of(row, own, mode, v, load, h, k, before, after, z, f, J):
    """When on a step a guard is zero: bisection, and regula falsi in turn."""
    low, high, at_low, at_high = 0.0, h, before[k], after[k]
    guard = np.empty(max(SWITCHES, 1))
    for n in range(LOCATED):
        t = 0.5 * (low + high) if n % 2 == 1 else low + (high - low) * at_low / (at_low - at_high)
        put(z, own)
        advanced(row, z, mode, v, load, t, f, J)
        guards_of(row, z, mode, v, load, guard)
        if guard[k] > 0.0:
            low, at_low = t, guard[k]
        else:
            high, at_high = t, guard[k]
        if high - low <= 1e-14 * h or at_high == 0.0:
            return high
    return high


@typed(void(f1, f1, f1, float64, float64, float64, f1, f1, f1))
def remembered_step(row, own, mode, v, load, h, f, J, last):
    """A step within which a law's memory switches where its guards fall to zero, one after the other."""
    z, before, guard = np.empty(max(STATES, 1)), np.empty(max(SWITCHES, 1)), np.empty(max(SWITCHES, 1))
    after = np.empty(max(SWITCHES, 1) * max(STATES + MODES, 1))
    for n in range(MOST):
        put(z, own)
        advanced(row, z, mode, v, load, h, f, J)
        guards_of(row, z, mode, v, load, guard)
        which = -1
        if lowest(guard) <= 0.0 and n < MOST - 1:
            guards_of(row, own, mode, v, load, before)
            which = first_fallen(before, guard, last)
        if which < 0:
            put(own, z)
            put(last, guard)
            return
        if before[which] > 0.0:
            t = zero_of(row, own, mode, v, load, h, which, before, guard, z, f, J)
            advanced(row, own, mode, v, load, t, f, J)
            h -= t
        outcomes_of(row, own, mode, v, load, after)
        first = which * (MODES + STATES)
        for i in range(MODES):
            mode[i] = after[first + i]
        for i in range(STATES):
            own[i] = after[first + MODES + i]


@typed(float64(f1))
def lowest(values):
    """The smallest of some numbers."""
    least = math.inf
    for k in range(len(values)):
        least = min(least, values[k])
    return least


@typed(void(f2, f1, f1, f2, f1, f2, f2, f2, f2))
def follow(rows, v, at, loads, steps, applied, begun, z, out):
    """Each case alone: a step of each inner state at constant velocity; then the force.

    A law's memory switches within a step where a guard falls to zero, and at rest where the velocity comes to zero or passes it.
    """
    own, mode = np.zeros(max(STATES, 1)), np.zeros(max(MODES, 1))
    f, J = np.zeros(max(STATES, 1)), np.zeros(max(STATES, 1))
    guard, came, after = np.zeros(max(SWITCHES, 1)), np.zeros(max(SWITCHES, 1)), np.zeros(max(SWITCHES, 1) * max(STATES + MODES, 1))
    last, force = np.zeros(max(SWITCHES, 1)), np.zeros(1)
    for case in range(len(rows)):
        row, side = rows[case], 0.0
        for i in range(MODES):
            mode[i] = begun[i, case]
        fill(last, 1.0)
        for i in range(STATES):
            own[i] = z[i, case]
        for k in range(len(v)):
            load = loads[k, case % loads.shape[1]]
            if SWITCHES > 0 and side != 0.0 and v[k] * side <= 0.0:
                guards_of(row, own, mode, side, load, came)
                guards_of(row, own, mode, 0.0, load, guard)
                outcomes_of(row, own, mode, 0.0, load, after)
                switch(guard, came, after, own, mode)
                guards_of(row, own, mode, 0.0, load, last)
            side = v[k]
            if v[k] != 0.0 and steps[k] > 0.0:
                if SWITCHES > 0:
                    remembered_step(row, own, mode, v[k], load, steps[k], f, J, last)
                else:
                    advanced(row, own, mode, v[k], load, steps[k], f, J)
            force_of(row, own, mode, at[k], load, applied[k, case % applied.shape[1]], force)
            out[k, case] = force[0]
        for i in range(STATES):
            z[i, case] = own[i]
