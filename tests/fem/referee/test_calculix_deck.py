"""What the deck asks of CalculiX's contact, without running it."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness
from fem.body.surface import OppositeZone
from fem.drive.meshes import RoundEnd, RoundGrading
from fem.drive.solution import solve_drive
from fem.options import SolutionOptions
from fem.referee.calculix_deck import PENALTY_FACTOR, even_support, write_deck
from ltca.drive.parts import Material
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


def values_after(lines, keyword):
    """The data line of every card with this keyword."""
    return [after for line, after in pairwise(lines) if line.startswith(keyword)]


@pytest.mark.nightly
@pytest.mark.slow
def test_the_penalty_gives_way_alike_on_every_mesh(tmp_path):
    """By the edge it was four times as stiff at the default size as at size 4, and ccx ended with contacts that pull there."""
    drive = load_drive("paper").cases["CS-1"]
    stiffness = {}
    for size in (6.0, 4.0):
        solution = solve_drive(drive, 0.5, SolutionOptions(size=size))
        lines = write_deck(solution, tmp_path / "drive.inp").read_text(encoding="ascii").splitlines()
        found = np.array(values_after(lines, "*SURFACE BEHAVIOR"), dtype=float)
        width = np.array([pair.expected_half_width for pair in solution.model.pairs])
        # Written with six digits.
        assert found == pytest.approx(PENALTY_FACTOR * drive.materials.disc.youngs_modulus / width, rel=1e-5)
        stiffness[size] = found
        # The number of points that touch must stand still before an answer counts, and none is removed at random.
        (controls,) = values_after(lines, "*CONTROLS, PARAMETERS=CONTACT")
        change, at_random = map(float, controls.split(",")[:2])
        assert change == 0.0
        assert at_random == 0.0
    # The half-widths are those expected from the loads of a coarse solution: alike within a few per cent.
    assert stiffness[6.0] == pytest.approx(stiffness[4.0], rel=0.05)


@pytest.mark.parametrize("edge", [0.1, 0.02])
def test_a_hundred_nodes_carry_a_pin_as_its_whole_area_does(edge):
    """By the elasticity of the finite elements: a force spread evenly does not move a free body against its own mean."""
    grading = RoundGrading(radius=5.0, core_radius=0.0, ends=(RoundEnd(edge=edge, half_width=0.2),), coarse_size=0.8)
    body = grading.mesh("pin")
    nodes, shares = even_support(body)
    assert 80 < len(nodes) <= 100
    assert np.sum(shares) == pytest.approx(1.0, abs=1e-12)
    # The force acts at the centre: no moment.
    assert body.mesh.doflocs[:, nodes] @ shares == pytest.approx(np.zeros(2), abs=1e-10)
    material, thickness = Material(youngs_modulus=206_000.0, poisson_ratio=0.3), 10.0
    pressed = OppositeZone.on_circle(body, "surface", 5.0 + 0j, 0.2).nodes
    contact, carried = np.zeros(body.unknowns), np.zeros((2, body.unknowns))
    contact[2 * pressed] = -1.0 / len(pressed)
    for direction in (0, 1):
        carried[direction, 2 * nodes + direction] = shares
    loads = sp.csc_matrix(np.vstack([contact, carried]).T)
    stiffness = assemble_stiffness(body, material, thickness=thickness, state="strain")
    moved = condense_body(body, stiffness, loads).compliance
    # A hundredth of the force at each node dents its surroundings by 0.2 % of what the contact yields against the mean,
    # 0.5 % with 50 nodes, and moves the contact by as much; 2.5 % with nodes of large elements alone.
    assert np.max(np.abs(moved[1:])) < 3e-3 * moved[0, 0]


@pytest.mark.slow
def test_elastic_shaft_pins_are_bodies_of_their_own(tmp_path):
    """The deck refused them."""
    fields = {"pin_shaft.elastic_contact": True, "materials.shaft_pin.youngs_modulus": 110_000.0}
    drive = with_fields(load_drive("paper").cases["CS-1"], fields)
    solution = solve_drive(drive, 0.5, SolutionOptions(size=6.0))
    lines = write_deck(solution, tmp_path / "drive.inp").read_text(encoding="ascii").splitlines()
    holes = [pair.index for pair in solution.model.pairs if pair.kind == "hole"]
    assert len(holes) >= 2
    assert not [line for line in lines if "RIGID" in line]
    for hole in holes:
        assert f"*ELEMENT, TYPE=CPE6, ELSET=HOLE_{hole}" in lines
        moduli = lines[lines.index(f"*MATERIAL, NAME=M_HOLE_{hole}") + 2]
        assert float(moduli.split(",")[0]) == 110_000.0
        for direction in (1, 2):
            at = lines.index(f"*SPRING, ELSET=SPRING_{hole}_{direction}")
            assert float(lines[at + 2]) == pytest.approx(drive.hole_stiffness, rel=1e-9)
