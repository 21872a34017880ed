# Text of every lane kernel below its step; engine/lanes.py puts the constants and the step before it.
# ruff: noqa: F821, D100, D103
# mypy: ignore-errors
#
# A lane holds one case: its step's state in S (field f of lane l at S[f + l]; offsets F_... are multiples of the number
# of lanes L), whole numbers in I[l], floats in K[l], the last strobe states in RING[l]. When its case is finished, the
# lane takes the next one. CURSOR = (next case, end of cases). Everything a lane knows is in these arrays, so the kernel
# can return after any number of calls and go on later with the same bits.

# columns of I (lane): case (-1 idle), periods done, recording, last period to do, period number, fresh point, closing, status
CASE, DONE, RECORDING, TARGET, NUMBER, FRESH, CLOSING, STATUS, SEGMENTS = range(9)
# columns of K (lane): the last two observed points, window
TQ, VQ, AQ, RQ, BQ, TP, VP, BP, VMAX, VMIN, XBEGIN, DISPLACEMENT, WINDOW = range(13)
KEPT = 16  # strobe positions kept after settling, and the largest period number looked for
RINGS = 34
SEGS = 32
FINISHED, REPEATED, TOO_LONG = 0, 1, 2


@njit("void(int64, int64, float64[::1], int64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1])", **OPTIONS)
def take(l, case, S, I, K, XS, PARAM, START):
    """Put a case into a lane."""
    c = np.empty(CONSTANTS)
    prelude(PARAM[case], c)
    for j in range(CONSTANTS):
        S[F_C + j * L + l] = c[j]
    for f in range(FIELDS - CONSTANTS):
        S[f * L + l] = 0.0
    period = c[PERIOD]
    S[F_H + l] = 1e-3 * period
    S[F_TEND + l] = period
    S[F_LE + l] = -2.0
    S[F_LH + l] = math.log2(1e-3 * period)
    S[F_GROW + l] = 1.4
    S[F_X + l] = START[case, 0]
    for i in range(STATES):
        S[F_Y + i * L + l] = START[case, 1 + i]
    side = np.empty(GUARDS)
    sides(PARAM[case], START[case], side)
    for k in range(GUARDS):
        S[F_B + k * L + l] = -1.0 if side[k] < 0.0 else 1.0
        S[F_ON + k * L + l] = 1.0 if side[k] == 0.0 else 0.0
    for j in range(9):
        I[l, j] = 0
    for j in range(13):
        K[l, j] = 0.0
    I[l, CASE] = case


@njit("int64(int64, int64[:,::1], float64[:,:,::1], float64[::1], float64)", **OPTIONS)
def repeated(l, I, RING, scale, tolerance):
    """Smallest p such that the strobe state of p periods ago came back, twice in a row; 0 if none."""
    k = I[l, DONE]
    for p in range(1, KEPT + 1):
        if k < 2 * p or k < p + 1:
            return 0
        good = True
        for back in range(2):
            d = 0.0
            for i in range(STATES):
                d = max(d, abs(RING[l, (k - back) % RINGS, 1 + i] - RING[l, (k - back - p) % RINGS, 1 + i]) / scale[i])
            if not d <= tolerance:
                good = False
        if good:
            return p
    return 0


@njit("float64(int64, int64, int64[:,::1], float64[:,:,::1], float64[::1])", **OPTIONS)
def remaining(l, p, I, RING, scale):
    """Estimated distance to the periodic state: the last difference d1 over 1 - d1/d0."""
    k = I[l, DONE]
    d1 = 0.0
    d0 = 0.0
    for i in range(STATES):
        d1 = max(d1, abs(RING[l, k % RINGS, 1 + i] - RING[l, (k - p) % RINGS, 1 + i]) / scale[i])
        d0 = max(d0, abs(RING[l, (k - p) % RINGS, 1 + i] - RING[l, (k - 2 * p) % RINGS, 1 + i]) / scale[i])
    if d1 == 0.0:
        return 0.0
    ratio = min(d1 / d0, 0.999) if d0 > 0.0 else 0.999
    return d1 / (1.0 - ratio)


@njit("void(int64, int64[:,::1], float64[:,::1], float64[::1])", **OPTIONS)
def begin_record(l, I, K, S):
    """Start to observe the motion from the lane's present point."""
    I[l, RECORDING] = 1
    I[l, SEGMENTS] = 0
    I[l, FRESH] = 2
    K[l, TP] = S[F_T + l]
    K[l, VP] = S[F_Y + l]
    K[l, BP] = S[F_B + l]
    K[l, VMAX] = S[F_Y + l]
    K[l, VMIN] = S[F_Y + l]


@njit("void(int64, int64, float64, int64[:,::1], float64[:,::1], int8[:,::1])", **OPTIONS)
def add_segment(l, code, length, I, SEGT, SEGC):
    """Append a stretch of one code, or lengthen the last one."""
    case = I[l, CASE]
    n = I[l, SEGMENTS]
    if length <= 0.0 or n < 0:
        return
    if n > 0 and SEGC[case, n - 1] == code:
        SEGT[case, n - 1] += length
    elif n == SEGS:
        I[l, SEGMENTS] = -1
    else:
        SEGC[case, n] = code
        SEGT[case, n] = length
        I[l, SEGMENTS] = n + 1


