/* The functions of FMI 3.0 for a machine of stickslip: Co-Simulation and Model Exchange. */

#include "fmi3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

#include "machine.h"
#include "state.c"

typedef struct {
    State now;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    bool exchange, stops_at_events;
} Instance;

typedef struct {
    char token[64];
    State state;
} Kept;

static fmi3Status tell(const Instance *c, fmi3Status status, const char *message)
{
    if (c->log != NULL) {
        c->log(c->environment, status, status == fmi3OK ? "logEvents" : "logStatusError", message);
    }
    return status;
}

static void begin_if_new(Instance *c)
{
    if (!c->now.begun) {
        begin(&c->now);
    }
}

static Instance *made(fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    Instance *c = NULL;
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        if (log != NULL) {
            log(environment, fmi3Error, "logStatusError", "the instantiation token is that of another FMU");
        }
        return NULL;
    }
    c = calloc(1, sizeof *c);
    if (c != NULL) {
        c->environment = environment;
        c->log = log;
        set_defaults(&c->now);
    }
    return c;
}

FMI3_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)instance, (void)on, (void)n, (void)categories;
    return fmi3OK;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log)
{
    Instance *c = made(token, environment, log);
    (void)name, (void)path, (void)visible, (void)logging;
    if (c != NULL) {
        c->exchange = true;
    }
    return c;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
    fmi3Boolean early_return, const fmi3ValueReference required[], size_t n, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback intermediate)
{
    Instance *c = made(token, environment, log);
    (void)name, (void)path, (void)visible, (void)logging, (void)required, (void)n, (void)intermediate;
    if (c != NULL) {
        c->stops_at_events = event_mode && early_return;
    }
    return c;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)path, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    if (log != NULL) {
        log(environment, fmi3Error, "logStatusError", "this FMU has Co-Simulation and Model Exchange");
    }
    return NULL;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    Instance *c = instance;
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    if (!isfinite(start)) {
        return tell(c, fmi3Error, "the start time is not a finite number");
    }
    c->now.begin_time = start;
    c->now.begun = false;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    Instance *c = instance;
    begin_if_new(c);
    c->now.running = true;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }
FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }
FMI3_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }
FMI3_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }
FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }
FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }
FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) { return instance != NULL ? fmi3OK : fmi3Error; }

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance instance)
{
    Instance *c = instance;
    set_defaults(&c->now);
    return fmi3OK;
}

/* ---- values ---- */

static void read_values(Instance *c, double *values)
{
    begin_if_new(c);
    machine_values(&c->now.lane, way_of(&c->now), values);
}

FMI3_EXPORT fmi3Status fmi3GetFloat64(
    fmi3Instance instance, const fmi3ValueReference which[], size_t n, fmi3Float64 values[], size_t count)
{
    Instance *c = instance;
    double all[ROOM(N_VALUES)];
    bool known = false;
    for (size_t k = 0; k < n && k < count; k++) {
        const fmi3ValueReference vr = which[k];
        if (vr == 0) {
            values[k] = c->now.begun ? c->now.time : c->now.begin_time;
        } else if (vr <= NUMBERS) {
            values[k] = c->now.numbers[vr - 1];
        } else if (vr < FIRST_VALUE + N_STATES && !c->now.begun) {
            values[k] = c->now.begin[vr - FIRST_VALUE];
        } else if (vr < FIRST_VALUE + N_VALUES) {
            if (!known) {
                read_values(c, all);
                known = true;
            }
            values[k] = all[vr - FIRST_VALUE];
        } else {
            return tell(c, fmi3Error, "a value reference is that of no number");
        }
    }
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFloat64(
    fmi3Instance instance, const fmi3ValueReference which[], size_t n, const fmi3Float64 values[], size_t count)
{
    Instance *c = instance;
    State *s = &c->now;
    for (size_t k = 0; k < n && k < count; k++) {
        const fmi3ValueReference vr = which[k];
        if (!isfinite(values[k])) {
            return tell(c, fmi3Error, "a value is not a finite number");
        }
        if (vr >= 1 && vr <= NUMBERS) {
            if (s->running && KINDS[vr - 1] == 0) {
                return tell(c, fmi3Error, "a fixed parameter is set after the initialization");
            }
            s->renewed = s->renewed || s->numbers[vr - 1] != values[k];
            s->numbers[vr - 1] = values[k];
            if (!s->running) {
                s->begun = false;
            } else if (c->exchange && KINDS[vr - 1] == 2 && s->renewed) {
                take_numbers(s);
                machine_constants(&s->lane);
            }
        } else if (vr >= FIRST_VALUE && vr < FIRST_VALUE + N_STATES && !s->running) {
            s->begin[vr - FIRST_VALUE] = values[k];
            s->begun = false;
        } else {
            return tell(c, fmi3Error, "a value is set that is no parameter, input or state at the start");
        }
    }
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference which[], size_t n, fmi3Int32 values[], size_t count)
{
    Instance *c = instance;
    begin_if_new(c);
    for (size_t k = 0; k < n && k < count; k++) {
        if (which[k] >= FIRST_VALUE + N_VALUES && which[k] < FIRST_VALUE + N_VALUES + CONTACTS) {
            values[k] = (fmi3Int32)c->now.lane.S[SIDE_PLACES[which[k] - FIRST_VALUE - N_VALUES]];
        } else if (which[k] == FIRST_VALUE + N_VALUES + CONTACTS) {
            values[k] = (fmi3Int32)(c->now.events + (c->exchange ? 0 : events_now(&c->now)));
        } else {
            return tell(c, fmi3Error, "a value reference is that of no whole number");
        }
    }
    return fmi3OK;
}

/* ---- the state ---- */

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    Instance *c = instance;
    Kept *kept = *state != NULL ? *state : calloc(1, sizeof *kept);
    if (kept == NULL) {
        return tell(c, fmi3Error, "there is no memory for the state");
    }
    strncpy(kept->token, TOKEN, sizeof kept->token - 1);
    kept->state = c->now;
    *state = kept;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
    Instance *c = instance;
    const Kept *kept = state;
    if (kept == NULL) {
        return tell(c, fmi3Error, "there is no state");
    }
    c->now = kept->state;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    (void)instance, (void)state;
    *size = sizeof(Kept);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    if (state == NULL || size < sizeof(Kept)) {
        return tell(instance, fmi3Error, "there is no state, or no room for it");
    }
    memcpy(bytes, state, sizeof(Kept));
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    Kept *kept = NULL;
    if (size != sizeof(Kept) || strncmp((const char *)bytes, TOKEN, sizeof kept->token) != 0) {
        return tell(instance, fmi3Error, "the bytes are not a state of this FMU");
    }
    kept = *state != NULL ? *state : malloc(sizeof *kept);
    if (kept == NULL) {
        return tell(instance, fmi3Error, "there is no memory for the state");
    }
    memcpy(kept, bytes, sizeof *kept);
    *state = kept;
    return fmi3OK;
}

