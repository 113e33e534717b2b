"""The arrows of the design: which package may import what, and how large a module may grow."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("ltca", "fem", "validation")
FEM_MAY_IMPORT = {
    "ltca.drive", "ltca.drive_file", "ltca.drive_checks", "ltca.profile", "ltca.placement", "ltca.errors",
    "ltca.units", "ltca.output_files", "ltca.progress",
}  # fmt: skip
LIGHT_COMMANDS = {"ltca.errors", "sys", "argparse", "json", "pathlib", "typing", "__future__", "collections"}
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def imports(path, tree=None):
    """Every module a file imports, wherever the statement stands; `from ltca import profile` is ltca.profile."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    found = set()
    for node in ast.walk(tree or ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = list(package[: len(package) - node.level + 1]) if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            if module in PACKAGES:
                found |= {f"{module}.{alias.name}" for alias in node.names}
            else:
                found.add(module)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
            if name in {"import_module", "__import__"} and node.args and isinstance(node.args[0], ast.Constant):
                found.add(str(node.args[0].value))
    return found


def test_there_is_something_to_check():
    assert len(MODULES) > 25
    assert "ltca.pairs" in imports(ROOT / "ltca" / "compliance.py")


def relative(path):
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_import_directions(path):
    package = path.relative_to(ROOT).parts[0]
    for module in imports(path):
        top = module.partition(".")[0]
        if package == "ltca":
            assert top not in {"fem", "validation"}, module
        elif package == "fem":
            assert top != "validation", module
            assert top != "ltca" or module in FEM_MAY_IMPORT, module
        assert top != "tests", module


@pytest.mark.parametrize("path", MODULES, ids=relative)
def test_one_file_one_step(path):
    assert path.stem not in {"utils", "util", "helpers", "helper", "common", "misc"}
    assert len(path.read_text(encoding="utf-8").splitlines()) < 450


@pytest.mark.parametrize("path", sorted(ROOT.glob("*/commands/*.py")), ids=relative)
def test_commands_import_lightly(path):
    """`cyclo --help` loads every command: at their head they may import light modules only."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    head = ast.Module(body=[n for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom)], type_ignores=[])
    for module in imports(path, head):
        light = module.partition(".")[0] in LIGHT_COMMANDS or module in LIGHT_COMMANDS
        assert light or ".commands." in module, module  # modules beside a command are held to the same rule


def test_every_registered_command_is_there():
    import tomllib

    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for name, module in table["project"]["entry-points"]["cyclo.commands"].items():
        path = ROOT / (module.replace(".", "/") + ".py")
        tree = ast.parse(path.read_text(encoding="utf-8"))
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert {"configure", "execute"} <= defined, name


def test_the_check_itself_sees_every_kind_of_import(tmp_path):
    text = (
        "import fem.mesh\nfrom ltca import pairs\ndef f():\n    from validation.x import y\n    import_module('fem')\n"
    )
    assert imports(ROOT / "ltca" / "any.py", ast.parse(text)) == {"fem.mesh", "ltca.pairs", "validation.x", "fem"}
    relative_import = ast.parse("from . import pairs\nfrom .placement import Placement\n")
    assert imports(ROOT / "ltca" / "any.py", relative_import) == {"ltca.pairs", "ltca.placement"}
