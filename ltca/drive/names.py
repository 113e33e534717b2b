"""Names of drives and cases, which name files and folders and are printed, drawn and put on pages."""

from __future__ import annotations

import unicodedata
from functools import lru_cache
from typing import Annotated, Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

LONGEST_NAME = 120
"""Bytes: file systems take 255 for a file, and names of figures go before it."""
UNPRINTED = ("Cc", "Cf", "Zl", "Zp")
"""Unicode categories of control and invisible characters: of zero width, joining, or changing the direction of text."""
BLANK = "\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0"
"""Letters and marks without a glyph."""
PRINTED = "\u0600\u0601\u0602\u0603\u0604\u0605\u06dd\u070f\u08e2"
"""Visible number marks of Arabic and Syriac in these categories."""
JOINERS = "\u200c\u200d"
"""Part of the spelling within words of some scripts."""
NAMING = f"must be a text of at most {LONGEST_NAME} bytes that can name a file, without /, \\, control and invisible characters"


def is_no_character(sign: str) -> bool:
    """Tell whether a code is one of those that Unicode gives to no character, which XML does not take.

    Examples
    --------
    >>> is_no_character(chr(0xFFFF)), is_no_character(chr(0xFFFD))
    (True, False)
    """
    return ord(sign) & 0xFFFE == 0xFFFE or "\ufdd0" <= sign <= "\ufdef"


def is_seen(text: str) -> bool:
    """Tell whether a text has no control or invisible characters; joiners between letters of their scripts are spelling.

    Examples
    --------
    >>> is_seen("CS-1"), is_seen(f"CS{chr(0x200B)}-1"), is_seen(f"a{chr(9)}b")
    (True, False, False)
    """
    for place, sign in enumerate(text):
        if sign in JOINERS:
            around = text[place - 1 : place] + text[place + 1 : place + 2]
            if (
                len(around) < 2
                or around.isascii()
                or any(unicodedata.category(other)[0] not in "LMS" for other in around)
            ):
                return False
        elif (
            sign in BLANK or is_no_character(sign) or (unicodedata.category(sign) in UNPRINTED and sign not in PRINTED)
        ):
            return False
    return True


@lru_cache(maxsize=1024)  # searches build hundreds of thousands of drives of one name
def names_a_file(name: str) -> bool:
    """Tell whether a text can be the name of a drive or a case; quotes, dollars and angle brackets can.

    Examples
    --------
    >>> names_a_file("a$x_{b$ <!--"), names_a_file("a/b"), names_a_file("a\\nb")
    (True, False, False)
    """
    return (
        bool(name.strip(" ."))
        and not any(sign in "/\\" or unicodedata.category(sign) == "Cs" for sign in name)
        and is_seen(name)
        and len(name.encode("utf-8", "replace")) <= LONGEST_NAME
    )


def _check(value: Any) -> Any:
    if isinstance(value, str) and names_a_file(value):
        return value
    raise PydanticCustomError("name", NAMING)


Name = Annotated[str, BeforeValidator(_check)]
