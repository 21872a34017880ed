"""The extremes of a state within the last step of a lane, on its dense output: text of the driver, and of what parts share."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A polynomial's coefficients stand at S[at + m * D[LANES]], m = 0 .. D[DEGREE], in powers of the part of the step.

SURELY = 0.25  # of how far a cubic turns beyond the ends of a step: it may be wrong by a tenth of that
WELL = 1e-4  # of a step: Newton's method is then within 1e-8 of where it turns, and the value there known to 1e-16 of its change


@njit(float64(int64, float64, f1, i1), **OPTIONS)
def on_step(at, x, S, D):
    """The value at a part of the step."""
    L, degree = D[LANES], D[DEGREE]
    value = S[at + degree * L]
    for m in range(degree - 1, -1, -1):
        value = fma(value, x, S[at + m * L])
    return value


@njit(float64(int64, float64, f1, i1), **OPTIONS)
def slope_on_step(at, x, S, D):
    """The slope at a part of the step."""
    L, degree = D[LANES], D[DEGREE]
    value = degree * S[at + degree * L]
    for m in range(degree - 1, 0, -1):
        value = fma(value, x, m * S[at + m * L])
    return value


@njit(float64(int64, float64, float64, float64, float64, f1, i1), **OPTIONS)
def value_where_it_turns(at, a, b, da, db, S, D):
    """The value between two parts of the step whose slopes differ in sign: Newton's method, held in the bracket."""
    L, degree = D[LANES], D[DEGREE]
    x = a + (b - a) * da / (da - db)
    for _ in range(60):
        slope, bend = degree * S[at + degree * L], 0.0
        for m in range(degree - 1, 0, -1):
            bend = fma(bend, x, slope)
            slope = fma(slope, x, m * S[at + m * L])
        if slope * da > 0.0:
            a = x
        else:
            b = x
        new = x - slope / bend if bend != 0.0 else a
        if not (new >= a and new <= b):
            new = 0.5 * (a + b)
        moved, x = abs(new - x), new
        if moved <= WELL:
            break
    return on_step(at, x, S, D)


@njit(int64(int64, i1), **OPTIONS)
def wide(b, D):
    """Where a body's extremes in the window begin, behind the fields of the step: the largest velocity of each lane, the smallest."""
    return (D[FIELDS] + 2 * b) * D[LANES]


@njit(void(int64, float64, f1, i1), **OPTIONS)
def widen_by(high, value, S, D):
    """Widen a range by a value."""
    S[high], S[high + D[LANES]] = max(S[high], value), min(S[high + D[LANES]], value)


@njit(void(int64, int64, float64, f1, i1), **OPTIONS)
def widen_on_step(high, at, part, S, D):
    """Widen the largest value at S[high], and the smallest one behind it, by a polynomial from the step's beginning to a part of it."""
    reach, bend = 0.0, 0.0
    for m in range(2, D[DEGREE] + 1):
        c = abs(S[at + m * D[LANES]])
        reach += c
        bend += m * (m - 1) * c
    if may_widen(high, at, reach, S, D):
        widen_within(high, at, part, on_step(at, part, S, D), slope_on_step(at, part, S, D), bend, S, D)


@njit(boolean(int64, int64, float64, f1, i1), **OPTIONS)
def may_widen(high, at, reach, S, D):
    """Whether a polynomial may leave the range so far, whose terms from the second power on are `reach` together."""
    first, whole = S[at], reach + abs(S[at + D[LANES]])
    return not (first + whole <= S[high] and first - whole >= S[high + D[LANES]])


@njit(boolean(int64, float64, float64, float64, float64, f1, i1), **OPTIONS)
def turns_outside(high, first, last, before, after, S, D):
    """Whether a step that turns once may leave the range there: by the cubic with its values and slopes at both ends, and a part."""
    rise = last - first
    a, b = before + after - 2.0 * rise, 3.0 * rise - 2.0 * before - after
    root = math.sqrt(max(b * b - 3.0 * a * before, 0.0))
    x = before / (root - b) if before > 0.0 else -before / (root + b)
    value = fma(fma(fma(a, x, b), x, before), x, first)
    if before > 0.0:
        return not value + SURELY * (value - max(first, last)) <= S[high]
    return not value - SURELY * (min(first, last) - value) >= S[high + D[LANES]]


@njit(void(int64, int64, float64, float64, float64, float64, f1, i1), **OPTIONS)
def widen_within(high, at, part, last, after, bend, S, D):
    """The same of one that may; `last` and `after` are its value and its slope at the end, its curvature is `bend` at most."""
    first, before = S[at], S[at + D[LANES]]
    S[high], S[high + D[LANES]] = max(S[high], max(first, last)), min(S[high + D[LANES]], min(first, last))
    half = 0.5 * part
    if before * after >= 0.0 and abs(before) + abs(after) > bend * part:  # it rises all along, or falls
        return
    if before * after < 0.0:
        if turns_outside(high, first, last, part * before, part * after, S, D):
            widen_by(high, value_where_it_turns(at, 0.0, part, before, after, S, D), S, D)
        return
    middle = slope_on_step(at, half, S, D)
    if before * middle < 0.0:  # it turns twice
        widen_by(high, value_where_it_turns(at, 0.0, half, before, middle, S, D), S, D)
        widen_by(high, value_where_it_turns(at, half, part, middle, after, S, D), S, D)
        return
    change = max(abs(middle - before), abs(after - middle))
    if min(abs(before), min(abs(middle), abs(after))) < 0.5 * change:  # it may turn twice in one of the halves
        early, late = slope_on_step(at, 0.5 * half, S, D), slope_on_step(at, 1.5 * half, S, D)
        if before * early < 0.0:
            widen_by(high, value_where_it_turns(at, 0.0, 0.5 * half, before, early, S, D), S, D)
            widen_by(high, value_where_it_turns(at, 0.5 * half, half, early, middle, S, D), S, D)
        if middle * late < 0.0:
            widen_by(high, value_where_it_turns(at, half, 1.5 * half, middle, late, S, D), S, D)
            widen_by(high, value_where_it_turns(at, 1.5 * half, part, late, after, S, D), S, D)


@njit(float64(int64, f1, i1), **OPTIONS)
def part_made(lane, S, D):
    """The part of its last step that a lane made: less than 1 where something switched within it, 0 where it was refused."""
    if S[D[F_STAT] + lane] == 1.0:
        return 1.0
    begin, end = S[D[F_T0] + lane], S[D[F_T] + lane]
    return (end - begin) / S[D[F_HH] + lane] if end != begin else 0.0
