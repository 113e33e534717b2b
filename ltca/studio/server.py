"""The server of the studio: on this machine alone, for who knows its token, of files in one folder."""

from __future__ import annotations

import asyncio
import hmac
import html
import json
import os
import re
import secrets
import socket
import webbrowser
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager, nullcontext, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ltca.drive.names import NAMING, names_a_file
from ltca.errors import CycloError, DriveError, FaultError, shortened
from ltca.output.file_names import DEVICE
from ltca.output.files import whole_file
from ltca.page.run_page import STAGE
from ltca.page.writing import page_text, script_data
from ltca.studio.answers import CACHED, COARSE, DERIVATIVE, FINE, Question, problem_of
from ltca.studio.connections import AT_ONCE, BoundedConnection, print_fault, report_in_a_line
from ltca.studio.entries import (
    changed_entries,
    declared_entries,
    with_named_entry,
    without_named_entry,
    written_entries,
)
from ltca.studio.jobs import Jobs, exports
from ltca.studio.sections import declarations, files_elsewhere, written_values
from ltca.studio.workers import Desks, Superseded, start_fork_server

HOST = "127.0.0.1"
MOST_BYTES = 4_000_000
"""Of a question; a drive file of many cases has some hundred thousand."""
MOST_HEADER_BYTES, MOST_TARGET_BYTES = 16_384, 2_048
"""Of the header of a question, and of its address; those of a browser have some hundred."""
BODY_SECONDS = 20.0
"""Time, s, in which a question has to be there behind its header."""
QUEUED = 64
"""Connections that the system keeps until the server accepts them."""
LOOKING = 0.25
"""Time, s, between two looks whether who asked is still there."""
COMPLIANCES = (CACHED, "half-space", "hybrid", "fe", "file")
PORTABLE = re.compile(r"[\w .-]+")
"""Names of saved files: signs that no file system refuses or reads in another way, letters of any script among them."""
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "X-Frame-Options": "DENY",
    "Cache-Control": "no-store",
}
POLICY = "default-src 'none'; frame-ancestors 'none'"
"""Of what is no page; a page says in itself what it runs, by hashes."""
PAGE_POLICY = "frame-ancestors 'none'; form-action 'none'; base-uri 'none'"
SHOWN = {
    ".html": "text/html; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".txt": "text/plain; charset=utf-8",
}
"""Files of jobs that a browser shows; others it saves."""


class Guard:
    """Lets through who names this server as the host and knows the token, and nobody else.

    Parameters
    ----------
    app : ASGI application
        Behind it.
    token : str
        First part of every path.
    """

    def __init__(self, app: ASGIApp, token: str) -> None:
        self.app, self.token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it; what goes wrong is one line."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        started = False

        async def sent(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start" and not started:
                started = True
                given = {name.lower() for name, _ in message["headers"]}
                policy = {"Content-Security-Policy": POLICY}
                added = [(n.lower().encode(), v.encode()) for n, v in (HEADERS | policy).items()]
                message["headers"] = [*message["headers"], *(one for one in added if one[0] not in given)]
            await send(message)

        app = self._refusal(scope) or await _with_body(self.app, receive)
        if app is None:  # who asked has gone
            return
        try:
            await app(scope, receive, sent)
        except asyncio.CancelledError:
            if not started:
                await _refused("the studio ends", 503)(scope, receive, sent)
        except Exception as error:  # noqa: BLE001  # the server goes on
            line = print_fault(error)
            if not started:
                await _refused(line, 500)(scope, receive, sent)

    def _refusal(self, scope: Scope) -> Response | None:
        headers = {name: value.decode("latin-1") for name, value in scope["headers"]}
        if sum(len(name) + len(value) for name, value in scope["headers"]) > MOST_HEADER_BYTES:
            return _refused(f"at most {MOST_HEADER_BYTES} bytes of header", 431)
        if len(scope.get("raw_path") or b"") + len(scope["query_string"]) > MOST_TARGET_BYTES:
            return _refused(f"at most {MOST_TARGET_BYTES} bytes of address", 414)
        _, port = scope["server"]
        hosts = {f"{name}:{port}" for name in (HOST, "localhost")}
        if headers.get(b"host", "") not in hosts:
            return _refused("not this host", 421)
        origin = headers.get(b"origin")
        if origin is not None and origin.removeprefix("http://") not in hosts:
            return _refused("not from elsewhere", 403)
        if not scope["path"].startswith("/"):  # "OPTIONS *", "CONNECT host:port"
            return _refused("an address begins with /", 400)
        given = scope["path"].split("/")[1]
        if not hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode()):
            return _refused("the address has no token that is known: take the one that cyclo studio printed", 403)
        length = headers.get(b"content-length", "0")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            return _refused(f"at most {MOST_BYTES} bytes", 413)
        if scope["method"] == "POST" and not headers.get(b"content-type", "").startswith("application/json"):
            return _refused("application/json alone", 415)
        return None


