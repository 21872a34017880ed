"""Draw the picture of docs/notebooks.md, as Chromium shows it: the widget of the paper's robot.

python examples/widget_picture.py [FOLDER]
"""

import json
import os
import shutil
import sys
from importlib import resources
from pathlib import Path

from playwright.sync_api import sync_playwright

import stickslip as ss

HERE = Path(__file__).resolve().parents[1]
#: What a notebook gives to the page part: the traits of the widget, and a callback for each change. Nothing is moved here.
PAGE = """<!doctype html><meta charset="utf-8"><style>%s</style><div id="here"></div><script type="module">
const told = %s;
const model = {get: (name) => told[name], set: () => {}, save_changes: () => {}, on: () => {}, off: () => {}};
const widget = (await import(URL.createObjectURL(new Blob([%s], {type: "text/javascript"})))).default;
widget.render({model, el: document.getElementById("here")});
document.documentElement.dataset.drawn = "yes";
</script>"""


def page_of(robot: ss.Robot) -> str:
    """The page that shows the widget of a robot."""
    assets, widget = resources.files("stickslip.show.explorer").joinpath("assets"), ss.widget(robot)
    script, style = (assets.joinpath(f"widget.{ending}").read_text(encoding="utf-8") for ending in ("js", "css"))
    told, script = (json.dumps(of).replace("<", "\\u003c") for of in (_traits(widget), script))
    return PAGE % (style, told, script)


def _traits(widget: object) -> dict[str, object]:
    return {name: getattr(widget, name) for name in ("title", "sliders", "state", "answer")}


def main(folder: Path) -> None:
    target = folder / "widget.png"
    with sync_playwright() as p:
        path = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium")
        browser = p.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1000, "height": 700}, reduced_motion="reduce", color_scheme="light")
        page.set_content(page_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude="0.556 mm", law="coulomb")))
        page.locator("html[data-drawn=yes]").wait_for(state="attached", timeout=60_000)
        page.screenshot(path=target, full_page=True)
        browser.close()
    print(target)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "docs" / "images")
