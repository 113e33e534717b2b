"""Pressure fields: loads, saddle, relief, layout, pictures."""

from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.pressure_fields import LOAD_TOLERANCE, build_pressure_dataset, pin_fields, roller_fields
from ltca.commands.program import main
from ltca.drive.parts import LengthProfile
from ltca.figures.pressure_figures import draw_roller_pressure, even_cells
from ltca.geometry.flank import FlankProfile
from ltca.geometry.separation import circle_departure, flank_departure
from ltca.reading.drive_file import load_drive

CASES = load_drive("paper").cases
ANGLE = np.array([0.3])


@pytest.fixture(scope="module")
def fields():
    return build_pressure_dataset("paper", {name: analyse(CASES[name], ANGLE) for name in ("CS-1", "CS-3")}, cells=12)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("kind", ["pin", "roller"])
def test_pressure_sums_to_the_load(fields, kind):
    """Also where nothing touches; and the field carries what the contact carries, to which it is solved."""
    side = "_outer" if kind == "roller" else ""
    x, y = (np.diff(fields[f"{kind}_{along}_edge{side}"].values) for along in "xy")
    total = (fields[f"{kind}_pressure{side}"].values * x[..., :, None] * y[..., None, :]).sum(axis=(-2, -1))
    np.testing.assert_allclose(total, fields[f"{kind}_field_load{side}"].values, rtol=1e-12, atol=1e-9)
    contacts = analyse(CASES["CS-1"], ANGLE).full.response
    expected = contacts.pin_load if kind == "pin" else contacts.rollers.outer_load
    loaded = expected > 1e-3 * np.max(expected)  # others have no field
    np.testing.assert_allclose(total[0].reshape(expected.shape)[loaded], expected[loaded], rtol=1.1 * LOAD_TOLERANCE)


def test_subsurface_shear_of_a_line_contact(fields):
    """0.300 p0 at a depth of 0.786 b (Johnson, section 4.2); grid and finite length move it by a few per cent."""
    for kind, side in (("pin", ""), ("roller", "_outer"), ("roller", "_inner")):
        at = {
            name: fields[f"{kind}_{name}{side}"].values
            for name in ("field_load", "max_shear", "pressure_mid", "max_shear_depth", "half_width")
        }
        loaded = at["field_load"] > 100.0
        shear = at["max_shear"][loaded] / at["pressure_mid"][loaded]
        depth = at["max_shear_depth"][loaded] / at["half_width"][loaded]
        np.testing.assert_allclose(shear, 0.300, rtol=0.02)
        np.testing.assert_allclose(depth, 0.786, rtol=0.04)


