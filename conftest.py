"""Collecting, for the tests and for the doctests of the packages: what ten thousand objects cost when nobody asks for them."""

from __future__ import annotations

import gc
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest
from _pytest.doctest import DoctestModule

# Modules and tests stay until the end: walking them again and again while they are made is a tenth of the collection.
gc.disable()


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
