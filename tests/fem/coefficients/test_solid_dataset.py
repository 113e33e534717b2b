"""Variables of a file of solid bodies: those of plane strain with the differences of the same loads and patches."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from fem.coefficients import solid_dataset
from fem.coefficients.solid_dataset import _joined, _Solid, with_solid_bodies
from fem.mesh.boundary_division import MAX_TURN
from ltca.reading.drive_file import load_drive

STATIONS, LAGS = 3, 4


def plane():
    """Coefficients of plane strain; any numbers will do."""
    random = np.random.default_rng(3)
    shapes = {
        "disc_approach": ("station", "loaded"), "wide_approach": ("wide",), "pin_approach": (), "pin_wide_approach": (),
        "roller_approach": ("side", "loaded_side"), "roller_wide_approach": (), "race_approach": ("lag",),
        "race_wide_approach": (), "disc_resultant": ("motion", "station"), "disc_stress": ("stress_station", "loaded"),
        "station_boundary": ("station",), "stress_station_boundary": ("stress_station",),
    }  # fmt: skip
    sizes = {
        "station": STATIONS, "loaded": STATIONS, "wide": 2, "side": 2, "loaded_side": 2, "lag": LAGS, "motion": 3,
        "stress_station": STATIONS,
    }  # fmt: skip
    return xr.Dataset(
        {
            name: (dims, random.uniform(1.0, 2.0, [sizes[dim] for dim in dims]), {"long_name": name})
            for name, dims in shapes.items()
        }
    )


def beyond(measures, loads):
    """Nothing beyond plane strain but of the last patch, the wide one, under the last load, its own."""
    even, linear = np.zeros((measures, loads)), np.zeros((measures, loads))
    even[measures - 1, loads - 1], linear[measures - 1, loads - 1] = 7.0, 5.0
    return SimpleNamespace(even=even, linear=linear)


def test_wide_patches_are_seen_under_their_own_load(monkeypatch):
    """Beside plane strain by the length of the body, and for linear loads 12/t² of it."""
    monkeypatch.setattr(solid_dataset, "continue_under_patches", lambda values, *_: values)
    drive = load_drive("paper").cases["CS-1"].with_fields({"crank_bearing.roller_length": 9.0})
    each, wide = np.zeros((STATIONS, STATIONS)), np.zeros(2)
    disc = SimpleNamespace(even=each, linear=each, wide_even=wide, wide_linear=wide, strain=each)
    solid = _Solid(disc=disc, pin=beyond(2, 2), roller=beyond(3, 3), race=beyond(LAGS + 1, 2))
    given = plane()
    found = _joined(given, drive, solid, 2)
    for body, length in (("pin", 11.8), ("roller", 9.0), ("race", 11.8)):
        strain = float(given[f"{body}_wide_approach"]) * drive.disc.thickness / length
        assert float(found[f"{body}_wide_approach"]) == pytest.approx(strain + 7.0, rel=1e-12)
        tilt = 12.0 / length**2 * strain
        assert float(found[f"{body}_wide_tilt_approach"]) == pytest.approx(tilt + 5.0, rel=1e-12)
        np.testing.assert_allclose(
            found[f"{body}_approach"], given[f"{body}_approach"] * drive.disc.thickness / length, rtol=1e-12
        )


def test_the_coarser_solution_has_twice_the_edges_and_a_layer_less(monkeypatch):
    """Whatever size is asked: its difference is the convergence estimate of the file."""
    meshes = []

    def derive(drive, shapes, places, mesh, options, note):
        meshes.append((mesh.size, mesh.turn, options.layers))
        if len(meshes) == 2:
            raise InterruptedError

    monkeypatch.setattr(solid_dataset, "_derive", derive)
    drive = load_drive("paper").cases["CS-1"]
    given = SimpleNamespace(attrs={"code_hash": "0"})
    with pytest.raises(InterruptedError):
        with_solid_bodies(
            given, drive, None, SimpleNamespace(count=9), size=3.0, layers=4, tell=print, store=lambda _: None
        )
    assert meshes == [(6.0, 2.0 * MAX_TURN, 3), (3.0, MAX_TURN, 4)]
