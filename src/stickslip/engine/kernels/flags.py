"""What a lane holds while it steps: columns of its arrays, flags, modes, and the known instants; text before watching.py."""
# ruff: noqa: F821
# mypy: ignore-errors

# columns of N (lane): case (-1 idle), periods done, recording, last period to do, period number, fresh point, closing, status, and of
# each contact how many segments there are
CASE, DONE, RECORDING, TARGET, NUMBER, FRESH, CLOSING, STATUS, SEGMENTS = range(9)
# columns of K (lane): the last two observed points, window, work of friction while recording and how long,
# displacement approached, extremes at the ends of the steps in the window
TQ, VQ, AQ, RQ, BQ, TP, VP, BP, VMAX, VMIN, DISPLACEMENT, WINDOW, WORK, LASTED, LIMIT, WIDE_MAX, WIDE_MIN = range(17)
SEGS = 32
FINISHED, REPEATED = 0, 1


@njit(void(int64, f1, f1, boolean, i1), **OPTIONS)
def set_flags(lane, S, row, first, D):
    """Everything that a step holds, from the lane's time and state; with `first` its modes too. Then the end of the next steps."""
    L = D[LANES]
    t, period = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * L + lane]
    y, clock, mode, side = np.empty(D[STATES]), np.empty(D[CLOCKS]), np.empty(D[MODES]), np.empty(D[GUARDS])
    for i in range(D[STATES]):
        y[i] = S[D[F_Y] + i * L + lane]
    for k in range(D[MODES]):
        mode[k] = S[D[F_MODE] + k * L + lane]
    call_look(D[AT_LOOK], CLOCK_SIGNS, row, t + 1e-13 * period, y, clock, mode, clock)
    if first:
        call_look(D[AT_LOOK], FIRST_MODES, row, t, y, clock, mode, side)
    call_look(D[AT_LOOK], GUARD_VALUES, row, t, y, clock, mode, side)
    for k in range(D[CLOCKS]):
        S[D[F_CLK] + k * L + lane] = clock[k]
    for k in range(D[MODES]):
        S[D[F_MODE] + k * L + lane] = mode[k]
    for k in range(D[FLAGS]):
        S[D[F_B] + k * L + lane] = -1.0 if side[k] < 0.0 and k < D[SIGNS] else 1.0
        if D[F_ON] >= 0:
            S[D[F_ON] + k * L + lane] = 1.0 if side[k] == 0.0 else 0.0
    end = period
    for k in range(D[BREAKS]):
        instant = S[D[F_C] + (D[BREAK_AT] + k) * L + lane]
        if instant > t + 1e-12 * period and instant < end and instant < period * (1.0 - 1e-12):
            end = instant
    S[D[F_TEND] + lane] = end


@njit(boolean(int64, int64, f1, i1), **OPTIONS)
def is_now(lane, k, S, D):
    """Whether an impulse comes at the present instant; the end of a period is the instant 0 of the next."""
    L = D[LANES]
    t, period = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * L + lane]
    away = abs(t - S[D[F_C] + (D[BREAK_AT] + D[BREAKS] - D[IMPULSES] + k) * L + lane])
    return min(away, abs(period - away)) <= 1e-12 * period


@njit(float64(int64, int64, f1, i1), **OPTIONS)
def jump_of(lane, j, S, D):
    """Jump of the velocity of coordinate j at the present instant."""
    L, J = D[LANES], D[COORDINATES]
    jump = 0.0
    for k in range(D[IMPULSES]):
        if is_now(lane, k, S, D):
            jump += S[D[F_C] + (D[BREAK_AT] + D[BREAKS] + k * J + j) * L + lane]
    return jump


@njit(boolean(int64, f1, i1), **OPTIONS)
def is_thrown(lane, S, D):
    """Whether a velocity jumps at the present instant: that of a coordinate, or of what a contact rubs on."""
    thrown = False
    for k in range(D[IMPULSES]):
        thrown = thrown or is_now(lane, k, S, D)
    return thrown


@njit(void(int64, f1, f1, i1), **OPTIONS)
def apply_jump(lane, S, row, D):
    """An impulse: velocities jump; the law of a single contact that remembers until v passes zero forgets."""
    L = D[LANES]
    before = S[D[F_Y] + lane]
    for j in range(D[COORDINATES]):
        S[D[F_Y] + j * L + lane] += jump_of(lane, j, S, D)
    if D[MODES] > 0 and D[SET_VALUED] == 0 and before * S[D[F_Y] + lane] < 0.0:
        y, clock, mode = np.empty(D[STATES]), np.empty(D[CLOCKS]), np.empty(D[MODES])
        for i in range(D[STATES]):
            y[i] = S[D[F_Y] + i * L + lane]
        for k in range(D[MODES]):
            mode[k] = S[D[F_MODE] + k * L + lane]
        call_look(D[AT_LOOK], CLOCK_SIGNS, row, S[D[F_T] + lane], y, clock, mode, clock)
        call_look(D[AT_LOOK], PASSED_REST, row, S[D[F_T] + lane], y, clock, mode, clock)
        for i in range(1, D[STATES]):
            S[D[F_Y] + i * L + lane] = y[i]
        for k in range(D[MODES]):
            S[D[F_MODE] + k * L + lane] = mode[k]


