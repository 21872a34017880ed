"""Where a Taylor step ends, once a law's kernel has written its series: a module of its own for each number of lanes L."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A polynomial's coefficients stand at S[at + m * L], m = 0 .. ORDER (polynomials.py), in powers of theta = (time since the start) / h.
# What a guard has more than all its other coefficients together (F_CLEAR) says whether it can be zero in the step at all.

BELOW = 1.0  # an exponent nearer to the floor than this is no longer waited for
ROUGH = 2e-15  # of the terms of a rate: what rounding may make of it
MISFIT_OF_CHANGES = 1e-11  # of a change: what a misfit may add to it in a step
SHORTEST = 1e-22  # of a period
LAST_DIGITS = 4.5e-16  # of a time: two roundings of it
SOON = 1.5e-14  # of a period: 64 roundings of the time
TOGETHER = 1e-12  # of a step: zeros this close are at one instant, where their order is asked for
SHARES_OF_POWERS = [1.0 / (m + 1) for m in range(ORDER + 1)]  # the mean of x^m from 0 to 1


@typed(float64(f1, int64, float64))
def mean_to(S, at, x):
    """Its mean from 0 to x."""
    value = SHARES_OF_POWERS[ORDER] * S[at + ORDER * L]
    for m in range(ORDER - 1, -1, -1):
        value = fma(value, x, SHARES_OF_POWERS[m] * S[at + m * L])
    return value


@typed(float64(f1, int64, float64, float64))
def first_zero(S, at, h, period):
    """Where a polynomial first falls below zero in [0, 1]; 2 if it does not, 3 if it touches zero meanwhile, to rounding.

    One that begins below zero and rises through it at once is not below: so much does the time of the event before it not know.
    """
    terms = 0.0
    for m in range(ORDER + 1):
        terms += abs(S[at + m * L])
    noise = NOISE * terms
    if S[at] < noise and not (S[at + L] > 0.0 and -S[at] * h <= SOON * period * S[at + L]):
        return 0.0
    return first_below(S, at, ORDER, noise)


@typed(float64(f1, int64, float64, float64, float64, float64))
def extremum(S, at, end, half_rate, end_rate, end_value):
    """The largest or smallest value before `end` of a polynomial that turns once; its value there if it does not turn."""
    lo, hi, d0, d1 = 0.0, end, S[at + L], end_rate
    if d0 * d1 >= 0.0:  # after break-away the rate is zero at first, to rounding: it shows its sign further on
        lo, d0 = 0.5 * end, half_rate
    if d0 * d1 >= 0.0:
        return end_value
    return value_at(S, at, ORDER, turning_point(S, at, ORDER, lo, hi, d0, d1))


@typed(int64(f1, int64, int64, int64, float64, float64, float64, float64, f1))
def fitting(S, at, row, slopes, part, h, allowed, least, ROWS):
    """At how many points, one after another, a polynomial's slope is what its equation says: two rows of ROWS."""
    size = 0.0
    for m in range(1, ORDER + 1):
        size += m * abs(S[at + m * L])
    allowed = max(allowed + ROUNDING_OF_SLOPES * part * size, least)
    for j in range(POINTS):
        if not abs(ROWS[slopes + j] - h * ROWS[row + j]) * part <= allowed:
            return j
    return POINTS


@typed(int64(f1, int64, int64, int64, float64, float64, float64, f1))
def fitting_change(S, at, row, slopes, part, h, allowed, ROWS):
    """The same of a passive state, which is as large as it becomes; one that is no number asks for nothing."""
    size, power = abs(S[at]), 1.0
    for m in range(1, ORDER + 1):
        power *= part
        size += m * abs(S[at + m * L]) * power
    for j in range(POINTS if size == size else 0):
        if not abs(ROWS[slopes + j] - h * ROWS[row + j]) * part <= allowed + MISFIT_OF_CHANGES * size:
            return j
    return POINTS


