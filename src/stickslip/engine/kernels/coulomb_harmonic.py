# Exact stick-slip under Coulomb friction and a harmonic drive: text of a kernel, loaded by engine/cache.py, never imported.
# ruff: noqa: F821
# mypy: ignore-errors
"""The mode machine of w' = sin(tau) - r, with r = r_plus for w > 0 and -r_minus for w < 0 (Eqs 2.3 and 2.4).

The body sticks while -s_minus <= sin(tau) <= s_plus. All arcs are closed formulas; only the instants at which w comes
to zero are searched. Time is counted as whole drive periods and a phase in [0, 2 pi], so nothing is lost on long runs.

Backward motion is forward motion of u = -w, with the signs S, C of sin and cos turned: u' = S(tau) - r. From the start
of an arc (phase, u, S, C), with q = S - r and d = tau - phase,
    u(d) = u + q d - S (d - sin d) + C (1 - cos d),   displacement = u d + q d^2/2 - S (d^2/2 - 1 + cos d) + C (d - sin d),
where no term cancels, so the shortest slips keep their digits. u can only come to zero where it falls: between the turning
points S = r. The value at the end of each falling stretch says whether there is a zero in it: none is missed, and the
zero at the start of an arc is never found again.
"""

TAU = 2.0 * math.pi
STEPS = 256  # arcs in one period beyond which a case is given up (7 are possible)
# One row of constants: for each side (forward at 0, backward at 8) resistance, first falling stretch (begin, end, C at its
# end), second one (begin, end, C), cos at the turning points; then for each side where rest breaks away (phase, end of it, sin, cos).
BACK, AWAY, AWAY_BACK, GAMMA, CONSTANTS = 8, 16, 20, 24, 25


@typed(UniTuple(float64, 4)(float64), fused=True)
def trig(d):
    """sin d, d - sin d, 1 - cos d and d^2/2 - 1 + cos d for 0 <= d <= 2 pi, each to a few units of its own last place."""
    k = math.floor(d * 0.6366197723675814 + 0.5)
    y = (d - k * 1.57079632673412561417e00) - k * 6.07710050650619224932e-11
    z = y * y
    p = 2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    p = -1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * p))
    c = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
    c = 4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * c))
    bend = y * z * p  # sin y - y
    lift = z * z * c  # cos y - 1 + y^2/2
    if k == 0.0:
        return y + bend, -bend, 0.5 * z - lift, lift
    sine, cosine = y + bend, 1.0 - (0.5 * z - lift)
    if k == 1.0:
        sine, cosine = cosine, -sine
    elif k == 2.0:
        sine, cosine = -sine, -cosine
    elif k == 3.0:
        sine, cosine = -cosine, sine
    return sine, d - sine, 1.0 - cosine, 0.5 * d * d - (1.0 - cosine)


@typed(void(f1, f1))
def prepare(row, q):
    """The constants of a case from its row (r_plus, r_minus, s_plus, s_minus, gamma, ...)."""
    for side in range(2):
        r, s = row[side], row[2 + side]
        base, away, shift = BACK * side, AWAY + 4 * side, math.pi * side
        turn = math.asin(min(1.0, max(-1.0, r)))
        level = math.asin(min(1.0, max(-1.0, s)))
        level = max(level, turn)  # rest breaks away only where the body then gathers speed
        rise, fall = shift + turn, shift + math.pi - turn  # u rises between these phases
        q[base] = r
        q[base + 7] = math.sqrt((1.0 - r) * (1.0 + r)) if abs(r) < 1.0 else 0.0
        q[base + 4], q[base + 5], q[base + 6] = fall, TAU, 1.0 - 2.0 * side
        q[base + 1], q[base + 2], q[base + 3] = 0.0, rise, q[base + 7]
        if rise < 0.0 or fall > TAU:  # r < 0: one falling stretch within the period
            q[base + 1], q[base + 2] = fall if rise < 0.0 else fall - TAU, rise + TAU if rise < 0.0 else rise
            q[base + 5] = -1.0
        q[away], q[away + 1] = shift + level, shift + math.pi - level
        if q[away] < 0.0:
            q[away] += TAU
        if q[away + 1] > TAU:
            q[away + 1] -= TAU
        q[away + 2] = s * (1.0 - 2.0 * side)
        q[away + 3] = math.sqrt((1.0 - s) * (1.0 + s)) * (1.0 - 2.0 * side) if abs(s) < 1.0 else 0.0
        if s >= 1.0:
            q[away], q[away + 1] = 9.0, -1.0  # never
        elif s <= -1.0:
            q[away], q[away + 1] = -1.0, 9.0  # always
    q[GAMMA] = row[4]


