"""The tables in the package are those that ``python -m validation.shipped_tables`` makes."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from dataclasses import asdict
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest

from ltca.contact import end_pressure
from ltca.contact.contact_kind import CELLS, ContactKind
from ltca.drive.members.width import FEWEST_SLICES, MOST_SLICES
from ltca.laws import line_contact, sliced_line
from ltca.laws.line_contact import LONGEST, SHORTEST, line_contact_table
from validation.shipped_tables import tabulate_line_contact, tabulate_softer_ends

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_line_contact_remade():
    """The same bits on the processor that made them, with one thread."""
    shipped, made = line_contact_table(), tabulate_line_contact()
    x = np.linspace(-2.0 * np.log(LONGEST), -2.0 * np.log(SHORTEST), 500)
    # OpenBLAS' kernels for other processors (Haswell, Zen, Nehalem) moved the curves by up to 5e-11 of their largest
    # value, slopes by 3e-9, curvatures by 1e-7: the matrices of graded grids have condition numbers near 1e6.
    for name in ("inverse_energy", "inverse_square_pressure", "inverse_square_half_width"):
        both = (getattr(table, name).value_and_derivatives(x) for table in (shipped, made))
        for stored, fresh, tolerance in zip(*both, (1e-9, 3e-8, 1e-6), strict=True):
            np.testing.assert_allclose(stored, fresh, rtol=0.0, atol=tolerance * np.max(np.abs(fresh)))


def test_end_pressure_remade():
    nodes, ratio = end_pressure.tabulate_cylinder_ratio(CELLS)
    stored = json.loads(end_pressure.TABLE.read_text(encoding="utf-8"))
    np.testing.assert_allclose(stored["nodes"], nodes, rtol=1e-14)  # logarithms
    np.testing.assert_allclose(stored["ratio"], ratio, rtol=1e-9)  # as above


@pytest.mark.slow
@pytest.mark.family(full=1)
@pytest.mark.parametrize("slices", [9, 33])
def test_softer_ends_remade(slices):
    stored = json.loads(sliced_line.TABLE.read_text(encoding="utf-8"))["softer"][str(slices)]
    np.testing.assert_allclose(stored, tabulate_softer_ends(slices), atol=2e-7)  # seven digits are kept


def test_every_number_of_slices_has_its_softer_ends():
    stored = json.loads(sliced_line.TABLE.read_text(encoding="utf-8"))["softer"]
    assert [int(slices) for slices in stored] == list(range(FEWEST_SLICES, MOST_SLICES + 1, 2))


def test_a_table_written_and_read_is_the_same_to_the_last_bit():
    made = json.dumps(asdict(line_contact_table()), indent=0, default=np.ndarray.tolist) + "\n"
    assert made == line_contact.TABLE.read_text(encoding="utf-8")


@pytest.mark.parametrize("cells", [CELLS, 8])
def test_end_pressure_of_grids_that_are_not_shipped_is_solved(cells):
    """The table of one grid does not answer for another."""
    kind = ContactKind(length=10.0, contact_modulus=1e5, generator=None, symmetric=True, cells=cells)
    found = end_pressure.largest_pressure_ratio(kind, np.array([[0.01]]), np.array([[2.0]]))[0, 0]
    node, ratio = end_pressure.tabulate_cylinder_ratio(cells)
    assert found == pytest.approx(np.interp(np.log(10.0) - 0.5 * np.log(0.02), node, ratio), rel=3e-9)


def test_the_wheel_has_the_tables():
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]["package-data"]
    for table in (line_contact.TABLE, end_pressure.TABLE, sliced_line.TABLE):
        assert any(fnmatch(table.relative_to(ROOT / "ltca").as_posix(), pattern) for pattern in data["ltca"])


@pytest.mark.slow
def test_an_analysis_on_tables_needs_no_scipy():
    """A second of a cold start was spent on its import and on tables that are data."""
    words = (
        "import sys, numpy; from ltca.analysis.loaded_analysis import analyse; "
        "from ltca.reading.drive_file import load_drive; "
        "analyse(load_drive('paper').cases['CS-1'], numpy.array([0.5])); "
        "print([name for name in sys.modules if name.partition('.')[0] == 'scipy'])"
    )
    found = subprocess.run([sys.executable, "-c", words], check=True, capture_output=True, text=True)
    assert found.stdout.strip() == "[]"
