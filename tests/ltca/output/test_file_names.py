"""Different names give different files on every system, and on Linux they stand as they are."""

from __future__ import annotations

import re
import unicodedata

import pytest

from ltca.output.file_names import file_word, file_words

NAMES = (
    "CS-1", "CS:1", "CS?1", "CS*1", "CS%3A1", 'a"b', "a<b", "a>b", "a|b", "nul", "NUL", "Con", "con.x", "com1", "lpt9.toml",
    "console", "end.", "end", "end ", "end. ", "a", "A", "a~2", "Spiel groß", "SPIEL GROSS", "ä", "a\u0308", "中文", "$x$",
)  # fmt: skip


def same_file(name):
    """The name as Windows and macOS compare it."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def test_windows_takes_every_name_and_no_two_for_one():
    words = file_words(NAMES, "win32").values()
    assert len({same_file(word) for word in words}) == len(NAMES)
    for word in words:
        # Microsoft, "Naming Files, Paths, and Namespaces".
        assert not re.search(r'[<>:"/\\|?*\x00-\x1f]', word), word
        assert word[-1] not in ". ", word
        assert word.partition(".")[0].rstrip().lower() not in {"con", "prn", "aux", "nul", "com1", "lpt9"}, word


def test_macos_has_no_two_names_for_one():
    words = file_words(NAMES, "darwin")
    assert len({same_file(word) for word in words.values()}) == len(NAMES)
    assert words["CS:1"] == "CS:1"
    assert words["A"] != "A"  # "a" came before


@pytest.mark.parametrize("name", NAMES)
def test_on_linux_names_stand_as_they_are(name):
    assert file_words(NAMES, "linux")[name] == file_word(name, "linux") == name


def test_usual_names_stand_as_they_are_everywhere():
    for system in ("win32", "darwin"):
        assert [*file_words(["nominal", "CS-1", "paper_curves", "Spiel groß"], system).values()] == [
            "nominal", "CS-1", "paper_curves", "Spiel groß",
        ]  # fmt: skip
