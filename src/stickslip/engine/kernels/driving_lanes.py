"""How lanes are filled, stepped, watched and emptied: the driver's last part; engine/driver.py puts the others before it."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A lane holds one case: its step's state in S (a field of a lane at S[D[F_...] + lane]; these offsets are multiples of the number
# of lanes L), whole numbers in N[lane], floats in K[lane], the last strobe states in RING[lane]. When its case is finished, the
# lane takes the next one. CURSOR = (next case, end of cases). Everything a lane knows is in these arrays, so the kernel
# can return after any number of calls and go on later with the same bits. CURSOR[2] counts pieces, CURSOR[3] says if all are wanted.

# A lane steps to the next known instant (an impulse or a break of the drive, at the latest the end of the period), where
# this happens in this order: the period ends, v jumps, the strobe state is taken, flags and modes are set anew.


@njit(void(int64, int64, f1, i2, f2, f2, f2, i1), **ALLOCATING)
def take(lane, case, S, N, K, PARAM, START, D):
    """Put a case into a lane."""
    L = D[LANES]
    c = np.empty(D[CONSTANTS])
    call_prelude(D[AT_PRELUDE], PARAM[case], c)
    for j in range(D[CONSTANTS]):
        S[D[F_C] + j * L + lane] = c[j]
    for f in range(D[FIELDS] - D[CONSTANTS]):
        S[f * L + lane] = 0.0
    period = c[D[PERIOD]]
    if D[F_H] >= 0:
        S[D[F_H] + lane] = 1e-3 * period
        S[D[F_LE] + lane] = -2.0
        S[D[F_LH] + lane] = math.log2(1e-3 * period)
        S[D[F_GROW] + lane] = 1.4
    if D[F_LOOKED] >= 0:
        S[D[F_LOOKED] + lane] = D[ARMS]
    if D[F_HIGH] >= 0:
        S[D[F_HIGH] + lane], S[D[F_LOW] + lane] = -math.inf, math.inf
    S[D[F_X] + lane] = START[case, 0]
    for i in range(D[STATES]):
        S[D[F_Y] + i * L + lane] = START[case, 1 + i]
    for k in range(D[KEPT_MODES]):
        S[D[F_MODE] + k * L + lane] = START[case, 1 + D[STATES] + k]
    set_flags(lane, S, PARAM[case], D[SET_VALUED] == 1, D)
    if D[CARRIED] > 0 and D[SET_VALUED] == 1:
        call_settle_changes(D[AT_SETTLE_CHANGES], lane, S, PARAM[case], D)
    for j in range(N.shape[1]):
        N[lane, j] = 0
    for j in range(K.shape[1]):
        K[lane, j] = 0.0
    K[lane, PART], K[lane, BEFORE] = -1.0, math.nan
    K[lane, LIMIT], K[lane, WIDE_MAX], K[lane, WIDE_MIN] = math.nan, -math.inf, math.inf
    N[lane, CASE] = case


@njit(void(int64, float64, f1, i2, f2, f2, f2, b2, i1), **OPTIONS)
def pass_instant(lane, slip_ratio, S, N, K, PARAM, SEGT, SEGC, D):
    """At a known instant: what was observed ends before an impulse, and begins anew after it."""
    if not is_thrown(lane, S, D):
        if N[lane, RECORDING] == 1 and N[lane, FRESH] == 1 and D[SIGNALS] == 0:
            K[lane, BEFORE] = rate_before(lane, S, D)
        return
    if N[lane, RECORDING] == 1 and N[lane, FRESH] == 1:
        observe(lane, 0.0, K[lane, RQ], slip_ratio, S[D[F_C] + D[PERIOD] * D[LANES] + lane], N, K, SEGT, SEGC, D)
    apply_jump(lane, S, PARAM[N[lane, CASE]], D)
    if N[lane, RECORDING] == 1:
        v = S[D[F_Y] + lane]
        N[lane, FRESH] = 2
        K[lane, TP], K[lane, VP] = S[D[F_T] + lane], v
        K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], v), min(K[lane, VMIN], v)


@njit(void(int64, float64, boolean, boolean, f1, i2, f2, f2, f2, b2, i1), **ALLOCATING)
def carry_through(lane, slip_ratio, within, first, S, N, K, PARAM, SEGT, SEGC, D):
    """The same with passive states that are changes of others: their part depends on the rates before and after."""
    before, kicks, row = np.empty(D[CARRIED]), np.zeros(D[COORDINATES]), PARAM[N[lane, CASE]]
    call_rates_now(D[AT_RATES_NOW], lane, S[D[F_T] + lane], before, S, row, D)
    moves = call_note_late(D[AT_NOTE_LATE], lane, kicks, S, D)
    pass_instant(lane, slip_ratio, S, N, K, PARAM, SEGT, SEGC, D)
    if moves:  # no direction moves the end of a period
        call_shift_changes(D[AT_SHIFT_CHANGES], lane, within, first, before, kicks, S, row, D)


@njit(void(int64, f1, i2, f2, f3, f3, f2, i2, f3, i1), **OPTIONS)
def finish(lane, S, N, K, RING, FOUND, OUT, COUNT, NOTED, D):
    """Write a case's results."""
    L = D[LANES]
    case = N[lane, CASE]
    OUT[case, 0] = K[lane, DISPLACEMENT]
    OUT[case, 1] = K[lane, WINDOW]
    OUT[case, 2] = K[lane, VMAX]
    OUT[case, 3] = K[lane, VMIN]
    good = N[lane, STATUS] == FINISHED or N[lane, STATUS] == REPEATS
    OUT[case, 4] = K[lane, WORK] / K[lane, LASTED] if D[OFFERED] == 1 and K[lane, LASTED] > 0.0 else np.nan
    OUT[case, 5] = RING[lane, N[lane, DONE] % KEPT, 0] if good else way_of(lane, S, D)
    for i in range(D[STATES]):
        OUT[case, 6 + i] = RING[lane, N[lane, DONE] % KEPT, 1 + i] if good else S[D[F_Y] + i * L + lane]
    for k in range(D[KEPT_MODES]):
        OUT[case, 6 + D[STATES] + k] = RING[lane, N[lane, DONE] % KEPT, 1 + D[STATES] + k] if good else S[D[F_MODE] + k * L + lane]
    more = 6 + D[STATES] + D[KEPT_MODES]
    if D[F_HIGH] >= 0:
        K[lane, WIDE_MAX], K[lane, WIDE_MIN] = S[D[F_HIGH] + lane], S[D[F_LOW] + lane]
    OUT[case, more] = K[lane, LIMIT] if good else np.nan
    OUT[case, more + 1], OUT[case, more + 2] = max(K[lane, WIDE_MAX], K[lane, VMAX]), min(K[lane, WIDE_MIN], K[lane, VMIN])
    COUNT[case, 0] = N[lane, STATUS]
    COUNT[case, 1] = N[lane, NUMBER]
    COUNT[case, 2] = N[lane, DONE]
    COUNT[case, 3] = np.int64(S[D[F_NACC] + lane])
    COUNT[case, 4] = np.int64(S[D[F_NREJ] + lane])
    for i in range(SEGMENTS, N.shape[1]):
        COUNT[case, 5 + i - SEGMENTS] = N[lane, i]
    if D[SIGNALS] > 0:
        call_note_parts(D[AT_NOTE_PARTS], lane, case, S, FOUND, NOTED, D)
    N[lane, CASE], N[lane, RECORDING] = -1, 0


