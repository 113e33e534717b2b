"""How accurate the line-contact table is, and the orders of convergence its extrapolation uses."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.pressure_cells import solve_cylinder_patch
from ltca.laws.line_contact import LineContactLaw

LAW = LineContactLaw(1.0, 1.0)


def solutions(slenderness, counts):
    half_width = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=16).half_width
    return [solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=c, half_width=half_width) for c in counts]


@pytest.mark.slow
@pytest.mark.parametrize("slenderness", [3.0, 30.0, 300.0])
def test_energy_converges_with_the_order_the_table_assumes(slenderness):
    coarse, middle, fine = (s.energy for s in solutions(slenderness, (8, 16, 32)))
    order = np.log2((middle - coarse) / (fine - middle))
    # 2.7 is assumed; the exact order is 3 up to logarithms and the end grading, seen as 2.5 … 2.9
    assert 2.4 < order < 3.0


@pytest.mark.slow
@pytest.mark.parametrize("slenderness", [3.0, 30.0, 300.0])
def test_energy_rises_to_its_limit_from_below(slenderness):
    """The discrete energy is the maximum over fewer pressures: it must not exceed the limit."""
    coarse, middle, fine = (s.energy / slenderness for s in solutions(slenderness, (8, 16, 32)))
    limit = float(LAW.energy(slenderness**-2.0, 1.0)) * slenderness**4
    assert coarse < middle < fine < limit * (1 + 1e-5)  # the table's own accuracy


@pytest.mark.slow
@pytest.mark.parametrize(
    "slenderness",
    [0.3, 13.0, 777.0, 9.1e4, *(pytest.param(ratio, marks=pytest.mark.nightly) for ratio in (0.7, 2.0, 101.0, 9e3))],
)
def test_table_against_refined_grids(slenderness):
    """Off the nodes, two grids of 16 and 32 cells extrapolated: the table uses 8 and 16."""
    middle, fine = solutions(slenderness, (16, 32))

    def limit(first, second, order):
        return second + (second - first) / (2.0**order - 1.0)

    approach = slenderness**-2.0
    load, _ = LAW.load_and_stiffness(approach, 1.0)
    energy = limit(middle.energy, fine.energy, 2.7) / slenderness
    force = limit(middle.load, fine.load, 2.7) / slenderness
    # measured: energy 2.2e-5, load 2.5e-5 (5e-6 above λ = 5); half of it sits in the ends, half in the nodes' spacing
    assert float(LAW.energy(approach, 1.0)) / approach**2 == pytest.approx(energy, rel=4e-5)
    assert float(load) / approach == pytest.approx(force, rel=4e-5)
    # measured: pressure 3.3e-4 at λ = 0.3 and 1e-4 above 2, half-width 4e-4 at 0.3 and 5e-5 above 2
    tolerance = 5e-4 if slenderness < 1.0 else 1.5e-4
    pressure = limit(middle.mid_pressure, fine.mid_pressure, 2.4)
    half_width = limit(middle.half_width, fine.half_width, 2.4)
    assert float(LAW.mid_pressure(approach, 1.0)) * slenderness == pytest.approx(pressure, rel=tolerance)
    assert float(LAW.half_width(approach, 1.0)) * slenderness == pytest.approx(half_width, rel=tolerance)


@pytest.mark.slow
def test_stiffness_against_loads_of_refined_grids():
    """dF/dδ from the difference of two extrapolated loads five per cent apart."""
    for slenderness in (5.0, 60.0, 2000.0):
        loads = []
        for factor in (0.95, 1.05):
            place = slenderness / np.sqrt(factor)
            middle, fine = solutions(place, (16, 32))
            loads.append((fine.load + (fine.load - middle.load) / 5.5) * factor / place)
        _, stiffness = LAW.load_and_stiffness(slenderness**-2.0, 1.0)
        # δ ± 5 %: the difference quotient itself errs by δ² F'''/6 · 0.05² < 1e-4, the loads by 1e-5/0.05
        assert (loads[1] - loads[0]) / 0.1 == pytest.approx(float(stiffness), rel=4e-4)
