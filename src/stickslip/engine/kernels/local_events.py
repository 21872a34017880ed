"""Rows of many bodies, event by event: what moves together is one cluster with a step of its own, and what rests waits for its neighbours.

Two moving bodies that a link joins are of one cluster. Between clusters stand bodies at rest, whose motion is known, so that a cluster is
expanded, and ends its step, without the others. A body at rest has a margin, a polynomial of its neighbours' motions, and breaks away where
that is zero. Whatever comes first in the whole row is done first: then only the clusters that it touches are expanded anew, and only the
margins beside them are looked at again.
"""
# ruff: noqa: F821
# mypy: ignore-errors

# columns of S (body): when its piece began, position and velocity there, mass, velocity of what it rubs on, friction limits at rest,
# until when its cluster's step holds, sum of the forces and of their sizes
T0, XS, VS, MASS, BASE, LOW, HIGH, END, SUM, SIZE = range(10)
# columns of K (body): mode (2: it has no contact); kinds of its friction forwards and backwards (-1: none), each with its row of numbers;
# kind of its applied force and its row; its first entry in ADJ, and how many there are; first body of its cluster; a mark; its next event
# (of a cluster the body that comes to rest, or -1; of a body at rest 1 or -1 where it breaks away, else 0); whether its slip begins at
# zero, 2 where it breaks away; how often its slip was zero at once; a mark of its group
MODE, AHEAD, AT_AHEAD, BACK, AT_BACK, APPLIED, AT_APPLIED, FIRST, COUNT, LEADER, MARK, WHAT, BORN, AT_ONCE, AT_GROUP = range(15)
# columns of LINK: its ends (-1: the ground), kind, row of numbers, mark
A, B, KIND, AT, SEEN = range(5)
# JOB: time, end of the run, typical velocity, whether a force is not linear
NOW, STOP, SPEED, CURVED = range(4)
# N: status, pieces and events written, steps and events done, the last mark, steps left for this call
STATUS, PIECES_WRITTEN, EVENTS_WRITTEN, STEPS, SWITCHED, MARKS, LEFT, REJECTED = range(8)

ORDERS = ORDER + 1
PLACES = ORDER + 2  # coefficients of a position
WIDE = PLACES + 2  # of a piece: body, beginning, coefficients
LOOKS = 4
NOISE = -4e-15  # of the sum of its terms: a margin this close to zero is not below it
ROUGH = 4e-15  # of the terms of a force: what rounding may make of it
SOON = 1e-13  # of a step
ROUNDING = 1e-16  # of the typical velocity: what a step may leave out
MISFIT = 2e-14  # of the typical velocity: what a misfit may add to a velocity in a step
ROUGH_SLOPE = 3e-14  # of the terms of a slope: a misfit below it is rounding
NEWTON = 60
MOST_AT_ONCE = 20
CHECKS = 5  # instants of a step at which the polynomials are compared with the equations


@njit(float64(f1, int64, int64, int64))
def product(W, a, b, m):
    """The coefficient m of a product."""
    total = 0.0
    for j in range(m + 1):
        total = fma(W[a + j], W[b + m - j], total)
    return total


@njit(float64(f1, int64, int64, int64))
def rest(W, a, b, m):
    """The same without the first coefficient of a."""
    total = 0.0
    for j in range(1, m + 1):
        total = fma(W[a + j], W[b + m - j], total)
    return total


@njit(float64(f1, int64, int64, int64))
def chain(W, a, slope, m):
    """The coefficient m of a function of a, from its slope."""
    total = 0.0
    for j in range(1, m + 1):
        total = fma(j * W[a + j], W[slope + m - j], total)
    return total / m


# ---- polynomials: coefficients from a place of an array on ----
@njit(float64(f1, int64, int64, float64))
def at_place(C, at, degree, x):
    """The value at x."""
    value = C[at + degree]
    for m in range(degree - 1, -1, -1):
        value = fma(value, x, C[at + m])
    return value


