"""A held case that is given numbers of its own leg by leg, as a record of a command has them; behind advancing.py."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(int64(f1, int64, i1, f2, i1, f2))
def follow(S, W, D, LEGS, CHANGED, ENDS):
    """Go on through the legs: each has its end and, behind it, the numbers that it changes, whose columns CHANGED says.

    ENDS gets the way and the states at the end of each leg. Returns how many legs were done.
    """
    JOB, GOAL, PARAM, ROOM, lane = JOB_of(W), GOAL_of(W), PARAM_of(W), PIECES_of(W).shape[0], 0
    for leg in range(LEGS.shape[0]):
        new = leg == 0
        for j in range(CHANGED.shape[0]):
            new = new or PARAM[0, CHANGED[j]] != LEGS[leg, 1 + j]
            PARAM[0, CHANGED[j]] = LEGS[leg, 1 + j]
        GOAL[RENEWED] = 2.0 if new else 0.0
        GOAL[GOAL_PERIOD], GOAL[GOAL_TIME], GOAL[EACH_STEP], GOAL[BEGUN_ANEW] = 0.0, LEGS[leg, 0], 0.0, 1.0
        code = UNDER_WAY
        while code == UNDER_WAY:
            JOB[WRITTEN] = 0
            code = advance_to(S, ROOM, W, D)
        if code == ENDED:
            return leg
        ENDS[leg, 0] = S[D[F_X] + lane]
        for j in range(D[STATES]):
            ENDS[leg, 1 + j] = S[D[F_Y] + j * D[LANES] + lane]
    return LEGS.shape[0]
