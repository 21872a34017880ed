"""The picture of the docs' page on reports, from a real browser. Run: python examples/report_picture.py"""

import os
import shutil
import tempfile
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

import stickslip as ss
from stickslip.report import study_page, write

TARGET = Path(__file__).resolve().parents[1] / "docs" / "images" / "report.png"
CHROMIUM = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")


def main() -> None:
    """Write the report of a small study, open it, ask the first chart for values."""
    grid = ss.sweep(ss.presets.piezo_rig, law=["coulomb", "lugre"], amplitude=np.linspace(1e-4, 8e-4, 71), tilt_deg=1.7)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as p:
        path = write(Path(folder) / "study.html", study_page(grid, "Two laws on 1.7 degrees", "stickslip report study --out study.html"))
        browser = p.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1100, "height": 640}, color_scheme="light")
        page.goto(path.as_uri())
        page.evaluate("document.querySelector('#figures').scrollIntoView()")
        plot = page.locator(".chart .u-over").first.bounding_box()
        page.mouse.move(plot["x"] + 0.6 * plot["width"], plot["y"] + 0.5 * plot["height"])
        page.wait_for_timeout(300)
        page.screenshot(path=TARGET)
        browser.close()
    print(TARGET)


if __name__ == "__main__":
    main()
