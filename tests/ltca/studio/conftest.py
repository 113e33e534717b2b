"""A studio as a program, and who asks it."""

from __future__ import annotations

import errno
import http.client
import json
import os
import socket
import subprocess
import sys
import tempfile
from contextlib import contextmanager, suppress
from types import SimpleNamespace
from urllib.parse import urlsplit

import pytest


def asker(address):
    """Return a function that asks a path below an address; it gives status, headers and body, a table where it is JSON."""
    parts = urlsplit(address)

    def ask(path="", content=None, *, method=None, headers=None, root=parts.path):
        connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=600)
        try:
            body = None if content is None else content if isinstance(content, bytes) else json.dumps(content)
            given = {} if body is None else {"Content-Type": "application/json"}
            kind = method or ("GET" if body is None else "POST")
            connection.request(kind, root + path, body=body, headers=given | (headers or {}))
            found = connection.getresponse()
            text = found.read()
            with suppress(ValueError):
                text = json.loads(text)
            return SimpleNamespace(status=found.status, headers=dict(found.getheaders()), body=text)
        finally:
            connection.close()

    return ask


def exchanged(address, sent):
    """Send bytes to the server of an address as they are; give all that it answers until it closes.

    Raises
    ------
    TimeoutError
        If it does not close: the client has said that nothing more will come.
    """
    parts = urlsplit(address)
    with socket.create_connection((parts.hostname, parts.port), timeout=300) as connection:
        found = b""
        try:
            connection.sendall(sent)
            connection.shutdown(socket.SHUT_WR)
            while more := connection.recv(65536):
                found += more
        except OSError as error:  # it may close before all is sent
            if not isinstance(error, ConnectionError) and error.errno != errno.ENOTCONN:
                raise
        return found


@contextmanager
def studio(drive, folder, *words, before=(), browser=None):
    """Run ``cyclo studio`` in a folder, behind words of another command, or with a command as browser.

    Give its process, address and a function that reads what it has written to the standard error output.
    """
    command = [*before, sys.executable, "-m", "ltca.commands.program", "studio", str(drive), *words]
    command += [] if browser else ["--no-browser"]
    environment = os.environ | ({"BROWSER": str(browser)} if browser else {})
    with tempfile.TemporaryFile("w+") as complaints:

        def errors():
            complaints.seek(0)
            return complaints.read()

        process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=complaints, text=True, env=environment
        )
        try:
            line = process.stdout.readline()
            assert "http://" in line, errors()
            yield SimpleNamespace(process=process, address=line.split(": ", 1)[1].strip(), errors=errors)
        finally:
            process.terminate()
            process.communicate(timeout=300)


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """The studio of the paper's drive in an empty folder; no request leaves a traceback."""
    folder = tmp_path_factory.mktemp("studio")
    with studio("paper", folder) as found:
        yield SimpleNamespace(folder=folder, ask=asker(found.address), **vars(found))
        assert "Traceback" not in found.errors()
