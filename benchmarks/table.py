"""Curves as text and as JSON."""

from __future__ import annotations

import json
import platform
from dataclasses import asdict
from importlib import metadata
from pathlib import Path

from measure import TARGETS, Curve

PACKAGES = ("stickslip", "numpy", "numba", "scipy", "heyoka", "scikit-sundae", "numbalsoda", "diffrax", "jax")
WIDTH = 22


def _number(microseconds: float) -> str:
    digits = 2 if microseconds < 10 else 1 if microseconds < 100 else 0
    return f"{microseconds:.{digits}f}"


def cell(curve: Curve, target: float, ours: Curve | None) -> str:
    """Cost at the target and its ratio to ours, or the best error that was reached."""
    cost = curve.cost(target)
    if cost is None:
        best = curve.front()[-1] if curve.front() else None
        return f"- ({best.error:.0e} at {_number(best.microseconds)})" if best else "- (no number)"
    mine = ours.cost(target) if ours else None
    return _number(cost) if mine is None or curve is ours else f"{_number(cost)} ({_number(cost / mine)}x)"


def _row(curves: list[Curve], ours: list[Curve], targets: tuple[float, ...]) -> str:
    """One solver on all problems."""
    name = f"{curves[0].name:44s}"
    if all(curve.missing for curve in curves):
        return f"{name} {curves[0].missing}"
    cells = []
    for curve, mine in zip(curves, ours, strict=True):
        if curve.missing:
            cells.append(f"{curve.missing:{len(targets) * WIDTH + 7}s}")
            continue
        cells.append(f"{curve.cases:>5d}  " + "".join(f"{cell(curve, t, mine if mine.points else None):{WIDTH}s}" for t in targets))
    return f"{name} " + "".join(cells)


def text(title: str, rows: list[list[Curve]], targets: tuple[float, ...] = TARGETS) -> str:
    """The table; each row is one solver's curves, one per problem; the first row is ours."""
    problems = [curve.mu0 for curve in rows[0]]
    head = "".join(f"{'cases':>5s}  " + "".join(f"{f'mu0 {m:g} at {t:.0e}':{WIDTH}s}" for t in targets) for m in problems)
    lines = [title, f"{'':44s} {head}", *(_row(row, rows[0], targets) for row in rows)]
    lines += [f"  * {curve.name}, mu0 {curve.mu0:g}: {curve.stopped}" for row in rows for curve in row if curve.stopped and curve.points]
    return "\n".join(lines)


def versions() -> dict[str, str]:
    """Installed versions of everything compared, of Python and of the machine."""
    found = {"python": platform.python_version(), "machine": _processor()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def _processor() -> str:
    """The processor's name as the system tells it."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def _plain(curve: Curve) -> dict:
    """A curve as JSON takes it, with the medians."""
    return asdict(curve) | {"points": [asdict(p) | {"microseconds": p.microseconds} for p in curve.points]}


def write_json(path: str, sections: dict[str, list[list[Curve]]], **more) -> None:
    """Everything measured, for comparison with other days and machines."""
    curves = {title: [_plain(curve) for row in rows for curve in row] for title, rows in sections.items()}
    told = {"versions": versions(), "targets": TARGETS, **more, "curves": curves}
    Path(path).write_text(json.dumps(told, indent=1, default=str), encoding="utf-8")