def _refused(reason: str, status: int) -> Response:
    """A refusal that closes the connection: the rest of the request is not read."""
    return PlainTextResponse(reason, status, headers={"Connection": "close"})


async def _with_body(app: ASGIApp, receive: Receive) -> ASGIApp | None:
    """The application with the whole body of the request, or a refusal; None where who asks has gone.

    Nothing says beforehand how long a body in chunks is, nor when it ends.
    """
    body = bytearray()
    try:
        async with asyncio.timeout(BODY_SECONDS):
            more = True
            while more:
                message = await receive()
                if message["type"] != "http.request":
                    return None
                body += message.get("body", b"")
                if len(body) > MOST_BYTES:
                    return _refused(f"at most {MOST_BYTES} bytes", 413)
                more = message.get("more_body", False)
    except TimeoutError:
        return _refused(f"the question was not there within {BODY_SECONDS:g} s", 408)
    whole: Message | None = {"type": "http.request", "body": bytes(body), "more_body": False}

    async def received() -> Message:
        nonlocal whole
        message, whole = whole, None
        return await receive() if message is None else message

    async def answered(scope: Scope, _: Receive, send: Send) -> None:
        await app(scope, received, send)

    return answered


class Studio:
    """What the addresses do.

    Parameters
    ----------
    text, source, case : str
        Of the drive file that a new page starts with.
    folder : Path
        That everything is read from and written to.
    """

    def __init__(self, text: str, source: str, case: str, folder: Path) -> None:
        self.text, self.source, self.case, self.folder = text, source, case, folder.resolve()
        self.jobs = Jobs(self.folder)
        self.desks: Desks | None = None
        self._page = ""

    @asynccontextmanager
    async def living(self, app: Starlette) -> AsyncIterator[None]:
        """Start what computes, and end it with all jobs."""
        self.desks = Desks(await asyncio.to_thread(start_fork_server))
        try:
            yield
        finally:
            self.end_answers()
            await asyncio.to_thread(self.jobs.close)

    def end_answers(self) -> None:
        """End what computes answers; who waits for one is told that it is superseded."""
        if self.desks is not None:
            self.desks.close()

    def app(self, token: str) -> ASGIApp:
        """Return the application behind its guard."""
        routes = [
            Route(f"/{token}/", self.page),
            Route(f"/{token}/edit", self.edit, methods=["POST"]),
            Route(f"/{token}/answer", self.answer, methods=["POST"]),
            Route(f"/{token}/save", self.save, methods=["POST"]),
            Route(f"/{token}/leave", self.leave, methods=["POST"]),
            Route(f"/{token}/jobs", self.told_jobs),
            Route(f"/{token}/jobs", self.start_job, methods=["POST"]),
            Route(f"/{token}/jobs/{{number:int}}/cancel", self.cancel_job, methods=["POST"]),
            Route(f"/{token}/files/{{path:path}}", self.file),
        ]
        return Guard(Starlette(routes=routes, lifespan=self.living), token)

    async def page(self, request: Request) -> Response:
        """Return the page."""
        if not self._page:
            first = {
                "declared": declarations(),
                "named": declared_entries(),
                "text": self.text,
                "case": self.case,
                "source": self.source,
                "exports": exports(),
            }
            context = {
                "title": "cyclo studio", "data": script_data(first), "several": False, "sliced": True, "positions": 0,
                "thinned": 0,
            }  # fmt: skip
            self._page = page_text(
                "studio.html", context, scripts=(*STAGE, "state", "fields", "results", "work", "studio"),
                styles=("studio",), package="ltca.studio", live=True,
            )  # fmt: skip
        return HTMLResponse(self._page, headers={"Content-Security-Policy": PAGE_POLICY})

    async def edit(self, request: Request) -> Response:
        """Return the text with changes, and what it has written."""

        def changed(asked: Mapping[str, Any]) -> dict[str, Any]:
            text, case, changes = _text(asked), _word(asked, "case"), asked.get("changes", {})
            if not isinstance(changes, dict) or not all(isinstance(one, str) for one in changes.values()):
                raise DriveError(["changes: must be texts by field"])
            if table := _word(asked, "entry"):
                text = with_named_entry(text, table, _word(asked, "key"), _word(asked, "value"))
            if path := _word(asked, "remove"):
                text = without_named_entry(text, path)
            text = changed_entries(text, case, changes)
            found, entries = written_values(text, case), written_entries(text)
            return {"text": text, **found, **entries, "values": found["values"] | entries["values"]}

        return await _answered(request, changed)

    async def answer(self, request: Request) -> Response:
        """Return what the text gives; ``superseded`` when the tab has asked something else before it was there."""
        try:
            asked = await _asked(request)
            question, tab = self._question(asked), _word(asked, "tab")
            told = files_elsewhere(question.text, self.folder / question.source)
            if told:
                raise DriveError(told)
        except CycloError as error:
            return JSONResponse(_mistakes(error))
        assert self.desks is not None
        task = asyncio.ensure_future(self.desks.ask(tab, question))
        try:
            while not task.done():
                await asyncio.wait([task], timeout=LOOKING)
                if not task.done() and await request.is_disconnected():
                    self.desks.forget(tab, question)
                    raise Superseded
            return JSONResponse(task.result())
        except Superseded:
            return JSONResponse({"superseded": True})
        finally:
            task.cancel()

    def _question(self, asked: Mapping[str, Any]) -> Question:
        quality, compliance = _word(asked, "quality"), _word(asked, "compliance") or "half-space"
        if quality not in (COARSE, FINE, DERIVATIVE):
            raise DriveError([f"quality = {shortened(quality)}: must be {COARSE}, {FINE} or {DERIVATIVE}"])
        if compliance not in COMPLIANCES:
            raise DriveError([f"compliance = {shortened(compliance)}: must be one of {', '.join(COMPLIANCES)}"])
        return Question(
            text=_text(asked), source=self.source, case=_word(asked, "case"), quality=quality, compliance=compliance,
            field=_word(asked, "field"),
        )  # fmt: skip

    async def leave(self, request: Request) -> Response:
        """End the workers of a tab."""
        with suppress(CycloError):
            tab = _word(await _asked(request), "tab")
            if self.desks is not None:
                self.desks.leave(tab)
        return JSONResponse({})

    async def save(self, request: Request) -> Response:
        """Write the text into the folder of the studio."""

        def saved(asked: Mapping[str, Any]) -> dict[str, Any]:
            text, name = _text(asked), _word(asked, "name").removesuffix(".toml")
            if not names_a_file(name) or name.startswith("."):
                raise DriveError([f"name = {shortened(name)}: {NAMING}"])
            if told := _not_everywhere(name):
                raise DriveError([f"name = {shortened(name)}: {told}"])
            path = self.folder / f"{name}.toml"
            if path.is_symlink() or (path.exists() and not path.is_file()):
                raise FaultError(f"{path.name}: is no file of its own; take another name")
            if path.exists() and asked.get("overwrite") is not True:
                return {"exists": path.name}
            with whole_file(path) as part:
                part.write_text(text, encoding="utf-8", newline="\n")
            return {"saved": path.name}

        return await _answered(request, saved)

    async def told_jobs(self, request: Request) -> Response:
        """Return all jobs."""
        return JSONResponse({"jobs": await asyncio.to_thread(self.jobs.told)})

    async def start_job(self, request: Request) -> Response:
        """Start a job."""

        def started(asked: Mapping[str, Any]) -> dict[str, Any]:
            text, job = _text(asked), asked.get("job")
            if not isinstance(job, dict):
                raise DriveError(["job: must be what is to be done"])
            if told := files_elsewhere(text, self.folder / self.source):
                raise DriveError(told)
            return {"number": self.jobs.start(job, text, self.source, _word(asked, "case"))}

        return await _answered(request, started)

    async def cancel_job(self, request: Request) -> Response:
        """End a job."""
        return JSONResponse({"cancelled": self.jobs.cancel(int(request.path_params["number"]))})

    async def file(self, request: Request) -> Response:
        """Return a file that a job wrote."""
        found = self.jobs.file(str(request.path_params["path"]))
        if found is None:
            return PlainTextResponse("no file of a job", 404)
        kind = SHOWN.get(found.suffix)
        if kind is None:
            return FileResponse(found, filename=found.name, media_type="application/octet-stream")
        policy = PAGE_POLICY if found.suffix == ".html" else POLICY
        return FileResponse(
            found,
            media_type=kind,
            headers={"Content-Security-Policy": f"sandbox allow-scripts allow-downloads; {policy}"},
        )