@njit(float64(f1, int64, int64, float64))
def slope_at(C, at, degree, x):
    """The slope at x."""
    value = degree * C[at + degree]
    for m in range(degree - 1, 0, -1):
        value = fma(value, x, m * C[at + m])
    return value


@njit(float64(f1, int64, int64, float64))
def bend_at(C, at, degree, x):
    """The second derivative at x."""
    value = degree * (degree - 1) * C[at + degree]
    for m in range(degree - 1, 1, -1):
        value = fma(value, x, m * (m - 1) * C[at + m])
    return value


@njit(float64(f1, int64, int64, float64, float64))
def zero_between(C, at, degree, lo, hi):
    """The zero between lo (not below zero) and hi (below zero): Newton's method, held in the bracket."""
    x = 0.5 * (lo + hi)
    for _ in range(NEWTON):
        value, rate = at_place(C, at, degree, x), slope_at(C, at, degree, x)
        if value > 0.0:
            lo = x
        else:
            hi = x
        new = x - value / rate if rate != 0.0 else lo
        if not (new >= lo and new <= hi):
            new = 0.5 * (lo + hi)
        if abs(new - x) <= 1e-16 * x or new == x:
            return new
        x = new
    return x


@njit(float64(f1, int64, int64, float64, float64, float64, float64))
def turning_point(C, at, degree, lo, hi, d0, d1):
    """Where the slope is zero between lo and hi, where it is d0 and d1, which differ in sign."""
    x = lo + (hi - lo) * d0 / (d0 - d1)
    for _ in range(NEWTON):
        d, dd = slope_at(C, at, degree, x), bend_at(C, at, degree, x)
        if d * d0 > 0.0:
            lo = x
        else:
            hi = x
        new = x - d / dd if dd != 0.0 else lo
        if not (new >= lo and new <= hi):
            new = 0.5 * (lo + hi)
        if abs(new - x) <= 1e-9:
            return new
        x = new
    return x


@njit(float64(f1, int64, int64))
def first_zero(C, at, degree):
    """Where a polynomial first falls below zero in [0, 1]; 2 if it does not.

    One that begins below zero by rounding and rises through it at once is not below.
    """
    terms = 0.0
    for m in range(1, degree + 1):
        terms += abs(C[at + m])
    if C[at] > terms:
        return 2.0
    noise = NOISE * (terms + abs(C[at]))
    if C[at] < noise and not (C[at + 1] > 0.0 and -C[at] <= SOON * C[at + 1]):
        return 0.0
    a, da = 0.0, C[at + 1]
    for j in range(LOOKS):
        b = (j + 1.0) / LOOKS
        db = slope_at(C, at, degree, b)
        if da < 0.0 and db > 0.0:
            low = turning_point(C, at, degree, a, b, da, db)
            if at_place(C, at, degree, low) < noise:
                return zero_between(C, at, degree, a, low)
        if at_place(C, at, degree, b) < noise:
            return zero_between(C, at, degree, a, b)
        a, da = b, db
    return 2.0


@njit(float64(float64, float64, int64))
def reach(least, coefficient, m):
    """Where a term of order m is as large as is tolerated."""
    if coefficient == 0.0 or not least > 0.0:
        return math.inf
    return math.expm1(0.6931471805599453 * math.log2(least / abs(coefficient)) / m) + 1.0


# ---- what comes next: a tree of times ----
@njit(void(int64, float64, f1))
def plan(i, t, TREE):
    """Body i, as the first of its cluster or at rest, is due at t."""
    k = i + len(TREE) // 2
    TREE[k] = t
    k = k // 2
    while k >= 1:
        TREE[k] = min(TREE[2 * k], TREE[2 * k + 1])
        k = k // 2


@njit(int64(f1))
def next_due(TREE):
    """The body that is due first."""
    k, half = 1, len(TREE) // 2
    while k < half:
        k = 2 * k if TREE[2 * k] <= TREE[2 * k + 1] else 2 * k + 1
    return k - half


