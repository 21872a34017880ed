"""One self-contained HTML page from a template: style and figures are embedded, without external addresses."""

from __future__ import annotations

import base64
import re
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, as_path
from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.show.reports.mathml import mathml


def svg_address(svg: str) -> str:
    """An SVG picture as a data address for an ``img`` element.

    Examples
    --------
    >>> svg_address("<svg/>")
    'data:image/svg+xml;base64,PHN2Zy8+'
    """
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode()


_SIZE = re.compile(r'<svg\b[^>]*?\bviewBox="\S+ \S+ (?P<width>\S+) (?P<height>\S+)"')


def image(svg: str, alt: str) -> Any:
    """An SVG picture as an ``img`` element with its own size, so that a page does not move when its pictures appear.

    Examples
    --------
    >>> print(image('<svg viewBox="0 0 302.4 158.4"/>', "a curve"))
    <img src="data:image/svg+xml;base64,PHN2ZyB2aWV3Qm94PSIwIDAgMzAyLjQgMTU4LjQiLz4=" alt="a curve" width="302" height="158">
    """
    from markupsafe import Markup, escape

    size = _SIZE.search(svg)
    if size is None:
        raise InputError("image", ["the picture has no viewBox; give an SVG picture with its size"])
    width, height = (round(float(size[name])) for name in ("width", "height"))
    return Markup(f'<img src="{svg_address(svg)}" alt="{escape(alt)}" width="{width}" height="{height}">')


def grouped(number: int) -> str:
    """A whole number with its digits grouped in thousands by narrow no-break spaces."""
    return f"{number:,}".replace(",", "\u202f")


def fixed(number: float, digits: int) -> str:
    """A number with a fixed number of decimals and a true minus sign."""
    return f"{number:.{digits}f}".replace("-", "−")


def _formula(tex: str) -> Any:
    """A displayed formula for a page."""
    from markupsafe import Markup

    return Markup(mathml(tex, as_block=True))


def environment(folder: str | Path) -> Any:
    """The template environment of a folder."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    made = Environment(loader=FileSystemLoader(folder), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    made.filters |= {"svg_address": svg_address, "image": image, "grouped": grouped, "fixed": fixed, "formula": _formula}
    return made


def page(template: str, **content: Any) -> str:
    """The text of a page; values in `content` are escaped where the template inserts them.

    Parameters
    ----------
    template : str
        Name of a file in ``reports/templates``.
    **content
        The values for the template.

    Returns
    -------
    str
    """
    text = environment(Path(__file__).parent / "templates").get_template(template).render(**content)
    outside = outside_addresses(text)
    if outside:
        raise InputError("page", [f"the page would need {outside[0]!r} from outside; put it into the page"])
    return text


def outside_addresses(text: str) -> list[str]:
    """External addresses that the page would load or link to.

    Examples
    --------
    >>> outside_addresses('<img src="data:,"><a href="#top">up</a>'), outside_addresses('<img src="https://a.example/b.png">')
    ([], ['https://a.example/b.png'])
    """
    addresses = re.findall(r"""(?:src|href|srcset|action|poster)\s*=\s*["']([^"']*)["']""", text) + re.findall(
        r"url\(\s*[\"']?([^)\"']*)", text
    )
    return [address for address in addresses if not address.startswith(("#", "data:"))]


def write(path: str | Path, text: str) -> Path:
    """Write a page; returns its path. An existing file is replaced in a single step at the end."""
    return write_whole(as_path(path, "report", "report.html"), text, unwritable("report"))
