"""The one pool: what comes out, in which order, and how it ends."""

import pytest

from rows import each_row
from stickslip.basics.interruption import PROGRESS, Interrupted, interruptible, is_stopped, look, partial_result, stop_call
from stickslip.basics.pool import handed_out


def test_one_worker_keeps_the_order_and_works_only_when_it_is_asked():
    begun = []

    def work(n):
        begun.append(n)
        return 10 * n

    results = handed_out(work, iter(range(5)))
    assert next(results) == (0, 0) and begun == [0]
    assert list(results) == [(n, 10 * n) for n in range(1, 5)]


def test_several_workers_make_the_same_and_take_few_parts_at_a_time():
    taken = []

    def parts():
        for n in range(100):
            taken.append(n)
            yield n

    results = handed_out(lambda n: n * n, parts(), workers=3)
    first = next(results)
    assert len(taken) <= 7  # two for each worker, and one after the first came back
    assert sorted([first, *results]) == [(n, n * n) for n in range(100)]


@each_row("workers", [1, 3])
def test_no_part_is_begun_after_an_interruption_and_those_at_work_have_no_result(workers):
    @interruptible
    def squares():
        def work(n):
            if n == 4:
                stop_call(PROGRESS)
                look()
            return n

        found = []
        with partial_result() as ending:
            for n, _ in handed_out(work, iter(range(1000)), workers):
                found.append(n)
        return found, ending.interrupted

    found, interrupted = squares()
    assert interrupted and 4 not in found and set(range(4)) <= set(found) and len(found) < 20


@each_row("workers", [1, 3])
def test_all_parts_are_begun_after_an_interruption_where_each_looks_for_itself(workers):
    @interruptible
    def squares():
        def work(n):
            if n == 4:
                stop_call(PROGRESS)
            return not is_stopped()

        return [n for n, _ in handed_out(work, range(50), workers, all_parts=True)]

    assert sorted(squares()) == [*range(50)]


@each_row("workers", [1, 3])
def test_an_interruption_without_a_call_is_an_error_like_any_other(workers):
    def work(n):
        raise Interrupted

    with pytest.raises(Interrupted):
        list(handed_out(work, range(3), workers))


def test_an_error_ends_the_work_of_the_other_threads():
    def work(n):
        if n == 2:
            raise ValueError("two")
        while n > 2:
            look()
        return n

    with pytest.raises(ValueError, match="two"):
        list(handed_out(work, range(100), 2))
