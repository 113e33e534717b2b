"""Collecting and dealing out, for the tests and for the doctests of the packages."""

from __future__ import annotations

import gc
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest
from _pytest.doctest import DoctestModule

APART = {"tests/test_printed_commands.py::test_every_printed_command_runs_small[python]"}
"""Tests that take as long as all others of their file together: another worker takes them."""

pytest_plugins = ("needs", "shards")  # tests/plugins, by `pythonpath` of pyproject.toml

# Modules and tests stay until the end: walking them again and again while they are made is a tenth of the collection.
gc.disable()


def pytest_configure(config: pytest.Config) -> None:
    """Deal out files, not tests (``--dist=loadfile``: what those of a file share is made once), in the order they stand in."""
    config.option.loadscopereorder = False


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Deal out files, and the tests of `APART` for themselves; other ways of dealing are those of pytest-xdist."""
    if config.option.dist != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Files(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return nodeid if nodeid in APART else super()._split_scope(nodeid)

    return Files(config, log)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put files with slow tests first: none of them is what one worker does while the other has nothing left."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path: Path) -> Generator[None, list[Any], list[Any]]:
    """Search a module for doctests only if there is one: five of six have none."""
    collectors = yield
    if any(isinstance(one, DoctestModule) for one in collectors) and b">>>" not in file_path.read_bytes():
        return [one for one in collectors if not isinstance(one, DoctestModule)]
    return collectors


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """Collect garbage from here on, of what the tests make."""
    gc.freeze()
    gc.enable()
