"""Draw the pictures of docs/explorer.md, as Chromium shows them: the page on the paper's Figure 23, wide and on a phone; a chain's page.

python examples/explorer_picture.py [FOLDER]
"""

import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

import stickslip as ss

HERE = Path(__file__).resolve().parents[1]
SHOWN = "law=lugre&also=coulomb&mu0=0.04&amplitude=6e-4&vary=mu0&map=motion_type,amplitude,mu0"
#: File name -> width and height [px], colours, and the control that is in sight.
PICTURES = {
    "explorer.png": ((1280, 1440), "light", None),
    "explorer-phone.png": ((380, 800), "dark", "input[name=sigma1]"),
}


def drawn(browser, address: str, target: Path) -> None:
    (width, height), colours, control = PICTURES[target.name]
    page = browser.new_page(viewport={"width": width, "height": height}, reduced_motion="reduce", color_scheme=colours)
    page.goto(f"{address}#{SHOWN}")
    page.locator("html[data-drawn$='fine']").wait_for(state="attached", timeout=300_000)
    page.locator("#map-legend", has_text="type").wait_for(timeout=300_000)
    page.locator("#strip[aria-label*='from']").wait_for(timeout=300_000)
    page.locator("#step").click()
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    if control:
        page.locator(control).focus()
    page.wait_for_timeout(500)
    page.screenshot(path=target)
    page.close()
    print(target)


def drawn_machine(browser, address: str, target: Path) -> None:
    """The page of a machine, a while after the start of its motion period."""
    page = browser.new_page(viewport={"width": 1280, "height": 1000}, reduced_motion="reduce", color_scheme="light")
    page.goto(address)
    page.locator("html[data-drawn$='fine']").wait_for(state="attached", timeout=300_000)
    page.locator("#moving input").fill("130")
    page.evaluate("document.activeElement.blur()")
    page.screenshot(path=target)
    page.close()
    print(target)


def three_modules() -> ss.Chain:
    """Driven a third of a period apart."""
    module = ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude=6e-4, omega=65.4 * np.pi), ss.Coulomb(mu_plus=0.15, mu_minus=0.21))
    return ss.Chain((module,) * 3, link=ss.Spring(1200.0, 0.4), phases=(0.0, 2 * np.pi / 3, 4 * np.pi / 3))


@contextlib.contextmanager
def served(*words: str) -> Iterator[str]:
    """The address of an explorer."""
    command = [sys.executable, "-m", "stickslip", "explore", "--port", "0", "--no-browser", *words]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield server.stdout.readline().strip()
    finally:
        server.terminate()
        server.wait()


def main(folder: Path) -> None:
    with sync_playwright() as p, tempfile.TemporaryDirectory() as place:
        path = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium")
        browser = p.chromium.launch(executable_path=path, args=["--no-sandbox"])
        chain = Path(place) / "three modules.toml"
        chain.write_text(three_modules().to_toml(), encoding="utf-8")
        with contextlib.chdir(place), served(chain.name) as address:
            drawn_machine(browser, address, folder / "explorer-machine.png")
        with served() as address:
            for name in PICTURES:
                drawn(browser, address, folder / name)
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "docs" / "images")
