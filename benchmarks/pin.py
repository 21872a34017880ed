"""One core, one thread. Import this before NumPy: the thread counts are read when the libraries load."""

import os

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def to_one_core() -> str:
    """Pin this process to one core and every library to one thread; says what was possible."""
    for name in THREADS:
        os.environ[name] = "1"
    # XLA reads only this, and otherwise counts the machine's cores
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
    if not hasattr(os, "sched_setaffinity"):
        return "not pinned (no sched_setaffinity on this system)"
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return f"pinned to core {core}"


WHERE = to_one_core()