@typed(void(int64, float64, f1, f1, i1))
def ask_slopes(lane, part, S, ROWS, D):
    """The rates that the equations give at `POINTS` points up to `part` of a step, and the slopes of the polynomials there."""
    states, first, h = D[STATES], D[F_K] + lane, S[D[F_HH] + lane]
    x = (1 + states) * POINTS  # the points; behind them the slopes of the polynomials
    for j in range(POINTS):
        ROWS[x + j] = part * (j + 1) / POINTS
        ROWS[j] = fma(ROWS[x + j], h, S[D[F_T] + lane])
    for i in range(states):
        at_points(S, first + i * (ORDER + 1) * L, ROWS, x, (1 + i) * POINTS, x + (1 + i) * POINTS, ORDER, L, POINTS)
    call_slopes(D[AT_SLOPES], lane, S, ROWS)


@typed(int64(int64, float64, float64, f1, f1, f1, i1))
def agreeing(lane, part, rough, S, ROWS, SIZES, D):
    """How many of these points pass, one after another: there the polynomials do what the equations say.

    They may differ by `rough` of the terms of a rate.
    """
    states, first, h = D[STATES], D[F_K] + lane, S[D[F_HH] + lane]
    x = (1 + states) * POINTS
    good, of_changes = POINTS, MISFIT * S[D[F_C] + D[FREE] * L + lane] if D[FREE] >= 0 else 0.0
    for i in range(states):
        scale = D[FREE] if i == 0 else D[SCALE_AT + i]
        if scale >= 0:
            allowed = MISFIT * S[D[F_C] + scale * L + lane]
            least = rough * part * h * SIZES[i]
            good = min(good, fitting(S, first + i * (ORDER + 1) * L, i * POINTS, x + (1 + i) * POINTS, part, h, allowed, least, ROWS))
        elif i >= states - D[PASSIVE]:
            good = min(good, fitting_change(S, first + i * (ORDER + 1) * L, i * POINTS, x + (1 + i) * POINTS, part, h, of_changes, ROWS))
    return good


@typed(boolean(int64, f1, i1))
def moving(lane, S, D):
    """Whether some mode is not that of rest."""
    modes = 0.0
    for k in range(D[MODES]):
        modes += abs(S[D[F_MODE] + k * L + lane])
    return modes > 0.0


@typed(float64(int64, int64, float64, f1, f1, i1))
def zero_behind_rounding(lane, k, zero, S, SIZES, D):
    """The first zero of a slip that begins at zero and falls no faster than rounding may make it: the next coefficient decides."""
    at, h = D[F_G] + k * (ORDER + 1) * L + lane, S[D[F_HH] + lane]
    call_sizes(D[AT_SIZES], lane, S, SIZES)
    if -S[at + L] > ROUGH * h * SIZES[D[STATES] + k]:
        return zero
    S[at + L] = 0.0
    return first_zero(S, at, h, S[D[F_C] + D[PERIOD] * L + lane])


@typed(UniTuple(float64, 2)(int64, f1, f1, f1, i1))
def end_of_step(lane, S, ROWS, SIZES, D):
    """Where in its step a lane must stop (above 1: at its end), and the guard that stops it (-1: none)."""
    theta, which, touched = 2.0, -1.0, False
    count, h, period = D[WATCHED] + D[EXPONENTS], S[D[F_HH] + lane], S[D[F_C] + D[PERIOD] * L + lane]
    for j in range(count):
        k = count - 1 - j if D[ORDERED] < 0 else j
        at = D[F_G] + k * (ORDER + 1) * L + lane
        if S[D[F_CLEAR] + k * L + lane] > 0.0 or (k >= D[WATCHED] and S[at] <= BELOW):
            continue
        zero = first_zero(S, at, h, period)
        if zero <= 1.0 and k < D[WATCHED] and S[at] == 0.0 and S[at + L] < 0.0:
            zero = zero_behind_rounding(lane, k, zero, S, SIZES, D)
        touched = touched or (zero > 2.0 and k < D[WATCHED])
        if zero < (theta - TOGETHER if D[ORDERED] != 0 and which >= 0.0 and k < D[WATCHED] else theta):
            theta, which = zero, np.float64(k) if k < D[WATCHED] else -1.0
    for i in range(D[STATES] - D[PASSIVE] if touched and D[CARRIED] > 0 else D[STATES], D[STATES]):
        S[D[F_K] + lane + i * (ORDER + 1) * L] = math.nan  # a switch that is touched and not crossed leaves changes without a number
    fits = D[F_FITS] >= 0 and S[D[F_FITS] + lane] > 0.5  # on the whole step, and so on any part
    if D[AT_SLOPES] == 0 or fits or not moving(lane, S, D):
        return theta, which
    rough = 0.0
    for _ in range(200):
        part = min(theta, 1.0)
        ask_slopes(lane, part, S, ROWS, D)
        good = agreeing(lane, part, rough, S, ROWS, SIZES, D)
        if good < POINTS and rough == 0.0:
            call_sizes(D[AT_SIZES], lane, S, SIZES)
            rough = ROUGH
            good = agreeing(lane, part, rough, S, ROWS, SIZES, D)
        if good >= POINTS:
            break
        theta, which = part * (good + 0.5) / POINTS, -1.0
        S[D[F_NREJ] + lane] += 1.0
    return theta, which


