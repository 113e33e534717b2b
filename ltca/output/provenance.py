"""Which code made a result: version and a hash of its sources, the same on every machine that has the same code."""

from __future__ import annotations

import ast
import hashlib
import os
import re
import sys
import tomllib
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from ltca.errors import FaultError, PlaceError
from ltca.output.files import whole_file
from ltca.output.regular_files import read_regular

SOURCES = (".py", ".toml", ".json", ".nc")


@cache
def code_version() -> str:
    """Return the version of the installed distribution."""
    return version("cyclo-ltca")


def cache_home() -> Path:
    """Return the folder of what is kept between runs: under ``$XDG_CACHE_HOME`` or ``~/.cache``."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "cyclo"


@cache
def code_hash(*packages: str) -> str:
    """Return a hash of the code of importable packages, by name (hex, 16 digits); nothing is imported.

    It is of relative paths and of what the files mean: the syntax tree of modules without docstrings, the content of TOML files,
    the bytes of others. Comments, docstrings and the place of the package change nothing; a package that is not installed
    counts by its absence.
    """
    digest = hashlib.sha256()
    for package in packages:
        spec = find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            digest.update(f"{package} is not installed".encode())
            continue
        digest.update(f"{package}\0{_package_hash(Path(next(iter(spec.submodule_search_locations))))}".encode())
    return digest.hexdigest()[:16]


def _package_hash(root: Path) -> str:
    """Return the hash of a package, kept in the cache under that of its bytes: parsing takes most of a second."""
    found = {path.relative_to(root).as_posix(): path for path in root.rglob("*") if path.suffix in SOURCES}
    sources = {name: path.read_bytes() for name, path in sorted(found.items()) if path.is_file()}
    # The content is the key, not the time of a file, so a kept answer cannot be that of other sources. Python and this file
    # are in it because they say how a tree is hashed.
    raw = _hash_of(
        {"python": sys.version.encode(), "this file": Path(__file__).read_bytes(), **sources},
    )
    with suppress(OSError, RuntimeError, ValueError):  # no home, no such file, no text
        kept = read_regular(cache_home() / "code" / raw, 64).decode("ascii")
        if re.fullmatch("[0-9a-f]{64}", kept):
            return kept
    answer = _hash_of({name: _meaning(name, content) for name, content in sources.items()})
    with suppress(FaultError, PlaceError, RuntimeError), whole_file(cache_home() / "code" / raw) as part:
        part.write_text(answer, encoding="ascii", newline="\n")
    return answer


def _hash_of(contents: dict[str, bytes]) -> str:
    digest = hashlib.sha256()
    for name, content in contents.items():
        digest.update(f"{name}\0{len(content)}\0".encode())
        digest.update(content)
    return digest.hexdigest()


def _meaning(name: str, content: bytes) -> bytes:
    """Return what a file means, without comments and docstrings."""
    try:
        if name.endswith(".py"):
            return "\0".join(_words(ast.parse(content))).encode(errors="surrogatepass")
        if name.endswith(".toml"):
            return repr(tomllib.loads(content.decode())).encode()
    except (SyntaxError, ValueError):  # a template, or damaged: then its bytes count
        pass
    return content


def _words(node: ast.AST) -> Iterator[str]:
    """Give the syntax tree below a node; what is empty is left out, so a field that a later Python adds changes nothing."""
    yield type(node).__name__
    for name, value in ast.iter_fields(node):
        if isinstance(value, list):
            parts = [part for part in value if not (_is_docstring(part) or _is_empty_text(node, part))]
            if parts:
                yield f"{name}[{len(parts)}]"
        elif value is not None:
            parts = [value]
            yield name
        else:
            continue
        for part in parts:
            if isinstance(part, ast.AST):
                yield from _words(part)
            else:
                yield repr(part)


def _is_docstring(part: object) -> bool:
    """Tell a text that stands alone: of a module, class, function or, after an assignment, of a variable."""
    return isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant) and isinstance(part.value.value, str)


def _is_empty_text(node: ast.AST, part: object) -> bool:
    """Tell the empty text that Python 3.12 puts behind a nested format, `{x:{width}}`."""
    return isinstance(node, ast.JoinedStr) and isinstance(part, ast.Constant) and part.value == ""