# ---- where bodies are ----
@njit(void(int64, float64, f2, i2, f2, f1))
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


@njit(float64(int64, float64, f2, i2, f2))
def position_at(i, now, S, K, X):
    """Its position."""
    dt = now - S[i, T0]
    return fma(S[i, BASE], dt, S[i, XS]) if K[i, MODE] == 0 else at_place(X[i], 0, PLACES - 1, dt)


@njit(float64(int64, float64, f2, i2, f2))
def velocity_at(i, now, S, K, X):
    """Its velocity."""
    return S[i, BASE] if K[i, MODE] == 0 else slope_at(X[i], 0, PLACES - 1, now - S[i, T0])


@njit(float64(int64, float64, float64, float64, f2, i2, f2, i2, i1, f1, i1))
def push_on(i, now, x, v, S, K, X, LINK, ADJ, NUM, N):
    """All forces on a body but friction; their sizes stand at SIZE."""
    total, size = 0.0, 0.0
    if K[i, APPLIED] >= 0:
        total = applied_value(K[i, APPLIED], NUM, K[i, AT_APPLIED], now, x, v)
        size = abs(total)
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


@njit(float64(int64, float64, i2, f1))
def friction_of(i, slip, K, NUM):
    """The friction force while it slides."""
    if K[i, MODE] > 0:
        return contact_value(K[i, AHEAD], NUM, K[i, AT_AHEAD], slip)
    return contact_value(K[i, BACK], NUM, K[i, AT_BACK], slip)


# ---- what is kept ----
@njit(void(int64, float64, f2, i2, f2, f2, i1))
def close(i, now, S, K, X, PIECES, N):
    """Write down the piece of a body that ends now, and where it is then."""
    if now > S[i, T0]:
        k = N[PIECES_WRITTEN]
        N[PIECES_WRITTEN] += 1
        PIECES[k, 0] = i
        PIECES[k, 1] = S[i, T0]
        if K[i, MODE] == 0:
            PIECES[k, 2] = S[i, XS]
            PIECES[k, 3] = S[i, BASE]
            for m in range(2, PLACES):
                PIECES[k, 2 + m] = 0.0
        else:
            for m in range(PLACES):
                PIECES[k, 2 + m] = X[i, m]
    x, v = position_at(i, now, S, K, X), velocity_at(i, now, S, K, X)
    S[i, XS], S[i, VS], S[i, T0] = x, v, now


@njit(void(int64, float64, int64, f2, i2, f2, i1))
def switch(i, now, mode, S, K, EVENTS, N):
    """A contact has another mode; its slip is zero."""
    k = N[EVENTS_WRITTEN]
    N[EVENTS_WRITTEN] += 1
    N[SWITCHED] += 1
    EVENTS[k, 0], EVENTS[k, 1], EVENTS[k, 2] = now, i, mode
    K[i, MODE], K[i, BORN] = mode, 1
    S[i, VS] = S[i, BASE]


# ---- clusters ----
@njit(int64(int64, int64, i2, i2, i1, i1, i1))
def gather(i, first, K, LINK, ADJ, Q, N):
    """The bodies that move together with body i, which moves: their numbers in Q from a place on, and the place after them."""
    mark = N[MARKS]
    end, at = first + 1, first
    Q[first], K[i, MARK] = i, mark
    while at < end:
        j = Q[at]
        at += 1
        K[j, LEADER] = i
        for k in range(K[j, COUNT]):
            e = ADJ[K[j, FIRST] + k]
            other = LINK[e, B] if LINK[e, A] == j else LINK[e, A]
            if other >= 0 and K[other, MODE] != 0 and K[other, MARK] != mark:
                K[other, MARK] = mark
                Q[end] = other
                end += 1
    return end


