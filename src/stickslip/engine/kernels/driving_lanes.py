"""How lanes are filled, stepped, watched and emptied: the driver's last part; engine/driver.py puts the others before it."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A lane holds one case: its step's state in S (a field of a lane at S[D[F_...] + lane]; these offsets are multiples of the number
# of lanes L), whole numbers in N[lane], floats in K[lane], the last strobe states in RING[lane]. When its case is finished, the
# lane takes the next one. Everything a lane knows is in the arrays that `SHARED` in engine/driver.py lists, so the kernel can return after
# any number of calls and go on later with the same bits. Functions are told where these arrays are by one number, W.

# A lane steps to the next known instant (an impulse or a break of the drive, at the latest the end of the period), where
# this happens in this order: the period ends, v jumps, the strobe state is taken, flags and modes are set anew.

STEPS_TO_LOOK = 10_000.0  # after which a step ends with the status BUDGET, and the progress of the case is looked at
AGAIN_WITHIN, AGAIN_TO = 4, 1e-8  # periods after which one is looked for that was the same, and how nearly, in scales of the states
LEAST_PROGRESS = 1e-5  # of a period, in so many steps: at this pace a period would take 1e9 steps
LAST_STEPS = 1000.0  # that a case makes when its budget is used up, whose changes of modes are counted


@typed(void(int64, f1, i1))
def widen_by_present(lane, S, D):
    """Of steps that find their extremes, which do not know with what they begin: the present velocity counts too."""
    if D[F_HIGH] >= 0 and S[D[F_LOOKED] + lane] > 0.1:
        v = S[D[F_Y] + lane]
        S[D[F_HIGH] + lane], S[D[F_LOW] + lane] = max(S[D[F_HIGH] + lane], v), min(S[D[F_LOW] + lane], v)


@typed(void(int64, int64, f1, int64, i1))
def take(lane, case, S, W, D):
    """Put a case into a lane."""
    N, K, PARAM, START = N_of(W), K_of(W), PARAM_of(W), START_of(W)
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
    K[lane, PART] = -1.0
    K[lane, LIMIT] = math.nan
    N[lane, CASE] = case


@typed(void(int64, f1, int64, i1))
def pass_instant(lane, S, W, D):
    """At a known instant: what was observed ends before an impulse, and begins anew after it."""
    N, K, PARAM = N_of(W), K_of(W), PARAM_of(W)
    if not is_thrown(lane, S, D):
        return
    if N[lane, RECORDING] == 1 and N[lane, FRESH] == 1:
        observe(lane, K[lane, RQ], S[D[F_C] + D[PERIOD] * D[LANES] + lane], W, D)
    apply_jump(lane, S, PARAM[N[lane, CASE]], D)
    widen_by_present(lane, S, D)
    if N[lane, RECORDING] == 1:
        v = S[D[F_Y] + lane]
        N[lane, FRESH] = 2
        K[lane, TP], K[lane, VP] = S[D[F_T] + lane], v
        K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], v), min(K[lane, VMIN], v)


@typed(void(int64, boolean, boolean, f1, int64, i1))
def carry_through(lane, within, first, S, W, D):
    """The same with passive states that are changes of others: their part depends on the rates before and after."""
    N, PARAM = N_of(W), PARAM_of(W)
    before, kicks, row = np.empty(D[CARRIED]), np.zeros(D[COORDINATES]), PARAM[N[lane, CASE]]
    call_rates_now(D[AT_RATES_NOW], lane, S[D[F_T] + lane], before, S, row, D)
    moves = call_note_late(D[AT_NOTE_LATE], lane, kicks, S, D)
    pass_instant(lane, S, W, D)
    if moves:  # no direction moves the end of a period
        call_shift_changes(D[AT_SHIFT_CHANGES], lane, within, first, before, kicks, S, row, D)


@typed(void(int64, f1, int64, i1))
def finish(lane, S, W, D):
    """Write a case's results; of one that ended before its time, in place of what it approaches, how far into the period that was."""
    N, K, RING, OUT, COUNT = N_of(W), K_of(W), RING_of(W), OUT_of(W), COUNT_of(W)
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
    high, low = D[F_HIGH] if D[F_HIGH] >= 0 else wide(0, D), D[F_LOW] if D[F_HIGH] >= 0 else wide(0, D) + D[LANES]
    OUT[case, more] = K[lane, LIMIT] if good else S[D[F_T] + lane]
    OUT[case, more + 1], OUT[case, more + 2] = max(S[high + lane], K[lane, VMAX]), min(S[low + lane], K[lane, VMIN])
    COUNT[case, 0] = N[lane, STATUS]
    COUNT[case, 1] = N[lane, NUMBER]
    COUNT[case, 2] = N[lane, DONE]
    COUNT[case, 3] = N[lane, ACCEPTED] + np.int64(S[D[F_NACC] + lane])
    COUNT[case, 4] = N[lane, REJECTED] + np.int64(S[D[F_NREJ] + lane])
    for i in range(SEGMENTS, N.shape[1]):
        COUNT[case, 5 + i - SEGMENTS] = N[lane, i]
    if D[SIGNALS] > 0:
        call_note_parts(D[AT_NOTE_PARTS], lane, case, S, W, D)
    N[lane, CASE], N[lane, RECORDING], N[lane, COUNTING] = -1, 0, 0