@njit(void(int64, f1, i1), **OPTIONS)
def want_extremes(lane, S, D):
    """From here on steps that find their extremes look for them."""
    if D[F_TOP] >= 0 and D[F_LOOKED] >= 0:
        S[D[F_LOOKED] + lane] = max(S[D[F_LOOKED] + lane], 0.25)


@njit(float64(int64, int64, f1, i1), **OPTIONS)
def scale_of(lane, i, S, D):
    """How large a state typically is: a velocity without friction, an inner state as the law says or as it has been."""
    L = D[LANES]
    if i < D[COORDINATES]:
        size = S[D[F_C] + D[FREE] * L + lane]
    elif D[SCALE_AT + i] >= 0:
        size = S[D[F_C] + D[SCALE_AT + i] * L + lane]
    else:
        size = S[D[F_M] + (i - 1) * L + lane]
    return max(size, 1e-300)


@njit(int64(int64, int64, float64, int64, int64, int64, float64, f1, i2, f2, f3, f3, f3, f2, i1), **ALLOCATING)
def judge_period(lane, k, x, periods, settle, auto, rtol, S, N, K, RING, XS, FOUND, OUT, D):
    """Whether the motion repeats, at the end of a period after which that is asked."""
    L = D[LANES]
    scale = np.empty(D[STATES] - D[PASSIVE])
    for i in range(len(scale)):
        scale[i] = scale_of(lane, i, S, D)
    count = min(k - 1, KEPT - 1)  # the start is not among them
    if N[lane, TARGET] > 0:
        if auto and N[lane, NUMBER] > 0:
            K[lane, DISPLACEMENT] = x - XS[lane, LONGEST, 0]
            keep_moved(lane, LONGEST, S, N, XS, OUT, D)
            K[lane, WINDOW] = N[lane, NUMBER]
            K[lane, LIMIT] = outcome(RING[lane], k, count, LONGEST, scale, 10.0 * rtol, 3.0 * rtol)[1]
        return 1
    if auto and k < periods:
        p, m = period_number(RING[lane], k, count, LONGEST, scale, 10.0 * rtol, 3.0 * rtol)
        if p > 0:
            moved = (x - RING[lane, (k - p) % KEPT, 0]) / p
            free = scale[0] * S[D[F_C] + D[PERIOD] * L + lane]
            if steady(moved, limit(RING[lane], k, p, m, scale, True), free, max(STEADY, rtol)):
                N[lane, NUMBER] = p
                N[lane, STATUS] = REPEATS
                N[lane, TARGET] = k + p
                keep_places(lane, LONGEST, S, XS, D)
                begin_record(lane, N, K, FOUND, S, D)
        return 0
    p, K[lane, LIMIT] = outcome(RING[lane], k, count, LONGEST, scale, 30.0 * rtol, 30.0 * rtol)
    N[lane, NUMBER] = p
    whole = max(p, 1)
    first = (periods - settle) % whole
    if auto or first >= LONGEST or first >= periods - settle:
        first = 0
    K[lane, DISPLACEMENT] = x - XS[lane, first, 0]
    keep_moved(lane, first, S, N, XS, OUT, D)
    K[lane, WINDOW] = periods - settle - first
    if p <= 1 and not auto:
        return 1
    N[lane, TARGET] = k + whole
    keep_places(lane, LONGEST, S, XS, D)
    begin_record(lane, N, K, FOUND, S, D)
    return 0