@njit(int64(int64, int64, float64, f2, i2, f2, i2, i1, i1, i1, i1))
def links_of(first, end, now, S, K, X, LINK, ADJ, Q, L, N):
    """The links of the bodies in Q from first to end, each once; what rests at their other ends is where it is now."""
    N[MARKS] += 1
    mark, count = N[MARKS], 0
    for q in range(first, end):
        i = Q[q]
        for k in range(K[i, COUNT]):
            e = ADJ[K[i, FIRST] + k]
            if LINK[e, SEEN] != mark:
                LINK[e, SEEN] = mark
                L[count] = e
                count += 1
                other = LINK[e, B] if LINK[e, A] == i else LINK[e, A]
                if other >= 0 and K[other, MODE] == 0:
                    row_at(other, now, S, K, X, X[other])
    return count


@njit(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, i1, i1, i1))
def expand(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Q, L, N):
    """The Taylor coefficients of all bodies of a cluster."""
    count = links_of(first, end, now, S, K, X, LINK, ADJ, Q, L, N)
    for q in range(first, end):
        i = Q[q]
        X[i, 0], X[i, 1] = S[i, XS], S[i, VS]
        S[i, SIZE] = 0.0
    for m in range(ORDER):
        for q in range(first, end):
            S[Q[q], SUM] = 0.0
        for k in range(count):
            e = L[k]
            a, b = LINK[e, A], LINK[e, B]
            W = WL[e]
            W[m], W[ORDERS + m] = X[a, m], (m + 1) * X[a, m + 1]
            if b >= 0:
                W[m] -= X[b, m]
                W[ORDERS + m] -= (m + 1) * X[b, m + 1]
            link_series(LINK[e, KIND], m, NUM, LINK[e, AT], W)
            force = W[2 * ORDERS + m]
            S[a, SUM] -= force
            if b >= 0:
                S[b, SUM] += force
            if m == 0:
                S[a, SIZE] += abs(force)
                if b >= 0:
                    S[b, SIZE] += abs(force)
        for q in range(first, end):
            i = Q[q]
            total = S[i, SUM]
            if K[i, APPLIED] >= 0:
                W = WA[i]
                W[m] = now if m == 0 else 1.0 if m == 1 else 0.0
                W[ORDERS + m], W[2 * ORDERS + m] = X[i, m], (m + 1) * X[i, m + 1]
                applied_series(K[i, APPLIED], m, NUM, K[i, AT_APPLIED], W)
                total += W[3 * ORDERS + m]
                if m == 0:
                    S[i, SIZE] += abs(W[3 * ORDERS])
            if K[i, MODE] != 2:
                W = WC[i]
                W[m] = (m + 1) * X[i, m + 1]
                if m == 0:
                    W[0] -= S[i, BASE]
                if K[i, MODE] > 0:
                    contact_series(K[i, AHEAD], m, NUM, K[i, AT_AHEAD], W)
                else:
                    contact_series(K[i, BACK], m, NUM, K[i, AT_BACK], W)
                total -= W[ORDERS + m]
                if m == 0:
                    S[i, SIZE] += abs(W[ORDERS])
                    if K[i, BORN] == 2:  # what holds it is as large as its limit: the instant is rounded
                        total = (S[i, HIGH] if K[i, MODE] > 0 else S[i, LOW]) - W[ORDERS]
                    if K[i, BORN] != 0 and abs(total) <= ROUGH * S[i, SIZE]:
                        total = 0.0
            X[i, m + 2] = total / (S[i, MASS] * ((m + 1) * (m + 2)))


@njit(float64(int64, int64, f2, i2, f2, f1, i1))
def longest(first, end, S, K, X, JOB, Q):
    """The step whose last terms are below rounding, for all bodies of a cluster."""
    speed = JOB[SPEED]
    for q in range(first, end):
        speed = max(speed, abs(S[Q[q], VS]))
    h = math.inf
    for q in range(first, end):
        i = Q[q]
        for m in range(ORDER - 1, ORDER + 1):
            h = min(h, reach(ROUNDING * speed, (m + 1) * X[i, m + 1], m))
    return h


