"""The spline of a flank against the exact flank: how far it departs, that it closes, what it encloses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import BSpline

from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.export import flank_outline
from ltca.export.flank_outline import MOST_SPANS, TOLERANCE, MadeFlank, departures, follow_flank
from ltca.geometry.flank import FlankProfile

MICRON = 1e-3
# Not the places where the spline itself is looked at while points are put in.
ELSEWHERE = np.linspace(0.03, 0.97, 13)
KINDS = ("paper", "rv", "robot-joint", "sleeved", "many", "plastic")


def flank_of(drive, inward=0.0, disc=0):
    return MadeFlank(profile=FlankProfile.of_drive(single_discs(drive)[disc]), inward=inward)


def as_curve(clamped):
    control = clamped.control_points
    return BSpline(clamped.knots, np.column_stack([control.real, control.imag]), 3)


def line_of(clamped, count):
    x, y = as_curve(clamped)(np.linspace(clamped.knots[0], clamped.knots[-1], count)).T
    return x + 1j * y


@pytest.mark.parametrize("inward", [0.0, -0.1])
@pytest.mark.parametrize("kind", KINDS)
def test_the_spline_departs_by_less_than_a_fifth_of_a_micron(kinds_of_drives, kind, inward):
    """A micron is promised; nowhere, not only where it was looked at, is it more than the fifth it is refined to."""
    spline = follow_flank(flank_of(kinds_of_drives[kind], inward))
    # A tenth of slack: between the places looked at a quartic remainder rises by less.
    assert np.max(np.abs(departures(spline, ELSEWHERE))) < 1.1 * TOLERANCE


def test_48_points_a_lobe_are_a_tenth_of_a_micron_off_on_the_papers_drive(kinds_of_drives):
    spline = follow_flank(flank_of(kinds_of_drives["paper"]))
    assert spline.parameter.size == 48 * 13
    # 0.11 µm was measured before this was written, to two digits.
    assert np.max(np.abs(departures(spline, ELSEWHERE))) == pytest.approx(0.11 * MICRON, abs=0.005 * MICRON)


def test_sharp_roots_get_more_points(kinds_of_drives):
    """99 lobes with e z_P/R_C = 0.82: even points are not enough in the roots, and only there are more."""
    spline = follow_flank(flank_of(kinds_of_drives["many"]))
    assert spline.parameter.size > 48 * 99
    steps = np.diff(spline.parameter)
    pitch = 2.0 * np.pi / 99
    from_root = np.abs(np.mod(spline.parameter[:-1] + 0.5 * steps + 0.5 * pitch, pitch) - 0.5 * pitch)
    assert np.max(from_root[steps < 0.6 * pitch / 48]) < 0.25 * pitch


@pytest.mark.parametrize("kind", KINDS)
def test_the_spline_closes_and_its_arcs_are_the_whole(kinds_of_drives, kind):
    spline = follow_flank(flank_of(kinds_of_drives[kind])).placed(1.0 - 2.0j)
    whole, arcs = spline.clamped(), spline.arcs()
    assert whole.control_points[0] == whole.control_points[-1]
    assert all(arc.control_points.size <= MOST_SPANS + 3 for arc in arcs)
    for here, after in zip(arcs, [*arcs[1:], arcs[0]], strict=True):
        assert here.control_points[-1] == after.control_points[0]
    # Twice continuously differentiable across the seam; round-off of second differences.
    curve = as_curve(whole)
    for order in range(3):
        ends = curve([whole.knots[0], whole.knots[-1]], nu=order)
        assert ends[0] == pytest.approx(ends[1], abs=1e-8)
    for arc in arcs[:5]:
        t = np.linspace(arc.knots[0], arc.knots[-1], 50)
        assert as_curve(arc)(t) == pytest.approx(curve(t), abs=1e-10)


def test_the_area_of_a_parallel_curve(kinds_of_drives):
    """Steiner: π(R² + u e²) of the trochoid less its length times the distance, plus π times its square."""
    drive = kinds_of_drives["paper"]
    radius, e, u, by = 88.09, 4.0, 14.0, 6.65 + 0.1
    length = quad(
        lambda t: np.sqrt(radius**2 + (e * u) ** 2 - 2 * radius * e * u * np.cos((u - 1) * t)), 0, np.pi / 13
    )[0]
    area = np.pi * (radius**2 + u * e**2) - 26.0 * length * by + np.pi * by**2
    assert flank_of(drive, 0.1).area() == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize("kind", ["paper", "plastic"])
def test_the_area_is_that_of_the_spline(kinds_of_drives, kind):
    flank = flank_of(kinds_of_drives[kind], 0.1)
    line = line_of(follow_flank(flank).clamped(), 200_001)
    polygon = 0.5 * np.sum((line[:-1].conjugate() * line[1:]).imag)
    # 0.2 µm all around some 600 mm would be 6e-6 of the area; it is on either side. The polygon is 2e-9 off.
    assert flank.area() == pytest.approx(polygon, rel=1e-6)


def test_curvature_of_a_compensated_flank_is_that_of_its_points(kinds_of_drives):
    """By three neighbouring points, whose circle is of second order: 1e-4 rad between them leave 1e-4 of it."""
    flank = flank_of(kinds_of_drives["plastic"], 0.2)
    theta = np.linspace(0.0, 6.0, 200)
    before, here, after = (flank.points(theta + step) for step in (-1e-4, 0.0, 1e-4))
    one, two = here - before, after - here
    around = 2.0 * (one.conjugate() * two).imag / (np.abs(one) * np.abs(two) * np.abs(after - before))
    assert flank.curvature(theta) == pytest.approx(around, abs=1e-4)


def test_a_flank_that_needs_too_many_points_is_refused(kinds_of_drives, monkeypatch):
    monkeypatch.setattr(flank_outline, "MOST_POINTS", 100)
    with pytest.raises(DriveError, match="needs more than 100 points"):
        follow_flank(flank_of(kinds_of_drives["paper"]))
