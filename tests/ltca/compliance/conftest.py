"""Coefficients in closed form, read from a file like those of finite elements, and coefficients held at one pose."""

from __future__ import annotations

import pytest

from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.testing.closed_form_bodies import closed_form_coefficients


@pytest.fixture
def closed_form(tmp_path):
    """Return a function that writes a drive's coefficients in closed form and reads them as a run does."""

    def load(drive, *, half_width=0.05, depth=300.0):
        path = tmp_path / "closed_form.nc"
        closed_form_coefficients(drive, half_width=half_width, depth=depth).to_netcdf(path, engine="h5netcdf")
        return load_coefficients(path, drive)

    return load


@pytest.fixture
def hold_coefficients(monkeypatch):
    """Return a function from whose call on coefficients are those of the places where they are asked for first.

    They follow the pose by 1e-3 of the tangent, which has none of it.
    """
    whole, held = CoupledCompliance.body_flexibility, []

    def first(self, places, loaded):
        held.append(places)
        return whole(self, held[0], loaded)

    return lambda: monkeypatch.setattr(CoupledCompliance, "body_flexibility", first)
