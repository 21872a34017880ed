"""Rows of many bodies (local_events.py): a cluster of bodies that move together, its polynomials, and where its step ends."""
# ruff: noqa: F821
# mypy: ignore-errors


# ---- what comes next: a tree of times ----
@typed(void(int64, float64, f1))
def plan(i, t, TREE):
    """Body i, as the first of its cluster or at rest, is due at t."""
    k = i + len(TREE) // 2
    TREE[k] = t
    k = k // 2
    while k >= 1:
        TREE[k] = min(TREE[2 * k], TREE[2 * k + 1])
        k = k // 2


@typed(int64(f1))
def next_due(TREE):
    """The body that is due first."""
    k, half = 1, len(TREE) // 2
    while k < half:
        k = 2 * k if TREE[2 * k] <= TREE[2 * k + 1] else 2 * k + 1
    return k - half


# ---- where a step ends ----
@typed(float64(f1, int64, int64))
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
    return first_below(C, at, degree, noise)


@typed(float64(float64, float64, int64))
def reach(least, coefficient, m):
    """Where a term of order m is as large as is tolerated."""
    if coefficient == 0.0 or not least > 0.0:
        return math.inf
    return math.expm1(0.6931471805599453 * math.log2(least / abs(coefficient)) / m) + 1.0


# ---- clusters ----
@typed(int64(int64, int64, i2, i2, i1, i1, i1))
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


@typed(int64(int64, int64, float64, f2, i2, f2, i2, i1, i1, i1, i1))
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


@typed(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, i1, i1, i1))
def expand(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Q, L, N):
    """The Taylor coefficients of all bodies of a cluster."""
    count = links_of(first, end, now, S, K, X, LINK, ADJ, Q, L, N)
    for q in range(first, end):
        i = Q[q]
        X[i, 0], X[i, 1] = S[i, XS], S[i, VS]
        S[i, SIZE] = abs(S[i, PUSH])
    for m in range(ORDER):
        for q in range(first, end):
            S[Q[q], SUM] = S[Q[q], PUSH] if m == 0 else 0.0
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


@typed(float64(int64, int64, f2, i2, f2, f1, i1))
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


@typed(float64(int64, float64, f2, i2, f2, f1))
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


@typed(boolean(int64, int64, float64, float64, f2, i2, f2, i2, i1, f1, f1, i1, i1))
def fits(first, end, now, dt, S, K, X, LINK, ADJ, NUM, JOB, Q, N):
    """Whether the polynomials do what the equations say at a time dt after now."""
    for q in range(first, end):
        i = Q[q]
        x, v = value_at(X[i], 0, PLACES - 1, dt), slope_at(X[i], 0, PLACES - 1, dt)
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
        misfit = abs(curvature_at(X[i], 0, PLACES - 1, dt) - force / S[i, MASS]) * dt
        if not misfit <= MISFIT * max(JOB[SPEED], abs(v)) + dt * (ROUGH_SLOPE * slope + ROUGH * size / S[i, MASS]):
            return False
    return True


@typed(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f1, f1, f1, i1, i1, i1))
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
