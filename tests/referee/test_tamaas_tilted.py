"""Contacts that tilt against tamaas over the whole surface: loads, moments and pressures of slices and of grids.

tamaas is given the load and finds the approach; slices and grids are asked at that approach (`test_tamaas_rollers` says what it
shares with them: nothing).
"""

from __future__ import annotations

import needs
import numpy as np
import pytest

from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.tilted_grid import press_tilted
from ltca.geometry.length_profile import Relief
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.laws.width_pressure import estimate_along_width
from validation.methods.grid_pressures import solve_along_width

tamaas = needs.optional("tamaas")
pytestmark = [pytest.mark.needs("referee")]

LENGTH, MODULUS, RADIUS = 12.0, 115e3, 20.0


def press(span, counts, separation, load):
    """Pressure, MPa, heights of its cells, mm, and approach, mm, of a contact under a load, N."""
    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [span, LENGTH], list(counts))
    model.E, model.nu = MODULUS, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "free")
    x, z = ((np.arange(n) + 0.5) * size / n - size / 2 for n, size in zip(counts, (span, LENGTH), strict=True))
    surface = -separation(x[:, None], z[None, :])
    solver = tamaas.PolonskyKeerRey(model, np.ascontiguousarray(surface), 1e-8)
    solver.setIntegralOperator("free")
    solver.max_iter = 5000
    assert solver.solve(load / (span * LENGTH)) < 1e-8, "tamaas did not converge"
    pressure = np.array(model.traction)
    displacement = np.empty_like(pressure)
    model.operators["free"](pressure, displacement)
    loaded = pressure > 0.2 * pressure.max()
    return pressure, z, float(np.mean((displacement - surface)[loaded]))


@pytest.mark.parametrize(
    ("drop", "tilt", "load", "span", "slices"),
    [
        pytest.param(0.0, 2e-4, 1200.0, 0.9, 9, id="tilted", marks=pytest.mark.slow),
        pytest.param(0.0, 1e-3, 1200.0, 1.3, 9, id="two thirds of the line", marks=pytest.mark.nightly),
        pytest.param(0.0, 4e-3, 1000.0, 1.8, 17, id="a third, seventeen slices", marks=pytest.mark.nightly),
        pytest.param(5e-3, 5e-4, 800.0, 0.9, 9, id="crowned", marks=pytest.mark.slow),
        pytest.param(15e-3, 2e-3, 800.0, 1.1, 9, id="crowned, on its side", marks=pytest.mark.nightly),
    ],
)
def test_load_moment_and_pressure(drop, tilt, load, span, slices):
    profile = None
    if drop:
        profile = Relief(length=LENGTH, crown_radius=LENGTH**2 / (8.0 * drop))
    kind = ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=profile, symmetric=True)
    pressure, z, approach = press(span, (96, 384), lambda x, y: x**2 / (2.0 * RADIUS) + kind.relief(y) - tilt * y, load)
    cell = span / 96 * LENGTH / 384
    assert pressure.sum() * cell == pytest.approx(load, rel=1e-6)
    assert not pressure[(0, -1), :].any()  # wide enough
    moment = float((pressure * z).sum()) * cell
    arm = max(abs(moment), load * LENGTH / 6.0)
    grid = press_tilted(
        kind, Separation(effective_radius=RADIUS, departure=lambda _, x: x**2 / (2.0 * RADIUS)), approach, tilt
    )
    # Both converge to the same: cells of tamaas err by 0.1 to 0.3 % at ends that carry.
    assert grid.load == pytest.approx(load, rel=5e-3)
    assert grid.moment == pytest.approx(moment, abs=5e-3 * arm)
    line = SlicedLine(
        length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=kind.relief(slice_heights(LENGTH, slices))
    )
    given = [np.array([value]) for value in (approach, tilt, RADIUS)]
    found = line.respond(*given)
    assert found.load[0] == pytest.approx(load, rel=0.01)
    # docs/theory/width.md: 2 %, of short lines 3 %; of L/b = 88 and a third of the line 2.3 %.
    assert found.moment[0] == pytest.approx(moment, abs=(0.03 if slices == 17 else 0.02) * arm)
    if drop:
        largest = float(pressure.max())
        assert estimate_along_width(kind, found.line_load, given[2]).largest[0] == pytest.approx(largest, rel=0.03)
        assert solve_along_width(kind, *given).largest[0] == pytest.approx(largest, rel=0.01)
