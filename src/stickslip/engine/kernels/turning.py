"""The extremes of a state within the last step of a lane, on its dense output: text of the driver, and of what parts share."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# A polynomial's coefficients stand at S[at + m * D[LANES]], m = 0 .. D[DEGREE], in powers of the part of the step.

WELL = 1e-8  # of a step: the value where it turns is then known to 1e-16 of its change


@njit(float64(int64, float64, f1, i1), **OPTIONS)
def on_step(at, x, S, D):
    """The value at a part of the step."""
    L, degree = D[LANES], D[DEGREE]
    value = S[at + degree * L]
    for m in range(degree - 1, -1, -1):
        value = fma(value, x, S[at + m * L])
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
        bend += m * c
    if may_widen(high, at, reach, S, D):
        widen_within(high, at, part, bend, S, D)


@njit(boolean(int64, int64, float64, f1, i1), **OPTIONS)
def may_widen(high, at, reach, S, D):
    """Whether a polynomial may leave the range so far, whose terms from the second power on are `reach` together."""
    first, whole = S[at], reach + abs(S[at + D[LANES]])
    return not (first + whole <= S[high] and first - whole >= S[high + D[LANES]])


@njit(void(int64, int64, float64, float64, f1, i1), **OPTIONS)
def widen_within(high, at, part, bend, S, D):
    """The same of one that may; its slope changes by less than `bend`."""
    L, degree, low = D[LANES], D[DEGREE], high + D[LANES]
    one, two, three = 0.25 * part, 0.5 * part, 0.75 * part
    c = S[at + degree * L]
    last, d1, d2, d3, d4 = c, degree * c, degree * c, degree * c, degree * c
    for m in range(degree - 1, 0, -1):
        c = S[at + m * L]
        last = fma(last, part, c)
        d1, d2, d3, d4 = fma(d1, one, m * c), fma(d2, two, m * c), fma(d3, three, m * c), fma(d4, part, m * c)
    first, d0 = S[at], S[at + L]
    last = fma(last, part, first)
    S[high], S[low] = max(S[high], max(first, last)), min(S[low], min(first, last))
    if abs(d0) < bend:  # else it rises all along, or falls
        if d0 * d1 < 0.0:
            widen_by(high, value_where_it_turns(at, 0.0, one, d0, d1, S, D), S, D)
        if d1 * d2 < 0.0:
            widen_by(high, value_where_it_turns(at, one, two, d1, d2, S, D), S, D)
        if d2 * d3 < 0.0:
            widen_by(high, value_where_it_turns(at, two, three, d2, d3, S, D), S, D)
        if d3 * d4 < 0.0:
            widen_by(high, value_where_it_turns(at, three, part, d3, d4, S, D), S, D)


@njit(float64(int64, f1, i1), **OPTIONS)
def part_made(lane, S, D):
    """The part of its last step that a lane made: less than 1 where something switched within it, 0 where it was refused."""
    if S[D[F_STAT] + lane] == 1.0:
        return 1.0
    begin, end = S[D[F_T0] + lane], S[D[F_T] + lane]
    return (end - begin) / S[D[F_HH] + lane] if end != begin else 0.0