@njit(float64(int64, f1, i1), **OPTIONS)
def way_of(lane, S, D):
    """Position of the body; of several that of their centre of mass, the first one's and a share of each other position."""
    L = D[LANES]
    x = S[D[F_X] + lane] if D[CYCLIC] == 1 or D[COORDINATES] == 1 else 0.0
    for k in range(D[SHARES]):
        x += S[D[F_C] + (D[SHARE_AT] + k) * L + lane] * S[D[F_Y] + (D[STATES] - D[PASSIVE] - D[SHARES] + k) * L + lane]
    return x


@njit(void(int64, int64, float64, f1, f1, f1, f1, i1), **OPTIONS)
def look_at(what, lane, t, y, out, S, row, D):
    """One of a law's looks at what a lane holds; its states are put into y."""
    L = D[LANES]
    clock, mode = np.empty(D[CLOCKS]), np.empty(D[MODES])
    for i in range(D[STATES]):
        y[i] = S[D[F_Y] + i * L + lane]
    for k in range(D[CLOCKS]):
        clock[k] = S[D[F_CLK] + k * L + lane]
    for k in range(D[MODES]):
        mode[k] = S[D[F_MODE] + k * L + lane]
    call_look(D[AT_LOOK], what, row, t, y, clock, mode, out)


@njit(void(int64, float64, f1, f1, f1, i1), **OPTIONS)
def rates_now(lane, t, out, S, row, D):
    """Rates of what the passive states are changes of, as a lane holds its modes and clocks."""
    look_at(RATES, lane, t, np.empty(D[STATES]), out, S, row, D)


@njit(void(int64, f1, f1, i1), **OPTIONS)
def settle_changes(lane, S, row, D):
    """At the start: what rests has no other change of its velocity than what it rests on."""
    y, n = np.empty(D[STATES]), D[STATES] - D[PASSIVE]
    look_at(RESTING_CHANGES, lane, S[D[F_T] + lane], y, y, S, row, D)
    for i in range(n, D[STATES]):
        S[D[F_Y] + i * D[LANES] + lane] = y[i]


@njit(void(int64, boolean, boolean, f1, f1, f1, i1), **OPTIONS)
def shift_changes(lane, within, first, before, S, row, D):
    """What a known instant does to the changes of the states: they get its own change times what the rates jump by, and the kick's.

    Instants that fall together and part along the direction have no one change: then there is none of the states either.
    """
    L, J = D[LANES], D[COORDINATES]
    t, period, n = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * L + lane], D[STATES] - D[PASSIVE]
    late, met, kicks = 0.0, False, np.zeros(J)
    for k in range(D[BREAKS]):
        away = abs(t - S[D[F_C] + (D[BREAK_AT] + k) * L + lane])
        if min(away, abs(period - away)) > 1e-12 * period:
            continue
        own = S[D[F_C] + (D[DELAY_AT] + k) * L + lane]
        late = own if not met or abs(own - late) <= 1e-9 * (abs(own) + abs(late)) else math.nan
        met = True
        i = k - D[BREAKS] + D[IMPULSES]
        for j in range(J if i >= 0 else 0):
            kicks[j] += S[D[F_C] + (D[DELAY_AT] + D[BREAKS] + i * J + j) * L + lane]
    S[D[F_Y] + (n + D[CARRIED]) * L + lane] = late
    if not met:  # the end of a period, which no direction moves
        return
    if D[MODES] > 0 and D[SET_VALUED] == 0 and (late != 0.0 or np.any(kicks != 0.0)):
        late = math.nan  # what a law forgets at an impulse that is moved itself is not followed
    after, held = np.empty(D[CARRIED]), S[D[F_T] + lane]
    if not within:
        S[D[F_T] + lane] = 0.0
    set_flags(lane, S, row, first, D)
    rates_now(lane, S[D[F_T] + lane], after, S, row, D)
    S[D[F_T] + lane] = held
    for i in range(D[CARRIED]):
        kick = kicks[i] if i < J else 0.0
        S[D[F_Y] + (n + i) * L + lane] += kick - (after[i] - before[i]) * late
