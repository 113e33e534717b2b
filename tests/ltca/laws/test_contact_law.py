"""What all laws have from their base class."""

import numpy as np
import pytest

from ltca.drive.materials import Material
from ltca.laws.backed import BackedLaw
from ltca.laws.conforming import ConformingLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.spring import SpringLaw

STIFFNESSES = np.array([[1e5], [2e5]])
SEAT = ConformingLaw.of_bodies(
    pin=Material(), bore=Material(), pin_radius=3.0, bore_radius=3.01, datum_radius=9.0, length=10.0
)
LAWS = {
    "line contact": LineContactLaw(10.0, 113e3),
    "plane strain": PlaneContactLaw(thickness=10.0, contact_modulus=113e3, datum=10.0),
    "springs of two drives": SpringLaw(stiffness=STIFFNESSES),
    "seats of different play": BackedLaw(
        contact=LineContactLaw(10.0, 113e3), seat=SEAT, play=np.array([0.004, 0.01, 0.02]), flexibility=1e-6
    ),
    "springs behind which sleeves yield": BackedLaw(
        contact=SpringLaw(stiffness=STIFFNESSES), seat=SEAT, play=np.array([0.004, 0.01, 0.02])
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_the_approach_at_a_load_is_the_inverse_of_the_load(name):
    law, radius = LAWS[name], np.array([2.0, 3.0, 4.0])
    load = np.array([[500.0, 0.0, 20.0], [0.0, 1e-3, 4000.0]])
    approach, compliance = law.approach_at_load(load, radius)
    found, stiffness = law.load_and_stiffness(approach, radius)
    # Newton's last step is below 1e-7 and convergence quadratic; the derivative is that of the last step but one.
    np.testing.assert_allclose(found, load, rtol=1e-12)
    np.testing.assert_allclose(compliance[load > 0.0] * stiffness[load > 0.0], 1.0, rtol=1e-6)
    assert not approach[load == 0.0].any()
    assert not compliance[load == 0.0].any()


@pytest.mark.parametrize("name", LAWS)
def test_a_law_of_some_contacts_answers_as_the_whole_does_there(name):
    law, approach, radius = LAWS[name], np.array([[1e-3, 5e-3, 0.02], [2e-3, 0.01, 0.03]]), np.full((2, 3), 2.0)
    load, stiffness = law.load_and_stiffness(approach, radius)
    chosen = (np.arange(2)[:, None], np.array([[2, 0], [1, 2]]))
    for places in (approach > 4e-3, chosen):
        some = law.take(approach.shape, places).load_and_stiffness(approach[places], radius[places])
        # The iteration ends when the worst of the contacts asked for has settled.
        np.testing.assert_allclose(some, (load[places], stiffness[places]), rtol=1e-6)


def test_a_law_without_pressures_says_so():
    spring = SpringLaw(stiffness=1e5)
    for law in (spring, BackedLaw(contact=spring, seat=None, play=np.zeros(1))):
        with pytest.raises(TypeError, match=f"{type(law).__name__} has no pressure"):
            law.mid_pressure(np.full((1, 1), 1e-3), 1.0)
        with pytest.raises(TypeError, match=f"{type(law).__name__} has no half-width"):
            law.half_width(np.full((1, 1), 1e-3), 1.0)
