/* What an instance holds, and what happens to it; the machine itself stands in machine.h. */

typedef struct {
    Lane lane;
    double numbers[ROOM(NUMBERS)]; /* as they are set: the machine has them from its next step on */
    double begin[ROOM(N_STATES)];  /* states with which it begins */
    double begin_time, time, span;
    double sides[ROOM(CONTACTS)], memories[ROOM(MEMORIES)], flights[ROOM(CONTACTS)], ends[STATES]; /* of the last piece of motion */
    double aloft[ROOM(CONTACTS)]; /* of the piece that is made */
    int64_t events;
    bool begun, running, renewed, noted, arrived;
} State;

static double period_of(const State *s) { return APERIODIC ? s->span : s->lane.S[AT_PERIOD]; }

static double time_of(const State *s)
{
    return APERIODIC ? s->lane.S[AT_T] : (double)s->lane.N[DONE] * s->lane.S[AT_PERIOD] + s->lane.S[AT_T];
}

/* The way of the first coordinate, with that of the contact from which steps count it. */
static double way_of(State *s)
{
    double offsets[ROOM(COORDINATES)];
    machine_offsets(s->lane.PARAM, offsets);
    return s->lane.S[AT_WAY] + (CARRIED ? offsets[0] * s->time : 0.0);
}

static void set_defaults(State *s)
{
    memset(s, 0, sizeof *s);
    memcpy(s->numbers, NUMBERS_AT_START, sizeof NUMBERS_AT_START);
    memcpy(s->begin, STATES_AT_START, sizeof STATES_AT_START);
    s->span = SPAN_AT_START;
}

static void renew(State *s, double what)
{
    s->lane.GOAL[RENEWED] = what > s->lane.GOAL[RENEWED] ? what : s->lane.GOAL[RENEWED];
    s->lane.GOAL[BEGUN_ANEW] = 1.0;
}

/* A run without a period is taken to be long, until it has lasted half of that. */
static bool lengthen(State *s, double end)
{
    bool longer = false;
    while (APERIODIC && end > 0.5 * s->span) {
        s->span *= 2.0;
        longer = true;
    }
    if (longer && SPAN_AT >= 0) {
        s->lane.PARAM[SPAN_PLACE] = s->span;
    }
    return longer;
}

/* Put the machine where it begins. */
static void begin(State *s)
{
    Lane *W = &s->lane;
    double offsets[ROOM(COORDINATES)];
    memset(W, 0, sizeof *W);
    memcpy(W->PARAM, s->numbers, sizeof s->numbers);
    if (SPAN_AT >= 0) {
        W->PARAM[SPAN_PLACE] = s->span;
    }
    machine_offsets(W->PARAM, offsets);
    W->START[0] = s->begin[WAY_STATE ? 0 : FIRST_POSITION];
    for (int i = 0; i < STATES; i++) {
        W->START[1 + i] = s->begin[WAY_STATE + i] - (i < COORDINATES ? offsets[i] : 0.0);
    }
    for (int i = 0; i < MEMORIES; i++) {
        W->START[1 + STATES + i] = MEMORIES_AT_START[i];
    }
    W->LIMITS[RTOL] = TOLERANCE;
    W->LIMITS[SLIP_RATIO] = 0.75;
    W->LIMITS[BUDGET_OF_STEPS] = BUDGET;
    W->N[CASE] = -1;
    W->GOAL[BEGUN_ANEW] = 1.0;
    machine_advance(W, 0);
    s->time = s->begin_time;
    if (s->begin_time != 0.0) {
        const double T = period_of(s);
        W->N[DONE] = APERIODIC ? 0 : (int64_t)floor(s->begin_time / T);
        W->S[AT_T] = s->begin_time - (double)W->N[DONE] * T;
        lengthen(s, s->begin_time);
        renew(s, 2.0);
        machine_advance(W, 0);
    }
    s->events = 0;
    s->noted = s->arrived = s->renewed = false;
    s->begun = true;
}

/* Give the machine the numbers that were set: positions, velocities and inner states do not jump. */
static void take_numbers(State *s)
{
    Lane *W = &s->lane;
    double before[ROOM(COORDINATES)], after[ROOM(COORDINATES)];
    const double span = SPAN_AT >= 0 ? W->PARAM[SPAN_PLACE] : 0.0;
    machine_offsets(W->PARAM, before);
    memcpy(W->PARAM, s->numbers, sizeof s->numbers);
    if (SPAN_AT >= 0) {
        W->PARAM[SPAN_PLACE] = span;
    }
    machine_offsets(W->PARAM, after);
    for (int j = 0; j < COORDINATES; j++) {
        W->S[AT_Y + j] += before[j] - after[j];
    }
    if (CARRIED) {
        W->S[AT_WAY] += (before[0] - after[0]) * s->time;
    }
    s->renewed = false;
}

