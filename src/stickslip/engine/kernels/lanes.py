"""Text of every lane kernel below its step, the last part; engine/lanes.py puts the constants and the step before it."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A lane holds one case: its step's state in S (field f of a lane at S[f + lane]; offsets F_... are multiples of the number
# of lanes L), whole numbers in N[lane], floats in K[lane], the last strobe states in RING[lane]. When its case is finished, the
# lane takes the next one. CURSOR = (next case, end of cases). Everything a lane knows is in these arrays, so the kernel
# can return after any number of calls and go on later with the same bits.

# A lane steps to the next known instant (an impulse or a break of the drive, at the latest the end of the period), where
# this happens in this order: the period ends, v jumps, the strobe state is taken, flags and modes are set anew.


@njit("void(int64, int64, float64[::1], int64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1])", **OPTIONS)
def take(lane, case, S, N, K, XS, PARAM, START):
    """Put a case into a lane."""
    c = np.empty(CONSTANTS)
    prelude(PARAM[case], c)
    for j in range(CONSTANTS):
        S[F_C + j * L + lane] = c[j]
    for f in range(FIELDS - CONSTANTS):
        S[f * L + lane] = 0.0
    period = c[PERIOD]
    if F_H >= 0:
        S[F_H + lane] = 1e-3 * period
        S[F_LE + lane] = -2.0
        S[F_LH + lane] = math.log2(1e-3 * period)
        S[F_GROW + lane] = 1.4
    S[F_X + lane] = START[case, 0]
    for i in range(STATES):
        S[F_Y + i * L + lane] = START[case, 1 + i]
    set_flags(lane, S, PARAM[case], True)
    for j in range(9):
        N[lane, j] = 0
    for j in range(15):
        K[lane, j] = 0.0
    N[lane, CASE] = case


@njit("void(int64, float64, float64[::1], int64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], int8[:,::1])", **OPTIONS)
def pass_instant(lane, slip_ratio, S, N, K, PARAM, SEGT, SEGC):
    """At a known instant: what was observed ends before an impulse, and begins anew after it."""
    jump = jump_of(lane, S)
    if jump == 0.0:
        return
    if N[lane, RECORDING] == 1 and N[lane, FRESH] == 1:
        observe(lane, 0.0, K[lane, RQ], slip_ratio, S[F_C + PERIOD * L + lane], N, K, SEGT, SEGC)
    apply_jump(lane, S, PARAM[N[lane, CASE]], jump)
    if N[lane, RECORDING] == 1:
        v = S[F_Y + lane]
        N[lane, FRESH] = 2
        K[lane, TP], K[lane, VP] = S[F_T + lane], v
        K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], v), min(K[lane, VMIN], v)


@njit("void(int64, float64[::1], int64[:,::1], float64[:,::1], float64[:,:,::1], float64[:,::1], int64[:,::1])", **OPTIONS)
def finish(lane, S, N, K, RING, OUT, COUNT):
    """Write a case's results."""
    case = N[lane, CASE]
    OUT[case, 0] = K[lane, DISPLACEMENT]
    OUT[case, 1] = K[lane, WINDOW]
    OUT[case, 2] = K[lane, VMAX]
    OUT[case, 3] = K[lane, VMIN]
    good = N[lane, STATUS] == FINISHED or N[lane, STATUS] == REPEATED
    OUT[case, 4] = K[lane, WORK] / K[lane, LASTED] if OFFERED and K[lane, LASTED] > 0.0 else np.nan
    OUT[case, 5] = RING[lane, N[lane, DONE] % RINGS, 0] if good else S[F_X + lane]
    for i in range(STATES):
        OUT[case, 6 + i] = RING[lane, N[lane, DONE] % RINGS, 1 + i] if good else S[F_Y + i * L + lane]
    COUNT[case, 0] = N[lane, STATUS]
    COUNT[case, 1] = N[lane, NUMBER]
    COUNT[case, 2] = N[lane, DONE]
    COUNT[case, 3] = N[lane, SEGMENTS]
    COUNT[case, 4] = np.int64(S[F_NACC + lane])
    COUNT[case, 5] = np.int64(S[F_NREJ + lane])
    N[lane, CASE] = -1


