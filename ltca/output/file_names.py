"""Names of drives and cases as they stand in names of files, on systems that refuse some of them or take two for one."""

from __future__ import annotations

import hashlib
import re
import sys
import unicodedata
from collections.abc import Iterable

REFUSED = re.compile(r'[<>:"|?*%]|[ .](?=[ .]*$)')
"""Signs that Windows refuses, or leaves out at the end of a name, and the one by which they are written."""
DEVICE = re.compile(r"(?:con|prn|aux|nul|(?:com|lpt)[0-9¹²³])(?: *\..*)?", re.IGNORECASE)
"""Names that Windows takes for devices, whatever ending they have."""
DIGITS = 12
"""Hexadecimal digits of a hash in the name of a file."""


def file_words(names: Iterable[str], system: str = sys.platform) -> dict[str, str]:
    """Return names as parts of names of files, by name: different names give different files.

    They stand as they are, with two exceptions. On Windows signs that it refuses are written by their numbers, as in addresses.
    There and on macOS names that differ in capitals, or in how accents are composed, are one name: the second is counted.

    Examples
    --------
    >>> file_words(["CS-1", "5 % *", "nul"], "win32")
    {'CS-1': 'CS-1', '5 % *': '5 %25 %2A', 'nul': '%6Eul'}
    >>> file_words(["a", "A", "a~2"], "darwin")
    {'a': 'a', 'A': 'A~2', 'a~2': 'a~2~2'}
    >>> file_words(["a", "A", "nul"], "linux")
    {'a': 'a', 'A': 'A', 'nul': 'nul'}
    """
    words: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        word = _on_windows(name) if system == "win32" else name
        if system in ("win32", "darwin"):
            first, count = word, 1
            while spelled_alike(word) in taken:
                count += 1
                word = f"{first}~{count}"
            taken.add(spelled_alike(word))
        words[name] = word
    return words


def file_word(name: str, system: str = sys.platform) -> str:
    """Return one name as a part of names of files; of names that share a folder `file_words` tells the parts."""
    return file_words([name], system)[name]


def shortened_file_name(text: str, most: int) -> str:
    """Return a text of at most so many bytes for the name of a file: a longer one is cut and gets a hash of the whole.

    Examples
    --------
    >>> shortened_file_name("paper_CS-1", 40), shortened_file_name("a" * 60, 20)
    ('paper_CS-1', 'aaaaaaa_11ee391211c6')
    """
    if len(text.encode("utf-8", "replace")) <= most:
        return text
    head = text.encode("utf-8", "replace")[: most - DIGITS - 1].decode("utf-8", "ignore")
    return f"{head}_{digest_of(text)}"


def digest_of(text: str) -> str:
    """Return `DIGITS` digits that tell a text from others."""
    return hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()[:DIGITS]


def _on_windows(name: str) -> str:
    word = REFUSED.sub(lambda sign: f"%{ord(sign[0]):02X}", name)
    return f"%{ord(word[0]):02X}{word[1:]}" if DEVICE.fullmatch(word) else word


def spelled_alike(word: str) -> str:
    """Return what Windows and macOS tell names by: neither capitals count there, nor how accents are composed.

    Examples
    --------
    >>> spelled_alike("Paper_A.json") == spelled_alike("paper_a.json")
    True
    """
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", word).casefold())
