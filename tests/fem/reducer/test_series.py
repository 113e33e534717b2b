"""One position after the other: what travels saves work and changes no bit, whatever came before."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

import fem.drive.solution as stages
from fem.drive.condensed import ENTRIES_KEPT, condense_drive, keep_rounds
from fem.drive.expected_contacts import expect_contacts
from fem.drive.meshes import mesh_drive
from fem.errors import MeshError
from fem.options import SolutionOptions
from fem.reducer.series import solve_positions
from fem.reducer.solution import solve_reducer
from fem.reducer.solution_files import summarise
from fem.shapes import DriveShapes

ANGLES, SIZE = (0.5, 1.4), 6.0


def answer(solution):
    """All that a solution says, less the clock."""
    return {name: value for name, value in summarise(solution).items() if not name.startswith("seconds")}


@pytest.mark.nightly
@pytest.mark.slow
def test_a_position_after_its_neighbour_is_that_position_alone(paper_cases):
    """To the last bit, not to a tolerance: so a resumed or reordered series ends with the same files."""
    first, second = solve_positions(paper_cases["CS-1"], ANGLES, SolutionOptions(size=SIZE))
    alone = solve_reducer(paper_cases["CS-1"], ANGLES[1], SolutionOptions(size=SIZE))
    (one,), (other,) = second.discs, alone.discs
    np.testing.assert_array_equal(one.state.contact.pressure, other.state.contact.pressure)
    np.testing.assert_array_equal(one.pose.roller_distances, other.pose.roller_distances)
    assert answer(second) == answer(alone)
    before = {id(group) for group in first.rounds}
    assert any(id(group) in before for group in one.model.groups)  # something did travel


@pytest.fixture(scope="module")
def condense(paper_cases):
    """Condense the drive of another make on meshes of one: coarse, none is solved."""
    drive = paper_cases["CS-1"]
    shapes, contacts = DriveShapes.of_drive(drive), expect_contacts(drive, 0.5)
    meshes = mesh_drive(shapes, contacts, SolutionOptions(size=8.0, growth=0.6))

    def of(made, known=(), **options):
        return condense_drive(made, shapes, contacts, meshes, known=known, **options).groups

    return of


@pytest.mark.slow
def test_pins_and_rollers_are_taken_only_where_all_that_they_are_made_of_is_the_same(condense, paper_cases):
    """Material, thickness and plane state belong to the stiffness as the shape does."""
    drive = paper_cases["CS-1"]
    known = condense(drive)
    taken = {id(group) for group in known}

    def reused(made, **options):
        return [id(group) in taken for group in condense(made, known, **options)]

    pins = sum(group.made_of.held == "core" for group in known)
    assert 0 < pins < len(known)
    assert all(reused(drive))
    soft = dataclasses.replace(drive.materials.roller, youngs_modulus=150_000.0)
    other_rollers = dataclasses.replace(drive, materials=dataclasses.replace(drive.materials, roller=soft))
    assert reused(other_rollers) == [True] * pins + [False] * (len(known) - pins)
    assert not any(reused(dataclasses.replace(drive, disc=dataclasses.replace(drive.disc, thickness=10.0))))
    assert not any(reused(drive, plane="stress"))


def test_a_coarse_mesh_too_flat_for_fast_growth_is_made_with_slow_growth():
    """Fast growth saves time; where gmsh makes bad triangles of it, the drive is solved all the same."""
    tried = []

    def mesh(contacts, options, rounds):
        tried.append((options.size, options.growth))
        if options.growth == stages.COARSE_GROWTH:
            raise MeshError("too distorted")

    disc = SimpleNamespace(mesh=mesh, condense=lambda *words: "model")
    task = SimpleNamespace(options=SolutionOptions(), say=None)
    assert stages.Task.condense_coarse(task, disc, None, ()) == "model"
    assert tried == [(4.0, stages.COARSE_GROWTH), (4.0, 0.3)]


def test_the_oldest_pins_and_rollers_are_dropped_first():
    """What travels is bounded, so that a long series needs no more memory than a short one."""
    groups = [SimpleNamespace(made_of=number, entries=ENTRIES_KEPT // 10) for number in range(13)]
    known = keep_rounds((), tuple(groups[:10]))
    known = keep_rounds(known, (groups[0], *groups[10:]))
    # 1 to 3 made room; 0 was used again and counts as new
    assert [group.made_of for group in known] == [4, 5, 6, 7, 8, 9, 0, 10, 11, 12]
    # What is in use stays, however much it is.
    large = SimpleNamespace(made_of="large", entries=2 * ENTRIES_KEPT)
    assert keep_rounds(known, (large,)) == (large,)
