"""A comparison takes one ring: full finite elements always have it of finite elements."""

import pytest

from ltca.drive.single_discs import single_discs
from ltca.errors import CycloError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import without_coupling
from validation.compare import compared_positions


@pytest.mark.parametrize(("model", "compared"), [("beam", "fe"), ("fe", "fe"), (None, None)])
def test_the_models_take_the_ring_of_the_full_solution(model, compared, monkeypatch):
    """The models took the beam of the drive file, the full solution finite elements: their difference was counted as error."""
    joint = load_drive("robot-joint").cases["nominal"]
    if model is not None:
        joint = with_fields(
            joint, {"ring": {"inner_radius": 60.0, "outer_radius": 90.0, "width": 50.0, "model": model}}
        )
    seen = []

    def analyse(drive, *given, **options):
        seen.append(None if drive.ring is None else drive.ring.model)
        raise CycloError("far enough")

    monkeypatch.setattr(compared_positions, "analyse", analyse)
    with pytest.raises(CycloError, match="far enough"):
        compared_positions.compare_case(joint, [], without_coupling(single_discs(joint)[0]))
    assert seen == [compared]
