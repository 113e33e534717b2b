"""Meshes of a drive: bodies that may share one do."""

import numpy as np

from fem.drive.expected_contacts import ContactGroup
from fem.drive.meshes import CLASS_RATIO, ELEMENTS_PER_HALF_WIDTH, RATIO_STEPS, _plan_circles
from fem.options import SolutionOptions
from fem.shapes import CircleShape


def group(half_width):
    return ContactGroup(half_width=half_width, load=half_width**2, direction=np.zeros(len(half_width)))


def test_rollers_of_one_class_have_one_mesh_at_both_ends():
    """Both ends carry one load: classes of their own gave rollers of one class up to twice as many meshes."""
    outer = np.geomspace(0.05, 0.2, 41)
    ratio = 0.81
    shapes = tuple(CircleShape(name=f"roller_{n}", radius=5.0) for n in range(len(outer)))
    plan = _plan_circles(shapes, (group(outer), group(ratio * outer)), SolutionOptions(), 2)
    gradings = [grading for _, grading, _ in plan]
    # Two octaves of half-widths are four classes of √2; five where the range does not begin with one.
    assert len(set(gradings)) <= 5
    for grading, width in zip(gradings, outer, strict=True):
        for end, own in zip(grading.ends, (width, ratio * width), strict=True):
            # As small as asked for at the lower end of the class, and not by more than class and rounding smaller.
            asked = own / ELEMENTS_PER_HALF_WIDTH
            assert asked / (CLASS_RATIO * (1.0 + 2.0 / RATIO_STEPS)) < end.edge <= asked * (1.0 + 1e-12)
            assert own <= end.half_width * (1.0 + 2.0 / RATIO_STEPS)


def test_a_roller_without_contact_has_no_small_elements():
    shape = (CircleShape(name="roller_0", radius=5.0),)
    ((_, grading, _),) = _plan_circles(shape, (group(np.zeros(1)), group(np.zeros(1))), SolutionOptions(), 2)
    assert grading.refinements == ()
