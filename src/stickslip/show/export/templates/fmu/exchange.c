/* Model Exchange: the importer integrates, and asks for rates, event indicators and what an event does. */

FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(
    fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *ends, fmi3Boolean *nominals, fmi3Boolean *jumped, fmi3Boolean *has_next,
    fmi3Float64 *next)
{
    Instance *c = instance;
    State *s = &c->now;
    bool moved = false;
    *again = *ends = *nominals = *jumped = *has_next = false;
    *next = 0.0;
    if (!c->exchange) {
        return fmi3OK;
    }
    *ends = update(s, &moved) != 0;
    *jumped = moved;
    *has_next = !(APERIODIC && s->lane.S[AT_END] >= s->span);
    *next = APERIODIC ? s->lane.S[AT_END] : (double)s->lane.N[DONE] * s->lane.S[AT_PERIOD] + s->lane.S[AT_END];
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *ends)
{
    (void)instance, (void)no_return;
    *event = *ends = false;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    Instance *c = instance;
    set_time(&c->now, time);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t n)
{
    Instance *c = instance;
    if (n != N_STATES) {
        return tell(c, fmi3Error, "there are as many continuous states as fmi3GetNumberOfContinuousStates says");
    }
    set_states(&c->now, states);
    return fmi3OK;
}

static fmi3Status some_values(Instance *c, size_t first, double values[], size_t n, size_t expected)
{
    double all[ROOM(N_VALUES)];
    if (n != expected) {
        return tell(c, fmi3Error, "the number of values is not that of the states, or of the event indicators");
    }
    read_values(c, all);
    for (size_t i = 0; i < n; i++) {
        values[i] = all[first + i];
    }
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 values[], size_t n)
{
    return some_values(instance, N_STATES, values, n, N_STATES);
}

FMI3_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 values[], size_t n)
{
    return some_values(instance, 0, values, n, N_STATES);
}

FMI3_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 values[], size_t n)
{
    Instance *c = instance;
    double all[ROOM(N_WATCHED)];
    if (n != N_WATCHED) {
        return tell(c, fmi3Error, "there are as many event indicators as fmi3GetNumberOfEventIndicators says");
    }
    begin_if_new(c);
    machine_guards(&c->now.lane, all);
    memcpy(values, all, n * sizeof *values);
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 values[], size_t n)
{
    Instance *c = instance;
    double all[ROOM(N_STATES)];
    if (n != N_STATES) {
        return tell(c, fmi3Error, "there are as many nominals as states");
    }
    begin_if_new(c);
    machine_nominals(&c->now.lane, all);
    for (size_t i = 0; i < n; i++) {
        values[i] = all[i] > 0.0 && isfinite(all[i]) ? all[i] : 1.0;
    }
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n)
{
    (void)instance;
    *n = N_WATCHED;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n)
{
    (void)instance;
    *n = N_STATES;
    return fmi3OK;
}
