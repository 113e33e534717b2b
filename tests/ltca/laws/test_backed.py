"""Contact, seat and beam in series: what each takes adds up to the whole, from nothing to far more than any load."""

import numpy as np
import pytest

from ltca.drive.materials import Material
from ltca.laws.backed import BackedLaw
from ltca.laws.conforming import ConformingLaw
from ltca.laws.line_contact import LineContactLaw

PLAY = 0.01
SEATS = {
    "none": None,
    "steel": (Material(), 9.0),
    "plastic": (Material(youngs_modulus=2.6e3, poisson_ratio=0.38), 9.0),
}


def series(name, flexibility, pairs):
    seat = SEATS[name]
    if seat is not None:
        seat = ConformingLaw.of_bodies(
            pin=Material(), bore=seat[0], pin_radius=3.0, bore_radius=3.01, datum_radius=seat[1], length=10.0
        )
    contact = LineContactLaw(10.0, 113e3)
    return BackedLaw(contact=contact, seat=seat, play=np.full(pairs, PLAY), flexibility=flexibility)


@pytest.mark.parametrize("name", SEATS)
@pytest.mark.parametrize("flexibility", [0.0, 1e-7, 1e-5, 1e-3, 1e-1])
def test_approaches_add_up(name, flexibility):
    """From 1e-12 mm to 1 mm at once, the contact nearly all of it or nearly nothing; to round-off."""
    whole, radius = np.geomspace(1e-12, 1.0, 60)[None], np.full((1, 60), 2.0)
    law = series(name, flexibility, 60)
    _, near = law.surface(whole, radius)
    load, stiffness = law.load_and_stiffness(whole, radius)
    np.testing.assert_allclose(law.contact.load_and_stiffness(near, radius)[0], load, rtol=1e-14)
    behind, slope = law.behind(load)
    np.testing.assert_allclose(near + behind, whole, rtol=4e-15)
    own = law.contact.load_and_stiffness(near, radius)[1]
    # stiffness of the last step but one, a part of 1e-7 away at most
    np.testing.assert_allclose(stiffness * (1.0 / own + slope), 1.0, rtol=1e-7)


@pytest.mark.parametrize("name", SEATS)
def test_open_pairs_beside_closed_ones(name):
    law = series(name, 1e-5, 3)
    whole, radius = np.array([[-0.01, 0.005, 0.0]]), np.full((1, 3), 2.0)
    load, stiffness = law.load_and_stiffness(whole, radius)
    assert np.flatnonzero(load[0]).tolist() == np.flatnonzero(stiffness[0]).tolist() == [1]
    np.testing.assert_array_equal(law.surface(whole, radius)[1][0, [0, 2]], whole[0, [0, 2]])
    alone = series(name, 1e-5, 1).load_and_stiffness(whole[:, [1]], radius[:, [1]])
    assert load[0, 1] == alone[0][0, 0]
    assert not law.load_and_stiffness(-np.abs(whole), radius)[0].any()
