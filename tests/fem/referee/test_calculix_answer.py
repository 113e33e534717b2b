"""What is read from a .dat file of CalculiX: the last increment only, and none whose contacts pull."""

import sys
from pathlib import Path

import pytest
from refusals import error_says

from fem.referee.calculix import last_output, read_forces, read_pressures, read_wheel_turn, run_calculix
from ltca.errors import CycloError


def increment(pressures, turn, force):
    """One increment as ccx 2.20 prints it: contact stresses, displacements, statistics of a pair."""
    stresses = "\n".join(f"      3270          3 {value: .6E}  0.000000E+00  0.000000E+00" for value in pressures)
    return f"""
 contact stress (slave element+face,press,tang1,tang2) for all contact elements and time 0.1000000E+01

{stresses}

 displacements (vx,vy,vz) for set WHEEL and time  0.1000000E+01

     39662 {turn: .6E}  0.000000E+00  0.000000E+00

 statistics for slave set S_PIN_3, master set O_PIN_3 and time  0.1000000E+01

   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)

   {force: .6E} -2.736185E+03  5.228434E-13 -4.878273E-03 -2.659323E-03 -1.741135E+05
"""


FIRST = increment([1243.9, -9439.7, 1285.2], -1.616355e-6, 1486.212)
LAST = increment([1210.0, 7.7, 1290.0], -2.875991e-7, 1490.0)


def test_the_last_increment_is_the_answer():
    """Of an increment whose contacts still pulled the wheel's angle was taken, and of both the pressures: 0.33″ off ours."""
    last = last_output(FIRST + LAST)
    assert read_wheel_turn(last) == -2.875991e-7
    assert read_pressures(last) == {(3270, 3): [1210.0, 7.7, 1290.0]}
    assert list(read_forces(last)) == ["PIN_3"]
    assert read_forces(last)["PIN_3"][0] == 1490.0
    assert last_output(LAST) == last


def test_contacts_that_pull_are_no_answer():
    with error_says(CycloError, "contacts that pull: -9440 MPa"):
        last_output(LAST + FIRST)
    # What the default size ended with: more than half of the largest pressure, among 50,000 points.
    with error_says(CycloError, "contacts that pull: -913.4 MPa, largest pressure 1554 MPa"):
        last_output(increment([1210.0, -913.4, 1554.0], 0.0, 1.0))
    with error_says(CycloError, "contacts that pull: -22.9 MPa"):
        last_output(increment([1210.0, -22.9, 2061.3], 0.0, 1.0))
    # Single points at the rim that changed sides last.
    assert read_pressures(last_output(increment([1210.0, -1.3, 2061.3], 0.0, 1.0)))


def test_a_file_without_contacts_is_one_error():
    with pytest.raises(CycloError, match="no contact stresses"):
        last_output("")


def test_a_deck_is_copied_where_links_are_for_administrators(tmp_path, monkeypatch):
    """Windows: a program that finds its deck answers with the deck's own text, which holds what a result has."""

    def refused(self, target):
        raise OSError(1314, "A required privilege is not held by the client")

    monkeypatch.setattr(Path, "symlink_to", refused)
    script = (
        "import pathlib; pathlib.Path('job.dat').write_text(pathlib.Path('job.inp').read_text()); print('Job finished')"
    )
    deck, program = tmp_path / "deck.inp", tmp_path / "ccx"
    deck.write_text("total surface force", encoding="utf-8")
    program.write_text(f"#!{sys.executable}\n{script}\n", encoding="utf-8")
    program.chmod(0o755)
    assert run_calculix(deck, str(program))[0] == "total surface force"