@typed(void(int64, f1, i1))
def want_extremes(lane, S, D):
    """From here on steps that find their extremes look for them."""
    if D[F_TOP] >= 0 and D[F_LOOKED] >= 0:
        S[D[F_LOOKED] + lane] = max(S[D[F_LOOKED] + lane], 0.25)
        widen_by_present(lane, S, D)


@typed(float64(int64, int64, f1, i1))
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


@typed(int64(int64, int64, float64, f1, int64, i1))
def judge_period(lane, k, x, S, W, D):
    """Whether the motion repeats, at the end of a period after which that is asked."""
    N, K, RING, XS, JOB = N_of(W), K_of(W), RING_of(W), XS_of(W), JOB_of(W)
    periods, settle, auto = JOB[PERIODS], JOB[SETTLE], JOB[AUTO]
    rtol = LIMITS_of(W)[RTOL]
    L = D[LANES]
    states = D[STATES] - D[PASSIVE]
    scale = np.empty(2 * states)
    for i in range(states):
        scale[i] = scale_of(lane, i, S, D)
        at = D[SCALE_AT + D[STATES] + i]
        scale[states + i] = S[D[F_C] + at * L + lane] if at >= 0 else 0.0
    count = min(k - 1, KEPT - 1)  # the start is not among them
    if N[lane, TARGET] > 0:
        if auto and N[lane, NUMBER] > 0:
            K[lane, DISPLACEMENT] = x - XS[lane, LONGEST, 0]
            keep_moved(lane, LONGEST, S, W, D)
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
                keep_places(lane, LONGEST, S, W, D)
                begin_record(lane, S, W, D)
        return 0
    p, K[lane, LIMIT] = outcome(RING[lane], k, count, LONGEST, scale, 30.0 * rtol, 30.0 * rtol)
    N[lane, NUMBER] = p
    whole = max(p, 1)
    first = (periods - settle) % whole
    if auto or first >= LONGEST or first >= periods - settle:
        first = 0
    K[lane, DISPLACEMENT] = x - XS[lane, first, 0]
    keep_moved(lane, first, S, W, D)
    K[lane, WINDOW] = periods - settle - first
    if p <= 1 and not auto:
        return 1
    N[lane, TARGET] = k + whole
    keep_places(lane, LONGEST, S, W, D)
    begin_record(lane, S, W, D)
    return 0


@typed(float64(int64, int64, f1))
def held(lane, field, S):
    """What a lane has in a field; 0 if this kind of step has no such field."""
    return S[field + lane] if field >= 0 else 0.0


@typed(void(int64, f1, f1, i1))
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


@typed(int64(int64, int64, int64, i1))
def repeats_exactly(lane, k, W, D):
    """After how many periods the last strobe point is the same to the last bit, so that all that follows is known; 0: it is new."""
    RING = RING_of(W)
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


@typed(void(int64, int64, int64, f1, int64, i1))
def skip(lane, p, k, S, W, D):
    """Go on behind all whole multiples of p periods before the last period: they are what the last p were."""
    N, RING, XS, JOB = N_of(W), RING_of(W), XS_of(W), JOB_of(W)
    periods, settle = JOB[PERIODS], JOB[SETTLE]
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
            for body in range(D[PLACES]):
                XS[lane, n - settle, body] = row[0] + (place_of(lane, body, S, D) - begun)
        if n == settle:
            want_extremes(lane, S, D)
    S[D[F_X] + lane] += RING[lane, end % KEPT, 0] - begun
    N[lane, DONE] = end