/* ---- derivatives ---- */

FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t n, const fmi3ValueReference knowns[], size_t m,
    const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t count)
{
    Instance *c = instance;
    double direction[ROOM(N_STATES + NUMBERS)] = {0.0}, all[ROOM(N_VALUES)];
    begin_if_new(c);
    for (size_t k = 0; k < m && k < seeds; k++) {
        if (knowns[k] >= 1 && knowns[k] <= NUMBERS) {
            direction[N_STATES + knowns[k] - 1] += seed[k];
        } else if (knowns[k] >= FIRST_VALUE && knowns[k] < FIRST_VALUE + N_STATES) {
            direction[knowns[k] - FIRST_VALUE] += seed[k];
        } else {
            return tell(c, fmi3Error, "derivatives are by states, inputs and parameters");
        }
    }
    machine_tangent(&c->now.lane, way_of(&c->now), direction, all);
    for (size_t k = 0; k < n && k < count; k++) {
        if (unknowns[k] < FIRST_VALUE || unknowns[k] >= FIRST_VALUE + N_VALUES) {
            return tell(c, fmi3Error, "derivatives are those of outputs and of the rates of states");
        }
        sensitivity[k] = all[unknowns[k] - FIRST_VALUE];
    }
    return fmi3OK;
}

/* ---- co-simulation ---- */

FMI3_EXPORT fmi3Status fmi3DoStep(
    fmi3Instance instance, fmi3Float64 current, fmi3Float64 size, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *ends,
    fmi3Boolean *early, fmi3Float64 *last)
{
    Instance *c = instance;
    char message[96];
    bool stopped = false;
    (void)no_return;
    *event = *ends = *early = false;
    *last = c->now.time;
    if (!(size > 0.0) || !isfinite(size)) {
        return tell(c, fmi3Error, "the size of the step is not a positive number");
    }
    if (!(fabs(current - c->now.time) <= 1e-9 * (size + fabs(current)))) {
        return tell(c, fmi3Error, "the step does not begin where the last one has ended");
    }
    const int status = go_on(&c->now, current, size, c->stops_at_events, &stopped);
    *last = c->now.time;
    *event = *early = stopped;
    if (status == 0) {
        return fmi3OK;
    }
    for (size_t k = 0; k < sizeof STATUS_WORDS / sizeof STATUS_WORDS[0]; k++) {
        if (STATUS_WORDS[k].status == status) {
            snprintf(message, sizeof message, "t = %.9g s: %s", c->now.time, STATUS_WORDS[k].words);
            *ends = true;
            return tell(c, STATUS_WORDS[k].is_end ? fmi3OK : fmi3Error, message);
        }
    }
    return tell(c, fmi3Error, "a state is no finite number any more");
}

#include "exchange.c"
#include "absent.c"
