"""Numbers read off a pressure, against Hertz' semi-ellipse; stresses against a turned tensor."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.body.stress import Stress, stress_of_strain
from fem.contact.pressure_measures import peak_of, pressure_moments, vertex_means
from fem.drive.contact_results import _detail
from fem.drive.fields import turn_stress
from fem.drive.model import rigid_fit
from ltca.drive.parts import Material

HALF_WIDTH, PEAK = 0.13, 1300.0


def ellipse(x):
    return PEAK * np.sqrt(np.maximum(1.0 - (x / HALF_WIDTH) ** 2, 0.0))


def projected(arc, fine=40001):
    """Return the L2 projection of the semi-ellipse on piecewise linear functions of the vertices."""
    x = np.linspace(arc[0], arc[-1], fine)
    hats = np.array([np.interp(x, arc, row) for row in np.eye(len(arc))])
    return np.linalg.solve(hats @ hats.T, hats @ ellipse(x - 0.5 * (arc[0] + arc[-1])))


def test_moments_of_the_ellipse():
    arc = np.linspace(0.0, 4.0 * HALF_WIDTH, 4001)
    total, centre, square = pressure_moments(arc, ellipse(arc - 2.0 * HALF_WIDTH))
    # The square-root ends cost a trapezoid of 1000 edges for each half-width about 1e-5.
    assert total == pytest.approx(0.5 * np.pi * PEAK * HALF_WIDTH, rel=2e-5)
    assert centre == pytest.approx(2.0 * HALF_WIDTH, rel=1e-9)
    assert 2.0 * np.sqrt(square) == pytest.approx(HALF_WIDTH, rel=2e-5)
    assert pressure_moments(arc, np.zeros_like(arc)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.5])
def test_peak_of_a_projection(shift):
    """Vertex values of the projection lie h²|p″|/12 above the pressure: 0.13 % at 8 edges for each half-width."""
    edge = HALF_WIDTH / 8.0
    arc = np.arange(40) * edge
    x = np.linspace(arc[0], arc[-1], 40001)
    hats = np.array([np.interp(x, arc, row) for row in np.eye(len(arc))])
    middle = arc[20] + shift * edge
    pressure = np.linalg.solve(hats @ hats.T, hats @ ellipse(x - middle))
    assert peak_of(arc, pressure, HALF_WIDTH) == pytest.approx(PEAK, rel=5e-4)
    assert abs(pressure.max() / PEAK - 1.0) > abs(peak_of(arc, pressure, HALF_WIDTH) / PEAK - 1.0)


def test_what_is_said_of_one_contact():
    """Load, share, peak and half-width of Hertz' own pressure: 2√⟨x²⟩ of a semi-ellipse is its half-width."""
    arc = np.linspace(0.0, 4.0 * HALF_WIDTH, 801)
    full = ellipse(arc - 1.9 * HALF_WIDTH)
    zone = SimpleNamespace(arc=arc, at_vertices=lambda unknowns: np.concatenate([[0.0], unknowns, [0.0]]))
    found = _detail(SimpleNamespace(zone=zone), full[1:-1], 600.0, 800.0)
    assert (found.load, found.share) == (600.0, 0.75)
    # 200 edges for each half-width: straight lines under the square-root ends cost 0.5 (1/200)^1.5 = 2e-4
    assert found.half_width == pytest.approx(HALF_WIDTH, rel=5e-4)
    assert found.peak_pressure == pytest.approx(PEAK, rel=1e-3)
    assert found.middle == pytest.approx(1.9 * HALF_WIDTH, rel=1e-3)
    assert found.largest_edge == pytest.approx(HALF_WIDTH / 200.0, rel=1e-9)
    nothing = _detail(SimpleNamespace(zone=zone), np.zeros(799), 0.0, 800.0)
    assert (nothing.load, nothing.share, nothing.peak_pressure, nothing.half_width) == (0.0, 0.0, 0.0, 0.0)


def test_means_keep_the_load_and_do_not_swing():
    arc = np.linspace(0.0, 2.5 * HALF_WIDTH, 21)
    pressure = projected(arc)
    means = vertex_means(arc, pressure)
    area = np.zeros(21)
    area[:-1] += 0.5 * np.diff(arc)
    area[1:] += 0.5 * np.diff(arc)
    assert means @ area == pytest.approx(pressure_moments(arc, pressure)[0], rel=1e-12)
    # Outside the contact the projection swings with a quarter of the amplitude from vertex to vertex; the means
    # of φp vanish there, but for the end vertices, whose half hats see the last swing.
    assert pressure.min() < -1e-2 * PEAK
    assert means.min() > -1e-5 * PEAK
    rising = np.diff(means[: np.argmax(means) + 1])
    assert np.all(rising > -1e-5 * PEAK)


def test_principal_stresses_do_not_turn():
    stress = Stress(xx=np.array([100.0]), yy=np.array([-40.0]), xy=np.array([30.0]), zz=np.array([18.0]))
    turned = turn_stress(stress, 0.7)
    rotation = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    expected = rotation @ np.array([[100.0, 30.0], [30.0, -40.0]]) @ rotation.T
    np.testing.assert_allclose(
        [turned.xx[0], turned.yy[0], turned.xy[0]], [expected[0, 0], expected[1, 1], expected[0, 1]], rtol=1e-12
    )
    values = np.sort(np.linalg.eigvalsh(np.array([[100.0, 30.0, 0.0], [30.0, -40.0, 0.0], [0.0, 0.0, 18.0]])))[::-1]
    np.testing.assert_allclose(np.array(turned.principal)[:, 0], values, rtol=1e-12)
    assert turned.maximum_shear[0] == pytest.approx(0.5 * (values[0] - values[2]))
    a, b, c = values
    assert turned.von_mises[0] == pytest.approx(np.sqrt(0.5 * ((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2)))


@pytest.mark.parametrize("state", ["strain", "stress"])
def test_hooke_inverts(state):
    material = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
    stress = stress_of_strain(np.array([1e-3]), np.array([-2e-4]), np.array([4e-4]), material, state)
    trace = stress.xx + stress.yy + stress.zz
    strain = (1.3 * stress.xx - 0.3 * trace) / 206_000.0
    assert strain[0] == pytest.approx(1e-3)
    out_of_plane = (1.3 * stress.zz - 0.3 * trace) / 206_000.0
    assert (abs(out_of_plane[0]) < 1e-15) == (state == "strain")
    assert (stress.zz[0] == 0.0) == (state == "stress")


def test_rigid_fit_ignores_an_even_growth():
    ring = 29.5 * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 73)[:-1])
    displacement = (0.003 - 0.002j) + 1j * 4e-5 * ring + 1e-4 * ring
    x, y, rotation = rigid_fit(ring, np.ones(72)) @ np.concatenate([displacement.real, displacement.imag])
    assert complex(x, y) == pytest.approx(0.003 - 0.002j, rel=1e-9)
    assert rotation == pytest.approx(4e-5, rel=1e-9)
