"""The explorer in numbers: milliseconds from a slider's event to the drawn curve, page weight, requests, what axe finds.

First, with an empty cache, seconds from the command to the first mean velocity on the page, and what the server computed until then.

Beside it, in the same run, a Panel and a Dash page of the same content: a slider for the amplitude, and the velocity of the paper's robot
under LuGre and Coulomb friction from the same solver. They are measured if they are installed (``pip install panel dash``).

    python benchmarks/explorer.py [--json FILE]
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import shutil
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

HERE = Path(__file__).resolve().parent
REPEATS = 30
AXE = HERE.parent / "tests" / "vendor" / "axe.min.js"
#: For each page a function drawn(): the promise of the next drawn curve, and move(value): what a hand does to the slider.
PAGES = {
    "explorer": """
        window.move = v => {
          const el = document.querySelector("input[name=amplitude]");
          el.value = v;
          el.dispatchEvent(new Event("input", {bubbles: true}));
        };
        window.drawn = () => new Promise(done => {
          const root = document.documentElement, seen = new MutationObserver(() => {
            if (!root.dataset.drawn.includes("fine")) { seen.disconnect(); done(); }
          });
          seen.observe(root, {attributeFilter: ["data-drawn"]});
        });""",
    "panel": """
        const models = [...Bokeh.documents[0]._all_models.values()], slider = models.find(m => m.type.endsWith("Slider"));
        const last = models.filter(m => m.type === "ColumnDataSource").at(-1);
        window.move = v => { slider.value = v; };
        window.drawn = () => new Promise(done => {
          const told = () => { last.properties.data.change.disconnect(told); requestAnimationFrame(() => done()); };
          last.properties.data.change.connect(told);
        });""",
    "dash": """
        window.move = v => dash_clientside.set_props("amplitude", {value: v});
        window.drawn = () => new Promise(done => {
          document.querySelector("#velocity .js-plotly-plot").once("plotly_afterplot", () => done());
        });""",
}
READY = {"explorer": "html[data-drawn$='fine']", "panel": ".bk-panel-models-layout-Column", "dash": "#velocity .js-plotly-plot"}
ONE = "async v => { const next = drawn(), t = performance.now(); move(v); await next; return performance.now() - t; }"


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


def server(name: str, port: int) -> subprocess.Popen[Any]:
    if name == "explorer":
        command = [sys.executable, "-m", "stickslip", "explore", "--no-browser", "--no-token", "--port", str(port)]
    else:
        command = [sys.executable, str(HERE / "pages" / f"{name}_page.py"), str(port)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait_for(address: str) -> None:
    for _ in range(300):
        try:
            urllib.request.urlopen(address, timeout=2).close()
            return
        except OSError:
            time.sleep(0.2)
    raise RuntimeError(f"nothing answers at {address}")


def measured(browser: Any, name: str) -> dict[str, Any]:
    """All numbers of one page."""
    port = free_port()
    process = server(name, port)
    try:
        address = f"http://127.0.0.1:{port}/"
        wait_for(address)
        page = browser.new_context(viewport={"width": 1200, "height": 900}, bypass_csp=True, reduced_motion="reduce").new_page()
        weight, requests = [], []
        page.on("requestfinished", lambda r: weight.append(sum(r.sizes()[k] for k in ("responseBodySize", "responseHeadersSize"))))
        page.on("request", lambda r: requests.append(r.url))
        page.goto(address)
        page.locator(READY[name]).first.wait_for(state="attached", timeout=300_000)
        page.wait_for_timeout(5000)
        elsewhere = [url for url in requests if not url.startswith((address, "data:", "blob:"))]
        loaded = {"bytes": sum(weight), "requests": len(requests), "elsewhere": len(elsewhere)}
        page.evaluate(f"() => {{ {PAGES[name]} }}")
        times = []
        for i in range(REPEATS + 5):
            value = 4e-4 + 4e-4 * ((i * 0.381966) % 1)
            times.append(page.evaluate(ONE, value))
            page.wait_for_timeout(60)
        times = sorted(times[5:])  # the first ones warm up
        page.evaluate(AXE.read_text(encoding="utf-8"))
        found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
        page.close()
        behind = maps(port) if name == "explorer" else {}
        return {
            **behind,
            "median_ms": round(statistics.median(times), 1),
            "p90_ms": round(times[int(0.9 * len(times))], 1),
            **loaded,
            "axe_violations": len(found),
            "axe_nodes": sum(len(v["nodes"]) for v in found),
        }
    finally:
        process.terminate()
        process.wait()


def first(browser: Any) -> dict[str, float]:
    """Seconds from the command to its address and to the first mean velocity in a browser that runs, and CPU seconds of the server."""
    with tempfile.TemporaryDirectory() as cache:
        page = browser.new_context(viewport={"width": 1200, "height": 900}).new_page()
        command, begin = [sys.executable, "-m", "stickslip", "explore", "--no-browser", "--port", "0"], time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env={**os.environ, "STICKSLIP_CACHE_DIR": cache})
        assert process.stdout is not None
        try:
            address = process.stdout.readline().strip()
            listens = time.perf_counter() - begin
            page.goto(address, wait_until="commit")
            page.locator("output[data-quantity=mean_velocity]", has_text="m/s").wait_for()
            seconds = time.perf_counter() - begin
            spent = sum(map(int, Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[11:13])) / os.sysconf(
                "SC_CLK_TCK"
            )
            return {"address_s": round(listens, 2), "first_velocity_s": round(seconds, 2), "server_cpu_s": round(spent, 2)}
        finally:
            process.terminate()
            process.wait()


def maps(port: int) -> dict[str, float]:
    """Milliseconds from the question to the answer of a map of 48 x 40 robots, each time of other robots."""
    from websockets.sync.client import connect

    from stickslip.show.explorer.frames import unpacked

    axes = [{"name": "amplitude", "from": 0.0, "to": 1.6e-3, "cells": 48}, {"name": "tilt_deg", "from": -8.0, "to": 8.0, "cells": 40}]
    found = {}
    with connect(f"ws://127.0.0.1:{port}/socket", max_size=None, compression=None) as socket:
        for law in ("lugre", "coulomb"):
            times = []
            for i in range(REPEATS // 2 + 2):
                state = {"law": law, "values": {"mu0": 0.17 + 0.001 * i}}
                begin = time.perf_counter()
                socket.send(json.dumps({"channel": "map", "id": i, "state": state, "axes": axes}))
                while unpacked(socket.recv(timeout=300))[0]["kind"] != "map":  # it waits for its kernel
                    pass
                times.append(1e3 * (time.perf_counter() - begin))
            found[f"map_{law}_ms"] = round(statistics.median(times[2:]), 1)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write the numbers there as well")
    asked = parser.parse_args()
    path = os.environ.get("STICKSLIP_CHROMIUM") or shutil.which("chromium")
    results = {}
    with sync_playwright() as p:
        browser = p.chromium.launch(executable_path=path, args=["--no-sandbox"])
        results["first"] = first(browser)
        print(f"{'first':10s}", json.dumps(results["first"]), flush=True)
        for name in PAGES:
            if name != "explorer" and importlib.util.find_spec(name) is None:
                print(f"{name}: not installed; type pip install {name}", file=sys.stderr)
                continue
            results[name] = measured(browser, name)
            print(f"{name:10s}", json.dumps(results[name]), flush=True)
        browser.close()
    if asked.json:
        asked.json.write_text(json.dumps({"load_average": os.getloadavg(), "repeats": REPEATS, "pages": results}, indent=1) + "\n")


if __name__ == "__main__":
    main()
