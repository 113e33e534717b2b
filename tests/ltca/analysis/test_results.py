"""The dataset and the summary: names, conventions, and equilibrium rebuilt from the dataset alone."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from refusals import error_says

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset, check_common_shape
from ltca.analysis.summary import summarise
from ltca.errors import DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles

ANGLES = np.array([0.1, 1.3, -4.0, 25.0, 3.3])


@pytest.fixture(scope="module")
def analyses(paper_cases):
    return {name: analyse(drive, ANGLES) for name, drive in paper_cases.items()}


@pytest.fixture(scope="module")
def dataset(analyses):
    return build_dataset("paper", analyses)


@pytest.fixture(scope="module")
def flat(dataset):
    """The one disc on the one crank, without their dimensions."""
    return dataset.isel(disc=0, crank=0)


def test_every_part_has_its_place_in_the_dataset(dataset):
    sizes = {"case": 6, "disc": 1, "crank": 1, "position": 5, "pin": 14, "roller": 11, "hole": 8}
    assert dict(dataset.sizes) == sizes


def test_position_is_an_integer_index_and_crank_angle_the_request(dataset):
    assert dataset.indexes["position"].dtype.kind == "i"
    assert set(dataset.indexes) == {"case", "disc", "crank", "position", "pin", "roller", "hole"}
    np.testing.assert_array_equal(dataset["crank_angle"].values, ANGLES)
    assert "crank_angle" in dataset.coords
    assert list(dataset["case"].values) == ["CS-1", "CS-2", "CS-3", "CS-4", "CS-5", "CS-6"]
    assert all(np.all(np.isfinite(dataset[name])) for name in dataset)


@pytest.mark.slow
def test_netcdf_gives_back_what_was_written(dataset, tmp_path):
    import xarray as xr

    dataset.to_netcdf(tmp_path / "results.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as read:
        xr.testing.assert_identical(read.load(), dataset)


def test_default_positions():
    angles = position_angles(8)
    np.testing.assert_array_equal(angles, [2.0 * math.pi * k / 8 for k in range(8)])


def flank_point(theta, e, z, R, r):
    psi = math.atan2(math.sin((1 - z) * theta), R / (e * z) - math.cos((1 - z) * theta))
    direction = cmath.exp(1j * (theta + psi))
    return R * cmath.exp(1j * theta) - r * direction - e * cmath.exp(1j * z * theta), direction


def check_position(drive, at, torque):
    """Rebuild every approach and the balance of disc, wheel and rollers from one row of the dataset, plainly."""
    phi = float(at["crank_angle"])
    e, z = drive.crank.eccentricity, drive.pin_wheel.number_of_pins
    sign = 1.0 if drive.load.direction == "ccw" else -1.0
    radial, tangential = cmath.exp(1j * phi), 1j * cmath.exp(1j * phi)
    race = e * radial
    disc = race + float(at["disc_radial"]) * radial + float(at["disc_tangential"]) * tangential
    turn = cmath.exp(1j * float(at["disc_rotation"]))
    wheel_turn = phi / z + float(at["transmission_error"])
    R = drive.pin_wheel.pin_circle_radius + drive.disc.shifting_offset
    r = drive.pin_wheel.pin_radius + drive.disc.equidistant_offset

    disc_force, disc_moment, wheel_moment = 0j, 0.0, -sign * torque
    for i in range(z):
        pin = drive.pin_wheel.pin_circle_radius * cmath.exp(1j * (wheel_turn + 2.0 * math.pi * i / z))
        theta = float(at["pin_contact_parameter"][i])
        assert 0.0 <= theta < 2.0 * math.pi
        point, direction = flank_point(theta, e, z, R, r)
        point, direction = disc + point * turn, direction * turn
        # the normal at the contact passes through the pin centre (places to round-off of 88 mm)
        assert abs((direction.conjugate() * (pin - point)).imag) < 1e-11
        approach = drive.pin_wheel.pin_radius - (direction.conjugate() * (pin - point)).real
        assert float(at["pin_approach"][i]) == pytest.approx(approach, abs=1e-12)
        load = float(at["pin_load"][i])
        assert load >= 0.0
        assert (load > 0.0) == (approach > 0.0)
        disc_force -= load * direction
        disc_moment -= load * ((pin - disc).conjugate() * direction).imag
        wheel_moment += load * (pin.conjugate() * direction).imag

    shaft = drive.pin_shaft
    for k in range(shaft.number_of_pins):
        ray = cmath.exp(2j * math.pi * k / shaft.number_of_pins)
        pin, hole = shaft.pin_circle_radius * ray, disc + shaft.pin_circle_radius * ray * turn
        approach = abs(pin - hole) - (shaft.hole_radius + drive.clearance.pin_hole - shaft.pin_radius)
        assert float(at["pin_shaft_approach"][k]) == pytest.approx(approach, abs=1e-12)
        load = float(at["pin_shaft_load"][k])
        assert load == pytest.approx(shaft.stiffness * max(approach, 0.0), abs=1e-6)
        direction = (pin - hole) / abs(pin - hole)
        disc_force += load * direction
        disc_moment += load * ((hole - disc).conjugate() * direction).imag

    bearing = drive.crank_bearing
    bore = bearing.outer_race_radius + 0.5 * drive.clearance.bearing
    push = 0j
    for n in range(bearing.number_of_rollers):
        cage = bearing.inner_race_radius / (bearing.inner_race_radius + bearing.outer_race_radius) * phi
        ray = cmath.exp(1j * (cage + 2.0 * math.pi * n / bearing.number_of_rollers))
        inner, outer = float(at["roller_approach_inner"][n]), float(at["roller_approach_outer"][n])
        centre = race + (bearing.inner_race_radius + bearing.roller_radius - inner) * ray
        arm = centre - disc
        assert outer == pytest.approx(abs(arm) + bearing.roller_radius - bore, abs=1e-12)
        outer_load, inner_load = float(at["roller_load"][n]), float(at["roller_load_inner"][n])
        assert (outer_load > 0.0) == (outer > 0.0)
        if outer <= 0.0:
            assert inner == 0.0
            assert inner_load == 0.0
        direction = arm / abs(arm)
        # F_i = F_o (n_o·n): 1e-11 of the share at 1e6 N/mm
        assert inner_load == pytest.approx(outer_load * (direction.conjugate() * ray).real, abs=1e-5)
        push += outer_load * direction
    disc_force += push
    assert float(at["bearing_radial"]) == pytest.approx((radial.conjugate() * push).real, abs=1e-6)
    assert float(at["bearing_tangential"]) == pytest.approx((tangential.conjugate() * push).real, abs=1e-6)

    # every rolling contact acts through the disc centre: no moment on the disc
    residual = [disc_force.real, disc_force.imag, disc_moment / (e * (z - 1)), wheel_moment / (e * z)]
    assert max(map(abs, residual)) < 1e-6 * torque / (e * z)
    # and what is reported is that, up to the rounding of places times stiffness
    assert float(at["equilibrium_residual"]) == pytest.approx(max(map(abs, residual)), abs=2e-6)


def test_equilibrium_from_the_dataset_alone(flat, paper_cases):
    for case, drive in paper_cases.items():
        for position in range(ANGLES.size):
            check_position(drive, flat.sel(case=case).isel(position=position), 377_300.0)


def test_equilibrium_of_the_reverse_drive_and_another_torque(vary):
    drive = vary(load={"direction": "cw"}, clearance={"bearing": 0.01, "pin_hole": 0.01})
    data = build_dataset("reverse", {"only": analyse(drive, ANGLES, 100_000.0)}).isel(disc=0, crank=0)
    for position in range(ANGLES.size):
        check_position(drive, data.sel(case="only").isel(position=position), 100_000.0)
    assert np.all(data["bearing_tangential"] < 0.0)
    assert np.all(data["transmission_error"] > 0.0)


def test_summary_keys_and_scalars_from_the_dataset(analyses, flat):
    for case, analysis in analyses.items():
        summary = summarise(analysis)
        # five chosen angles are no turn: nothing is refined over it
        assert all((value is None) == key.startswith("refined_") for key, value in summary.items())
        assert all(math.isfinite(value) for value in summary.values() if value is not None)
        at = flat.sel(case=case)
        radial, tangential = at["bearing_radial"].values, at["bearing_tangential"].values
        total = [math.hypot(a, b) for a, b in zip(radial, tangential, strict=True)]
        expected = {
            "mean_bearing_load_N": sum(total) / 5,
            "mean_radial_bearing_load_N": radial.mean(),
            "mean_tangential_bearing_load_N": tangential.mean(),
            "ptp_tangential_bearing_load_N": tangential.max() - tangential.min(),
            "max_pin_load_N": at["pin_load"].values.max(),
            "max_pin_pressure_mid_MPa": at["pin_pressure_mid"].values.max(),
            "max_roller_load_N": at["roller_load"].values.max(),
            "max_roller_pressure_mid_MPa": max(
                at["roller_pressure_mid_outer"].values.max(), at["roller_pressure_mid_inner"].values.max()
            ),
            "max_pin_shaft_load_N": at["pin_shaft_load"].values.max(),
            "ptp_transmission_error_arcsec": np.ptp(np.degrees(at["transmission_error"].values)) * 3600.0,
            "ptp_transmission_error_light_arcsec": np.ptp(np.degrees(at["transmission_error_light"].values)) * 3600.0,
        }
        for key, load, count in (
            ("mean_loaded_pins", "pin_load", 14),
            ("mean_loaded_rollers", "roller_load", 11),
            ("mean_loaded_pin_shaft_pins", "pin_shaft_load", 8),
        ):
            values = at[load].values
            loaded = [[value > 0.001 * values.max() for value in row] for row in values]
            expected[key] = sum(map(sum, loaded)) / 5
            if key == "mean_loaded_pin_shaft_pins":
                fractions = [sum(row[k] for row in loaded) / 5 for k in range(count)]
                expected["pin_shaft_loaded_range_deg"] = 360.0 * sum(fractions) / count
        for key, value in expected.items():
            assert summary[key] == pytest.approx(value, rel=1e-12), key
        # the residual of both torques counts
        assert summary["max_equilibrium_residual_N"] >= at["equilibrium_residual"].values.max()


def test_light_torque_is_that_of_the_drive(vary):
    from ltca.compliance.half_space import HalfSpaceCompliance
    from ltca.equilibrium.balance import solve_equilibrium
    from ltca.equilibrium.reducer import Reducer

    drive = vary(load={"light_torque": 20_000.0})
    analysis = analyse(drive, ANGLES)
    alone = solve_equilibrium(Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), ANGLES, -20_000.0)
    np.testing.assert_allclose(analysis.light.pose[:, WHEEL_ANGLE], alone.pose[:, WHEEL_ANGLE], atol=1e-11)


def test_cases_of_different_shape_are_refused(vary):
    other = vary(pin_shaft={"number_of_pins": 6})
    with error_says(
        DriveError,
        "rollers, 6 shaft pins, 1 disc, 1 crank: must be 14 wheel pins, 11 rollers, 8 shaft pins, 1 disc, 1 crank as",
    ):
        check_common_shape({"A": vary(), "B": other})
    check_common_shape({"A": vary(), "C": vary()})
