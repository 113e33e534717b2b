"""Loads that meshes of solid discs are graded anew by, and their memory."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.drive.expected_contacts import expect_contacts
from fem.shapes import DriveShapes
from fem.solid_drive import solved_discs
from fem.solid_drive.along_width import DriveWidths
from fem.solid_drive.solid_model import SolidModel
from fem.solid_drive.solved_discs import SolutionOptions, require_solid_memory
from ltca.reading.drive_file import load_drive


def test_contacts_without_pairs_are_graded_for_no_load(monkeypatch):
    """The most loaded height counts over the whole width; contacts that were no candidates carry nothing."""
    kinds = (("pin", 1, 30.0), ("roller_outer", 2, 50.0), ("roller_inner", 2, 70.0), ("hole", 0, 8.0))
    pairs = tuple(SimpleNamespace(kind=kind, index=index) for kind, index, _ in kinds)
    along = tuple(SimpleNamespace(line_load=np.array([0.5, 1.0, 0.25]) * largest) for _, _, largest in kinds)
    lengths = {"pin": 10.0, "roller_outer": 12.0, "hole": 10.0}
    model = object.__new__(SolidModel)
    for name, value in (("pairs", pairs), ("widths", SimpleNamespace(length_of=lengths.get))):
        object.__setattr__(model, name, value)
    none = SimpleNamespace(pin_load=np.zeros(5), roller_load=np.zeros(4), pin_shaft_load=np.zeros(3))
    monkeypatch.setattr(solved_discs, "summarise_contacts", lambda *_: none)
    monkeypatch.setattr(solved_discs, "along_width", lambda *_: along)
    pins, rollers, holes = solved_discs.largest_loads(model, None)
    np.testing.assert_array_equal(pins, [0.0, 300.0, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(rollers, [0.0, 0.0, 600.0, 0.0])
    np.testing.assert_array_equal(holes, [80.0, 0.0, 0.0])


def test_unknowns_of_a_solid_disc_grow_with_those_above_each_node(monkeypatch):
    """Nodes of the section, the same of all, times the displacements above each, of all classes together."""
    asked = []
    monkeypatch.setattr(solved_discs, "require_memory", lambda unknowns, needed, what: asked.append((unknowns, needed)))
    drive = load_drive("paper").cases["CS-1"]
    shapes, contacts = DriveShapes.of_drive(drive), expect_contacts(drive, 0.5)
    above = []
    for layers in (3, 9):
        widths = DriveWidths(drive=drive, layers=layers)
        require_solid_memory([(shapes, contacts, widths)], SolutionOptions(size=6.0))
        above.append(sum(part.unknowns_per_node for part in widths.layers_of("disc")))
    (few, less), (many, more) = asked
    assert above[1] > 2.0 * above[0]
    assert many / few == pytest.approx(above[1] / above[0], rel=1e-12)
    assert few % above[0] == 0
    assert more > less
