"""A Rosenbrock step, slow and obvious, for any kind of number: the twin of the emitted one."""

from __future__ import annotations


def rosenbrock_step(f, jacobian, by_time, t, y, h, tableau, mp):
    """One step (Hairer and Wanner, section IV.7). Returns the new state, the dense output at its middle, and the error estimate."""
    n, s = len(y), tableau.stages
    number = lambda x: mp.mpf(x)  # noqa: E731
    J, ft = jacobian(t, y), by_time(t, y)
    W = mp.matrix(n, n)
    for i in range(n):
        for j in range(n):
            W[i, j] = (1 / (h * number(tableau.gamma)) if i == j else 0) - J[i][j]
    u = []
    for q in range(s):
        w = [y[i] + sum(number(tableau.a[q][j]) * u[j][i] for j in range(q)) for i in range(n)]
        slope = f(t + number(tableau.c[q]) * h, w)
        right = [
            slope[i] + sum(number(tableau.C[q][j]) * u[j][i] for j in range(q)) / h + h * number(tableau.d[q]) * ft[i] for i in range(n)
        ]
        u.append(list(mp.lu_solve(W, mp.matrix(right))))
    new = [w[i] + u[-1][i] for i in range(n)]
    return new, dense(y, new, u, tableau, number("0.5"), number), u[-1]


def dense(y, new, u, tableau, theta, number):
    """The continuous extension at theta."""
    values = []
    for i in range(len(y)):
        k = [sum(number(row[j]) * u[j][i] for j in range(len(u))) for row in tableau.dense]
        inner = k[-1]
        for m in reversed(k[:-1]):
            inner = m + theta * inner
        values.append((1 - theta) * y[i] + theta * (new[i] + (1 - theta) * inner))
    return values
