"""The paper's flank: gaps and backlash of its Fig. 23 discussion and the reading notes.

Sources
-------
[1] *Contact characteristics of cycloid planetary gear drives considering backlashes and clearances*, section 4.1:
    the offset modification "yields about 10 arcmin of backlash".
[2] shared/paper/notes.md: ΔR_C = +0.09 mm, Δr_P = +0.15 mm fit it; gaps 0.060 mm (tip, root) to 0.081 mm (flank);
    10.6–10.8 arcmin as rotation of the disc about its held centre, 9.8–10.1 arcmin at the wheel (issue 2).
"""

from __future__ import annotations

import numpy as np
import pytest

from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash
from ltca.geometry.pairs import ContactGeometry

ARCMIN = 60.0 * 180.0 / np.pi


@pytest.fixture(scope="module")
def geometry(paper_cases):
    return ContactGeometry.of_drive(paper_cases["CS-1"])


def test_nominal_gaps(geometry):
    angles = 2.0 * np.pi * np.arange(720) / 720
    gap = -geometry.flank(angles, np.zeros((720, 4))).approach
    # [2], printed to 1 µm. Tip and root: Δr_P − ΔR_C.
    assert gap.min() == pytest.approx(0.060, abs=1e-5)
    # Steepest flank: Δr_P − ΔR_C cos ψ with sin ψ = e z_P/R_C = 56/88; second order ΔR_C²/(2·10 mm) = 0.4 µm
    assert gap.max() == pytest.approx(0.15 - 0.09 * np.sqrt(1.0 - (56.0 / 88.0) ** 2), abs=4e-4)
    assert gap.max() == pytest.approx(0.081, abs=5e-4)


def test_backlash(geometry):
    angles = 2.0 * np.pi * np.arange(360) / 360
    disc = backlash(geometry, angles, DISC_ROTATION) * ARCMIN
    wheel = backlash(geometry, angles, WHEEL_ANGLE) * ARCMIN
    # [1], [2]: in the mean; a backlash averaged otherwise or halved would miss both intervals
    assert 10.6 < disc.mean() < 10.8
    assert 9.8 < wheel.mean() < 10.1
    # first order: both from the same gaps with lever arms e z_C and e z_P
    assert disc.mean() / wheel.mean() == pytest.approx(14.0 / 13.0, rel=2e-3)


def test_fewest_free_parameters(geometry):
    """Root and tip of the disc: R_C + ΔR_C ∓ e − r_P − Δr_P."""
    assert geometry.profile.root_radius == pytest.approx(88.09 - 4.0 - 6.65, abs=1e-12)
    assert geometry.profile.tip_radius == pytest.approx(88.09 + 4.0 - 6.65, abs=1e-12)
