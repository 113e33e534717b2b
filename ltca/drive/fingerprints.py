"""Hashes of definitions without what is at its default, so that fields of later versions change none."""

from __future__ import annotations

import hashlib
from dataclasses import MISSING, fields, is_dataclass
from typing import Any

HASHED_DEFAULT = "hashed default"
"""Key of the metadata of a field: the value that hashes leave out, where that is not the default."""


def fingerprint_of(part: Any) -> str:
    """Return a hash (hex, 16 digits) of a definition: a dataclass or dict of numbers, texts, tuples and other such
    definitions.
    """
    content = _given(part) if is_dataclass(part) else part
    return hashlib.sha256(repr(content).encode()).hexdigest()[:16]


def _given(part: Any) -> dict[str, Any]:
    """Fields of a part that are not at their defaults, by name."""
    given = {}
    for item in fields(part):
        if not item.compare:  # a name, no part of the definition
            continue
        value = getattr(part, item.name)
        default = item.default_factory() if item.default_factory is not MISSING else item.default
        default = item.metadata.get(HASHED_DEFAULT, default)
        if default is MISSING or value != default:
            given[item.name] = _value(value)
    return given


def _value(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(_value(item) for item in value)
    return _given(value) if is_dataclass(value) else value