@njit(float64(int64, int64, f1), **OPTIONS)
def held(lane, field, S):
    """What a lane has in a field; 0 if this kind of step has no such field."""
    return S[field + lane] if field >= 0 else 0.0


@njit(void(int64, f1, f1, i1), **OPTIONS)
def keep_beside(lane, row, S, D):
    """Of a strobe point, what a step takes from the one before besides the states: its length, its sort, sides and modes."""
    L, at = D[LANES], 1 + D[STATES] + D[KEPT_MODES]
    row[at], row[at + 1], row[at + 2] = held(lane, D[F_H], S), held(lane, D[F_LE], S), held(lane, D[F_LH], S)
    row[at + 3], row[at + 4], row[at + 5] = held(lane, D[F_GROW], S), held(lane, D[F_LIM], S), held(lane, D[F_SORT], S)
    row[at + 6] = row[at + 7] = 0.0
    for k in range(D[FLAGS]):
        row[at + 6] = 2.0 * row[at + 6] + S[D[F_B] + k * L + lane]
    for k in range(D[MODES]):
        row[at + 7] = 3.0 * row[at + 7] + S[D[F_MODE] + k * L + lane]


@njit(int64(int64, int64, f3, i1), **OPTIONS)
def seen_before(lane, k, RING, D):
    """After how many periods the last strobe point is the same to the last bit, so that all that follows is known; 0: it is new."""
    if D[SAMPLE_AT] >= 0:
        return 0
    new = RING[lane, k % KEPT]
    for p in range(1, min(k, LONGEST + 1)):
        old, i = RING[lane, (k - p) % KEPT], 1
        while i < RING.shape[2] and new[i] == old[i]:
            i += 1
        if i == RING.shape[2]:
            return p
    return 0


