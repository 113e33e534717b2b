"""What only Linux has is used behind a question for it, and texts are written in one encoding with one end of lines."""

from __future__ import annotations

import ast
import re
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGES = ("ltca", "fem", "validation")
FILES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


@cache
def nodes():
    """Return every node of every file in which something that is looked for can stand, by its path in the repository."""
    texts = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in FILES}
    return {name: list(ast.walk(ast.parse(text))) for name, text in texts.items() if POSSIBLE.search(text)}


def lacking():
    """Return the tables of `sitecustomize`, which is not installed by that: modules, and names by their module."""
    spec = spec_from_file_location("tables_of_windows", HERE / "sitecustomize.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.MODULES, module.NAMES


MODULES, NAMES = lacking()
POSSIBLE = re.compile(
    rf"(?:import|from) (?:{'|'.join(MODULES | NAMES.keys())})\b|_text\(|open\(|[\"'](?:/proc|/dev|/sys|/tmp|/var|/etc)"
)
SYSTEMS = ("win32", "darwin", "nt", "forkserver")
"""Values that code asks for which system it is on."""
PLACES = ("/proc", "/dev/shm", "/sys/", "/tmp", "/var/", "/etc/")
"""Beginnings of paths that other systems have not."""
ASKED_FOR = {
    ("ltca/output/resources.py", "/sys/"): "looked for, and left out where it is missing",
    ("ltca/output/process_pools.py", "/tmp"): "of sockets of a fork server, looked for",
    ("ltca/output/process_pools.py", "/dev/shm"): "named in a message of the system that has it",
}
"""Paths of one system that stand in the code, and why."""


def asks(node):
    """Whether an expression asks for a system, or whether a name is there."""
    for one in ast.walk(node):
        if isinstance(one, ast.Call) and isinstance(one.func, ast.Name) and one.func.id == "hasattr":
            return True
        if isinstance(one, ast.Constant) and one.value in SYSTEMS:
            return True
    return False


def leaves(body):
    return bool(body) and isinstance(body[-1], ast.Return | ast.Raise | ast.Continue)


def unguarded(tree):
    """Yield line and name of what Windows lacks, where no `if`, early end or `except ImportError` stands before it."""

    def walk(node, guarded):
        if not guarded:
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                if node.attr in NAMES.get(node.value.id, ()):
                    yield node.lineno, f"{node.value.id}.{node.attr}"
            elif isinstance(node, ast.Import):
                yield from ((node.lineno, one.name) for one in node.names if one.name.partition(".")[0] in MODULES)
            elif isinstance(node, ast.ImportFrom):
                if (node.module or "").partition(".")[0] in MODULES:
                    yield node.lineno, node.module
                missing = NAMES.get(node.module or "", ())
                yield from ((node.lineno, f"{node.module}.{one.name}") for one in node.names if one.name in missing)
        if isinstance(node, ast.If | ast.IfExp) and asks(node.test):
            yield from walk(node.test, guarded)
            for part in (node.body, node.orelse):
                for one in part if isinstance(part, list) else [part]:
                    yield from walk(one, True)
            return
        if isinstance(node, ast.Try) and any("ImportError" in ast.unparse(one.type or node) for one in node.handlers):
            yield from (found for one in node.body for found in walk(one, True))
            # What was imported there is used behind it.
            yield from (
                found for one in (*node.handlers, *node.orelse, *node.finalbody) for found in walk(one, guarded)
            )
            return
        for _, value in ast.iter_fields(node):
            before = guarded
            for one in value if isinstance(value, list) else [value]:
                if isinstance(one, ast.AST):
                    yield from walk(one, before)
                    before = before or (isinstance(one, ast.If) and asks(one.test) and leaves(one.body))

    yield from walk(tree, False)


def test_nothing_that_windows_lacks_is_used_without_a_question():
    found = [f"{path}:{line}: {name}" for path, (tree, *_) in nodes().items() for line, name in unguarded(tree)]
    assert not found


@pytest.mark.parametrize(
    ("code", "name"),
    [
        ("import os\nos.killpg(1, 2)", "os.killpg"),
        ("import fcntl", "fcntl"),
        ("def f():\n    if x:\n        return\n    signal.alarm(1)", "signal.alarm"),
        ("from multiprocessing import forkserver", "multiprocessing.forkserver"),
        ("if hasattr(os, 'fork'):\n    os.fork()", ""),
        ("def f():\n    if not hasattr(os, 'fork'):\n        return\n    os.fork()", ""),
        ("try:\n    import fcntl\nexcept ImportError:\n    pass", ""),
        ("x = os.getuid() if os.name != 'nt' else 0", ""),
    ],
)
def test_what_is_used_without_a_question_is_found(code, name):
    assert [found for _, found in unguarded(ast.parse(code))] == ([name] if name else [])


def test_no_path_of_one_system_is_taken_for_granted():
    found = set()
    for path, every in nodes().items():
        texts = {id(node.value) for node in every if isinstance(node, ast.Expr)}  # docstrings
        for node in every:
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in texts:
                found |= {(path, place) for place in PLACES if node.value.startswith(place)}
    assert found == set(ASKED_FOR)


def writes_text(call):
    """Whether a call writes a text file: ``write_text``, or ``open`` in a mode of text that writes."""
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    if name == "write_text":
        return True
    modes = [one.value for one in call.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    return name == "open" and any(set(mode) & set("wax") and "b" not in mode and len(mode) < 4 for mode in modes)


def test_texts_are_written_with_one_encoding_and_one_end_of_lines():
    """Windows would write cp1252, and two signs at the end of a line: other bytes from the same input."""
    wanted = {"encoding", "newline"}
    found = [
        f"{path}:{node.lineno}"
        for path, every in nodes().items()
        for node in every
        if isinstance(node, ast.Call) and writes_text(node) and not wanted <= {one.arg for one in node.keywords}
    ]
    assert not found


def test_texts_are_read_with_their_encoding():
    found = [
        f"{path}:{node.lineno}"
        for path, every in nodes().items()
        for node in every
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "read_text"
        and not node.args
        and "encoding" not in {one.arg for one in node.keywords}
    ]
    assert not found
