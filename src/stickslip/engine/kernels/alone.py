"""A held lane of which nothing is noted: text behind advancing.py, in whose place some functions do less."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(boolean(int64, f1, int64, i1))
def next_case(lane, S, W, D):
    """Put the only case into the lane."""
    take(lane, 0, S, W, D)
    return True


@typed(boolean(int64, f1, int64, i1))
def begins_to_count(lane, S, W, D):
    """Of a case whose budget is used up: nothing more is counted."""
    return False


@typed(void(int64, f1, int64, i1))
def pass_instant(lane, S, W, D):
    """At a known instant: velocities jump, and controllers take their samples."""
    PARAM = PARAM_of(W)
    if is_thrown(lane, S, D):
        apply_jump(lane, S, PARAM[0], D)


@typed(int64(int64, f1, int64, i1))
def end_period(lane, S, W, D):
    """At the end of a drive period: it never ends by itself."""
    N = N_of(W)
    N[lane, DONE] += 1
    return 0