@njit(void(int64, int64, int64, int64, int64, f1, i2, f3, f3, i1), **OPTIONS)
def skip(lane, p, periods, settle, k, S, N, RING, XS, D):
    """Go on behind all whole multiples of p periods before the last period: they are what the last p were."""
    end = k + (periods - 1 - k) // p * p
    if (D[PLACES] > 1 and p > 1) or end <= k:
        return
    begun = RING[lane, k % KEPT, 0]
    moved = begun - RING[lane, (k - p) % KEPT, 0]
    for n in range(k + 1, end + 1):
        row, old = RING[lane, n % KEPT], RING[lane, (n - p) % KEPT]
        for i in range(RING.shape[2]):
            row[i] = old[i]
        row[0] = old[0] + moved
        if n >= settle and n < settle + LONGEST:
            for place in range(D[PLACES]):
                XS[lane, n - settle, place] = row[0] + (place_of(lane, place, S, D) - begun)
        if n == settle:
            want_extremes(lane, S, D)
    S[D[F_X] + lane] += RING[lane, end % KEPT, 0] - begun
    N[lane, DONE] = end


@njit(int64(int64, int64, int64, int64, float64, f1, i2, f2, f3, f3, f3, f2, i1), **OPTIONS)
def end_period(lane, periods, settle, auto, rtol, S, N, K, RING, XS, FOUND, OUT, D):
    """Book-keeping at the end of a drive period. Returns 1 when only the last observation is missing."""
    L = D[LANES]
    N[lane, DONE] += 1
    k = N[lane, DONE]
    x = way_of(lane, S, D)
    row = RING[lane, k % KEPT]
    row[0] = x
    for i in range(D[STATES]):
        row[1 + i] = S[D[F_Y] + i * L + lane]
    for m in range(D[KEPT_MODES]):
        row[1 + D[STATES] + m] = S[D[F_MODE] + m * L + lane]
    keep_beside(lane, row, S, D)
    if k == settle:
        want_extremes(lane, S, D)
    if k >= settle and k < settle + LONGEST:
        keep_places(lane, k - settle, S, XS, D)
    if k < periods - 1 and not auto and N[lane, TARGET] == 0 and N[lane, WHOLE] == 0:
        p = seen_before(lane, k, RING, D)
        if p > 0:
            skip(lane, p, periods, settle, k, S, N, RING, XS, D)
            k = N[lane, DONE]
    if k == periods - 1 and not auto and N[lane, TARGET] == 0:
        begin_record(lane, N, K, FOUND, S, D)
    if (N[lane, TARGET] > 0 and k < N[lane, TARGET]) or (N[lane, TARGET] == 0 and not auto and k < periods):
        return 0
    return judge_period(lane, k, x, periods, settle, auto, rtol, S, N, K, RING, XS, FOUND, OUT, D)


