"""A running explorer for tests: the command itself, in a process of its own, and a client that speaks as the page does."""

import contextlib
import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.sync.client import connect

from stickslip.show.explorer.frames import unpacked

#: Seconds that a first kernel may take to compile on a slow machine.
PATIENCE = 240


class Explorer:
    """The command `stickslip explore`, and where it serves."""

    def __init__(self, *options):
        command = [sys.executable, "-W", "error", "-m", "stickslip", "explore", "--port", "0", "--no-browser", *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            raise RuntimeError(self.process.communicate()[1])
        self.port = urlsplit(self.address).port
        self.token = urlsplit(self.address).query.partition("=")[2]
        self.cookie = f"stickslip_token_{self.port}={self.token}"

    def close(self):
        self.process.terminate()
        self.process.communicate(timeout=30)

    def ask(self, path="/", method="GET", **headers):
        """Status, headers and body of a request, with exactly these headers and the token's cookie."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        host = headers.pop("Host", f"127.0.0.1:{self.port}")
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, value in {"Host": host, "Cookie": self.cookie, **headers}.items():
            connection.putheader(name, value)
        connection.endheaders()
        with contextlib.closing(connection):
            reply = connection.getresponse()
            return reply.status, dict(reply.getheaders()), reply.read()

    def page(self, **headers):
        """A socket as a page opens it."""
        told, address = {"Cookie": self.cookie, **headers}, f"ws://127.0.0.1:{self.port}/socket"
        return connect(address, additional_headers=told, max_size=None, compression=None, open_timeout=60)

    def memory(self):
        """Resident memory of the server [bytes]."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")


@contextlib.contextmanager
def kernels_wait(explorer):
    """Nothing is compiled within: the process that compiles for the explorer is stopped."""
    children = Path(f"/proc/{explorer.process.pid}/task")
    compiles = None
    for _ in range(PATIENCE * 20):
        pids = [pid for listed in children.glob("*/children") for pid in listed.read_text().split()]
        compiles = next((pid for pid in pids if b"explorer.kernels" in Path(f"/proc/{pid}/cmdline").read_bytes()), None)
        if compiles:
            break
        time.sleep(0.05)
    assert compiles, "no process compiles"
    os.kill(int(compiles), signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(int(compiles), signal.SIGCONT)


def curves(id=1, fine=False, **state):
    return json.dumps({"channel": "curves", "id": id, "fine": fine, "state": state})


def axis(name, low, high, cells):
    return {"name": name, "from": low, "to": high, "cells": cells}


def plane(channel, *axes, id=1, **state):
    return json.dumps({"channel": channel, "id": id, "state": state, "axes": list(axes)})


def answer(socket, channel="curves", id=None):
    """The next answer of a channel that is whole: nothing in it waits for a kernel."""
    while True:
        header, arrays = unpacked(socket.recv(timeout=PATIENCE))
        waits = "waits" in header or any("waits" in law for law in header.get("laws", ()))
        if header["channel"] == channel and not waits and id in (None, header.get("id")):
            return header, arrays


def chromium():
    """Where Chromium is, or a sentence that says what is missing."""
    names = ("chromium", "chromium-browser", "google-chrome")
    found = os.environ.get("STICKSLIP_CHROMIUM") or next(filter(None, map(shutil.which, names)), None)
    if not found:
        pytest.skip("no Chromium was found: install Debian's package chromium, or set STICKSLIP_CHROMIUM to one")
    return found


@contextlib.contextmanager
def started_chromium():
    """Chromium, which reaches no host but this one; the test is skipped with a sentence where it is missing."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install playwright")
    here_alone = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
    path = chromium()
    with (
        playwright.sync_playwright() as p,
        contextlib.closing(p.chromium.launch(executable_path=path, args=["--no-sandbox", here_alone])) as made,
    ):
        yield made
