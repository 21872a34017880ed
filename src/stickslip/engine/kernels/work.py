"""The work of friction in a step: text of every law's kernel, below the force that all but friction offer."""
# ruff: noqa: F821
# mypy: ignore-errors


@njit(float64(int64, float64[::1], float64[::1]), **OPTIONS)
def work(lane, S, row):
    """What was offered in the last step and did not become kinetic energy (Gauss's rule on the dense output)."""
    begin, end, h = S[F_T0 + lane], S[F_T + lane], S[F_HH + lane]
    part = (end - begin) / h
    done = 0.0
    for q in range(NODES.shape[0]):
        theta = part * NODES[q]
        v = S[F_K + DEGREE * L + lane]
        for m in range(DEGREE - 1, -1, -1):
            v = fma(v, theta, S[F_K + m * L + lane])
        done += WEIGHTS[q] * force(lane, S, row, begin + theta * h) * v
    last = S[F_K + DEGREE * L + lane]
    for m in range(DEGREE - 1, -1, -1):
        last = fma(last, part, S[F_K + m * L + lane])
    first = S[F_K + lane]
    return done * (end - begin) - 0.5 * S[F_C + MASS * L + lane] * (last - first) * (last + first)
