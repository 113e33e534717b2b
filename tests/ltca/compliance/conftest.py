"""Coefficients in closed form, read from a file like those of finite elements, and coefficients held at one pose."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.compliance.coefficients import InfluenceCoefficients, load_coefficients
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

    They follow the pose by 1e-3 of the tangent, which has none of it. Between chosen contacts they are taken from those of all.
    """
    whole, held = InfluenceCoefficients.disc_matrix, {}

    def first(self, *places, among=False):
        *places, loaded = places if len(places) == 6 else (*places, None)
        of_tilts = self.tilting is None
        if of_tilts not in held:
            held[of_tilts] = whole(self, *places)
        matrix = held[of_tilts]
        if loaded is not None:
            ahead = np.cumsum([0, *(each.shape[1] for each in places[:2])])
            chosen = np.concatenate([number + some for number, some in zip(ahead, loaded, strict=True)], axis=1)
            matrix = np.take_along_axis(matrix, chosen[:, None], axis=2)
            if among:
                matrix = np.take_along_axis(matrix, chosen[..., None], axis=1)
        return matrix.copy()

    return lambda: monkeypatch.setattr(InfluenceCoefficients, "disc_matrix", first)
