"""Names of drives and cases: files and folders are called after them, and they are printed, drawn and put on pages."""

from __future__ import annotations

import unicodedata
from typing import Annotated, Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

LONGEST_NAME = 120
"""Bytes: file systems take 255 for a file, and names of figures go before it."""
UNPRINTED = ("Cc", "Cs", "Zl", "Zp")
BACKWARD = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
"""Signs that turn what is printed behind them."""
NAMING = f"must be a text of at most {LONGEST_NAME} bytes that can name a file, without /, \\ and control characters"


def names_a_file(name: str) -> bool:
    """Tell whether a text can be the name of a drive or a case; quotes, dollars and angle brackets can.

    Examples
    --------
    >>> names_a_file("a$x_{b$ <!--"), names_a_file("a/b"), names_a_file("a\\nb")
    (True, False, False)
    """
    return (
        bool(name.strip(" ."))
        and not any(sign in "/\\" or unicodedata.category(sign) in UNPRINTED or sign in BACKWARD for sign in name)
        and len(name.encode("utf-8", "replace")) <= LONGEST_NAME
    )


def _check(value: Any) -> Any:
    if isinstance(value, str) and names_a_file(value):
        return value
    raise PydanticCustomError("name", NAMING)


Name = Annotated[str, BeforeValidator(_check)]
