"""Connections of the studio that say nothing, too little or too much, and what the guard takes of them; no drive is computed."""

from __future__ import annotations

import asyncio
import stat
from contextlib import asynccontextmanager, suppress
from types import SimpleNamespace

import pytest

with suppress(ImportError):  # the marker skips every test where the extra is missing
    import uvicorn
    from starlette.responses import PlainTextResponse

    from ltca.studio import connections, server

pytestmark = pytest.mark.needs("studio")


async def hello(scope, receive, send):
    await PlainTextResponse("hello")(scope, receive, send)


async def failing(scope, receive, send):
    raise ZeroDivisionError("of an application")


@asynccontextmanager
async def served(app=hello):
    """A server of connections with a guard whose token is "token"; gives a function that connects, and all connections."""
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda loop, context: pytest.fail(str(context)))
    config = uvicorn.Config(
        server.Guard(app, "token"), log_level="error", ws="none", lifespan="off", http=connections.BoundedConnection
    )
    config.load()
    state = uvicorn.server.ServerState()
    listening = await loop.create_server(
        lambda: connections.BoundedConnection(config=config, server_state=state, app_state={}), server.HOST, 0
    )
    port = listening.sockets[0].getsockname()[1]
    writers = []

    async def connect(sent=b""):
        reader, writer = await asyncio.open_connection(server.HOST, port)
        writers.append(writer)
        writer.write(sent)
        await writer.drain()
        return reader, writer

    async with listening:
        yield SimpleNamespace(
            connect=connect,
            open=state.connections,
            get=f"GET /token/ HTTP/1.1\r\nHost: {server.HOST}:{port}\r\n".encode(),
            post=f"POST /token/ HTTP/1.1\r\nHost: {server.HOST}:{port}\r\nContent-Type: application/json\r\n".encode(),
        )
        for one in list(state.connections):
            one.transport.abort()
        for writer in writers:
            writer.close()
            with suppress(ConnectionError):
                await writer.wait_closed()


LONGEST = 300.0
"""Time, s, that a busy machine may take to answer; nothing waits as long where all is well."""


async def until(condition):
    async with asyncio.timeout(LONGEST):
        while not condition():
            await asyncio.sleep(0.002)


async def all_of(reader):
    try:
        return await asyncio.wait_for(reader.read(), LONGEST)
    except ConnectionError:
        return b""


@pytest.mark.parametrize("sent", ["", "half a header", "a request, then half a header"])
def test_a_half_open_connection_is_closed_in_time(sent, monkeypatch):
    monkeypatch.setattr(connections, "HEADER_SECONDS", 0.05)

    async def test():
        async with served() as own:
            parts = {"": b"", "half a header": own.get, "a request, then half a header": own.get + b"\r\n" + own.get}
            reader, _ = await own.connect(parts[sent])
            found = await all_of(reader)
            assert found.count(b"hello") == sent.startswith("a request")
            await until(lambda: not own.open)

    asyncio.run(test())


def test_of_too_many_connections_the_oldest_that_waits_is_closed(monkeypatch):
    monkeypatch.setattr(connections, "MOST_CONNECTIONS", 3)
    held = asyncio.Event()

    async def holding(scope, receive, send):
        await held.wait()
        await hello(scope, receive, send)

    async def test():
        async with served(holding) as own:
            answered, _ = await own.connect(own.get + b"Connection: close\r\n\r\n")
            await until(lambda: any(not one.waits for one in own.open))
            silent = [(await own.connect())[0] for _ in range(12)]
            for reader in silent[:-2]:
                assert await all_of(reader) == b""
            await until(lambda: len(own.open) == 3)
            held.set()
            assert (await all_of(answered)).endswith(b"hello")

    asyncio.run(test())


def test_a_body_in_chunks_has_a_bound(monkeypatch):
    """One of 794 MB was taken into memory."""
    monkeypatch.setattr(server, "MOST_BYTES", 1000)

    async def test():
        async with served() as own:
            chunked = own.post + b"Transfer-Encoding: chunked\r\n\r\n"
            reader, _ = await own.connect(chunked + 11 * (b"64\r\n" + 100 * b"a" + b"\r\n"))
            assert (await all_of(reader)).startswith(b"HTTP/1.1 413 ")
            reader, _ = await own.connect(chunked + 10 * (b"64\r\n" + 100 * b"a" + b"\r\n") + b"0\r\n\r\n")
            assert (await asyncio.wait_for(reader.readuntil(b"hello"), LONGEST)).startswith(b"HTTP/1.1 200 ")

    asyncio.run(test())


