"""Laws of contacts in slices whose bodies end: images in the end planes, one energy, the limit of ends far away, grids."""

import numpy as np
import pytest

from ltca.compliance.near_field import projected_on_half_space, redistributed_approach
from ltca.contact.free_end import FreeEnds, free_ends_of, guilbault_factor, remaining_bulge
from ltca.contact.influence import end_images
from ltca.contact.pressure_cells import solve_cylinder_patch
from ltca.laws.sliced_contact import POINTS, slice_heights
from ltca.laws.sliced_line import STRIP, SlicedLine

LENGTH, MODULUS, RADIUS, SLICES = 12.0, 1.1e5, 3.0, 9
FLUSH = (FreeEnds(reach=1.0, weight=guilbault_factor(0.3)),)
ONE_BEYOND = (FreeEnds(reach=1.0, weight=0.695), FreeEnds(reach=1.4, weight=0.695))


def line(free_ends, slices=SLICES, relief=0.0):
    z = slice_heights(LENGTH, slices)
    return SlicedLine(
        length=LENGTH,
        contact_modulus=MODULUS,
        slices=slices,
        relief=np.zeros(z.shape) + relief * z**2,
        free_ends=free_ends,
    )


def test_images_of_narrow_strips_are_logarithms():
    """∫∫ 1/(a + y + y') over two strips is a second difference of x ln x; strips a millionth wide are lines."""
    edges, plane, width = np.array([-1.5, -0.5, 0.5, 1.5]), 1.7, 1e-6

    def of(corner):
        return corner * np.log(corner)

    expected = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for sign in (1.0, -1.0):
                near = 2.0 * plane - sign * (edges[i] + edges[j])
                expected[i, j] += of(near - 2.0 * sign) - 2.0 * of(near - sign) + of(near)
    # 3e-6 is what quadrature of distant cells has (`ltca.contact.influence`).
    np.testing.assert_allclose(end_images(width, edges, plane) / width**2, expected, rtol=3e-6)


@pytest.mark.parametrize(
    ("reach", "even", "linear"), [(1.0, 2.0 * np.log(2.0), 2.0 * (1.0 - np.log(2.0)))], ids=["flush"]
)
def test_images_of_narrow_lines_add_constants_to_the_logarithms(reach, even, linear):
    """In κ and κ′: 2 ln 2 and 2 (1 − ln 2), the integrals of 1/(t − z − z′) and z z′/(t − z − z′) over both heights."""
    t, b = 10.0, 1e-4
    more = np.subtract(
        projected_on_half_space(t, b, (FreeEnds(reach=reach, weight=1.0),)), projected_on_half_space(t, b)
    )
    # What is left goes with b/t, 1e-5.
    np.testing.assert_allclose(more / (2.0 / (np.pi * t) * np.array([1.0, 12.0 / t**2])), [even, linear], rtol=1e-4)


@pytest.mark.parametrize("reach", [1.0, 1.3])
def test_images_of_the_law_add_up_to_what_comes_off_the_solid_answer(reach):
    """Means of strips over all slices are those of the line, but for the shape of strips and, of linear loads, stairs (1/n²)."""
    t, b, slices = 8.0, 0.1, 45
    size = t / slices
    edges = np.arange(slices + 1.0) - 0.5 * slices
    width = 2.0 * STRIP * b / size
    strips = end_images(width, edges, 0.5 * slices * reach) / width**2
    z = edges[1:] - 0.5
    found = np.array(
        [strips.sum() / (np.pi * slices**2 * size), (12.0 / t**3) ** 2 * size**3 * (z @ strips @ z) / np.pi]
    )
    given = (FreeEnds(reach=reach, weight=1.0),)
    expected = np.subtract(projected_on_half_space(t, b, given), projected_on_half_space(t, b))
    np.testing.assert_allclose(found, expected, rtol=4e-3)


@pytest.mark.parametrize("free_ends", [FLUSH, ONE_BEYOND], ids=["flush", "one beyond"])
@pytest.mark.parametrize("tilt", [0.0, 2e-4])
def test_loads_and_moments_are_slopes_of_one_energy(free_ends, tilt):
    law, delta, step = line(free_ends, relief=2e-5), 4e-3, 1e-7

    def at(more=0.0, turned=0.0):
        return law.respond(np.array([delta + more]), np.array([tilt + turned]), np.array([RADIUS]))

    here = at()
    for moved, expected in (((step, 0.0), here.load), ((0.0, step), here.moment)):
        up, down = at(*moved), at(*(-each for each in moved))
        slope = (law.energy(up, np.array([RADIUS])) - law.energy(down, np.array([RADIUS]))) / (2.0 * step)
        # Differences of energies of some N·mm over 1e-7 mm keep eight digits of the load, of the moment beside none.
        np.testing.assert_allclose(slope, expected, rtol=1e-6, atol=1e-6 * here.load[0] * LENGTH)
    up, down = at(step), at(-step)
    np.testing.assert_allclose((up.load - down.load) / (2.0 * step), here.by_approach, rtol=1e-6)
    # Maxwell: ∂M/∂δ = ∂F/∂θ.
    np.testing.assert_allclose(
        (up.moment - down.moment) / (2.0 * step), here.by_tilt, rtol=1e-6, atol=1e-6 * here.by_approach[0] * LENGTH
    )
    up, down = at(0.0, step), at(0.0, -step)
    np.testing.assert_allclose((up.moment - down.moment) / (2.0 * step), here.moment_by_tilt, rtol=1e-5)


