"""Plane and solid bodies by name: who takes them, what is refused, what results tell."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_is, error_says, refused_field

import ltca
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain, engine_named, engine_of, nearly_same_body
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.coefficient_files import file_name
from ltca.compliance.coefficients import _coefficients_of_dataset
from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients

PAPER = load_drive("paper").cases["CS-3"]


def coefficients(drive, tilt_depth=260.0):
    data = closed_form_coefficients(drive, half_width=0.05, depth=300.0, tilt_depth=tilt_depth)
    return _coefficients_of_dataset(data, drive, shared=False)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("slices", [1, 3])
def test_results_say_that_bodies_are_solid(slices):
    """Attributes of results and the sentence beside them; plane ones keep theirs."""
    drive = PAPER.with_fields({"contact.slices": slices})
    solid = analyse(drive, np.array([0.5]), engine=Hybrid(coefficients=coefficients(drive), bodies="solid"))
    plane = analyse(drive, np.array([0.5]), engine=Hybrid(coefficients=coefficients(drive, None)))
    assert (solid.engine.options["bodies"], plane.engine.options["bodies"]) == ("solid", "plane")
    assert "those of solids with their ends" in solid.width_words
    assert ("tilt of every contact" in solid.width_words) == (slices == 3)
    assert ("those of the plane" in plane.width_words) == (slices == 3)


def test_names_of_bodies_reach_the_engine():
    """The option wins over the drive file, whose word counts where none is given; half-spaces have none."""
    filed = PAPER.with_fields({"analysis.compliance": "hybrid", "analysis.bodies": "solid"})
    assert engine_of([filed]).bodies == "solid"
    assert engine_of([filed], bodies="plane").bodies == "plane"
    assert engine_of([filed], "fe") == PlaneStrain(bodies="solid")
    assert engine_of([filed], "half-space") == HalfSpace()
    assert engine_named("hybrid").bodies == "plane"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"compliance": "half-space", "bodies": "solid"}, "bodies: has no effect with compliance half-space"),
        ({"method": "paper", "bodies": "solid"}, "bodies: has no effect with compliance half-space"),
        (
            {"compliance": "hybrid", "bodies": "solids"},
            "bodies = 'solids': is unknown; must be one of 'plane', 'solid'",
        ),
        ({"compliance": Hybrid(), "bodies": "solid"}, "bodies: is an option of the engine given as compliance"),
    ],
)
def test_bodies_that_mean_nothing_are_refused(given, words):
    with error_says(DriveError, words):
        ltca.analyse(PAPER, 2, **given)


def test_bodies_are_refused_where_a_file_contradicts_itself():
    filed = PAPER.with_fields({"analysis.compliance": "half-space", "analysis.bodies": "solid"})
    with refused_field("analysis.bodies", "= 'solid'", "has no effect with analysis.compliance = 'half-space'"):
        engine_of([filed])
    with refused_field("analysis.bodies", "= plane, solid", "must be the same in all drives"):
        engine_of([PAPER, filed], "hybrid")


def test_coefficients_of_other_bodies_are_refused():
    with error_is(DriveError, "coefficients: are of solid bodies; bodies = 'plane' asks for others"):
        Hybrid(coefficients=coefficients(PAPER))


def test_solid_shapes_have_the_length_of_rollers():
    """Another length is another shape of solid bodies, and of plane ones the same: files, and drives that lend theirs."""
    longer = PAPER.with_fields({"crank_bearing.roller_length": 11.8})
    other = PAPER.with_fields({"crank_bearing.roller_length": 11.0})
    assert file_name(longer) == file_name(other)
    assert file_name(longer, "solid") != file_name(other, "solid")
    assert file_name(longer, "solid").endswith("-solid.nc")
    assert nearly_same_body(longer, other)
    assert not nearly_same_body(longer, other, "solid")
    near = PAPER.with_fields({"crank_bearing.roller_length": 11.79})
    assert nearly_same_body(longer, near, "solid")
    lent = Hybrid(bodies="solid").lending([longer])
    assert [lent.bodies_of([one])[0] for one in (longer, near, other)] == [longer, longer, other]
    assert replace(coefficients(longer)).lent_to(near).shared


@pytest.mark.slow
def test_what_reshapes_solid_bodies_alone_has_no_derivative_on_them():
    """The length of rollers shapes solid rollers; plane ones yield like one over it."""
    results = [
        ltca.analyse(PAPER, crank_angle=[0.5], compliance=engine)
        for engine in (
            Hybrid(coefficients=coefficients(PAPER), bodies="solid"),
            Hybrid(coefficients=coefficients(PAPER, None)),
        )
    ]
    with refused_field("crank_bearing.roller_length", "", "reshapes a body"):
        ltca.derivatives(results[0], ["crank_bearing.roller_length"])
    assert "pin_load" in ltca.derivatives(results[1], ["crank_bearing.roller_length"])
