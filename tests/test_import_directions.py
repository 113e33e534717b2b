"""The arrows of the design: one ordered tuple of floors and no circle.

Every rule walks all modules in one test and names all that break it: a test for each module costs more to collect than
to run.
"""

from __future__ import annotations

import ast
import tomllib
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from ltca.compliance import sliced

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
PACKAGES = ("ltca", "fem", "validation")
# The floors of the house, lowest first: a module imports from its own floor or from lower ones, never from above.
FLOORS = (
    "ltca.errors", "ltca.arrays", "ltca.beam", "ltca.quantities", "ltca.output", "ltca.drive", "ltca.geometry", "ltca.contact",
    "ltca.reading", "ltca.laws", "ltca.compliance", "ltca.mechanics", "ltca.equilibrium", "ltca.dynamics", "ltca.analysis",
    "ltca.studies",
    "ltca.figures", "ltca.page", "ltca.export", "ltca.studio", "ltca.testing", "ltca",
    "fem.errors", "fem.discretisation_error", "fem.shapes", "fem.mesh", "fem.body", "fem.solid", "fem.options", "fem.contact",
    "fem.drive", "fem.solid_contact", "fem.solid_drive", "fem.reducer",
    "fem.coefficients", "fem.referee", "fem.pictures", "fem.export", "fem.testing", "fem",
    "validation.hertz", "validation.methods", "validation.rows", "validation.compare", "validation.levels", "validation.study",
    "validation.report", "validation.seats", "validation.manual",
    "ltca.commands", "fem.commands", "validation.commands", "validation",
)  # fmt: skip
# What a package may not see at all: ltca stands alone, nothing sees validation.
UNSEEN = {"ltca": {"fem", "validation"}, "fem": {"validation"}, "validation": set()}
# Of ltca, fem takes the drive, its shape, the nominal place of its parts and the edge: never their mechanics.
FEM_MAY_IMPORT = (
    "ltca.errors", "ltca.arrays", "ltca.output", "ltca.quantities", "ltca.drive", "ltca.reading", "ltca.geometry.flank",
    "ltca.geometry.length_profile",
    "ltca.geometry.placement", "ltca.geometry.boundary_stations", "ltca.page.study_page", "ltca.page.tables",
    "ltca.page.verdict_tables",
    "ltca.figures.house_style",
    "ltca.export",
    # The flexibility of what holds pins and cranks, where that is no body of finite elements.
    "ltca.beam", "ltca.laws.carrier", "ltca.laws.member_bearings",
    # One command writes parts and, handed on whole, models for simulators: nothing of these comes back.
    "ltca.commands.reduced_model",
)  # fmt: skip
# A change is checked as a drive file is read, above the drive; users look for it on the drive. It is loaded when called.
METHODS_FROM_ABOVE = {("ltca.drive.parts", "ltca.reading.changes")}
LIGHT_COMMANDS = {
    "contextlib",
    "functools",
    "dataclasses",
    "errno",
    "fem.solid.layer_count",
    "ltca.errors",
    "ltca.reading.arguments",
    "ltca.output.terminal",
    "shlex",
    "traceback",
    "warnings",
    "sys",
    "os",
    "re",
    "importlib",
    "argparse",
    "json",
    "pathlib",
    "typing",
    "__future__",
    "collections",
}
MODULES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def name_of(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


NAMES = {name_of(path): path for path in MODULES}


@cache
def imports(path, tree=None):
    """Every module a file imports, wherever the statement stands; `from ltca.geometry import pairs` is the module."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    found = set()
    for node in ast.walk(tree or ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = list(package[: len(package) - node.level + 1]) if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                inner = f"{module}.{alias.name}"
                found.add(inner if inner in NAMES else module)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
            if name in {"import_module", "__import__"} and node.args and isinstance(node.args[0], ast.Constant):
                found.add(str(node.args[0].value))
    return found


def ours(module):
    return module.partition(".")[0] in PACKAGES


def floor(module):
    """Number of the floor of a module: of the longest entry of `FLOORS` that it is or lies in."""
    entries = [entry for entry in FLOORS if module == entry or module.startswith(f"{entry}.")]
    return FLOORS.index(max(entries, key=len))


def circle(graph):
    """One circle of a graph as a list, empty when there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def relative(path):
    return str(path.relative_to(ROOT))


def test_there_is_something_to_check():
    assert len(MODULES) > 150
    assert "ltca.geometry.pairs" in imports(NAMES["ltca.compliance.half_space"])


def wrong_arrows(module, others):
    """What a module imports of ours and may not, each with the reason."""
    package = module.partition(".")[0]
    found = []
    for other in sorted(filter(ours, others)):
        if other.partition(".")[0] in UNSEEN[package]:
            found.append(f"{module} → {other}: is not seen from {package}")
        elif floor(other) > floor(module) and (module, other) not in METHODS_FROM_ABOVE:
            found.append(f"{module} → {other}: stands above")
        elif (
            package == "fem"
            and other.startswith("ltca")
            and not any(other == allowed or other.startswith(f"{allowed}.") for allowed in FEM_MAY_IMPORT)
        ):
            found.append(f"{module} → {other}: is not in FEM_MAY_IMPORT")
    return found


def test_import_directions():
    assert [arrow for path in MODULES for arrow in wrong_arrows(name_of(path), imports(path))] == []


def test_the_check_of_directions_itself_can_fail():
    pairs = {
        ("ltca.geometry.flank", "fem.mesh"): "is not seen from ltca",
        ("fem.mesh", "validation.rows"): "is not seen from fem",
        ("ltca.geometry.flank", "ltca.studies.quantities"): "stands above",
        ("fem.drive.solution", "ltca.compliance.half_space"): "is not in FEM_MAY_IMPORT",
    }
    for (module, other), told in pairs.items():
        assert wrong_arrows(module, {other, "numpy"}) == [f"{module} → {other}: {told}"]
    assert wrong_arrows("fem.drive.solution", {"ltca.geometry.flank", "ltca.drive.parts", "fem.mesh"}) == []


def test_no_circle():
    graph = {
        name: {other for other in imports(path) if other in NAMES and (name, other) not in METHODS_FROM_ABOVE}
        for name, path in NAMES.items()
    }
    assert circle(graph) == []
    folders = {}
    for name, others in graph.items():
        folder = FLOORS[floor(name)]
        folders.setdefault(folder, set()).update(FLOORS[floor(other)] for other in others)
        folders[folder].discard(folder)
    assert circle(folders) == []


def test_every_floor_is_there():
    assert len(set(FLOORS)) == len(FLOORS)
    assert all(entry in NAMES for entry in FLOORS)


def test_methods_from_above_are_loaded_when_they_are_called():
    for module, other in METHODS_FROM_ABOVE:
        tree = ast.parse(NAMES[module].read_text(encoding="utf-8"))
        head = ast.Module(body=[n for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom)], type_ignores=[])
        assert other in imports(NAMES[module]) - imports(NAMES[module], head)


