"""The one pool: what comes out, in which order, and how it ends."""

from types import SimpleNamespace

import pytest

from stickslip.pool import Cancelled, shared


def test_one_worker_keeps_the_order_and_works_only_when_it_is_asked():
    begun = []

    def work(n):
        begun.append(n)
        return 10 * n

    results = shared(work, iter(range(5)))
    assert next(results) == (0, 0) and begun == [0]
    assert list(results) == [(n, 10 * n) for n in range(1, 5)]


def test_several_workers_make_the_same_and_take_few_parts_at_a_time():
    taken = []

    def parts():
        for n in range(100):
            taken.append(n)
            yield n

    results = shared(lambda n: n * n, parts(), workers=3)
    first = next(results)
    assert len(taken) <= 7  # two for each worker, and one after the first came back
    assert sorted([first, *results]) == [(n, n * n) for n in range(100)]


@pytest.mark.parametrize("workers", [1, 3])
def test_no_part_is_begun_after_somebody_said_stop_and_cancelled_parts_have_no_result(workers):
    watch = SimpleNamespace(stopped=False)

    def work(n):
        if n == 4:
            watch.stopped = True
            raise Cancelled
        return n

    found = [n for n, _ in shared(work, iter(range(1000)), workers, watch)]
    assert 4 not in found and set(range(4)) <= set(found) and len(found) < 20


@pytest.mark.parametrize("workers", [1, 3])
def test_without_a_watch_it_is_an_error_like_any_other(workers):
    def work(n):
        raise Cancelled

    with pytest.raises(Cancelled):
        list(shared(work, range(3), workers))


def test_an_error_ends_the_work_and_tells_the_watch():
    watch = SimpleNamespace(stopped=False)

    def work(n):
        if n == 2:
            raise ValueError("two")
        while not watch.stopped and n > 2:
            pass
        return n

    with pytest.raises(ValueError, match="two"):
        list(shared(work, range(100), 2, watch))
    assert watch.stopped
