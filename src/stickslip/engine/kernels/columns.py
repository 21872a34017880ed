"""Columns of the arrays that lanes share; text before all others of the driver."""
# mypy: ignore-errors

# columns of N (lane): case (-1 idle), periods done, recording, last period to do, period number, fresh point, closing, status, steps
# accepted and rejected until the last look at the progress, whether the present period is one of the window once more, whether changes of
# modes are counted, and of each contact how many segments there are
CASE, DONE, RECORDING, TARGET, NUMBER, FRESH, CLOSING, STATUS, ACCEPTED, REJECTED, AGAIN, COUNTING, SEGMENTS = range(13)
# columns of K (lane): the last two observed points (of the first when, whether it slips, and which way), window, work of friction while
# recording and how long, displacement approached; part of the last step after which slip begins or ends;
# periods done at the last look at the progress, with the part of the present one
TQ, RQ, BQ, TP, VP, BP, VMAX, VMIN, DISPLACEMENT, WINDOW, WORK, LASTED, LIMIT, PART, SINCE = range(15)
# JOB: the next case, the end of cases, pieces written; then what to do with every case, and whether each period must be made
NEXT, END, WRITTEN, PERIODS, SETTLE, AUTO, WHOLE = range(7)
# LIMITS: tolerance, slip ratio from which on a contact slips, steps of a case
RTOL, SLIP_RATIO, BUDGET_OF_STEPS = range(3)
SEGS = 32
# of a strobe point, behind x, the states and the memories of the law: what else a lane takes to the next period
BESIDE = 8

# FOUND[lane] has for each signal an integral or a count, the largest and the smallest value (reducing.py), and after the signals for
# each body the extremes of its velocity over the window.
TOTAL, LARGEST, SMALLEST = range(3)
MEAN, MOST, LEAST, COUNTED, LAST, AT_GUARD = 1, 2, 4, 8, 16, 64
