"""CSV files: what they say of themselves, points on the exact flank, normals and curvature of those very points."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from ltca.export.parts import make_parts
from ltca.export.point_tables import write_tables
from ltca.geometry.flank import FlankProfile


def read(path):
    text = path.read_text(encoding="utf-8").splitlines()
    remarks = [line for line in text if line.startswith("#")]
    return remarks, list(csv.DictReader(line for line in text if not line.startswith("#")))


def test_points_normals_and_curvature_of_a_flank(kinds_of_drives, tmp_path):
    drive = kinds_of_drives["plastic"]
    flank_file, _ = write_tables(make_parts(drive, "nominal", compensation=0.1)[0], tmp_path)
    assert flank_file.name == "plastic_nominal_disc_compensated_0.1mm_flank.csv"
    remarks, rows = read(flank_file)
    assert any("mm" in remark for remark in remarks)
    assert any("compensation 0.1 mm" in remark for remark in remarks)
    x, y, along_x, along_y, curvature, theta = (np.array([float(row[name]) for row in rows]) for name in rows[0])
    points, normals = x + 1j * y, along_x + 1j * along_y
    flank = FlankProfile.of_drive(drive)
    # The last of nine decimals.
    assert points + 0.1 * normals == pytest.approx(flank.flank(theta), abs=3e-9)
    assert np.abs(normals) == pytest.approx(1.0, abs=3e-9)
    # Across the chord of both neighbours, whose lengths differ by up to a tenth: second order of 0.3 mm on 4 mm.
    chord = np.roll(points, -1) - np.roll(points, 1)
    assert np.max(np.abs((chord * normals.conjugate()).real / np.abs(chord))) < 0.02
    # Steiner: 1/κ shrinks by what the flank moves inward.
    bent = np.abs(curvature) > 1e-3
    assert 1.0 / curvature[bent] == pytest.approx(1.0 / flank.curvature(theta)[bent] - 0.1, rel=1e-5)


def test_circles_in_a_row_each(kinds_of_drives, tmp_path):
    (path,) = write_tables(make_parts(kinds_of_drives["sleeved"], "nominal", "pin-wheel")[0], tmp_path)
    _, rows = read(path)
    assert len(rows) == 60
    assert rows[30] == {
        "name": "slot 0", "x": "70.000000000", "y": "0.000000000", "radius": "3.510000000", "bottom": "0.000000000",
        "top": "26.000000000",
    }  # fmt: skip


def test_an_assembly_has_a_file_for_each_flank(kinds_of_drives, tmp_path):
    written = write_tables(make_parts(kinds_of_drives["robot-joint"], "nominal", "assembly")[0], tmp_path)
    assert [path.name for path in written] == [
        "robot-joint_nominal_assembly_disc_0_flank.csv", "robot-joint_nominal_assembly_disc_1_flank.csv",
        "robot-joint_nominal_assembly_circles.csv",
    ]  # fmt: skip
    _, rows = read(written[1])
    # Disc 1 stands at −e; its root at −π/39 is half a lobe from the pin there.
    centre = np.mean([complex(float(row["x"]), float(row["y"])) for row in rows])
    assert centre == pytest.approx(-1.0, abs=1e-6)