@pytest.mark.parametrize(
    "case", [case if case in ("CS-1", "CS-6") else pytest.param(case, marks=pytest.mark.slow) for case in CASES]
)
def test_roller_pressure_is_a_saddle(case):
    """Both ends above the middle along the roller, the middle above the edges across it (Fig. 31)."""
    field = max(roller_fields(analyse(CASES[case], ANGLE), 0, "inner", cells=10).values(), key=lambda f: f.load)
    _, along = even_cells(field.y_edges, field.pressure[field.pressure.shape[0] // 2], 100)
    middle = along[50]
    assert along[0] > 1.5 * middle
    assert along[-1] > 1.5 * middle
    assert np.argmin(along[10:90]) in range(35, 45)
    assert field.largest > 1.5 * field.mid
    across = field.pressure[:, field.pressure.shape[1] // 2]
    assert across[across.size // 2] == pytest.approx(np.max(across), rel=1e-9)
    assert across[0] == 0.0


@pytest.mark.slow
def test_relief_removes_the_saddle():
    drive = CASES["CS-3"]
    bearing = replace(drive.crank_bearing, roller_profile=LengthProfile(logarithmic_factor=1.0))
    relieved = analyse(replace(drive, crank_bearing=bearing), ANGLE)
    for side in ("inner", "outer"):
        for field in roller_fields(relieved, 0, side, cells=12).values():
            _, along = even_cells(field.y_edges, field.pressure[field.pressure.shape[0] // 2], 100)
            assert np.max(along) < 1.02 * along[50]
            assert max(along[0], along[-1]) < 0.7 * along[50]


def test_true_separation_of_the_flank():
    """Its second order is the curvature of the flank; its points lie on the flank (Eq. 18–19)."""
    profile = FlankProfile.of_drive(CASES["CS-1"])
    for theta in (0.05, 0.11, 0.2):
        x = np.array([-0.02, -0.01, 0.01, 0.02])
        h = flank_departure(profile, theta, x)
        even = 0.5 * (h + h[::-1])
        curvature = float(profile.curvature(np.array(theta)))
        # The fourth order is what is left: (x/ρ)² with ρ of millimetres.
        np.testing.assert_allclose(even[2:], 0.5 * curvature * x[2:] ** 2, rtol=1e-3)
        normal = complex(profile.normal(np.array(theta)))
        points = complex(profile.flank(np.array(theta))) + (1j * x - h) * normal
        near = profile.nearest_point(points, np.full(4, theta)).parameter
        np.testing.assert_allclose(profile.distance(points, near), 0.0, atol=1e-12)


def test_circles_leave_their_tangent():
    x = np.array([0.0, 1.0, 3.0, 6.0])
    np.testing.assert_allclose(circle_departure(x, 5.0), [0.0, 5.0 - np.sqrt(24.0), 1.0, np.inf])
    np.testing.assert_allclose(circle_departure(x[:3], -5.0), [0.0, np.sqrt(24.0) - 5.0, -1.0])


@pytest.mark.slow
def test_fields_survive_their_file(fields, tmp_path):
    path = tmp_path / "pressure.nc"
    fields.to_netcdf(path, engine="h5netcdf")
    with xr.open_dataset(path, engine="h5netcdf") as read:
        xr.testing.assert_equal(read.load(), fields)
        assert read["roller_pressure_max_outer"].attrs["end_cell_mm"] == pytest.approx(0.118)
        assert read["pin_pressure"].dims == ("case", "disc", "position", "pin", "pin_cell_x", "pin_cell_y")
        rollers = ("case", "disc", "crank", "position", "roller", "roller_cell_x", "roller_cell_y")
        assert read["roller_pressure_inner"].dims == rollers


@pytest.mark.slow
def test_no_light_falls_on_the_colours_of_a_surface(fields):
    """Colours were shaded and told other pressures than their scale, whose ticks were 724, 1448, 2171."""
    figure = draw_roller_pressure(fields, "CS-3")
    surface, scale = figure.axes
    (drawn,) = surface.collections
    told = mpl.colormaps["viridis"](np.linspace(0.0, 1.0, 256))
    away = np.linalg.norm(drawn.get_facecolor()[:, None, :3] - told[None, :, :3], axis=2).min(axis=1)
    assert away.max() < 1e-6
    ticks = scale.get_yticks()
    assert np.all(ticks % 100.0 == 0.0)
    assert len(ticks) > 3


@pytest.mark.slow
def test_run_with_pressure(tmp_path):
    """The command writes fields and figures, with no need of GL."""
    command = [
        "run",
        "paper",
        "--case",
        "CS-3",
        "--positions",
        "20",
        "--pressure",
        "0.3",
        "--figures",
        "--out",
        str(tmp_path),
    ]
    assert main(command) == 0
    names = {path.name for path in (tmp_path / "figures").iterdir()}
    assert {"fig27_contact_zone.svg", "fig31_roller_pressure_CS-3.png", "fig32_roller_pressure_along.svg"} <= names
    assert not [name for name in names if ".part" in name]


def test_pin_fields_lie_within_the_disc():
    for field in pin_fields(analyse(CASES["CS-1"], ANGLE), 0, cells=8).values():
        assert field.y_edges[0] == pytest.approx(-5.9)
        assert field.y_edges[-1] == pytest.approx(5.9)
        assert np.all(field.pressure >= 0.0)
