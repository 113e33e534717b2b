"""The table of cylinders with free ends is what finite elements in three dimensions say of them."""

import json

import numpy as np
import pytest

from fem.coefficients.pieces import Pieces
from fem.coefficients.solid_bodies import SolidOptions
from fem.coefficients.solid_dataset import SectionMesh, solid_round
from fem.mesh.boundary_division import MAX_TURN
from fem.shapes import CircleShape
from ltca.compliance.solid_cylinder import free_ends_of_cylinder
from ltca.drive.parts import Material

pytestmark = pytest.mark.slow


def test_a_cylinder_between_those_of_the_table_is_as_soft_as_finite_elements_say(tmp_path, monkeypatch):
    """ν and R/t between rows and columns, another modulus and radius.

    The parabola over ν and straight lines over ln R/t leave some thousandths of κ, beside the approach of a pin of 3 to 4 κ (and
    meshes twice as coarse 0.007 κ).
    """
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    nu, radius, length, modulus = 0.35, 3.0, 9.0, 2600.0
    options = SolidOptions(
        thickness=length, layers=4, tell=lambda _: None, pieces=Pieces.of_key(json.dumps(["test", nu, length]))
    )
    shape, at = CircleShape(name="cylinder", radius=radius, core_radius=0.0), np.zeros(1)
    material = Material(youngs_modulus=modulus, poisson_ratio=nu)
    found = solid_round("solid cylinder", shape, at, at, material, SectionMesh(1.0, MAX_TURN), options)
    unit = 2.0 * (1.0 - nu**2) / (np.pi * modulus * length)
    even, linear = free_ends_of_cylinder(radius, length, nu)
    assert found.even[0, 0] / unit == pytest.approx(even, abs=6e-3)
    assert found.linear[0, 0] / unit * length**2 / 12.0 == pytest.approx(linear, abs=1.2e-2)
