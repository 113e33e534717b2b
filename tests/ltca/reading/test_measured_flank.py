"""Measured flanks read back: what was exported comes back as the same deviation and the same loads; bad files in one line."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

import ltca
from ltca.errors import DriveError
from ltca.export.parts import make_parts
from ltca.export.point_tables import write_tables
from ltca.geometry.flank import FlankProfile
from ltca.geometry.flank_deviation import ProfileDeviation
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.measured.points import read_points
from ltca.reading.writing import drive_text

DEVIATED = {
    "disc.profile_errors.orders": (2, 13, 26),
    "disc.profile_errors.cosine": (0.004, -0.002, 0.001),
    "disc.profile_errors.sine": (0.001, 0.002, 0.0),
}
LINE = 'measured_flank = "points.csv"\n'
NANOMETRE = 1e-6
THETA = np.linspace(0.0, 2.0 * np.pi, 5001)


@pytest.fixture(scope="module")
def deviated(paper_cases):
    return with_fields(paper_cases["CS-3"], DEVIATED)


@pytest.fixture(scope="module")
def exported(deviated, tmp_path_factory):
    """A folder with the points of a deviated flank beside a drive file that reads them."""
    folder = tmp_path_factory.mktemp("measured")
    flank, _ = write_tables(make_parts(deviated, "CS-3")[0], folder)
    flank.rename(folder / "points.csv")
    (folder / "drive.toml").write_text(shipped_drive().replace("[disc]\n", f"[disc]\n{LINE}"))
    return folder


def values(drive):
    return ProfileDeviation.of_errors(drive.disc.profile_errors).value_and_derivatives(np.exp(1j * THETA))


def between_flanks(one, other):
    """Largest distance of the flank of one drive from that of another, mm."""
    points = FlankProfile.of_drive(one).flank(THETA)
    flank = FlankProfile.of_drive(other)
    return np.max(np.abs(flank.distance(points, flank.nearest_point(points, THETA).parameter)))


def test_an_exported_flank_comes_back(exported, deviated):
    """As deviation, slope and curvature: what a cubic spline through 48 points a lobe leaves of the wave of order k = 26,
    5 h⁴k⁴/384, h³k⁴/24 and h²k⁴/8 of its 1 µm; nine decimals are far below.
    """
    step = 2.0 * np.pi / (48 * 13)
    read = load_drive(exported / "drive.toml").cases["CS-3"]
    found, known = values(read), values(deviated)
    for power, share, one, other in zip((4, 3, 2), (5 / 384, 1 / 24, 1 / 8), found, known, strict=True):
        assert one == pytest.approx(other, abs=share * step**power * 26**4 * 0.001)
    assert between_flanks(deviated, read) < 0.1 * NANOMETRE


@pytest.mark.slow
def test_loads_on_an_exported_flank_come_back(exported, deviated):
    """0.1 nm times some 3e5 N/mm of a contact are 3e-5 N; curvature and slope move loads by some 1e-6: 1e-5 of the largest."""
    read = load_drive(exported / "drive.toml").cases["CS-3"]
    one, other = (ltca.analyse(drive, positions=4).dataset["pin_load"].values for drive in (deviated, read))
    assert np.max(one) > 2000.0
    assert other == pytest.approx(one, abs=1e-5 * np.max(one))


def test_points_count_from_the_bore(exported, deviated, paper_cases, tmp_path):
    """Runout measured with the flank is part of its deviation; runout of the drive file is not counted twice."""
    off_centre = with_fields(deviated, {"disc.runout.amount": 0.004, "disc.runout.angle": 1.0})
    flank, _ = write_tables(make_parts(off_centre, "CS-3")[0], tmp_path)
    flank.rename(tmp_path / "points.csv")
    for more in ("", "runout = { amount = 0.004, angle = 1.0 }\n"):
        (tmp_path / "drive.toml").write_text(shipped_drive().replace("[disc]\n", f"[disc]\n{LINE}{more}"))
        read = load_drive(tmp_path / "drive.toml").cases["CS-3"]
        # What is no deviation of the design bends with the flank: 4 µm over 48 places a lobe leave a nanometre.
        assert between_flanks(off_centre, read) < NANOMETRE


def test_every_case_deviates_from_its_own_design(exported, tmp_path, deviated):
    """The flank that was measured is the same, whatever offsets a case compares it with."""
    text = shipped_drive().replace("[disc]\n", f'[disc]\nmeasured_flank = "{exported / "points.csv"}"\n')
    text += '[[case]]\nname = "other"\ndisc = { equidistant_offset = 0.14 }\n'
    (tmp_path / "drive.toml").write_text(text)
    cases = load_drive(tmp_path / "drive.toml").cases
    assert between_flanks(deviated, cases["other"]) < NANOMETRE
    # At the least 0.01 mm were taken away from the other design.
    assert np.mean(cases["other"].disc.profile_errors.deviation) == pytest.approx(-0.01, abs=1e-5)


def test_each_disc_has_its_own_file(kinds_of_drives, tmp_path):
    """Disc 1 of robot-joint is turned against its holes; its points are read in its own frame."""
    drive = kinds_of_drives["robot-joint"]
    own = tuple({"profile_errors": {"orders": [2], "cosine": [size]}} for size in (0.002, -0.001))
    text = shipped_drive("robot-joint").replace("number_of_discs = 2 ", "number_of_discs = 2 #")
    given = drive_text(drive)
    (tmp_path / "deviated.toml").write_text(
        given.replace("[disc]\n", "[disc]\nof = [{}, {}]\n".format(*(_inline(entry) for entry in own)))
    )
    deviated = load_drive(tmp_path / "deviated.toml").cases["nominal"]
    for number, part in enumerate(make_parts(deviated, "nominal")):
        flank, _ = write_tables(part, tmp_path)
        flank.rename(tmp_path / f"disc_{number}.csv")
    named = '[disc]\nof = [{ measured_flank = "disc_0.csv" }, { measured_flank = "disc_1.csv" }]\n'
    (tmp_path / "drive.toml").write_text(text.replace("[disc]\n", named))
    read = load_drive(tmp_path / "drive.toml").cases["nominal"]
    for found, known in zip(read.disc.of, deviated.disc.of, strict=True):
        one, other = (
            ProfileDeviation.of_errors(entry.profile_errors).value_and_derivatives(np.exp(1j * THETA))[0]
            for entry in (found, known)
        )
        assert one == pytest.approx(other, abs=NANOMETRE)
    # One disc's points are no points of the other, which is turned by half a lobe.
    wrong = text.replace("[disc]\n", '[disc]\nmeasured_flank = "disc_1.csv"\n')
    (tmp_path / "drive.toml").write_text(wrong)
    with error_says(DriveError, "disc.measured_flank: ", "disc_1.csv: line ", ": the point ", " off the flank"):
        load_drive(tmp_path / "drive.toml")


def _inline(entry):
    errors = entry["profile_errors"]
    return f"{{ profile_errors = {{ orders = {errors['orders']}, cosine = {errors['cosine']} }} }}"


def test_a_read_drive_is_written_with_its_numbers(exported):
    read = load_drive(exported / "drive.toml").cases["CS-3"]
    text = drive_text(read)
    assert "measured_flank" not in text
    # No engine can tell it from one whose numbers were written: each takes or refuses it as that one.
    assert parse_drive(text).cases["nominal"] == read


@pytest.mark.parametrize("separator", [";", *(pytest.param(other, marks=pytest.mark.slow) for other in ",\t")])
def test_what_measuring_machines_write(exported, deviated, tmp_path, separator):
    """Other separators and orders of columns, no names at all, points in any order, the first repeated as the last."""
    measured = read_points(exported / "points.csv")
    points = np.append(measured.points, measured.points[0])[::-1]
    rows = [separator.join(("P", f"{point.imag!r}", f"{point.real!r}")) for point in points.tolist()]
    (tmp_path / "points.csv").write_text("\n".join([separator.join(('"Name"', " Y ", "X")), *rows]))
    (tmp_path / "drive.toml").write_text((exported / "drive.toml").read_text())
    assert between_flanks(deviated, load_drive(tmp_path / "drive.toml").cases["CS-3"]) < NANOMETRE
    bare = [separator.join((f"{point.real!r}", f"{point.imag!r}")) for point in measured.points.tolist()]
    (tmp_path / "points.csv").write_text("# bare\n" + "\n".join(bare))
    assert between_flanks(deviated, load_drive(tmp_path / "drive.toml").cases["CS-3"]) < NANOMETRE


def scaled(lines, factor):
    return ["x,y", *(",".join(str(float(cell) * factor) for cell in line.split(",")[:2]) for line in lines)]


def noisy(lines):
    """A wave of 24 µm from point to point, 0.9 mm apart: by a (π/h)² its hollows have some 3.4 mm, less than the pins."""
    rows = [[float(cell) for cell in line.split(",")[:2]] for line in lines]
    return ["x,y", *(f"{x * (1 + (-1) ** k * 3e-4)},{y * (1 + (-1) ** k * 3e-4)}" for k, (x, y) in enumerate(rows))]


def turned_normals(lines):
    rows = [[float(cell) for cell in line.split(",")[:4]] for line in lines]
    return ["x,y,normal_x,normal_y", *(f"{x},{y},{-along},{-up}" for x, y, along, up in rows)]


BAD = {
    "empty": (lambda lines: [], "holds no points"),
    "names alone": (lambda lines: ["x,y"], "holds 0 points: must be at least 52, 4 a lobe"),
    "too few": (lambda lines: ["x,y", *lines[::20]], "holds 32 points: must be at least 52"),
    "columns": (lambda lines: ["a,b", *lines], "has no column x and no column y: the columns are 'a, b'"),
    "one normal": (lambda lines: ["x,y,normal_x", *lines], "has a column normal_x and none normal_y"),
    "nan": (lambda lines: ["x,y", *lines[:40], "nan,3", *lines[40:]], "line 42: x = 'nan': must be a finite number"),
    "text": (lambda lines: ["x,y", *lines[:40], "80,3 mm", *lines[40:]], "line 42: y = '3 mm': must be a finite number"),
    "short": (lambda lines: ["x,y", *lines[:40], "80", *lines[40:]], "line 42: y is missing"),
    "comma": (lambda lines: ["x;y", *("77,45;0,0" for _ in lines)], "line 2: x = '77,45': must be a finite number"),
    "inches": (lambda lines: scaled(lines, 1 / 25.4), "mm off the flank…they look like inches"),
    "metres": (lambda lines: scaled(lines, 1e-3), "they look like metres"),
    "frame": (lambda lines: ["y,x", *(f"{line.split(',')[1]},{float(line.split(',')[0]) + 3}" for line in lines)], "as `cyclo"),
    "half": (lambda lines: ["x,y", *lines[: len(lines) // 2]], "no points between θ = 3.1… and 6.2… rad"),
    "noise": (noisy, "the flank has a hollow of radius … mm at … passes through every point: filter noise"),
    "inward": (turned_normals, "line …: the normal … is more than 60° off"),
    "twice": (lambda lines: ["x,y", "77.5,0.0", *lines], "lines … and … are one place of the flank and differ by 0.0… mm"),
}  # fmt: skip


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_file_is_one_clear_line(exported, tmp_path, kind):
    change, told = BAD[kind]
    text = (exported / "points.csv").read_text().splitlines()
    (tmp_path / "points.csv").write_text("\n".join(change([line for line in text if line[0] not in "#x"])))
    (tmp_path / "drive.toml").write_text((exported / "drive.toml").read_text())
    with error_says(DriveError, *told.split("…")) as caught:
        load_drive(tmp_path / "drive.toml")
    assert len(caught.value.problems) == 1
    assert caught.value.problems[0].startswith("disc.measured_flank: ")
    assert "points.csv" in caught.value.problems[0]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ('measured_flank = "nowhere.csv"\n', "disc.measured_flank: …nowhere.csv: no such file"),
        ("measured_flank = 3\n", "disc.measured_flank = 3: must be the name of a CSV file"),
        ('measured_flank = "."\n', "disc.measured_flank: …: cannot be read"),
    ],
)  # fmt: skip
def test_a_bad_name_is_one_clear_line(tmp_path, line, told):
    (tmp_path / "drive.toml").write_text(shipped_drive().replace("[disc]\n", f"[disc]\n{line}"))
    with error_says(DriveError, *told.split("…")) as caught:
        load_drive(tmp_path / "drive.toml")
    assert len(caught.value.problems) == 1


def test_a_measured_flank_is_all_of_the_deviation(exported, tmp_path):
    text = (
        (exported / "drive.toml")
        .read_text()
        .replace("orders = [2, 3, 13, 26] }", "orders = [2], cosine = [0.001] }", 1)
    )
    (tmp_path / "points.csv").write_text((exported / "points.csv").read_text())
    (tmp_path / "drive.toml").write_text(text)
    with error_says(DriveError, "holds all of the deviation; leave out disc.profile_errors"):
        load_drive(tmp_path / "drive.toml")


def test_a_wrong_drive_is_told_before_its_measured_flank(exported, tmp_path):
    text = (exported / "drive.toml").read_text().replace("number_of_teeth = 13", "number_of_teeth = 14")
    (tmp_path / "drive.toml").write_text(text)
    with pytest.raises(DriveError, match="number_of_teeth"):
        load_drive(tmp_path / "drive.toml")


def test_a_compensated_flank_is_no_measured_one(tmp_path):
    """An export for a printer read back as an error of form of a tenth of a millimetre, in silence."""
    path = tmp_path / "flank.csv"
    path.write_text(
        "# compensation 0.1 mm: every face is moved into the material by 0.1 mm\nx,y\n1.0,2.0\n", encoding="utf-8"
    )
    with error_says(DriveError, "line 1: is a flank compensated for a printer"):
        read_points(path)
