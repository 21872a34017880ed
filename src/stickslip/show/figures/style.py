"""The style of our figures: one column wide, colours for any colour vision, axes with SI prefixes."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import ArrayLike
from stickslip.basics.quantities import LINES, SUBSCRIPTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


P = ParamSpec("P")
T = TypeVar("T")
#: Colours of Okabe and Ito (2008), dark ones first: distinguishable with any colour vision, and in grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
#: Dash patterns that accompany the colours, so that a figure can be printed without colour.
DASHES = ("-", (0, (5, 1.6)), (0, (1, 1.1)), (0, (5, 1.2, 1, 1.2)), "-", "-", "-")
INK, SHADE = "#333333", "#DFE3E8"
#: Colour and marker of what has not settled.
UNSETTLED, UNSETTLED_MARK = "#8A8A8A", "x"
#: Width of a journal column [inch].
WIDTH = 3.5

#: The figures by their names: functions under `drawing`.
FIGURES: dict[str, Callable[..., Any]] = {}
_SETTINGS = Path(__file__).with_name("publication.mplstyle")


@contextlib.contextmanager
def publication() -> Iterator[None]:
    """Context manager for figures in the style of this package; the previous settings are restored afterwards.

    Examples
    --------
    >>> import matplotlib
    >>> before = matplotlib.rcParams["font.size"]
    >>> with publication():
    ...     inside = matplotlib.rcParams["font.size"]
    >>> float(inside), matplotlib.rcParams["font.size"] == before
    (8.0, True)
    """
    import matplotlib as mpl

    settings = mpl.rc_params_from_file(_SETTINGS, use_default_template=False)
    before = {name: mpl.rcParams[name] for name in settings}
    mpl.rcParams.update(settings)
    try:
        yield
    finally:  # only these settings: loading a back end for a notebook's first figure turns `interactive` on, and it must stay on
        mpl.rcParams.update(before)


def drawing(function: Callable[P, T]) -> Callable[P, T]:
    """Make a function a figure: it uses the style of this package, and its errors name arguments of a wrong kind."""
    FIGURES[function.__name__] = drawn = publication()(explains_arguments(function))
    return drawn


def axes(ax: Any = None, height: float = 2.1) -> Any:
    """The given axes, or those of a new figure of one column's width."""
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots(figsize=(WIDTH, height))[1]


def dot_size(count: int) -> float:
    """Diameter of a diagram's dots [point] for a number of values across a column's width: small if there are many.

    Examples
    --------
    >>> dot_size(21), dot_size(100), dot_size(600)
    (3.0, 1.8, 1.2)
    """
    return float(np.clip(180.0 / max(count, 1), 1.2, 3.0))


def name_rows(ax: Any, names: Sequence[str], room: float = 0.0) -> None:
    """Row names at the left, without ticks; `room` is the margin below the first and above the last row, in rows."""
    ax.set_yticks(range(len(names)), names)
    if room:
        ax.set_ylim(-room, len(names) - 1 + room)
    ax.tick_params(axis="y", length=0)


def legend_above(ax: Axes, *entries: Any, **options: Any) -> None:
    """A legend above the frame, right-aligned; entries and options as for ``ax.legend``."""
    ax.legend(*entries, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, **options)


_SYMBOL = re.compile(rf"(?<!\S)([A-Za-zΑ-ωℓ])(?:_([0-9a-z,]+)|_?([0-9a-z+-]|[{SUBSCRIPTS}]*))$")


def symbols(text: str) -> str:
    """A name with the symbol at its end typeset for an axis: in italics, with its index.

    Examples
    --------
    >>> symbols("Stribeck velocity vₛ"), symbols("tilt of the track θ"), symbols("rise")
    ('Stribeck velocity $v_{s}$', 'tilt of the track $θ$', 'rise')
    """

    def typeset(match: re.Match[str]) -> str:
        letter, long, short = match.groups()
        index = (long or short or "").translate(LINES)
        return f"${letter}_{{{index.replace('-', '{-}')}}}$" if index else f"${letter}$"

    return _SYMBOL.sub(typeset, text)