@njit(float64(int64, float64, f2, i2, f2, f1))
def rests_after(i, h, S, K, X, G):
    """The part of a step after which the slip of a moving body is zero; above 1: it is not."""
    side = np.float64(K[i, MODE])
    power = 1.0
    for m in range(ORDERS):
        G[m] = side * (m + 1) * X[i, m + 1] * power
        power *= h
    first = 0
    if K[i, BORN] != 0:
        first = 1 if G[1] != 0.0 else 2
        if first == 2 and G[2] == 0.0:
            first = 3
    else:
        G[0] -= side * S[i, BASE]
    return first_zero(G, first, ORDER - first)


@njit(boolean(int64, int64, float64, float64, f2, i2, f2, i2, i1, f1, f1, i1, i1))
def fits(first, end, now, dt, S, K, X, LINK, ADJ, NUM, JOB, Q, N):
    """Whether the polynomials do what the equations say at a time dt after now."""
    for q in range(first, end):
        i = Q[q]
        x, v = at_place(X[i], 0, PLACES - 1, dt), slope_at(X[i], 0, PLACES - 1, dt)
        force = push_on(i, now + dt, x, v, S, K, X, LINK, ADJ, NUM, N)
        size = S[i, SIZE]
        if K[i, MODE] != 2:
            friction = friction_of(i, v - S[i, BASE], K, NUM)
            force -= friction
            size += abs(friction)
        slope, power = 0.0, 1.0
        for m in range(2, PLACES):
            slope += m * (m - 1) * abs(X[i, m]) * power
            power *= dt
        misfit = abs(bend_at(X[i], 0, PLACES - 1, dt) - force / S[i, MASS]) * dt
        if not misfit <= MISFIT * max(JOB[SPEED], abs(v)) + dt * (ROUGH_SLOPE * slope + ROUGH * size / S[i, MASS]):
            return False
    return True


@njit(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f1, f1, f1, i1, i1, i1))
def begin_step(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, G, TREE, JOB, Q, L, N):
    """Expand a cluster, and plan where its step ends."""
    expand(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Q, L, N)
    N[STEPS] += 1
    h = min(longest(first, end, S, K, X, JOB, Q), JOB[STOP] - now)
    leader, what, part = Q[first], -1, 1.0
    for q in range(first, end):
        i = Q[q]
        if K[i, MODE] != 2:
            zero = rests_after(i, h, S, K, X, G)
            if zero < part or (zero == part and what < 0):
                part, what = zero, i
    if JOB[CURVED] > 0.0:
        tries = 0
        while tries < 100:
            dt, good = part * h, True
            for j in range(1, CHECKS + 1):
                good = good and fits(first, end, now, dt * j / CHECKS, S, K, X, LINK, ADJ, NUM, JOB, Q, N)
            if good:
                break
            part, what = 0.5 * part, -1
            tries += 1
            N[REJECTED] += 1
    due = now + part * h
    if not due >= now:
        N[STATUS] = 4
        due = now
    if what >= 0:
        K[what, AT_ONCE] = 0 if due > now else K[what, AT_ONCE] + 1
        if K[what, AT_ONCE] > MOST_AT_ONCE:
            N[STATUS] = 3
    elif not due > now and JOB[STOP] > now:
        N[STATUS] = 3
    for q in range(first, end):
        i = Q[q]
        S[i, END] = due
        K[i, WHAT] = -1
        plan(i, math.inf, TREE)
    K[leader, WHAT] = what
    plan(leader, due, TREE)


