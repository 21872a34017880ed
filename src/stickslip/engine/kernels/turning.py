"""The extremes of a state within the last step of a lane, on its dense output: text of the driver, and of what parts share."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A polynomial's coefficients stand at S[at + m * D[LANES]], m = 0 .. D[DEGREE], in powers of the part of the step.

SURELY = 0.25  # of how far a cubic turns beyond the ends of a step: it may be wrong by a tenth of that
WELL = 1e-4  # of a step: Newton's method is then within 1e-8 of where it turns, and the value there known to 1e-16 of its change


@typed(float64(int64, float64, f1, i1))
def on_step(at, x, S, D):
    """The value at a part of the step."""
    L, degree = D[LANES], D[DEGREE]
    value = S[at + degree * L]
    for m in range(degree - 1, -1, -1):
        value = fma(value, x, S[at + m * L])
    return value


@typed(float64(int64, float64, f1, i1))
def slope_on_step(at, x, S, D):
    """The slope at a part of the step."""
    L, degree = D[LANES], D[DEGREE]
    value = degree * S[at + degree * L]
    for m in range(degree - 1, 0, -1):
        value = fma(value, x, m * S[at + m * L])
    return value


@typed(float64(int64, float64, float64, float64, float64, f1, i1))
def value_where_it_turns(at, a, b, rising, x, S, D):
    """The value between two parts of the step where the slope, whose sign at the first is that of `rising`, is zero: Newton from x."""
    L, degree = D[LANES], D[DEGREE]
    value, change = S[at], 0.0
    for _ in range(60):
        value, slope, bend, twist = S[at + degree * L], 0.0, 0.0, 0.0  # a half of the curvature, a sixth of the next derivative
        for m in range(degree - 1, -1, -1):
            twist = fma(twist, x, bend)
            bend = fma(bend, x, slope)
            slope = fma(slope, x, value)
            value = fma(value, x, S[at + m * L])
        if slope * rising > 0.0:
            a = x
        else:
            b = x
        change, enough = -0.5 * slope / bend if bend != 0.0 else math.inf, WELL
        if not (x + change >= a and x + change <= b):
            change, enough = 0.5 * (a + b) - x, WELL * WELL
        if abs(change) <= enough:
            break
        x += change
    return fma(fma(fma(twist, change, bend), change, slope), change, value)


@typed(int64(int64, i1))
def wide(b, D):
    """Where a body's extremes in the window begin, behind the fields of the step: the largest velocity of each lane, the smallest."""
    return (D[FIELDS] + 2 * b) * D[LANES]


@typed(void(int64, float64, f1, i1))
def widen_by(high, value, S, D):
    """Widen a range by a value."""
    S[high], S[high + D[LANES]] = max(S[high], value), min(S[high + D[LANES]], value)


@typed(void(int64, int64, float64, f1, i1))
def widen_on_step(high, at, part, S, D):
    """Widen the largest value at S[high], and the smallest one behind it, by a polynomial from the step's beginning to a part of it."""
    L, last, after, bend = D[LANES], S[at] + S[at + D[LANES]], S[at + D[LANES]], 0.0
    for m in range(2, D[DEGREE] + 1):
        c = S[at + m * L]
        last += c
        after += m * c
        bend += m * (m - 1) * abs(c)
    if may_widen(high, S[at], last, S[at + L], after, bend, S, D):
        if part != 1.0:
            last, after = on_step(at, part, S, D), slope_on_step(at, part, S, D)
        widen_within(high, at, part, last, after, bend, S, D)


@typed(boolean(int64, float64, float64, float64, float64, float64, f1, i1))
def may_widen(high, first, last, before, after, bend, S, D):
    """Whether a polynomial on the unit interval may leave the range so far, with its values and slopes at both ends.

    Its curvature is `bend` at most. With slopes that are larger together it rises all along, or falls; it is never further from the
    straight line between its ends than an eighth of `bend`.
    """
    beside = 0.0 if before * after >= 0.0 and abs(before) + abs(after) > bend else 0.125 * bend
    return not (max(first, last) + beside <= S[high] and min(first, last) - beside >= S[high + D[LANES]])


@typed(float64(float64, float64, float64, float64))
def where_cubic_turns(rise, before, after, sign):
    """Where the cubic on the unit interval turns that rises so much, and has these slopes of different signs at its ends."""
    a, b = before + after - 2.0 * rise, 3.0 * rise - 2.0 * before - after
    root = math.sqrt(max(b * b - 3.0 * a * before, 0.0))
    return before / (sign * root - b)


@typed(void(int64, int64, float64, float64, float64, float64, f1, i1))
def widen_within(high, at, part, last, after, bend, S, D):
    """The same of one that may; `last` and `after` are its value and its slope at the end of the part, its curvature is `bend` at most."""
    first, before, L = S[at], S[at + D[LANES]], D[LANES]
    widen_by(high, first, S, D)
    widen_by(high, last, S, D)
    half = 0.5 * part
    if before * after < 0.0:
        rise, sign = last - first, 1.0 if before > 0.0 else -1.0
        x = where_cubic_turns(rise, part * before, part * after, sign)
        a, b = part * (before + after) - 2.0 * rise, 3.0 * rise - part * (2.0 * before + after)
        value = fma(fma(fma(a, x, b), x, part * before), x, first)
        end = max(first, last) if before > 0.0 else min(first, last)
        least = S[high] if before > 0.0 else -S[high + L]
        if not sign * (value + SURELY * (value - end)) <= least:
            widen_by(high, value_where_it_turns(at, 0.0, part, before, min(max(part * x, 0.0), part), S, D), S, D)
        return
    if abs(before) + abs(after) > bend * part:  # it rises all along, or falls
        return
    middle = slope_on_step(at, half, S, D)
    if before * middle < 0.0:  # it turns twice
        widen_between(high, at, 0.0, half, before, middle, S, D)
        widen_between(high, at, half, part, middle, after, S, D)
        return
    change = max(abs(middle - before), abs(after - middle))
    if min(abs(before), min(abs(middle), abs(after))) < 0.5 * change:  # it may turn twice in one of the halves
        early, late = slope_on_step(at, 0.5 * half, S, D), slope_on_step(at, 1.5 * half, S, D)
        if before * early < 0.0:
            widen_between(high, at, 0.0, 0.5 * half, before, early, S, D)
            widen_between(high, at, 0.5 * half, half, early, middle, S, D)
        if middle * late < 0.0:
            widen_between(high, at, half, 1.5 * half, middle, late, S, D)
            widen_between(high, at, 1.5 * half, part, late, after, S, D)


@typed(void(int64, int64, float64, float64, float64, float64, f1, i1))
def widen_between(high, at, a, b, before, after, S, D):
    """Widen a range by the value between two parts of the step whose slopes differ in sign."""
    widen_by(high, value_where_it_turns(at, a, b, before, a + (b - a) * before / (before - after), S, D), S, D)


@typed(float64(int64, f1, i1))
def part_made(lane, S, D):
    """The part of its last step that a lane made: less than 1 where something switched within it, 0 where it was refused."""
    if S[D[F_STAT] + lane] == 1.0:
        return 1.0
    begin, end = S[D[F_T0] + lane], S[D[F_T] + lane]
    return (end - begin) / S[D[F_HH] + lane] if end != begin else 0.0
