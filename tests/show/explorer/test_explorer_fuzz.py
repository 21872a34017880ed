"""Ten thousand messages and requests of nonsense to the explorer: nothing but answers in our words, nothing in the log, and it lives."""

import asyncio
import contextlib
import copy
import json
import logging
import math
import random
import re
import socket
from collections import Counter
from urllib.parse import quote

import pytest

from explorers import axis
from records.test_read_damaged import damaged
from show.explorer.test_explorer_doors import NoKernels, Served
from stickslip.show.explorer import responses, server
from stickslip.show.explorer.exports import EXPORTS
from stickslip.show.explorer.frames import unpacked
from stickslip.show.explorer.models import CONTACTS, DRIVES, FRICTION, TRACKS
from stickslip.show.explorer.requests import CHANNELS, DEFAULT, KEPT
from stickslip.show.explorer.sliders import PARAMETERS

TOKEN = "token-of-the-test"
PORT = 8765
COOKIE = f"stickslip_token_{PORT}={TOKEN}"
PATIENCE = 60.0  # for one answer: a hang takes for ever
HOSTILE = [
    None, True, False, 0, -1, 1, 10**400, -(2**63), 2**53, 1e308, -1e-308, 5e-324, math.nan, math.inf, -math.inf, "", "x", "\0", "\ud800",
    "é" * 50, "../../etc/passwd", "<script>alert(1)</script>", "__proto__", "constructor", "coulomb", "lugre", "amplitude", [], {}, [[]],
    [None] * 50, [[1.0]] * 40, {"": ""}, {"a": {"b": {"c": []}}}, "9" * 5000, [1.0, 2.0], "{}", "${7*7}", "%s%n", "\u202e",
]  # fmt: skip


class QuickKernels(NoKernels):
    """Ready is what is solved in closed form, one robot at a time; for everything else a page is told to wait."""

    def ready(self, found, law, robot, many):
        return not many and (found.drive, law) == ("harmonic", "coulomb") and found.track in ("level", "folded", "gravity")


# what is sent -----------------------------------------------------------------------------------------------------


def whole(rng):
    """A message that makes sense."""
    values = {name: rng.uniform(p.low, p.high) for name, p in PARAMETERS.items() if rng.random() < 0.3}
    choice = {"drive": DRIVES, "track": TRACKS, "contact": CONTACTS, "law": FRICTION}
    state = {name: rng.choice([*parts]) for name, parts in choice.items() if rng.random() < 0.4} | {"values": values}
    if rng.random() < 0.5:
        state |= {"drive": "harmonic", "track": "folded", "law": "coulomb", "also": []}
    if rng.random() < 0.2:
        state["shape"] = [[rng.uniform(-1, 1) for _ in range(5)] for _ in range(2)]
    told = {
        "channel": rng.choice(CHANNELS),
        "id": rng.randrange(1000),
        "state": state,
        "fine": rng.random() < 0.2,
    }
    if told["channel"] != "curves":
        names = rng.sample(DEFAULT.active, 2 if told["channel"] == "map" else 1)
        told["axes"] = [axis(name, PARAMETERS[name].low, PARAMETERS[name].high, rng.randint(2, 9)) for name in names]
        told |= {"sliders": names, "keep": rng.sample(KEPT, rng.randrange(3))} if told["channel"] == "faster" else {}
    return told


def places(value, path=()):
    """Where something stands in a table."""
    yield path
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in inner:
        yield from places(part, (*path, key))


def hostile(rng):
    return copy.deepcopy(rng.choice(HOSTILE))  # it may be changed further


def changed(told, rng):
    """The same with hostile values somewhere."""
    told = copy.deepcopy(told)
    for _ in range(rng.choice([0, 1, 1, 1, 2, 5])):
        path = rng.choice([*places(told)])
        if not path:
            return hostile(rng)
        *way, last = path
        holder = told
        for key in way:
            holder = holder[key]
        if isinstance(holder, dict) and rng.random() < 0.2:
            holder[str(rng.choice(HOSTILE))[:100]] = hostile(rng)
        elif rng.random() < 0.1:
            del holder[last]
        else:
            holder[last] = hostile(rng)
    return told


def message(rng):
    """Text or bytes, as a page or somebody else sends them."""
    kind = rng.random()
    if kind < 0.05:
        return rng.randbytes(rng.randrange(200))
    if kind < 0.1:
        return rng.choice(["[", '{"a":', "-", '"', "\\u", "1e"]) * rng.randrange(1, 4000)
    with contextlib.suppress(ValueError):
        text = json.dumps(changed(whole(rng), rng), ensure_ascii=rng.random() < 0.5)
        if rng.random() < 0.25:
            return damaged(text.encode("utf-8", "replace"), rng)
        return text if text.isascii() else text.encode("utf-8", "replace").decode()
    return "1" * 5000


