"""The program: exit status, messages, files whole or not at all, what it imports."""

from __future__ import annotations

import errno
import io
import json
import os
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from ltca.commands import program
from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.output.run_folder import MANIFEST
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

ROOT = Path(__file__).parents[3]


def python(code):
    """Run code in a fresh interpreter on this tree and return the last line it prints; nothing may go to stderr."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False, timeout=600,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout.strip().splitlines()[-1]


RUN = ["run", "paper", "--case", "CS-3", "--case", "CS-1", "--angles", "0.1", "-1.3", "4.0"]


def test_run_writes_results_and_summary(tmp_path):
    assert main([*RUN, "--no-figures", "--out", str(tmp_path)]) == 0
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as data:
        # to the last bit, whatever the order
        assert data["crank_angle"].values.tolist() == [0.1, -1.3, 4.0]
        assert list(data["case"].values) == ["CS-3", "CS-1"]
        assert data.indexes["position"].dtype.kind == "i"
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["drive"] == "paper"
    assert list(summary["cases"]) == ["CS-3", "CS-1"]
    assert summary["cases"]["CS-1"]["mean_tangential_bearing_load_N"] == pytest.approx(6737.5, rel=5e-3)
    assert {path.name for path in tmp_path.iterdir()} == {"results.nc", "summary.json", "report.html", MANIFEST}
    assert "report.html" in json.loads((tmp_path / MANIFEST).read_text())["files"]


@pytest.mark.slow
def test_no_page_leaves_the_page_out(tmp_path, capsys):
    words = ["run", "paper", "--case", "CS-1", "--angles", "0.1", "--no-figures", "--no-page", "--out", str(tmp_path)]
    assert main(words) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"results.nc", "summary.json", MANIFEST}
    capsys.readouterr()
    assert main([*words, "--compare", str(tmp_path)]) == 2
    assert "--compare: has no effect with --no-page" in capsys.readouterr().err


START = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "suffix"),
    [([], ".svg"), *(pytest.param([name], f".{name}", marks=pytest.mark.nightly) for name in ("png", "pdf"))],
)
def test_figures_of_the_paper_when_asked_for(words, suffix, tmp_path):
    """They were drawn twice, as SVG and PNG, by every run: two thirds of its time."""
    assert main([*RUN, "--out", str(tmp_path), "--figures", *words]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        "results.nc",
        "summary.json",
        "report.html",
        "figures",
        MANIFEST,
    }
    files = list((tmp_path / "figures").iterdir())
    assert {path.suffix for path in files} == {suffix}
    assert {int(path.stem[3:5]) for path in files} == {23, 24, 25, 26, 28, 29, 30, 34, 35, 36}  # issue 2
    for path in files:
        assert path.read_bytes().startswith(START[suffix])
        if suffix == ".svg":
            svg = path.read_text()
            assert svg.rstrip().endswith("</svg>")  # whole
            for case in ("CS-1", "CS-3"):  # direct labels, as text
                assert case in svg, path
    if suffix != ".svg":
        return
    for stem, unit in (("fig23_transmission_error", "″"), ("fig24_pin_load", "[N]"), ("fig26_pin_pressure", "[MPa]")):
        assert unit in (tmp_path / "figures" / f"{stem}.svg").read_text()


@pytest.mark.slow
def test_first_screen_is_verdict_table_files(tmp_path, capsys):
    """Six verdict tables, 133 lines, stood before the numbers: now a line a case, and no figures unless asked for."""
    assert main(["run", "paper", "--positions", "28", "--no-page", "--out", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) < 50
    assert lines[0].startswith("paper: 377.3 N·m ccw, ")
    for number, line in enumerate(lines[2:8], 1):
        assert re.fullmatch(rf"  CS-{number}  (pass|FAIL)  \S.* \([≤≥] .*\).*", line)
        assert len(line) <= 80
    assert lines[8].startswith("  half-spaces: about 30 … 34 % too stiff here")
    assert lines[11].split() == [f"CS-{number}" for number in range(1, 7)]
    assert lines[-1].startswith("results: ")
    assert not (tmp_path / "figures").exists()


@pytest.mark.parametrize("words", [[], ["--debug"]])
def test_bare_cyclo_ended_in_command_required(words, capsys):
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("usage: cyclo ")
    assert "judge a design" in err
    assert "cyclo: error" not in err


def test_check_did_not_say_which_engine_it_judged_by(tmp_path, capsys):
    words = ["check", "paper", "--case", "CS-1", "--positions", "2", "--quick", "--no-advice", "--no-page"]
    main([*words, "--out", str(tmp_path)])
    first = capsys.readouterr().out.splitlines()[0]
    assert first == "paper CS-1, 377.3 N·m ccw: judged by half-space (tables), 2 positions"


def test_figures_and_none_contradict_each_other(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main([*RUN, "--figures", "--no-figures", "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert "not allowed with argument" in capsys.readouterr().err


@pytest.mark.slow
def test_torque_with_a_unit_is_that_torque(tmp_path):
    for name, torque in (("a", "188.65 N m"), ("b", "188650")):
        arguments = [
            "run",
            "paper",
            "--case",
            "CS-1",
            "--positions",
            "3",
            "--torque",
            torque,
            "--no-page",
            "--no-figures",
        ]
        assert main([*arguments, "--out", str(tmp_path / name)]) == 0
    first, second = ((tmp_path / name / "results.nc") for name in "ab")
    with xr.open_dataset(first, engine="h5netcdf") as a, xr.open_dataset(second, engine="h5netcdf") as b:
        np.testing.assert_array_equal(a["pin_load"], b["pin_load"])
        np.testing.assert_array_equal(a["crank_angle"], [2.0 * np.pi * k / 3 for k in range(3)])
        # half the torque, about half the mean load: the sum of F times its lever is the torque
        assert float(a["torque"].item()) == 188_650.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nowhere.toml"], "no such file"),
        (["run", "paper", "--case", "CS-9"], "case 'CS-9' is not defined"),
        (["run", "paper", "--positions", "0"], "--positions = 0: must be from 1 to 1000000"),
        (["run", "paper", "--angles", "1.0", "x"], "--angles = 'x'"),
        (["run", "paper", "--angles", "nan"], "--angles = 'nan': must be finite"),
        (["run", "paper", "--torque", "-5"], "--torque = -5: must be at least 0 N·mm"),
        (["run", "paper", "--torque", "3 mm"], "must have the unit N·mm"),
        (["run", "paper", "--torque", "1e8", "--positions", "3"], "cannot be carried"),
        (["show", "paper", "--angle", "one"], "--angle = 'one'"),
        (["show", "paper", "--case", "CS-9"], "is not defined"),
    ],
)
def test_wrong_input_is_exit_status_2_one_message_and_no_file(arguments, message, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("cyclo: error: ")
    assert message in told.err
    assert "Traceback" not in told.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["run"], ["fly"], ["run", "paper", "--positions", "3", "--angles", "1"]])
def test_wrong_usage_is_exit_status_2(arguments, capsys):
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    told = capsys.readouterr().err
    assert told.startswith("cyclo: error: ")
    assert told.count("\n") == 1
    assert "--help' shows the usage" in told


def test_wrong_drive_is_told_whole(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = shipped_drive().replace("eccentricity = 4.0", "eccentricity = -4.0").replace("thickness = 11.8", "thick = 1")
    Path("bad.toml").write_text(text, encoding="utf-8")
    assert main(["run", "bad.toml"]) == 2
    told = capsys.readouterr().err
    for part in ("2 mistakes", "crank.eccentricity = -4.0", "disc.thick: ", "`thickness`, which is missing"):
        assert part in told
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


def test_output_that_cannot_be_written(tmp_path, capsys):
    (tmp_path / "out").write_text("a file where the folder should be")
    assert main(["run", "paper", "--positions", "2", "--case", "CS-1", "--out", str(tmp_path / "out")]) == 2
    assert "is a file, not a folder" in capsys.readouterr().err


@pytest.mark.slow
def test_init_writes_a_runnable_commented_copy(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["init", "my.toml"]) == 0
    text = Path("my.toml").read_text(encoding="utf-8")
    assert text.count("#") > 20
    file = load_drive("my.toml")
    assert file.name == "my"
    assert list(file.cases) == list(load_drive("paper").cases)
    assert main(["run", "my.toml", "--positions", "2", "--no-figures"]) == 0
    assert Path("out/my/summary.json").exists()
    capsys.readouterr()
    assert main(["init", "my.toml"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main(["init", "my.toml", "--force"]) == 0


LIKE = ("paper", "robot-joint", "rv", "sleeved")


@pytest.mark.parametrize("like", LIKE)
def test_a_template_is_the_shipped_drive(like, tmp_path):
    """`cyclo init --like robot-joint` had beams for springs: unchanged it failed the check that the shipped drive passes."""
    path = tmp_path / "my.toml"
    assert main(["init", str(path), "--like", like]) == 0
    text, shipped = path.read_text(encoding="utf-8"), shipped_drive(like)
    changed = [pair for pair in zip(text.splitlines(), shipped.splitlines(), strict=True) if pair[0] != pair[1]]
    assert changed == [('name = "my"', f'name = "{like}"')]
    mine, theirs = load_drive(path), load_drive(like)
    assert {name: replace(drive, name=like) for name, drive in mine.cases.items()} == theirs.cases
    assert (mine.tolerances, mine.limits) == (theirs.tolerances, theirs.limits)


@pytest.mark.slow
@pytest.mark.parametrize(
    "like", ["robot-joint", *(pytest.param(like, marks=pytest.mark.nightly) for like in LIKE if like != "robot-joint")]
)
def test_a_template_has_the_numbers_of_the_shipped_drive(like, tmp_path, monkeypatch):
    """On half-spaces, at 2 positions: every number of the summary to the last bit."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", "my.toml", "--like", like]) == 0
    for drive in ("my.toml", like):
        words = ["run", drive, "--compliance", "half-space", "--positions", "2", "--no-page", "--case"]
        assert main([*words, next(iter(load_drive(drive).cases))]) == 0
    mine, theirs = (
        json.loads((tmp_path / "out" / name / "summary.json").read_text(encoding="utf-8")) for name in ("my", like)
    )
    assert mine.pop("drive") == "my"
    assert theirs.pop("drive") == like
    assert mine == theirs


