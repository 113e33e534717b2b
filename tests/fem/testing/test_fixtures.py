"""The small meshes in ``meshes/``: as recorded, valid, and what their command makes."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fem.mesh.body_mesh import BodyMesh
from fem.mesh.mesh_file import read_msh
from fem.mesh.quality import require_quality
from fem.testing.fixtures import make_fixtures

FOLDER = Path(__file__).parents[3] / "meshes"
NAMES = ("disc", "pin_3", "roller_2", "inner_race", "cylinder_lower", "cylinder_upper", "reducer_disc")
NAMES += ("sleeved_pin", "sleeve")


@pytest.fixture(scope="module")
def made() -> dict[str, BodyMesh]:
    return {fixture.body.name: fixture.body for fixture in make_fixtures()}


@pytest.mark.parametrize("name", NAMES)
def test_files_are_as_the_readme_records_them(name: str) -> None:
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| {name}\.msh \|.*`([0-9a-f]{{64}})`", readme, re.MULTILINE)
    assert row is not None
    assert hashlib.sha256((FOLDER / f"{name}.msh").read_bytes()).hexdigest() == row.group(1)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_command_makes_the_same_bodies(made: dict[str, BodyMesh], name: str) -> None:
    """Other gmsh versions and processors may place inner nodes otherwise; outline and size must agree."""
    stored, fresh = read_msh(FOLDER / f"{name}.msh"), made[name]
    require_quality(stored)
    stored.require_complete_boundaries()
    assert set(stored.boundary_names) == set(fresh.boundary_names)
    for boundary in stored.boundary_names:
        # A closed chain may begin anywhere; mid-side nodes (column 1) tell the edges apart.
        ours, theirs = (body.mesh.doflocs[:, body.boundary_nodes(boundary)[:, 1]].T for body in (stored, fresh))
        assert len(ours) == len(theirs)
        assert np.max(cKDTree(ours).query(theirs)[0]) < 1e-9
    assert stored.unknowns == pytest.approx(fresh.unknowns, rel=0.02)
