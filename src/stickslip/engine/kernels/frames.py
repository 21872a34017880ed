"""Orthonormal frames that matrices carry along: text of kernels, never imported."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(void(f2, int64, float64, f2, int64))
def reflect(A, k, turn, B, j):
    """A column j of B as the k-th reflection, which stands in A below its diagonal, makes it."""
    along = B[k, j]
    for i in range(k + 1, STATES):
        along += A[i, k] * B[i, j]
    along *= turn
    B[k, j] -= along
    for i in range(k + 1, STATES):
        B[i, j] -= along * A[i, k]


@typed(void(f2, f1, f1))
def reflected(A, below, turns):
    """Householder's reflections that make a matrix upper triangular, below its diagonal, and the sizes of the diagonal."""
    for k in range(STATES):
        top = 0.0
        for i in range(k, STATES):
            top += abs(A[i, k])
        turns[k] = 0.0
        below[k] = top
        if top > 0.0:
            square = 0.0
            for i in range(k, STATES):
                part = A[i, k] / top
                square += part * part
            size = top * math.sqrt(square)
            first = abs(A[k, k]) + size
            turns[k] = first / size
            below[k] = size
            signed = math.copysign(first, A[k, k])
            for i in range(k + 1, STATES):
                A[i, k] = A[i, k] / signed
            for j in range(k + 1, STATES):
                reflect(A, k, turns[k], A, j)


@typed(void(f2, f1, f2))
def frame_of(A, turns, Q):
    """The orthonormal matrix that some reflections make together."""
    for i in range(STATES):
        for j in range(STATES):
            Q[i, j] = 1.0 if i == j else 0.0
    for k in range(STATES - 1, -1, -1):
        for j in range(k, STATES):
            reflect(A, k, turns[k], Q, j)


@typed(void(f2, f2, f2, f1, f1))
def carry(J, Q, A, turns, sizes):
    """The frame that a matrix makes of another, in its place, made orthonormal again, and by how much its directions grow."""
    for i in range(STATES):
        for j in range(STATES):
            total = 0.0
            for k in range(STATES):
                total += J[i, k] * Q[k, j]
            A[i, j] = total
    reflected(A, sizes, turns)
    frame_of(A, turns, Q)


@typed(void(f3, f2, f2))
def carry_on(matrices, Q, sizes):
    """The same of several matrices, one after the other."""
    A, turns = np.empty((STATES, STATES)), np.empty(STATES)
    for n in range(len(sizes)):
        carry(matrices[n], Q, A, turns, sizes[n])
