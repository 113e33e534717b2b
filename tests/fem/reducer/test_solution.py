"""Several discs by finite elements: one wheel angle, the same parts at half a turn, the LTCA's answer, files by disc."""

from __future__ import annotations

import argparse
import json
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from fem.coefficients.dataset import derive_coefficients
from fem.commands import fem as command
from fem.drive.disc_stress import recover_disc_stress
from fem.options import SolutionOptions
from fem.pictures.drive_loads import draw_loads
from fem.reducer.solution import solve_reducer
from fem.reducer.solution_files import build_dataset, summarise
from fem.reducer.verdict import judge_solution
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset as results_dataset
from ltca.drive.deviations import OneDisc, Runout
from ltca.drive.members.limits import parse_limits
from ltca.drive.single_discs import single_discs
from ltca.reading.changes import with_fields
from ltca.reading.coefficient_file import write_coefficients
from ltca.reading.writing import drive_text

pytestmark = pytest.mark.slow

ANGLE = 0.5
KINDS = (
    ("pin_load", lambda contacts: contacts.pin_load),
    ("roller_load", lambda contacts: contacts.rollers.outer_load),
    ("pin_shaft_load", lambda contacts: contacts.hole_load),
)


@pytest.fixture(scope="module")
def uneven(paper_cases):
    """Two discs, the first with a flank 4 µm off its bore."""
    drive = paper_cases["CS-1"]
    of = (OneDisc(runout=Runout(amount=0.004, angle=0.5)), OneDisc())
    return replace(drive, disc=replace(drive.disc, number_of_discs=2, of=of))


@pytest.fixture(scope="module")
def solved(uneven):
    return solve_reducer(uneven, ANGLE, SolutionOptions(size=2.0))


def test_two_discs_at_one_wheel_angle(solved, uneven):
    angles = [disc.pose.wheel_angle for disc in solved.discs]
    assert np.ptp(angles) <= 1e-9
    assert solved.wheel_moment == pytest.approx(uneven.wheel_moment(), rel=1e-12)
    for disc in solved.discs:
        assert disc.contacts.equilibrium_residual < 1e-6 * disc.contacts.pin_load.max()
    # the runout makes the shares differ, by far more than the meshes do
    assert solved.torque_share[1] - solved.torque_share[0] > 0.01


def test_the_second_disc_takes_pins_and_rollers_of_the_first(solved):
    first, second = ({id(group) for group in disc.model.groups} for disc in solved.discs)
    assert first & second


def test_the_ltca_on_plane_strain_bodies_says_the_same(solved, uneven, tmp_path):
    """Loads within 0.5 % of the largest of a kind, wheel within 0.3″; 0.33 % and 0.07″ on these meshes and coefficients of as
    coarse ones. Both discs are one part, turned, so one file serves them."""
    path = tmp_path / "coefficients.nc"
    write_coefficients(derive_coefficients(single_discs(uneven)[0], stations=0.5, size=2.0), path)
    answer = analyse(uneven, np.array([ANGLE]), engine=PlaneStrain(coefficients=(path,)))
    for own, full in zip(answer.discs, solved.discs, strict=True):
        for name, load in KINDS:
            theirs = getattr(full.contacts, name)
            assert np.max(np.abs(load(own.full.response)[0] - theirs)) < 5e-3 * theirs.max(), name
    assert abs(np.degrees(answer.full.pose[0, -1] - solved.wheel_angle)) * 3600.0 < 0.3
    np.testing.assert_allclose(answer.torque_share[0], solved.torque_share, atol=1e-3)


def test_dataset_and_summary_are_by_disc(solved, uneven):
    data = build_dataset(solved, "nominal")
    run = results_dataset("two", {"nominal": analyse(uneven, np.array([ANGLE]))})
    for name in set(run.data_vars) & set(data.data_vars):
        assert data[name].dims == run[name].dims, name
        assert data[name].shape == run[name].shape, name
    for name in set(run.coords) - {"light_torque", "case"}:
        np.testing.assert_allclose(data[name], run[name], rtol=1e-12, err_msg=name)
    assert {"disc_torque", "wheel_moment", "transmission_error", "disc_phase"} <= set(data.variables)
    assert data["disc_torque"].values.sum() == pytest.approx(uneven.wheel_moment())
    assert set(data["pressure_disc"].values) == {0, 1}
    summary = summarise(solved)
    np.testing.assert_array_equal(np.shape(summary["pin_load_N"]), (2, 14))
    assert len(summary["disc_displacement"]) == len(summary["bearing_radial_N"]) == len(summary["torque_share"]) == 2
    # The eccentricity of the second disc points the other way: what is radial is so along its own.
    (bearing_force,) = solved.discs[1].contacts.bearing_force
    force = bearing_force * -np.exp(-1j * ANGLE)
    assert summary["bearing_tangential_N"][1] == pytest.approx(force.imag, rel=1e-12)


