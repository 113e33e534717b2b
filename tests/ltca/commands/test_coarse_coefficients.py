"""Files of coefficients that state to be coarser than asked for were read without a word."""

import pytest

from ltca.commands.program import main
from ltca.compliance.coefficient_files import write_coefficients
from ltca.compliance.coefficients import load_coefficients
from ltca.reading.coefficient_file import quality_warning
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients

PAPER = load_drive("paper").cases["CS-1"]


def coefficients(tilt_depth=None, **stated):
    """Bodies in closed form that state some accuracy of their own."""
    return closed_form_coefficients(PAPER, half_width=0.05, depth=300.0, tilt_depth=tilt_depth).assign_attrs(stated)


@pytest.mark.parametrize(
    ("depth", "stated", "figure", "command"),
    [
        (None, {"convergence_estimate": 0.0121, "mesh_size": "1: edges"}, "0.0121: must be at most 0.012", "--size 0.5"),
        (260.0, {"convergence_estimate": 0.0121, "mesh_size": "1.5: edges"}, "0.0121", "--bodies solid --size 0.75"),
        (260.0, {"interpolation_error_tilt": 0.02}, "0.02: must be at most 0.012", "--bodies solid --stations 2"),
        (None, {"convergence_stress": 0.31}, "0.31: must be at most 0.3", "cyclo derive DRIVE)"),
    ],
)  # fmt: skip
def test_a_coarse_file_is_told_by_figure_bound_and_command(depth, stated, figure, command):
    told = quality_warning(coefficients(depth, **stated), "some.nc")
    assert told.startswith("some.nc: ")
    assert figure in told
    assert command in told
    assert "\n" not in told


def test_a_file_within_its_bounds_is_not_spoken_of():
    """Bounds themselves are kept: 0.012 is at most 0.012."""
    assert quality_warning(coefficients(convergence_estimate=0.012, mesh_size="1: edges"), "some.nc") == ""


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(("depth", "bodies"), [(None, "plane"), (260.0, "solid")])
def test_commands_warn_of_coarse_files(tmp_path, capsys, depth, bodies, positions_alone):
    """`run` among its warnings, `curves` before the work, each once; the file is read all the same."""
    file = tmp_path / "coarse.nc"
    write_coefficients(coefficients(depth, convergence_estimate=0.05, mesh_size="2: edges"), file)
    assert "is 0.05" in load_coefficients(file, PAPER).warning
    words = ["paper", "--case", "CS-1", "--compliance", "hybrid", "--bodies", bodies, "--coefficients", str(file)]
    more = ["--no-page", "--out", str(tmp_path / "out")]
    assert main(["run", *words, "--angles", "0.5", *more]) == 0
    told = capsys.readouterr()
    assert (told.out + told.err).count(f"warning: {file}: convergence") == 1
    assert "--size 1)" in told.out
