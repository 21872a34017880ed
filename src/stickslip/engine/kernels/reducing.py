"""What is made on the way of the signals of several bodies and contacts, over the dense output of each step; text before lanes.py."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# Signals are functions of a law's kernel (`engine/observed.py`): slip ratios first, then what is reduced into FOUND[lane] (watching.py).
# HELD[lane] has the flags, modes and clocks with which the present step began. ROOM is where a step is looked at: a row for each of its
# instants, then some other place, the states there, the instants, and a row for each state with its values at all of them.

ELSEWHERE, STATES_THERE, INSTANTS, EACH_STATE = 8, 9, 10, 11  # rows of ROOM


@typed(float64(int64, int64, float64, f1, i1))
def state_at(lane, i, theta, S, D):
    """A state at a part of the last step."""
    L, degree = D[LANES], D[DEGREE]
    at = D[F_K] + i * (degree + 1) * L + lane
    value = S[at + degree * L]
    for m in range(degree - 1, -1, -1):
        value = fma(value, theta, S[at + m * L])
    return value


@typed(void(int64, f1, int64, f1, f1, int64, i1))
def look_at_all(lane, at, count, S, row, W, D):
    """All signals at several parts of the last step, each into its row of ROOM."""
    HELD, ROOM = HELD_of(W), ROOM_of(W)
    L, degree = D[LANES], D[DEGREE]
    for k in range(D[LOOKED]):
        i = D[D[LOOKED_AT] + k]
        first, values = D[F_K] + i * (degree + 1) * L + lane, ROOM[EACH_STATE + i]
        for j in range(8):
            values[j] = S[first + degree * L]
        for m in range(degree - 1, -1, -1):
            c = S[first + m * L]
            for j in range(8):
                values[j] = fma(values[j], at[j], c)
    for j in range(count):
        for k in range(D[LOOKED]):
            i = D[D[LOOKED_AT] + k]
            ROOM[STATES_THERE, i] = ROOM[EACH_STATE + i, j]
        t = fma(at[j], S[D[F_HH] + lane], S[D[F_T0] + lane])
        call_signals(D[AT_SIGNALS], row, t, ROOM[STATES_THERE], HELD[lane], ROOM[j])


@typed(void(int64, float64, int64, f1, f1, int64, i1))
def look_at(lane, theta, to, S, row, W, D):
    """All signals at a part of the last step, into a row of ROOM."""
    HELD, ROOM = HELD_of(W), ROOM_of(W)
    for k in range(D[LOOKED]):
        i = D[D[LOOKED_AT] + k]
        ROOM[STATES_THERE, i] = state_at(lane, i, theta, S, D)
    t = fma(theta, S[D[F_HH] + lane], S[D[F_T0] + lane])
    call_signals(D[AT_SIGNALS], row, t, ROOM[STATES_THERE], HELD[lane], ROOM[to])


@typed(float64(int64, int64, float64, f1, f1, int64, i1))
def signal_at(lane, k, theta, S, row, W, D):
    """One signal at a part of the last step; by its polynomial if it is a state."""
    ROOM = ROOM_of(W)
    i = D[D[STATE_OF] + k - D[RATIOS]] if k >= D[RATIOS] else -1
    if i >= 0:
        return state_at(lane, i, theta, S, D)
    look_at(lane, theta, ELSEWHERE, S, row, W, D)
    return ROOM[ELSEWHERE, k]


@typed(float64(int64, int64, float64, float64, float64, float64, float64, float64, float64, f1, f1, int64, i1))
def highest(lane, k, sign, a, b, c, va, vb, vc, S, row, W, D):
    """The largest value of a signal times `sign` between a and c, from one in the middle that is not below them: parabolas."""
    width = 1e-8 * (c - a)
    for _ in range(16):
        p, q = (b - a) * (vb - vc), (b - c) * (vb - va)
        x = b - 0.5 * ((b - a) * p - (b - c) * q) / (p - q) if p != q else 0.5 * (b + c)
        if abs(x - b) <= width or not (x > a and x < c):
            break
        v = sign * signal_at(lane, k, x, S, row, W, D)
        if v >= vb:
            if x > b:
                a, va = b, vb
            else:
                c, vc = b, vb
            b, vb = x, v
        elif x > b:
            c, vc = x, v
        else:
            a, va = x, v
    return vb


@typed(float64(int64, int64, float64, float64, float64, float64, float64, f1, f1, int64, i1))
def crossing(lane, k, level, a, b, va, vb, S, row, W, D):
    """Where a signal passes a level between a and b: regula falsi, with the end that stays weighed down."""
    fa, fb, x = va - level, vb - level, b
    for _ in range(60):
        x = b - fb * (b - a) / (fb - fa)
        if not (x > a and x < b):
            x = 0.5 * (a + b)
        f = signal_at(lane, k, x, S, row, W, D) - level
        if f == 0.0 or b - a <= 1e-12:
            break
        if (f > 0.0) == (fb > 0.0):
            b, fb, fa = x, f, 0.5 * fa
        else:
            a, fa, fb = x, f, 0.5 * fb
    return x


@typed(void(int64, float64, f1, int64, f1, f1, int64, i1))
def add_stretches(lane, h, at, count, S, row, W, D):
    """Lengthen the stretches of every contact by the last step, cut where a slip ratio passes its threshold."""
    HELD, ROOM = HELD_of(W), ROOM_of(W)
    slip_ratio = LIMITS_of(W)[SLIP_RATIO]
    for i in range(D[CONTACTS]):
        side = np.int64(HELD[lane, D[D[SIDES] + i]])
        if D[RATIOS] == 0:
            add_segment(lane, i, 2 * side, at[count - 1] * h, W)
            continue
        begin, slips = 0.0, ROOM[0, i] >= slip_ratio
        for j in range(1, count):
            if (ROOM[j, i] >= slip_ratio) != slips:
                x = crossing(lane, i, slip_ratio, at[j - 1], at[j], ROOM[j - 1, i], ROOM[j, i], S, row, W, D)
                add_segment(lane, i, 2 * side if slips else side, (x - begin) * h, W)
                begin, slips = x, not slips
        add_segment(lane, i, 2 * side if slips else side, (at[count - 1] - begin) * h, W)


@typed(float64(int64, int64, float64, float64, f1, int64, f1, f1, int64, i1))
def largest(lane, k, sign, known, at, count, S, row, W, D):
    """The largest value of a signal times `sign` in the last step, or what is known if that is more."""
    ROOM = ROOM_of(W)
    for j in range(count):
        known = max(known, sign * ROOM[j, k])
    for j in range(1, count - 1):
        a, b, c = at[j - 1], at[j], at[j + 1]
        va, vb, vc = sign * ROOM[j - 1, k], sign * ROOM[j, k], sign * ROOM[j + 1, k]
        if max(va, vb, vc) + 3.0 * (max(va, vb, vc) - min(va, vb, vc)) <= known:  # no parabola through them reaches it
            continue
        if not (vb >= va and vb >= vc):  # next to an end of the step it may rise and fall between two nodes
            p, q = (b - a) * (vb - vc), (b - c) * (vb - va)
            x = b - 0.5 * ((b - a) * p - (b - c) * q) / (p - q) if p > q else b
            if j == 1 and va > vb and x > a and x < b:
                b, c, vc = x, b, vb
            elif j == count - 2 and vc > vb and x > b and x < c:
                a, b, va = b, x, vb
            else:
                continue
            vb = sign * signal_at(lane, k, b, S, row, W, D)
            if not (vb >= va and vb >= vc):
                continue
        known = max(known, highest(lane, k, sign, a, b, c, va, vb, vc, S, row, W, D))
    return known


@typed(void(int64, f1, f1, int64, i1))
def reduce_step(lane, S, row, W, D):
    """Add what the last step of a lane did to all that is noted."""
    FOUND, ROOM = FOUND_of(W), ROOM_of(W)
    h = S[D[F_HH] + lane]
    part = part_made(lane, S, D)
    few = D[DEGREE] < 8
    inside = FEW_NODES.shape[0] if few else MANY_NODES.shape[0]
    count = inside + 2
    at = ROOM[INSTANTS]
    at[0], at[count - 1] = 0.0, part
    for j in range(inside):
        at[j + 1] = part * (FEW_NODES[j] if few else MANY_NODES[j])
    look_at_all(lane, at, count, S, row, W, D)
    add_stretches(lane, h, at, count, S, row, W, D)
    for s in range(D[SIGNALS]):
        k, kind = D[RATIOS] + s, D[D[KINDS] + s]
        if kind >= AT_GUARD:
            if S[D[F_FIRED] + lane] == kind - AT_GUARD:
                FOUND[lane, s, TOTAL] += 1.0
                FOUND[lane, s, LARGEST] = max(FOUND[lane, s, LARGEST], ROOM[count - 1, k])
            continue
        if kind & MEAN:
            total = 0.0
            for j in range(inside):
                total += (FEW_WEIGHTS[j] if few else MANY_WEIGHTS[j]) * ROOM[j + 1, k]
            FOUND[lane, s, TOTAL] += part * h * total
        if kind & COUNTED:  # how often it begins to be more than zero
            last = FOUND[lane, s, SMALLEST]
            for j in range(count):
                if last == 0.0 and ROOM[j, k] > 0.0:
                    FOUND[lane, s, TOTAL] += 1.0
                last = max(ROOM[j, k], 0.0)
            FOUND[lane, s, SMALLEST] = last
        if kind & LAST:
            FOUND[lane, s, SMALLEST] = ROOM[count - 1, k]
        if kind & MOST:
            FOUND[lane, s, LARGEST] = largest(lane, k, 1.0, FOUND[lane, s, LARGEST], at, count, S, row, W, D)
        if kind & LEAST:
            FOUND[lane, s, SMALLEST] = -largest(lane, k, -1.0, -FOUND[lane, s, SMALLEST], at, count, S, row, W, D)


@typed(void(int64, int64, i1))
def begin_signals(lane, W, D):
    """Nothing is known of the signals yet."""
    FOUND = FOUND_of(W)
    for s in range(D[SIGNALS]):
        kind = D[D[KINDS] + s]
        FOUND[lane, s, TOTAL] = 0.0
        FOUND[lane, s, LARGEST] = 0.0 if kind >= AT_GUARD else -math.inf
        FOUND[lane, s, SMALLEST] = math.nan if kind & COUNTED else math.inf


@typed(void(int64, f1, int64, i1))
def hold(lane, S, W, D):
    """Keep the flags, modes and clocks that hold in the step to come."""
    HELD = HELD_of(W)
    L, n = D[LANES], D[SIGNS]
    for k in range(n):
        HELD[lane, k] = S[D[F_B] + k * L + lane]
    for k in range(D[MODES]):
        HELD[lane, n + k] = S[D[F_MODE] + k * L + lane]
    for k in range(D[CLOCKS]):
        HELD[lane, n + D[MODES] + k] = S[D[F_CLK] + k * L + lane]


@typed(void(f1, int64, i1))
def widen_all(S, W, D):
    """Extremes of velocities in a step in the window, of bodies that move with their coordinates; all lanes at once."""
    N, JOB = N_of(W), JOB_of(W)
    settle, L, whole, wanted = JOB[SETTLE], D[LANES], D[DEGREE] + 1, False
    for lane in range(L):
        wanted = wanted or (N[lane, CASE] >= 0 and N[lane, DONE] >= settle and N[lane, AGAIN] == 0)
    if not wanted:
        return
    bend = wide(D[BODIES], D)
    last, after = bend + L, bend + 2 * L
    for b in range(D[BODIES]):
        high, at = wide(b, D), D[F_K] + D[D[BODY_MOVES] + b] * whole * L
        for lane in range(L):
            S[bend + lane] = 0.0
            S[last + lane], S[after + lane] = S[at + lane] + S[at + L + lane], S[at + L + lane]
        for m in range(2, whole):
            for lane in range(L):
                c = S[at + m * L + lane]
                S[bend + lane] += m * (m - 1) * abs(c)
                S[last + lane] += c
                S[after + lane] += m * c
        for lane in range(L):
            looked = N[lane, CASE] >= 0 and N[lane, DONE] >= settle and N[lane, AGAIN] == 0
            first, before = S[at + lane], S[at + L + lane]
            if looked and may_widen(high + lane, first, S[last + lane], before, S[after + lane], S[bend + lane], S, D):
                part, k = part_made(lane, S, D), at + lane
                if part != 1.0:
                    S[last + lane], S[after + lane] = on_step(k, part, S, D), slope_on_step(k, part, S, D)
                widen_within(high + lane, k, part, S[last + lane], S[after + lane], S[bend + lane], S, D)


@typed(void(int64, f1, int64, i1))
def begin_parts(lane, S, W, D):
    """At the start of a case: what its first step holds; of signals and of extremes in the window nothing is known."""
    hold(lane, S, W, D)
    begin_signals(lane, W, D)
    for b in range(D[BODIES]):
        S[wide(b, D) + lane], S[wide(b, D) + D[LANES] + lane] = -math.inf, math.inf


@typed(void(int64, int64, f1, int64, i1))
def note_parts(lane, case, S, W, D):
    """Write what was found of the signals of a case, and of its bodies in the window."""
    FOUND, NOTED = FOUND_of(W), NOTED_of(W)
    for b in range(D[BODIES]):
        FOUND[lane, D[SIGNALS] + b, LARGEST], FOUND[lane, D[SIGNALS] + b, SMALLEST] = S[wide(b, D) + lane], S[wide(b, D) + D[LANES] + lane]
    for s in range(NOTED.shape[1]):
        for j in range(3):
            NOTED[case, s, j] = FOUND[lane, s, j]


@typed(void(int64, f1, f1, int64, i1))
def widen(lane, S, row, W, D):
    """The same of one lane, where a body moves otherwise than its coordinate: at both ends of the step, its middle, where it turns."""
    ROOM = ROOM_of(W)
    at, part = ROOM[INSTANTS], part_made(lane, S, D)
    at[0], at[1], at[2] = 0.0, 0.5 * part, part
    look_at_all(lane, at, 3, S, row, W, D)
    for b in range(D[BODIES]):
        high, low, k = wide(b, D) + lane, wide(b, D) + D[LANES] + lane, D[RATIOS] + D[D[BODY_SIGNAL] + b]
        S[high] = largest(lane, k, 1.0, S[high], at, 3, S, row, W, D)
        S[low] = -largest(lane, k, -1.0, -S[low], at, 3, S, row, W, D)