@typed(int64(int64, int64, f1, int64, i1))
def is_again(lane, k, S, W, D):
    """Whether the period that begins is one of the window once more, as it begins with the same states: its extremes are known."""
    RING = RING_of(W)
    new = RING[lane, k % KEPT]
    for p in range(1, min(k - JOB_of(W)[SETTLE], AGAIN_WITHIN) + 1):
        old, i = RING[lane, (k - p) % KEPT], 0
        while i < D[STATES] - D[PASSIVE] and abs(new[1 + i] - old[1 + i]) <= AGAIN_TO * scale_of(lane, i, S, D):
            i += 1
        if i == D[STATES] - D[PASSIVE]:
            return 1
    return 0


@typed(int64(int64, f1, int64, i1))
def end_period(lane, S, W, D):
    """Book-keeping at the end of a drive period. Returns 1 when only the last observation is missing."""
    N, RING, JOB = N_of(W), RING_of(W), JOB_of(W)
    periods, settle, auto = JOB[PERIODS], JOB[SETTLE], JOB[AUTO]
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
    if D[F_HIGH] < 0:
        N[lane, AGAIN] = is_again(lane, k, S, W, D)
    if k == settle:
        want_extremes(lane, S, D)
    if k >= settle and k < settle + LONGEST:
        keep_places(lane, k - settle, S, W, D)
    if k < periods - 1 and not auto and N[lane, TARGET] == 0 and JOB[WHOLE] == 0:
        p = repeats_exactly(lane, k, W, D)
        if p > 0:
            skip(lane, p, k, S, W, D)
            k = N[lane, DONE]
    if k == periods - 1 and not auto and N[lane, TARGET] == 0:
        begin_record(lane, S, W, D)
    if (N[lane, TARGET] > 0 and k < N[lane, TARGET]) or (N[lane, TARGET] == 0 and not auto and k < periods):
        return 0
    return judge_period(lane, k, x, S, W, D)


@typed(boolean(int64, f1, int64, i1))
def next_case(lane, S, W, D):
    """Put the next case into an idle lane, if there is one."""
    JOB = JOB_of(W)
    periods, settle, auto = JOB[PERIODS], JOB[SETTLE], JOB[AUTO]
    if JOB[NEXT] >= JOB[END]:
        return False
    take(lane, JOB[NEXT], S, W, D)
    JOB[NEXT] += 1
    keep_places(lane, 0, S, W, D)
    if settle == 0:
        want_extremes(lane, S, D)
    if D[SIGNALS] > 0:
        call_begin_parts(D[AT_BEGIN_PARTS], lane, S, W, D)
    else:
        S[wide(0, D) + lane], S[wide(0, D) + D[LANES] + lane] = -math.inf, math.inf
    if periods == 1 and not auto:
        begin_record(lane, S, W, D)
    return True


@typed(boolean(f1, i1))
def is_piece(S, D):
    """Whether the last step took some time, or switched at one instant what is kept with a piece."""
    piece = S[D[F_T]] != S[D[F_T0]]
    if D[SERIES] == 1:
        for i in range(D[CONTACTS]):
            piece = piece or S[D[F_SIDE] + i] != S[D[F_MODE] + i]
    return piece


@typed(void(f1, int64, i1))
def keep_piece(S, W, D):
    """Write the last step's dense output, in powers of its own part of the step."""
    N, JOB, PIECES = N_of(W), JOB_of(W), PIECES_of(W)
    n = JOB[WRITTEN]
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
    JOB[WRITTEN] += 1


