"""What is told beforehand of a solid derivation."""

import pytest

from fem.coefficients.bodies import estimate_disc_unknowns
from fem.coefficients.solid_dataset import need_of_solid
from fem.coefficients.solid_need import SECONDS_OF_PLANE
from fem.coefficients.stations import DiscStations
from fem.mesh.memory_need import solid_memory, solid_values
from fem.shapes import DriveShapes
from ltca.compliance.coefficient_files import derivation_words, expected_seconds
from ltca.drive.single_discs import nominal_shape
from ltca.reading.drive_file import load_drive

PAPER = load_drive("paper").cases["CS-1"]


def test_time_told_of_solid_bodies_has_the_plane_part():
    """A coarse derivation was told as 6 s and took 9 to 13: the plane bodies before it were left out."""
    shape = DriveShapes.of_drive(nominal_shape(PAPER)).disc
    places = DiscStations.of_disc(shape, 1.0)
    plane = SECONDS_OF_PLANE * estimate_disc_unknowns(shape, places, 1.0)
    # Processor time of the paper's plane bodies, 4.6 s, to a factor of two.
    assert 2.3 < plane < 9.2
    # 73 s of processor time in all, beside other work; to a factor of two.
    assert 37.0 < need_of_solid(shape, places, size=1.0, layers=2).seconds < 146.0
    # However few layers and unknowns the solid has, the plane part is there.
    assert need_of_solid(shape, places, size=2.0, layers=1).seconds > SECONDS_OF_PLANE * estimate_disc_unknowns(
        shape, places, 2.0
    )


def test_memory_of_a_factor_grows_like_nested_dissection():
    """n p² log₂ n: twice the unknowns at each node four times, twice the nodes twice and a little more."""
    assert solid_memory(4096, 14) == pytest.approx(4.0 * solid_memory(4096, 7), rel=1e-12)
    assert solid_values(8192, 7) == pytest.approx(2.0 * 13.0 / 12.0 * solid_values(4096, 7), rel=1e-12)


def test_no_plane_seconds_are_told_of_solid_bodies():
    """Those of the plane were told of solid bodies, which take ten times as long and more."""
    assert derivation_words([PAPER], "solid") == "minutes, told before each"
    (seconds,) = expected_seconds([PAPER])
    words = derivation_words([PAPER], "plane")
    assert float(words.removeprefix("some ").removesuffix(" s")) == pytest.approx(seconds, abs=2.5)
