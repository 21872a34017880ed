"""Rows of many bodies, event by event: what moves together is one cluster with a step of its own, and what rests waits for its neighbours.

Two moving bodies that a link joins are of one cluster. Between clusters stand bodies at rest, whose motion is known, so that a cluster is
expanded, and ends its step, without the others. A body at rest has a margin, a polynomial of its neighbours' motions, and breaks away where
that is zero. Whatever comes first in the whole row is done first: then only the clusters that it touches are expanded anew, and only the
margins beside them are looked at again.
"""
# ruff: noqa: F821
# mypy: ignore-errors


# ---- what is kept ----
@typed(void(int64, float64, f2, i2, f2, f2, i1))
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


@typed(void(int64, float64, int64, f2, i2, f2, i1))
def switch(i, now, mode, S, K, EVENTS, N):
    """A contact has another mode; its slip is zero."""
    k = N[EVENTS_WRITTEN]
    N[EVENTS_WRITTEN] += 1
    N[SWITCHED] += 1
    EVENTS[k, 0], EVENTS[k, 1], EVENTS[k, 2] = now, i, mode
    K[i, MODE], K[i, BORN] = mode, 1
    S[i, VS] = S[i, BASE]


# ---- bodies at rest ----
@typed(void(int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f1, f1, f1))
def watch(i, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB):
    """Plan when a body at rest breaks away, or is looked at again."""
    end = JOB[STOP]
    for m in range(ORDERS):
        Z[0, m] = S[i, PUSH] if m == 0 else 0.0
    size = S[i, HIGH] - S[i, LOW] + abs(S[i, PUSH])
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


@typed(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f1, f1, f1, i1, i1))
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


@typed(void(int64, float64, f2, i2, f2, i2, i1, f1, f2, i1))
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


@typed(void(int64, int64, float64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, i1))
def regroup(first, end, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, N):
    """Find the clusters of the bodies in Q from first to end, which are all where they are now, and begin their steps."""
    for q in range(first, end):
        if K[Q[q], MODE] == 0:
            K[Q[q], LEADER] = Q[q]
    N[MARKS] += 1
    group, slot = N[MARKS], end
    for q in range(first, end):
        i = Q[q]
        if K[i, MODE] != 0 and K[i, AT_GROUP] != group:
            N[MARKS] += 1
            last = gather(i, slot, K, LINK, ADJ, Q, N)
            for k in range(slot, last):
                K[Q[k], AT_GROUP] = group
            begin_step(slot, last, now, S, K, X, LINK, ADJ, NUM, WL, WC, WA, G, TREE, JOB, Q, L, N)
            for k in range(slot, last):
                K[Q[k], BORN] = 0
            slot = last
    watch_beside(first, slot, now, S, K, X, LINK, ADJ, NUM, WL, WA, Z, G, TREE, JOB, Q, N)


@typed(void(f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, f2, i1))
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


@typed(void(f2, i2, f2, f1, f2, i1))
def finish(S, K, X, JOB, PIECES, N):
    """Write down the pieces of all bodies up to now."""
    for i in range(len(S)):
        close(i, JOB[NOW], S, K, X, PIECES, N)


@typed(void(f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, f2, f2, i1))
def advance(S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, PIECES, EVENTS, N):
    """Go on until the end or the pause, until the arrays for pieces or events are full, or until the steps of this call are used up."""
    bodies = len(S)
    N[PAUSED] = 0
    while N[STATUS] == 0 and N[LEFT] > 0:
        if N[PIECES_WRITTEN] + 3 * bodies > len(PIECES) or N[EVENTS_WRITTEN] + bodies > len(EVENTS):
            return
        N[LEFT] -= 1
        i = next_due(TREE)
        now = S[i, T0] if TREE[len(TREE) // 2 + i] < S[i, T0] else TREE[len(TREE) // 2 + i]
        if now > JOB[PAUSE]:
            JOB[NOW] = JOB[PAUSE]
            N[PAUSED] = 1
            return
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
        if JOB[EACH_EVENT] > 0.0 and N[EVENTS_WRITTEN] > 0:
            return


@typed(void(int64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, f2, f2, i1))
def act(what, S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, PIECES, EVENTS, N):
    """What Python asks for, in one compiled function."""
    if what == BEGIN:
        begin(S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, EVENTS, N)
    elif what == ADVANCE:
        advance(S, K, X, LINK, ADJ, NUM, WL, WC, WA, Z, G, TREE, JOB, Q, L, PIECES, EVENTS, N)
    else:
        finish(S, K, X, JOB, PIECES, N)
