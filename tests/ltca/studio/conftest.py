"""A studio as a program, and who asks it."""

from __future__ import annotations

import http.client
import json
import subprocess
import sys
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


@contextmanager
def studio(drive, folder, *words):
    """Run ``cyclo studio`` in a folder; give its process and address."""
    command = [sys.executable, "-m", "ltca.commands.program", "studio", str(drive), "--no-browser", *words]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        assert "http://" in line, process.stderr.read()
        yield SimpleNamespace(process=process, address=line.split(": ", 1)[1].strip())
    finally:
        process.terminate()
        process.communicate(timeout=300)


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """The studio of the paper's drive in an empty folder."""
    folder = tmp_path_factory.mktemp("studio")
    with studio("paper", folder) as found:
        yield SimpleNamespace(folder=folder, ask=asker(found.address), **vars(found))
