"""The pictures of the docs' page on reports, from a real browser. Run: python examples/report_picture.py"""

import os
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

import stickslip as ss
from stickslip.maths import pi, sin
from stickslip.show.reports import run_page, study_page, write

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
TARGET, MACHINE = IMAGES / "report.png", IMAGES / "report-machine.png"
CHROMIUM = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")


@dataclass(frozen=True, eq=False)
class Capsule(ss.Machine):
    """A hammer on a spring that hits the wall of its capsule."""

    omega: float = 100.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        def push(sign):
            return lambda t, x, v: sign * 0.8 * sin(self.omega * t)

        return {"capsule": ss.Body(0.1, force=push(-1.0)), "hammer": ss.Body(0.05, force=push(1.0))}

    def contacts(self):
        return {"capsule": ss.Contact("capsule", ss.Coulomb(0.2, 0.3), load=1.5)}

    def links(self):
        return {("hammer", "capsule"): ss.Spring(300.0, damping=0.05)}

    def stops(self):
        return {("hammer", "capsule"): ss.Stop(gap=0.002, stiffness=2e4, damping=1.0)}


def machine(browser, folder: Path) -> None:
    """The part of a machine's report that moves."""
    path = write(folder / "capsule.html", run_page(ss.solve(Capsule(), periods=200), "A capsule"))
    page = browser.new_page(viewport={"width": 1100, "height": 740}, color_scheme="light")
    page.goto(path.as_uri())
    page.evaluate("scrollTo(0, document.getElementById('live').getBoundingClientRect().top)")
    page.locator("#moving input").fill("170")
    page.screenshot(path=MACHINE)
    print(MACHINE)


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
        machine(browser, Path(folder))
        browser.close()
    print(TARGET)


if __name__ == "__main__":
    main()
