"""The work of friction in a step: text of every law's kernel, below the force that all but friction offer."""
# ruff: noqa: F821
# mypy: ignore-errors


@njit(float64(int64, f1, f1), **OPTIONS)
def work(lane, S, row):
    """What was offered in the last step and did not become kinetic energy (Gauss's rule on the dense output).

    The last of the places at which the step is looked at is its end, with no weight; all are computed side by side.
    """
    begin, end, h = S[F_T0 + lane], S[F_T + lane], S[F_HH + lane]
    part = (end - begin) / h
    at, v, power = np.empty(PLACES), np.empty(PLACES), np.empty(PLACES)
    for q in range(PLACES):
        at[q] = part * NODES[q]
        v[q] = S[F_K + DEGREE * L + lane]
    for m in range(DEGREE - 1, -1, -1):
        c = S[F_K + m * L + lane]
        for q in range(PLACES):
            v[q] = fma(v[q], at[q], c)
    for q in range(PLACES):
        power[q] = WEIGHTS[q] * force(lane, S, row, begin + at[q] * h) * v[q]
    done, first, last = 0.0, S[F_K + lane], v[PLACES - 1]
    for q in range(PLACES):
        done += power[q]
    return done * (end - begin) - 0.5 * S[F_C + MASS * L + lane] * (last - first) * (last + first)