PATHS = ["", "/", "assets", "export", "record", "drive", "socket", "..", "%2e", "main.js", "a.csv", *EXPORTS, "\0", "é", "x" * 300]
KNOWN = ["/", "/assets/main.js", "/socket", "/record/a.h5", "/drive/a.mat", *(f"/export/{name}" for name in EXPORTS)]
HOSTS = [*["127.0.0.1:8765"] * 12, "localhost", "[::1]:1", "[", "[::1", "evil.example", "", "a@b:c", "\xff", "127.0.0.1:99999999"]
NAMES = [b"cookie", b"origin", b"sec-fetch-site", b"sec-fetch-mode", b"content-length", b"x-forwarded-for", b"range"]
VALUES = ["http://127.0.0.1:8765", "null", "[", "http://[", "cross-site", "navigate", "-1", "\xff", ";=;\x01", COOKIE, "a" * 2000]
BODIES = [b"", b"1,2\n3,4\n", b"\x89HDF\r\n\x1a\n", b"PK\x03\x04", b"MATLAB 5.0", b"TDSm", b"CDF\x01"]
METHODS = ["GET", "GET", "POST", "POST", "HEAD", "PUT", "OPTIONS", "X"]


def query(rng):
    """What stands behind the question mark."""
    if rng.random() < 0.5:
        told = changed(whole(rng), rng)
        told = told.get("state") if isinstance(told, dict) else told
        return "state=" + quote(json.dumps(told)[:5000])
    return rng.choice(
        ["", f"token={TOKEN}", "token=\xff", "state=%", "state=%ff", "state={", "&" * 50, rng.randbytes(20).decode("latin-1")]
    )


def request(rng):
    """Method, path, query, headers and body; most of them with the token."""
    path = rng.choice(KNOWN) if rng.random() < 0.6 else "/" + "/".join(rng.choice(PATHS) for _ in range(rng.randrange(4)))
    headers = [(b"host", rng.choice(HOSTS).encode("latin-1"))] * rng.choice([1] * 9 + [0, 2])
    headers += [(name, rng.choice(VALUES).encode("latin-1")) for name in rng.sample(NAMES, 3)]
    if rng.random() < 0.8:
        headers = [header for header in headers if header[0] not in NAMES[:3]] + [(b"cookie", COOKIE.encode())]
    return rng.choice(METHODS), path, query(rng), headers, rng.choice(BODIES) + rng.randbytes(rng.choice([0, 0, 300]))


UPGRADE = (
    b"GET /socket HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    b"Host: 127.0.0.1\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
)


def blob(rng):
    """Bytes on a bare connection."""
    method, path, words, headers, body = request(rng)
    lines = [f"{method} {quote(path)}?{quote(words)} HTTP/1.1".encode(), *(b": ".join(header) for header in headers), b"", body]
    text = b"\r\n".join(lines)
    upgrade = b"GET /socket HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    if rng.random() < 0.3:
        text = (
            upgrade
            + f"Host: 127.0.0.1\r\nCookie: {COOKIE}\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
            + rng.randbytes(60)
        )
    return damaged(text, rng) if rng.random() < 0.7 else text


# to whom ----------------------------------------------------------------------------------------------------------


class Page:
    """A page within this process: an application that is spoken to as the server does."""

    def __init__(self, app):
        self.asked, self.said = asyncio.Queue(), asyncio.Queue()
        head = [(b"host", b"127.0.0.1:8765"), (b"cookie", COOKIE.encode())]
        scope = {"type": "websocket", "path": "/socket", "raw_path": b"/socket", "query_string": b"", "headers": head, "root_path": "",
                 "server": ("127.0.0.1", PORT), "client": None, "subprotocols": [], "scheme": "ws", "asgi": {"version": "3.0"}}  # fmt: skip
        self.task = asyncio.create_task(app(scope, self.asked.get, self.said.put))
        self.asked.put_nowait({"type": "websocket.connect"})

    async def answer(self, text):
        """The one answer to a message."""
        kind = "bytes" if isinstance(text, bytes) else "text"
        await self.asked.put({"type": "websocket.receive", kind: text})
        return await asyncio.wait_for(self.said.get(), PATIENCE)

    async def close(self):
        await self.asked.put({"type": "websocket.disconnect", "code": 1000})
        await asyncio.wait_for(self.task, PATIENCE)


