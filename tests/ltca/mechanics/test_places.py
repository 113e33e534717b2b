"""Where contacts lie on the body of the disc, as an observer on the disc sees them."""

from __future__ import annotations

import numpy as np

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.reducer import Reducer
from ltca.mechanics.contacts import ContactSystem


def test_places_turn_with_the_disc(paper_cases):
    """Rollers and shaft pins stand still, the disc is turned by a tenth: on it they are found a tenth further back."""
    model = HalfSpaceCompliance.of_drive(paper_cases["CS-6"])
    place, angle = model.geometry.placement, np.array([0.0, 0.7, 4.0])
    pose = np.array([[0.02, -0.01, turn, 0.0] for turn in (0.0, 0.1, -0.1)])
    system = ContactSystem(Reducer(discs=(model,)))
    parameter = system.respond(angle, pose, None, roughly=False).body_places(0).parameter
    _, in_bore, in_hole = np.split(parameter, np.cumsum((system.pins, system.rollers)), axis=1)
    centre = place.races(angle).middle + pose[:, 0] + 1j * pose[:, 1]
    back = np.exp(-1j * pose[:, 2, None])
    # Rollers touch the inner race; seen from the disc's centre, in its own frame.
    rays = model.geometry.rollers(angle)
    rollers = place.races(angle).middle[:, None] + rays.outermost * rays.direction
    bore = np.angle((rollers - centre[:, None]) * back)
    np.testing.assert_allclose(np.exp(1j * in_bore), np.exp(1j * bore), atol=1e-12)
    # A shaft pin presses on the wall of its hole on the side to which it is off the hole's centre, again in the disc's frame.
    pins = np.broadcast_to(place.shaft_pin_centres, (3, place.shaft_pin_centres.size))
    hole = np.angle((pins - centre[:, None]) * back - place.hole_centres)
    np.testing.assert_allclose(np.exp(1j * in_hole), np.exp(1j * hole), atol=1e-12)
