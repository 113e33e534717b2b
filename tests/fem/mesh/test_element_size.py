"""The size field of very many balls is that of each of them, to the last bit: meshes follow from it."""

import numpy as np
import pytest

from fem.mesh.boundary_division import sample_parameters
from fem.mesh.element_size import MANY_BALLS, Refinement, SizeField, nearest_distance
from fem.shapes import CircleShape


@pytest.fixture
def field():
    """Balls along a circle, alike but for a few, one of them wider only, and two at one place."""
    angles = np.linspace(0.0, 2.0 * np.pi, 4 * MANY_BALLS, endpoint=False)
    balls = [Refinement.polar(20.0, angle, size=0.05, radius=0.15) for angle in angles]
    others = [Refinement.polar(18.0, angle, size=0.02 + 0.01 * angle, radius=0.1) for angle in angles[:5]]
    wide = Refinement.polar(17.0, 1.0, size=0.05, radius=2.0)
    return SizeField(balls=(*others, *balls, wide, balls[3]), coarse_size=3.0, growth=0.4)


def one_by_one(field, points):
    size = np.full(points.shape, field.coarse_size)
    for ball in field.balls:
        away = np.maximum(np.abs(points - ball.point) - ball.radius, 0.0)
        size = np.minimum(size, ball.size + field.growth * away)
    return size


def test_many_balls_are_asked_like_each(field):
    random = np.random.default_rng(2)
    points = 25.0 * (random.uniform(-1.0, 1.0, (300, 3)) + 1j * random.uniform(-1.0, 1.0, (300, 3)))
    # Between two balls their distances are a tie but for the last bit.
    between = 20.0 * np.exp(2j * np.pi * (np.arange(4 * MANY_BALLS) + 0.5) / (4 * MANY_BALLS))
    for places in (points, between):
        np.testing.assert_array_equal(field.at(places), one_by_one(field, places))


@pytest.mark.parametrize("number", [1, MANY_BALLS - 1, MANY_BALLS, 5 * MANY_BALLS])
def test_nearest_distance(number):
    random = np.random.default_rng(4)
    centres, points = (random.normal(size=count) + 1j * random.normal(size=count) for count in (number, 200))
    expected = np.abs(points[:, None] - centres).min(axis=1)
    np.testing.assert_array_equal(nearest_distance(points, centres), expected)


def test_boundary_is_divided_as_ball_by_ball(field, monkeypatch):
    """Small balls between two samples are found among many as they were one after the other."""
    (curve,) = CircleShape(name="pin", radius=20.02).curves
    found = sample_parameters(curve, field)
    asked = []

    def each_alone(self):
        asked.append(len(self.balls))
        return ((ball, np.array([ball.point])) for ball in self.balls)

    monkeypatch.setattr(SizeField, "balls_alike", each_alone)
    np.testing.assert_array_equal(found, sample_parameters(curve, field))
    assert asked
    assert len(found) > 20.0 * 2.0 * np.pi / 0.2  # about four samples for each edge at the balls