@typed(void(int64, f1, int64, i1))
def watch(lane, S, W, D):
    """Note what the last step of a recording lane did; status 7 when the last observation is made."""
    N, K, PARAM = N_of(W), K_of(W), PARAM_of(W)
    slip_ratio = LIMITS_of(W)[SLIP_RATIO]
    if D[SIGNALS] > 0:
        if N[lane, CLOSING] == 1:
            S[D[F_STAT] + lane] = 7.0
        elif S[D[F_T] + lane] != S[D[F_T0] + lane]:
            call_reduce_step(D[AT_REDUCE_STEP], lane, S, PARAM[N[lane, CASE]], W, D)
        call_hold(D[AT_HOLD], lane, S, W, D)
        return
    if D[OFFERED] == 1 and N[lane, CLOSING] == 0 and S[D[F_T] + lane] != S[D[F_T0] + lane]:
        K[lane, WORK] += S[D[F_WORK] + lane] if D[F_WORK] >= 0 else call_work(D[AT_WORK], lane, S, PARAM[N[lane, CASE]])
        K[lane, LASTED] += S[D[F_T] + lane] - S[D[F_T0] + lane]
    if D[F_TOP] >= 0 and N[lane, CLOSING] == 0:
        K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], S[D[F_TOP] + lane]), min(K[lane, VMIN], S[D[F_TOP] + lane])
    elif N[lane, CLOSING] == 0 and S[D[F_T] + lane] != S[D[F_T0] + lane]:
        note_turns(lane, S, W, D)
    if N[lane, FRESH] > 0:
        period = S[D[F_C] + D[PERIOD] * D[LANES] + lane]
        observe(lane, S[D[F_RATIO] + lane], period, W, D)
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


@typed(void(int64, f1, int64, i1))
def arrive(lane, S, W, D):
    """At a known instant, the end of the period or one within it: impulse, strobe state, flags for the steps that follow."""
    N, K, PARAM = N_of(W), K_of(W), PARAM_of(W)
    jumped, within, done = False, False, 0
    known = D[BREAKS] > 0 or D[SAMPLE_AT] >= 0
    if known:
        jumped = is_thrown(lane, S, D)
        within = S[D[F_T] + lane] < S[D[F_C] + D[PERIOD] * D[LANES] + lane]
        if D[CARRIED] > 0:
            carry_through(lane, within, D[SET_VALUED] == 1 and jumped, S, W, D)
        else:
            pass_instant(lane, S, W, D)
    if not within:
        done = end_period(lane, S, W, D)
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
        call_hold(D[AT_HOLD], lane, S, W, D)


@typed(void(int64, f1, int64, i1))
def widen(lane, S, W, D):
    """Widen the extremes over the window by the last step, if it did not do so itself."""
    N, PARAM, JOB = N_of(W), PARAM_of(W), JOB_of(W)
    if N[lane, CASE] < 0 or N[lane, DONE] < JOB[SETTLE] or D[F_HIGH] >= 0:
        return
    if D[F_TOP] >= 0 and D[SET_VALUED] == 0:  # a step that finds its extreme, of a case that is recorded
        widen_by(wide(0, D) + lane, S[D[F_K] + lane], S, D)
        widen_by(wide(0, D) + lane, S[D[F_TOP] + lane], S, D)
        widen_by(wide(0, D) + lane, S[D[F_Y] + lane], S, D)
    elif N[lane, AGAIN] == 1:
        return
    elif D[SIGNALS] == 0:
        widen_on_step(wide(0, D) + lane, D[F_K] + lane, part_made(lane, S, D), S, D)
    elif D[ARMS] == 1:
        call_widen(D[AT_WIDEN], lane, S, PARAM[N[lane, CASE]], W, D)
        call_hold(D[AT_HOLD], lane, S, W, D)


@typed(boolean(int64, f1, int64, i1))
def begins_to_count(lane, S, W, D):
    """Of a case whose budget is used up: whether `LAST_STEPS` follow before it ends, whose changes of modes are counted."""
    N, budget = N_of(W), LIMITS_of(W)[BUDGET_OF_STEPS]
    if CHANGED_of(W).shape[0] == 0 or N[lane, COUNTING] == 1 or budget < LAST_STEPS:
        return False
    done = min(STEPS_TO_LOOK, budget) - LAST_STEPS  # so that the next look is after so many
    N[lane, COUNTING] = 1
    N[lane, ACCEPTED] -= np.int64(done)
    S[D[F_NACC] + lane] = done
    return True


