# Periodic motions under Coulomb friction without waiting: text that follows coulomb_harmonic_looks.py in one kernel, never imported.
# ruff: noqa: F821
# mypy: ignore-errors
"""The strobe point of the periodic motion by formula, then one motion period from it.

Where break-away is at the sliding friction, two motions can only come nearer to each other, so there is one periodic motion and it is
the one that every start ends in (for friction above zero). It either never rests (type IV), and then its reversals are known
(analysis/closed_form.py), or it rests, and then it leaves the weaker side's rest at the phase of break-away. Whatever the formula gave,
the motion period that follows must come back to its strobe point; else the case is left to the mode machine.
"""


@typed(float64(f1))
def never_resting(row):
    """w at phase 0 of the motion that never rests; not a number if there is none.

    The forward slide lasts 2 delta = 2 pi r_minus/(r_plus + r_minus), around the phase c with sin c = r_plus delta/sin delta, cos c < 0.
    """
    plus, minus = row[0], row[1]
    delta = math.pi * minus / (plus + minus)
    small = min(delta, math.pi - delta)
    middle = (plus * delta if delta <= 0.5 * math.pi else minus * (math.pi - delta)) / math.sin(small)
    if not middle <= 1.0:
        return math.nan
    c = math.pi - math.asin(middle)
    begin, end = c - delta, c + delta
    if not (math.sin(begin) >= row[2] and math.sin(end) <= -row[3]):
        return math.nan
    if begin < 0.0:
        return math.cos(begin) - 1.0 + plus * begin
    if end > TAU:
        return math.cos(begin) - 1.0 - plus * (TAU - begin)
    return math.cos(end) - 1.0 + minus * (TAU - end)


@typed(Tuple((float64, float64, float64, boolean))(f1, f1, float64, float64, float64, float64))
def travels(q, last, phase, w, s, c):
    """Run to the end of the drive period: w there, and the distances travelled forwards and backwards; False if there are too many arcs."""
    ahead, back = 0.0, 0.0
    for _ in range(STEPS):
        phase, w, s, c, moved, mode = arc(q, last, phase, w, s, c)
        if mode > 0:
            ahead += moved
        elif mode < 0:
            back -= moved
        if phase >= TAU:
            return w, ahead, back, True
    return w, ahead, back, False


@typed(float64(f1, f1, f1))
def strobe_point(row, q, last):
    """w at phase 0 of the periodic motion, if break-away is at the sliding friction."""
    if row[2] >= 1.0 and row[3] >= 1.0:
        return 0.0
    w = never_resting(row)
    if w == w:
        return w
    away = AWAY if row[2] <= row[3] else AWAY_BACK
    return travels(q, last, q[away], 0.0, q[away + 2], q[away + 3])[0]


@typed(void(f2, i1, int64, int64, float64, f2, i2, f2, b2))
def orbits(rows, known, i0, i1, tolerance, out, count, seg_time, seg_code):
    """Cases i0 to i1, rows as for `run`. Where known[i] > 0, row[5] is a strobe point of a motion of that period; else it is found.

    out: displacement over the motion period, its drive periods, largest and smallest w, margin, misfit of the strobe point, distance
    travelled forwards, and backwards. count: status (REPEATS, or BUDGET: left to the mode machine), period, periods run, segments.
    """
    q, last = np.empty(CONSTANTS), np.empty(2)
    for i in range(i0, i1):
        row = rows[i]
        prepare(row, q)
        last[0], last[1] = -1.0, -1.0
        number = max(known[i], 1)
        w = row[5] if known[i] > 0 else strobe_point(row, q, last)
        w1, ahead, back, good = w, 0.0, 0.0, True
        for _ in range(number):
            w1, forth, away, fine = travels(q, last, 0.0, w1, 0.0, 1.0)
            ahead, back, good = ahead + forth, back + away, good and fine
        misfit = abs(w1 - w)
        good = good and misfit <= tolerance * (1.0 + abs(w))
        count[i, 3] = observe(q, row, last, w, number, seg_time[i], seg_code[i], out[i]) if good else 0
        out[i, 1], out[i, 5], out[i, 6], out[i, 7] = number, misfit, ahead, back
        count[i, 0], count[i, 1], count[i, 2] = REPEATS if good else BUDGET, number, number
