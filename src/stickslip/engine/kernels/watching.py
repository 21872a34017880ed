"""What is noted of a motion on the way: stretches, extremes, the work of friction; text before lanes.py."""
# ruff: noqa: F821
# mypy: ignore-errors

# FOUND[lane] has for each signal an integral or a count, the largest and the smallest value (reducing.py), and after the signals for
# each body the extremes of its velocity over the window.
TOTAL, LARGEST, SMALLEST = range(3)
MEAN, MOST, LEAST, COUNTED, LAST, AT_GUARD = 1, 2, 4, 8, 16, 64


@njit(void(int64, f3, i1), **OPTIONS)
def begin_signals(lane, FOUND, D):
    """Nothing is known of the signals yet."""
    for s in range(D[SIGNALS]):
        kind = D[D[KINDS] + s]
        FOUND[lane, s, TOTAL] = 0.0
        FOUND[lane, s, LARGEST] = 0.0 if kind >= AT_GUARD else -math.inf
        FOUND[lane, s, SMALLEST] = math.nan if kind & COUNTED else math.inf


@njit(void(int64, i2, f2, f3, f1, i1), **OPTIONS)
def begin_record(lane, N, K, FOUND, S, D):
    """Start to observe the motion from the lane's present point."""
    begin_signals(lane, FOUND, D)
    N[lane, RECORDING] = 1
    if D[F_LOOKED] >= 0:
        S[D[F_LOOKED] + lane] = 1.0
    for i in range(SEGMENTS, N.shape[1]):
        N[lane, i] = 0
    N[lane, FRESH] = 2
    K[lane, TP] = S[D[F_T] + lane]
    K[lane, VP] = S[D[F_Y] + lane]
    K[lane, BP] = S[D[F_SIGN] + lane]
    K[lane, VMAX] = S[D[F_Y] + lane]
    K[lane, VMIN] = S[D[F_Y] + lane]
    K[lane, WORK] = 0.0
    K[lane, LASTED] = 0.0


@njit(void(int64, int64, int64, float64, i2, f2, b2), **OPTIONS)
def add_segment(lane, i, code, length, N, SEGT, SEGC):
    """Append a stretch of one code to those of contact i, or lengthen the last one."""
    case, first = N[lane, CASE], i * SEGS
    n = N[lane, SEGMENTS + i]
    if length <= 0.0 or n < 0:
        return
    if n > 0 and SEGC[case, first + n - 1] == code:
        SEGT[case, first + n - 1] += length
    elif n == SEGS:
        N[lane, SEGMENTS + i] = -1
    else:
        SEGC[case, first + n] = code
        SEGT[case, first + n] = length
        N[lane, SEGMENTS + i] = n + 1


@njit(void(int64, float64, float64, float64, float64, i2, f2, f2, b2, i1), **OPTIONS)
def observe(lane, acceleration, ratio, slip_ratio, period, N, K, SEGT, SEGC, D):
    """The stretch from the last observed point Q to the new one P, whose slopes are known only now."""
    t, v, b = K[lane, TP], K[lane, VP], K[lane, BP]
    if N[lane, FRESH] == 1:
        dt = t - K[lane, TQ]
        bq, rq = K[lane, BQ], K[lane, RQ]
        slips = rq >= slip_ratio
        side = np.int64(bq)
        if b == bq and v != 0.0 and (ratio >= slip_ratio) != slips:
            part = (slip_ratio - rq) / (ratio - rq)
            add_segment(lane, 0, 2 * side if slips else side, part * dt, N, SEGT, SEGC)
            add_segment(lane, 0, side if slips else 2 * side, (1.0 - part) * dt, N, SEGT, SEGC)
        else:
            add_segment(lane, 0, 2 * side if slips else side, dt, N, SEGT, SEGC)
        top = v
        aq = K[lane, AQ]
        if D[F_TOP] < 0 and aq * acceleration < 0.0:  # an extremum of v between: the cubic's
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