async def _asked(request: Request) -> dict[str, Any]:
    try:
        found = json.loads(await request.body())
        json.dumps(found, ensure_ascii=False).encode()
    except UnicodeEncodeError as error:  # "\\ud800" alone, which no answer could repeat
        raise HTTPException(400, "the question has half of a surrogate pair, which is no character") from error
    except (ValueError, RecursionError) as error:
        raise DriveError(["the question is no JSON"]) from error
    if not isinstance(found, dict):
        raise DriveError(["the question must be a table"])
    return found


async def _answered(request: Request, action: Callable[[Mapping[str, Any]], dict[str, Any]]) -> Response:
    """What an action answers, or the mistakes in what it was asked."""
    try:
        return JSONResponse(action(await _asked(request)))
    except CycloError as error:
        return JSONResponse(_mistakes(error))


def _mistakes(error: CycloError) -> dict[str, Any]:
    problems = error.problems if isinstance(error, DriveError) else (str(error),)
    return {"problems": [problem_of(one) for one in problems]}


def _not_everywhere(name: str) -> str:
    """Why a name cannot name a file on any system; empty where it can."""
    if not PORTABLE.fullmatch(name):
        return "must have only letters, digits, spaces and . _ -, which any system takes"
    if name != name.strip() or name.endswith("."):
        return "must not begin or end with a space, nor end with a dot: Windows leaves them out"
    if name.startswith("-"):
        return "must not begin with -: commands would take it for an option"
    if DEVICE.fullmatch(name):
        return "must not be the name of a device of Windows (con, prn, aux, nul, com1, lpt1, …)"
    return ""


