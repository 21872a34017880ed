"""What a lane holds while it steps: columns of its arrays, flags, modes, and the known instants; text before watching.py."""
# ruff: noqa: F821
# mypy: ignore-errors

# columns of N (lane): case (-1 idle), periods done, recording, last period to do, period number, fresh point, closing, status
CASE, DONE, RECORDING, TARGET, NUMBER, FRESH, CLOSING, STATUS, SEGMENTS = range(9)
# columns of K (lane): the last two observed points, window, work of friction while recording and how long
TQ, VQ, AQ, RQ, BQ, TP, VP, BP, VMAX, VMIN, XBEGIN, DISPLACEMENT, WINDOW, WORK, LASTED = range(15)
KEPT = 16  # strobe positions kept after settling, and the largest period number looked for
RINGS = 34
SEGS = 32
FINISHED, REPEATED = 0, 1


@njit("void(int64, float64[::1], float64[::1], boolean)", **OPTIONS)
def set_flags(lane, S, row, first):
    """Everything that a step holds, from the lane's time and state; with `first` the modes too. Then the end of the next steps."""
    t, period = S[F_T + lane], S[F_C + PERIOD * L + lane]
    y, clock, mode, side = np.empty(STATES), np.empty(CLOCKS), np.empty(MODES), np.empty(GUARDS)
    for i in range(STATES):
        y[i] = S[F_Y + i * L + lane]
    for k in range(MODES):
        mode[k] = S[F_MODE + k * L + lane]
    clocks(row, t + 1e-13 * period, clock)
    if first:
        modes(row, t, y, clock, mode)
    sides(row, t, y, clock, mode, side)
    for k in range(CLOCKS):
        S[F_CLK + k * L + lane] = clock[k]
    for k in range(MODES):
        S[F_MODE + k * L + lane] = mode[k]
    for k in range(FLAGS):
        S[F_B + k * L + lane] = -1.0 if side[k] < 0.0 and k < SIGNS else 1.0
        if F_ON >= 0:
            S[F_ON + k * L + lane] = 1.0 if side[k] == 0.0 else 0.0
    end = period
    for k in range(BREAKS):
        instant = S[F_C + (BREAK_AT + k) * L + lane]
        if instant > t + 1e-12 * period and instant < end and instant < period * (1.0 - 1e-12):
            end = instant
    S[F_TEND + lane] = end


@njit("float64(int64, float64[::1])", **OPTIONS)
def jump_of(lane, S):
    """Jump of v at the present instant; the end of a period is the instant 0 of the next."""
    t, period = S[F_T + lane], S[F_C + PERIOD * L + lane]
    jump = 0.0
    for k in range(IMPULSES):
        instant = S[F_C + (BREAK_AT + CLOCKS + k) * L + lane]
        away = abs(t - instant)
        if min(away, abs(period - away)) <= 1e-12 * period:
            jump += S[F_C + (BREAK_AT + BREAKS + k) * L + lane]
    return jump


@njit("void(int64, float64[::1], float64[::1], float64)", **OPTIONS)
def apply_jump(lane, S, row, jump):
    """An impulse: v jumps; a law that remembers until v passes zero forgets."""
    before = S[F_Y + lane]
    S[F_Y + lane] = before + jump
    if MODES > 0 and not SET_VALUED and before * (before + jump) < 0.0:
        y, clock, mode = np.empty(STATES), np.empty(CLOCKS), np.empty(MODES)
        for i in range(STATES):
            y[i] = S[F_Y + i * L + lane]
        for k in range(MODES):
            mode[k] = S[F_MODE + k * L + lane]
        clocks(row, S[F_T + lane], clock)
        at_rest(row, S[F_T + lane], y, clock, mode)
        for i in range(1, STATES):
            S[F_Y + i * L + lane] = y[i]
        for k in range(MODES):
            S[F_MODE + k * L + lane] = mode[k]
