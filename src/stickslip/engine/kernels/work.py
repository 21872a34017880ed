"""The work of friction in a step: text of every law's kernel, below the force that all but friction offer."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(float64(int64, float64, f1))
def velocity(lane, theta, S):
    """The velocity at a part of the last step."""
    v = S[F_K + DEGREE * L + lane]
    for m in range(DEGREE - 1, -1, -1):
        v = fma(v, theta, S[F_K + m * L + lane])
    return v


@typed(float64(int64, f1, f1))
def work(lane, S, row):
    """What was offered in the last step and did not become kinetic energy (Gauss's rule on the dense output)."""
    begin, end, h = S[F_T0 + lane], S[F_T + lane], S[F_HH + lane]
    part, done = (end - begin) / h, 0.0
    for q in range(len(NODES)):
        theta = part * NODES[q]
        done += WEIGHTS[q] * force(lane, S, row, begin + theta * h) * velocity(lane, theta, S)
    first, last = S[F_K + lane], velocity(lane, part, S)
    return done * (end - begin) - 0.5 * S[F_C + MASS * L + lane] * (last - first) * (last + first)
