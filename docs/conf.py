"""Sphinx builds the documentation from this file: strictly, nothing from elsewhere."""

import gc
import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

# Pages are millions of objects that stay: looking among them for garbage took a
# third of the time.
gc.set_threshold(20_000, 20, 20)

project = "stickslip"
author = "The stickslip contributors"
copyright = "2026, The stickslip contributors"
release = metadata.version("stickslip")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "mathml",
    "commands",
    "executed",
    "notebooks",
    "api_pages",
    "moved",
]
exclude_patterns = ["_build"]

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
myst_update_mathjax = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say type, unit and shape
napoleon_google_docstring = False
napoleon_use_rtype = False

copybutton_selector = (
    "div:not(.output) > div.highlight pre"  # what is typed, not what is answered
)
copybutton_prompt_text = r"\$ |>>> |\.\.\. "
copybutton_prompt_is_regexp = True

html_theme = "furo"
html_title = f"stickslip {release}"
html_static_path = ["_static"]
html_css_files = ["style.css"]
html_js_files = ["reach.js"]
html_math_renderer = "mathml"
html_show_sphinx = False
html_copy_source = False
