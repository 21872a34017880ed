"""What is noted of a motion on the way: stretches, extremes, the work of friction; text before lanes.py."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(void(int64, f1, int64, i1))
def begin_record(lane, S, W, D):
    """Start to observe the motion from the lane's present point."""
    N, K = N_of(W), K_of(W)
    if D[SIGNALS] > 0:
        call_begin_signals(D[AT_BEGIN_SIGNALS], lane, W, D)
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


@typed(float64(int64, float64, f1, i1))
def turned(lane, slip_ratio, S, D):
    """The part of a step after which slip begins or ends, where its polynomials are as good as its ends; -1 where it does not.

    There |v| times the slip ratio 1 - (dz/dt)/v of one inner state passes its limit; v has one sign in a step.
    """
    L, degree, first, slips = D[LANES], D[DEGREE], D[F_K] + lane, S[D[F_RATIO] + lane] >= slip_ratio
    C, part, end, v = np.empty(degree + 1), (1.0 - slip_ratio) * S[D[F_HH] + lane], 0.0, S[first]
    for m in range(degree + 1):
        C[m] = part * S[first + m * L]
        if m < degree:
            C[m] -= (m + 1) * S[first + (degree + 2 + m) * L]
        if m > 0:
            v += S[first + m * L]
    side = 1.0 if (v + S[first] > 0.0) == slips else -1.0
    for m in range(degree + 1):
        C[m] *= side
        end += C[m]
    if end > 0.0 or (end == 0.0 and slips):
        return -1.0
    if C[0] < 0.0:
        return 0.0
    return zero_from(C, 0, degree, 0.0, 1.0, C[0] / (C[0] - end), 1e-6)


@typed(void(int64, float64, float64, int64, i1))
def observe(lane, ratio, period, W, D):
    """The stretch from the last observed point Q to the new one P, whose ratio of slip is known only now."""
    N, K, slip_ratio = N_of(W), K_of(W), LIMITS_of(W)[SLIP_RATIO]
    t, v, b = K[lane, TP], K[lane, VP], K[lane, BP]
    if N[lane, FRESH] == 1:
        dt = t - K[lane, TQ]
        bq, rq = K[lane, BQ], K[lane, RQ]
        slips = rq >= slip_ratio
        side = np.int64(bq)
        if b == bq and v != 0.0 and (ratio >= slip_ratio) != slips:
            part = K[lane, PART]
            if part < 0.0:
                part = (slip_ratio - rq) / (ratio - rq)
            add_segment(lane, 0, 2 * side if slips else side, part * dt, W)
            add_segment(lane, 0, side if slips else 2 * side, (1.0 - part) * dt, W)
        else:
            add_segment(lane, 0, 2 * side if slips else side, dt, W)
        K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], v), min(K[lane, VMIN], v)
    K[lane, TQ] = 0.0 if t >= period else t  # the end of a period is the beginning of the next
    K[lane, RQ], K[lane, BQ] = ratio, b
    N[lane, FRESH] = 0


@typed(void(int64, f1, int64, i1))
def note_turns(lane, S, W, D):
    """Widen the extremes of the observed motion by where the velocity turns within the last step, in quarters of it."""
    K, at, part, begin = K_of(W), D[F_K] + lane, part_made(lane, S, D), 0.0
    before = S[at + D[LANES]]
    for quarter in range(1, 5):
        end = 0.25 * quarter * part
        slope = slope_on_step(at, end, S, D)
        if before * slope < 0.0:
            v = value_where_it_turns(at, begin, end, before, begin + (end - begin) * before / (before - slope), S, D)
            K[lane, VMAX], K[lane, VMIN] = max(K[lane, VMAX], v), min(K[lane, VMIN], v)
        begin, before = end, slope


@typed(float64(int64, int64, f1, i1))
def place_of(lane, p, S, D):
    """Place 0 is the position of the body, or of the centre of mass; place 1 + j that of coordinate j."""
    L, j = D[LANES], p - 1
    if p == 0:
        return way_of(lane, S, D)
    if D[CYCLIC] == 0:
        return S[D[F_Y] + (D[STATES] - D[COORDINATES] + j) * L + lane]
    return S[D[F_X] + lane] + (S[D[F_Y] + (D[STATES] - D[COORDINATES] + j) * L + lane] if j > 0 else 0.0)


@typed(void(int64, int64, f1, int64, i1))
def keep_places(lane, row, S, W, D):
    """Where everything is, as a row of XS."""
    XS = XS_of(W)
    for p in range(D[PLACES]):
        XS[lane, row, p] = place_of(lane, p, S, D)


@typed(void(int64, int64, f1, int64, i1))
def keep_moved(lane, row, S, W, D):
    """How far each coordinate went since a row of XS was kept."""
    N, XS, OUT = N_of(W), XS_of(W), OUT_of(W)
    for p in range(1, D[PLACES]):
        OUT[N[lane, CASE], 8 + D[STATES] + D[KEPT_MODES] + p] = place_of(lane, p, S, D) - XS[lane, row, p]