@njit("int64(int64, int64, int64, int64, float64, float64[::1], int64[:,::1], float64[:,::1], float64[:,:,::1], float64[:,::1])", **OPTIONS)
def end_period(lane, periods, settle, auto, rtol, S, N, K, RING, XS):
    """Book-keeping at the end of a drive period. Returns 1 when only the last observation is wanting."""
    N[lane, DONE] += 1
    k = N[lane, DONE]
    x = S[F_X + lane]
    RING[lane, k % RINGS, 0] = x
    scale = np.empty(STATES)
    for i in range(STATES):
        RING[lane, k % RINGS, 1 + i] = S[F_Y + i * L + lane]
        scale[i] = (
            S[F_C + FREE * L + lane] if i == 0 else (S[F_C + SCALE_AT[i] * L + lane] if SCALE_AT[i] >= 0 else S[F_M + (i - 1) * L + lane])
        )
        scale[i] = max(scale[i], 1e-300)
    if k >= settle and k < settle + KEPT:
        XS[lane, k - settle] = x
    if N[lane, TARGET] > 0:
        if k < N[lane, TARGET]:
            return 0
        if auto and N[lane, NUMBER] > 0:
            K[lane, DISPLACEMENT] = x - K[lane, XBEGIN]
            K[lane, WINDOW] = N[lane, NUMBER]
        return 1
    if auto and k < periods:
        p = repeated(lane, N, RING, scale, 10.0 * rtol)
        if p > 0 and k >= 2 * p + 1 and remaining(lane, p, N, RING, scale, 0.0) <= 3.0 * rtol:
            N[lane, NUMBER] = p
            N[lane, STATUS] = REPEATED
            N[lane, TARGET] = k + p
            K[lane, XBEGIN] = x
            begin_record(lane, N, K, S)
        return 0
    if k == periods - 1 and not auto:
        begin_record(lane, N, K, S)
    if k < periods:
        return 0
    p = repeated(lane, N, RING, scale, 30.0 * rtol)
    if p > 0 and k >= 2 * p + 1 and remaining(lane, p, N, RING, scale, 3.0 * rtol) > 300.0 * rtol:  # it still drifts
        p = 0
    N[lane, NUMBER] = p
    whole = max(p, 1)
    first = (periods - settle) % whole
    if auto or first >= KEPT or first >= periods - settle:
        first = 0
    K[lane, DISPLACEMENT] = x - (XS[lane, first])
    K[lane, WINDOW] = periods - settle - first
    if p <= 1 and not auto:
        return 1
    N[lane, TARGET] = k + whole
    K[lane, XBEGIN] = x
    begin_record(lane, N, K, S)
    return 0


