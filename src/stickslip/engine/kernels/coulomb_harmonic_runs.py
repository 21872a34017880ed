# Runs of the mode machine: text that follows coulomb_harmonic_looks.py in one kernel, loaded by engine/cache.py, never imported.
# ruff: noqa: F821
# mypy: ignore-errors
"""A batch without trajectories, and one case with all its arcs."""

WITHIN = 1e-13  # a displacement in a period this near to the one approached: the window holds a steady motion


@typed(Tuple((float64, float64, boolean))(f1, f1, float64))
def one_period(q, last, w):
    """w and the displacement after one drive period; False if it has too many arcs."""
    phase, s, c, x = 0.0, 0.0, 1.0, 0.0
    for _ in range(STEPS):
        phase, w, s, c, moved, _ = arc(q, last, phase, w, s, c)
        x += moved
        if phase >= TAU:
            return w, x, True
    return w, x, False


@typed(void(f1, f1, f1, float64, int64, int64, f1, b1, f1))
def wide(q, row, last, w, settle, periods, seg_time, seg_code, out):
    """What `observe` finds over the whole window: the run once more, from its start."""
    for _ in range(settle):
        w = one_period(q, last, w)[0]
    observe(q, row, last, w, periods - settle, seg_time, seg_code, out)


@typed(float64(f2, int64, int64, f1))
def remaining(points, n, p, unit):
    """Estimated distance of w from the periodic state: the last change over p periods times rate/(1 - rate)."""
    d2, d1, d0 = apart(points, n, p, 1, unit), 0.0, 0.0
    if d2 == 0.0:
        return 0.0
    if n >= 4 * p:
        d1, d0 = apart(points, n - p, p, 1, unit), apart(points, n - 2 * p, p, 1, unit)
    rate = max(d2 / d1, d1 / d0)  # not a number or infinite where there is none
    return d2 * rate / (1.0 - rate) if rate < 1.0 else math.inf


@typed(UniTuple(float64, 2)(float64, float64, float64))
def add(total, excess, term):
    """Kahan's sum: the new total, and by how much it is too large."""
    term -= excess
    new = total + term
    return new, (new - total) - term


@typed(UniTuple(int64, 3)(f1, f1, f2, f1, f1, f1, f1, int64, int64, boolean, boolean))
def follow(q, last, points, early, sums, scale, unit, periods, settle, auto, skip):
    """Run up to `periods` drive periods from the strobe point points[0]: periods done, period number (0: not asked for), status.

    sums receives the displacement over the window after `settle`, and over all; early the window's first periods one by one.
    `auto` stops at the repeated strobe point. `skip`: the same point to the last bit means the same period over and over.
    """
    w, n, window, x, excess, excess_x = points[0, 1], 0, 0.0, 0.0, 0.0, 0.0
    status, p = FINISHED, 0
    while n < periods and p == 0 and status == FINISHED:
        before = w
        w, moved, good = one_period(q, last, w)
        n += 1
        x, excess_x = add(x, excess_x, moved)
        points[n % KEPT, 0], points[n % KEPT, 1] = x, w
        if not good:
            status = BUDGET
        elif w - w != 0.0:
            status = NOT_A_NUMBER
        elif auto:
            scale[0] = 1.0 + abs(w)
            if remaining(points, n, 1, unit) <= 1e-14 * scale[0] or abs(w - before) <= 4e-16 * scale[0]:
                p = 1
            elif n % 64 == 0:
                p = period_number(points, n, KEPT - 1, LONGEST, scale, 1e-13, 1e-13)[0]
        elif n > settle:
            if n - settle <= LONGEST:
                early[n - settle - 1] = moved
            window, excess = add(window, excess, moved)
        if skip and not auto and w == before:
            x, excess_x = add(x, excess_x, moved * (periods - n))
            window, excess = add(window, excess, moved * min(periods - n, periods - settle))
            for k in range(max(n - settle, 0), LONGEST):
                early[k] = moved
            n = periods
            for k in range(KEPT):
                points[(n - k) % KEPT, 0], points[(n - k) % KEPT, 1] = x - k * moved, w
    sums[0], sums[1], scale[0] = window, x, 1.0 + abs(w)
    return n, p, status


