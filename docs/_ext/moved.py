"""Former addresses of pages: a page that leads on, so that links and bookmarks from elsewhere stay good."""

from __future__ import annotations

import html
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

#: Where a page was, and where it is.
MOVED = {
    "coming-from-matlab": "coming-from/matlab",
    "decisions/index": "index",
    "excel": "coming-from/excel",
    "gallery": "gallery/index",
    "style": "index",
    "theory/several-contacts": "theory/index",
    "which-machine": "data-model",
}
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Moved</title><meta http-equiv="refresh" content="0; url={to}"></head>
<body><p>This page is now <a href="{to}">{to}</a>.</p></body></html>
"""


def lead_on(app: Sphinx, error: Exception | None) -> None:
    """Write a page at each former address."""
    if error is not None or app.builder.format != "html":
        return
    for before, now in MOVED.items():
        file = Path(app.outdir) / f"{before}.html"
        if not (Path(app.outdir) / f"{now}.html").exists():
            raise ValueError(f"docs/_ext/moved.py: {before} leads to {now}; allowed is a page that is there")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(_PAGE.format(to=html.escape("../" * before.count("/") + f"{now}.html")), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """When all other pages are written."""
    app.connect("build-finished", lead_on)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