@njit(boolean(int64, int64, int64, int64, f1, i2, f2, f3, f2, f3, i1, f2, f2, i1), **OPTIONS)
def next_case(lane, periods, settle, auto, S, N, K, XS, HELD, FOUND, CURSOR, PARAM, START, D):
    """Put the next case into an idle lane, if there is one."""
    if CURSOR[0] >= CURSOR[1]:
        return False
    take(lane, CURSOR[0], S, N, K, PARAM, START, D)
    CURSOR[0] += 1
    N[lane, WHOLE] = CURSOR[3]
    keep_places(lane, 0, S, XS, D)
    if settle == 0:
        want_extremes(lane, S, D)
    if D[SIGNALS] > 0:
        call_begin_parts(D[AT_BEGIN_PARTS], lane, S, HELD, FOUND, D)
    if periods == 1 and not auto:
        begin_record(lane, N, K, FOUND, S, D)
    return True


@njit(boolean(f1, i1), **OPTIONS)
def is_piece(S, D):
    """Whether the last step took some time, or switched at one instant what is kept with a piece."""
    piece = S[D[F_T]] != S[D[F_T0]]
    if D[SET_VALUED] == 1:
        for i in range(D[CONTACTS]):
            piece = piece or S[D[F_SIDE] + i] != S[D[F_MODE] + i]
    return piece


@njit(void(f1, i2, i1, f2, i1), **OPTIONS)
def keep_piece(S, N, CURSOR, PIECES, D):
    """Write the last step's dense output, in powers of its own part of the step."""
    n = CURSOR[2]
    begin, end = S[D[F_T0]], S[D[F_T]]
    PIECES[n, 0], PIECES[n, 1], PIECES[n, 2], PIECES[n, 3] = N[0, DONE], begin, end, S[D[F_X0]]
    for i in range(D[CONTACTS]):
        PIECES[n, 4 + i] = S[D[F_SIDE] + i]
    first = 4 + D[CONTACTS] + D[KEPT_MODES]
    part, power = (end - begin) / S[D[F_HH]], 1.0
    if S[D[F_STAT]] == 1.0:
        part = 1.0
    for k in range(D[KEPT_MODES]):
        PIECES[n, 4 + D[CONTACTS] + k] = S[D[F_HELD] + k]
    for m in range(D[DEGREE] + 1):
        for i in range(D[STATES]):
            PIECES[n, first + i * (D[DEGREE] + 1) + m] = S[D[F_K] + i * (D[DEGREE] + 1) + m] * power
        power *= part
    CURSOR[2] += 1


@njit(void(int64, float64, f1, i2, f2, f2, f3, f2, f2, f2, b2, i1), **OPTIONS)
def watch(lane, slip_ratio, S, N, K, HELD, FOUND, ROOM, PARAM, SEGT, SEGC, D):
    """Note what the last step of a recording lane did; status 7 when the last observation is made."""
    if D[SIGNALS] > 0:
        if N[lane, CLOSING] == 1:
            S[D[F_STAT] + lane] = 7.0
        elif S[D[F_T] + lane] != S[D[F_T0] + lane]:
            call_reduce_step(D[AT_REDUCE_STEP], lane, slip_ratio, S, PARAM[N[lane, CASE]], N, HELD, FOUND, ROOM, SEGT, SEGC, D)
        call_hold(D[AT_HOLD], lane, S, HELD, D)
        return
    if D[OFFERED] == 1 and N[lane, CLOSING] == 0 and S[D[F_T] + lane] != S[D[F_T0] + lane]:
        K[lane, WORK] += call_work(D[AT_WORK], lane, S, PARAM[N[lane, CASE]])
        K[lane, LASTED] += S[D[F_T] + lane] - S[D[F_T0] + lane]
    if D[F_TOP] >= 0 and N[lane, CLOSING] == 0:
        K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], S[D[F_TOP] + lane]), min(K[lane, VMIN], S[D[F_TOP] + lane])
    if N[lane, FRESH] > 0:
        period = S[D[F_C] + D[PERIOD] * D[LANES] + lane]
        observe(lane, S[D[F_ACC] + lane], S[D[F_RATIO] + lane], slip_ratio, period, N, K, SEGT, SEGC, D)
        if N[lane, CLOSING] == 1:
            S[D[F_STAT] + lane] = 7.0
            return
    if D[F_TOP] >= 0 and D[SET_VALUED] == 0 and S[D[F_HH] + lane] > 0.0:
        if D[F_TAIL] < 0 or (S[D[F_TAIL] + lane] >= slip_ratio) != (S[D[F_RATIO] + lane] >= slip_ratio):
            K[lane, PART] = turned(lane, slip_ratio, S, D)
        else:
            K[lane, PART] = -1.0
    if S[D[F_T] + lane] != K[lane, TP] or S[D[F_SIGN] + lane] != K[lane, BP]:
        K[lane, TP], K[lane, VP], K[lane, BP] = S[D[F_T] + lane], S[D[F_Y] + lane], S[D[F_SIGN] + lane]
        N[lane, FRESH] = 1


