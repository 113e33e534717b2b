"""``cyclo fem``: files, keys, pictures, and one clear message for each mistake."""

import argparse
import json

import numpy as np
import pytest
import xarray as xr

from fem.commands import fem as command
from fem.pictures import solution_pictures
from fem.reducer import solution
from fem.reducer.solution_files import ARRAYS
from ltca.errors import CycloError
from ltca.output.labelled import LabelledDataset
from ltca.quantities import QUANTITIES
from ltca.reading.changes import with_fields

SCALARS = (
    "wheel_angle_rad", "bearing_radial_N", "bearing_tangential_N", "equilibrium_residual_N", "pose_iterations", "dof", "seconds",
)  # fmt: skip


def run(*words):
    parser = argparse.ArgumentParser()
    command.configure(parser)
    return command.execute(parser.parse_args(words))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folder of a coarse solution, and the solution."""
    out, solve, solutions = tmp_path_factory.mktemp("fem"), solution.solve_reducer, []
    words = ("paper", "--case", "CS-3", "--angle", "0.5", "--size", "6", "--out", str(out), "--export", "calculix")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            solution, "solve_reducer", lambda *given, **more: solutions.append(solve(*given, **more)) or solutions[-1]
        )
        assert run(*words) == 0
    return out, solutions[0]


@pytest.fixture(scope="module")
def folder(made):
    return made[0]


@pytest.mark.slow
def test_summary_has_the_agreed_keys(folder):
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert "cases" not in summary
    for name in SCALARS:
        assert isinstance(summary[name], int | float), name
    for name in ("disc_displacement", "disc_displacement_area"):
        assert set(summary[name]) == {"x_mm", "y_mm", "rotation_rad"}
    assert summary["bearing_tangential_N"] == pytest.approx(6737.5, rel=2e-3)


@pytest.mark.slow
def test_dataset_agrees_with_the_summary(folder):
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    with xr.open_dataset(folder / "fem.nc", engine="h5netcdf") as data:
        for quantity in (QUANTITIES[name] for name in ARRAYS):
            parts = data[quantity.name].values.reshape(1, -1)  # by disc, then by part
            for key in (quantity.fem_key, quantity.older_fem_key):
                np.testing.assert_array_equal(parts, summary[key], err_msg=key)
        assert data["pin_load"].size == 14
        assert data["wheel_angle"].item() == summary["wheel_angle_rad"]
        assert data["case"].values.tolist() == ["CS-3"]
        assert data["pressure"].max() > 100.0


@pytest.mark.slow
def test_dataset_has_the_dimensions_and_names_of_a_run(folder, paper_cases):
    """What ``results.nc`` has, too, has the same name, dimensions, unit and place in ``fem.nc``."""
    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.results import build_dataset

    drive = paper_cases["CS-3"]
    run = build_dataset("paper", {"CS-3": analyse(drive, np.array([0.5]))})
    with xr.open_dataset(folder / "fem.nc", engine="h5netcdf") as data:
        shared = set(run.data_vars) & set(data.data_vars)
        assert shared >= {
            "pin_load", "roller_load", "roller_load_inner", "pin_shaft_load", "wheel_angle", "disc_rotation",
            "bearing_radial", "bearing_tangential", "equilibrium_residual", "pin_half_width",
        }  # fmt: skip
        for name in shared:
            assert data[name].shape == run[name].shape, name
        for name in set(run.coords) - {"light_torque"}:
            assert data[name].dims == run[name].dims, name
            if name != "case":
                np.testing.assert_allclose(data[name], run[name], rtol=1e-12, err_msg=name)
        for name in ("Conventions", "source", "version", "drive", "drive_file"):
            assert data.attrs[name] == run.attrs[name], name
        assert data.attrs["code_hash"] != run.attrs["code_hash"]  # that of fem is in it
        for name, variable in data.variables.items():
            assert "units" in variable.attrs or name in data.dims, name


@pytest.mark.slow
def test_one_file_opens_all_bodies(folder):
    import pyvista

    bodies = pyvista.read(folder / "fem.vtm")
    assert isinstance(bodies, pyvista.MultiBlock)
    names = ["disc", *(f"pin_{k}" for k in range(14)), *(f"roller_{k}" for k in range(11)), "inner_race"]
    assert list(bodies.keys()) == names
    for name in names:
        assert bodies[name].n_cells > 100, name
        assert "von_mises_MPa" in bodies[name].point_data
    # Bodies stand where they are: the race on the eccentricity; the middle of a box about coarse nodes is off by their sag.
    assert abs(complex(*bodies["inner_race"].center[:2]) - 4.0 * np.exp(0.5j)) < 0.02
    assert bodies["disc"].length > 100.0


@pytest.mark.slow
def test_a_run_cut_short_leaves_no_index_over_two_solutions(folder, tmp_path, monkeypatch):
    import shutil

    from fem.reducer import solution_files

    out = shutil.copytree(folder, tmp_path / "out")

    def fail(field, path):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(solution_files, "label_solution", lambda *words: LabelledDataset({}, (), {}))
    monkeypatch.setattr(solution_files, "recover_disc_stress", lambda solution: None)
    monkeypatch.setattr(solution_files, "write_field", fail)
    field = type("Field", (), {"body": type("Body", (), {"name": "disc"})})
    with pytest.raises(OSError, match="No space left"):
        solution_files.write_solution(type("Solution", (), {"discs": (None,), "solid": False}), [[field]], "CS-3", out)
    assert not (out / "fem.vtm").exists()


@pytest.mark.slow
def test_fields_and_deck_are_there(folder):
    import meshio

    disc = meshio.read(folder / "disc.vtu")
    assert {"displacement_mm", "von_mises_MPa", "principal_MPa", "maximum_shear_MPa"} <= set(disc.point_data)
    zz = disc.point_data["stress_zz_MPa"]
    np.testing.assert_allclose(
        zz, 0.3 * (disc.point_data["stress_xx_MPa"] + disc.point_data["stress_yy_MPa"]), atol=1e-9 * np.abs(zz).max()
    )
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]
    assert not list(folder.glob("*.png"))  # pictures wait for --pictures
    assert (folder / "calculix.inp").read_text(encoding="ascii").count("*CONTACT PAIR") >= 10


@pytest.mark.slow
def test_pictures(made, tmp_path, monkeypatch):
    monkeypatch.setattr(solution, "solve_reducer", lambda *given, **more: made[1])
    monkeypatch.setattr(solution_pictures, "ZOOM_SIDE", 400)
    monkeypatch.setitem(solution_pictures.draw_solution.__kwdefaults__, "side", 500)
    assert run("paper", "--case", "CS-3", "--angle", "0.5", "--size", "6", "--out", str(tmp_path), "--pictures") == 0
    for name in ("von_mises.png", "contacts.png", "deformed.png"):
        assert (tmp_path / name).stat().st_size > 20_000
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    # The drive twice, and the most loaded contact of the flank, of the holes and of the rollers
    assert page.count('<svg class="stress"') == page.count("data:image/webp;base64,") == 5
    assert len(page) < 2_500_000


@pytest.mark.slow
def test_pictures_without_gl(monkeypatch, tmp_path):
    """matplotlib draws the same scenes where pyvista must not be tried."""
    from fem.pictures.offscreen import rendering_problem
    from fem.pictures.scene import Lines, Panel, Triangles, render

    monkeypatch.setenv("CYCLO_NO_PYVISTA", "1")
    rendering_problem.cache_clear()
    corners = np.array([0.0, 1.0, 1j, 1.0 + 1j])
    patch = Triangles(points=corners, faces=np.array([[0, 1, 2], [1, 3, 2]]), values=np.arange(4.0))
    lines = Lines(points=corners[None, [0, 1, 3]])
    panel = Panel(title="square", centre=0.5 + 0.5j, half_side=1.0, triangles=(patch,), lines=(lines,), label="value")
    assert "CYCLO_NO_PYVISTA" in render(tmp_path / "square.png", [panel, panel], side=300)
    assert (tmp_path / "square.png").stat().st_size > 2_000
    rendering_problem.cache_clear()


def test_file_in_place_of_the_folder(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(CycloError, match="is a file, not a folder"):
        run("paper", "--out", str(tmp_path / "taken"))


def test_missing_referee_is_said_before_any_work(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CycloError, match="ccx is not installed"):
        run("paper", "--referee", "calculix", "--out", str(tmp_path / "out"))


@pytest.mark.parametrize(("model", "told"), [(None, False), ("fe", False), ("beam", True)])
def test_a_ring_that_analyses_have_as_a_beam_is_told(paper_cases, model, told):
    ring = {"inner_radius": 88.5, "outer_radius": 106.0, "width": 20.0, "model": model}
    drive = paper_cases["CS-1"] if model is None else with_fields(paper_cases["CS-1"], {"ring": ring})
    assert ("as a beam" in command.ring_words(drive)) is told
