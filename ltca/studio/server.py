"""The server of the studio: on this machine alone, for who knows its token, of files in one folder."""

from __future__ import annotations

import asyncio
import hmac
import json
import re
import secrets
import socket
import webbrowser
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ltca.drive.names import NAMING, names_a_file
from ltca.errors import CycloError, DriveError, FaultError, shortened
from ltca.output.files import whole_file
from ltca.page.run_page import STAGE
from ltca.page.writing import page_text, script_data
from ltca.studio.answers import CACHED, COARSE, DERIVATIVE, FINE, Question, problem_of
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
LOOKING = 0.25
"""Time, s, between two looks whether who asked is still there."""
COMPLIANCES = (CACHED, "half-space", "hybrid", "fe", "file")
PORTABLE = re.compile(r"[\w .-]+")
"""Names of saved files: signs that no file system refuses or reads in another way, letters of any script among them."""
DEVICE = re.compile(r"(?:con|prn|aux|nul|(?:com|lpt)[0-9¹²³])(?: *\..*)?", re.IGNORECASE)
"""Names that Windows takes for devices, whatever ending they have."""
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
        """Answer a request, or refuse it."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        app = self.app if refusal is None else refusal
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

        await app(scope, receive, sent)

    def _refusal(self, scope: Scope) -> Response | None:
        headers = {name: value.decode("latin-1") for name, value in scope["headers"]}
        _, port = scope["server"]
        hosts = {f"{name}:{port}" for name in (HOST, "localhost")}
        if headers.get(b"host", "") not in hosts:
            return PlainTextResponse("not this host", 421)
        origin = headers.get(b"origin")
        if origin is not None and origin.removeprefix("http://") not in hosts:
            return PlainTextResponse("not from elsewhere", 403)
        given = scope["path"].split("/")[1]
        if not hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode()):
            return PlainTextResponse(
                "the address has no token that is known: take the one that cyclo studio printed", 403
            )
        length = headers.get(b"content-length", "0")
        if not length.isdigit() or int(length) > MOST_BYTES:
            return PlainTextResponse(f"at most {MOST_BYTES} bytes", 413)
        if scope["method"] == "POST" and not headers.get(b"content-type", "").startswith("application/json"):
            return PlainTextResponse("application/json alone", 415)
        return None


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
        self.on_start: Callable[[], None] = lambda: None
        self._page = ""

    @asynccontextmanager
    async def living(self, app: Starlette) -> AsyncIterator[None]:
        """Start what computes, and end it with all jobs."""
        self.desks = Desks(await asyncio.to_thread(start_fork_server))
        self.on_start()
        try:
            yield
        finally:
            self.desks.close()
            await asyncio.to_thread(self.jobs.close)

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
            task.cancel()
            return JSONResponse({"superseded": True})

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
                part.write_text(text, encoding="utf-8")
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
    import uvicorn

    token = secrets.token_urlsafe(24)
    # Named as TCP: asyncio sends small packets of no other socket at once, and each answer would wait for 40 ms.
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listening:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((HOST, port))
            listening.listen(64)  # who has the address may ask before the server looks
        except OSError as error:
            raise FaultError(f"--port {port}: cannot be had: {error.strerror or error}; 0 takes a free one") from error
        address = f"http://{HOST}:{listening.getsockname()[1]}/{token}/"
        config = uvicorn.Config(
            studio.app(token), log_level="error", access_log=False, lifespan="on", ws="none", server_header=False,
            timeout_graceful_shutdown=1,
        )  # fmt: skip
        studio.on_start = lambda: _started(address, browser, told)
        asyncio.run(uvicorn.Server(config).serve(sockets=[listening]))


def _started(address: str, browser: bool, told: Callable[[str], None]) -> None:
    told(address)
    if browser:
        webbrowser.open(address)
