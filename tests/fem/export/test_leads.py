"""Flanks with a lead along their width, as solids and as facets: read back where the formulas of the fields say they are."""

from __future__ import annotations

import ezdxf
import meshio
import numpy as np
import pytest
from refusals import error_says

from fem.export.facets import write_facets
from fem.export.solids import ALONG_WIDTH, write_solids
from fem.mesh.gmsh_session import gmsh_model
from ltca.commands.program import main
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.export.drawing import write_drawing
from ltca.export.parts import make_parts
from ltca.export.point_tables import write_tables
from ltca.geometry.flank import FlankProfile
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text

PROMISED = 2.5e-4
"""mm: of docs/how-to/export.md."""
FLOAT32 = 1e-5  # mm: 24 bits of some 100 mm
CROWN = {"disc.lead_crown_drop": 0.004}
ALL = {
    "disc.lead_crown_drop": 0.01, "disc.lead_slope": 1e-3, "disc.lead_relief_length": 2.0, "disc.lead_relief_depth": 0.02,
}  # fmt: skip


def drive_with(changes):
    return with_fields(load_drive("paper").cases["CS-1"], {"contact.slices": 5} | changes)


def short_of(disc, z):
    """By how much the flank falls short at a height above the middle, by the meaning of the fields."""
    half = 0.5 * disc.thickness
    beyond = np.maximum(np.abs(z) - half + disc.lead_relief_length, 0.0) / (disc.lead_relief_length or 1.0)
    return disc.lead_crown_drop * (z / half) ** 2 + disc.lead_relief_depth * beyond**2 - disc.lead_slope * z


def departures(drive, places, inward=0.0):
    """How far points, lower face at z = 0, lie outside the flank, mm."""
    single = single_discs(drive)[0]
    flank, points = FlankProfile.of_drive(single), places[:, 0] + 1j * places[:, 1]
    foot = flank.nearest_point(points, np.angle((points - flank.centre) / flank.turn)).parameter
    return flank.distance(points, foot) + inward + short_of(single.disc, places[:, 2] - 0.5 * single.disc.thickness)


SHALLOW = {"disc.lead_slope": -2e-4, "disc.lead_relief_length": 3.0, "disc.lead_relief_depth": 0.004}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "inward"),
    [
        (CROWN, 0.0),
        pytest.param(SHALLOW, 0.1, marks=pytest.mark.slow),
        pytest.param(ALL, 0.0, marks=pytest.mark.nightly),
    ],
)
def test_a_solid_follows_its_lead(tmp_path, changes, inward):
    drive = drive_with(changes)
    (part,) = make_parts(drive, "CS-1", compensation=inward)
    steps = list[str]()
    write_solids(part, tmp_path / "part.step", steps.append)
    # Minutes of a flank with a lead were silent: every outline of it is told before it is made.
    outlines = sum("outline " in step for step in steps)
    assert outlines == part.bodies[0].heights(ALONG_WIDTH).size >= 3
    assert steps[-2:] == ["volumes", "file"]
    with gmsh_model("read back") as gmsh:
        gmsh.model.occ.importShapes(str(tmp_path / "part.step"))
        gmsh.model.occ.synchronize()
        (solid,) = gmsh.model.getEntities(3)
        faces = gmsh.model.getBoundary([solid], oriented=False)
        edges = [edge for face in faces for edge in gmsh.model.getBoundary([face], oriented=False, combined=False)]
        assert all(edges.count(edge) == 2 for edge in set(edges))
        assert gmsh.model.occ.getMass(*solid) == pytest.approx(part.bodies[0].volume, rel=2e-5)
        walls = [tag for _, tag in faces if gmsh.model.getType(2, tag) not in ("Plane", "Cylinder")]
        assert len(walls) >= 2 * drive.disc.number_of_teeth
        found = []
        for tag in walls:
            low, high = gmsh.model.getParametrizationBounds(2, tag)
            u, v = np.meshgrid(np.linspace(low[0], high[0], 9), np.linspace(low[1], high[1], 41))
            found.append(np.reshape(gmsh.model.getValue(2, tag, np.stack([u, v], axis=-1).ravel()), (-1, 3)))
    assert np.max(np.abs(departures(drive, np.concatenate(found), inward))) < PROMISED


def test_volumes_with_a_lead_are_those_between_parallel_curves():
    """A parallel curve at h bounds A − h P + π h²: integrated over the width, that of the middle times it less ∫ h P."""
    drive = drive_with(ALL)
    body = make_parts(drive, "CS-1")[0].bodies[0]
    z = 11.8 * ((np.arange(200_000) + 0.5) / 200_000 - 0.5)
    short, theta = short_of(drive.disc, z), np.linspace(0.0, 2.0 * np.pi, 200_001)
    length = np.abs(np.diff(body.outer.flank.points(theta))).sum()
    cut = np.mean(np.pi * short**2 - length * short) * drive.disc.thickness
    # The sums over 200,000 pieces are good to 1e-9; the cut is 2e-4 of the volume.
    assert body.volume == pytest.approx(body.section * 11.8 + cut, rel=1e-8)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("changes", [CROWN, pytest.param(ALL, marks=pytest.mark.slow)])
