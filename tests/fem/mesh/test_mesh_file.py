"""Mesh files: nothing is lost on the way, and every broken file ends in one clear error."""

from __future__ import annotations

import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from refusals import error_says

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import Refinement
from fem.mesh.gmsh_session import gmsh_model, load_gmsh
from fem.mesh.mesh_file import read_msh, write_msh, write_vtu
from fem.mesh.triangulation import mesh_circle
from fem.shapes import CircleShape
from ltca.errors import CycloError


def pin(order: int = 2) -> BodyMesh:
    shape = CircleShape(name="pin_3", radius=6.5, core_radius=2.0)
    return mesh_circle(shape, [Refinement.polar(6.5, 0.7, size=0.2, radius=0.5)], order=order)


@pytest.fixture(scope="module")
def mesh_text(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write_msh(pin(), tmp_path_factory.mktemp("mesh") / "pin.msh").read_text(encoding="ascii")


@pytest.mark.parametrize("order", [1, 2])
def test_msh_round_trip_keeps_everything(tmp_path: Path, order: int) -> None:
    body = pin(order)
    back = read_msh(write_msh(body, tmp_path / "x.msh"), required_boundaries=("surface", "core"))
    assert (back.name, back.order) == ("pin_3", order)
    # 17 significant digits: bit for bit.
    np.testing.assert_array_equal(back.mesh.doflocs, body.mesh.doflocs)
    np.testing.assert_array_equal(back.mesh.t, body.mesh.t)
    assert set(back.boundary_names) == {"surface", "core"}
    for name in body.boundary_names:
        np.testing.assert_array_equal(back.boundary_nodes(name), body.boundary_nodes(name))


@pytest.mark.parametrize("order", [1, 2])
def test_gmsh_reads_the_file_with_its_groups_and_our_reader_reads_what_gmsh_writes(tmp_path: Path, order: int) -> None:
    """gmsh is the other code here: it sees the same groups, and its MSH 4.1 comes back complete."""
    body = pin(order)
    path = write_msh(body, tmp_path / "x.msh")
    with gmsh_model("reader") as gmsh:
        gmsh.merge(str(path))
        names = {gmsh.model.getPhysicalName(*group): group[0] for group in gmsh.model.getPhysicalGroups()}
        qualities = []
        for _, tags, _ in [gmsh.model.mesh.getElements(2)]:
            qualities = gmsh.model.mesh.getElementQualities(np.concatenate(tags), "minDetJac")
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.write(str(tmp_path / "y.msh"))
    assert names == {"pin_3": 2, "surface": 1, "core": 1}
    assert len(qualities) == body.mesh.nelements
    assert min(qualities) > 0.0
    back = read_msh(tmp_path / "y.msh", required_boundaries=("surface", "core"))
    assert back.order == order
    assert back.unknowns == body.unknowns
    for name in body.boundary_names:
        nodes, ours = back.boundary_nodes(name), body.boundary_nodes(name)
        np.testing.assert_allclose(back.mesh.doflocs[:, nodes], body.mesh.doflocs[:, ours], atol=1e-14)


@pytest.mark.parametrize(("order", "kind"), [(1, "triangle"), (2, "triangle6")])
def test_vtu_keeps_curved_cells_and_fields(tmp_path: Path, order: int, kind: str) -> None:
    body = pin(order)
    displacement = np.column_stack([body.mesh.doflocs.T, np.zeros(body.node_count)])
    content = meshio.read(write_vtu(body, tmp_path / "x.vtu", {"displacement": displacement}))
    assert [block.type for block in content.cells] == [kind]
    np.testing.assert_array_equal(content.points, displacement)
    np.testing.assert_array_equal(content.point_data["displacement"], displacement)
    cells = content.cells[0].data
    if order == 2:
        # Third node but one of a straight inner edge lies halfway: checks the order of the mid-side nodes.
        middles = 0.5 * (content.points[cells[:, [0, 1, 2]]] + content.points[cells[:, [1, 2, 0]]])
        # A curved edge of 15° on R = 6.5 mm has a sagitta of 0.056 mm, far less than an edge is long.
        assert np.abs(content.points[cells[:, 3:]] - middles).max() < 0.06


def test_vtu_refuses_a_field_that_does_not_fit(tmp_path: Path) -> None:
    with error_says(MeshError, "field 'stress' has 3 values, but pin_3 has"):
        write_vtu(pin(), tmp_path / "x.vtu", {"stress": np.zeros(3)})
    assert list(tmp_path.iterdir()) == []


def test_every_cut_of_a_file_is_refused(tmp_path: Path, mesh_text: str) -> None:
    path = tmp_path / "cut.msh"
    for share in np.linspace(0.0, 0.999, 23):
        path.write_text(mesh_text[: int(share * len(mesh_text))], encoding="ascii")
        with error_says(MeshError, "cut.msh: corrupt"):
            read_msh(path)


def _replace_line(text: str, section: str, index: int, line: str) -> str:
    lines = text.splitlines()
    lines[lines.index(f"${section}") + index] = line
    return "\n".join(lines) + "\n"


def broken_files(text: str) -> dict[str, tuple[str | bytes, str]]:
    lines = text.splitlines()
    first_triangle = lines.index("$Elements") + 2
    corners = lines[first_triangle].split()
    swapped = corners.copy()
    swapped[-6], swapped[-5], swapped[-2], swapped[-1] = corners[-5], corners[-6], corners[-1], corners[-2]
    missing_node = [*corners[:-1], "999999"]
    return {
        "empty": ("", "corrupt or no gmsh mesh"),
        "binary rubbish": (bytes(range(256)) * 50, "corrupt or no gmsh mesh"),
        "another format": ("solid cube\nendsolid\n", "corrupt or no gmsh mesh"),
        "unknown version": (text.replace("2.2 0 8", "9.9 0 8"), "corrupt"),
        "words for numbers": (_replace_line(text, "Nodes", 5, "5 one two three"), "corrupt"),
        "node count too large": (_replace_line(text, "Nodes", 1, "99999999"), "corrupt"),
        "node that is not there": (_replace_line(text, "Elements", 2, " ".join(missing_node)), "corrupt|not there"),
        "not a number": (_replace_line(text, "Nodes", 2, "1 nan 0 0"), "corrupt|no numbers"),
        "inverted element": (_replace_line(text, "Elements", 2, " ".join(swapped)), r"1 inverted element\(s\)"),
        "missing boundary": (text.replace('"core"', '"cor"'), "has no boundary 'core'; its boundaries are: "),
    }


@pytest.mark.parametrize(
    "kind",
    [
        "empty",
        "binary rubbish",
        "another format",
        "unknown version",
        "words for numbers",
        "node count too large",
        "node that is not there",
        "not a number",
        "inverted element",
        "missing boundary",
    ],
)
def test_broken_files_end_in_one_clear_error(tmp_path: Path, mesh_text: str, kind: str) -> None:
    content, message = broken_files(mesh_text)[kind]
    path = tmp_path / "broken.msh"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(MeshError, match=message) as caught:
        read_msh(path, required_boundaries=("surface", "core"))
    assert str(caught.value).startswith(str(path))


def test_missing_file_and_folder(tmp_path: Path) -> None:
    with error_says(MeshError, "none.msh: no such file"):
        read_msh(tmp_path / "none.msh")
    with pytest.raises(MeshError, match="no such file"):
        read_msh(tmp_path)
    blocked = tmp_path / "file"
    blocked.write_text("x")
    with pytest.raises(CycloError, match="cannot be written"):
        write_msh(pin(), blocked / "x.msh")


def test_an_outline_without_a_name_is_refused(tmp_path: Path, mesh_text: str) -> None:
    lines = mesh_text.splitlines()
    start = lines.index("$Elements")
    count = int(lines[start + 1])
    # The last element is a boundary line: drop it.
    lines[start + 1] = str(count - 1)
    del lines[start + 1 + count]
    path = tmp_path / "open.msh"
    path.write_text("\n".join(lines) + "\n")
    with error_says(MeshError, "1 outer edges belong to no named boundary"):
        read_msh(path, required_boundaries=("surface", "core"))
    with pytest.raises(MeshError, match="is not a closed line"):
        read_msh(path).boundary_nodes("surface")


def test_missing_system_library_names_the_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    class Blocker:
        def find_spec(self, name: str, path: object = None, target: object = None) -> None:
            if name == "gmsh":
                raise OSError("libGLU.so.1: cannot open shared object file: No such file or directory")

    monkeypatch.delitem(sys.modules, "gmsh", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Blocker(), *sys.meta_path])
    with pytest.raises(MeshError) as caught:
        load_gmsh()
    message = str(caught.value)
    assert "libGLU.so.1" in message
    assert "libglu1-mesa libgl1 libxft2 libxcursor1 libxinerama1 libgomp1 libegl1" in message
    assert ".ci/system-libraries" in message


@pytest.mark.parametrize("order", [1, 2])
def test_a_moved_mesh_has_the_facets_that_scikit_fem_would_find(order: int) -> None:
    body = pin(order)
    turned = body.turned(0.3)
    fresh = type(body.mesh)(turned.mesh.doflocs, turned.mesh.t, sort_t=False, validate=False)
    for name in ("facets", "t2f", "f2t"):
        np.testing.assert_array_equal(getattr(turned.mesh, name), getattr(fresh, name), err_msg=name)
    np.testing.assert_array_equal(turned.boundary_nodes("core")[:, 1] >= 0, True)