@njit("void(int64, float64, float64, float64, float64, int64[:,::1], float64[:,::1], float64[:,::1], int8[:,::1])", **OPTIONS)
def observe(l, acceleration, ratio, slip_ratio, period, I, K, SEGT, SEGC):
    """The stretch from the last observed point Q to the new one P, whose slopes are known only now."""
    t, v, b = K[l, TP], K[l, VP], K[l, BP]
    if I[l, FRESH] == 1:
        dt = t - K[l, TQ]
        bq, rq = K[l, BQ], K[l, RQ]
        slips = rq >= slip_ratio
        side = np.int64(bq)
        if b == bq and v != 0.0 and (ratio >= slip_ratio) != slips:
            part = (slip_ratio - rq) / (ratio - rq)
            add_segment(l, 2 * side if slips else side, part * dt, I, SEGT, SEGC)
            add_segment(l, side if slips else 2 * side, (1.0 - part) * dt, I, SEGT, SEGC)
        else:
            add_segment(l, 2 * side if slips else side, dt, I, SEGT, SEGC)
        top = v
        aq = K[l, AQ]
        if aq * acceleration < 0.0:  # an extremum of v between: the cubic's
            d0, d1, rise = aq * dt, acceleration * dt, v - K[l, VQ]
            a, bb = 3.0 * (d0 + d1 - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * d0 - d1)
            root = math.sqrt(max(bb * bb - 4.0 * a * d0, 0.0))
            q = -0.5 * (bb + (root if bb >= 0.0 else -root))
            s = d0 / q if q != 0.0 else 0.5
            if not (s > 0.0 and s < 1.0):
                s = q / a if a != 0.0 else 0.5
            if s > 0.0 and s < 1.0:
                top = K[l, VQ] + s * (d0 + s * (0.5 * bb + s * a / 3.0))
        K[l, VMAX] = max(K[l, VMAX], max(v, top))
        K[l, VMIN] = min(K[l, VMIN], min(v, top))
    K[l, TQ] = 0.0 if t >= period else t  # the end of a period is the beginning of the next
    K[l, VQ], K[l, AQ], K[l, RQ], K[l, BQ] = v, acceleration, ratio, b
    I[l, FRESH] = 0


@njit("void(int64, float64[::1], int64[:,::1], float64[:,::1], float64[:,:,::1], float64[:,::1], int64[:,::1])", **OPTIONS)
def finish(l, S, I, K, RING, OUT, COUNT):
    """Write a case's results."""
    case = I[l, CASE]
    OUT[case, 0] = K[l, DISPLACEMENT]
    OUT[case, 1] = K[l, WINDOW]
    OUT[case, 2] = K[l, VMAX]
    OUT[case, 3] = K[l, VMIN]
    good = I[l, STATUS] == FINISHED or I[l, STATUS] == REPEATED
    OUT[case, 4] = RING[l, I[l, DONE] % RINGS, 0] if good else S[F_X + l]
    for i in range(STATES):
        OUT[case, 5 + i] = RING[l, I[l, DONE] % RINGS, 1 + i] if good else S[F_Y + i * L + l]
    COUNT[case, 0] = I[l, STATUS]
    COUNT[case, 1] = I[l, NUMBER]
    COUNT[case, 2] = I[l, DONE]
    COUNT[case, 3] = I[l, SEGMENTS]
    COUNT[case, 4] = np.int64(S[F_NACC + l])
    COUNT[case, 5] = np.int64(S[F_NREJ + l])
    I[l, CASE] = -1


