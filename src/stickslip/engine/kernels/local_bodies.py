"""Rows of many bodies (local_events.py): the columns of their arrays, the coefficients of forces, and where each body is."""
# ruff: noqa: F821
# mypy: ignore-errors

# columns of S (body): when its piece began, position and velocity there, mass, velocity of what it rubs on, friction limits at rest,
# until when its cluster's step holds, sum of the forces and of their sizes, a constant force on it
T0, XS, VS, MASS, BASE, LOW, HIGH, END, SUM, SIZE, PUSH = range(11)
# columns of K (body): mode (2: it has no contact); kinds of its friction forwards and backwards (-1: none), each with its row of numbers;
# kind of its applied force and its row; its first entry in ADJ, and how many there are; first body of its cluster; a mark; its next event
# (of a cluster the body that comes to rest, or -1; of a body at rest 1 or -1 where it breaks away, else 0); whether its slip begins at
# zero, 2 where it breaks away; how often its slip was zero at once; a mark of its group
MODE, AHEAD, AT_AHEAD, BACK, AT_BACK, APPLIED, AT_APPLIED, FIRST, COUNT, LEADER, MARK, WHAT, BORN, AT_ONCE, AT_GROUP = range(15)
# columns of LINK: its ends (-1: the ground), kind, row of numbers, mark
A, B, KIND, AT, SEEN = range(5)
# JOB: time, end of the run, typical velocity, whether a force is not linear, where it pauses, whether it pauses after each event
NOW, STOP, SPEED, CURVED, PAUSE, EACH_EVENT = range(6)
# N: status, pieces and events written, steps and events done, the last mark, steps left for this call, steps rejected, whether it has
# come to its pause
STATUS, PIECES_WRITTEN, EVENTS_WRITTEN, STEPS, SWITCHED, MARKS, LEFT, REJECTED, PAUSED = range(9)

ORDERS = ORDER + 1
PLACES = ORDER + 2  # coefficients of a position
WIDE = PLACES + 2  # of a piece: body, beginning, coefficients
ROUGH = 4e-15  # of the terms of a force: what rounding may make of it
SOON = 1e-13  # of a step
ROUNDING = 1e-16  # of the typical velocity: what a step may leave out
MISFIT = 2e-14  # of the typical velocity: what a misfit may add to a velocity in a step
ROUGH_SLOPE = 3e-14  # of the terms of a slope: a misfit below it is rounding
MOST_AT_ONCE = 20
CHECKS = 5  # instants of a step at which the polynomials are compared with the equations


# ---- coefficients of forces ----
@typed(float64(f1, int64, int64, int64))
def product(W, a, b, m):
    """The coefficient m of a product."""
    total = 0.0
    for j in range(m + 1):
        total = fma(W[a + j], W[b + m - j], total)
    return total


@typed(float64(f1, int64, int64, int64))
def rest(W, a, b, m):
    """The same without the first coefficient of a."""
    total = 0.0
    for j in range(1, m + 1):
        total = fma(W[a + j], W[b + m - j], total)
    return total


@typed(float64(f1, int64, int64, int64))
def chain(W, a, slope, m):
    """The coefficient m of a function of a, from its slope."""
    total = 0.0
    for j in range(1, m + 1):
        total = fma(j * W[a + j], W[slope + m - j], total)
    return total / m


# ---- where bodies are ----
@typed(void(int64, float64, f2, i2, f2, f1))
def row_at(i, now, S, K, X, R):
    """The coefficients of a body's position, counted from now."""
    dt = now - S[i, T0]
    if K[i, MODE] == 0:
        R[0] = fma(S[i, BASE], dt, S[i, XS])
        R[1] = S[i, BASE]
        for m in range(2, PLACES):
            R[m] = 0.0
        return
    for m in range(PLACES):
        R[m] = X[i, m]
    if dt != 0.0:
        for k in range(PLACES - 1):
            for m in range(PLACES - 2, k - 1, -1):
                R[m] = fma(R[m + 1], dt, R[m])


@typed(float64(int64, float64, f2, i2, f2))
def position_at(i, now, S, K, X):
    """Its position."""
    dt = now - S[i, T0]
    return fma(S[i, BASE], dt, S[i, XS]) if K[i, MODE] == 0 else value_at(X[i], 0, PLACES - 1, dt)


@typed(float64(int64, float64, f2, i2, f2))
def velocity_at(i, now, S, K, X):
    """Its velocity."""
    return S[i, BASE] if K[i, MODE] == 0 else slope_at(X[i], 0, PLACES - 1, now - S[i, T0])


@typed(float64(int64, float64, float64, float64, f2, i2, f2, i2, i1, f1, i1))
def push_on(i, now, x, v, S, K, X, LINK, ADJ, NUM, N):
    """All forces on a body but friction; their sizes stand at SIZE."""
    total, size = S[i, PUSH], abs(S[i, PUSH])
    if K[i, APPLIED] >= 0:
        force = applied_value(K[i, APPLIED], NUM, K[i, AT_APPLIED], now, x, v)
        total += force
        size += abs(force)
    for k in range(K[i, COUNT]):
        e = ADJ[K[i, FIRST] + k]
        other = LINK[e, B] if LINK[e, A] == i else LINK[e, A]
        far = position_at(other, now, S, K, X) if other >= 0 else 0.0
        fast = velocity_at(other, now, S, K, X) if other >= 0 else 0.0
        side = 1.0 if LINK[e, A] == i else -1.0
        force = side * link_value(LINK[e, KIND], NUM, LINK[e, AT], side * (x - far), side * (v - fast))
        total -= force
        size += abs(force)
    S[i, SIZE] = size
    return total


@typed(float64(int64, float64, i2, f1))
def friction_of(i, slip, K, NUM):
    """The friction force while it slides."""
    if K[i, MODE] > 0:
        return contact_value(K[i, AHEAD], NUM, K[i, AT_AHEAD], slip)
    return contact_value(K[i, BACK], NUM, K[i, AT_BACK], slip)
