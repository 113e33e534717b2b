"""STEP files read back by gmsh: one solid each, closed, the exact flank within a micron, section and volume, names."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from fem.errors import MeshError
from fem.export import solids
from fem.export.solids import write_solids
from fem.mesh.gmsh_session import gmsh_model
from ltca.drive.single_discs import single_discs
from ltca.export.parts import make_parts
from ltca.geometry.flank import FlankProfile

MICRON = 1e-3
SAME_SECTION = 1e-4  # the limit


def read_back(path, look):
    with gmsh_model("read back") as gmsh:
        gmsh.model.occ.importShapes(str(path), highestDimOnly=False)
        gmsh.model.occ.synchronize()
        return look(gmsh)


def places_of(gmsh, tag, count):
    """Points along a curve."""
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, tag)
    return np.array(gmsh.model.getValue(1, tag, np.linspace(low, high, count))).reshape(-1, 3)


@pytest.mark.parametrize(
    ("kind", "disc", "inward"),
    [
        ("paper", 0, 0.0),
        pytest.param("robot-joint", 1, 0.0, marks=pytest.mark.nightly),
        pytest.param("rv", 0, 0.0, marks=pytest.mark.slow),
        pytest.param("many", 0, 0.0, marks=pytest.mark.nightly),
        pytest.param("plastic", 0, 0.2, marks=pytest.mark.slow),
    ],
)
def test_a_disc_read_back(kinds_of_drives, tmp_path, kind, disc, inward):
    drive = kinds_of_drives[kind]
    part = make_parts(drive, "nominal", disc=disc, compensation=inward)[0]
    write_solids(part, tmp_path / "part.step")
    (body,) = part.bodies

    def look(gmsh):
        (solid,) = gmsh.model.getEntities(3)
        faces = gmsh.model.getBoundary([solid], oriented=False)
        # Closed: every edge of the shell belongs to two faces, or twice to one (the seam of a cylinder).
        edges = [edge for face in faces for edge in gmsh.model.getBoundary([face], oriented=False, combined=False)]
        assert all(edges.count(edge) == 2 for edge in set(edges))
        caps = [
            gmsh.model.occ.getMass(*face) for face in faces if np.ptp(gmsh.model.getBoundingBox(*face)[2::3]) < 1e-3
        ]
        heights = gmsh.model.getBoundingBox(*solid)[2::3]
        lines = [
            places_of(gmsh, tag, 200)
            for dimension, tag in gmsh.model.getEntities(1)
            if gmsh.model.getType(dimension, tag) == "BSpline"
        ]
        assert len(lines) >= 2 * 2 * drive.disc.number_of_teeth  # cut at roots and tips, on either face
        return caps, heights, np.concatenate(lines), gmsh.model.occ.getMass(*solid)

    caps, heights, line, volume = read_back(tmp_path / "part.step", look)
    assert heights == pytest.approx((0.0, drive.disc.thickness), abs=1e-5)  # boxes are widened by 1e-7 and more
    assert len(caps) == 2
    assert caps == pytest.approx([body.section] * 2, rel=SAME_SECTION)
    assert volume == pytest.approx(body.section * drive.disc.thickness, rel=SAME_SECTION)
    flank = FlankProfile.of_drive(single_discs(drive)[disc])
    points = line[:, 0] + 1j * line[:, 1]
    foot = flank.nearest_point(points, np.angle((points - flank.centre) / flank.turn)).parameter
    assert np.max(np.abs(flank.distance(points, foot) + inward)) < MICRON


def test_every_body_is_a_named_product(kinds_of_drives, tmp_path):
    """In their places: what is called pin 7 stands where pin 7 is; slots are surfaces."""
    (part,) = make_parts(kinds_of_drives["sleeved"], "nominal", "pin-wheel")
    write_solids(part, tmp_path / "part.step")

    def look(gmsh):
        names, centres = [], []
        for solid in gmsh.model.getEntities(3):
            names.append(gmsh.model.getEntityName(*solid).rpartition("sleeved nominal ")[2])
            centres.append(gmsh.model.occ.getCenterOfMass(*solid))
        return names, np.array(centres), len(gmsh.model.getEntities(2))

    names, centres, faces = read_back(tmp_path / "part.step", look)
    assert names == [body.name for body in part.bodies]
    assert faces == 30 * 3 + 30
    for body, centre in zip(part.bodies, centres, strict=True):
        assert complex(*centre[:2]) == pytest.approx(body.outer.centre, abs=1e-6)
        assert centre[2] == pytest.approx(13.0, abs=1e-5)
    text = (tmp_path / "part.step").read_text()
    assert len(re.findall(r"PRODUCT\('sleeved nominal slot \d+'", text)) == 30
    assert "Open CASCADE STEP translator" not in text


@pytest.mark.slow
def test_an_assembly_has_a_solid_for_each_body(kinds_of_drives, tmp_path):
    (part,) = make_parts(kinds_of_drives["robot-joint"], "nominal", "assembly")
    write_solids(part, tmp_path / "part.step")
    names = read_back(
        tmp_path / "part.step", lambda gmsh: [gmsh.model.getEntityName(*solid) for solid in gmsh.model.getEntities(3)]
    )
    assert [name.rpartition("/")[2] for name in names] == [f"robot-joint nominal {body.name}" for body in part.bodies]


def test_the_same_input_gives_the_same_bytes(kinds_of_drives, tmp_path):
    """The kernel writes the time and counts its files; neither is left."""
    (part,) = make_parts(kinds_of_drives["paper"], "CS-1", "pin-wheel", compensation=0.05)
    for name in ("one", "other"):
        write_solids(part, tmp_path / f"{name}.step")
    one = (tmp_path / "one.step").read_text()
    assert one == (tmp_path / "other.step").read_text()
    assert not re.search(r"20\d\d-\d\d-\d\d", one)
    assert "compensation 0.05 mm" in one.split("ENDSEC;")[0]


def test_names_beyond_ascii_and_quotes(kinds_of_drives, tmp_path):
    """ISO 10303-21: quotes doubled, letters by their code points; what reads it gets the name back."""
    drive = replace(kinds_of_drives["paper"], name="Größe 'A' 輪 𝄞")
    (part,) = make_parts(drive, "CS-1", "pin-shaft")
    write_solids(part, tmp_path / "part.step")
    text = (tmp_path / "part.step").read_text(encoding="ascii")
    assert r"PRODUCT('Gr\X2\00F600DF\X0\e ''A'' \X2\8F2A\X0\ \X4\0001D11E\X0\ CS-1 pin-shaft'" in text


def test_a_solid_of_a_wrong_volume_is_refused(kinds_of_drives, tmp_path, monkeypatch):
    """As one closed spline the kernel reads a flank wrong."""
    monkeypatch.setattr(solids, "SAME_VOLUME", 1e-7)
    with error_says(MeshError, "gmsh made disc with ", " its section times its height is"):
        write_solids(make_parts(kinds_of_drives["paper"], "CS-1")[0], tmp_path / "part.step")
    assert list(tmp_path.iterdir()) == []
