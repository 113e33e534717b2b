"""Batches on this process, on a local pool of processes or on a dask.distributed cluster: one loop for all of them.

Every one of them is an executor of `concurrent.futures`. Results come as they are done; a batch depends on its number
alone, so who solves it and when shows nowhere in them.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, cast

from ltca.errors import CycloError, FaultError
from ltca.output.process_pools import become_worker, process_pool
from ltca.output.progress import be_silent
from ltca.output.threads import use_one_thread
from ltca.studies.study import BatchResult, Study, run_batch

SCHEDULER_TIMEOUT = 10.0
"""Time, s, in which a scheduler has to answer."""

MAX_POOL_RESTARTS = 3
"""Times the local pool is built anew after a worker has died before the study gives up."""

BATCHES_PER_WORKER = 4
"""Batches handed out for each worker: enough that none waits, few enough that memory stays flat."""


class ThisProcess(Executor):
    """Executor that runs a task when it is handed in."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run the task and return its finished future."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@dataclass(frozen=True, slots=True, kw_only=True)
class Workers:
    """Where batches are solved.

    Attributes
    ----------
    processes : int
        Processes of the local pool; 1 is this process alone.
    scheduler : str
        Address of a dask.distributed scheduler, empty for none.
    """

    processes: int = 1
    scheduler: str = ""

    @contextmanager
    def executor(self) -> Iterator[tuple[Executor, int]]:
        """Give the executor and its number of workers; `CycloError` where dask.distributed or its scheduler is missing."""
        if self.scheduler:
            with _cluster(self.scheduler) as found:
                yield found
        elif self.processes > 1:
            # The fork server imports the suite and builds the tables once.
            preload = "ltca.studies.execution.warm_worker"
            with process_pool(self.processes, preload=preload, initializer=_calm_threads) as pool:
                yield pool, self.processes
        else:
            yield ThisProcess(), 1


def _calm_threads() -> None:
    """One thread a worker: threads of small dense algebra wait for each other (up to 40 times slower, measured)."""
    use_one_thread()
    be_silent()
    become_worker()


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    try:
        from distributed import Client
    except ImportError as error:
        raise CycloError(
            "--scheduler needs dask.distributed, which is not installed: pip install 'cyclo-ltca[cluster]'"
        ) from error
    # What is lost is said in one line of ours; the library would print tracebacks of its own beside it.
    for name in ("distributed", "distributed.client", "distributed.core", "tornado", "asyncio"):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # some have levels of their own
    try:
        client: Any = cast(Any, Client)(address, timeout=SCHEDULER_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise CycloError(f"--scheduler = {address}: no scheduler answers there: {error}") from error
    try:
        workers = max(1, sum(client.nthreads().values()))
        yield client.get_executor(pure=False, retries=MAX_POOL_RESTARTS), workers
    finally:
        client.close()


def solve_batches(study: Study, numbers: Iterable[int], workers: Workers) -> Iterator[BatchResult]:
    """Solve batches and yield them as they are done, in no particular order.

    Raises `FaultError` when workers die again and again, or the scheduler is gone.
    """
    left = list(numbers)[::-1]
    for _ in range(MAX_POOL_RESTARTS + 1):
        done: set[int] = set()
        try:
            with workers.executor() as (executor, count):
                for result in _flow(study, left, executor, BATCHES_PER_WORKER * count):
                    done.add(result.number)
                    yield result
            return
        except BrokenProcessPool:
            # A worker died (killed, out of memory): its pool is gone with it, what was not finished starts again.
            left = [number for number in left if number not in done]
        except _cluster_losses(workers.scheduler) as error:
            kept = len([number for number in left if number not in done])
            raise FaultError(
                f"--scheduler {workers.scheduler}: lost its batches ({type(error).__name__}); {kept} are left: finished ones "
                "are kept, continue with --resume"
            ) from error
    raise FaultError(
        f"workers died {MAX_POOL_RESTARTS + 1} times; {len(left)} batches are left: finished ones are kept, continue with "
        "--resume"
    )


def _cluster_losses(scheduler: str) -> tuple[type[Exception], ...]:
    """What futures raise when a scheduler has gone, or has lost a batch with too many workers."""
    if not scheduler:
        return ()
    try:
        from distributed.comm.core import CommClosedError
        from distributed.scheduler import KilledWorker
    except ImportError:
        return ()  # the executor says what is missing

    return (CancelledError, CommClosedError, KilledWorker)


def _flow(study: Study, numbers: list[int], executor: Executor, window: int) -> Iterator[BatchResult]:
    """Keep a window of batches in flight."""
    waiting = list(numbers)
    flying: set[Future[BatchResult]] = set()
    while waiting or flying:
        while waiting and len(flying) < window:
            flying.add(executor.submit(run_batch, study, waiting.pop()))
            if isinstance(executor, ThisProcess):
                break
        finished, flying = wait(flying, return_when=FIRST_COMPLETED)
        for future in finished:
            yield future.result()