# These two files state lengths that would follow thickness and number where they are left out.
STATED = {"paper": ("crank_bearing.roller_length",), "sleeved": ("pin_wheel.beam.span", "pin_shaft.beam.span")}


def problems_of(text):
    """What is wrong with a drive file."""
    try:
        parse_drive(text)
    except DriveError as error:
        return error.problems
    return []


@pytest.mark.parametrize("like", LIKE)
@pytest.mark.parametrize(("thickness", "discs"), [(8, 1), (10, 2), (14, 3)])
def test_a_template_holds_back_no_change_of_thickness_or_number(like, thickness, discs, tmp_path):
    """Phases, planes, rollers and pins of robot-joint refused a thickness or a third disc that the reader changed alone.

    Where a file states a length that is in the way the message says that it may be left out, and then it follows.
    """
    path = tmp_path / "my.toml"
    assert main(["init", str(path), "--like", like]) == 0
    text = path.read_text(encoding="utf-8")
    changed = re.sub(r"(?m)^thickness = [0-9.]+", f"thickness = {thickness}", text)
    changed = re.sub(r"(?m)^number_of_discs = [0-9]", f"number_of_discs = {discs}", changed)
    problems = problems_of(changed)
    assert {problem.partition(" = ")[0] for problem in problems} <= {*STATED.get(like, ())}
    assert all("left out, it is as long as" in problem or "when left out" in problem for problem in problems)
    changed = re.sub(r"(?m)^roller_length = .*\n|span = [0-9.]+, ", "", changed)
    drive = next(iter(parse_drive(changed).cases.values()))
    assert len(drive.disc.disc_planes) == len(drive.disc.disc_phases) == discs
    assert drive.roller_length == thickness


