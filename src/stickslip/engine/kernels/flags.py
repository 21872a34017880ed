"""What a lane holds while it steps: columns of its arrays, flags, modes, and the known instants; text before watching.py."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(void(int64, f1, f1, boolean, i1))
def set_flags(lane, S, row, first, D):
    """Everything that a step holds, from the lane's time and state; with `first` its modes too. Then the end of the next steps.

    Conditions on time are asked just beyond the present instant, behind all that count as the same one.
    """
    L = D[LANES]
    t, period = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * L + lane]
    y, clock, mode, side = np.empty(D[STATES]), np.empty(D[CLOCKS]), np.empty(D[MODES]), np.empty(D[GUARDS])
    for i in range(D[STATES]):
        y[i] = S[D[F_Y] + i * L + lane]
    for k in range(D[MODES]):
        mode[k] = S[D[F_MODE] + k * L + lane]
    call_look(D[AT_LOOK], CLOCK_SIGNS, row, t + 1e-12 * period, y, clock, mode, clock)
    if first:
        call_look(D[AT_LOOK], FIRST_MODES, row, t, y, clock, mode, side)
    call_look(D[AT_LOOK], GUARD_VALUES, row, t, y, clock, mode, side)
    for k in range(D[CLOCKS]):
        S[D[F_CLK] + k * L + lane] = clock[k]
    for k in range(D[MODES]):
        S[D[F_MODE] + k * L + lane] = mode[k]
    for k in range(D[FLAGS]):
        S[D[F_B] + k * L + lane] = -1.0 if side[k] < 0.0 and k < D[SIGNS] else 1.0
        if D[F_ON] >= 0:
            S[D[F_ON] + k * L + lane] = 1.0 if side[k] == 0.0 else 0.0
    end = period
    for k in range(D[BREAKS]):
        instant = S[D[F_C] + (D[BREAK_AT] + k) * L + lane]
        if instant > t + 1e-12 * period and instant < end and instant < period * (1.0 - 1e-12):
            end = instant
    if D[SAMPLE_AT] >= 0:
        between = S[D[F_C] + D[SAMPLE_AT] * L + lane]
        instant = (math.floor(t / between + 1e-9) + 1.0) * between
        if instant < end and instant < period - 1e-6 * between:
            end = instant
    S[D[F_TEND] + lane] = end


@typed(boolean(int64, f1, i1))
def is_sample(lane, S, D):
    """Whether controllers take a sample at the present instant; the end of a period is one if it is nearly a multiple."""
    if D[SAMPLE_AT] < 0:
        return False
    t, period = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * D[LANES] + lane]
    count = t / S[D[F_C] + D[SAMPLE_AT] * D[LANES] + lane]
    return abs(count - math.floor(count + 0.5)) <= (1e-9 if t < period * (1.0 - 1e-12) else 1e-6)


@typed(boolean(int64, int64, f1, i1))
def is_now(lane, k, S, D):
    """Whether an impulse comes at the present instant; the end of a period is the instant 0 of the next."""
    L = D[LANES]
    t, period = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * L + lane]
    away = abs(t - S[D[F_C] + (D[BREAK_AT] + D[BREAKS] - D[IMPULSES] + k) * L + lane])
    return min(away, abs(period - away)) <= 1e-12 * period


@typed(float64(int64, int64, f1, i1))
def jump_of(lane, j, S, D):
    """Jump of the velocity of coordinate j at the present instant."""
    L, J = D[LANES], D[COORDINATES]
    jump = 0.0
    for k in range(D[IMPULSES]):
        if is_now(lane, k, S, D):
            jump += S[D[F_C] + (D[BREAK_AT] + D[BREAKS] + k * J + j) * L + lane]
    return jump


@typed(boolean(int64, f1, i1))
def is_thrown(lane, S, D):
    """Whether a velocity jumps at the present instant, that of a coordinate or of what a contact rubs on, or a force that is held."""
    thrown = is_sample(lane, S, D)
    for k in range(D[IMPULSES]):
        thrown = thrown or is_now(lane, k, S, D)
    return thrown


@typed(void(int64, f1, f1, i1))
def take_sample(lane, S, row, D):
    """What controllers hold after a sample; where something jumps at that instant they see what comes after it."""
    L, t, period = D[LANES], S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * D[LANES] + lane]
    begun = t if t < period * (1.0 - 1e-12) else 0.0
    y, clock, mode, new = np.empty(D[STATES]), np.empty(D[CLOCKS]), np.empty(D[MODES]), np.empty(D[STATES])
    for i in range(D[STATES]):
        y[i] = new[i] = S[D[F_Y] + i * L + lane]
    for k in range(D[MODES]):
        mode[k] = S[D[F_MODE] + k * L + lane]
    call_look(D[AT_LOOK], CLOCK_SIGNS, row, begun + 1e-12 * period, y, clock, mode, clock)
    call_look(D[AT_LOOK], SAMPLE, row, begun + 1e-13 * period, y, clock, mode, new)
    for i in range(D[STATES]):
        S[D[F_Y] + i * L + lane] = new[i]


@typed(void(int64, f1, f1, i1))
def apply_jump(lane, S, row, D):
    """An impulse: velocities jump; the law of a single contact that remembers until v passes zero forgets. Then samples are taken."""
    L = D[LANES]
    before = S[D[F_Y] + lane]
    for j in range(D[COORDINATES]):
        S[D[F_Y] + j * L + lane] += jump_of(lane, j, S, D)
    if D[KEPT_MODES] > 0 and D[SET_VALUED] == 0 and before * S[D[F_Y] + lane] < 0.0:
        y, clock, mode = np.empty(D[STATES]), np.empty(D[CLOCKS]), np.empty(D[MODES])
        for i in range(D[STATES]):
            y[i] = S[D[F_Y] + i * L + lane]
        for k in range(D[MODES]):
            mode[k] = S[D[F_MODE] + k * L + lane]
        call_look(D[AT_LOOK], CLOCK_SIGNS, row, S[D[F_T] + lane], y, clock, mode, clock)
        call_look(D[AT_LOOK], PASSED_REST, row, S[D[F_T] + lane], y, clock, mode, clock)
        for i in range(1, D[STATES]):
            S[D[F_Y] + i * L + lane] = y[i]
        for k in range(D[MODES]):
            S[D[F_MODE] + k * L + lane] = mode[k]
    if is_sample(lane, S, D):
        take_sample(lane, S, row, D)


@typed(float64(int64, f1, i1))
def way_of(lane, S, D):
    """Position of the body; of several that of their centre of mass, the first one's and a share of each other position."""
    L = D[LANES]
    x = S[D[F_X] + lane] if D[CYCLIC] == 1 or D[COORDINATES] == 1 else 0.0
    for k in range(D[SHARES]):
        x += S[D[F_C] + (D[SHARE_AT] + k) * L + lane] * S[D[F_Y] + (D[STATES] - D[PASSIVE] - D[SHARES] + k) * L + lane]
    return x
