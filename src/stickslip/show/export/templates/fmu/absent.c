/* What FMI 3.0 has and this FMU does not: variables of other types, clocks, adjoint derivatives, scheduled execution. */

static fmi3Status absent(fmi3Instance instance, const char *what) { return tell(instance, fmi3Error, what); }

FMI3_EXPORT fmi3Status fmi3GetFloat32(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Float32 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Float32");
}

FMI3_EXPORT fmi3Status fmi3GetInt8(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Int8 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Int8");
}

FMI3_EXPORT fmi3Status fmi3GetUInt8(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3UInt8 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt8");
}

FMI3_EXPORT fmi3Status fmi3GetInt16(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Int16 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Int16");
}

FMI3_EXPORT fmi3Status fmi3GetUInt16(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3UInt16 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt16");
}

FMI3_EXPORT fmi3Status fmi3GetUInt32(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3UInt32 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt32");
}

FMI3_EXPORT fmi3Status fmi3GetInt64(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Int64 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Int64");
}

FMI3_EXPORT fmi3Status fmi3GetUInt64(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3UInt64 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt64");
}

FMI3_EXPORT fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Boolean values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Boolean");
}

FMI3_EXPORT fmi3Status fmi3GetString(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3String values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type String");
}

FMI3_EXPORT fmi3Status fmi3SetFloat32(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Float32 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Float32");
}

FMI3_EXPORT fmi3Status fmi3SetInt8(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Int8 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Int8");
}

FMI3_EXPORT fmi3Status fmi3SetUInt8(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3UInt8 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt8");
}

FMI3_EXPORT fmi3Status fmi3SetInt16(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Int16 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Int16");
}

FMI3_EXPORT fmi3Status fmi3SetUInt16(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3UInt16 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt16");
}

FMI3_EXPORT fmi3Status fmi3SetUInt32(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3UInt32 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt32");
}

FMI3_EXPORT fmi3Status fmi3SetInt64(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Int64 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Int64");
}

FMI3_EXPORT fmi3Status fmi3SetUInt64(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3UInt64 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type UInt64");
}

FMI3_EXPORT fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Boolean values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type Boolean");
}

FMI3_EXPORT fmi3Status fmi3SetString(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3String values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "this FMU has no variables of type String");
}

FMI3_EXPORT fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Int32 values[], size_t count)
{
    (void)which, (void)n, (void)values, (void)count;
    return n == 0 ? fmi3OK : absent(c, "modes and the count of events are outputs");
}

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference which[], size_t n, size_t sizes[], fmi3Binary values[], size_t count)
{
    (void)which, (void)n, (void)sizes, (void)values, (void)count;
    return absent(c, "this FMU has no variables of type Binary");
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference which[], size_t n, const size_t sizes[], const fmi3Binary values[], size_t count)
{
    (void)which, (void)n, (void)sizes, (void)values, (void)count;
    return absent(c, "this FMU has no variables of type Binary");
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Clock values[])
{
    (void)which, (void)n, (void)values;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Clock values[])
{
    (void)which, (void)n, (void)values;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference which, size_t *n)
{
    (void)which, (void)n;
    return absent(c, "dependencies stand in modelDescription.xml");
}

FMI3_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference which, size_t own[], fmi3ValueReference others[], size_t of_others[],
    fmi3DependencyKind kinds[], size_t n)
{
    (void)which, (void)own, (void)others, (void)of_others, (void)kinds, (void)n;
    return absent(c, "dependencies stand in modelDescription.xml");
}

FMI3_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t n, const fmi3ValueReference knowns[], size_t m,
    const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t count)
{
    (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)seeds, (void)sensitivity, (void)count;
    return absent(c, "derivatives are directional ones");
}

FMI3_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Float64 values[], fmi3IntervalQualifier qualifiers[])
{
    (void)which, (void)n, (void)values, (void)qualifiers;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)which, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3Float64 values[])
{
    (void)which, (void)n, (void)values;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference which[], size_t n, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void)which, (void)n, (void)counters, (void)resolutions;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Float64 values[])
{
    (void)which, (void)n, (void)values;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)which, (void)n, (void)counters, (void)resolutions;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Float64 values[])
{
    (void)which, (void)n, (void)values;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)which, (void)n, (void)counters, (void)resolutions;
    return absent(c, "this FMU has no clocks");
}

FMI3_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference which[], size_t n, const fmi3Int32 orders[], fmi3Float64 values[], size_t count)
{
    (void)which, (void)n, (void)orders, (void)values, (void)count;
    return absent(c, "the rates of states are variables of this FMU");
}

FMI3_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return absent(c, "this FMU has Co-Simulation and Model Exchange");
}
