"""Processes that answer questions, one at a time each, and are ended by the next one: nobody waits for what nobody wants."""

from __future__ import annotations

import asyncio
import contextlib
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any

from ltca.output.process_pools import become_worker, make_pool_folder, start_context
from ltca.studio.answers import COARSE, Question

PATIENCE = 0.3
"""Time, s, that a coarse answer is waited for when the next question is there: most are done, and keep their process."""
STARTS, BETWEEN_STARTS = 3, 0.2
"""Trials to start a process, and the time, s, between them: the system takes a moment to tell that a fork server was killed."""
MOST_DESKS = 8
"""Tabs with processes of their own; that of the longest silence gives its up."""
WARM = "ltca.studio.warm"


class Superseded(Exception):  # noqa: N818  # no error: the next question has come
    """The question is no longer asked."""


def start_fork_server() -> Any:
    """Start the process from which workers are forked, and return the context that does so; without one they are spawned."""
    return start_context(WARM)


def _answer_all(connection: Connection) -> None:
    """Answer questions until there are none."""
    become_worker()
    from ltca.studio.answers import Memory, answer

    memory = Memory()
    while True:
        try:
            question = connection.recv()
        except EOFError:
            return
        try:
            found = answer(question, memory)
        except Exception as error:  # noqa: BLE001  # the page tells of it, and the studio goes on
            memory = Memory()
            told = f"unforeseen {type(error).__name__}: {error}"
            found = {"failure": f"{told[:300]}. This is a fault of cyclo, please report it with the drive file"}
        try:
            connection.send(found)
        except OSError:  # nobody waits any more
            return


class Worker:
    """A process that answers one question at a time.

    Parameters
    ----------
    context : multiprocessing context
        That processes are started by.
    """

    def __init__(self, context: Any) -> None:
        self._context = context
        self._process: Any = None
        self._connection: Connection | None = None
        self._number = 0
        self._asking: Question | None = None
        self._lock = asyncio.Lock()
        # A thread of its own waits for the answer: a shared pool could be full of those that wait for slow drives.
        self._waiting = ThreadPoolExecutor(1, thread_name_prefix="answer")

    async def ask(self, question: Question) -> dict[str, Any]:
        """Return the answer; `Superseded` when another question is asked before it is there."""
        self._number += 1
        number = self._number
        if self._lock.locked():
            if question.quality == COARSE:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._free(), PATIENCE)
            if self._lock.locked() and number == self._number:
                self.end()
        async with self._lock:
            if number != self._number:
                raise Superseded
            loop = asyncio.get_running_loop()
            self._asking = question
            try:
                return await loop.run_in_executor(self._waiting, self._asked, question)
            except (EOFError, OSError) as error:
                self.end()
                if number != self._number:
                    raise Superseded from error
                return {"failure": "the process that computes has ended: it was killed, or memory was not enough"}

    async def _free(self) -> None:
        async with self._lock:
            return

    def forget(self, question: Question) -> None:
        """End the process where it answers this question."""
        if self._lock.locked() and self._asking is question:
            self.end()  # and not the one that waits behind it

    def drop(self) -> None:
        """Forget the question that is being answered, if any, and end its process."""
        self._number += 1
        if self._lock.locked():
            self.end()

    def _asked(self, question: Question) -> dict[str, Any]:
        connection = self._connection
        if connection is None or self._process is None or not self._process.is_alive():
            self.end()  # it may be without its fork server alone
            self._process, self._connection = self._started()
            connection = self._connection
        assert connection is not None
        connection.send(question)
        found: dict[str, Any] = connection.recv()
        return found

    def _started(self, trials: int = STARTS) -> tuple[Any, Connection]:
        """Start a process, from a new fork server where the last one was killed just now."""
        connection, other = self._context.Pipe()
        process = self._context.Process(target=_answer_all, args=(other,), daemon=False)
        try:
            process.start()
        except (EOFError, OSError):
            if trials == 1:
                raise
            time.sleep(BETWEEN_STARTS)
            if self._context.get_start_method() == "forkserver":
                make_pool_folder()  # of its socket, if somebody has removed it
            return self._started(trials - 1)
        finally:
            other.close()
        return process, connection

    def end(self) -> None:
        """End the process with what it does."""
        process, self._process = self._process, None
        connection, self._connection = self._connection, None
        if process is not None:
            process.kill()
            # It is waited for where nothing else waits.
            threading.Thread(target=process.join, daemon=True).start()
        del connection  # closed by who reads from it, at its end

    def close(self) -> None:
        """End the process for good."""
        self._number += 1
        self.end()
        self._waiting.shutdown(wait=False, cancel_futures=True)


class Desks:
    """The workers of every tab: one for coarse answers, one for the others."""

    def __init__(self, context: Any) -> None:
        self._context = context
        self._desks: dict[str, tuple[Worker, Worker]] = {}

    async def ask(self, tab: str, question: Question) -> dict[str, Any]:
        """Return the answer for a tab; a coarse question ends what the tab asked before."""
        coarse, fine = self._desk(tab)
        if question.quality == COARSE:
            fine.drop()
            return await coarse.ask(question)
        return await fine.ask(question)

    def _desk(self, tab: str) -> tuple[Worker, Worker]:
        found = self._desks.pop(tab, None) or (Worker(self._context), Worker(self._context))
        self._desks[tab] = found  # the last one asked stands last
        while len(self._desks) > MOST_DESKS:
            self.leave(next(iter(self._desks)))
        return found

    def forget(self, tab: str, question: Question) -> None:
        """End the answer to a question that nobody waits for."""
        for worker in self._desks.get(tab, ()):
            worker.forget(question)

    def leave(self, tab: str) -> None:
        """End the workers of a tab that is closed."""
        for worker in self._desks.pop(tab, ()):
            worker.close()

    def close(self) -> None:
        """End all workers."""
        for tab in list(self._desks):
            self.leave(tab)