@typed(float64(int64, f1, int64, i1))
def progress(lane, S, W, D):
    """After `STEPS_TO_LOOK` steps: 0 if a case gets on and has steps left, else the status with which it ends."""
    N, K = N_of(W), K_of(W)
    N[lane, ACCEPTED] += np.int64(S[D[F_NACC] + lane])
    N[lane, REJECTED] += np.int64(S[D[F_NREJ] + lane])
    S[D[F_NACC] + lane] = S[D[F_NREJ] + lane] = 0.0
    now = N[lane, DONE] + S[D[F_T] + lane] / S[D[F_C] + D[PERIOD] * D[LANES] + lane]
    moved = now - K[lane, SINCE]
    K[lane, SINCE] = now
    if N[lane, ACCEPTED] + N[lane, REJECTED] > LIMITS_of(W)[BUDGET_OF_STEPS]:
        return 0.0 if begins_to_count(lane, S, W, D) else BUDGET
    return CHATTERS if moved < LEAST_PROGRESS else 0.0


@typed(void(int64, f1, int64, i1))
def count_changes(lane, S, W, D):
    """Note which contacts changed their modes at the end of the last step of a lane."""
    CHANGED, case, some = CHANGED_of(W), N_of(W)[lane, CASE], 0
    for i in range(D[CONTACTS]):
        if S[D[F_SIDE] + i * D[LANES] + lane] != S[D[F_MODE] + i * D[LANES] + lane]:
            CHANGED[case, 1 + i] += 1
            some = 1
    CHANGED[case, 0] += some


@typed(boolean(int64, f1, int64, i1))
def go_on(lane, S, W, D):
    """After a step at whose end something is known of a lane: on to the next period or case. Returns whether there is one."""
    N = N_of(W)
    stat = S[D[F_STAT] + lane]
    S[D[F_STAT] + lane] = 0.0
    if stat == 1.0:
        arrive(lane, S, W, D)
        return True
    if stat == BUDGET:
        stat = progress(lane, S, W, D)
        if stat == 0.0:
            return True
    if stat != 7.0:
        N[lane, STATUS] = np.int64(stat)
        for i in range(SEGMENTS, N.shape[1]):
            N[lane, i] = 0
    finish(lane, S, W, D)
    if next_case(lane, S, W, D):
        return True
    S[D[F_TEND] + lane] = 1e30
    return False


@typed(int64(f1, int64, int64, i1))
def advance(S, calls, W, D):
    """Up to `calls` vector steps. Returns the number of lanes at work; JOB[WRITTEN] counts the pieces written."""
    N, JOB, PIECES = N_of(W), JOB_of(W), PIECES_of(W)
    rtol, steps = LIMITS_of(W)[RTOL], min(STEPS_TO_LOOK, LIMITS_of(W)[BUDGET_OF_STEPS])
    L = D[LANES]
    active = 0
    recording = 0
    counting = 0
    pieces_wanted = PIECES.shape[0] > 0
    for lane in range(L):
        if N[lane, CASE] >= 0 or next_case(lane, S, W, D):
            active += 1
            recording += N[lane, RECORDING]
            counting += N[lane, COUNTING]
    for _ in range(calls):
        if active == 0:
            return 0
        if pieces_wanted and JOB[WRITTEN] >= PIECES.shape[0]:
            return active
        call_step(D[AT_STEP], S, rtol, steps)
        if D[SERIES] == 1:
            call_land(D[AT_LAND], S, steps, D)
        if pieces_wanted and is_piece(S, D):
            keep_piece(S, W, D)
        if counting > 0:
            for lane in range(L):
                if N[lane, COUNTING] == 1:
                    count_changes(lane, S, W, D)
        if recording > 0:
            for lane in range(L):
                if N[lane, RECORDING] == 1:
                    watch(lane, S, W, D)
        if D[SIGNALS] > 0 and D[ARMS] == 0:
            call_widen_all(D[AT_WIDEN_ALL], S, W, D)
        for lane in range(L):
            widen(lane, S, W, D)
            if S[D[F_STAT] + lane] < 0.5:
                continue
            if N[lane, CASE] < 0:
                S[D[F_STAT] + lane] = 0.0
                S[D[F_NACC] + lane] = 0.0
                S[D[F_NREJ] + lane] = 0.0
                S[D[F_TEND] + lane] = 1e30
                continue
            was, counted = N[lane, RECORDING], N[lane, COUNTING]
            if not go_on(lane, S, W, D):
                active -= 1
            recording += N[lane, RECORDING] - was
            counting += N[lane, COUNTING] - counted
    return active
