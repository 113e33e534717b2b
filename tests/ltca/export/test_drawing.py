"""DXF files read back by ezdxf: the exact flank within a micron, closed, circles, layers, units; the same bytes every time."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from ltca.drive.single_discs import single_discs
from ltca.export.drawing import write_drawing
from ltca.export.parts import make_parts
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement

ROOT = Path(__file__).parents[3]
MICRON = 1e-3


def read_back(part, path):
    write_drawing(part, path)
    document = ezdxf.readfile(path)
    assert document.audit().errors == []
    return document


def line_of(spline, count):
    tool = spline.construction_tool()
    points = np.array([(p.x, p.y) for p in tool.points(np.linspace(0.0, tool.max_t, count))])
    return points[:, 0] + 1j * points[:, 1]


@pytest.mark.parametrize(
    ("kind", "disc", "inward"),
    [
        ("paper", 0, 0.0), ("sleeved", 0, 0.1), ("plastic", 0, 0.2),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in [("robot-joint", 1, 0.0), ("rv", 1, 0.0), ("many", 0, 0.0)]),
    ],
)  # fmt: skip
def test_read_back_within_a_micron_of_the_exact_flank(kinds_of_drives, tmp_path, kind, disc, inward):
    drive = kinds_of_drives[kind]
    part = make_parts(drive, "nominal", disc=disc, compensation=inward)[0]
    space = read_back(part, tmp_path / "part.dxf").modelspace()
    (spline,) = space.query("SPLINE")
    assert spline.dxf.degree == 3
    assert spline.fit_point_count() == 0
    assert tuple(spline.control_points[0]) == tuple(spline.control_points[-1])
    # Some eight places between two control points, at no rhythm with them.
    line = line_of(spline, 8 * spline.control_point_count() + 7)
    single = single_discs(drive)[disc]
    flank = FlankProfile.of_drive(single)
    # θ is within an eccentricity over the radius of the polar angle about the centre of the flank: on the same lobe.
    near = np.angle((line - flank.centre) / flank.turn)
    foot = flank.nearest_point(line, near).parameter
    assert np.max(np.abs(flank.distance(line, foot) + inward)) < MICRON
    # It runs once around: no foot is left out.
    turns = np.unwrap(foot)
    assert np.all(np.diff(turns) > 0.0)
    assert turns[-1] - turns[0] == pytest.approx(2.0 * np.pi, abs=1e-9)


def test_circles_layers_and_units(kinds_of_drives, tmp_path):
    drive = kinds_of_drives["plastic"]
    document = read_back(make_parts(drive, "nominal", compensation=0.1)[0], tmp_path / "part.dxf")
    assert document.header["$INSUNITS"] == 4  # mm
    assert document.header["$MEASUREMENT"] == 1
    tip = 88.09 + 4.0 - 6.65  # half a lobe from +x
    assert tip * np.cos(np.pi / 13) - 0.2 < document.header["$EXTMAX"][0] < tip
    assert dict(document.header.custom_vars.properties)["Compensation"].startswith("compensation 0.1 mm")
    space = document.modelspace()
    by_layer = {layer: space.query(f'*[layer=="{layer}"]') for layer in ("FLANK", "BORE", "HOLE")}
    assert [len(found) for found in by_layer.values()] == [1, 1, 8]
    assert len(space) == 10
    placement = Placement.of_drive(drive)
    for hole, centre, radius in zip(by_layer["HOLE"], placement.hole_centres, placement.hole_radii, strict=True):
        assert complex(hole.dxf.center.x, hole.dxf.center.y) == pytest.approx(centre, abs=1e-12)
        assert hole.dxf.radius == pytest.approx(radius + 0.1, abs=1e-12)


@pytest.mark.slow
def test_an_assembly_has_layers_for_each_disc(kinds_of_drives, tmp_path):
    (part,) = make_parts(kinds_of_drives["sleeved"], "nominal", "assembly")
    space = read_back(part, tmp_path / "part.dxf").modelspace()
    count = {layer: len(space.query(f'*[layer=="{layer}"]')) for layer in {entity.dxf.layer for entity in space}}
    assert count == {
        "PIN": 30, "SLOT": 30, "SHAFT_PIN": 10, "SHAFT_SLEEVE": 10, "SHAFT_SLEEVE_BORE": 10,
        **{f"DISC_{k}_{name}": count for k in range(2)
           for name, count in {"FLANK": 1, "BORE": 1, "HOLE": 10, "INNER_RACE": 1, "ROLLER": 15}.items()},
    }  # fmt: skip


@pytest.mark.slow
def test_the_same_input_gives_the_same_bytes(paper_cases, tmp_path):
    """In another process, whose sets have another order, and at another time."""
    code = (
        "from pathlib import Path; from ltca.reading.drive_file import load_drive\n"
        "from ltca.export.parts import make_parts; from ltca.export.drawing import write_drawing\n"
        "drive = load_drive('paper').cases['CS-3']\n"
        f"[write_drawing(part, Path('{tmp_path / 'there.dxf'}')) for part in make_parts(drive, 'CS-3')]"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "12345"}
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, env=environment, timeout=300)
    write_drawing(make_parts(paper_cases["CS-3"], "CS-3")[0], tmp_path / "here.dxf")
    assert (tmp_path / "here.dxf").read_bytes() == (tmp_path / "there.dxf").read_bytes()


def test_drawings_come_with_the_default_install():
    """`cyclo export --format dxf` refused until an extra was installed; the name of the extra stays."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert any(name.startswith("ezdxf>=") for name in project["dependencies"])
    assert project["optional-dependencies"]["cad"] == []
