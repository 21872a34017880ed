"""Draw docs/images/explorer.png: the explorer's page on the paper's Figure 23, as Chromium shows it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

HERE = Path(__file__).resolve().parents[1]
SHOWN = "law=lugre&also=coulomb&mu0=0.04&amplitude=6e-4&vary=mu0&map=motion_type,amplitude,mu0"


def main(target: Path) -> None:
    command = [sys.executable, "-m", "stickslip", "explore", "--port", "0", "--no-browser"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        address = server.stdout.readline().strip()
        with sync_playwright() as p:
            path = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium")
            browser = p.chromium.launch(executable_path=path, args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 1300}, reduced_motion="reduce", color_scheme="light")
            page.goto(f"{address}#{SHOWN}")
            page.locator("html[data-drawn$='fine']").wait_for(state="attached", timeout=300_000)
            page.locator("#map-legend", has_text="type").wait_for(timeout=300_000)
            page.locator("#strip[aria-label*='from']").wait_for(timeout=300_000)
            page.locator("#step").click()
            page.evaluate("document.activeElement.blur()")
            page.wait_for_timeout(500)
            page.screenshot(path=target)
            browser.close()
    finally:
        server.terminate()
        server.wait()
    print(target)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "docs" / "images" / "explorer.png")
