"""More cases than lanes, for steps of which there are two sorts: lanes hold cases that want the same; the driver's last part."""
# ruff: noqa: F821
# mypy: ignore-errors
#
# Each case at work has a place, with its rows of N, K, RING and XS; some are in a lane, the others wait, with what a lane holds
# from step to step in their row of STORE. A lane whose case wants the other sort of step changes it for one that waits for this sort. When
# there are too few of these, all go over to the other sort. POOL says which place is in which lane (-1: none), then for either sort how
# many places wait for it and which, and last of which sort the steps are; then how many numbers are not the same for all cases, and which.

#: With how many lanes at work steps of a sort go on while more cases wait for the other sort.
ENOUGH = 13
VECTOR = 8  # lanes of a vector of the step
IN_LANE, WAITING, SORT, VARIED = 0, 1, 3, 4
NOBODY, MISFIT, FIT = 0, 1, 2  # what a lane has: no case, one that wants the other sort of step, one that wants this


@typed(void(int64, int64, int64, f1, int64, i1))
def put_away(slot, lane, sort, S, W, D):
    """Let the case of a lane wait for steps of a sort."""
    STORE, POOL = STORE_of(W), POOL_of(W)
    at, apart = np.uint64(POOL.shape[1] + lane), np.uint64(D[LANES])
    row = STORE[slot]
    for f in range(np.uint64(D[LASTING])):
        row[f] = S[at]
        at += apart
    S[POOL.shape[1] + lane + D[F_TEND]] = 1e30
    POOL[WAITING + sort, 0] += 1
    POOL[WAITING + sort, POOL[WAITING + sort, 0]] = slot
    POOL[IN_LANE, lane] = -1


@typed(int64(int64, int64, f1, int64, i1))
def bring(lane, sort, S, W, D):
    """Put a case that waits for steps of a sort into an empty lane; returns its place, or -1 if there is none."""
    STORE, POOL = STORE_of(W), POOL_of(W)
    count = POOL[WAITING + sort, 0]
    if count == 0:
        return -1
    slot, first = POOL[WAITING + sort, count], POOL.shape[1] + lane
    POOL[WAITING + sort, 0] = count - 1
    at, apart, row = np.uint64(first), np.uint64(D[LANES]), STORE[slot]
    lasting = np.uint64(D[LASTING])
    for f in range(lasting):
        S[at] = row[f]
        at += apart
    constants = np.uint64(first + D[F_C])
    for k in range(1, POOL[VARIED, 0] + 1):
        j = np.uint64(POOL[VARIED, k])
        S[constants + j * apart] = row[lasting + j]
    S[first + D[F_SOON]] = sort
    POOL[IN_LANE, lane] = slot
    return slot


@typed(int64(int64, int64, int64, int64, f1, int64, i1))
def exchange(lane, slot, wish, sort, S, W, D):
    """Give a lane a case that wants steps of a sort, if one waits, and it has none (place -1) or another; what it has now."""
    POOL = POOL_of(W)
    if slot >= 0 and wish != sort and POOL[WAITING + sort, 0] > 0:
        put_away(slot, lane, wish, S, W, D)
        slot = -1
    if slot < 0:
        return FIT if bring(lane, sort, S, W, D) >= 0 else NOBODY
    return FIT if wish == sort else MISFIT


@typed(int64(f1, int64, i1))
def marks_of(S, begin, D):
    """The lanes, as bits, in which something was noted or whose case wants the other sort of step."""
    marks = 0
    for first in range(0, D[LANES], VECTOR):
        marks |= as_bits(S[begin + D[F_MARKS] + first]) << first
    return marks


@typed(int64(int64))
def lowest(bits):
    """The place of the lowest bit that is set."""
    return (as_bits(np.float64(bits & -bits)) >> 52) - 1023


@typed(int64(int64))
def count_of(bits):
    """How many bits are set."""
    count = 0
    while bits != 0:
        bits &= bits - 1
        count += 1
    return count


@typed(void(int64, int64, f1, int64, i1))
def keep_constants(slot, lane, S, W, D):
    """What lasts as long as the case of a lane."""
    STORE, POOL = STORE_of(W), POOL_of(W)
    for j in range(D[CONSTANTS]):
        STORE[slot, D[LASTING] + j] = S[POOL.shape[1] + lane + D[F_C] + j * D[LANES]]