@typed(void(int64, f1, f1, f1, float64, i1))
def land_lane(lane, S, ROWS, SIZES, budget, D):
    """End a lane's step at its end, or at the first zero of a guard, where modes and flags change."""
    states, at_y, at_k = D[STATES], D[F_Y] + lane, D[F_K] + lane
    at_t, at_x, at_stat, at_nacc = D[F_T] + lane, D[F_X] + lane, D[F_STAT] + lane, D[F_NACC] + lane
    theta, guard = end_of_step(lane, S, ROWS, SIZES, D)
    which = np.int64(guard)
    h, last = S[D[F_HH] + lane], S[D[F_LAST] + lane] > 0.5
    part = min(theta, 1.0)
    S[D[F_T0] + lane], S[D[F_X0] + lane] = S[at_t], S[at_x]
    for i in range(D[CONTACTS]):
        S[D[F_SIDE] + i * L + lane] = S[D[F_MODE] + i * L + lane]
    whole = theta > 1.0  # then the step's own lines know what is there
    if whole:
        v, d1, d0 = S[D[F_ENDS] + lane], S[D[F_RATES] + lane], S[D[F_RATES] + L + lane]
    else:
        v, d1, d0 = value_at(S, at_k, ORDER, part), slope_at(S, at_k, ORDER, part), slope_at(S, at_k, ORDER, 0.5 * part)
    S[D[F_TOP] + lane] = extremum(S, at_k, part, d0, d1, v)
    if D[F_FIRED] >= 0:
        S[D[F_FIRED] + lane] = guard
    bad = False
    for i in range(states):
        if i == 0:
            y = v
        elif whole and i < states - D[PASSIVE]:
            y = S[D[F_ENDS] + i * L + lane]
        else:
            y = value_at(S, at_k + i * (ORDER + 1) * L, ORDER, part)
        S[at_y + i * L] = y
        bad = bad or (y != y and i < states - D[PASSIVE])
        if i > 0:
            S[D[F_M] + (i - 1) * L + lane] = max(S[D[F_M] + (i - 1) * L + lane], abs(y))
    if D[CYCLIC] == 1:
        S[at_x] += h * (S[D[F_MEAN] + lane] if whole else part * mean_to(S, at_k, part))
    else:
        S[at_x] = S[at_y + (states - D[PASSIVE] - D[COORDINATES]) * L]
    S[at_nacc] += 1.0
    if bad:
        S[at_stat] = 4.0
        return
    if theta > 1.0 and last:
        S[at_t] = S[D[F_TEND] + lane]
        S[at_stat] = 1.0
    else:
        before = S[at_t]
        S[at_t] += part * h
        if which >= 0:
            status = call_switched(D[AT_SWITCHED], which, lane, S)
            if status > 0:
                S[at_stat] = status
            elif last and S[at_t] == before and h <= LAST_DIGITS * S[D[F_TEND] + lane]:
                S[at_t] = S[D[F_TEND] + lane]  # at the end but for rounding: a guard that is zero there may change sides for ever
                S[at_stat] = 1.0
        elif part * h < SHORTEST * S[D[F_C] + D[PERIOD] * L + lane]:
            S[at_stat] = 3.0
    if S[at_nacc] > budget and S[at_stat] < 0.5:
        S[at_stat] = 2.0


@typed(void(f1, float64, i1))
def land(S, budget, D):
    """End the step of every lane."""
    ROWS, SIZES = np.empty(2 * (1 + D[STATES]) * POINTS), np.zeros(D[STATES] + D[WATCHED])
    for lane in range(L):
        land_lane(lane, S, ROWS, SIZES, budget, D)
