"""Which tolerance studies are refused before the work."""

import pytest
from refusals import error_says

from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive
from ltca.studies.tolerance_study import tolerance_study


def test_saltellis_design_asks_for_eight_blocks_of_two_samples_more_than_fields():
    """A block has two independent samples and one with each field exchanged (Saltelli et al. 2010, N (k + 2))."""
    file = load_drive("paper")
    fields = len(file.tolerances)
    least = 8 * (fields + 2)
    with error_says(DriveError, f"at least {least}, 8 blocks of {fields + 2} samples for {fields} fields"):
        tolerance_study(file, case="CS-1", samples=3, positions=2, sequence="saltelli")
    study = tolerance_study(file, case="CS-1", samples=least, positions=2, sequence="saltelli")
    assert study.design.samples == least
    with pytest.raises(DriveError, match="must have at least"):
        tolerance_study(file, case="CS-1", samples=least - 1, positions=2, sequence="saltelli")
