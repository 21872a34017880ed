# What is noted of some periods of the mode machine: text that follows coulomb_harmonic.py in one kernel, never imported.
# ruff: noqa: F821
# mypy: ignore-errors
"""Segments, margin of the forces, extremes of the velocity."""

SEGS = 32  # segments kept


@typed(float64(f1, f1, float64))
def force_margin(q, row, sine):
    """Relative distance of the force offered at this sin(tau) from break-away."""
    offered = sine + q[GAMMA]
    margin = math.inf
    for side in range(2):
        distance = abs(offered / (row[2] + q[GAMMA] if side == 0 else q[GAMMA] - row[3]) - 1.0)
        if distance < margin:  # not a number where nothing is offered and nothing borne
            margin = distance
    return margin


@typed(int64(f1, f1, f1, float64, int64, f1, b1, f1))
def observe(q, row, last, w, periods, seg_time, seg_code, out):
    """Run some periods again; note segments, margin of the forces, extremes of w, displacement.

    Returns the number of segments, -1 if there are too many.
    """
    n, before, margin, top, bottom, x = 0, 9, math.inf, w, w, 0.0
    for _ in range(periods):
        phase, s, c = 0.0, 0.0, 1.0
        for _ in range(STEPS):
            start, v, s0, c0 = phase, w, s, c
            phase, w, s, c, moved, mode = arc(q, last, phase, w, s, c)
            x += moved
            if mode * before == -1 and v == 0.0:
                margin = min(margin, force_margin(q, row, s0))
            if mode == 0:
                for k in range(2):
                    extreme = (0.5 + k) * math.pi
                    if start < extreme and extreme < phase:
                        margin = min(margin, force_margin(q, row, 1.0 - 2.0 * k))
            else:
                base, sign = 0 if mode > 0 else BACK, 1.0 if mode > 0 else -1.0
                turn = q[base + 4] if q[base + 5] > 0.0 else q[base + 1]
                if start < turn and turn < phase:
                    v = v + sign * (sign * c0 + q[base + 7] - q[base] * (turn - start))
                top, bottom = max(top, max(v, w)), min(bottom, min(v, w))
            if n > 0 and seg_code[n - 1] == 2 * mode:
                seg_time[n - 1] += (phase - start) / TAU
            elif n == SEGS or n < 0:
                n = -1  # too many to keep
            elif phase > start:
                seg_time[n], seg_code[n] = (phase - start) / TAU, 2 * mode
                n += 1
            before = mode
            if phase >= TAU:
                break
    out[0], out[2], out[3], out[4] = x, top, bottom, margin
    return n
