"""Cases of one file whose bodies hardly differ share influence coefficients, and that is told."""

import json

import pytest

import ltca
from ltca.analysis import engines
from ltca.commands.program import main
from ltca.compliance import coefficient_files
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import without_coupling

CASES = """
[[case]]
name = "drawn"
[[case]]
name = "looser"                        # 0.03 % of the bore
clearance = { bearing = 0.02 }
[[case]]
name = "thicker"                       # another body
disc = { thickness = 12.5 }
[[case]]
name = "thicker and looser"
disc = { thickness = 12.5 }
clearance = { bearing = 0.02 }
"""


@pytest.fixture
def text():
    """The paper's drive on hybrid with cases of its own."""
    own = shipped_drive("paper").split("[[case]]")[0].replace('compliance = "half-space"', 'compliance = "hybrid"')
    return own + CASES


@pytest.fixture
def derived(monkeypatch):
    """Coefficients without coupling in place of derived ones; names and thicknesses of the drives they were asked for."""
    asked = []

    def find(drive, *given, **options):
        return without_coupling(drive)

    def find_all(cases, files=(), **options):
        asked.append({name: drive.disc.thickness for name, drive in cases.items()})
        return {}

    monkeypatch.setattr(engines, "find_coefficients", find)
    monkeypatch.setattr(coefficient_files, "find_case_coefficients", find_all)
    return asked


@pytest.mark.slow
def test_cases_that_hardly_differ_are_derived_once(text, derived, tmp_path, capsys):
    """A clearance of 0.03 % of the bore had coefficients of its own derived for every case."""
    path = tmp_path / "several.toml"
    path.write_text(text, encoding="utf-8")
    words = ["run", str(path), "--angles", "0.3", "--no-page", "--out", str(tmp_path / "all")]
    assert main(words) == 0
    assert derived.pop() == {"drawn": 11.8, "thicker": 12.5}
    told = capsys.readouterr().out
    assert "influence coefficients are those of case drawn where no number of a body is off by more than 0.2%" in told
    assert "influence coefficients are those of case thicker" in told
    # One case alone gives what it gives beside the others.
    assert main([*words[:-1], str(tmp_path / "one"), "--case", "looser"]) == 0
    assert derived.pop() == {"drawn": 11.8}
    all_of, one = (json.loads((tmp_path / name / "summary.json").read_text())["cases"] for name in ("all", "one"))
    assert one["looser"] == all_of["looser"]
    # `check` on the command line and in Python does the same.
    words = ["check", str(path), "--case", "looser", "--positions", "2", "--no-advice", "--no-page"]
    assert main([*words, "--out", str(tmp_path / "check")]) in (0, 1)
    assert derived.pop() == {"drawn": 11.8}
    found = ltca.check(parse_drive(text), 2, case="looser", advice=False)
    assert any("coefficients are those of case drawn" in note for note in found.notes)


def test_a_case_alone_and_files_that_are_given_keep_their_own(text, tmp_path):
    file = parse_drive(text)
    engine = engines.Hybrid()
    assert engines.lending_between([file.cases["looser"]], engine) is engine
    given = engines.Hybrid(coefficients=(tmp_path / "some.nc",))
    assert engines.lending_between(file.cases.values(), given) is given
    assert engines.lending_between(file.cases.values(), engines.HalfSpace()) == engines.HalfSpace()
    lending = engines.lending_between(file.cases.values(), engine)
    assert [body.case for body in lending.lenders] == ["drawn", "thicker"]
    assert engines.lent_words(lending, file.cases["thicker"]) == ""
    (looser,) = single_discs(file.cases["looser"])
    (body,) = lending.bodies_of([looser])
    assert body.case == "drawn"


def test_what_plane_strain_cannot_say_is_refused_of_a_case_that_borrows(text, derived):
    """Only the drive whose coefficients are lent would have been looked at."""
    crowned = "pin_wheel = { pin_profile = { crown_drop = 0.002 } }"
    file = parse_drive(
        text.replace("clearance = { bearing = 0.02 }", f"clearance = {{ bearing = 0.02 }}\n{crowned}", 1)
    )
    engine = engines.lending_between(file.cases.values(), engines.PlaneStrain())
    engine.with_coefficients(file.cases["drawn"])
    with pytest.raises(DriveError, match="pin_profile"):
        engine.with_coefficients(file.cases["looser"])