async def messages(app, rng, count):
    """Each is answered, by a curve or a sentence."""
    told = Counter()
    for begin in range(0, count, 200):  # a page may send so many at once
        page = Page(app)
        assert (await page.said.get())["type"] == "websocket.accept"
        for _ in range(min(200, count - begin)):
            sent = message(rng)
            answer = await page.answer(sent)
            assert answer["type"] == "websocket.send", (sent, answer)
            header, _ = unpacked(answer["bytes"])
            problems = header.get("problems", ["-"])
            assert header["kind"] in ("curves", "map", "strip", "waits", "problems") and problems, sent
            assert not any("error of stickslip itself" in p or "Traceback" in p for p in problems), (sent, problems)
            told[header["kind"]] += 1
        await page.close()
    return told


async def requests(app, rng, count):
    """Each is answered as a page is or a sentence says why not."""
    told = Counter()
    for _ in range(count):
        method, path, words, headers, body = asked = request(rng)
        scope = {"type": "http", "method": method, "path": path, "raw_path": quote(path).encode(), "headers": headers,
                 "query_string": words.encode("latin-1"), "root_path": "", "server": ("127.0.0.1", PORT), "client": None,
                 "scheme": "http", "http_version": "1.1", "asgi": {"version": "3.0"}}  # fmt: skip
        parts, said = iter([{"type": "http.request", "body": body, "more_body": False}]), []

        async def receive(parts=parts):
            return next(parts, {"type": "http.disconnect"})

        async def send(event, said=said):
            said.append(event)

        await asyncio.wait_for(app(scope, receive, send), PATIENCE)
        status = said[0]["status"]
        text = b"".join(event.get("body", b"") for event in said[1:])
        assert status in (200, 307, 400, 403, 404, 405, 413, 503), (asked, status)
        assert b"Traceback" not in text and b"error of stickslip itself" not in text, (asked, text)
        told[status] += 1
    return told


def bytes_to_a_server(rng, count):
    """Whatever comes on a connection, the next request is answered."""
    served, told, log = Served(token=False), Counter(), []
    (listener := logging.Handler(logging.ERROR)).emit = log.append
    logging.getLogger("uvicorn.error").addHandler(listener)  # which does not hand on to others
    with contextlib.closing(served):
        for number in range(count):
            with contextlib.suppress(OSError), served.raw(blob(rng)) as connection:
                connection.shutdown(socket.SHUT_WR)
                connection.settimeout(5.0)
                found = connection.recv(4096)
                told[found[9:12].decode() if re.match(rb"HTTP/1\.[01] \d{3} ", found) else "closed"] += 1
                assert b"Traceback" not in found and not found.startswith(b"HTTP/1.1 500"), found
            if number % 100 == 0:
                assert served.status() == 200
        assert served.status() == 200
    logging.getLogger("uvicorn.error").removeHandler(listener)
    assert not log, [record.getMessage() for record in log]
    return told


def endure(monkeypatch, caplog, count, seed):
    """Six tenths messages, three tenths requests, one tenth bytes."""
    rng = random.Random(seed)
    monkeypatch.setattr(server, "Kernels", QuickKernels)
    monkeypatch.setattr(responses, "at_once", lambda make, stop: None)  # half a second for each page that is to wait
    guard = server.application("127.0.0.1", TOKEN, 2)

    async def both():
        async with guard.inner.router.lifespan_context(guard.inner):
            return await messages(guard, rng, 6 * count // 10), await requests(guard, rng, 3 * count // 10)

    with caplog.at_level(logging.ERROR):
        answers, statuses = asyncio.run(both())
        raw = bytes_to_a_server(rng, count // 10)
    assert not caplog.records
    print(f"\n{count} tried: messages {dict(answers)}, requests {dict(statuses)}, connections {dict(raw)}")
    assert answers["problems"] > 0.3 * 6 * count / 10 and answers["curves"] > 0 and {200, 400, 403, 404} <= set(statuses)


def test_an_address_that_is_not_text_is_refused():
    """Servers before the application need not have looked at it."""
    said = []

    async def send(event):
        said.append(event)

    headers = [(b"host", f"127.0.0.1:{PORT}".encode()), (b"cookie", COOKIE.encode())]
    scope = {
        "type": "http",
        "method": "GET",
        "path": "/drive/a.mat",
        "headers": headers,
        "query_string": b"x=\x8d",
        "server": ("127.0.0.1", PORT),
    }
    asyncio.run(server.application("127.0.0.1", TOKEN, 2)(scope, None, send))
    assert said[0]["status"] == 400 and b"not text in UTF-8" in said[1]["body"]


def test_nonsense_is_answered_in_our_words(monkeypatch, caplog):
    endure(monkeypatch, caplog, 500, seed=1)


@pytest.mark.slow
def test_ten_thousand_messages_and_requests_of_nonsense_are_answered_in_our_words(monkeypatch, caplog):
    endure(monkeypatch, caplog, 10_000, seed=2)