/* ---- events ---- */

/* How many events are where the last piece of motion ends and what follows has these sides, memories and states. */
static int events_between(const State *s, const double *sides, const double *memories, const double *flights, const double *y)
{
    const double speed = 1e-9 * s->lane.S[AT_SPEED];
    double jump[ROOM(COORDINATES)];
    int count = 0;
    if (!s->noted) {
        return 0;
    }
    for (int j = 0; j < COORDINATES; j++) {
        jump[j] = y[j] - s->ends[j];
    }
    for (int k = 0; k < STOPS && !s->arrived; k++) {
        double rate = 0.0;
        for (int j = 0; j < COORDINATES; j++) {
            rate += STOP_ROWS[k][j] * jump[j];
        }
        count += rate > speed;
    }
    for (int i = 0; i < CONTACTS; i++) {
        double thrown = 0.0;
        bool changed = sides[i] != s->sides[i];
        if (FLIGHT_STATES[i] >= 0) {
            const double was = s->ends[FLIGHT_STATES[i]], is = y[FLIGHT_STATES[i]];
            const bool up = s->flights[i] > 0.5, stays = flights[i] > 0.5;
            if (up || stays) {
                count += !up || !stays || (was < 0.0 && is >= 0.0);
                continue;
            }
        }
        for (int k = 0; k < MEMORIES; k++) {
            changed = changed || (MEMORY_OF[k] == i && memories[k] != s->memories[k]);
        }
        for (int j = 0; j < COORDINATES && s->arrived; j++) {
            thrown += SLIP_ROWS[i][j] * jump[j];
        }
        count += changed || fabs(thrown) > speed;
    }
    return count;
}

static void sides_now(const State *s, double *sides, double *memories, double *flights)
{
    for (int i = 0; i < CONTACTS; i++) {
        sides[i] = s->lane.S[SIDE_PLACES[i]];
        flights[i] = FLIGHT_PLACES[i] >= 0 ? s->lane.S[FLIGHT_PLACES[i]] : 0.0;
    }
    for (int i = 0; i < MEMORIES; i++) {
        memories[i] = s->lane.S[AT_MODE + i];
    }
}

/* How many events are at the present instant, after the last piece of motion. */
static int events_now(const State *s)
{
    double sides[ROOM(CONTACTS)], memories[ROOM(MEMORIES)], flights[ROOM(CONTACTS)];
    sides_now(s, sides, memories, flights);
    return events_between(s, sides, memories, flights, s->lane.S + AT_Y);
}

/* Note a piece of motion, and the events at which it begins. */
static void note_piece(State *s)
{
    const double *piece = s->lane.PIECES, *sides = piece + 4, *memories = piece + 4 + CONTACTS, *k = piece + 4 + CONTACTS + MEMORIES;
    double first[STATES];
    s->lane.JOB[WRITTEN] = 0;
    if (!(piece[2] > piece[1])) {
        return;
    }
    for (int i = 0; i < STATES; i++) {
        first[i] = k[i * (DEGREE + 1)];
    }
    s->events += events_between(s, sides, memories, s->aloft, first);
    for (int i = 0; i < CONTACTS; i++) {
        s->sides[i] = sides[i];
        s->flights[i] = s->aloft[i];
    }
    for (int i = 0; i < MEMORIES; i++) {
        s->memories[i] = memories[i];
    }
    for (int i = 0; i < STATES; i++) {
        double end = 0.0;
        for (int m = DEGREE; m >= 0; m--) {
            end += k[i * (DEGREE + 1) + m];
        }
        s->ends[i] = end;
    }
    s->noted = true;
    s->arrived = false;
}