@njit(void(int64, int64, int64, int64, float64, float64, f1, i2, f2, f3, f3, f2, f3, f2, f2, f2, b2, i1), **OPTIONS)
def arrive(lane, periods, settle, auto, rtol, slip_ratio, S, N, K, RING, XS, HELD, FOUND, PARAM, OUT, SEGT, SEGC, D):
    """At a known instant, the end of the period or one within it: impulse, strobe state, flags for the steps that follow."""
    jumped, within, done = False, False, 0
    known = D[BREAKS] > 0 or D[SAMPLE_AT] >= 0
    if known:
        jumped = is_thrown(lane, S, D)
        within = S[D[F_T] + lane] < S[D[F_C] + D[PERIOD] * D[LANES] + lane]
        if D[CARRIED] > 0:
            carry_through(lane, slip_ratio, within, D[SET_VALUED] == 1 and jumped, S, N, K, PARAM, SEGT, SEGC, D)
        else:
            pass_instant(lane, slip_ratio, S, N, K, PARAM, SEGT, SEGC, D)
    if not within:
        done = end_period(lane, periods, settle, auto, rtol, S, N, K, RING, XS, FOUND, OUT, D)
        S[D[F_T] + lane] = 0.0
    if known:
        set_flags(lane, S, PARAM[N[lane, CASE]], D[SET_VALUED] == 1 and jumped, D)
        if N[lane, FRESH] == 2:
            K[lane, VP], K[lane, BP] = S[D[F_Y] + lane], S[D[F_SIGN] + lane]
    if not within:
        if N[lane, FRESH] == 2:
            K[lane, TP] = 0.0
        if done == 1:
            N[lane, CLOSING] = 1
    if D[SIGNALS] > 0:
        call_hold(D[AT_HOLD], lane, S, HELD, D)


@njit(void(int64, int64, f1, i2, f2, f2, f2, f2, i1), **OPTIONS)
def widen(lane, settle, S, N, K, HELD, ROOM, PARAM, D):
    """Widen the extremes over the window by the last step, if it did not do so itself."""
    if N[lane, DONE] < settle or D[F_HIGH] >= 0:
        return
    v = S[D[F_Y] + lane]
    K[lane, WIDE_MAX], K[lane, WIDE_MIN] = max(K[lane, WIDE_MAX], v), min(K[lane, WIDE_MIN], v)
    if D[SIGNALS] > 0 and D[ARMS] == 1:
        call_widen(D[AT_WIDEN], lane, S, PARAM[max(N[lane, CASE], 0)], HELD, ROOM, D)
        call_hold(D[AT_HOLD], lane, S, HELD, D)
    elif D[F_TOP] >= 0:  # the extremum within the step
        v = S[D[F_TOP] + lane]
        K[lane, WIDE_MAX], K[lane, WIDE_MIN] = max(K[lane, WIDE_MAX], v), min(K[lane, WIDE_MIN], v)


