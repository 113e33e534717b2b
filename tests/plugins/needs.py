"""What a test needs beyond ``.[test]``: an extra of ``pyproject.toml`` or a program of `PROGRAMS`.

``@pytest.mark.needs("docs")`` skips a test where one of its needs is missing, with the line that installs it; a need that is
neither is an error. ``-m needs`` runs the tests that need anything, ``-m "not needs"`` those that run after the README's line.
With ``--all-needs`` a test whose needs are missing fails instead of being skipped, where all are meant to be installed.

An extra is there when every distribution that it lists is installed, and those that a distribution lists in brackets
(`dask[distributed]`).
"""

from __future__ import annotations

import re
import shutil
import tomllib
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS: dict[str, tuple[str, tuple[str, ...], str]] = {
    "calculix": ("CalculiX", ("ccx",), "calculix-ccx"),
    "chromium": ("chromium", ("chromium", "chromium-browser", "google-chrome"), "chromium"),
    "compiler": ("a C compiler", ("cc", "gcc", "clang"), "gcc"),
}
"""Programs of other people by the name of the need: what it is, commands that are taken for it, package of Debian."""


@cache
def extras() -> dict[str, tuple[str, ...]]:
    """Return the distributions of every extra."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return {
        extra: tuple(name for line in lines for name in re.findall(r"[A-Za-z][\w.-]*", re.split("[<>=;]", line)[0]))
        for extra, lines in project["optional-dependencies"].items()
    }


@cache
def is_installed(name: str) -> bool:
    """Whether a distribution is installed."""
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True


def optional(module: str) -> Any:
    """Return a module for a file whose tests all need it; None where it is not installed."""
    try:
        return import_module(module)
    except ModuleNotFoundError:
        return None


@cache
def program(need: str) -> str | None:
    """Return the path of a program; None where it is not installed."""
    return next(filter(None, map(shutil.which, PROGRAMS[need][1])), None)


def missing(need: str) -> str:
    """Return what of a need is not installed and how to install it; empty where all of it is.

    Raises
    ------
    ValueError
        If the need is neither an extra nor a program.
    """
    if need in PROGRAMS:
        title, _, package = PROGRAMS[need]
        return "" if program(need) else f"needs {title}: apt install {package}"
    if need not in extras():
        known = ", ".join([*PROGRAMS, *extras()])
        raise ValueError(f"needs({need!r}): neither an extra of pyproject.toml nor a program; there are {known}")
    lacking = [name for name in extras()[need] if not is_installed(name)]
    return f"needs extra {need} ({', '.join(lacking)}): pip install --editable '.[{need}]'" if lacking else ""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the option."""
    parser.getgroup("needs").addoption(
        "--all-needs", action="store_true", help="a missing extra or program of a test is an error, not a skip"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker."""
    config.addinivalue_line(
        "markers", "needs(*names): extras or programs that the test needs; skipped where one is missing"
    )


LACKING = pytest.StashKey[str]()
"""Reason for which a test fails in its set-up."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip the tests whose needs are not installed, or with ``--all-needs`` let them fail."""
    for item in items:
        names = [name for mark in item.iter_markers("needs") for name in mark.args or ("",)]
        try:
            reasons = list(filter(None, map(missing, names)))
        except ValueError as error:
            raise pytest.UsageError(f"{item.nodeid}: {error}") from None
        reason = "; ".join(dict.fromkeys(reasons))
        if reason and config.option.all_needs:
            item.stash[LACKING] = reason
        elif reason:
            item.add_marker(pytest.mark.skip(reason=reason))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Fail where a need is missing, before any fixture is made."""
    if LACKING in item.stash:
        pytest.fail(f"--all-needs: {item.stash[LACKING]}", pytrace=False)
