"""The explorer's doors, tried on the loopback: half-sent requests, slow uploads, and files that end whoever reads them."""

import contextlib
import http.client
import json
import os
import signal
import socket
import threading
import time
from urllib.parse import urlsplit

import h5py
import numpy as np
import pytest
from websockets.sync.client import connect

from stickslip.show.explorer import server, uploads
from stickslip.show.explorer.frames import unpacked
from stickslip.show.explorer.upload_reading import Reader

SOON = 20.0  # by when what is to end has ended, on a machine with other work
RECORD = ("t [ms];v [mm/s]\n" + "".join(f"{i}.0;{i % 2}.0\n" for i in range(50))).encode()


class NoKernels:
    """Stands for the kernels: nothing is ready, and nothing is compiled."""

    def __init__(self, separate=True):
        pass

    def ready(self, *asked):
        return False

    def listen(self, tell):
        pass

    begin = end = lambda self, later=(): None


class Served:
    """A server in a thread, and what is needed to speak to it."""

    def __init__(self, token=True):
        told, ready = [], threading.Event()
        self.server = server.server_of("127.0.0.1", 0, lambda address: (told.append(address), ready.set()), 1, token)
        self.app = self.server.config.app
        self.thread = threading.Thread(target=self.server.run)
        self.thread.start()
        assert ready.wait(60)
        parts = urlsplit(told[0])
        self.port, token = parts.port, parts.query.partition("=")[2]
        self.cookie = f"stickslip_token_{self.port}={token}"
        self.head = f"Host: 127.0.0.1:{self.port}\r\nCookie: {self.cookie}\r\n"

    def close(self):
        self.server.should_exit = True
        self.thread.join(60)

    def raw(self, text=""):
        """A connection on which this is sent, and no more."""
        made = socket.create_connection(("127.0.0.1", self.port), timeout=SOON)
        made.sendall(text.encode() if isinstance(text, str) else text)
        return made

    def status(self, path="/", method="GET", body=None):
        """The status of a whole request with the token."""
        with contextlib.closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=SOON)) as connection:
            connection.request(method, path, body, {"Cookie": self.cookie})
            reply = connection.getresponse()
            reply.read()
            return reply.status

    def upload(self, data=RECORD):
        """What is said of a file."""
        with contextlib.closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)) as connection:
            connection.request("POST", "/record/a.csv", data, {"Cookie": self.cookie})
            reply = connection.getresponse()
            body = reply.read()
            return (reply.status, unpacked(body)[0]) if reply.status == 200 else (reply.status, body.decode())

    def page(self):
        return connect(
            f"ws://127.0.0.1:{self.port}/socket", additional_headers={"Cookie": self.cookie}, compression=None, open_timeout=SOON
        )


@pytest.fixture(scope="module")
def served():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(server, "Kernels", NoKernels)
        patch.setattr(uploads, "RECEIVING", 2.0)  # instead of two minutes
        made = Served()
        with contextlib.closing(made):
            made.app.inner.state.uploads._reader.read("velocity", "a.csv", RECORD)  # it is ready
            yield made


def all_of(connection):
    """What comes until the connection ends; it ends in time."""
    found = bytearray()
    with contextlib.suppress(ConnectionResetError):
        while part := connection.recv(65536):
            found += part
    return bytes(found)


def until(condition):
    end = time.monotonic() + SOON
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


# strangers --------------------------------------------------------------------------------------------------------

HALVES = [
    "",
    "GET / HT",
    "GET / HTTP/1.1\r\nHost: 127.0.0.1",
    "POST /record/a.csv HTTP/1.1\r\nContent-Length: 100\r\nHost: 1",
    "\x00",
    "{head}",
]


def test_half_sent_requests_keep_nobody_out(served):
    held = [served.raw(half.replace("{head}", f"GET / HTTP/1.1\r\n{served.head}")) for half in 10 * HALVES]
    assert served.status() == 200 and served.upload()[0] == 200
    with served.page() as page:
        page.send("{}")
        assert unpacked(page.recv(timeout=SOON))[0]["kind"] == "problems"
    for connection in held:
        connection.close()


