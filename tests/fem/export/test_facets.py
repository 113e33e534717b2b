"""STL files read back: closed, within the chord, corners on the exact curves, volume; and the file itself."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from fem.export.facets import divide, write_facets
from ltca.export.flank_outline import FlankSpline
from ltca.export.parts import Circle, make_parts

FLOAT32 = 1e-5  # mm: 24 bits of some 100 mm


def read_back(path):
    mesh = meshio.read(path)
    return mesh.points[mesh.cells_dict["triangle"]]


def enclosed(corners):
    """Volume by the divergence theorem: right only where all triangles look outward."""
    return np.sum(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0


def is_closed(corners):
    """Every edge is there once in either direction."""
    places = np.ascontiguousarray(corners.reshape(-1, 3), dtype=np.float32).view("V12").ravel()
    _, number = np.unique(places, return_inverse=True)
    triangles = number.reshape(-1, 3)
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    there, back = (np.unique(edges @ size) for size in ([number.size, 1], [1, number.size]))
    return there.size == len(edges) and np.array_equal(there, back)


@pytest.mark.parametrize(
    ("kind", "inward"),
    [
        ("paper", 0.1),
        *(pytest.param(kind, inward, marks=pytest.mark.slow) for kind, inward in (("rv", 0.0), ("plastic", 0.2))),
    ],
)
def test_a_disc_read_back(kinds_of_drives, tmp_path, kind, inward):
    part = make_parts(kinds_of_drives[kind], "nominal", disc=0, compensation=inward)[0]
    count = write_facets(part, tmp_path / "part.stl", chord=0.001)
    corners = read_back(tmp_path / "part.stl")
    assert len(corners) == count
    assert is_closed(corners)
    (body,) = part.bodies
    # A micron all around: the chords cut off two thirds of it from outlines and add it to holes.
    assert enclosed(corners) == pytest.approx(body.section * body.top, rel=1e-4)
    assert (corners[..., 2].min(), corners[..., 2].max()) == pytest.approx((0.0, body.top))


@pytest.mark.parametrize("chord", [0.001, 0.05])
@pytest.mark.parametrize("kind", ["paper", "many", "plastic"])
def test_edges_keep_within_the_chord(kinds_of_drives, kind, chord):
    body = make_parts(kinds_of_drives[kind], "nominal", compensation=0.1)[0].bodies[0]
    spline = body.outer
    corners = divide(spline, chord)
    for share in (0.25, 0.5, 0.75):
        places = (1.0 - share) * corners + share * np.roll(corners, -1)
        near = np.angle(places - spline.flank.profile.centre)
        assert np.max(np.abs(spline.flank.departure(places, near))) <= chord
    # No finer than it must be: twice as many edges would be a quarter of the chord off.
    if chord > 0.01:
        return
    assert corners.size < 2 * spline.parameter.size + 60 * spline.flank.lobes


def test_circles_keep_within_the_chord_and_are_round(kinds_of_drives):
    circle = Circle(feature="pin", name="pin", radius=200.0)
    corners = divide(circle, 0.001)
    assert 200.0 - np.abs(0.5 * (corners + np.roll(corners, -1))).min() <= 0.001
    assert divide(Circle(feature="pin", name="pin", radius=1.0), 0.1).size == 360


def test_sleeves_and_pins_are_bodies_of_their_own(kinds_of_drives, tmp_path):
    (part,) = make_parts(kinds_of_drives["sleeved"], "nominal", "pin-shaft")
    write_facets(part, tmp_path / "part.stl")
    corners = read_back(tmp_path / "part.stl")
    assert is_closed(corners)
    pins, sleeves = np.pi * 4.5**2 * 24.0, np.pi * (6.0**2 - 4.51**2) * 22.0
    # Polygons of 360 edges: (2π²/3)/360² of the area each.
    assert enclosed(corners) == pytest.approx(10 * (pins + sleeves), rel=1e-4)


@pytest.mark.slow
def test_the_file_says_chord_and_unit_and_has_no_clock(kinds_of_drives, tmp_path):
    (part,) = make_parts(kinds_of_drives["paper"], "CS-1", compensation=0.1)
    for name in ("one", "other"):
        write_facets(part, tmp_path / f"{name}.stl", chord=0.01)
    content = (tmp_path / "one.stl").read_bytes()
    assert content == (tmp_path / "other.stl").read_bytes()
    assert content[:80].rstrip() == b"cyclo paper CS-1 disc, compensated 0.1 mm, mm, chord 0.01 mm"
    assert len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")


@pytest.mark.slow
def test_an_assembly_is_where_its_parts_are(kinds_of_drives, tmp_path):
    """Bodies of the robot joint's assembly in their heights and places, each closed."""
    (part,) = make_parts(kinds_of_drives["robot-joint"], "nominal", "assembly")
    discs = tuple(body for body in part.bodies if isinstance(body.outer, FlankSpline))
    assert [(body.bottom, body.top) for body in discs] == [(-10.5, -0.5), (0.5, 10.5)]
    alone = type(part)(name="assembly", drive=part.drive, case=part.case, frame=part.frame, bodies=discs)
    write_facets(alone, tmp_path / "part.stl")
    corners = read_back(tmp_path / "part.stl")
    assert is_closed(corners)
    assert enclosed(corners) == pytest.approx(2 * discs[0].section * 10.0, rel=1e-4)
    low = corners[corners[..., 2].max(axis=1) < 0.0]
    exact = discs[0].outer.points.real  # about a centre at +e: root on one side, half a lobe from it on the other
    assert (low[..., 0].min(), low[..., 0].max()) == pytest.approx((exact.min(), exact.max()), abs=0.002)
    assert np.mean(exact) == pytest.approx(1.0, abs=1e-6)