@typed(void(f2, int64, int64, int64, int64, boolean, boolean, float64, f2, i2, f2, b2))
def run(rows, i0, i1, periods, settle, auto, skip, tolerance, out, count, seg_time, seg_code):
    """Cases i0 to i1 of a batch; everything dimensionless.

    rows: r_plus, r_minus, s_plus, s_minus, gamma, w at the start. out: displacement over the window (`auto`: over the last motion
    period), its periods, largest and smallest w and the margin of the last motion period, estimated distance from the periodic
    state, displacement in all, w at the end, displacement in a drive period that the motion approaches, extremes of w over the
    window. count: status, period number, periods run, segments.
    """
    q, last, points, early, sums = np.empty(CONSTANTS), np.empty(2), np.zeros((KEPT, 2)), np.empty(LONGEST), np.empty(2)
    scale, unit = np.zeros(2), np.zeros(2)
    scale[0], unit[0] = 1.0, 1.0
    scratch, scratch_time, scratch_code = np.empty(out.shape[1]), np.empty(SEGS), np.empty(SEGS, dtype=np.int8)
    for i in range(i0, i1):
        row = rows[i]
        prepare(row, q)
        last[0], last[1] = -1.0, -1.0
        points[0, 0], points[0, 1] = 0.0, row[5]
        n, p, status = follow(q, last, points, early, sums, scale, unit, periods, settle, auto, skip)
        out[i, 7] = points[n % KEPT, 1]
        for k in range(6):
            out[i, k] = math.nan
        count[i, 3], out[i, 8], out[i, 9], out[i, 10] = 0, math.nan, math.nan, math.nan
        if status == FINISHED:
            status = REPEATS if p > 0 else FINISHED
            repeated, out[i, 8] = outcome(points, n, min(n, KEPT - 1), LONGEST, scale, tolerance, tolerance)
            p = p if p > 0 else repeated
            number = min(max(p, 1), n)
            out[i, 1], out[i, 5] = number, remaining(points, n, number, unit)
            begin = n if status == REPEATS else n - number  # where it repeats, the next motion period is the best one yet
            count[i, 3] = observe(q, row, last, points[begin % KEPT, 1], number, seg_time[i], seg_code[i], out[i])
            out[i, 9], out[i, 10] = out[i, 2], out[i, 3]
            if not auto and not (p > 0 and abs(sums[0] - out[i, 8] * (periods - settle)) <= WITHIN * (periods - settle)):
                wide(q, row, last, row[5], settle, periods, scratch_time, scratch_code, scratch)
                out[i, 9], out[i, 10] = max(out[i, 2], scratch[2]), min(out[i, 3], scratch[3])
            if status == REPEATS:
                n += number
                sums[1] += out[i, 0]
                out[i, 8] = out[i, 0] / number
            if not auto:
                first = (periods - settle) % number
                first = first if first < periods - settle else 0
                for k in range(first):
                    sums[0] -= early[k]
                out[i, 0], out[i, 1] = sums[0], periods - settle - first
        out[i, 6] = sums[1]
        count[i, 0], count[i, 1], count[i, 2] = status, p, n


@typed(UniTuple(int64, 2)(f1, f1, int64, int64, i1, f2, i1))
def record(row, state, n, periods, number, arcs, mode):
    """The arcs of one case from period n on, as many as there is room for: drive period, (phase, displacement, w) and mode of each.

    state holds w, the displacement and its excess, and the last zeros; the next call goes on from it. Returns (arcs, next period);
    (-1, period) if one has too many arcs.
    """
    q, last = np.empty(CONSTANTS), np.empty(2)
    prepare(row, q)
    last[0], last[1] = state[3], state[4]
    w, x, excess, i = state[0], state[1], state[2], 0
    while n < periods and i + STEPS <= len(mode):
        phase, s, c, steps = 0.0, 0.0, 1.0, 0
        while phase < TAU:
            number[i], arcs[i, 0], arcs[i, 1], arcs[i, 2] = n, phase, x, w
            phase, w, s, c, moved, mode[i] = arc(q, last, phase, w, s, c)
            x, excess = add(x, excess, moved)
            i, steps = i + 1, steps + 1
            if steps >= STEPS:
                return -1, n
        n += 1
    state[0], state[1], state[2], state[3], state[4] = w, x, excess, last[0], last[1]
    return i, n
