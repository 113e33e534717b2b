"""Public modules, classes and functions are documented, and what they document is what they take.

Every rule walks all modules in one test and names all that break it: a test for each module costs more to collect than
to run.
"""

from __future__ import annotations

import ast
import inspect
import re
import tomllib
from functools import cache
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from types import ModuleType

import pytest
from numpydoc.docscrape import NumpyDocString

import ltca

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
MODULES = sorted(path for package in ("ltca", "fem", "validation") for path in (ROOT / package).rglob("*.py"))
# Units stand as ", mm" everywhere; "[mm]", "[N/mm, contact cells held]", "[mm, MPa]" are the dialect that is gone.
BRACKETED_UNIT = re.compile(r"\[(?:1/)?(?:mm|N|MPa|rad|arcsec|arcmin|s)[²³]?(?:[·/,][^\]]*)?\]")


@cache
def tree_of(path):
    return ast.parse(path.read_text(encoding="utf-8"))


def relative(path):
    return str(path.relative_to(ROOT))


def public_definitions(tree):
    """Yield (qualified name, node, owning class or None) of public functions, classes and methods."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node.name, node, None
            if isinstance(node, ast.ClassDef):
                for inner in node.body:
                    if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
                        yield f"{node.name}.{inner.name}", inner, node


def documented(docstring, section):
    """Names of a numpydoc section, `a, b : float` being two."""
    parsed = NumpyDocString(docstring)[section]
    return [name.strip().lstrip("*") for entry in parsed for name in entry.name.split(",")]


def signature(node, owner):
    arguments = node.args
    names = [a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    names += [a.arg for a in (arguments.vararg, arguments.kwarg) if a]
    static = any(isinstance(d, ast.Name) and d.id == "staticmethod" for d in node.decorator_list)
    return names[1:] if owner is not None and not static else names


def fields(node):
    """Annotated fields of a (data)class body."""
    return [
        entry.target.id
        for entry in node.body
        if isinstance(entry, ast.AnnAssign)
        and isinstance(entry.target, ast.Name)
        and not entry.target.id.startswith("_")
        and not ast.unparse(entry.annotation).startswith("ClassVar")
    ]


def problems_of(tree):
    found = []
    for name, node, owner in public_definitions(tree):
        docstring = ast.get_docstring(node)
        if not docstring:
            found.append(f"{name}: no docstring")
            continue
        if isinstance(node, ast.ClassDef):
            init = [n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__"]
            expected = sorted(signature(init[0], node)) if init else sorted(fields(node))
            told = sorted(documented(docstring, "Attributes") + documented(docstring, "Parameters"))
            if told and told != expected:
                found.append(f"{name}: documents {told}, has {expected}")
        else:
            expected, told = signature(node, owner), documented(docstring, "Parameters")
            if told and sorted(told) != sorted(expected):
                found.append(f"{name}: documents {told}, takes {expected}")
    return found


def problems_or_warning(tree):
    try:
        return problems_of(tree)
    except UserWarning as warning:  # numpydoc's, of sections it does not know
        return [str(warning)]


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_documented_parameters_equal_the_signature():
    assert [relative(path) for path in MODULES if not ast.get_docstring(tree_of(path))] == [], "no module docstring"
    found = {relative(path): problems for path in MODULES if (problems := problems_or_warning(tree_of(path)))}
    assert found == {}


def rows_of(text):
    """Names in the first column of the table of a docstring."""
    _, _, body = text.partition("====  ====")
    return set(re.findall(r"^(\w+) {2,}\S", body, re.MULTILINE))


def faults_of_the_map(path, text):
    """Names that the table of a package lacks, or has and nobody else."""
    rows = rows_of(text)
    modules = {other.stem for other in path.parent.glob("*.py")} - {"__init__"}
    folders = {other.parent.name for other in path.parent.glob("*/__init__.py")}
    return sorted(((modules | folders) - rows) | {row for row in rows - modules if not (path.parent / row).is_dir()})


def test_the_map_of_a_package_has_all_its_modules():
    """A merge left one line of equals signs where nine modules of `ltca.output` had stood."""
    packages = [path for path in MODULES if path.name == "__init__.py" and path.parent.name != "commands"]
    assert len(packages) > 20
    found = {relative(path): faults_of_the_map(path, ast.get_docstring(tree_of(path))) for path in packages}
    assert {package: faults for package, faults in found.items() if faults} == {}


def test_the_check_of_maps_itself_can_fail():
    path = ROOT / "ltca" / "output" / "__init__.py"
    text = ast.get_docstring(tree_of(path))
    assert faults_of_the_map(path, text.partition("====  ====")[0]) == sorted(rows_of(text))
    assert faults_of_the_map(path, text + "\nattic        What is not there.") == ["attic"]


def docstrings(tree):
    """Every docstring of a module, private ones too."""
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    return [text for node in ast.walk(tree) if isinstance(node, kinds) and (text := ast.get_docstring(node))]


def bracketed_units(tree):
    return [found for text in docstrings(tree) for found in BRACKETED_UNIT.findall(text)]


def test_units_follow_a_comma():
    assert {relative(path): units for path in MODULES if (units := bracketed_units(tree_of(path)))} == {}


def test_the_check_of_units_itself_can_fail():
    told = ("[mm]", "[N]", "[MPa]", "[N/mm, held]", "[mm³/MPa]", "[1/mm]", "[mm, MPa]", "[rad]")
    lines = "".join(f'def f{number}():\n    """Length {unit}."""\n' for number, unit in enumerate(told))
    assert bracketed_units(ast.parse(lines)) == list(told)
    kept = '"""In [0, 2π), the section [tolerances], items[k], see [1] and `Norm[T]`."""'
    assert bracketed_units(ast.parse(kept)) == []


def test_examples_of_all_packages_are_run():
    """pytest collects the examples in docstrings: of every package, and every package has some."""
    options = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["pytest"]["ini_options"]
    assert "--doctest-modules" in options["addopts"]
    for package in ("ltca", "fem", "validation"):
        assert package in options["testpaths"]
        paths = [path for path in MODULES if path.is_relative_to(ROOT / package)]
        assert any(">>> " in text for path in paths for text in docstrings(tree_of(path))), package


def public_objects():
    """Yield (path, object, names of the members that the page shows) of all that docs/reference/api.rst documents."""
    page = (ROOT / "docs" / "reference" / "api.rst").read_text(encoding="utf-8")
    for kind, path, options in re.findall(r"^\.\. auto(\w+):: (\S+)\n((?:   .*\n)*)", page, re.MULTILINE):
        module, _, name = (path, "", "") if kind == "module" else path.rpartition(".")
        if kind == "method":
            module, _, owner = module.rpartition(".")
            name = f"{owner}.{name}"
        found = attrgetter(name)(import_module(module)) if name else import_module(module)
        told = re.search(r":members:(.*)", options)
        members = [one.strip() for one in told[1].split(",") if one.strip()] if told else []
        if told and not members:
            members = [one for one in vars(found) if not one.startswith("_") and one not in found.__annotations__]
        yield path, found, members


def lacking_examples():
    """Public objects without an example; members are shown in the example of their class, or have one of their own."""
    for path, found, members in public_objects():
        text = found.__doc__ or ""
        if not isinstance(found, ModuleType) and ">>> " not in text:
            yield path
        for member in members:
            own = inspect.getattr_static(found, member).__doc__ or ""
            used = "[" if member == "__getitem__" else f".{member}"
            if ">>> " not in own and (used not in text or isinstance(found, ModuleType)):
                yield f"{path}.{member}"


def test_every_public_object_has_an_example():
    """pytest runs them as doctests; public is what docs/reference/api.rst has, all of ``import ltca`` among it."""
    assert list(lacking_examples()) == []
    shown = [found for _, found, _ in public_objects()] + [
        getattr(found, member)
        for _, found, members in public_objects()
        if isinstance(found, ModuleType)
        for member in members
    ]
    assert [name for name in ltca.__all__ if name != "__version__" and getattr(ltca, name) not in shown] == []


def test_the_check_of_examples_itself_can_fail(monkeypatch):
    monkeypatch.setattr(ltca.check, "__doc__", "Judge a drive.")
    assert list(lacking_examples()) == ["ltca.front.checks.check"]


def test_the_check_itself_can_fail():
    tree = ast.parse(
        '"""M."""\nclass A:\n    """A.\n\n    Attributes\n    ----------\n    x : int\n    """\n    y: int\n'
        '    def f(self, a, b):\n        """F.\n\n'
        '        Parameters\n        ----------\n        a : int\n        """\n'
        "def g():\n    pass\n"
    )
    assert [problem.split(":")[0] for problem in problems_of(tree)] == ["A", "A.f", "g"]
