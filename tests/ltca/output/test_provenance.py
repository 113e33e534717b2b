"""The hash of the code: of contents and relative places, nothing else."""

import shutil
import sys

import pytest

from ltca.output.provenance import code_hash, code_version


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Write a small package and make it importable; return a function that hashes it afresh."""

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


def test_packages_count():
    assert code_hash("ltca") != code_hash("ltca", "fem")
    assert len(code_hash("ltca")) == 16
    assert code_version()
    assert code_hash("ltca", "no_such_package") not in (code_hash("ltca"), code_hash("ltca", "fem"))