@pytest.mark.parametrize("length", [b"Content-Length: 9\r\n\r\n{", b"Transfer-Encoding: chunked\r\n\r\n1\r\n{"])
def test_a_body_that_does_not_come_is_refused_in_time(length, monkeypatch):
    monkeypatch.setattr(server, "BODY_SECONDS", 0.05)

    async def test():
        async with served() as own:
            reader, _ = await own.connect(own.post + length)
            assert (await all_of(reader)).startswith(b"HTTP/1.1 408 ")

    asyncio.run(test())


def test_a_body_without_the_token_is_not_waited_for():
    async def test():
        async with served() as own:
            reader, _ = await own.connect(own.post.replace(b"/token/", b"/other/") + b"Content-Length: 9\r\n\r\n")
            assert (await all_of(reader)).startswith(b"HTTP/1.1 403 ")

    asyncio.run(test())


@pytest.mark.parametrize(
    ("more", "status"),
    [(b"X: " + 20_000 * b"a" + b"\r\n\r\n", b"431"), (b"Host: twice\r\n\r\n", b"400"), (b"X: \x00\r\n\r\n", b"400")],
)
def test_headers_have_bounds(more, status):
    async def test():
        async with served() as own:
            reader, _ = await own.connect(own.get + more)
            assert (await all_of(reader)).split()[1] == status
            reader, _ = await own.connect(own.get.replace(b"/token/", b"/token/" + 3000 * b"a") + b"\r\n")
            assert (await all_of(reader)).split()[1] == b"414"

    asyncio.run(test())


@pytest.mark.parametrize(
    "line", [b"OPTIONS * ", b"GET abc ", b"CONNECT 127.0.0.1:80 ", b"GET http://127.0.0.1/token/ "]
)
def test_an_address_that_is_no_path_is_refused(line, capfd):
    """It was answered with status 500 and a traceback."""

    async def test():
        async with served() as own:
            reader, _ = await own.connect(own.get.replace(b"GET /token/ ", line) + b"\r\n")
            assert (await all_of(reader)).startswith(b"HTTP/1.1 400 ")

    asyncio.run(test())
    assert capfd.readouterr().err == ""


def test_a_body_that_is_no_http_leaves_no_traceback(capfd):
    """The application answered a connection that had been refused already."""

    async def test():
        async with served() as own:
            reader, _ = await own.connect(own.post + b"Transfer-Encoding: chunked\r\n\r\n")
            await until(lambda: any(not one.waits for one in own.open))
            (one,) = own.open
            one.data_received(b"xyz\r\n")
            assert (await all_of(reader)).startswith(b"HTTP/1.1 400 ")

    asyncio.run(test())
    assert capfd.readouterr().err == ""


def test_who_goes_before_the_body_is_there_leaves_no_traceback(capfd):
    async def test():
        async with served() as own:
            _, writer = await own.connect(own.post + b"Content-Length: 9\r\n\r\n{")
            await until(lambda: any(not one.waits for one in own.open))
            writer.transport.abort()
            await until(lambda: not own.open)

    asyncio.run(test())
    assert capfd.readouterr().err == ""


def test_an_unforeseen_error_is_one_line(capfd):
    async def test():
        async with served(failing) as own:
            reader, _ = await own.connect(own.get + b"\r\n")
            assert (await all_of(reader)).startswith(b"HTTP/1.1 500 ")

    asyncio.run(test())
    assert capfd.readouterr().err == (
        "cyclo: error: unforeseen ZeroDivisionError: of an application. This is a fault of cyclo, please report it\n"
    )


def test_errors_of_the_system_leave_no_traceback(capfd):
    """Each connection beyond the open files of the process left one: 50 MB in a minute."""

    async def test():
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(connections.report_in_a_line)
        for error in (OSError(24, "Too many open files"), ValueError("other\nlines")):
            loop.call_exception_handler({"message": "socket.accept() out of system resource", "exception": error})

    asyncio.run(test())
    assert capfd.readouterr().err == (
        "cyclo: error: unforeseen ValueError: other lines. This is a fault of cyclo, please report it\n"
    )


def test_the_file_that_forwards_with_the_token_is_read_by_its_user_alone():
    address = "http://127.0.0.1:1234/a-token/"
    with server.forwarding_file(address) as page:
        assert stat.S_IMODE(page.stat().st_mode) == 0o600
        assert stat.S_IMODE(page.parent.stat().st_mode) == 0o700
        assert f'http-equiv="refresh" content="0; url={address}"' in page.read_text(encoding="utf-8")
        assert "a-token" not in page.as_uri()
    assert not page.parent.exists()
