"""Connections of the server: how many, how long until a request is there, and no traceback for what is no HTTP."""

from __future__ import annotations

import asyncio
import sys
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from ltca.errors import printable

MOST_CONNECTIONS = 32
"""Open at the same time: a browser keeps six, and a process of 100 open files has room for them."""
AT_ONCE = 4
"""Connections accepted in one step of the event loop: those over `MOST_CONNECTIONS` are seen one or two steps later."""
HEADER_SECONDS = 10.0
"""Time, s, from a connection or from the end of an answer until the header of a request is there."""


class BoundedConnection(H11Protocol):
    """A connection that is closed when no request comes in time; of too many, the one that has waited longest is closed.

    Connections that are being answered stay: only who knows the token is answered anything that takes time.
    """

    _timer: asyncio.TimerHandle | None = None
    _waits_since = 0.0

    @property
    def waits(self) -> bool:
        """Whether no request is being answered."""
        return self.cycle is None or self.cycle.response_complete

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request; close what is over the number of connections."""
        super().connection_made(transport)
        self._wait()
        kept = [
            one for one in self.connections if isinstance(one, BoundedConnection) and not one.transport.is_closing()
        ]
        if len(kept) > MOST_CONNECTIONS:
            min((one for one in kept if one.waits), key=lambda one: one._waits_since).transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the timer."""
        self._forget_timer()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on; once the header of a request is there, the guard counts the time of its body."""
        super().data_received(data)
        if not self.waits:
            self._forget_timer()

    def on_response_complete(self) -> None:
        """Begin to wait for the next request."""
        super().on_response_complete()
        if self.waits:
            self._wait()

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP, once: of a request that is being answered the answer is dropped."""
        if self.cycle is not None and not self.cycle.response_complete:
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        try:
            super().send_400_response(msg)
        except h11.LocalProtocolError:  # the answer has begun already
            self.transport.abort()

    def _wait(self) -> None:
        self._forget_timer()
        self._waits_since = self.loop.time()
        self._timer = self.loop.call_later(HEADER_SECONDS, self._end)

    def _forget_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _end(self) -> None:
        if self.transport.get_write_buffer_size() > 0:  # the last answer is still being read
            self._timer = self.loop.call_later(HEADER_SECONDS, self._end)
        else:
            self.transport.abort()


def report_in_a_line(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Report an error of the event loop in one line, one of the system, as too many open files, not at all: it recurs.

    For `asyncio.AbstractEventLoop.set_exception_handler`.
    """
    error = context.get("exception")
    if not isinstance(error, OSError):
        print_fault(error if isinstance(error, Exception) else RuntimeError(context.get("message", "")))


def print_fault(error: BaseException) -> str:
    """Report an unforeseen error on the standard error output, and return the line."""
    line = (
        f"unforeseen {type(error).__name__}: {printable(str(error))[:300]}. This is a fault of cyclo, please report it"
    )
    print(f"cyclo: error: {line}", file=sys.stderr, flush=True)
    return line
