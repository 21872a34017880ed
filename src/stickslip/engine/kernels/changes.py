"""What known instants do to passive states that are changes of others, for the kernels of tangents; text after flags.py."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(void(int64, int64, float64, f1, f1, f1, f1, i1))
def look_at(what, lane, t, y, out, S, row, D):
    """One of a law's looks at what a lane holds, its flags behind its modes; its states are put into y."""
    L = D[LANES]
    clock, mode = np.empty(D[CLOCKS]), np.empty(D[MODES] + D[SIGNS])
    for i in range(D[STATES]):
        y[i] = S[D[F_Y] + i * L + lane]
    for k in range(D[CLOCKS]):
        clock[k] = S[D[F_CLK] + k * L + lane]
    for k in range(D[MODES]):
        mode[k] = S[D[F_MODE] + k * L + lane]
    for k in range(D[SIGNS]):
        mode[D[MODES] + k] = S[D[F_B] + k * L + lane]
    call_look(D[AT_LOOK], what, row, t, y, clock, mode, out)


@typed(void(int64, float64, f1, f1, f1, i1))
def rates_now(lane, t, out, S, row, D):
    """Rates of what the passive states are changes of, as a lane holds modes, clocks and flags: a state may dwell where a guard is zero."""
    look_at(RATES, lane, t, np.empty(D[STATES]), out, S, row, D)


@typed(void(int64, f1, f1, i1))
def settle_changes(lane, S, row, D):
    """At the start: what rests has no other change of its velocity than what it rests on."""
    y, n = np.empty(D[STATES]), D[STATES] - D[PASSIVE]
    look_at(RESTING_CHANGES, lane, S[D[F_T] + lane], y, y, S, row, D)
    for i in range(n, D[STATES]):
        S[D[F_Y] + i * D[LANES] + lane] = y[i]


@typed(boolean(int64, f1, f1, i1))
def note_late(lane, kicks, S, D):
    """Note by how much later the present instant comes along the direction, and what kicks change by; whether it is one that may move.

    Instants that fall together and part along the direction have no one change.
    """
    L, J = D[LANES], D[COORDINATES]
    t, period, n = S[D[F_T] + lane], S[D[F_C] + D[PERIOD] * L + lane], D[STATES] - D[PASSIVE]
    late, met = 0.0, False
    for k in range(D[BREAKS]):
        away = abs(t - S[D[F_C] + (D[BREAK_AT] + k) * L + lane])
        if min(away, abs(period - away)) > 1e-12 * period:
            continue
        own = S[D[F_C] + (D[DELAY_AT] + k) * L + lane]
        late = own if not met or abs(own - late) <= 1e-9 * (abs(own) + abs(late)) else math.nan
        met = True
        i = k - D[BREAKS] + D[IMPULSES]
        for j in range(J if i >= 0 else 0):
            kicks[j] += S[D[F_C] + (D[DELAY_AT] + D[BREAKS] + i * J + j) * L + lane]
    if is_sample(lane, S, D):
        between = S[D[F_C] + D[SAMPLE_AT] * L + lane]
        own = math.floor(t / between + 0.5) * S[D[F_C] + (D[SAMPLE_AT] + 1) * L + lane] if t < period * (1.0 - 1e-12) else 0.0
        late = own if not met or abs(own - late) <= 1e-9 * (abs(own) + abs(late)) else math.nan
        met = True
    S[D[F_Y] + (n + D[CARRIED]) * L + lane] = late
    return met


@typed(void(int64, boolean, boolean, f1, f1, f1, f1, i1))
def shift_changes(lane, within, first, before, kicks, S, row, D):
    """What a known instant does to the changes of the states: they get its own change times what the rates jump by, and the kick's."""
    L, J, n = D[LANES], D[COORDINATES], D[STATES] - D[PASSIVE]
    late = S[D[F_Y] + (n + D[CARRIED]) * L + lane]
    moved = late != 0.0
    for j in range(J):
        moved = moved or kicks[j] != 0.0
    if D[KEPT_MODES] > 0 and D[SET_VALUED] == 0 and moved:
        late = math.nan  # what a law forgets at an impulse that is moved itself is not followed
    after, held = np.empty(D[CARRIED]), S[D[F_T] + lane]
    if not within:
        S[D[F_T] + lane] = 0.0
    set_flags(lane, S, row, first, D)
    rates_now(lane, S[D[F_T] + lane], after, S, row, D)
    S[D[F_T] + lane] = held
    for i in range(D[CARRIED]):
        kick = kicks[i] if i < J else 0.0
        S[D[F_Y] + (n + i) * L + lane] += kick - (after[i] - before[i]) * late
