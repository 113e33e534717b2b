"""Motions of the contact problem of a solid disc."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.solid_drive.solid_model import SolidModel


@pytest.mark.parametrize(("even", "motions"), [(True, 7), (False, 12)])
def test_motions_are_those_of_disc_wheel_and_candidate_rollers(even, motions):
    """x, y and rotation of the disc, the wheel, three rollers; two tilts and three leans more where sides differ along the width.

    The moment holds the wheel; without any pair nothing else is there.
    """
    none = np.zeros((0, 0))
    model = SimpleNamespace(
        unknown_count=0,
        rollers=(2, 5, 6),
        on_disc=0,
        disc=SimpleNamespace(compliance=none),
        race=SimpleNamespace(compliance=none),
        placement=SimpleNamespace(cranks=1, wheel_axis=0j),
        race_unknowns=lambda _: slice(0, 0),
        loads_on_race=lambda _: np.zeros(0, dtype=int),
        roller_rays=np.zeros(9, dtype=complex),
        widths=SimpleNamespace(even=even),
        disc_pose=lambda _: SimpleNamespace(centre=4.0 + 0.0j),
        pairs=(),
    )
    model.motion_count = SolidModel.motion_count.fget(model)
    problem = SolidModel.contact_problem(model, None, [], 300.0)
    assert problem.motions.shape == (0, motions)
    np.testing.assert_array_equal(problem.external, [0.0, 0.0, 0.0, -300.0, *np.zeros(motions - 4)])
