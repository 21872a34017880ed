"""The work-precision diagram: cost against error, both logarithmic; further left and lower is better."""

from __future__ import annotations

from measure import TARGETS, Curve

# Okabe and Ito's eight colours, told apart with every common colour blindness; marks differ too, for print
COLOURS = ("#000000", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#999933")
MARKS = "osD^vPX*<>hd"


def draw(path: str, rows: list[list[Curve]]) -> None:
    """One panel per problem, one line per solver, to `path` (the suffix says the format)."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    problems = [curve.mu0 for curve in rows[0]]
    figure, axes = plt.subplots(1, len(problems), figsize=(6.2 * len(problems), 6.2), sharey=True, layout="constrained", squeeze=False)
    for column, (axis, mu0) in enumerate(zip(axes[0], problems, strict=True)):
        for number, row in enumerate(rows):
            _line(axis, row[column], number)
        for target in TARGETS:
            axis.axvline(target, color="0.8", lw=1, zorder=0)
        axis.set(xscale="log", yscale="log", xlabel="worst relative error of the mean velocity", title=f"$\\mu_0$ = {mu0:g}")
        axis.invert_xaxis()
        axis.grid(alpha=0.25)
    axes[0][0].set_ylabel("CPU time per drive period and case [µs]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    figure.savefig(path, dpi=150)
    plt.close(figure)


def _line(axis, curve: Curve, number: int) -> None:
    """The front of one solver; ours is heavier."""
    front = [point for point in curve.front() if point.error > 0]
    if not front:
        return
    axis.plot(
        [point.error for point in front],
        [point.microseconds for point in front],
        label=curve.name,
        color=COLOURS[number % len(COLOURS)],
        marker=MARKS[number % len(MARKS)],
        ls="-" if number < len(COLOURS) else "--",
        lw=3 if number == 0 else 1.3,
        ms=7 if number == 0 else 5,
    )