@njit(
    "int64(float64[::1], int64[:,::1], float64[:,::1], float64[:,:,::1], float64[:,::1], int64[::1], float64[:,::1], float64[:,::1], "
    "float64[:,::1], int64[:,::1], float64[:,::1], int8[:,::1], float64[:,::1], int64, int64, int64, float64, float64, float64, int64)",
    **OPTIONS,
)
def advance(
    S, N, K, RING, XS, CURSOR, PARAM, START, OUT, COUNT, SEGT, SEGC, PIECES, periods, settle, auto, rtol, slip_ratio, budget, calls
):
    """Up to `calls` vector steps. Returns the number of lanes at work; CURSOR[2] counts the pieces written."""
    active = 0
    recording = 0
    pieces_wanted = PIECES.shape[0] > 0
    for lane in range(L):
        if N[lane, CASE] >= 0:
            active += 1
            recording += N[lane, RECORDING]
        elif CURSOR[0] < CURSOR[1]:
            take(lane, CURSOR[0], S, N, K, XS, PARAM, START)
            CURSOR[0] += 1
            active += 1
            XS[lane, 0] = S[F_X + lane]
            if periods == 1 and not auto:
                begin_record(lane, N, K, S)
                recording += 1
    for _ in range(calls):
        if active == 0:
            return 0
        if RECORD and pieces_wanted and CURSOR[2] >= PIECES.shape[0]:
            return active
        step(S, rtol, budget)
        if RECORD and pieces_wanted and S[F_T] != S[F_T0]:
            n = CURSOR[2]
            begin, end = S[F_T0], S[F_T]
            PIECES[n, 0], PIECES[n, 1], PIECES[n, 2], PIECES[n, 3], PIECES[n, 4] = N[0, DONE], begin, end, S[F_X0], S[F_SIDE]
            part, power = (end - begin) / S[F_HH], 1.0
            if S[F_STAT] == 1.0:
                part = 1.0
            for k in range(KEPT_MODES):
                PIECES[n, 5 + k] = S[F_HELD + k]
            for m in range(DEGREE + 1):
                for i in range(STATES):
                    PIECES[n, 5 + KEPT_MODES + i * (DEGREE + 1) + m] = S[F_K + i * (DEGREE + 1) + m] * power
                power *= part
            CURSOR[2] += 1
        if recording > 0:
            for lane in range(L):
                if N[lane, RECORDING] == 0 or N[lane, CASE] < 0:
                    continue
                if OFFERED and N[lane, CLOSING] == 0 and S[F_T + lane] != S[F_T0 + lane]:
                    dissipate(lane, S, K, PARAM[N[lane, CASE]])
                if F_TOP >= 0 and N[lane, CLOSING] == 0:
                    K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], S[F_TOP + lane]), min(K[lane, VMIN], S[F_TOP + lane])
                if N[lane, FRESH] > 0:
                    period = S[F_C + PERIOD * L + lane]
                    observe(lane, S[F_ACC + lane], S[F_RATIO + lane], slip_ratio, period, N, K, SEGT, SEGC)
                    if N[lane, CLOSING] == 1:
                        S[F_STAT + lane] = 7.0
                        continue
                if S[F_T + lane] != K[lane, TP] or S[F_SIGN + lane] != K[lane, BP]:
                    K[lane, TP], K[lane, VP], K[lane, BP] = S[F_T + lane], S[F_Y + lane], S[F_SIGN + lane]
                    N[lane, FRESH] = 1
        for lane in range(L):
            stat = S[F_STAT + lane]
            if stat < 0.5:
                continue
            S[F_STAT + lane] = 0.0
            if N[lane, CASE] < 0:
                S[F_NACC + lane] = 0.0
                S[F_NREJ + lane] = 0.0
                S[F_TEND + lane] = 1e30
                continue
            if stat == 1.0:
                if BREAKS > 0:
                    pass_instant(lane, slip_ratio, S, N, K, PARAM, SEGT, SEGC)
                    if S[F_T + lane] < S[F_C + PERIOD * L + lane]:
                        set_flags(lane, S, PARAM[N[lane, CASE]], SET_VALUED and jump_of(lane, S) != 0.0)
                        if N[lane, FRESH] == 2:
                            K[lane, VP], K[lane, BP] = S[F_Y + lane], S[F_SIGN + lane]
                        continue
                was = N[lane, RECORDING]
                done = end_period(lane, periods, settle, auto, rtol, S, N, K, RING, XS)
                jumped = BREAKS > 0 and jump_of(lane, S) != 0.0
                S[F_T + lane] = 0.0
                if BREAKS > 0:
                    set_flags(lane, S, PARAM[N[lane, CASE]], SET_VALUED and jumped)
                    if N[lane, FRESH] == 2:
                        K[lane, VP], K[lane, BP] = S[F_Y + lane], S[F_SIGN + lane]
                recording += N[lane, RECORDING] - was
                if N[lane, FRESH] == 2:
                    K[lane, TP] = 0.0
                if done == 0:
                    continue
                N[lane, CLOSING] = 1
                continue
            if stat != 7.0:
                N[lane, STATUS] = np.int64(stat)
                N[lane, SEGMENTS] = 0
            recording -= N[lane, RECORDING]
            finish(lane, S, N, K, RING, OUT, COUNT)
            if CURSOR[0] < CURSOR[1]:
                take(lane, CURSOR[0], S, N, K, XS, PARAM, START)
                CURSOR[0] += 1
                XS[lane, 0] = S[F_X + lane]
                if periods == 1 and not auto:
                    begin_record(lane, N, K, S)
                    recording += 1
            else:
                active -= 1
                S[F_TEND + lane] = 1e30
    return active
