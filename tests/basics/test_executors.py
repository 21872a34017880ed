"""Chunks on an executor: each result once, whatever happens to the workers, and how it ends."""

import gc
import os
import pickle
import signal
import struct
import threading
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from multiprocessing.connection import Connection

import pytest

import stickslip as ss
from spawned import processes
from stickslip.basics.errors import Problems
from stickslip.basics.executors import Workers, packed
from stickslip.basics.interruption import PROGRESS, interruptible, look, partial_result, stop_call
from stickslip.basics.pool import handed_out
from stickslip.basics.processes import Processes


class Polled:
    """A batch queue: its jobs can be looked at, and not waited for; the first of each is lost."""

    def __init__(self, lose=0):
        self.left, self.pool = lose, ThreadPoolExecutor(2)

    def submit(self, function, *arguments):
        future = self.pool.submit(function, *arguments)
        self.left -= 1
        return Job(future, self.left >= 0)


class Job:
    def __init__(self, future, lost):
        self.future, self.lost = future, lost

    def done(self):
        return self.future.done()

    def exception(self):
        return RuntimeError("node failure") if self.lost else self.future.exception()

    def result(self):
        return self.future.result()

    def cancel(self):
        self.future.cancel()


def test_jobs_that_can_only_be_looked_at_and_some_of_which_are_lost():
    assert sorted(handed_out(lambda n: n * n, range(30), Workers(2, Polled(3)))) == [(n, n * n) for n in range(30)]
    with pytest.raises(ss.StickslipError, match=r"chunk \d+ was lost with its worker 2 times \(RuntimeError: node failure\)"):
        list(handed_out(lambda n: n, range(3), Workers(2, Polled(100), retries=1)))


def test_a_killed_worker_costs_nothing_if_the_pool_can_be_made_again(tmp_path):
    def work(n):
        if n == 3 and not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return n * n

    assert sorted(handed_out(work, range(40), Workers(2, processes))) == [(n, n * n) for n in range(40)]
    assert (tmp_path / "killed").exists()


def test_of_processes_by_name_one_that_is_killed_costs_its_own_chunks(tmp_path):
    def work(n):
        if n == 3 and not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(0.02)
        return os.getpid()

    crew = Workers(1, "processes:2")
    assert crew.threads == 2 and crew.elsewhere
    done = list(handed_out(work, range(60), crew))
    assert sorted(n for n, _ in done) == list(range(60)) and len({pid for _, pid in done}) <= 3


def test_a_process_that_is_killed_while_it_sends_its_result_is_not_waited_for(tmp_path):
    """A pool of `concurrent.futures` waits for the rest of the result for ever."""

    def work(n):
        if not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            pipes = [each for each in gc.get_objects() if isinstance(each, Connection)]
            os.write(pipes[0].fileno(), struct.pack("!i", 1_000_000) + b"the first bytes of it")
            os.kill(os.getpid(), signal.SIGKILL)
        return n

    assert sorted(handed_out(work, range(5), Workers(1, "processes:1"))) == [(n, n) for n in range(5)]
    pool = Processes(1)
    assert pool.submit(abs, -2).result() == 2
    with pytest.raises(ss.StickslipError, match="TypeError: bad operand"):
        pool.submit(abs, "two").result()
    with pytest.raises(AttributeError, match=r"lambda|local object"):
        pool.submit(lambda: 3).result()
    pool.shutdown()


class Broken(Executor):
    """A pool that has lost its workers."""

    def submit(self, function, /, *arguments, **named):
        from concurrent.futures.process import BrokenProcessPool

        future = Future()
        future.set_exception(BrokenProcessPool("a child process terminated"))
        return future


def test_a_pool_that_is_broken_for_good_says_what_to_type():
    with pytest.raises(ss.StickslipError, match=r"the workers of the executor are gone .* give a function that makes the executor"):
        list(handed_out(abs, range(3), Workers(2, Broken())))
    with pytest.raises(ss.StickslipError, match="4 times without a chunk finished in between"):
        list(handed_out(abs, range(3), Workers(2, Broken)))


def test_no_chunk_is_begun_after_an_interruption_and_those_at_work_are_called_back():
    @interruptible
    def squares(pool):
        values = []
        with partial_result() as ending:
            for n, _ in handed_out(slow, range(1000), Workers(2, pool)):
                values.append(n)
                if len(values) == 4:
                    stop_call(PROGRESS)
        return values, ending.interrupted

    def slow(n):
        until = time.monotonic() + (0.0 if n < 5 else 20.0)
        while time.monotonic() < until:
            look()
            time.sleep(0.01)
        return n

    began = time.monotonic()
    with ThreadPoolExecutor(2) as pool:
        values, interrupted = squares(pool)
    assert interrupted and set(values) <= set(range(5)) and len(values) >= 4
    assert time.monotonic() - began < 10.0


def test_an_error_of_a_chunk_is_raised_as_it_is():
    def work(n):
        raise ss.InputError("chunk", [f"{n} is odd"])

    with ThreadPoolExecutor(1) as pool, pytest.raises(ss.InputError, match="0 is odd"):
        list(handed_out(work, range(3), Workers(1, pool)))


def test_what_cannot_travel_is_refused_in_words():
    with pytest.raises(ss.InputError, match=r"cannot be sent to another process .*lock.*; write it into a module"):
        packed(threading.Lock())
    assert pickle.loads(packed(lambda: 3))() == 3
    problems = Problems("sweep")
    Workers(0, 3).note(problems)
    assert len(problems.mistakes) == 2 and "executor = 3; allowed is an executor with submit()" in problems.mistakes[1]
    with pytest.raises(ss.InputError, match=r"executor = 'processes:0'; allowed is .* or \"processes:N\"; type for example"):
        ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 5e-4], tilt_deg=1.7, executor="processes:0")
