"""A process that answers messages: what ends it, or what it has no time or memory for, is told of that message alone."""

import os
import signal
import sys
import threading

import pytest

from stickslip.basics.child_process import ChildEnded, ChildProcess

MODULE = """
import mmap, os, signal, time
from stickslip.basics.child_process import serve

def answer(wish, data):
    if wish["do"] == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if wish["do"] == "sleep":
        time.sleep(600)
    if wish["do"] == "write":
        print("not an answer", flush=True)
        os.write(1, b"nor this")
    if wish["do"] == "take":
        return str(len(mmap.mmap(-1, 2 * 10**9))).encode()
    if wish["do"] == "file":
        with open(data.decode(), "wb") as file:
            file.write(b"1")
    return data[::-1]

if __name__ == "__main__":
    serve(answer)
"""


@pytest.fixture
def child(tmp_path, monkeypatch):
    (tmp_path / "answering.py").write_text(MODULE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    made = ChildProcess("answering")
    yield made
    made.end()


def asked(child, do, data=b"ab", seconds=60.0):
    return child.ask({"do": do}, data, seconds, 1e8)


def test_messages_are_answered_by_one_process(child):
    assert [asked(child, "reverse", data) for data in (b"", b"abc", bytes(10**6) + b"\1")] == [b"", b"cba", b"\1" + bytes(10**6)]
    first = child._running
    assert asked(child, "write") == b"ba" and child._running is first


def test_a_crash_is_that_of_one_message(child):
    with pytest.raises(ChildEnded) as ended:
        asked(child, "crash")
    assert not ended.value.late and asked(child, "reverse") == b"ba"


def test_what_takes_too_long_is_ended(child):
    asked(child, "reverse")
    with pytest.raises(ChildEnded) as ended:
        asked(child, "sleep", seconds=0.3)
    assert ended.value.late and asked(child, "reverse") == b"ba"


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such limits")
def test_memory_and_files_are_limited(child, tmp_path):
    with pytest.raises(ChildEnded):
        asked(child, "take")
    assert child.ask({"do": "take"}, b"", 60.0, 4e9) == b"2000000000"
    with pytest.raises(ChildEnded):
        asked(child, "file", str(tmp_path / "written").encode())
    assert not (tmp_path / "written").exists() or (tmp_path / "written").stat().st_size == 0


def test_one_that_cannot_start_is_an_error_of_the_system(tmp_path):
    with pytest.raises(OSError, match="ended while it started"):
        ChildProcess("stickslip.no_such_module").ask({}, b"", 1.0, 1e8)


def test_ended_for_good_while_it_answers(child):
    asked(child, "reverse")
    threading.Timer(0.2, child.end).start()
    with pytest.raises(ChildEnded):
        asked(child, "sleep")
    with pytest.raises(ChildEnded):
        asked(child, "reverse")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no forks")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_asks_a_process_of_its_own(child):
    asked(child, "reverse")
    running = child._running
    pid = os.fork()
    if pid == 0:
        os._exit(0 if asked(child, "reverse") == b"ba" and child._running is not running else 1)
    assert os.waitpid(pid, 0)[1] == 0
    assert asked(child, "reverse") == b"ba" and child._running is running


def test_a_process_that_was_ended_from_outside_is_replaced(child):
    asked(child, "reverse")
    process = child._running._process
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert asked(child, "reverse") == b"ba"
