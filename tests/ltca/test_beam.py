"""Pins as beams: printed results of the literature, and small elements."""

import numpy as np
import pytest

from ltca.beam import PinBeam


def test_pin_as_a_beam_of_small_elements():
    """Deflections of a stubby pin under loads along whole discs against Timoshenko elements that lock nowhere: 1e-3."""
    span, diameter, modulus, ratio, count = 16.0, 5.0, 206e3, 0.3, 320
    rigidity = modulus * np.pi * diameter**4 / 64.0
    factor = 6.0 * (1.0 + ratio) / (7.0 + 6.0 * ratio)
    shear = factor * modulus / (2.0 * (1.0 + ratio)) * np.pi * diameter**2 / 4.0
    step = span / count
    slip = 12.0 * rigidity / (shear * step**2)
    element = np.array([
        [12.0, 6.0 * step, -12.0, 6.0 * step],
        [6.0 * step, (4.0 + slip) * step**2, -6.0 * step, (2.0 - slip) * step**2],
        [-12.0, -6.0 * step, 12.0, -6.0 * step],
        [6.0 * step, (2.0 - slip) * step**2, -6.0 * step, (4.0 + slip) * step**2],
    ]) * rigidity / (step**3 * (1.0 + slip))  # fmt: skip
    whole = np.zeros((2 * count + 2, 2 * count + 2))
    for number in range(count):
        own = slice(2 * number, 2 * number + 4)
        whole[own, own] += element
    nodes = np.linspace(0.0, span, count + 1)
    planes, width = [4.0, 11.0], 6.0
    spread = np.array(
        [(np.abs(nodes - z) < 0.5 * width) + 0.5 * (np.abs(np.abs(nodes - z) - 0.5 * width) < 1e-9) for z in planes]
    )
    spread = spread / spread.sum(axis=1, keepdims=True)
    for ends, held in (
        (("supported", "supported"), [0, 2 * count]),
        (("clamped", "clamped"), [0, 1, 2 * count, 2 * count + 1]),
        (("clamped", "free"), [0, 1]),
        (("clamped", "supported"), [0, 1, 2 * count]),
    ):
        free = np.setdiff1d(np.arange(2 * count + 2), held)
        onto = np.zeros((2 * count + 2, 2))
        onto[::2] = spread.T
        moved = np.zeros_like(onto)
        moved[free] = np.linalg.solve(whole[np.ix_(free, free)], onto[free])
        beam = PinBeam(span=span, ends=ends, diameter=diameter, youngs_modulus=modulus, poisson_ratio=ratio)
        np.testing.assert_allclose(beam.flexibility(planes, width), spread @ moved[::2], rtol=1e-3)


def _by_virtual_work(ends, span, width, planes, bending, shear):
    """Flexibility of forces and moments of discs by the unit-load theorem: bending moments and shears of a cantilever, redundants
    of the far end by the force method, integrals by Gauss points between all kinks.
    """
    edges = np.unique([0.0, span, *(z + side * width / 2.0 for z in planes for side in (-1.0, 1.0))])
    nodes, factors = np.polynomial.legendre.leggauss(6)
    halves = 0.5 * np.diff(edges)[:, None]
    z = (edges[:-1, None] + halves + halves * nodes).ravel()
    weights = (halves * factors).ravel()
    bent, sheared = [], []
    for kind in (0, 1):
        for middle in planes:
            # Beyond z lies what is pressed from `low` on: its force and its moment about z.
            low, high = np.clip(z - middle, -0.5 * width, 0.5 * width), 0.5 * width
            scale = 1.0 / width if kind == 0 else 12.0 / width**3
            force, first = (scale * (high**power - low**power) / power for power in (kind + 1, kind + 2))
            bent.append(first + (middle - z) * force)
            sheared.append(force)
    # Redundants: force and couple at the far end.
    redundant = {
        "free": [], "supported": [(span - z, np.ones_like(z))],
        "clamped": [(span - z, np.ones_like(z)), (np.ones_like(z), np.zeros_like(z))],
    }[ends[1]]  # fmt: skip
    if ends[0] == "supported":
        # Statically determinate: the far end carries what balances moments about the start.
        redundant, start = [], [*planes, *(1.0 for _ in planes)]
        bent = [each - moment * (span - z) / span for each, moment in zip(bent, start, strict=True)]
        sheared = [each - moment / span for each, moment in zip(sheared, start, strict=True)]

    def work(one, other):
        return (weights * (one[0] * other[0] / bending + one[1] * other[1] / shear)).sum()

    loads = list(zip(bent, sheared, strict=True))
    found = np.array([[work(a, b) for b in loads] for a in loads])
    if redundant:
        onto = np.array([[work(a, b) for b in loads] for a in redundant])
        among = np.array([[work(a, b) for b in redundant] for a in redundant])
        found -= onto.T @ np.linalg.solve(among, onto)
    return found


