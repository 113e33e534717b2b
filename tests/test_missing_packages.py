"""A package that is not installed: one line that says what to install, exit status 2, nothing left behind.

The extra ``fast`` only makes things faster: without it SuperLU factorises and orders (tests/fem/body, tests/fem/solid).
"""

from __future__ import annotations

import re
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import pytest

from ltca.commands.program import DISTRIBUTIONS, main, what_installs

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
MODULES = {distribution: module for module, distribution in DISTRIBUTIONS.items()}
DERIVED = ["paper", "--case", "CS-1", "--angle", "0.5"]


class _Without:
    """Finder that has not got a package."""

    def __init__(self, name):
        self.name = name

    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == self.name:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return None


@pytest.fixture
def without(monkeypatch, tmp_path):
    """Take a package away, in an empty folder."""

    def take(module):
        ours = [name for name in sys.modules if name.split(".")[0] == module]
        for name in ours:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setattr(sys, "meta_path", [_Without(module), *sys.meta_path])
        monkeypatch.chdir(tmp_path)

    return take


def required():
    """Yield (distribution, extra or empty) of all that pyproject.toml asks for; what two extras ask for, of the first."""
    groups = {"": PROJECT["dependencies"], **PROJECT["optional-dependencies"]}
    seen = set()
    for extra, lines in groups.items():
        for line in lines:
            name = re.split(r"[\[<>=]", line)[0]
            if name not in seen:
                seen.add(name)
                yield name, extra


@pytest.mark.parametrize(("name", "extra"), sorted(required()))
def test_every_package_is_told_by_what_installs_it(name, extra):
    module = MODULES.get(name, name.replace("-", "_"))
    wanted = what_installs(module)
    assert wanted == f"'cyclo-ltca[{extra}]'" if extra else wanted.startswith(f"'{name}")


def test_a_module_that_we_do_not_ask_for_stays_a_fault():
    assert what_installs("ltca.no_such_module") == ""
    assert what_installs("no_such_module") == ""


@pytest.mark.parametrize(
    ("module", "words", "line"),
    [
        ("distributed", ["tolerance", "paper", "--samples", "2", "--positions", "2", "--scheduler", "tcp://127.0.0.1:1"],
         "--scheduler needs dask.distributed, which is not installed: pip install 'cyclo-ltca[cluster]'"),
        ("gmsh", ["mesh", *DERIVED], "gmsh is not installed"),
        ("ezdxf", ["export", "paper", "--case", "CS-1", "--format", "dxf"],
         "the Python package ezdxf is not installed: pip install 'ezdxf>=1.4.4'"),
    ],
)  # fmt: skip
def test_a_command_without_a_package_says_what_to_install(without, tmp_path, capsys, module, words, line):
    without(module)
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err.strip().splitlines()
    assert [one for one in told if one.startswith("cyclo: error: ")] == told[-1:]
    assert line in told[-1]
    assert "install" in told[-1]
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]


def run_without(module, code, *words):
    """Run a script, with a package taken away, in a process of its own."""
    script = textwrap.dedent(f"""
        import importlib.util, runpy, sys
        sys.path[:0] = [{str(ROOT)!r}, {str(ROOT / "benchmarks")!r}]
        found = importlib.util.find_spec
        importlib.util.find_spec = lambda name, *rest: None if name.split(".")[0] == {module!r} else found(name, *rest)
        sys.modules[{module!r}] = None
        sys.argv = {list(words or ("program",))!r}
        {code}
    """)
    return subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False, timeout=600
    )


def test_mutants_without_coverage():
    """The one use of the extra ``mutants``."""
    done = run_without(
        "coverage", "runpy.run_path('benchmarks/mutants.py', run_name='__main__')", "benchmarks/mutants.py"
    )
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "pip install 'cyclo-ltca[mutants]'" in done.stderr


@pytest.mark.slow
def test_other_codes_without_the_referee(tmp_path):
    """The program that stores answers of other codes asks for tamaas; validation itself takes what is stored."""
    out = tmp_path / "answers.json"
    module = "validation.levels.other_codes"
    words = (module, "tamaas", "--out", str(out))
    done = run_without("tamaas", f"runpy.run_module({module!r}, run_name='__main__', alter_sys=True)", *words)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "pip install 'cyclo-ltca[referee]'" in done.stderr
    assert not out.exists()


@pytest.mark.slow
@pytest.mark.needs("docs")
@pytest.mark.parametrize("module", ["myst_parser", "sphinx_gallery"])
def test_documentation_without_its_extra(tmp_path, module):
    code = f"from sphinx.cmd.build import main; sys.exit(main(['-b', 'html', 'docs', {str(tmp_path)!r}]))"
    done = run_without(module, code)
    assert done.returncode == 2
    told = " ".join(done.stderr.split())
    assert f"the Python package {module} is not installed: pip install --editable '.[docs]'" in told
