"""Near fields of contacts."""

import pytest

from ltca.compliance.near_field import near_field_depth
from ltca.reading.drive_file import load_drive


def test_near_fields_of_wider_contacts_reach_deeper():
    """The depth down to which a contact of finite length counts goes with that length, as all lengths of a half-space do."""
    drive = load_drive("paper").cases["CS-1"]
    wide = drive.with_fields({"disc.thickness": 3.0 * drive.disc.thickness})
    narrow, wide = (near_field_depth(one, "half-space") for one in (drive, wide))
    assert wide == pytest.approx(3.0 * narrow, rel=1e-12)
    assert 0.1 * drive.disc.thickness < narrow < 10.0 * drive.disc.thickness
