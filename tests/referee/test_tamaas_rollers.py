"""Centre pressures and approaches of rollers against tamaas: FFT (non-periodic Boussinesq), conjugate gradients.

tamaas shares nothing with our grids: uniform cells, point values of Love's solution convolved by FFT, iterative
solver, load instead of approach prescribed. Its peaks at unrelieved ends depend on its cells, so only centre values
are compared there.
"""

from __future__ import annotations

import needs
import numpy as np
import pytest

from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.drive.parts import Material, contact_modulus
from ltca.geometry.length_profile import LOGARITHMIC, Relief
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import ProfiledLineContactLaw, solve_profiled_patch

tamaas = needs.optional("tamaas")
pytestmark = pytest.mark.needs("referee")

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)
MODULUS = contact_modulus(STEEL, STEEL)


def press(length, span, counts, separation, load):
    """Pressure [MPa] and approach [mm] of a contact over span × length under a load, by tamaas."""
    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [span, length], list(counts))
    model.E, model.nu = MODULUS, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "free")
    x, y = ((np.arange(n) + 0.5) * size / n - size / 2 for n, size in zip(counts, (span, length), strict=True))
    surface = -separation(x[:, None], y[None, :])
    solver = tamaas.PolonskyKeerRey(model, np.ascontiguousarray(surface), 1e-8)
    solver.setIntegralOperator("free")
    solver.max_iter = 5000
    residual = solver.solve(load / (span * length))
    assert residual < 1e-8, "tamaas did not converge"
    pressure = np.array(model.traction)
    displacement = np.empty_like(pressure)
    model.operators["free"](pressure, displacement)
    loaded = pressure > 0.2 * pressure.max()
    approach = float(np.mean((displacement - surface)[loaded]))
    return pressure, approach


def approach_under(law, load, radius):
    """Approach at which a law carries a load (Newton from a stiff guess)."""
    approach = load / (law.contact_modulus * 10.0)
    for _ in range(50):
        found, stiffness = law.load_and_stiffness(approach, radius)
        approach -= float((found - load) / stiffness)
    return approach


def centre_peak(pressure):
    """Largest pressure at mid-width: the two middle rows agree by symmetry."""
    middle = pressure.shape[1] // 2
    return float(pressure[:, middle - 1 : middle + 1].mean(axis=1).max())


@pytest.mark.parametrize(
    ("length", "load", "counts"),
    [
        pytest.param(11.8, 1500.0, (96, 512), id="long", marks=pytest.mark.nightly),
        pytest.param(2.0, 1500.0, (96, 256), id="short", marks=pytest.mark.slow),
        pytest.param(0.3, 400.0, (192, 128), id="shorter than wide", marks=pytest.mark.slow),
    ],
)
def test_centre_pressure_and_approach_of_uncrowned_rollers(length, load, counts):
    radius = 2.0
    law = LineContactLaw(length, MODULUS)
    approach = approach_under(law, load, radius)
    width = float(law.half_width(approach, radius))
    pressure, referee_approach = press(length, 3.6 * width, counts, lambda x, y: x**2 / (2 * radius) + 0.0 * y, load)
    # required 0.3 %; tamaas errs by its cell size (finer cells halve the difference), 0.15 % at worst
    assert float(law.mid_pressure(approach, radius)) == pytest.approx(centre_peak(pressure), rel=2e-3)
    # the same first-order error of its uniform cells at the ends: 0.05 % to 0.1 %
    assert approach == pytest.approx(referee_approach, rel=2e-3)


@pytest.mark.slow
def test_logarithmic_relief_benchmark():
    """D = L = 20 mm, 40 kN on a flat, ISO 16281:2025 profile, E = 210 GPa: 2710 MPa by Hertz, about 2760 MPa really."""
    profile = Relief(length=20.0, logarithm=LOGARITHMIC * 20.0)
    radius, load = 10.0, 40e3
    assert float(line_peak_pressure(load / 20.0, radius, MODULUS)) == pytest.approx(2710.0, abs=1.0)
    law = ProfiledLineContactLaw.for_radii(profile, MODULUS, radius, radius)
    approach = approach_under(law, load, radius)
    width = float(line_half_width(load / 20.0, radius, MODULUS))
    pressure, referee_approach = press(
        20.0, 3.2 * width, (96, 384), lambda x, y: x**2 / (2 * radius) + profile.relief(y), load
    )
    assert pressure.max() == pytest.approx(2760.0, rel=2e-3)
    # required 0.5 %; both codes are within 0.05 % of their limits
    assert float(law.mid_pressure(approach, radius)) == pytest.approx(float(pressure.max()), rel=1e-3)
    assert approach == pytest.approx(referee_approach, rel=1e-3)
    coarse = solve_profiled_patch(profile, radius, MODULUS, approach, cells=16)
    fine = solve_profiled_patch(profile, radius, MODULUS, approach, cells=32)
    assert coarse.load == pytest.approx(fine.load, rel=5e-4)
    assert fine.load == pytest.approx(load, rel=2e-4)
    assert coarse.pressure.max() == pytest.approx(fine.pressure.max(), rel=3e-3)
    assert fine.pressure.max() == pytest.approx(float(pressure.max()), rel=2e-3)