@njit(boolean(int64, int64, int64, int64, float64, float64, f1, i2, f2, f3, f3, f2, f3, f2, i1, f2, f2, f2, i2, f3, f2, b2, i1), **OPTIONS)
def go_on(
    lane, periods, settle, auto, rtol, slip_ratio, S, N, K, RING, XS, HELD, FOUND, ROOM, CURSOR, PARAM, START, OUT, COUNT, NOTED, SEGT,
    SEGC, D,
):  # fmt: skip
    """After a step at whose end something is known of a lane: on to the next period or case. Returns whether there is one."""
    stat = S[D[F_STAT] + lane]
    S[D[F_STAT] + lane] = 0.0
    if stat == 1.0:
        arrive(lane, periods, settle, auto, rtol, slip_ratio, S, N, K, RING, XS, HELD, FOUND, PARAM, OUT, SEGT, SEGC, D)
        return True
    if stat != 7.0:
        N[lane, STATUS] = np.int64(stat)
        for i in range(SEGMENTS, N.shape[1]):
            N[lane, i] = 0
    finish(lane, S, N, K, RING, FOUND, OUT, COUNT, NOTED, D)
    if next_case(lane, periods, settle, auto, S, N, K, XS, HELD, FOUND, CURSOR, PARAM, START, D):
        return True
    S[D[F_TEND] + lane] = 1e30
    return False


@njit(
    int64(f1, i2, f2, f3, f3, f2, f3, f2, i1, f2, f2, f2, i2, f3, f2, b2, f2, int64, int64, int64, float64, float64, float64, int64, i1),
    **CALLED, **BORROWING,
)  # fmt: skip
def advance(
    S, N, K, RING, XS, HELD, FOUND, ROOM, CURSOR, PARAM, START, OUT, COUNT, NOTED, SEGT, SEGC, PIECES, periods, settle, auto, rtol,
    slip_ratio, budget, calls, D,
):  # fmt: skip
    """Up to `calls` vector steps. Returns the number of lanes at work; CURSOR[2] counts the pieces written."""
    L = D[LANES]
    active = 0
    recording = 0
    pieces_wanted = PIECES.shape[0] > 0
    for lane in range(L):
        if N[lane, CASE] >= 0 or next_case(lane, periods, settle, auto, S, N, K, XS, HELD, FOUND, CURSOR, PARAM, START, D):
            active += 1
            recording += N[lane, RECORDING]
    for _ in range(calls):
        if active == 0:
            return 0
        if pieces_wanted and CURSOR[2] >= PIECES.shape[0]:
            return active
        call_step(D[AT_STEP], S, rtol, budget)
        if D[SET_VALUED] == 1:
            call_land(D[AT_LAND], S, budget, D)
        if pieces_wanted and is_piece(S, D):
            keep_piece(S, N, CURSOR, PIECES, D)
        if recording > 0:
            for lane in range(L):
                if N[lane, RECORDING] == 1:
                    watch(lane, slip_ratio, S, N, K, HELD, FOUND, ROOM, PARAM, SEGT, SEGC, D)
        if D[SIGNALS] > 0 and D[ARMS] == 0:
            call_widen_all(D[AT_WIDEN_ALL], settle, S, N, D)
        for lane in range(L):
            widen(lane, settle, S, N, K, HELD, ROOM, PARAM, D)
            if S[D[F_STAT] + lane] < 0.5:
                continue
            if N[lane, CASE] < 0:
                S[D[F_STAT] + lane] = 0.0
                S[D[F_NACC] + lane] = 0.0
                S[D[F_NREJ] + lane] = 0.0
                S[D[F_TEND] + lane] = 1e30
                continue
            was = N[lane, RECORDING]
            if not go_on(
                lane, periods, settle, auto, rtol, slip_ratio, S, N, K, RING, XS, HELD, FOUND, ROOM, CURSOR, PARAM, START, OUT, COUNT,
                NOTED, SEGT, SEGC, D,
            ):  # fmt: skip
                active -= 1
            recording += N[lane, RECORDING] - was
    return active