@njit("int64(int64, int64, int64, int64, float64, float64[::1], int64[:,::1], float64[:,::1], float64[:,:,::1], float64[:,::1])", **OPTIONS)
def end_period(l, periods, settle, auto, rtol, S, I, K, RING, XS):
    """Book-keeping at the end of a drive period. Returns 1 when only the last observation is wanting."""
    I[l, DONE] += 1
    k = I[l, DONE]
    x = S[F_X + l]
    RING[l, k % RINGS, 0] = x
    scale = np.empty(STATES)
    for i in range(STATES):
        RING[l, k % RINGS, 1 + i] = S[F_Y + i * L + l]
        scale[i] = S[F_C + VSCALE * L + l] if i == 0 else (S[F_C + (ZSCALE + i - 1) * L + l] if ZSCALE >= 0 else S[F_M + (i - 1) * L + l])
        scale[i] = max(scale[i], 1e-300)
    if k >= settle and k < settle + KEPT:
        XS[l, k - settle] = x
    if I[l, TARGET] > 0:
        if k < I[l, TARGET]:
            return 0
        if auto:
            K[l, DISPLACEMENT] = x - K[l, XBEGIN]
            K[l, WINDOW] = I[l, NUMBER]
        return 1
    if auto and k < periods:
        p = repeated(l, I, RING, scale, 10.0 * rtol)
        if p > 0 and k >= 2 * p + 1 and remaining(l, p, I, RING, scale) <= 3.0 * rtol:
            I[l, NUMBER] = p
            I[l, STATUS] = REPEATED
            I[l, TARGET] = k + p
            K[l, XBEGIN] = x
            begin_record(l, I, K, S)
        return 0
    if k == periods - 1 and not auto:
        begin_record(l, I, K, S)
    if k < periods:
        return 0
    p = repeated(l, I, RING, scale, 30.0 * rtol)
    I[l, NUMBER] = p
    whole = max(p, 1)
    first = (periods - settle) % whole
    if auto or first >= KEPT or first >= periods - settle:
        first = 0
    K[l, DISPLACEMENT] = x - (XS[l, first])
    K[l, WINDOW] = periods - settle - first
    if p <= 1 and not auto:
        return 1
    I[l, TARGET] = k + whole
    K[l, XBEGIN] = x
    begin_record(l, I, K, S)
    return 0


@njit(
    "int64(float64[::1], int64[:,::1], float64[:,::1], float64[:,:,::1], float64[:,::1], int64[::1], float64[:,::1], float64[:,::1], "
    "float64[:,::1], int64[:,::1], float64[:,::1], int8[:,::1], float64[:,::1], int64, int64, int64, float64, float64, float64, int64)",
    **OPTIONS,
)
def advance(S, I, K, RING, XS, CURSOR, PARAM, START, OUT, COUNT, SEGT, SEGC, PIECES, periods, settle, auto, rtol, slip_ratio, budget, calls):
    """Up to `calls` vector steps. Returns the number of lanes at work; CURSOR[2] counts the pieces written."""
    active = 0
    recording = 0
    pieces_wanted = PIECES.shape[0] > 0
    for l in range(L):
        if I[l, CASE] >= 0:
            active += 1
            recording += I[l, RECORDING]
        elif CURSOR[0] < CURSOR[1]:
            take(l, CURSOR[0], S, I, K, XS, PARAM, START)
            CURSOR[0] += 1
            active += 1
            XS[l, 0] = S[F_X + l]
            if periods == 1 and not auto:
                begin_record(l, I, K, S)
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
            PIECES[n, 0], PIECES[n, 1], PIECES[n, 2], PIECES[n, 3], PIECES[n, 4] = I[0, DONE], begin, end, S[F_X0], S[F_SIDE]
            part, power = (end - begin) / S[F_HH], 1.0
            if S[F_STAT] == 1.0:
                part = 1.0
            for m in range(DEGREE + 1):
                for i in range(STATES):
                    PIECES[n, 5 + i * (DEGREE + 1) + m] = S[F_K + i * (DEGREE + 1) + m] * power
                power *= part
            CURSOR[2] += 1
        if recording > 0:
            for l in range(L):
                if I[l, RECORDING] == 0 or I[l, CASE] < 0:
                    continue
                if I[l, FRESH] > 0:
                    observe(l, S[F_ACC + l], S[F_RATIO + l], slip_ratio, S[F_TEND + l], I, K, SEGT, SEGC)
                    if I[l, CLOSING] == 1:
                        S[F_STAT + l] = 7.0
                        continue
                if S[F_T + l] != K[l, TP] or S[F_B + l] != K[l, BP]:
                    K[l, TP], K[l, VP], K[l, BP] = S[F_T + l], S[F_Y + l], S[F_B + l]
                    I[l, FRESH] = 1
        for l in range(L):
            stat = S[F_STAT + l]
            if stat < 0.5:
                continue
            S[F_STAT + l] = 0.0
            if I[l, CASE] < 0:
                S[F_NACC + l] = 0.0
                S[F_NREJ + l] = 0.0
                S[F_TEND + l] = 1e30
                continue
            if stat == 1.0:
                was = I[l, RECORDING]
                done = end_period(l, periods, settle, auto, rtol, S, I, K, RING, XS)
                S[F_T + l] = 0.0
                recording += I[l, RECORDING] - was
                if I[l, FRESH] == 2:
                    K[l, TP] = 0.0
                if done == 0:
                    continue
                I[l, CLOSING] = 1
                continue
            if stat != 7.0:
                I[l, STATUS] = np.int64(stat)
                I[l, SEGMENTS] = 0
            recording -= I[l, RECORDING]
            finish(l, S, I, K, RING, OUT, COUNT)
            if CURSOR[0] < CURSOR[1]:
                take(l, CURSOR[0], S, I, K, XS, PARAM, START)
                CURSOR[0] += 1
                XS[l, 0] = S[F_X + l]
                if periods == 1 and not auto:
                    begin_record(l, I, K, S)
                    recording += 1
            else:
                active -= 1
                S[F_TEND + l] = 1e30
    return active