def test_ends_far_away_are_half_spaces_to_round_off():
    far, without = line((FreeEnds(reach=1e14, weight=1.39),)), line(())
    approach, tilt = np.array([1e-3, 5e-3]), np.array([1e-4, 0.0])
    one, other = (law.respond(approach, tilt, np.array(RADIUS)) for law in (far, without))
    np.testing.assert_allclose(one.slice_load, other.slice_load, rtol=1e-11)


@pytest.mark.parametrize(
    ("free_ends", "factor"), [(FLUSH, FLUSH[0].weight), ((FreeEnds(reach=1.0, weight=0.695),), 0.695)]
)
@pytest.mark.parametrize("slices", [5, 9])
@pytest.mark.parametrize("approach", [1e-3, 1e-2, 0.05])
def test_aligned_lines_with_free_ends_have_the_load_of_grids(free_ends, factor, slices, approach):
    """Down to L/b of 30; grids of 16 cells err by 0.003 %, the softer ends by the square of the bulge within 0.1 %."""
    grid = solve_cylinder_patch(LENGTH, RADIUS, MODULUS, approach, cells=16, end_factor=factor)
    found = line(free_ends, slices).respond(np.array([approach]), np.zeros(1), np.array([RADIUS]))
    np.testing.assert_allclose(found.load[0], grid.load, rtol=1e-3)


def test_flush_ends_carry_no_peak():
    """Solid bodies have K_Hβ of 1.028 where half-spaces carry half as much again at the end (docs/theory/solid_contact.md)."""
    flush, without = (
        line(ends).respond(np.array([5e-3]), np.zeros(1), np.array([RADIUS])).slice_load[0] for ends in (FLUSH, ())
    )
    assert flush.max() / flush.mean() < 1.03
    assert flush[0] < flush[SLICES // 2]
    assert without.max() / without.mean() > 1.2


def test_an_even_line_gains_nothing_by_loads_that_move_to_its_ends():
    """Images of weight 1 leave an aligned line even: it approaches as under the even load, to a thousandth of κ."""
    kappa = 2.0 / (np.pi * LENGTH)
    with_images = redistributed_approach(LENGTH, 0.1, (FreeEnds(reach=1.0, weight=1.0),))
    assert abs(with_images) < 1e-3 * kappa
    assert 0.05 * kappa < redistributed_approach(LENGTH, 0.1) < 0.1 * kappa


def test_bodies_count_by_their_compliance_and_length():
    steel, plastic = 0.91 / 2.06e5, (1.0 - 0.38**2) / 2600.0
    found = free_ends_of(10.0, steel + plastic, [(10.0, plastic, 0.38), (14.0, steel, 0.3)])
    assert [each.reach for each in found] == [1.0, 1.4]
    np.testing.assert_allclose(found[0].weight, guilbault_factor(0.38) * plastic / (steel + plastic), rtol=1e-12)
    # What does not reach beyond has all of its image at its end, what reaches far none.
    np.testing.assert_allclose(remaining_bulge((FreeEnds(reach=1.0, weight=0.4),), np.array([0.02])), 0.6, rtol=1e-12)
    assert remaining_bulge((FreeEnds(reach=1e4, weight=0.4),), np.array([0.02]))[0] > 0.9999


def test_pressures_at_flush_ends_have_no_peak():
    from ltca.contact.contact_kind import ContactKind
    from ltca.laws.width_pressure import estimate_along_width

    found = {}
    for ends in (FLUSH, ()):
        kind = ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=None, symmetric=True, free_ends=ends)
        contact = line(ends).respond(np.array([5e-3]), np.zeros(1), np.array([RADIUS]))
        assert contact.line_load.shape[-1] == POINTS
        along = estimate_along_width(kind, contact.line_load, np.array([RADIUS]))
        found[ends] = along.largest[0] / along.pressure[0, SLICES // 2]
    # Images say 1, solid bodies 1 (the middle), half-spaces 1.5 (the mean over a hundredth of the length).
    assert found[FLUSH] < 1.02
    assert found[()] > 1.4
