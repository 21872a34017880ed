"""Text of every lane kernel below its step; engine/lanes.py puts the constants and the step before it."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A lane holds one case: its step's state in S (field f of a lane at S[f + lane]; offsets F_... are multiples of the number
# of lanes L), whole numbers in N[lane], floats in K[lane], the last strobe states in RING[lane]. When its case is finished, the
# lane takes the next one. CURSOR = (next case, end of cases). Everything a lane knows is in these arrays, so the kernel
# can return after any number of calls and go on later with the same bits.

# A lane steps to the next known instant (an impulse or a break of the drive, at the latest the end of the period), where
# this happens in this order: the period ends, v jumps, the strobe state is taken, flags and modes are set anew.
#
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


@njit("int64(int64, int64[:,::1], float64[:,:,::1], float64[::1], float64)", **OPTIONS)
def repeated(lane, N, RING, scale, tolerance):
    """Smallest p such that the strobe state of p periods ago came back, twice in a row; 0 if none."""
    k = N[lane, DONE]
    for p in range(1, KEPT + 1):
        if k < 2 * p or k < p + 1:
            return 0
        good = True
        for back in range(2):
            d = 0.0
            for i in range(STATES):
                d = max(d, abs(RING[lane, (k - back) % RINGS, 1 + i] - RING[lane, (k - back - p) % RINGS, 1 + i]) / scale[i])
            if not d <= tolerance:
                good = False
        if good:
            return p
    return 0


@njit("float64(int64, int64, int64[:,::1], float64[:,:,::1], float64[::1], float64)", **OPTIONS)
def remaining(lane, p, N, RING, scale, noise):
    """Estimated distance to the periodic state: the last difference d1 over 1 - d1/d0; a difference below `noise` is no drift."""
    k = N[lane, DONE]
    d1 = 0.0
    d0 = 0.0
    for back in range(max(1, min(p, min(k, RINGS - 1) - 2 * p + 1))):  # every phase of the motion, as far as it is remembered
        for i in range(STATES):
            new, old, older = (k - back) % RINGS, (k - back - p) % RINGS, (k - back - 2 * p) % RINGS
            d1 = max(d1, abs(RING[lane, new, 1 + i] - RING[lane, old, 1 + i]) / scale[i])
            d0 = max(d0, abs(RING[lane, old, 1 + i] - RING[lane, older, 1 + i]) / scale[i])
    if d1 <= noise:
        return d1
    ratio = min(d1 / d0, 0.999) if d0 > 0.0 else 0.999
    return d1 / (1.0 - ratio)


@njit("void(int64, int64[:,::1], float64[:,::1], float64[::1])", **OPTIONS)
def begin_record(lane, N, K, S):
    """Start to observe the motion from the lane's present point."""
    N[lane, RECORDING] = 1
    N[lane, SEGMENTS] = 0
    N[lane, FRESH] = 2
    K[lane, TP] = S[F_T + lane]
    K[lane, VP] = S[F_Y + lane]
    K[lane, BP] = S[F_SIGN + lane]
    K[lane, VMAX] = S[F_Y + lane]
    K[lane, VMIN] = S[F_Y + lane]
    K[lane, WORK] = 0.0
    K[lane, LASTED] = 0.0


@njit("void(int64, int64, float64, int64[:,::1], float64[:,::1], int8[:,::1])", **OPTIONS)
def add_segment(lane, code, length, N, SEGT, SEGC):
    """Append a stretch of one code, or lengthen the last one."""
    case = N[lane, CASE]
    n = N[lane, SEGMENTS]
    if length <= 0.0 or n < 0:
        return
    if n > 0 and SEGC[case, n - 1] == code:
        SEGT[case, n - 1] += length
    elif n == SEGS:
        N[lane, SEGMENTS] = -1
    else:
        SEGC[case, n] = code
        SEGT[case, n] = length
        N[lane, SEGMENTS] = n + 1


@njit("void(int64, float64, float64, float64, float64, int64[:,::1], float64[:,::1], float64[:,::1], int8[:,::1])", **OPTIONS)
def observe(lane, acceleration, ratio, slip_ratio, period, N, K, SEGT, SEGC):
    """The stretch from the last observed point Q to the new one P, whose slopes are known only now."""
    t, v, b = K[lane, TP], K[lane, VP], K[lane, BP]
    if N[lane, FRESH] == 1:
        dt = t - K[lane, TQ]
        bq, rq = K[lane, BQ], K[lane, RQ]
        slips = rq >= slip_ratio
        side = np.int64(bq)
        if b == bq and v != 0.0 and (ratio >= slip_ratio) != slips:
            part = (slip_ratio - rq) / (ratio - rq)
            add_segment(lane, 2 * side if slips else side, part * dt, N, SEGT, SEGC)
            add_segment(lane, side if slips else 2 * side, (1.0 - part) * dt, N, SEGT, SEGC)
        else:
            add_segment(lane, 2 * side if slips else side, dt, N, SEGT, SEGC)
        top = v
        aq = K[lane, AQ]
        if F_TOP < 0 and aq * acceleration < 0.0:  # an extremum of v between: the cubic's
            d0, d1, rise = aq * dt, acceleration * dt, v - K[lane, VQ]
            a, bb = 3.0 * (d0 + d1 - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * d0 - d1)
            root = math.sqrt(max(bb * bb - 4.0 * a * d0, 0.0))
            q = -0.5 * (bb + (root if bb >= 0.0 else -root))
            s = d0 / q if q != 0.0 else 0.5
            if not (s > 0.0 and s < 1.0):
                s = q / a if a != 0.0 else 0.5
            if s > 0.0 and s < 1.0:
                top = K[lane, VQ] + s * (d0 + s * (0.5 * bb + s * a / 3.0))
        K[lane, VMAX] = max(K[lane, VMAX], max(v, top))
        K[lane, VMIN] = min(K[lane, VMIN], min(v, top))
    K[lane, TQ] = 0.0 if t >= period else t  # the end of a period is the beginning of the next
    K[lane, VQ], K[lane, AQ], K[lane, RQ], K[lane, BQ] = v, acceleration, ratio, b
    N[lane, FRESH] = 0


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


@njit("void(int64, float64[::1], float64[:,::1], float64[::1])", **OPTIONS)
def dissipate(lane, S, K, row):
    """Work of friction in the last step: what was offered and did not become kinetic energy (Gauss's rule on the dense output)."""
    begin, end, h = S[F_T0 + lane], S[F_T + lane], S[F_HH + lane]
    part = (end - begin) / h
    work = 0.0
    for q in range(NODES.shape[0]):
        theta = part * NODES[q]
        v = S[F_K + DEGREE * L + lane]
        for m in range(DEGREE - 1, -1, -1):
            v = fma(v, theta, S[F_K + m * L + lane])
        work += WEIGHTS[q] * offered(lane, S, row, begin + theta * h) * v
    last = S[F_K + DEGREE * L + lane]
    for m in range(DEGREE - 1, -1, -1):
        last = fma(last, part, S[F_K + m * L + lane])
    first = S[F_K + lane]
    K[lane, WORK] += work * (end - begin) - 0.5 * total_mass(row) * (last - first) * (last + first)
    K[lane, LASTED] += end - begin


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
