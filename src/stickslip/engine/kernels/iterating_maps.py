"""A map iterated: text that follows the functions of a map in its kernel, never imported."""
# ruff: noqa: F821
# mypy: ignore-errors


@typed(void(f2, f2, int64))
def iterate(rows, states, count):
    """The states of some starts after so many iterations, in their place."""
    y, out = np.empty(STATES), np.empty(STATES)
    for case in range(len(rows)):
        row, state = rows[case], states[case]
        for i in range(STATES):
            y[i] = state[i]
        for _ in range(count):
            mapped(row, y, out)
            for i in range(STATES):
                y[i] = out[i]
        for i in range(STATES):
            state[i] = y[i]


@typed(void(f1, f1, f2, f2))
def grow(row, y, Q, sizes):
    """Along one orbit, how much each direction of a frame that is made orthonormal again grows in each iteration."""
    out, turns = np.empty(STATES), np.empty(STATES)
    J, A = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    for n in range(len(sizes)):
        sloped(row, y, J)
        carry(J, Q, A, turns, sizes[n])
        mapped(row, y, out)
        for i in range(STATES):
            y[i] = out[i]