@njit(void(int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f1, f1, f1))
def watch(i, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB):
    """Plan when a body at rest breaks away, or is looked at again."""
    end = JOB[STOP]
    for m in range(ORDERS):
        Z[0, m] = 0.0
    size = S[i, HIGH] - S[i, LOW]
    row_at(i, now, S, K, X, Z[1])
    for k in range(K[i, COUNT]):
        e = ADJ[K[i, FIRST] + k]
        other = LINK[e, B] if LINK[e, A] == i else LINK[e, A]
        side = 1.0 if LINK[e, A] == i else -1.0
        W = WL[e]
        if other >= 0:
            row_at(other, now, S, K, X, Z[2])
            if K[other, MODE] != 0:
                end = min(end, S[other, END])
        for m in range(ORDERS):
            W[m], W[ORDERS + m] = side * Z[1, m], side * (m + 1) * Z[1, m + 1]
            if other >= 0:
                W[m] -= side * Z[2, m]
                W[ORDERS + m] -= side * (m + 1) * Z[2, m + 1]
            link_series(LINK[e, KIND], m, NUM, LINK[e, AT], W)
            Z[0, m] -= side * W[2 * ORDERS + m]
        size += abs(W[2 * ORDERS])
    if K[i, APPLIED] >= 0:
        W = WA[i]
        for m in range(ORDERS):
            W[m] = now if m == 0 else 1.0 if m == 1 else 0.0
            W[ORDERS + m], W[2 * ORDERS + m] = Z[1, m], (m + 1) * Z[1, m + 1]
            applied_series(K[i, APPLIED], m, NUM, K[i, AT_APPLIED], W)
            Z[0, m] += W[3 * ORDERS + m]
        size += abs(W[3 * ORDERS])
    h = end - now
    own = math.inf
    for m in range(ORDER - 1, ORDERS):
        own = min(own, reach(ROUNDING * size, Z[0, m], m))
    h = min(h, own)
    K[i, WHAT] = 0
    if not h > 0.0:
        plan(i, math.inf, TREE)
        return
    due = now + h if own < end - now else math.inf
    part = 1.0
    for way in range(2):
        side = 1.0 - 2.0 * way
        power = 1.0
        for m in range(ORDERS):
            G[m] = -side * Z[0, m] * power
            power *= h
        G[0] += S[i, HIGH] if way == 0 else -S[i, LOW]
        if abs(G[0]) <= ROUGH * size:
            G[0] = 0.0
        zero = first_zero(G, 0, ORDER)
        if zero <= part:
            part = zero
            due = now + zero * h
            K[i, WHAT] = 1 - 2 * way
    plan(i, due, TREE)


@njit(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f1, f1, f1, i1, i1))
def watch_beside(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB, Q, N):
    """Look at the bodies at rest among those in Q from first to end, and beside them."""
    N[MARKS] += 1
    mark = N[MARKS]
    for q in range(first, end):
        i = Q[q]
        if K[i, MODE] == 0 and K[i, MARK] != mark:
            K[i, MARK] = mark
            watch(i, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB)
        for k in range(K[i, COUNT]):
            e = ADJ[K[i, FIRST] + k]
            other = LINK[e, B] if LINK[e, A] == i else LINK[e, A]
            if other >= 0 and K[other, MODE] == 0 and K[other, MARK] != mark:
                K[other, MARK] = mark
                watch(other, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB)


@njit(void(int64, float64, f2, i2, f2, i2, i1, f1, f2, i1))
def settle(i, now, S, K, X, LINK, ADJ, NUM, EVENTS, N):
    """Decide how a contact goes on whose slip is zero."""
    before = K[i, MODE]
    needed = push_on(i, now, S[i, XS], S[i, BASE], S, K, X, LINK, ADJ, NUM, N)
    rough = ROUGH * (S[i, SIZE] + S[i, HIGH] - S[i, LOW])
    mode = 1 if needed > S[i, HIGH] + rough else -1 if needed < S[i, LOW] - rough else 0
    switch(i, now, mode, S, K, EVENTS, N)
    if mode == before:  # its slip touches zero and goes on
        N[EVENTS_WRITTEN] -= 1
        N[SWITCHED] -= 1