@typed(boolean(float64, float64, float64))
def within(phase, begin, end):
    """Whether a phase lies in [begin, end), which may reach across the end of the period."""
    if begin <= end:
        return phase >= begin and phase < end
    return phase >= begin or phase < end


@typed(UniTuple(float64, 4)(float64, float64, float64, float64, float64, float64, float64), fused=True)
def zero(u, q, S, C, lo, hi, x):
    """The zero of u(d) in [lo, hi], u(lo) > 0 >= u(hi), from the guess x: Halley's steps, else halving.

    Returns d, S and C there, and the displacement.
    """
    step, sine, short, cosine1, lift, f, slope = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for trial in range(160):
        sine, short, cosine1, lift = trig(x)
        f = u + q * x - S * short + C * cosine1
        slope = q - S * cosine1 + C * sine
        bend = C - C * cosine1 - S * sine
        if f > 0.0:
            lo = x
        else:
            hi = x
        t = 0.5 * f * bend
        square = slope * slope
        step = -f * slope / (square - t)
        new = x + step
        near = abs(t) <= square and new >= lo and new <= hi  # else it may be a turning point that draws the steps
        if near and abs(t) <= 0.1 * square:
            t = t / square
            if abs(step) * (t * t + step * step / abs(slope)) <= 1e-17 * x or abs(step) <= 2.2e-16 * x:
                break
        if not near or trial > 8:
            step = 0.0
            new = 0.5 * (lo + hi)
            if new <= lo or new >= hi or hi - lo <= 1e-30:
                break
        x = new
    S1, C1 = S + C * sine - S * cosine1, C - C * cosine1 - S * sine
    moved = u * x + 0.5 * q * x * x - S * lift + C * short + step * (f + step * (0.5 * slope + step * C1 / 6.0))
    half = 0.5 * step * step
    return x + step, S1 + step * C1 - half * S1, C1 - step * S1 - half * C1, moved


@typed(UniTuple(float64, 5)(f1, f1, int64, float64, float64, float64, float64))
def slip(q, last, side, phase, u, S, C):
    """A sliding arc, to its zero or to the end of the period: new phase, u, S, C, and the displacement."""
    base = BACK * side
    r = q[base]
    begin, end, low = q[base + 1], q[base + 2], 1.0
    if phase < end:
        low = u + C - q[base + 3] - r * (end - phase)
    if low > 0.0 and phase < q[base + 5]:
        begin, end = q[base + 4], q[base + 5]
        low = u + C - q[base + 6] - r * (end - phase)
    if low > 0.0:
        d, sign = TAU - phase, 1.0 - 2.0 * side
        return TAU, max(u + C - sign - r * d, 0.0), 0.0, sign, (u + C) * d + S - 0.5 * r * d * d
    lo, hi = max(begin - phase, 0.0), end - phase
    x = last[side] - phase
    if not (x > lo and x < hi):  # no zero known from the period before: fall like a parabola from the top, or along the chord
        cosine = q[base + 7]
        top = u if lo == 0.0 else u + C + cosine - r * lo
        x = lo + math.sqrt(2.0 * max(top, 0.0) / cosine) if lo > 0.0 and cosine > 0.0 else hi
        if not (x > lo and x < hi):
            x = lo + (hi - lo) * top / (top - low)
        if not (x >= lo and x <= hi):
            x = 0.5 * (lo + hi)
    d, S1, C1, moved = zero(u, S - r, S, C, lo, hi, x)
    new = min(max(phase + d, begin), TAU)
    last[side] = new
    return new, 0.0, S1, C1, moved


@typed(Tuple((float64, float64, float64, float64, float64, int64))(f1, f1, float64, float64, float64, float64))
def arc(q, last, phase, w, s, c):
    """One arc of the mode machine, not beyond the end of the period: new phase, w, sin, cos, the displacement and the mode."""
    if w > 0.0 or (w == 0.0 and within(phase, q[AWAY], q[AWAY + 1])):
        new, u, S, C, moved = slip(q, last, 0, phase, w, s, c)
        return new, u, S, C, moved, 1
    if w < 0.0 or within(phase, q[AWAY_BACK], q[AWAY_BACK + 1]):
        new, u, S, C, moved = slip(q, last, 1, phase, -w, -s, -c)
        return new, 0.0 - u, 0.0 - S, 0.0 - C, 0.0 - moved, -1
    new, s, c = TAU, 0.0, 1.0
    for side in range(2):
        away = AWAY + 4 * side
        if q[away] > phase and q[away] < new:
            new, s, c = q[away], q[away + 2], q[away + 3]
    return new, 0.0, s, c, 0.0, 0
