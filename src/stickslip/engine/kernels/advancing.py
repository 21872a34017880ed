"""One case that goes on to an instant of its caller's, and from there on with other numbers; the driver's last part for a held lane."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# Behind driving_lanes.py. The case never ends by itself: it is asked for more periods than there are. GOAL says where a call is to end
# (drive period, time in it), whether the numbers of the case are new since the last one (1: the period alone, which is how long the run is
# of a machine without one; 2: any), whether to return after each step, and whether a call begins.

GOAL_PERIOD, GOAL_TIME, RENEWED, EACH_STEP, BEGUN_ANEW = range(5)
THERE, UNDER_WAY, ENDED = 0, 1, 2
SAME_INSTANT = 1e-12  # of a period: an instant of the caller's this close to a known one is that one


@typed(void(int64, boolean, f1, int64, i1))
def renew(lane, anew, S, W, D):
    """Constants of the case from its numbers; with `anew` also its modes, as after an impulse at this instant. Its state stays."""
    PARAM, L = PARAM_of(W), D[LANES]
    c = np.empty(D[CONSTANTS])
    call_prelude(D[AT_PRELUDE], PARAM[0], c)
    for j in range(D[CONSTANTS]):
        S[D[F_C] + j * L + lane] = c[j]
    set_flags(lane, S, PARAM[0], anew and D[SET_VALUED] == 1, D)
    if anew and D[CARRIED] > 0 and D[SET_VALUED] == 1:
        call_settle_changes(D[AT_SETTLE_CHANGES], lane, S, PARAM[0], D)


@typed(void(int64, f1, int64, i1))
def begin_call(lane, S, W, D):
    """The budget of steps is that of a call, and so is the progress that is looked at."""
    N, K, GOAL = N_of(W), K_of(W), GOAL_of(W)
    if N[lane, CASE] < 0:
        next_case(lane, S, W, D)
    if GOAL[RENEWED] > 0.0:
        renew(lane, GOAL[RENEWED] > 1.0, S, W, D)
    N[lane, ACCEPTED] = N[lane, REJECTED] = 0
    S[D[F_NACC] + lane] = S[D[F_NREJ] + lane] = 0.0
    K[lane, SINCE] = N[lane, DONE] + S[D[F_T] + lane] / S[D[F_C] + D[PERIOD] * D[LANES] + lane] - 1.0
    GOAL[RENEWED] = GOAL[BEGUN_ANEW] = 0.0


@typed(int64(f1, int64, int64, i1))
def advance_to(S, calls, W, D):
    """Up to `calls` steps towards the goal: whether it is there, under way, or has ended before it, N[0, STATUS] says how."""
    N, JOB, PIECES, GOAL, lane = N_of(W), JOB_of(W), PIECES_of(W), GOAL_of(W), 0
    rtol, steps = LIMITS_of(W)[RTOL], min(STEPS_TO_LOOK, LIMITS_of(W)[BUDGET_OF_STEPS])
    if GOAL[BEGUN_ANEW] > 0.0:
        begin_call(lane, S, W, D)
    near = SAME_INSTANT * S[D[F_C] + D[PERIOD] * D[LANES] + lane]
    for _ in range(calls):
        if JOB[WRITTEN] >= PIECES.shape[0]:
            return UNDER_WAY
        known, last = S[D[F_TEND] + lane], N[lane, DONE] >= GOAL[GOAL_PERIOD]
        cut = last and GOAL[GOAL_TIME] < known - near
        if cut and S[D[F_T] + lane] >= GOAL[GOAL_TIME]:
            return THERE
        S[D[F_TEND] + lane] = GOAL[GOAL_TIME] if cut else known
        call_step(D[AT_STEP], S, rtol, steps)
        if D[SERIES] == 1:
            call_land(D[AT_LAND], S, steps, D)
        S[D[F_TEND] + lane] = known
        if is_piece(S, D):
            keep_piece(S, W, D)
        stat = S[D[F_STAT] + lane]
        S[D[F_STAT] + lane] = 0.0
        if stat == 1.0:
            if not cut:
                arrive(lane, S, W, D)
            if last and (cut or GOAL[GOAL_TIME] <= known + near):
                return THERE
        elif stat == BUDGET:
            stat = progress(lane, S, W, D)
        if stat > 1.5:
            N[lane, STATUS] = np.int64(stat)
            return ENDED
        if GOAL[EACH_STEP] > 0.0:
            return UNDER_WAY
    return UNDER_WAY
