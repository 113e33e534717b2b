"""Linear algebra on one thread where results are made: with more, sums are taken in another order and last digits differ.

Matrices of a batch are small, so threads gain nothing; more processes do (``--workers``).
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

VARIABLES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Variables that libraries of linear algebra read as they are loaded, and prefer to OMP_NUM_THREADS."""


def use_one_thread() -> None:
    """Give linear algebra one thread in this process, and in those it starts; OMP_NUM_THREADS stays for other programs."""
    for variable in VARIABLES:
        os.environ[variable] = "1"
    if "numpy" in sys.modules:  # what is loaded already has read them
        from threadpoolctl import threadpool_limits

        threadpool_limits(limits=1, user_api="blas")


@contextmanager
def one_thread() -> Iterator[None]:
    """Give linear algebra one thread within a block whose results come from it."""
    import scipy.linalg  # noqa: F401  # has a library of its own, which must be there to be limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function whose results come from linear algebra: it has one thread until the function returns."""

    @functools.wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with one_thread():
            return function(*args, **kwargs)

    return limited
