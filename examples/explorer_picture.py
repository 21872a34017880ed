"""Draw the pictures of docs/explorer.md: the explorer's page on the paper's Figure 23, as Chromium shows it, wide and on a phone.

python examples/explorer_picture.py [FOLDER]
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

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


def main(folder: Path) -> None:
    command = [sys.executable, "-m", "stickslip", "explore", "--port", "0", "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        address = server.stdout.readline().strip()
        with sync_playwright() as p:
            path = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium")
            browser = p.chromium.launch(executable_path=path, args=["--no-sandbox"])
            for name in PICTURES:
                drawn(browser, address, folder / name)
            browser.close()
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "docs" / "images")