@pytest.mark.parametrize(
    "ends",
    [("clamped", "free"), ("clamped", "supported"), ("clamped", "clamped"), ("supported", "supported")],
)
@pytest.mark.parametrize("planes", [[9.0], [6.0, 19.0], [5.0, 15.0, 25.0]])
def test_slopes_and_moments_by_virtual_work(ends, planes):
    """Deflections and slopes under forces and moments of discs by the theorem of unit loads: nothing but round-off apart."""
    span, width, diameter, modulus, ratio = 31.0, 10.0, 8.0, 206e3, 0.3
    bending = modulus * np.pi * diameter**4 / 64.0
    factor = 6.0 * (1.0 + ratio) / (7.0 + 6.0 * ratio)
    shear = factor * modulus / (2.0 * (1.0 + ratio)) * np.pi * diameter**2 / 4.0
    beam = PinBeam(span=span, ends=ends, diameter=diameter, youngs_modulus=modulus, poisson_ratio=ratio)
    found = beam.flexibility(planes, width, slopes=True)
    expected = _by_virtual_work(ends, span, width, planes, bending, shear)
    scale = np.sqrt(np.diag(expected))
    # 1e-10 of round-off: places to the third power less each other
    np.testing.assert_allclose(found / np.outer(scale, scale), expected / np.outer(scale, scale), atol=1e-10)
    np.testing.assert_allclose(found[: len(planes), : len(planes)], beam.flexibility(planes, width), rtol=1e-10)


def test_a_force_at_a_plane_turns_a_cantilever_by_its_square():
    """A very thin disc at a on a cantilever that does not shear: deflection a³/3EI, slope a²/2EI, slope under a moment a/EI."""
    beam = PinBeam(span=40.0, ends=("clamped", "free"), diameter=10.0, youngs_modulus=2e5)
    rigidity = 2e5 * np.pi * 10.0**4 / 64.0
    found = rigidity * beam.flexibility([20.0], 0.01, slopes=True)
    # 1e-3 of a disc of a two-thousandth of its lever; its own curvature counts to that
    np.testing.assert_allclose(found, [[20.0**3 / 3.0, 200.0], [200.0, 20.0]], rtol=1e-3)


def test_the_far_end_slopes_discs_as_it_carries_their_moments():
    """Reciprocity: shares of a clamped far end of forces and moments are displacement and slope where it is moved by one."""
    beam = PinBeam(span=30.0, ends=("clamped", "clamped"), diameter=8.0, youngs_modulus=2e5)
    shape = beam.tip_shape([12.0], 1e-3, slopes=True)
    x = 12.0 / 30.0
    # v (3 x² − 2 x³) of a sway, and its slope; 1e-6 of a thin disc
    np.testing.assert_allclose(shape, [3.0 * x**2 - 2.0 * x**3, 6.0 * x * (1.0 - x) / 30.0], rtol=1e-6)


@pytest.mark.parametrize("ends", [("clamped", "free"), ("clamped", "clamped"), ("supported", "supported")])
def test_bending_under_moments_of_discs_is_in_balance(ends):
    """Bending moments and shears under forces and moments of two discs: their work on the pin is the flexibility of `slopes`.

    Σ of both by EI and κGA along the pin, Gauss points between all kinks: 1e-9.
    """
    beam = PinBeam(span=30.0, ends=ends, diameter=8.0, youngs_modulus=2e5, poisson_ratio=0.3)
    planes, width = [9.0, 21.0], 10.0
    edges = np.array([0.0, 4.0, 14.0, 16.0, 26.0, 30.0])
    nodes, weights = np.polynomial.legendre.leggauss(6)
    halves = 0.5 * np.diff(edges)[:, None]
    z, weights = (edges[:-1, None] + halves + halves * nodes).ravel(), (halves * weights).ravel()
    bending, shear = beam._rigidity
    moment, force = (each(z, planes, width, slopes=True)[:, :-1] for each in (beam.moments, beam.shears))
    found = (moment.T * weights) @ moment / bending + (force.T * weights) @ force / shear
    expected = beam.flexibility(planes, width, slopes=True)
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(found / np.outer(scale, scale), expected / np.outer(scale, scale), atol=1e-9)
    np.testing.assert_allclose(moment[:, :2], beam.moments(z, planes, width)[:, :2], rtol=1e-9, atol=1e-9)