@pytest.mark.parametrize("like", ["paper", "robot-joint"])
def test_a_template_of_springs_names_the_beam(like, tmp_path):
    path = tmp_path / "my.toml"
    assert main(["init", str(path), "--like", like]) == 0
    text = path.read_text(encoding="utf-8")
    told = re.search(r"(?m)^# .*?(beam = \{ tip = \"tied-clamped\" \})", text)[1]
    drive = next(iter(parse_drive(re.sub(r"(?m)^stiffness = .*$", told, text)).cases.values()))
    assert drive.pin_shaft.stiffness is None
    assert drive.pin_shaft.beam.tip == "tied-clamped"
    assert drive.shaft_pin_span == drive.disc.stack_length


def test_init_with_a_name_that_toml_must_escape(tmp_path):
    path = tmp_path / 'my "best" drive.toml'
    assert main(["init", str(path)]) == 0
    assert load_drive(path).name == 'my "best" drive'


@pytest.mark.skipif(os.name == "nt", reason="words are in the quotes of another shell")
@pytest.mark.parametrize("name", ["my.toml", "my drive ö.toml", "it's mine.toml", "$HOME.toml"])
def test_the_commands_that_init_names_could_not_be_pasted(name, tmp_path, monkeypatch, capsys):
    """`'cyclo show 'my drive ö.toml''` had quotes in quotes."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", name]) == 0
    commands = [shlex.split(line) for line in capsys.readouterr().out.splitlines() if line.startswith("  cyclo ")]
    assert commands == [["cyclo", "show", name], ["cyclo", "run", name]]
    with pytest.raises(DriveError) as caught:
        load_drive(f"other {name}")
    assert f"cyclo init {shlex.quote(f'other {name}')})" in str(caught.value)


@pytest.mark.slow
def test_show_prints_the_derived_geometry_and_draws(tmp_path, capsys):
    assert main(["show", "paper", "--angle", "-0.4", "--case", "CS-2", "--out", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    for part in ("reduction ratio", "backlash at the disc, wheel held", "10.69′", "6737.5 N", "at φ_C = -0.4 rad"):
        assert part in told
    pictures = [path for path in tmp_path.iterdir() if path.name != MANIFEST]
    assert [path.suffix for path in pictures] == [".png"]
    assert pictures[0].read_bytes().startswith(b"\x89PNG")


def test_version(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["--version"])
    assert stopped.value.code == 0
    assert capsys.readouterr().out.startswith("cyclo 0.")


@pytest.mark.slow
def test_run_in_a_pipe_is_silent_and_imports_no_finite_elements_and_no_system_libraries(tmp_path):
    code = f"""
