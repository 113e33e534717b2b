"""Mistakes in a definition as sentences: field, value, bound."""

from __future__ import annotations

from typing import Any


def describe_mistake(detail: Any) -> str:
    """Return one mistake pydantic found as a sentence with field, value and bound."""
    path = ".".join(str(part) for part in detail["loc"])
    match detail["type"]:
        case "missing" | "missing_argument" | "missing_keyword_only_argument":
            return f"{path}: is missing"
        case "unexpected_keyword_argument" | "extra_forbidden":
            return f"{path}: is not a field of the drive definition"
        case "dataclass_type" | "dataclass_exact_type" | "model_type" | "dict_type":
            return f"{path} = {_shown(detail['input'])}: must be a table"
        case "tuple_type":
            return f"{path} = {_shown(detail['input'])}: must be an array of numbers in mm"
    message = str(detail["msg"]).replace("Input should be", "must be")
    message = message.replace("a valid integer, unable to parse string as an integer", "a whole number")
    message = message.replace("a valid integer, got a number with a fractional part", "a whole number")
    return f"{path} = {_shown(detail['input'])}: {message}"


def _shown(value: Any) -> str:
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
