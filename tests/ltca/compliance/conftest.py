"""Coefficients in closed form, read from a file like those of finite elements."""

from __future__ import annotations

import pytest

from ltca.compliance.coefficients import load_coefficients
from ltca.testing.closed_form_bodies import closed_form_coefficients


@pytest.fixture
def closed_form(tmp_path):
    """Return a function that writes a drive's coefficients in closed form and reads them as a run does."""

    def load(drive, *, half_width=0.05, depth=300.0):
        path = tmp_path / "closed_form.nc"
        closed_form_coefficients(drive, half_width=half_width, depth=depth).to_netcdf(path, engine="h5netcdf")
        return load_coefficients(path, drive)

    return load
