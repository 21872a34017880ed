"""Polynomials of any degree, whose coefficients stand in an array from a place on, STRIDE apart: values, slopes and zeros in [0, 1]."""
# ruff: noqa: F821
# mypy: ignore-errors

LOOKS = 4  # stretches of [0, 1] at whose ends a polynomial is looked at
NOISE = -4e-15  # of the sum of its terms: a polynomial this close to zero is not below it
BEGUN = 1e-3  # what touches zero before has begun there
NEWTON = 60  # iterations at most; a handful is usual
HALVES = 40  # of a quarter of a step, in search of the steepest fall in it


@typed(float64(f1, int64, int64, float64))
def value_at(C, at, degree, x):
    """The value at x."""
    value = C[at + degree * STRIDE]
    for m in range(degree - 1, -1, -1):
        value = fma(value, x, C[at + m * STRIDE])
    return value


@typed(float64(f1, int64, int64, float64))
def slope_at(C, at, degree, x):
    """The slope at x."""
    value = degree * C[at + degree * STRIDE]
    for m in range(degree - 1, 0, -1):
        value = fma(value, x, m * C[at + m * STRIDE])
    return value


@typed(float64(f1, int64, int64, float64))
def curvature_at(C, at, degree, x):
    """The second derivative at x."""
    value = degree * (degree - 1) * C[at + degree * STRIDE]
    for m in range(degree - 1, 1, -1):
        value = fma(value, x, m * (m - 1) * C[at + m * STRIDE])
    return value


@typed(float64(f1, int64, int64, float64, float64))
def zero_between(C, at, degree, lo, hi):
    """The zero between lo (not below zero) and hi (below zero), to the last digit."""
    return zero_from(C, at, degree, lo, hi, 0.5 * (lo + hi), 1e-16)


@typed(float64(f1, int64, int64, float64, float64, float64, float64))
def zero_from(C, at, degree, lo, hi, x, enough):
    """The same by Newton's method from x on, held in the bracket, until a step is `enough` of x, whose square is what is missing."""
    for _ in range(NEWTON):
        value, rate = C[at + degree * STRIDE], degree * C[at + degree * STRIDE]
        for m in range(degree - 1, 0, -1):
            value, rate = fma(value, x, C[at + m * STRIDE]), fma(rate, x, m * C[at + m * STRIDE])
        value = fma(value, x, C[at])
        if value > 0.0:
            lo = x
        else:
            hi = x
        new = x - value / rate if rate != 0.0 else lo
        if not (new >= lo and new <= hi):
            new = 0.5 * (lo + hi)
        if abs(new - x) <= enough * x or new == x:
            return new
        x = new
    return x


@typed(float64(f1, int64, int64, float64, float64, float64, float64))
def turning_point(C, at, degree, lo, hi, d0, d1):
    """Where the slope is zero between lo and hi, where it is d0 and d1, which differ in sign: Newton's method, held in the bracket."""
    x = lo + (hi - lo) * d0 / (d0 - d1)
    for _ in range(NEWTON):
        d, dd = slope_at(C, at, degree, x), curvature_at(C, at, degree, x)
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


@typed(float64(f1, int64, int64, float64))
def steepest_fall(C, at, degree, hi):
    """Where the slope is least between 0, where the curvature is negative, and hi, where it is positive: by halves."""
    lo = 0.0
    for _ in range(HALVES):
        x = 0.5 * (lo + hi)
        if curvature_at(C, at, degree, x) < 0.0:
            lo = x
        else:
            hi = x
    return lo


@typed(float64(f1, int64, int64, float64))
def first_below(C, at, degree, noise):
    """Where one that does not begin below `noise` first falls below zero in [0, 1]; 2 if it does not, 3 if it touches zero meanwhile."""
    none, a, da = 2.0, 0.0, C[at + STRIDE]
    for j in range(LOOKS):
        b = (j + 1.0) / LOOKS
        db = slope_at(C, at, degree, b)
        if j == 0 and da > 0.0 and db > 0.0 and C[at] == 0.0 and C[at + 2 * STRIDE] < 0.0 and curvature_at(C, at, degree, b) > 0.0:
            a = steepest_fall(C, at, degree, b)  # what has just risen from zero may fall and rise again before the first look
            da = slope_at(C, at, degree, a)
            if value_at(C, at, degree, a) < noise:
                return zero_between(C, at, degree, 0.0, a)
        if da < 0.0 and db > 0.0:
            low = turning_point(C, at, degree, a, b, da, db)
            bottom = value_at(C, at, degree, low)
            if bottom < noise:
                return zero_between(C, at, degree, a, low)
            if bottom < -noise and low > BEGUN:
                none = 3.0
        if value_at(C, at, degree, b) < noise:
            return zero_between(C, at, degree, a, b)
        a, da = b, db
    return none
