"""The whole validation of a drive: which positions, in which order, and the rows of all six levels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from fem.options import SolutionOptions
from ltca.drive.engine_support import require
from ltca.drive.members.limits import Limits
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.reading.drive_file import DriveFile
from validation.compare.compared_positions import ComparedPosition, compare_case
from validation.compare.derived_coefficients import coefficients_of, disc_coefficients_of, nominal_coefficients_of
from validation.compare.error_bars import ErrorBars, error_bars_of
from validation.compare.finite_element_positions import FullPosition, solve_positions
from validation.compare.model_positions import DiscCoefficients
from validation.levels.closed_forms import check_closed_forms
from validation.levels.coefficients import check_file, halved_mesh_row
from validation.levels.disc_stresses import disc_stress_rows
from validation.levels.flexible_disc import FlexibilityEffect, flexibility_rows, full_solution_rows, study_case
from validation.levels.model_laws import compare_models
from validation.levels.other_codes import asked_codes
from validation.levels.positions import compare_position_rows, shared_file_rows
from validation.levels.printed_results import compare_printed_results
from validation.rows import Row

Level = Literal["quick", "full"]

QUICK_ANGLES, FULL_ANGLES = 2, 12
VALIDATION = "validation by full finite elements"
"""What refusals call this analysis."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What to compare.

    Attributes
    ----------
    name : str
        Name of the drive.
    drives : dict of str to Drive
        The chosen cases.
    crank_angles : tuple of float
        rad.
    level : {"quick", "full"}
        How much is computed beside the positions.
    options : SolutionOptions
        Of the full solutions.
    limits : dict of str to dict of str to Limit
        Of the drive file, by case; none by default.
    """

    name: str
    drives: dict[str, Drive]
    crank_angles: tuple[float, ...]
    level: Level
    options: SolutionOptions
    limits: dict[str, Limits] = field(default_factory=dict)

    @property
    def pictured(self) -> float:
        """Crank angle of the pictures and of the error bars, rad."""
        return self.crank_angles[len(self.crank_angles) // 2]

    @property
    def steps(self) -> int:
        """Number of steps that `run_validation` reports."""
        bars = len(self.drives) if self.level == "full" else 0
        return 5 + 2 * len(self.drives) + len(self.drives) * len(self.crank_angles) + bars


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """Everything a report needs.

    Attributes
    ----------
    plan : Plan
        What was compared.
    rows : tuple of Row
        Of all levels, in order.
    compared : dict of str to list of ComparedPosition
        By case.
    flexibility : dict of str to FlexibilityEffect
        By case.
    coefficients : dict of str to InfluenceCoefficients or tuple of them
        By case, of several discs of each.
    error_bars : dict of str to ErrorBars or None
        By case, on level full; None where the memory is too small for nested meshes.
    """

    plan: Plan
    rows: tuple[Row, ...]
    compared: dict[str, list[ComparedPosition]]
    flexibility: dict[str, FlexibilityEffect]
    coefficients: dict[str, DiscCoefficients]
    error_bars: dict[str, ErrorBars | None] = field(default_factory=dict)


def plan_study(
    file: DriveFile,
    cases: list[str] | None,
    crank_angles: list[float] | None,
    level: Level,
    options: SolutionOptions,
) -> Plan:
    """Return what a validation compares.

    Without cases: the first, the middle and the last one of the file. Without angles: two (quick) or twelve (full) over
    one period of the flank, 360°/z_C of the crank.

    Raises
    ------
    DriveError
        When a case is not in the file, or is nothing that full FE can say.
    """
    names = list(file.cases)
    if not cases:
        cases = list(dict.fromkeys([names[0], names[(len(names) - 1) // 2], names[-1]]))
    drives = file.select_warm(cases)
    for drive in drives.values():
        require(drive, "full FE")
    if not crank_angles:
        count = QUICK_ANGLES if level == "quick" else FULL_ANGLES
        teeth = next(iter(drives.values())).disc.number_of_teeth
        crank_angles = (2.0 * np.pi / teeth * np.arange(count) / count).tolist()
    return Plan(
        name=file.name,
        drives=drives,
        crank_angles=tuple(dict.fromkeys(crank_angles)),
        level=level,
        options=options,
        limits={case: file.limits.get(case, {}) for case in drives},
    )


def run_validation(plan: Plan, folder: Path, step: Callable[[str], None], say: Callable[[str], None]) -> Study:
    """Run a validation.

    Parameters
    ----------
    plan : Plan
        What to compare.
    folder : Path
        Where finished solutions, coefficients and other codes' answers are kept.
    step : callable
        Called with the name of each step before it starts.
    say : callable
        Called with the details of a step.

    Returns
    -------
    Study
        The same whether everything was solved now or taken from files.

    Raises
    ------
    CycloError
        When something does not converge or a file cannot be written.
    """
    with asked_codes(folder / "other_codes.json") as answers:
        one, three, coefficients, four = _before_positions(plan, folder / "coefficients", step, say)
        full = _solve_positions(plan, folder / "positions", step, say)
        bars = _error_bars(plan, full, folder / "errors", step, say)
        step("other codes")
        two = answers()
    compared = {case: compare_case(plan.drives[case], full[case], coefficients[case]) for case in plan.drives}
    five = _model_rows(plan, compared, full, coefficients, folder / "coefficients", bars, say)
    flexibility, six = {}, []
    for case, drive in plan.drives.items():
        step(f"one turn of {case}")
        flexibility[case] = study_case(drive, coefficients[case])
        six += [*full_solution_rows(case, compared[case], bars.get(case)), *flexibility_rows(case, flexibility[case])]
    rows = (*one, *two, *three, *four, *five, *six)
    return Study(
        plan=plan,
        rows=rows,
        compared=compared,
        flexibility=flexibility,
        coefficients=coefficients,
        error_bars=bars,
    )


def _error_bars(
    plan: Plan,
    full: dict[str, list[FullPosition]],
    folder: Path,
    step: Callable[[str], None],
    say: Callable[[str], None],
) -> dict[str, ErrorBars | None]:
    """Return the error bars of all cases, at the position that has pictures; nothing on level quick."""
    found: dict[str, ErrorBars | None] = {}
    if plan.level == "full":
        for case, drive in plan.drives.items():
            step(f"error bars of {case}")
            own = [position for position in full[case] if position.crank_angle == plan.pictured]
            found[case] = error_bars_of(drive, case, plan.pictured, folder, plan.options, compared=own, progress=say)
    return found


def _before_positions(
    plan: Plan, folder: Path, step: Callable[[str], None], say: Callable[[str], None]
) -> tuple[list[Row], list[Row], dict[str, DiscCoefficients], list[Row]]:
    """Return the rows of levels 1 and 3, the coefficients of all cases and the rows of level 4."""
    case, drive = next(iter(plan.drives.items()))
    step("closed forms")
    one = check_closed_forms(drive)
    step("printed results")
    three = compare_printed_results()
    coefficients: dict[str, DiscCoefficients] = {}
    four: list[Row] = []
    for name, own in plan.drives.items():
        step(f"coefficients of {name}")
        datasets, coefficients[name] = disc_coefficients_of(own, name, folder, progress=say)
        four += [row for label, dataset in datasets.items() for row in check_file(dataset, label, "strain")]
    step("coefficients of the bodies in plane stress")
    label, alone = first_disc(drive, case)
    stress, _ = coefficients_of(alone, case, folder, plane="stress", progress=say)
    four += check_file(stress, label, "stress")
    if plan.level == "full":
        finer, _ = coefficients_of(alone, case, folder, size=0.5, progress=say)
        four.append(halved_mesh_row(finer, label))
    return one, three, coefficients, four


def _model_rows(
    plan: Plan,
    compared: dict[str, list[ComparedPosition]],
    full: dict[str, list[FullPosition]],
    coefficients: dict[str, DiscCoefficients],
    folder: Path,
    bars: dict[str, ErrorBars | None],
    say: Callable[[str], None],
) -> list[Row]:
    """Return the rows of level 5; relations between the models are checked on the first disc alone."""
    first, last = next(iter(plan.drives)), list(plan.drives)[-1]
    rows = [
        row
        for case, items in compared.items()
        for item in items
        for row in (*compare_position_rows(item, bars.get(case)), *disc_stress_rows(item, bars.get(case)))
    ]
    label, alone = first_disc(plan.drives[first], first)
    _, stress = coefficients_of(alone, first, folder, plane="stress", progress=say)
    own = coefficients[first]
    strain = own[0] if isinstance(own, tuple) else own
    rows += compare_models(alone, label, np.array(plan.crank_angles), strain, stress)
    shared = nominal_coefficients_of(plan.drives[last], last, folder, progress=say)
    if shared is not None:
        rows += shared_file_rows(compare_case(plan.drives[last], full[last], shared), bars.get(last))
    return rows


def first_disc(drive: Drive, case: str) -> tuple[str, Drive]:
    """Return a label and the first disc alone under an equal part of the torque; the drive itself if it has no other disc."""
    single, *others = single_discs(drive)
    if not others:
        return case, single
    return f"{case}, disc 0 alone", single


def _solve_positions(
    plan: Plan, folder: Path, step: Callable[[str], None], say: Callable[[str], None]
) -> dict[str, list[FullPosition]]:
    solved: dict[str, list[FullPosition]] = {}
    for case, drive in plan.drives.items():
        series = solve_positions(
            drive,
            case,
            plan.crank_angles,
            folder,
            plan.options,
            pictured=plan.pictured,
            title=f"{plan.name}, {case}",
            begin=step,
            progress=say,
        )
        solved[case] = [position for positions in series for position in positions]
    return solved
