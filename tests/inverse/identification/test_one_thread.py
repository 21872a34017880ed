"""Linear algebra of fits runs in one thread, and the process has its threads back afterwards."""

import numpy as np
import pytest
import scipy.linalg  # noqa: F401  has a library of its own
from threadpoolctl import ThreadpoolController

from stickslip.basics.one_thread import in_one_thread


def threads():
    return [library["num_threads"] for library in ThreadpoolController().info() if library["user_api"] == "blas"]


@pytest.fixture
def two():
    """Two threads, whatever the machine has."""
    with ThreadpoolController().limit(limits=2, user_api="blas"):
        if max(threads(), default=1) < 2:
            pytest.skip("the libraries under NumPy and SciPy have one thread here")
        yield


def test_a_function_runs_with_one_thread_and_leaves_as_many_as_there_were(two):
    assert set(in_one_thread(threads)()) == {1} and set(threads()) == {2}


def test_threads_come_back_after_an_error(two):
    with pytest.raises(np.linalg.LinAlgError):
        in_one_thread(np.linalg.inv)(np.zeros((2, 2)))
    assert set(threads()) == {2}
