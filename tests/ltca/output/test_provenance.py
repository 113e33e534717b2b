"""The hash of the code: of syntax trees and relative places, nothing else."""

import os
import shutil
import sys

import pytest

from ltca.output.provenance import code_hash, code_version


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Write a small package and make it importable; return a function that hashes it afresh."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def build(place, text):
        folder = tmp_path / place / "some_package"
        (folder / "inner").mkdir(parents=True)
        (folder / "__init__.py").write_text("")
        (folder / "inner" / "part.py").write_text(text)
        (folder / "inner" / "notes.txt").write_text(place)
        monkeypatch.syspath_prepend(str(tmp_path / place))
        sys.modules.pop("some_package", None)
        code_hash.cache_clear()
        return code_hash("some_package")

    yield build
    code_hash.cache_clear()
    shutil.rmtree(tmp_path)


def test_same_code_same_hash_wherever_it_lies(package):
    assert package("here", "x = 1\n") == package("there", "x = 1\n")


def test_another_code_another_hash(package):
    assert package("here", "x = 1\n") != package("there", "x = 2\n")


WRITTEN = '''"""A module."""

LIMIT = 2.0  # mm
"""What it may reach."""


def law(x: float) -> float:
    """Return x beyond the limit."""
    # Never below.
    return max(x, LIMIT) - LIMIT


class Empty:
    """Nothing."""
'''
READ_OTHERWISE = '''"""Another text,
of two lines."""
LIMIT = 2.0


def law(
    x: float,
) -> float:
    return max(x, LIMIT) - LIMIT  # told elsewhere
class Empty:
    """Still nothing."""
'''


def test_comments_and_docstrings_change_nothing(package):
    assert package("here", WRITTEN) == package("there", READ_OTHERWISE)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("2.0", "2.5"),
        ("max(x, LIMIT)", "max(LIMIT, x)"),
        ("max", "min"),
        ("x: float", "x: float = 1.0"),
        ("- LIMIT", "+ LIMIT"),
        ("-> float", "-> int"),
        ("    return max", "    assert x\n    return max"),
        ('"""What it may reach."""', 'NAME = """What it may reach."""'),
    ],
)
def test_what_is_computed_changes_it(package, before, after):
    assert WRITTEN.count(before) >= 1
    assert package("here", WRITTEN) != package("there", WRITTEN.replace(before, after))


def test_the_cache_is_only_a_cache(package, tmp_path, monkeypatch):
    """What is kept is found again by the bytes of the sources; damaged, or in a place that is none, it is made anew."""
    first = package("here", WRITTEN)
    kept = list((tmp_path / "cache" / "cyclo" / "code").iterdir())
    assert len(kept) == 1
    whole = kept[0].read_text()
    kept[0].write_text("0" * 64)
    assert package("there", WRITTEN) != first  # what is kept under these bytes is believed
    kept[0].write_text("no hash")
    assert package("elsewhere", WRITTEN) == first
    assert kept[0].read_text() == whole
    monkeypatch.setenv("XDG_CACHE_HOME", str(kept[0]))  # a file where a folder should be
    assert package("without", WRITTEN) == first


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_pipe_in_the_place_of_what_is_kept_is_not_waited_for(package, tmp_path):
    first = package("here", WRITTEN)
    (kept,) = (tmp_path / "cache" / "cyclo" / "code").iterdir()
    kept.unlink()
    os.mkfifo(kept)
    assert package("there", WRITTEN) == first
    assert kept.is_file()


def test_comments_in_data_change_nothing(package, tmp_path):
    def of(place, text):
        (tmp_path / place / "some_package").mkdir(parents=True)
        (tmp_path / place / "some_package" / "sizes.toml").write_text(text)
        return package(place, WRITTEN)

    plain = of("here", "bore = 20.0\n")
    assert plain == of("there", "# mm\nbore = 20.0  # H7\n")
    assert plain != of("elsewhere", "bore = 20.5\n")


def test_packages_count():
    assert code_hash("ltca") != code_hash("ltca", "fem")
    assert len(code_hash("ltca")) == 16
    assert code_version()
    assert code_hash("ltca", "no_such_package") not in (code_hash("ltca"), code_hash("ltca", "fem"))
