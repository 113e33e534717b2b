"""Laws between the compliance models, on coefficients made by hand."""

from __future__ import annotations

from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.testing.closed_form_bodies import without_coupling
from validation.levels import model_laws
from validation.levels.model_laws import pair_approaches, widen

LOAD = np.where(np.arange(14) < 5, 1000.0, 0.0)


@pytest.fixture(scope="module")
def made(paper_cases):
    """CS-6 and coefficients with numbers in every matrix, random but of the size of real ones; 2(1 − ν²)/(πEt) is that of
    steel, as it must be for the datum of the near field not to matter."""
    drive = paper_cases["CS-6"]
    plain = without_coupling(drive)
    rng = np.random.default_rng(4)
    filled = {
        name: rng.uniform(0.5e-6, 1e-6, np.shape(getattr(plain, name))) for name in ("disc", "pin", "roller", "race")
    }
    filled["disc"] = 0.5 * (filled["disc"] + filled["disc"].T)
    steel = 2.0 * 0.91 / (np.pi * 206_000.0 * 11.8)
    filled |= {f"{name}_logarithm": np.float64(steel) for name in ("disc", "pin", "roller", "race")}
    return drive, replace(plain, **{name: value if value.shape else float(value) for name, value in filled.items()})


def test_a_wide_drive_is_the_same_slice_many_times(made):
    """All that carries by width grows with it; all coefficients of plane strain fall with it; nothing else moves."""
    drive, coefficients = made
    wide, scaled = widen(drive, coefficients, 4.0)
    assert wide.disc.thickness == pytest.approx(4.0 * 11.8)
    assert wide.crank_bearing.roller_length == pytest.approx(4.0 * drive.crank_bearing.roller_length)
    assert wide.pin_shaft.stiffness == pytest.approx(4.0 * drive.pin_shaft.stiffness)
    assert wide.load.torque == pytest.approx(4.0 * 377_300.0)
    assert wide.load.light_torque == pytest.approx(4.0 * drive.load.light_torque)
    assert scaled.thickness == pytest.approx(4.0 * coefficients.thickness)
    for item in fields(coefficients):
        value = getattr(coefficients, item.name)
        if item.name.removesuffix("_logarithm") in ("disc", "pin", "roller", "race"):
            np.testing.assert_allclose(getattr(scaled, item.name), np.asarray(value) / 4.0, err_msg=item.name)
    assert wide.pin_wheel == drive.pin_wheel
    assert wide.clearance == drive.clearance


def test_plane_strain_knows_no_width(made):
    """Load by width and coefficients by width: the approach stays, to round-off; that of finite length does not."""
    drive, coefficients = made
    narrow = pair_approaches(drive, coefficients, "plane-strain", 0.5, LOAD)
    wide, scaled = widen(drive, coefficients, 4.0)
    np.testing.assert_allclose(pair_approaches(wide, scaled, "plane-strain", 0.5, 4.0 * LOAD), narrow, rtol=1e-9)
    assert np.all(narrow[:5] > 0.0)
    finite = pair_approaches(drive, coefficients, "half-space", 0.5, LOAD)
    broad = pair_approaches(wide, scaled, "half-space", 0.5, 4.0 * LOAD)
    assert np.all(np.abs(broad[:5] / finite[:5] - 1.0) > 5e-4)


def test_the_body_part_is_that_of_the_coefficients(made):
    """Twice the body part of pin and disc moves the approach by just its share of the load."""
    drive, coefficients = made
    more = replace(coefficients, pin=np.float64(coefficients.pin) + 2e-6)
    first, second = (pair_approaches(drive, own, "half-space", 0.5, LOAD) for own in (coefficients, more))
    np.testing.assert_allclose((second - first)[:5], 2e-6 * 1000.0, rtol=1e-9)
    np.testing.assert_array_equal(second[5:], 0.0)


def test_finite_lengths_tend_to_plane_strain(made, monkeypatch):
    """Of half-spaces with bodies that do not couple: the rows of the level keep their limits, whatever loads the pins carry."""
    drive, _ = made
    response = SimpleNamespace(pin_load=LOAD[None])
    monkeypatch.setattr(
        model_laws, "analyse", lambda *_, **__: SimpleNamespace(full=SimpleNamespace(response=response))
    )
    *gaps, falls = model_laws._wide(drive, "CS-6", np.array([0.5]), made[1])
    assert [abs(row.value) for row in gaps] == sorted((abs(row.value) for row in gaps), reverse=True)
    assert abs(gaps[-1].value) < gaps[-1].limit
    assert falls.value > 0.0