/* Go on to a time, or to the first event if it is asked for; returns a status of the machine, 0 for a step that was made. */
static int go_on(State *s, double current, double size, bool stop, bool *stopped)
{
    Lane *W = &s->lane;
    const double end = current + size, begun = time_of(s), T0 = period_of(s);
    double sides[ROOM(CONTACTS)], memories[ROOM(MEMORIES)];
    *stopped = false;
    if (s->renewed) {
        take_numbers(s);
        renew(s, 2.0);
    }
    if (lengthen(s, end)) {
        renew(s, 1.0);
    }
    double whole = (double)W->N[DONE], time = W->S[AT_T] + size;
    if (!APERIODIC) {
        const double more = floor(time / T0);
        whole += more;
        time -= more * T0;
        if (more > 0.0 && time <= 1e-12 * T0) {
            whole -= 1.0;
            time = T0;
        }
    }
    W->GOAL[GOAL_PERIOD] = whole;
    W->GOAL[GOAL_TIME] = time;
    W->GOAL[EACH_STEP] = 0.0;
    W->GOAL[BEGUN_ANEW] = 1.0;
    W->JOB[WRITTEN] = 0;
    W->LIMITS[BUDGET_OF_STEPS] = APERIODIC ? BUDGET : BUDGET * (ceil(size / T0) + 1.0);
    for (;;) {
        const double known = W->S[AT_END];
        sides_now(s, sides, memories, s->aloft);
        const int64_t code = machine_advance(W, 1);
        if (W->JOB[WRITTEN] > 0) {
            const bool there = W->PIECES[2] >= known;
            note_piece(s);
            s->arrived = IMPULSES > 0 && there;
        }
        for (int i = 0; i < STATES; i++) {
            if (!isfinite(W->S[AT_Y + i])) {
                return -1;
            }
        }
        if (code != UNDER_WAY) {
            s->time = code == THERE ? end : time_of(s);
            return code == ENDED ? (int)W->N[STATUS] : 0;
        }
        if (stop && time_of(s) > begun + 1e-12 * T0 && events_now(s) > 0) {
            s->time = time_of(s);
            *stopped = true;
            return 0;
        }
    }
}

/* ---- model exchange ---- */

static void set_time(State *s, double t)
{
    s->time = t;
    if (lengthen(s, t)) {
        machine_constants(&s->lane);
    }
    s->lane.S[AT_T] = APERIODIC ? t : t - (double)s->lane.N[DONE] * s->lane.S[AT_PERIOD];
}

static void set_states(State *s, const double *x)
{
    double offsets[ROOM(COORDINATES)];
    machine_offsets(s->lane.PARAM, offsets);
    for (int i = 0; i < STATES; i++) {
        s->lane.S[AT_Y + i] = x[WAY_STATE + i] - (i < COORDINATES ? offsets[i] : 0.0);
    }
    s->lane.S[AT_WAY] = WAY_STATE ? x[0] - (CARRIED ? offsets[0] * s->time : 0.0) : x[FIRST_POSITION];
}

/* Known instants, and guards that have come to zero; returns a status of the machine, 0 if it goes on. */
static int update(State *s, bool *jumped)
{
    Lane *W = &s->lane;
    double values[ROOM(N_WATCHED)], rates[ROOM(N_WATCHED)];
    bool done[ROOM(N_WATCHED)] = {false};
    const double T = period_of(s), soon = 1e-9 * T; /* so far from its instant an importer may have located an event */
    int status = 0;
    sides_now(s, s->sides, s->memories, s->flights);
    memcpy(s->ends, W->S + AT_Y, sizeof s->ends);
    s->noted = true;
    s->arrived = false;
    if (s->renewed) {
        take_numbers(s);
        renew(s, 2.0);
        machine_advance(W, 0);
    }
    if (!(APERIODIC && W->S[AT_END] >= s->span) && W->S[AT_T] >= W->S[AT_END] - 1e-12 * T) {
        W->S[AT_T] = W->S[AT_END];
        machine_arrive(W);
        s->arrived = IMPULSES > 0;
    }
    for (int turn = 0; turn < 4 * N_WATCHED + 4; turn++) {
        int which = -1;
        machine_guards(W, values);
        machine_guard_rates(W, rates);
        for (int k = 0; k < N_WATCHED && which < 0; k++) { /* one that rises after its event has not fallen again */
            const bool falls = values[k] + soon * rates[k] < 0.0 || (values[k] < 0.0 && rates[k] == 0.0);
            which = falls && !(done[k] && rates[k] > 0.0) ? k : -1;
        }
        if (which < 0) {
            break;
        }
        done[which] = true;
        status = machine_switch(W, which);
        if (status != 0) {
            return status;
        }
    }
    *jumped = memcmp(s->ends, W->S + AT_Y, sizeof s->ends) != 0;
    s->events += events_now(s);
    return 0;
}