def test_equal_discs_and_a_held_wheel(paper_cases):
    """Half a turn apart, pins and holes even in number: the same body turned, numbers shifted by half, rollers as they are.

    The wheel's moment then balances crank and output, and the crank bears its 1/z_C of the output but for a few tenths of
    a per cent, the slope of the transmission error.
    """
    drive = with_fields(paper_cases["CS-3"], {"disc.number_of_discs": 2, "installation.held": "pin-wheel"})
    found = solve_reducer(drive, ANGLE, SolutionOptions(size=6.0))
    first, second = (disc.contacts for disc in found.discs)
    for name, shift in (("pin_load", 7), ("roller_load", 0), ("pin_shaft_load", 4)):
        one, other = getattr(first, name), np.roll(getattr(second, name), shift)
        # The meshes differ: with one and a half elements for a half-width a load is good to a per cent or two.
        assert np.max(np.abs(one - other)) < 0.02 * one.max(), name
        assert np.max(np.abs(one - np.roll(other, 1))) > 0.1 * one.max(), name
    np.testing.assert_allclose(found.torque_share, 0.5, atol=2e-3)
    crank = sum(disc.crank_moments.sum() for disc in found.discs)
    assert found.wheel_moment + crank + drive.load.torque == pytest.approx(0.0, abs=1e-7 * drive.load.torque)
    assert crank == pytest.approx(drive.load.torque / 13.0, rel=5e-3)
    assert found.transmission_error == pytest.approx(-14.0 / 13.0 * found.wheel_angle, rel=1e-12)


def test_the_picture_has_an_arrow_for_every_load(solved):
    """Arrows are forces: those on a disc balance, in sum and in moment. Dots are at all contacts, the inner races' too."""
    picture, lengths = draw_loads(solved), []
    for disc, (told, svg) in zip(solved.discs, picture.panels, strict=True):
        assert "% of the torque" in told
        loaded, drawn = disc.contacts.loaded, ET.fromstring(svg)
        arrows = [group for group in drawn if group.get("class", "").startswith("load ")]
        dots = [dot for dot in drawn if dot.get("class", "").startswith("pressed ")]
        assert len(dots) == len(loaded)
        on_disc = [load for kind, _, load, _, _ in loaded if kind != "roller_inner"]
        assert len(arrows) == len(on_disc)
        ends = [[path.get("d") for path in group if path.tag == "path"] for group in arrows]
        start, tip = (np.array([complex(*map(float, _first(pair[k]))) for pair in ends]) for k in (0, 1))
        force = tip - start
        lengths.append([np.abs(force), on_disc])
        # Texts have 3 decimals of a millimetre, forces balance to far less.
        assert abs(force.sum()) < 1e-3 * len(force)
        assert abs((start.conjugate() * force).imag.sum()) < 1e-3 * np.abs(start).sum() + 1e-3 * np.abs(force).sum()
        assert max(float(one.get("class")[-1]) for one in dots) >= 8.0
    longest = max(load for disc in solved.discs for _, _, load, _, _ in disc.contacts.loaded)
    length, load = np.hstack(lengths)
    # One scale for both discs; each end of an arrow is a text that is off by up to 0.0007 mm.
    np.testing.assert_allclose(length, load / longest * length.max(), atol=3e-3)
    keys = " ".join(" ".join(key) for key in picture.keys)
    assert f"longest arrow {longest:.0f} N" in keys
    assert "28.6479°" in picture.title
    assert "377.3 N·m" in picture.title


def _first(path):
    return re.match(r"M([-.\d]+),([-.\d]+)", path).groups()


def test_the_command_writes_files_by_disc(solved, uneven, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("fem.reducer.solution.solve_reducer", lambda *words, **options: solved)
    source = tmp_path / "two.toml"
    source.write_text(drive_text(uneven), encoding="utf-8")
    parser = argparse.ArgumentParser()
    command.configure(parser)
    words = [str(source), "--angle", "0.5", "--size", "4", "--out", str(tmp_path / "out"), "--no-pictures"]
    assert command.execute(parser.parse_args([*words, "--export", "calculix"])) == 0
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"fem.nc", "summary.json", "fem.vtm", "disc_0.vtu", "disc_1.vtu", "disc_1_pin_13.vtu"} <= names
    assert {"disc_0_calculix.inp", "disc_1_calculix.inp", "disc_0_inner_race.vtu"} <= names
    assert "disc.vtu" not in names
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count('<svg class="drive"') == 2
    assert page.count('<g class="load ') == sum(
        kind != "roller_inner" for disc in solved.discs for kind, *_ in disc.contacts.loaded
    )
    with xr.open_dataset(tmp_path / "out" / "fem.nc", engine="h5netcdf") as data:
        assert data.sizes["disc"] == 2
        assert set(data["wall_disc"].values) == {0, 1}
        assert data["root_stress"].shape == (1, 2, 1, 13)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert sum(summary["torque_share"]) == pytest.approx(1.0)
    out = capsys.readouterr().out
    assert "disc 1, " in out
    assert out.count("its part of the moment on the wheel: ") == 2


def test_full_solutions_are_judged_by_the_limits_of_the_drive(solved):
    """Largest of both discs, where it is; what one position cannot say is not judged."""
    largest = max(float(disc.contacts.pin_pressure_mid.max()) for disc in solved.discs)
    limits = parse_limits({"max_pin_pressure_mid": 0.9 * largest, "max_backlash_output": "3 arcmin"}, [])
    stresses = [recover_disc_stress(disc) for disc in solved.discs]
    checks = {check.value.quantity: check for check in judge_solution(solved, stresses, limits)}
    found = checks["pin_pressure_mid"]
    assert (found.verdict, found.value.value) == ("fail", largest)
    assert found.safety == pytest.approx(0.9)
    worst = int(np.argmax([disc.contacts.pin_pressure_mid.max() for disc in solved.discs]))
    assert found.value.part == f"disc {worst}, wheel pin {np.argmax(solved.discs[worst].contacts.pin_pressure_mid)}"
    assert found.value.crank_angle == ANGLE
    assert "backlash_output" not in checks
    assert checks["pin_load"].verdict == "no limit"