def test_no_drawer_for_everything():
    assert [path for path in MODULES if path.stem in {"utils", "util", "helpers", "helper", "common", "misc"}] == []


def loaded_by(path, tree):
    """Modules that a file imports as it is loaded: not in functions, not for types alone."""
    head = ast.Module(body=[n for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom)], type_ignores=[])
    return imports(path, head)


def heavy_imports(path, tree):
    """What the head of a command imports that is not light."""
    return sorted(
        module
        for module in loaded_by(path, tree)
        # modules beside a command are held to the same rule
        if not (module.partition(".")[0] in LIGHT_COMMANDS or module in LIGHT_COMMANDS or ".commands." in module)
    )


def test_commands_import_lightly():
    """`cyclo --help` loads every command: at their head they may import light modules only; actions come when they start."""
    commands = sorted(path for path in ROOT.glob("*/commands/**/*.py") if path.parent.name != "actions")
    assert len(commands) > 10
    heavy = {relative(path): heavy_imports(path, ast.parse(path.read_text(encoding="utf-8"))) for path in commands}
    assert {path: modules for path, modules in heavy.items() if modules} == {}
    text = "import json\nimport numpy as np\nfrom ltca.commands import program\ndef f():\n    import scipy\n"
    assert heavy_imports(ROOT / "ltca" / "commands" / "any.py", ast.parse(text)) == ["numpy"]


def test_the_help_of_the_paper_s_benchmark_loaded_all_models():
    path = ROOT / "benchmarks" / "paper_method.py"
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert heavy_imports(path, tree) == []
    inside = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert "validation.methods.paper_method" in inside


def test_a_plane_run_loads_nothing_of_the_width():
    """What `ltca.compliance.sliced` names is loaded with the first drive in slices."""
    homes = set(sliced._HOMES)
    waiting = ["ltca.commands.actions.run", "ltca.commands.actions.check", "ltca.analysis.engines"]
    reached = set(waiting)
    while waiting:
        path = NAMES[waiting.pop()]
        new = (loaded_by(path, ast.parse(path.read_text(encoding="utf-8"))) & NAMES.keys()) - reached
        reached |= new
        waiting += new
    assert "ltca.compliance.sliced" in reached
    assert reached & homes == set()
    assert sorted(name for names in sliced._HOMES.values() for name in names) == sorted(sliced.__all__)
    assert all(getattr(sliced, name).__module__ in homes for name in sliced.__all__)
    with pytest.raises(AttributeError, match="no attribute 'SlicedCircle'"):
        _ = sliced.SlicedCircle


def test_every_registered_command_is_there():
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    for name, module in table["project"]["entry-points"]["cyclo.commands"].items():
        path = ROOT / (module.replace(".", "/") + ".py")
        tree = ast.parse(path.read_text(encoding="utf-8"))
        defined = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert {"configure", "execute"} <= defined, name


def test_the_check_itself_sees_every_kind_of_import():
    text = (
        "import fem.mesh\nfrom ltca.geometry import pairs\ndef f():\n    from validation.x import y\n"
        "    import_module('fem')\n"
    )
    path = ROOT / "ltca" / "geometry" / "any.py"
    assert imports(path, ast.parse(text)) == {"fem.mesh", "ltca.geometry.pairs", "validation.x", "fem"}
    relative_import = ast.parse("from . import pairs\nfrom .placement import Placement\n")
    assert imports(path, relative_import) == {"ltca.geometry.pairs", "ltca.geometry.placement"}
    assert circle({"a": {"b"}, "b": {"a"}})
    assert floor("ltca.errors") == 0
    assert floor("ltca.compliance.half_space") > floor("ltca.laws.spring") > floor("ltca.drive.parts")
