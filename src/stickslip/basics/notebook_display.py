"""Results in a notebook: title, numbers rounded to their significant digits, remarks and figure."""

from __future__ import annotations

import base64
import contextlib
import html
import io
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

from stickslip.basics.errors import StickslipError
from stickslip.basics.presenting import presenter

NOT_DETERMINED = "not determined"
_INCHES, _SHOWN = (4.4, 2.2), 96  # size of figures, and screen pixels per inch


def rounded(value: float, error: float) -> str:
    """A value rounded to two significant digits of its standard error, or to two of its own if it is below a hundredth of the error.

    Examples
    --------
    >>> rounded(0.1797921, 0.00112), rounded(7961.23, 7.2), rounded(0.05, float("inf")), rounded(1.5, 7.7e3)
    ('0.1798', '7961.2', '0.05', '1.5')
    """
    if not (math.isfinite(value) and math.isfinite(error) and error > 0):
        return f"{value:.6g}"
    if abs(value) < error / 100:
        return f"{value:.2g}"
    places = 1 - math.floor(math.log10(error))
    text = f"{value:.{places}f}" if 0 <= places <= 6 else f"{value:.{max(math.floor(math.log10(max(abs(value), error))) + places, 0)}e}"
    return f"{round(value, places):.0f}" if places < 0 and abs(value) < 1e6 else text


_ROUNDING = 1e-14  # a value whose error is smaller, and which is smaller itself, is zero


def with_error(value: float, error: float) -> str:
    """A value with its standard error, to the digits that this leaves, and to six at most.

    Examples
    --------
    >>> with_error(0.188061, 0.047), with_error(-13960.4, 103.0), with_error(-0.46644712, 1e-14)
    ('0.188 ± 0.05', '-13960 ± 1e+02', '-0.466447 ± 1e-14')
    >>> with_error(-1.95e-16, 0.0)
    '0 ± 0'
    """
    if error < _ROUNDING and abs(value) < _ROUNDING:
        value = 0.0
    text = f"{value:.6g}" if error < 1e-6 * abs(value) else rounded(value, error)
    return f"{text} ± {error:.1g}"


def sure(error: float, digits: str = ".2g") -> str:
    """A standard error as printed after its value.

    Examples
    --------
    >>> sure(0.00112), sure(float("inf"))
    ('± 0.0011', 'not determined')
    """
    return f"± {error:{digits}}" if math.isfinite(error) else NOT_DETERMINED


class Text(str):
    r"""Text of several lines that a notebook cell displays as it is, not with escaped line breaks.

    Examples
    --------
    >>> Text("two\nlines")
    two
    lines
    """

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self)}</pre>"


class Face:
    """A result displayed in a notebook: its title, its `_facts`, its tables, its notes, and a figure if it has one."""

    def _title(self) -> str:
        return type(self).__name__

    def _facts(self) -> Mapping[str, Any]:
        """Facts in two columns."""
        return {}

    def _tables(self) -> Sequence[Sequence[Sequence[str]]]:
        """Tables, each as rows of text with the heading first."""
        return ()

    def _remarks(self) -> Sequence[str]:
        return tuple(getattr(self, "notes", ()) or ())

    def _figures(self) -> list[Any]:
        """Matplotlib figures made without pyplot, whose figures a notebook would show a second time."""
        return []

    def _text(self) -> str:
        """The result as plain text: title, facts and tables; the printed form of results whose record is too long to read."""
        facts = "; ".join(f"{name} {value}" for name, value in self._facts().items())
        rows = [", ".join(f"{name} {cell}" for name, cell in zip(head, row, strict=True)) for head, *rest in self._tables() for row in rest]
        return "\n  ".join([f"{self._title()}: {facts}" if facts else self._title(), *rows])

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr>{_cell(name, 'th')}{_cell(value)}</tr>" for name, value in self._facts().items())
        facts = f"<table>{rows}</table>" if rows else ""
        tables = "".join(map(html_table, self._tables()))
        below = "".join(f"<p><small>{html.escape(remark)}</small></p>" for remark in self._remarks())
        return f"<div><p><b>{html.escape(self._title())}</b></p>{facts}{tables}{''.join(map(_image, self._figures()))}{below}</div>"


class Drawn(Face):
    """A result drawn by a function of `stickslip.plot`, which its method `plot` calls."""

    #: Name of the function.
    _drawn_by: ClassVar[str]
    #: Width and height of the figure in a notebook.
    _inches: ClassVar[tuple[float, float]] = _INCHES

    def _drawn(self) -> Any:
        """The arguments of the function."""
        return self

    def plot(self, *args: Any, **options: Any) -> Any:
        """Draw the result, with the arguments of the corresponding function of `stickslip.plot`; returns the axes."""
        return presenter("figure", self._drawn_by)(self._drawn(), *args, **options)

    def _figures(self) -> list[Any]:
        return drawn_on(lambda figure: self.plot(ax=figure.subplots()), self._inches)


def drawn_on(draw: Callable[[Any], Any], inches: tuple[float, float] = _INCHES) -> list[Any]:
    """A list with the Matplotlib figure that `draw` fills; empty if there is too little to draw, such as basins over one coordinate."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=inches, layout="constrained")
    with contextlib.suppress(StickslipError), presenter("figure", "publication")():
        draw(figure)
        return [figure]
    return []


def _image(figure: Any) -> str:
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=2 * _SHOWN, facecolor="white")  # sharp on high-resolution screens
    width = round(figure.get_figwidth() * _SHOWN)
    return f'<img alt="figure" width="{width}" src="data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}">'


def html_table(rows: Sequence[Sequence[str]]) -> str:
    """Rows of text as an HTML table; the first row is the heading."""
    head = "".join(_cell(cell, "th") for cell in rows[0])
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows[1:])
    return f"<table><tr>{head}</tr>{body}</table>"


def _cell(value: Any, kind: str = "td") -> str:
    text = html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))
    return f'<{kind} style="text-align:left">{text}</{kind}>'
