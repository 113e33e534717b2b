"""A disc whose flank is turned against its holes: which part it is, and where that part's coefficients are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.compliance.coefficients import BodyPlaces
from ltca.drive.parts import part_turn
from ltca.drive.single_discs import equal_parts, nominal_shape, single_discs
from ltca.geometry.boundary_stations import Boundary
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import without_coupling


@pytest.mark.parametrize(("teeth", "holes"), [(13, 8), (14, 8), (15, 6), (39, 8), (3, 3), (59, 10), (12, 6)])
def test_part_turn_leaves_nothing_of_the_turn(teeth, holes):
    """The turn is that of the part, hole pitches and tooth pitches together; and no turn by hole pitches leaves less."""
    for phase in (0.0, np.pi, 2.0 * np.pi / 3.0, -0.3, 7.0):
        turned = -phase / teeth
        turn, hole_pitches, tooth_pitches = part_turn(turned, teeth, holes)
        whole = turn + 2.0 * np.pi * (hole_pitches / holes + tooth_pitches / teeth)
        assert whole == pytest.approx(turned, abs=2e-9)  # what counts as the same part
        pitch = 2.0 * np.pi / teeth
        others = [(turned - 2.0 * np.pi * j / holes + 1e-9) % pitch - 1e-9 for j in range(holes)]
        assert turn <= min(others) + 2e-9


@pytest.mark.parametrize(("teeth", "holes", "alike"), [(13, 8, True), (14, 8, True), (13, 7, False), (12, 6, False)])
def test_equal_discs_by_counting(teeth, holes, alike):
    """Some j makes ζ/2π + j z_C/z_PS whole (design): for half a turn 1/2 + j z_C/z_PS, by whole numbers alone."""
    drive = with_fields(
        load_drive("paper").cases["CS-1"],
        {"pin_wheel.number_of_pins": teeth + 1, "disc.number_of_teeth": teeth, "pin_shaft.number_of_pins": holes,
         "crank.eccentricity": 3.8, "disc.number_of_discs": 2},
        check=False,
    )  # fmt: skip
    assert any((holes + 2 * j * teeth) % (2 * holes) == 0 for j in range(holes)) == alike
    assert equal_parts(drive) == alike
    shapes = {single.shape_fingerprint() for single in single_discs(drive)}
    assert len(shapes) == (1 if alike else 2)


@pytest.mark.parametrize("phase", [np.pi, 2.0 * np.pi / 8.0, -np.pi, 1.3])
def test_coefficients_of_the_part_are_found_where_it_stands(phase):
    """A field over the part, f(x) f(y) of the places of its walls, is met at the same metal in the disc that it is in."""
    drive = with_fields(load_drive("paper").cases["CS-1"], {"disc.phases": (phase,)})
    part = nominal_shape(drive)
    assert part.shape_fingerprint() == drive.shape_fingerprint()
    flank, place = FlankProfile.of_drive(part), Placement.of_drive(part)

    def field(points):
        return 1.0 + 0.01 * points.real - 0.02 * points.imag + 1e-4 * points.real * points.imag

    counts = (1000, 100, *[60] * 8)
    firsts = np.cumsum((0, *counts[:-1]))
    boundaries = [Boundary(first=int(f), count=c) for f, c in zip(firsts, counts, strict=True)]
    circle = [boundary.parameters() for boundary in boundaries]
    walls = [flank.flank(circle[0]), place.bore_radius * np.exp(1j * circle[1])]
    walls += [
        centre + radius * np.exp(1j * at)
        for centre, radius, at in zip(place.hole_centres, place.hole_radii, circle[2:], strict=True)
    ]
    value = field(np.concatenate(walls))
    found = replace(
        without_coupling(part), flank=boundaries[0], bores=(boundaries[1],), holes=tuple(boundaries[2:]),
        disc=np.outer(value, value),
    ).placed_in(drive)  # fmt: skip

    rng = np.random.default_rng(3)
    theta, bore, holes = (
        rng.uniform(0.0, 6.28, (1, 14)),
        rng.uniform(0.0, 6.28, (1, 11)),
        rng.uniform(0.0, 6.28, (1, 8)),
    )
    turned, disc = FlankProfile.of_drive(drive), Placement.of_drive(drive)
    points = np.concatenate(
        [
            turned.flank(theta),
            disc.bore_radius * np.exp(1j * bore),
            disc.hole_centres + disc.hole_radii * np.exp(1j * holes),
        ],
        axis=1,
    )
    matrix = found.disc_matrix(
        BodyPlaces.on_walls(theta, turned.flank(theta), bore, float(disc.bore_radius), holes, 1)
    )[0]
    # the metal of the part that is at these places of the disc: turned back by whole hole pitches
    metal = field(points[0] * np.exp(-2j * np.pi * drive.part_turn[1] / 8.0))
    # interpolation between stations: to round-off on circles, 1e-6 on the lobes
    np.testing.assert_allclose(matrix, np.outer(metal, metal), rtol=1e-5)


def test_the_flank_turns_and_the_runout_does_not():
    """Roots lie at −Δz ζ/z_C in the frame of the holes; the centre of the flank where the drawing of the disc has it."""
    drive = with_fields(
        load_drive("paper").cases["CS-1"],
        {"disc.phases": (1.3,), "disc.runout.amount": 0.01, "disc.runout.angle": 0.4},
    )
    flank = FlankProfile.of_drive(drive)
    root = flank.flank(np.array([0.0]))[0] - 0.01 * np.exp(0.4j)
    assert np.angle(root) == pytest.approx(-1.3 / 13.0, abs=1e-12)
    assert abs(root) == pytest.approx(flank.root_radius, rel=1e-14)