@njit(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, i1))
def regroup(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, N):
    """Find the clusters of the bodies in Q from first to end, which are all where they are now, and begin their steps."""
    for q in range(first, end):
        if K[Q[q], MODE] == 0:
            K[Q[q], LEADER] = Q[q]
    N[MARKS] += 1
    group, place = N[MARKS], end
    for q in range(first, end):
        i = Q[q]
        if K[i, MODE] != 0 and K[i, AT_GROUP] != group:
            N[MARKS] += 1
            last = gather(i, place, K, LINK, ADJ, Q, N)
            for k in range(place, last):
                K[Q[k], AT_GROUP] = group
            begin_step(place, last, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, G, TREE, JOB, Q, L, N)
            for k in range(place, last):
                K[Q[k], BORN] = 0
            place = last
    watch_beside(first, place, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB, Q, N)


@njit(void(f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, f2, i1))
def begin(S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, EVENTS, N):
    """Modes, clusters and margins at the start."""
    bodies, now = len(S), JOB[NOW]
    for i in range(bodies):
        X[i, 0], X[i, 1] = S[i, XS], S[i, VS]
        for m in range(2, PLACES):
            X[i, m] = 0.0
        S[i, T0] = now
        slip = S[i, VS] - S[i, BASE]
        if K[i, AHEAD] < 0:
            K[i, MODE] = 2
        else:
            K[i, MODE] = 1 if slip > 0.0 else -1 if slip < 0.0 else 3
        plan(i, math.inf, TREE)
    for i in range(bodies):
        if K[i, MODE] == 3:
            settle(i, now, S, K, X, LINK, ADJ, NUM, EVENTS, N)
    N[EVENTS_WRITTEN], N[SWITCHED] = 0, 0
    for i in range(bodies):
        Q[i] = i
    regroup(0, bodies, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, N)


@njit(void(f2, i2, f2, f1, f2, i1))
def finish(S, K, X, JOB, PIECES, N):
    """Write down the pieces of all bodies up to now."""
    for i in range(len(S)):
        close(i, JOB[NOW], S, K, X, PIECES, N)


@njit(void(f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, f2, f2, i1))
def advance(S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, PIECES, EVENTS, N):
    """Go on until the end, until the arrays for pieces or events are full, or until the steps of this call are used up."""
    bodies = len(S)
    while N[STATUS] == 0 and N[LEFT] > 0:
        if N[PIECES_WRITTEN] + 3 * bodies > len(PIECES) or N[EVENTS_WRITTEN] + bodies > len(EVENTS):
            return
        N[LEFT] -= 1
        i = next_due(TREE)
        now = S[i, T0] if TREE[len(TREE) // 2 + i] < S[i, T0] else TREE[len(TREE) // 2 + i]
        if now >= JOB[STOP]:
            JOB[NOW] = JOB[STOP]
            finish(S, K, X, JOB, PIECES, N)
            N[STATUS] = 1
            return
        JOB[NOW] = now
        if K[i, MODE] == 0:
            if K[i, WHAT] == 0:
                watch(i, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB)
                continue
            close(i, now, S, K, X, PIECES, N)
            switch(i, now, K[i, WHAT], S, K, EVENTS, N)
            K[i, BORN] = 2
            X[i, 0], X[i, 1] = S[i, XS], S[i, VS]
            N[MARKS] += 1
            count = gather(i, 0, K, LINK, ADJ, Q, N)
            for q in range(1, count):
                close(Q[q], now, S, K, X, PIECES, N)
        else:
            what = K[i, WHAT]
            N[MARKS] += 1
            count = gather(i, 0, K, LINK, ADJ, Q, N)
            for q in range(count):
                close(Q[q], now, S, K, X, PIECES, N)
            for q in range(count):  # where neighbours are asked now, they are where their pieces have ended
                X[Q[q], 0], X[Q[q], 1] = S[Q[q], XS], S[Q[q], VS]
            if what >= 0:
                settle(what, now, S, K, X, LINK, ADJ, NUM, EVENTS, N)
        regroup(0, count, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, N)
