"""``cyclo mesh``: files, picture, messages."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from fem.commands import mesh
from fem.mesh.mesh_file import read_msh
from fem.pictures import mesh_picture, offscreen
from ltca.errors import CycloError


def run(*words: str) -> int:
    parser = argparse.ArgumentParser()
    mesh.configure(parser)
    return mesh.execute(parser.parse_args(words))


def image_detail(path: Path) -> list[float]:
    """Return how strongly the grey level varies in the five windows of the picture."""
    grey = matplotlib.image.imread(path)[..., :3].mean(axis=-1)
    height, width = grey.shape
    half, quarter, middle = width // 2, 3 * width // 4, height // 2
    windows = [grey[:, :half]]
    windows += [
        grey[rows, columns]
        for rows in (slice(0, middle), slice(middle, height))
        for columns in (slice(half, quarter), slice(quarter, width))
    ]
    return [float(np.std(window)) for window in windows]


@pytest.mark.slow
def test_writes_all_files_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_picture, "PIXELS_PER_INCH", 60.0)
    assert run("paper", "--case", "CS-3", "--angle", "0.5", "--size", "6", "--out", str(tmp_path / "out")) == 0
    names = ["disc", "inner_race", *(f"pin_{i}" for i in range(14)), *(f"roller_{n}" for n in range(11))]
    expected = {f"{name}{suffix}" for name in names for suffix in (".msh", ".vtu")} | {
        "mesh.png",
        "cyclo-manifest.json",
    }
    assert {path.name for path in (tmp_path / "out").iterdir()} == expected
    output = capsys.readouterr().out
    assert "disc: " in output
    assert "smallest angle" in output
    disc = read_msh(tmp_path / "out" / "disc.msh", required_boundaries=("flank", "bore", "hole_7"))
    assert disc.order == 2
    # Blank windows have no variation at all; meshes measured 0.1 to 0.3.
    assert min(image_detail(tmp_path / "out" / "mesh.png")) > 0.03


@pytest.mark.nightly
@pytest.mark.slow
def test_falls_back_to_matplotlib_with_a_message(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_picture, "PIXELS_PER_INCH", 60.0)
    offscreen.rendering_problem.cache_clear()
    # The probe ends as VTK does without GL libraries.
    monkeypatch.setattr(offscreen, "_PROBE", "import os; os.kill(os.getpid(), 11)")
    try:
        assert run("paper", "--size", "6", "--order", "1", "--out", str(tmp_path)) == 0
    finally:
        offscreen.rendering_problem.cache_clear()
    assert "drawn with matplotlib, because pyvista cannot render here: the trial rendering was ended by signal 11" in (
        capsys.readouterr().out
    )
    assert min(image_detail(tmp_path / "mesh.png")) > 0.03
    assert read_msh(tmp_path / "disc.msh").order == 1


@pytest.mark.nightly
@pytest.mark.slow
def test_size_halves_the_elements(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh, "_draw", lambda *_: None)
    for size in ("4", "2"):
        run("paper", "--size", size, "--out", str(tmp_path / size))

    def smallest_edge(folder: str) -> float:
        body = read_msh(tmp_path / folder / "disc.msh")
        ends = body.mesh.p[:, body.mesh.facets]
        return float(np.sort(np.hypot(*(ends[:, 0] - ends[:, 1])))[:50].mean())

    # Single edges scatter about the size; the mean of fifty smallest follows it to about 10 %.
    assert smallest_edge("4") / smallest_edge("2") == pytest.approx(2.0, rel=0.15)


def test_the_probe_tells_how_the_rendering_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    for code, reason in (
        ("import os; os.kill(os.getpid(), 11)", "ended by signal 11 (GL libraries missing?)"),
        ("raise RuntimeError('no screen')", "failed: RuntimeError: no screen"),
        ("print('rendered')", ""),
    ):
        offscreen.rendering_problem.cache_clear()
        monkeypatch.setattr(offscreen, "_PROBE", code)
        problem = offscreen.rendering_problem()
        assert problem.endswith(reason)
        assert bool(problem) == bool(reason)
    offscreen.rendering_problem.cache_clear()


def test_out_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("x")
    with pytest.raises(CycloError, match="is a file, not a folder"):
        run("paper", "--out", str(tmp_path / "out"))


def test_the_command_module_is_light() -> None:
    code = (
        "import sys, fem.commands.mesh\n"
        "heavy = {'gmsh', 'skfem', 'numpy', 'scipy', 'pyvista', 'meshio', 'pydantic'} & set(sys.modules)\n"
        "sys.exit(', '.join(sorted(heavy)) or 0)\n"
    )
    child = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, env=dict(os.environ)
    )
    assert child.returncode == 0, child.stderr
