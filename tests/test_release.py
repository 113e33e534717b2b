"""Files of a release: the version with and without tags, public addresses in one place, forms and workflows that can be read."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
NEXT = PROJECT["tool"]["setuptools_scm"]["fallback_version"].partition(".dev")[0]
YAML = [*sorted(ROOT.glob(".github/**/*.yml")), ROOT / ".readthedocs.yaml"]
PYTHONS = [
    line.rpartition(" ")[2] for line in PROJECT["project"]["classifiers"] if re.search(r"Python :: 3\.\d+$", line)
]


def run(*command, cwd):
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("GIT_", "SETUPTOOLS_SCM"))}
    environment |= {f"GIT_{who}_{what}": "x@y" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    done = subprocess.run(command, cwd=cwd, env=environment, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def version(folder):
    return run(sys.executable, "-W", "ignore", "-m", "setuptools_scm", cwd=folder)


def archive(repository, folder):
    """Unpack what the hosting page offers as the source of a commit."""
    folder.mkdir()
    packed = folder.with_suffix(".tar")
    run("git", "archive", "--output", str(packed), "HEAD", cwd=repository)
    shutil.unpack_archive(packed, folder, filter="data")
    return folder


@pytest.fixture
def repository(tmp_path):
    """A repository of two commits that says its version as ours does."""
    folder = tmp_path / "repository"
    folder.mkdir()
    for name in ("pyproject.toml", ".git_archival.txt", ".gitattributes"):
        shutil.copy(ROOT / name, folder)
    run("git", "init", "--quiet", cwd=folder)
    run("git", "add", "--all", cwd=folder)
    for message in ("first", "second"):
        run("git", "commit", "--quiet", "--allow-empty", "--message", message, cwd=folder)
    return folder


@pytest.mark.slow
def test_version_without_tags(repository, tmp_path):
    """A fresh clone counts its commits; its archive, which has no history, is the zeroth."""
    assert version(repository) == f"{NEXT}.dev2"
    assert version(archive(repository, tmp_path / "archive")) == f"{NEXT}.dev0"
    run("git", "clone", "--quiet", "--depth", "1", repository.as_uri(), str(tmp_path / "shallow"), cwd=tmp_path)
    assert version(tmp_path / "shallow") == f"{NEXT}.dev1"


def test_the_version_is_tested_with_what_builds_it():
    builds = [line for line in PROJECT["build-system"]["requires"] if line.startswith("setuptools-scm")]
    assert builds == [
        line for line in PROJECT["project"]["optional-dependencies"]["test"] if line.startswith("setuptools-scm")
    ]


def test_version_of_a_release(repository, tmp_path):
    """The tag says it, in the clone and in the archive that Zenodo keeps; a commit later the next one is in development."""
    run("git", "tag", f"v{NEXT}", cwd=repository)
    assert version(repository) == NEXT
    assert version(archive(repository, tmp_path / "archive")) == NEXT
    run("git", "commit", "--quiet", "--allow-empty", "--message", "third", cwd=repository)
    numbers = [int(part) for part in NEXT.split(".")]
    assert version(repository) == f"{numbers[0]}.{numbers[1]}.{numbers[2] + 1}.dev1"


def test_version_of_an_sdist(tmp_path):
    """An sdist has no git; what was found when it was made is in PKG-INFO."""
    for name in ("pyproject.toml", ".git_archival.txt"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / "PKG-INFO").write_text("Metadata-Version: 2.4\nName: cyclo-ltca\nVersion: 7.8.9\n", encoding="utf-8")
    assert version(tmp_path) == "7.8.9"


def test_citation_said_0_2_0_where_pages_said_0_3_0_dev():
    """Between releases it has the version that code of no tag has, and no date; a release has the newest entry's."""
    entries = re.findall(r"^## (\d+\.\d+\.\d+) \((.*)\)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    number, date = entries[0]
    if date == "not released":
        expected = PROJECT["tool"]["setuptools_scm"]["fallback_version"], None
        assert expected[0].startswith(f"{number}.dev")
    else:
        expected = number, date
    assert (str(CITATION["version"]), CITATION.get("date-released") and str(CITATION["date-released"])) == expected
    assert CITATION["license"] == PROJECT["project"]["license"]
    assert [author["name"] for author in CITATION["authors"]] == [one["name"] for one in PROJECT["project"]["authors"]]


def test_public_addresses_stand_in_one_place():
    """Whoever opens the repository enters them in pyproject.toml; CITATION.cff, a format of its own, has to follow."""
    addresses = PROJECT["project"].get("urls", {})
    assert CITATION.get("repository-code") == addresses.get("Repository")
    assert CITATION.get("url") == addresses.get("Documentation")
    for page in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md", "docs/conf.py"):
        text = (ROOT / page).read_text(encoding="utf-8")
        assert not [address for address in addresses.values() if address in text], page


@pytest.mark.parametrize("path", YAML, ids=lambda path: path.name)
def test_hosting_files_can_be_read(path):
    assert isinstance(yaml.safe_load(path.read_text(encoding="utf-8")), dict)


def test_forms_ask_for_what_a_wrong_number_needs():
    for path in sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")):
        form = yaml.safe_load(path.read_text(encoding="utf-8"))
        if path.name == "config.yml":
            continue
        assert {"name", "description", "body"} <= set(form), path.name
        fields = [part for part in form["body"] if part["type"] != "markdown"]
        identifiers = [part["id"] for part in fields]
        assert len(set(identifiers)) == len(identifiers)
        assert all(part["attributes"]["label"] for part in fields)
        if path.stem == "wrong_number":
            required = {part["id"] for part in fields if part.get("validations", {}).get("required")}
            assert required == {"drive", "command", "version", "found", "expected", "source"}


def test_hosted_runs_cover_the_pythons_of_the_package():
    jobs = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text(encoding="utf-8"))["jobs"]
    assert jobs["run"]["strategy"]["matrix"]["python"] == PYTHONS
    assert PROJECT["project"]["requires-python"] == f">={PYTHONS[0]}"
    # .ci/run has the lowest versions of the dependencies on the lowest Python.
    lowest = tuple(int(part) for part in PYTHONS[0].split("."))
    assert f"sys.version_info[:2] != {lowest}" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_publishing_stores_no_secret():
    """By OIDC (trusted publishing): the one job that uploads may ask for an identity, nothing else may."""
    text = (ROOT / ".github/workflows/publish.yml").read_text(encoding="utf-8")
    workflow = yaml.safe_load(text)
    assert workflow["permissions"] == {"contents": "read"}
    assert {name: job.get("permissions") for name, job in workflow["jobs"].items()} == {
        "build": None,
        "publish": {"id-token": "write"},
    }
    assert "secrets." not in text
    assert "password" not in text


def test_documentation_host_has_the_system_libraries():
    script = (ROOT / ".ci" / "system-libraries").read_text(encoding="utf-8")
    needed = re.search(r'^packages="([^"]+)"$', script, re.MULTILINE)[1].split()
    host = yaml.safe_load((ROOT / ".readthedocs.yaml").read_text(encoding="utf-8"))
    assert host["build"]["apt_packages"] == needed
    assert host["sphinx"] == {"configuration": "docs/conf.py", "fail_on_warning": True}