def prefix(*arrays: Any) -> tuple[float, str]:
    """The SI prefix in which the largest of the numbers lies between 1 and 1000, as (factor, prefix).

    Examples
    --------
    >>> prefix([0.0, -3.2e-3])
    (1000.0, 'm')
    >>> prefix([0.0])
    (1.0, '')
    """
    largest = max((float(np.max(np.abs(a), initial=0.0)) for a in arrays), default=0.0)
    if not 0 < largest < np.inf:
        return 1.0, ""
    return _with_power(np.floor(np.log10(largest) / 3 + 1e-9))


def _with_power(power: float) -> tuple[float, str]:
    """The SI prefix of a power of a thousand, as (factor, prefix)."""
    n = int(np.clip(power, -5, 4))
    return (1000.0**-n if n else 1.0), "fpnµm kMGT"[n + 5].strip()


def axis_label(text: str, unit: str, factor_prefix: str = "") -> str:
    """An axis label with its symbol and unit, if it has one."""
    text = symbols(text)
    return text if unit in ("", "1") and not factor_prefix else f"{text} ({factor_prefix}{unit})"


#: Units that take no SI prefix on an axis: a number without one, and angles, which are read in rad.
_AS_THEY_ARE = ("", "1", "degrees", "rad", "rad/s", "rad/s^2", "rad/s²")


def scaled(values: ArrayLike, unit: str) -> tuple[float, str]:
    """The scale factor and SI prefix of an axis with a unit; angles, their rates and numbers without a unit are not scaled.

    Examples
    --------
    >>> scaled([0.002], "m/s"), scaled([0.2, 0.6], "rad/s")
    ((1000.0, 'm'), (1.0, ''))
    """
    return (1.0, "") if unit in _AS_THEY_ARE else prefix(values)


def labelled(column: Any, factor_prefix: str = "") -> str:
    """An axis label from the name and the unit of a dataset column."""
    return axis_label(column.attrs["long_name"], column.attrs["units"], factor_prefix)


def side_of(column: Any) -> tuple[float, str]:
    """Scale factor and axis label of a dataset column."""
    factor, letter = scaled(column.values[np.isfinite(column.values)], column.attrs["units"])
    return factor, labelled(column, letter)


def in_their_units(curves: Sequence[ArrayLike], units: Sequence[str]) -> tuple[list[float], list[str]]:
    """Of each curve its scale factor, and its unit with the prefix: all curves of one unit have one prefix.

    Beside angles, which have none, lengths have the prefix that makes their curves most nearly as large.

    Examples
    --------
    >>> in_their_units([[0.002], [0.004]], ["m/s", "m/s"])
    ([1000.0, 1000.0], ['mm/s', 'mm/s'])
    >>> in_their_units([[0.002], [1.5]], ["m/s", "rad/s"]), in_their_units([[0.2], [1.5]], ["m/s", "rad/s"])
    (([1000.0, 1.0], ['mm/s', 'rad/s']), ([1.0, 1.0], ['m/s', 'rad/s']))
    """
    sizes = {unit: _largest(c for c, own in zip(curves, units, strict=True) if own == unit) for unit in units}
    beside = max((size for unit, size in sizes.items() if unit in _AS_THEY_ARE), default=0.0)
    of = {}
    for unit, size in sizes.items():
        near = unit not in _AS_THEY_ARE and 0 < size < np.inf and 0 < beside < np.inf
        of[unit] = _with_power(np.round(np.log10(size / beside) / 3)) if near else scaled([size], unit)
    return [of[unit][0] for unit in units], [of[unit][1] + unit for unit in units]


def _largest(curves: Iterable[ArrayLike]) -> float:
    return max(float(np.max(np.abs(np.asarray(c, float)), initial=0.0)) for c in curves)


def shared_unit(label: str, shown: Sequence[str]) -> str:
    """An axis label with the unit of its curves, if they have one; otherwise without, as their names say it.

    Examples
    --------
    >>> shared_unit("velocity $v$", ["mm/s", "mm/s"]), shared_unit("velocity $v$", ["mm/s", "rad/s"])
    ('velocity $v$ (mm/s)', 'velocity $v$')
    """
    units = set(shown)
    return f"{label} ({units.pop()})" if len(units) == 1 and "" not in units else label
