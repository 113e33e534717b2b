"""Studies that move a ring of finite elements: rings that hardly differ take one, others are derived and told beforehand."""

import argparse
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import SHARED_BODY, HalfSpace, Hybrid, ring_lender
from ltca.commands import optimise
from ltca.compliance import ring as rings
from ltca.drive.ring_shape import nearly_same_ring, ring_fingerprint
from ltca.errors import CycloError
from ltca.laws.ring_beam import beam_flexibility
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.studies import shapes
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers
from ltca.studies.run_study import run_study
from ltca.studies.sweep_file import parse_sweep
from ltca.studies.tolerance_study import tolerance_study

RING = """
[ring]
inner_radius = 60.0
outer_radius = 90.0
width = 50.0
model = "fe"
"""
SWEEP = """
positions = 2
quantities = ["max_pin_load"]
[factors]
"ring.outer_radius" = [90.0, 90.05, 85.0]
"load.torque" = [3e5, 3.5e5]
"""


@pytest.fixture
def derived(monkeypatch):
    """The beam of each ring in place of finite elements, and the outer radii that were asked for."""
    asked = []

    def found(drive):
        asked.append(drive.ring.outer_radius)
        return drive.ring.material.youngs_modulus * drive.ring.width * beam_flexibility(drive)

    monkeypatch.setattr(rings, "_kept_or_derived", found)
    monkeypatch.setattr(rings, "_KNOWN", {})
    monkeypatch.setattr(shapes, "has_ring", lambda drive: ring_fingerprint(drive) in rings._KNOWN)
    return asked


@pytest.fixture(scope="module")
def joint():
    return next(iter(parse_drive(shipped_drive("robot-joint") + RING).cases.values()))


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "joint.toml"
    path.write_text(shipped_drive("robot-joint") + RING, encoding="utf-8")
    return path


def test_rings_are_compared_by_their_height_and_seats(joint):
    """0.2 % of 30 mm and of pins of 2.5 mm; a ring that is larger as a whole is the same."""
    all_larger = {
        name: 1.1 * value
        for name, value in (
            ("pin_wheel.pin_circle_radius", 60.0), ("pin_wheel.pin_radius", 2.5), ("ring.inner_radius", 60.0),
            ("ring.outer_radius", 90.0),
        )
    }  # fmt: skip
    for changes, expected in (
        ({"ring.outer_radius": 90.05}, True),
        ({"ring.outer_radius": 90.07}, False),
        ({"ring.inner_radius": 59.95}, True),
        ({"pin_wheel.pin_radius": 2.504}, True),
        ({"pin_wheel.pin_radius": 2.506}, False),
        ({"ring.width": 20.0, "ring.material.youngs_modulus": 70e3}, True),
        ({"ring.material.poisson_ratio": 0.301}, False),
        ({"ring.flange": "built-in"}, False),
        ({"ring.bolts": {"number": 12, "circle_radius": 75.0, "stiffness": 1e6}}, False),
        (all_larger, True),
    ):
        assert nearly_same_ring(joint, with_fields(joint, changes, check=False), SHARED_BODY) is expected, changes
    assert not nearly_same_ring(replace(joint, ring=None), joint, SHARED_BODY)
    # Where its own is there, nobody lends.
    near = with_fields(joint, {"ring.outer_radius": 90.05})
    assert ring_lender(near, [joint]) is joint
    assert ring_lender(near, [joint, near]) is None
    assert ring_lender(with_fields(near, {"ring.model": "beam"}), [joint]) is None


def test_a_lent_ring_has_modulus_width_and_bolts_of_its_own(joint, derived):
    changes = {"ring.width": 25.0, "ring.material.youngs_modulus": 103e3}
    near = with_fields(joint, {"ring.outer_radius": 90.05, **changes})
    own = rings.ring_flexibility(joint)
    np.testing.assert_allclose(
        rings.ring_flexibility(near, joint),
        own * (joint.ring.material.youngs_modulus / 103e3 * 2.0),
        rtol=1e-12,  # one product
        atol=1e-18,
    )
    assert derived == [90.0]


@pytest.mark.slow
def test_a_sweep_derives_each_ring_once_and_beforehand(file, derived, tmp_path):
    """Two rings of three: one differs by 0.05 mm of 30."""
    study = parse_sweep(tomllib.loads(SWEEP), str(file))
    told = []
    folder = StudyFolder(path=tmp_path / "swept")
    found = run_study(study, folder, Workers(), told=lambda text: told.append((text, len(derived))))
    assert not found.failures
    assert derived == [90.0, 85.0]
    words = [(text, count) for text, count in told if "ring" in text]
    assert "differs from that of the drive by at most 0.2% of its height" in words[0][0]
    assert words[1][0].startswith("2 shapes of the ring by finite elements: derived first")
    assert words[1][1] == 0


def test_scatter_within_the_bound_derives_one_ring(file, derived):
    """Every sample of a tolerance study derived its own, in silence."""
    drive = parse_drive(file.read_text(encoding="utf-8"))
    scatter = next(iter(drive.tolerances.values()))
    for tolerance, count in ((0.02, 1), (0.5, 5)):
        tolerances = {"ring.outer_radius": replace(scatter, tolerance=tolerance)}
        study = tolerance_study(replace(drive, tolerances=tolerances), samples=5, positions=2)
        assert len(study.rings(range(study.batches))) == count
    assert tolerance_study(load_drive("robot-joint"), samples=5, positions=2).rings([0]) == {}


def test_rings_are_part_of_what_a_study_is(joint):
    """A study is resumed with the rings that it began with; without finite elements nothing of it changes."""
    plain = with_fields(joint, {"ring.model": "beam"})
    assert shapes.coefficients_identity(HalfSpace().lending_rings([plain])) == "none"
    assert ring_fingerprint(joint) in shapes.coefficients_identity(HalfSpace().lending_rings([joint]))
    assert Hybrid().lending_rings([joint]).rings == (joint,)
    assert HalfSpace().lending_rings([plain]) == HalfSpace()


def test_a_search_tells_of_rings_that_candidates_need(file, derived, monkeypatch, tmp_path, capsys):
    def stop(problem, positions, engine):
        assert len(engine.rings) == 1
        raise CycloError("far enough")

    monkeypatch.setattr("ltca.commands.actions.optimise.batch_analysis", stop)
    parser = argparse.ArgumentParser()
    optimise.configure(parser)
    for bounds, told in (("89.97:90.03", False), ("80:90", True)):
        words = [file, "--vary", f"ring.outer_radius={bounds}", "--minimise", "max_pin_load", "--positions", 13]
        with pytest.raises(CycloError, match="far enough"):
            optimise.execute(parser.parse_args([*map(str, words), "--quick", "--out", str(tmp_path / f"out-{told}")]))
        assert ("candidates reshape the ring of finite elements by more than 0.2%" in capsys.readouterr().err) is told
