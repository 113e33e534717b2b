"""A small study without any finite elements: the half-space's own answers, changed a little, stand for full solutions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import validation.levels.flexible_disc
from fem.options import SolutionOptions
from ltca.analysis.loaded_analysis import analyse
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import without_coupling
from validation.compare.compared_positions import compare_case
from validation.compare.disc_stresses import DiscStressAnswer
from validation.compare.finite_element_positions import FullPosition
from validation.compare.model_positions import answers_of
from validation.levels.flexible_disc import flexibility_rows, full_solution_rows, study_case
from validation.levels.positions import compare_position_rows
from validation.rows import Row
from validation.study import Plan, Study

ANGLES = (0.0, 0.2, 0.4)
# The coefficients of the small study know no stress: nothing is compared.
NO_STRESS = DiscStressAnswer(parameter=(), stress=(), clear=(), largest={}, shear={})


@pytest.fixture(scope="session")
def no_stress() -> DiscStressAnswer:
    """What a full solution says of stresses that no model knows."""
    return NO_STRESS


def perturbed(answer, factor):
    """The answer with every load, and so the bearing force, changed by a factor."""
    kinds = {
        name: replace(kind, load=factor * kind.load, pressure=np.sqrt(factor) * kind.pressure)
        for name, kind in answer.kinds.items()
    }
    return replace(
        answer,
        kinds=kinds,
        bearing_radial=factor * answer.bearing_radial,
        bearing_tangential=factor * answer.bearing_tangential,
    )


@pytest.fixture(scope="session")
def small_study(paper_cases):
    """Two cases, three angles; "full FE" is the half-space with loads 1 % larger; a turn of six positions."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(validation.levels.flexible_disc, "TURN_POSITIONS", 6)
        patch.setattr(validation.levels.flexible_disc, "TORQUES", (1.0,))
        return make_study(paper_cases)


def make_study(paper_cases):
    drives = {name: paper_cases[name] for name in ("CS-1", "CS-6")}
    compared, flexibility, coefficients, rows = {}, {}, {}, []
    for case, drive in drives.items():
        answers = answers_of(analyse(drive, np.array(ANGLES)))
        positions = [
            FullPosition(
                case=case,
                crank_angle=angle,
                answer=perturbed(answer, 1.01),
                stress=NO_STRESS,
                residual=0.0,
                unknowns=1000,
                seconds=1.0,
                pictures=None,
            )
            for angle, answer in zip(ANGLES, answers, strict=True)
        ]
        coefficients[case] = without_coupling(drive)
        compared[case] = compare_case(drive, positions, coefficients[case])
        flexibility[case] = study_case(drive, coefficients[case])
        for item in compared[case]:
            rows += compare_position_rows(item)
        rows += [*full_solution_rows(case, compared[case]), *flexibility_rows(case, flexibility[case])]
    for level in (1, 2, 3, 4):
        rows.append(
            Row(
                level=level,
                quantity=f"figure of level {level}",
                value=1.001,
                reference=1.0,
                unit="mm",
                difference=1e-3,
                limit=2e-3,
                reason="made by hand",
            )
        )
    plan = Plan(name="paper", drives=drives, crank_angles=ANGLES, level="quick", options=SolutionOptions())
    return Study(plan=plan, rows=tuple(rows), compared=compared, flexibility=flexibility, coefficients=coefficients)


@pytest.fixture(scope="session")
def crank_drive():
    """Three rigid cranks that stand at no angle a symmetry likes, no pin shaft, one disc with few teeth."""
    rv = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    fields = {
        "crank.eccentricity": 4.0, "crank.angle": 0.4, "crank_bearing.number_of_rollers": 9,
        "pin_wheel.number_of_pins": 12, "pin_wheel.pin_radius": 8.0, "disc.number_of_teeth": 11,
        "disc.number_of_discs": 1, "disc.phases": (), "disc.planes": (), "load.torque": 400e3,
    }  # fmt: skip
    return with_fields(replace(rv, crank=replace(rv.crank, support=None)), fields)


@pytest.fixture(scope="session")
def crank_study(crank_drive):
    """One angle of it; "full FE" is the half-space to the last bit, the other models yield like it but for pins."""
    angles = (0.3,)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(validation.levels.flexible_disc, "TURN_POSITIONS", 2)
        patch.setattr(validation.levels.flexible_disc, "TORQUES", (1.0,))
        (answer,) = answers_of(analyse(crank_drive, np.array(angles)))
        full = FullPosition(
            case="nominal", crank_angle=angles[0], answer=answer, stress=NO_STRESS, residual=0.0, unknowns=1000,
            seconds=1.0, pictures=None,
        )  # fmt: skip
        coefficients = replace(without_coupling(crank_drive), pin=1e-7)
        compared = compare_case(crank_drive, [full], coefficients)
        plan = Plan(
            name="rv", drives={"nominal": crank_drive}, crank_angles=angles, level="quick", options=SolutionOptions()
        )
        return Study(
            plan=plan, rows=tuple(compare_position_rows(compared[0])), compared={"nominal": compared},
            flexibility={"nominal": study_case(crank_drive, coefficients)}, coefficients={"nominal": coefficients},
        )  # fmt: skip


@pytest.fixture(scope="session")
def small_report(small_study, tmp_path_factory) -> Path:
    """The page of the small study."""
    from validation.report.page import write_report

    return write_report(small_study, tmp_path_factory.mktemp("report") / "report.html")