def test_facets_follow_their_lead(tmp_path, changes):
    drive, chord = drive_with(changes), 0.02
    (part,) = make_parts(drive, "CS-1")
    write_facets(part, tmp_path / "part.stl", chord)
    mesh = meshio.read(tmp_path / "part.stl")
    corners = mesh.points[mesh.cells_dict["triangle"]]
    edges = {}
    for triangle in np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 3).tolist():
        for edge in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            edges[edge] = edges.get(edge, 0) + 1
    assert set(edges.values()) == {1}
    assert all(edge[::-1] in edges for edge in edges)
    enclosed = np.sum(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    assert enclosed == pytest.approx(
        part.bodies[0].volume, rel=4e-4
    )  # chords cut off two thirds of 0.02 mm of outlines
    radius = np.abs(corners[..., 0] + 1j * corners[..., 1])
    outside = corners[radius > 75.0]  # beyond all holes
    assert outside.shape[0] > 1000
    assert np.max(np.abs(departures(drive, outside))) < FLOAT32


def test_drawings_and_tables_hold_the_middle_and_say_so(tmp_path):
    drive, plain = drive_with(ALL), load_drive("paper").cases["CS-1"]
    for name, one in (("led", drive), ("plain", plain)):
        (part,) = make_parts(one, "CS-1")
        write_drawing(part, tmp_path / f"{name}.dxf")
        (tmp_path / name).mkdir()
        write_tables(part, tmp_path / name)
    led, straight = (ezdxf.readfile(tmp_path / f"{name}.dxf") for name in ("led", "plain"))
    splines = [next(iter(each.modelspace().query("SPLINE"))).control_points for each in (led, straight)]
    np.testing.assert_array_equal(*splines)
    told = "flank of disc: crown 0.01 mm, end relief 0.02 mm over 2 mm, slope 0.001 rad; the outline of a drawing or table is "
    assert dict(led.header.custom_vars.properties)["Lead 0"].startswith(told)
    texts = [next((tmp_path / name).glob("*_flank.csv")).read_text() for name in ("led", "plain")]
    assert f"# {told}" in texts[0]
    rows = [[line for line in text.splitlines() if not line.startswith("#")] for text in texts]
    assert rows[0] == rows[1]


def test_the_lead_of_each_disc_is_its_own():
    drive = drive_with({"disc.number_of_discs": 2, "disc.of.1.lead_slope": 1e-3})
    first, second = make_parts(drive, "CS-1")
    assert first.bodies[0].lead is None
    assert second.bodies[0].lead.lead_slope == 1e-3
    (whole,) = make_parts(drive, "CS-1", "assembly")
    assert [body.name for body in whole.bodies if body.lead is not None] == ["disc 1"]


@pytest.mark.parametrize(
    ("changes", "part", "field"),
    [
        ({"pin_wheel.inclination.x": 1e-3}, "pin-wheel", "pin_wheel.inclination"),
        ({"pin_wheel.pin_errors.inclination_y.3": 1e-3}, "assembly", "pin_wheel.pin_errors.inclination_y"),
        ({"pin_shaft.inclination.y": 1e-3}, "pin-shaft", "pin_shaft.inclination"),
        ({"disc.hole_errors.inclination_x.3": 1e-3}, "disc", "disc.hole_errors.inclination_x"),
        ({"crank.inclination.x": 1e-3}, "assembly", "crank.inclination"),
    ],
)
def test_inclinations_are_refused_where_bodies_stand_upright(tmp_path, capsys, changes, part, field):
    file = tmp_path / "tilted.toml"
    file.write_text(drive_text(drive_with(changes)))
    given = ["export", str(file), "--part", part, "--out", str(tmp_path / "out")]
    assert main([*given, "--format", "step"]) == 2
    assert f"{field}: inclinations are not written to STEP" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
    assert main([*given, "--format", "csv"]) == 0


def test_a_lead_that_folds_the_flank_is_refused():
    """A flank close to undercut has sharp places; it was told as a compensation that nobody gave."""
    drive = drive_with({"disc.lead_crown_drop": 0.45})
    path = FlankProfile.of_drive(drive)
    sharpest = 1.0 / np.max(path.locus(np.linspace(0.0, 2.0 * np.pi, 20_001)).curvature)
    offset = float(sharpest - drive.pin_wheel.pin_radius - 0.3)
    with error_says(DriveError, ": must be less than 0.15", " mm in size", starts="disc.lead_crown_drop = 0.45 mm"):
        make_parts(with_fields(drive, {"disc.equidistant_offset": offset}, check=False), "CS-1")