@typed(void(int64, i1))
def find_varied(W, D):
    """Which numbers of a case are not those of all other cases: lanes that change their case need no others."""
    JOB, PARAM, POOL = JOB_of(W), PARAM_of(W), POOL_of(W)
    first, other = np.empty(D[CONSTANTS]), np.empty(D[CONSTANTS])
    varies = np.zeros(D[CONSTANTS], dtype=np.int64)
    call_prelude(D[AT_PRELUDE], PARAM[JOB[NEXT]], first)
    for case in range(JOB[NEXT] + 1, JOB[END]):
        call_prelude(D[AT_PRELUDE], PARAM[case], other)
        for j in range(D[CONSTANTS]):
            varies[j] |= other[j] != first[j] or other[j] != other[j]
    for j in range(D[CONSTANTS]):
        if varies[j]:
            POOL[VARIED, 0] += 1
            POOL[VARIED, POOL[VARIED, 0]] = j


@typed(int64(f1, int64, i1))
def cases_at_work(S, W, D):
    """How many places have a case; at the start of a job they are given the first ones, and the first of these the lanes."""
    N, POOL = N_of(W), POOL_of(W)
    begin, places, active = POOL.shape[1], N.shape[0], 0
    for slot in range(places):
        if N[slot, CASE] >= 0:
            active += 1
    if active > 0:
        return active
    for lane in range(D[LANES]):
        POOL[IN_LANE, lane] = -1
        S[begin + lane + D[F_TEND]] = 1e30
    find_varied(W, D)
    for slot in range(places - 1, -1, -1):
        lane = slot if slot < D[LANES] else 0
        if next_case(slot, S[begin + lane - slot :], W, D):
            active += 1
            keep_constants(slot, lane, S, W, D)
            POOL[IN_LANE, lane] = slot
            S[begin + lane + D[F_SOON]] = 0.0
            if slot >= D[LANES]:
                put_away(slot, lane, 0, S, W, D)
    return active


@typed(UniTuple(int64, 2)(f1, int64, i1))
def idle_lanes(S, W, D):
    """Bits of the lanes whose case wants the other sort of step, and of the lanes without a case."""
    POOL = POOL_of(W)
    misfits, empty = 0, 0
    for lane in range(D[LANES]):
        if POOL[IN_LANE, lane] < 0:
            empty |= 1 << lane
        elif np.int64(S[POOL.shape[1] + D[F_SOON] + lane]) != POOL[SORT, 0]:
            misfits |= 1 << lane
    return misfits, empty


@typed(int64(f1, int64, int64, i1))
def advance_pooled(S, calls, W, D):
    """As `advance`, with a row of N, K, RING and XS for each place, and as many numbers before the lanes in S as there are places."""
    N, POOL = N_of(W), POOL_of(W)
    rtol, least = LIMITS_of(W)[RTOL], min(STEPS_TO_LOOK, LIMITS_of(W)[BUDGET_OF_STEPS])
    L, begin, active = D[LANES], POOL.shape[1], cases_at_work(S, W, D)
    steps, soon = S[begin:], begin + D[F_SOON]
    misfits, empty = idle_lanes(S, W, D)
    for _ in range(calls):
        if active == 0:
            return 0
        call_step(D[AT_STEP], steps, rtol, least)
        sort = POOL[SORT, 0]
        asking, misfits = marks_of(S, begin, D) | misfits | (empty if POOL[WAITING + sort, 0] > 0 else 0), 0
        while asking != 0:
            lane = lowest(asking)
            asking &= asking - 1
            slot = POOL[IN_LANE, lane]
            wish = np.int64(S[soon + lane])
            if slot >= 0 and wish > 1:
                V = S[begin + lane - slot :]
                if N[slot, RECORDING] == 1:
                    watch(slot, V, W, D)
                if steps[D[F_STAT] + lane] >= 0.5:
                    case = N[slot, CASE]
                    if not go_on(slot, V, W, D):
                        active -= 1
                        POOL[IN_LANE, lane] = slot = -1
                    elif N[slot, CASE] != case:
                        keep_constants(slot, lane, S, W, D)
                        wish = 2
                wish -= 2
                S[soon + lane] = wish
            match = exchange(lane, slot, wish, sort, S, W, D)
            empty = empty | 1 << lane if match == NOBODY else empty & ~(1 << lane)
            misfits |= (match == MISFIT) << lane
        ready = L - count_of(misfits | empty)
        if ready < ENOUGH and active - ready > ready:
            sort = 1 - sort
            POOL[SORT, 0] = sort
            misfits = 0
            for lane in range(L):
                match = exchange(lane, POOL[IN_LANE, lane], np.int64(S[soon + lane]), sort, S, W, D)
                empty = empty | 1 << lane if match == NOBODY else empty & ~(1 << lane)
                misfits |= (match == MISFIT) << lane
    return active