import sys
from ltca.commands.program import main
assert main(["run", "paper", "--no-figures", "--positions", "2", "--case", "CS-1", "--out", {str(tmp_path)!r}]) == 0
heavy = {{"gmsh", "vtk", "vtkmodules", "pyvista", "skfem", "meshio", "validation", "matplotlib"}}
found = heavy & {{name.partition(".")[0] for name in sys.modules}}
# the packages' commands are listed by the parser, nothing else of them
found |= {{n for n in sys.modules if n.startswith("fem.") and not n.startswith("fem.commands")}}
print(sorted(found))
"""
    assert python(code) == "[]"


def test_help_imports_no_numpy():
    code = """
import sys
from ltca.commands.program import main
try:
    main(["--help"])
except SystemExit:
    pass
heavy = {"numpy", "scipy", "xarray", "pydantic", "matplotlib"}
print(sorted(heavy & {name.partition(".")[0] for name in sys.modules}))
"""
    assert python(code) == "[]"


REFUSED = (
    ["run", "paper", "--case", "CS-9"],
    ["run", "paper", "--contacts", "grids"],
    ["run", "paper", "--compliance", "fe", "--method", "direct"],
    ["run", "paper", "--compliance", "fe", "--coefficients", "none.nc"],
    ["run", "paper", "--out", "/dev/null"],
    ["curves", "paper", "--case", "CS-9"],
    ["curves", "paper", "--no-hole-near-field"],
    ["show", "paper", "--case", "CS-9"],
    ["tolerance", "paper", "--case", "CS-9"],
    ["tolerance", "none.toml"],
    ["tolerance", "paper", "--workers", "2", "--scheduler", "tcp://x:1"],
    ["sweep", "none.toml"],
    ["optimise", "paper", "--vary", "thickness", "--minimise", "max_pin_load", "--case", "CS-9"],
    ["mesh", "paper", "--case", "CS-9"],
    ["fem", "paper", "--case", "CS-9"],
    ["derive", "paper", "--case", "CS-9"],
    ["derive", "--check", "none.nc"],
    ["validate", "paper", "--case", "CS-9"],
)


@pytest.mark.slow
def test_arguments_and_drive_are_read_before_what_takes_seconds_to_import(tmp_path):
    """A wrong --case or --contacts was told after two seconds of imports."""
    code = (
        "import sys; from ltca.commands.program import main\n"
        f"for words in {REFUSED!r}:\n"
        "    assert main(words) == 2, words\n"
        "    late = {'scipy', 'xarray', 'matplotlib', 'skfem', 'gmsh', 'pyvista'} & set(sys.modules)\n"
        "    assert not late, (words, late)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("\n") == len(REFUSED)


@pytest.mark.family(quick=1)
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("words", [["--help"], ["--version"], pytest.param(["show", "paper"], marks=pytest.mark.slow)])
def test_an_output_that_takes_nothing_is_named(words, unbuffered, tmp_path):
    """`cyclo --help` ended with exit status 0, `cyclo run` spoke of 'a file'."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": unbuffered}
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "ltca.commands.program", *words], stdout=full, stderr=subprocess.PIPE, text=True,
            check=False, cwd=tmp_path, env=environment,
        )  # fmt: skip
    assert (done.returncode, done.stderr) == (1, "cyclo: error: standard output: No space left on device\n")


class _Gone(io.StringIO):
    """Standard output whose reader has gone."""

    def __init__(self, number):
        super().__init__()
        self.number = number

    def write(self, text):
        raise OSError(self.number, os.strerror(self.number))


@pytest.mark.parametrize(
    ("system", "number", "status"),
    [("posix", errno.EPIPE, 141), ("nt", errno.EPIPE, 141), ("nt", errno.EINVAL, 141), ("posix", errno.EINVAL, 1)],
)
def test_a_reader_that_has_gone_is_no_error(system, number, status, monkeypatch, capsys):
    """Windows says of `cyclo run | more`, left early, that an argument is invalid."""
    monkeypatch.setattr(program, "os", SimpleNamespace(**{**vars(os), "name": system}))
    monkeypatch.setattr(sys, "stdout", _Gone(number))
    assert program.main(["fields", "thickness"]) == status
    assert (capsys.readouterr().err == "") == (status == 141)
