"""Factors of sparse matrices, and what is said where memory is not enough for one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import scipy.sparse as sp
import scipy.sparse.linalg as spla

from ltca.errors import FaultError

OUT_OF_MEMORY = ("invalid arguments", "not enough memory", "out of memory", "malloc", "memory allocation")
"""Parts of the messages of libraries that find too little memory: SuperLU says "gstrf was called with invalid arguments"."""


@contextmanager
def enough_memory(unknowns: int) -> Iterator[None]:
    """Replace the error of a library that finds no memory for a system of so many unknowns by a FaultError."""
    try:
        yield
    except (MemoryError, SystemError, RuntimeError, ArithmeticError) as error:
        if not isinstance(error, MemoryError) and not any(sign in str(error).lower() for sign in OUT_OF_MEMORY):
            raise
        raise FaultError(
            f"memory is not enough to solve {unknowns:,} unknowns: take a coarser mesh (--size where the command has it), "
            "or raise the limit of memory (ulimit -v, container)"
        ) from error


def factor_sparse(matrix: sp.csc_matrix, **options: Any) -> Any:
    """Return the factor by SuperLU; FaultError where memory is not enough. Options are those of `scipy.sparse.linalg.splu`."""
    with enough_memory(matrix.shape[0]):
        return spla.splu(matrix, **options)
