"""A pool of two new processes, as they are on every system."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor


def processes(count=2):
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"))
