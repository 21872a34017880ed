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


@typed(void(int64, int64, float64, float64, float64, float64, f1, i1))
def widen_within(high, at, part, last, after, bend, S, D):
    """The same of one that may; `last` and `after` are its value and its slope at the end of the part, its curvature is `bend` at most.

    With slopes of two signs it turns once. The cubic with its values and slopes at both ends says where, and whether that is far within
    the range. With slopes of one sign it may turn twice: quarters are looked at.
    """
    first, before, a, pieces = S[at], S[at + D[LANES]], 0.0, 1
    widen_by(high, first, S, D)
    widen_by(high, last, S, D)
    sign = 1.0 if before > 0.0 else -1.0
    x = 0.0
    if before * after < 0.0:
        rise = last - first
        p, q = part * (before + after) - 2.0 * rise, 3.0 * rise - part * (2.0 * before + after)
        x = part * before / (sign * math.sqrt(max(q * q - 3.0 * p * part * before, 0.0)) - q)
        value = fma(fma(fma(p, x, q), x, part * before), x, first)
        end = max(first, last) if before > 0.0 else min(first, last)
        reached = S[high] if before > 0.0 else S[high + D[LANES]]
        if sign * (value + SURELY * (value - end) - reached) <= 0.0:
            return
        x = min(max(part * x, 0.0), part)
    else:
        if abs(before) + abs(after) > bend * part:  # it rises all along, or falls
            return
        pieces = 4
    for piece in range(1, pieces + 1):
        b = part * piece / pieces
        slope = after if piece == pieces else slope_on_step(at, b, S, D)
        if before * slope < 0.0:
            begin = x if pieces == 1 else a + (b - a) * before / (before - slope)
            widen_by(high, value_where_it_turns(at, a, b, before, begin, S, D), S, D)
        a, before = b, slope


@typed(float64(int64, f1, i1))
def part_made(lane, S, D):
    """The part of its last step that a lane made: less than 1 where something switched within it, 0 where it was refused."""
    if S[D[F_STAT] + lane] == 1.0:
        return 1.0
    begin, end = S[D[F_T0] + lane], S[D[F_T] + lane]
    return (end - begin) / S[D[F_HH] + lane] if end != begin else 0.0
