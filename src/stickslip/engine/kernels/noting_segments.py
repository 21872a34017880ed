"""Stretches of one code, as a lane notes them; text before those that note."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(void(int64, int64, int64, float64, int64))
def add_segment(lane, i, code, length, W):
    """Append a stretch of one code to those of contact i, or lengthen the last one."""
    N, SEGT, SEGC = N_of(W), SEGT_of(W), SEGC_of(W)
    case, first = N[lane, CASE], i * SEGS
    n = N[lane, SEGMENTS + i]
    if length <= 0.0 or n < 0:
        return
    if n > 0 and SEGC[case, first + n - 1] == code:
        SEGT[case, first + n - 1] += length
    elif n == SEGS:
        N[lane, SEGMENTS + i] = -1
    else:
        SEGC[case, first + n] = code
        SEGT[case, first + n] = length
        N[lane, SEGMENTS + i] = n + 1