def test_who_brings_no_token_is_sent_away_at_once(served):
    with served.raw(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\n\r\n") as connection:
        said = all_of(connection)
    assert said.startswith(b"HTTP/1.1 403") and b"connection: close" in said.lower()
    with served.raw(f"POST /record/a.csv HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\nContent-Length: 1000000\r\n\r\n") as connection:
        assert all_of(connection).startswith(b"HTTP/1.1 403")


def test_an_upload_that_stops_ends_with_a_sentence(served):
    with served.raw(f"POST /record/a.csv HTTP/1.1\r\n{served.head}Content-Length: 1000\r\n\r\n0,1\n") as connection:
        said = all_of(connection)
    assert said.startswith(b"HTTP/1.1 408") and b"did not arrive in time" in said
    assert served.upload()[0] == 200


def test_an_upload_that_trickles_ends(served):
    with served.raw(f"POST /record/a.csv HTTP/1.1\r\n{served.head}Content-Length: 100000\r\n\r\n") as connection:
        end, found = time.monotonic() + SOON, b""
        connection.settimeout(0.1)
        while b"408" not in found and time.monotonic() < end:
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                connection.sendall(b"1")
            with contextlib.suppress(TimeoutError):
                found += connection.recv(65536)
        assert b"408" in found


# files ------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def reader():
    made = Reader(uploads.READING)
    yield made
    made.end()


def said(answer):
    return " ".join(unpacked(answer)[0].get("problems", ()))


def process_of(reader):
    return reader._child._running


def bomb(folder):
    with h5py.File(folder / "a.h5", "w") as file:
        file["t"] = np.arange(10.0)
        file.create_dataset("v", shape=(2**30,), dtype="f8", chunks=(2**20,), fillvalue=0.0)
    return (folder / "a.h5").read_bytes()


def test_a_file_is_read_beside_the_server_and_the_next_one_by_the_same_process(reader):
    process = process_of(reader)
    for what in ("velocity", "velocity", "drive"):
        reader.read(what, "a.csv", RECORD)
    assert process_of(reader) is process
    assert unpacked(reader.read("velocity", "a.csv", RECORD))[0]["mean"] == pytest.approx(0.0005, rel=0.05)
    assert "no table of numbers" in said(reader.read("velocity", "a.csv", b"no numbers"))
    assert "has no known file extension" in said(reader.read("velocity", "a", RECORD))


def test_a_file_that_unpacks_without_end_is_refused(reader, tmp_path):
    assert "STICKSLIP_LARGEST" in said(reader.read("velocity", "a.h5", bomb(tmp_path)))


def test_a_file_that_ends_its_reader_is_said_and_the_next_one_is_read(reader):
    process = process_of(reader)
    assert said(reader.read("velocity", "a.csv", RECORD)) == ""
    os.kill(process._process.pid, signal.SIGSEGV)
    process._process.wait(60)
    process.is_alive = lambda: True  # it ends while it reads
    assert "the process that read the record crashed" in said(reader.read("velocity", "a.csv", RECORD))
    assert said(reader.read("velocity", "a.csv", RECORD)) == ""


def test_a_file_that_takes_too_long_is_given_up_and_the_next_one_is_read(tmp_path):
    reader = Reader(uploads.READING)
    process = process_of(reader)
    assert said(reader.read("velocity", "a.csv", RECORD)) == ""
    reader._seconds = 0.5
    os.kill(process._process.pid, signal.SIGSTOP)
    assert "not read in time" in said(reader.read("velocity", "a.csv", RECORD))
    reader._seconds = uploads.READING
    assert said(reader.read("velocity", "a.csv", RECORD)) == ""
    reader.end()
    assert not process_of(reader).is_alive()


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="this system has no limits of memory")
def test_a_file_that_needs_too_much_memory_is_said(monkeypatch, tmp_path):
    monkeypatch.setenv("STICKSLIP_LARGEST", "1e12")  # the limit of the process remains
    reader = Reader(60.0)
    assert "more memory than" in said(reader.read("velocity", "a.h5", bomb(tmp_path)))
    assert said(reader.read("velocity", "a.csv", RECORD)) == ""
    reader.end()


def test_messages_of_nonsense_do_not_end_a_page(served):
    with served.page() as page:
        for text in ("", "{", "[" * 20000, json.dumps({"channel": "\ud800", "id": "\udfff"}), b"\xff\xfe", b"\x00" * 100):
            page.send(text)
            assert unpacked(page.recv(timeout=SOON))[0]["kind"] == "problems"