def _word(asked: Mapping[str, Any], name: str) -> str:
    value = asked.get(name, "")
    if not isinstance(value, str) or len(value) > 300:
        raise DriveError([f"{name} = {shortened(value)}: must be a short text"])
    return value


def _text(asked: Mapping[str, Any]) -> str:
    value = asked.get("text")
    if not isinstance(value, str):
        raise DriveError(["text: must be that of a drive file"])
    return value


def serve(studio: Studio, port: int, *, browser: bool, told: Callable[[str], None]) -> None:
    """Serve a studio until it is interrupted.

    Parameters
    ----------
    studio : Studio
        What is served.
    port : int
        Of this machine; 0 takes a free one.
    browser : bool
        Whether a browser is opened.
    told : callable
        Given the address once it can be asked.

    Raises
    ------
    FaultError
        When the port is taken.
    """
    token = secrets.token_urlsafe(24)
    # Named as TCP: asyncio sends small packets of no other socket at once, and each answer would wait for 40 ms.
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listening:
        # On Windows SO_REUSEADDR would share a port with whoever has it.
        option = getattr(socket, "SO_EXCLUSIVEADDRUSE", socket.SO_REUSEADDR)
        listening.setsockopt(socket.SOL_SOCKET, option, 1)
        try:
            listening.bind((HOST, port))
            listening.listen(QUEUED)  # who has the address may ask before the server looks
        except OSError as error:
            raise FaultError(f"--port {port}: cannot be had: {error.strerror or error}; 0 takes a free one") from error
        address = f"http://{HOST}:{listening.getsockname()[1]}/{token}/"
        config = uvicorn.Config(
            studio.app(token), log_level="error", access_log=False, lifespan="on", ws="none", server_header=False,
            timeout_graceful_shutdown=1, http=BoundedConnection, h11_max_incomplete_event_size=MOST_HEADER_BYTES,
            backlog=AT_ONCE,
        )  # fmt: skip
        with forwarding_file(address) if browser else nullcontext() as page:

            def started() -> None:
                listening.listen(QUEUED)
                told(address)
                if page is not None:
                    webbrowser.open(page.as_uri())

            asyncio.run(_Server(config, started, studio.end_answers).serve(sockets=[listening]))


class _Server(uvicorn.Server):
    """Calls a function once requests are accepted, and another one before it ends."""

    def __init__(self, config: uvicorn.Config, started: Callable[[], None], ending: Callable[[], None]) -> None:
        super().__init__(config)
        self._on_start, self._on_end = started, ending

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        asyncio.get_running_loop().set_exception_handler(report_in_a_line)
        await super().startup(sockets)
        self._on_start()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self._on_end()
        await super().shutdown(sockets)


@contextmanager
def forwarding_file(address: str) -> Iterator[Path]:
    """Give a page that forwards to an address, which only this user can read; it is removed at the end of the block.

    Command lines can be read by every user of a machine: one that opens the address itself shows the token.
    """
    with TemporaryDirectory(prefix="cyclo-studio-", ignore_cleanup_errors=True) as folder:  # of mode 0700
        page = Path(folder) / "studio.html"
        descriptor = os.open(page, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
        escaped = html.escape(address)
        with open(descriptor, "w", encoding="utf-8", newline="\n") as file:
            file.write(
                '<!doctype html><meta charset="utf-8"><meta name="referrer" content="no-referrer"><title>cyclo studio</title>'
                f'<meta http-equiv="refresh" content="0; url={escaped}"><a href="{escaped}">cyclo studio</a>\n'
            )
        yield page
