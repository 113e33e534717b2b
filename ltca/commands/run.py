"""``cyclo run``: the loaded tooth contact analysis of a drive, all cases."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.errors import ConvergenceError
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    count_argument,
    default_folder,
    quantity_argument,
    torque_argument,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from xarray import Dataset

    from ltca.analysis.engines import Engine
    from ltca.analysis.loaded_analysis import LoadedAnalysis
    from ltca.drive.members.limits import Limits
    from ltca.drive.parts import Drive
    from ltca.geometry.pairs import FloatArray
    from ltca.reading.drive_file import DriveFile

SUMMARY = "loaded tooth contact analysis: loads, pressures, bearing forces, transmission error"
DEFAULT_POSITIONS = 360


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case to run, repeatable; default all")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 1, 1_000_000),
        help=f"crank angles 2πk/N, k = 0 … N−1; default {DEFAULT_POSITIONS}",
    )
    where.add_argument(
        "--angles",
        metavar="φ",
        nargs="+",
        type=quantity_argument("--angles", "rad"),
        help="crank angles in rad (or texts such as '20 deg')",
    )
    parser.add_argument(
        "--torque",
        metavar="T",
        type=torque_argument,
        help="output torque in N·mm (or a text such as '377.3 N m'); default that of the drive",
    )
    parser.add_argument(
        "--method",
        choices=("tables", "direct", "paper"),
        help="equilibrium on tabulated contact laws (default), with contact grids solved inside every iteration, or by "
        "the paper's iteration with held wheel",
    )
    parser.add_argument(
        "--contacts", choices=("tables", "grids"), help="what the paper's iteration runs on; default tables"
    )
    add_compliance_arguments(parser)
    parser.add_argument(
        "--pressure",
        metavar="φ",
        nargs="*",
        type=quantity_argument("--pressure", "rad"),
        help="pressure fields of all loaded contacts at these crank angles (default 0) into pressure.nc, with figures",
    )
    add_out_argument(parser, "run")
    parser.add_argument("--no-figures", action="store_true", help="write results.nc and summary.json only")


def execute(arguments: argparse.Namespace) -> int:
    """Run the analysis and write results, summary and figures."""
    from ltca.commands.compliance_arguments import check_compliance
    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    # Before the analysis is imported: what is wrong is told at once.
    check_compliance(arguments)
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case)
    out = arguments.out or default_folder(file.name, "run")
    require_folder(out)
    from ltca.analysis.memory_need import require_room_for
    from ltca.analysis.results import check_common_shape
    from ltca.commands.compliance_arguments import find_coefficients_of

    angles, pressure_angles = _crank_angles(arguments), _pressure_angles(arguments)
    torque, engine = arguments.torque, _engine(arguments)
    check_common_shape(cases)
    require_room_for(cases.values(), angles.size, out, f"--positions {angles.size}")
    with claimed_folder(out, "run", writes=_files(arguments, cases)):
        find_coefficients_of(cases, arguments)
        chosen = _Chosen(file=file, cases=cases, engine=engine, torque=torque)
        return _solve_and_write(chosen, angles, pressure_angles, out, figures=not arguments.no_figures)


def _parts(cases: Mapping[str, Drive]) -> tuple[int, int, int]:
    """Numbers of discs, of holes and of cranks, which all cases of a run have."""
    drive = next(iter(cases.values()))
    return drive.disc.number_of_discs, drive.number_of_holes, drive.crank.number


def _files(arguments: argparse.Namespace, cases: Mapping[str, Drive]) -> Iterator[str]:
    """Names of all files that the run may write."""
    from glob import escape

    yield from ("results.nc", "summary.json")
    if arguments.pressure is not None:
        yield "pressure.nc"
    if not arguments.no_figures:
        from ltca.figures.pressure_figures import PRESSURE_FIGURES
        from ltca.figures.run_figures import figure_names
        from ltca.output.run_folder import figure_files

        yield from figure_files(*figure_names(*_parts(cases)))
        if arguments.pressure is not None:
            yield from figure_files(*PRESSURE_FIGURES)
            yield from (f"figures/fig31_roller_pressure_{escape(name)}.png" for name in cases)


class _Chosen(NamedTuple):
    """What is analysed."""

    file: DriveFile
    cases: dict[str, Drive]
    engine: Engine
    torque: float | None


def _solve_and_write(
    chosen: _Chosen, angles: FloatArray, pressure_angles: FloatArray | None, out: Path, *, figures: bool
) -> int:
    from ltca.analysis.engines import describe_engine
    from ltca.analysis.results import build_dataset
    from ltca.analysis.summary import summarise
    from ltca.output.files import whole_file, write_json
    from ltca.output.netcdf import write_netcdf

    file, cases, engine, torque = chosen
    analyses, failures = _analyse(cases, angles, torque, engine, "cases")
    cases = {name: analysis.drive for name, analysis in analyses.items()}
    shown: dict[str, LoadedAnalysis] = {}
    also: dict[str, ConvergenceError] = {}
    if pressure_angles is not None:
        shown, also = _analyse(cases, pressure_angles, torque, engine, "pressure fields")
    if also:  # a field of a position without an answer is no field
        raise next(iter(also.values()))
    summaries = {name: summarise(analysis) for name, analysis in analyses.items()}
    dataset = build_dataset(file.name, analyses, file.text)
    with whole_file(out / "results.nc") as part:
        write_netcdf(dataset, part)
    write_json(out / "summary.json", {"drive": file.name, "cases": summaries})
    files, fields = ["results.nc", "summary.json"], None
    if pressure_angles is not None:
        from ltca.analysis.pressure_fields import build_pressure_dataset

        fields = build_pressure_dataset(file.name, shown, drive_file=file.text)
        packed = {name: {"zlib": True} for name in fields if str(name).endswith(("_pressure", "_outer", "_inner"))}
        with whole_file(out / "pressure.nc") as part:
            write_netcdf(fields, part, packed)
        files.append("pressure.nc")
    print(f"{file.name}: {describe_engine(engine)}, {_many(angles)}")
    yields = any(drive.crank.support or drive.pin_wheel.support_stiffness for drive in cases.values())
    print(_verdicts(analyses, summaries, file.limits))
    print(_table(summaries, {name: drive.load_words(torque) for name, drive in cases.items()}, bool(yields)))
    if any(one.pressures.rigid_shaft_pins and one.drive.pin_shaft is not None for one in analyses.values()):
        print(RIGID_SHAFT_PINS)
    print(_sampling(analyses, summaries, angles))
    print("results: " + ", ".join(str(out / name) for name in files))
    for name, failure in failures.items():
        left = 2 * angles.size
        if failure.partial is not None:
            left = sum(int((~known).sum()) for known in (failure.partial.balanced, failure.partial.balanced_light))
        told = f"case {name}: partial: {left} of {2 * angles.size} states have no answer"
        print(f"cyclo: error: {told}: {failure}", file=sys.stderr)
    if figures:
        _draw(dataset, fields, cases, out / "figures")
    return ConvergenceError.exit_status if failures else 0


def _verdicts(
    analyses: dict[str, LoadedAnalysis], summaries: dict[str, dict[str, float | None]], limits: dict[str, Limits]
) -> str:
    """The checks that have a limit, case by case; nothing of cases without an answer everywhere."""
    from ltca.analysis.verdict.proportions import odd_proportions
    from ltca.analysis.verdict.values import judge_analysis
    from ltca.drive.members.verdict_words import verdict_table

    told = []
    for name, analysis in analyses.items():
        if analysis.is_complete:
            checks = judge_analysis(analysis, summaries[name], limits[name], lives=False)
            told += [f"verdict on {name}" if len(analyses) > 1 else "verdict", verdict_table(checks, limited=True)]
            told += [f"  note: {note}" for note in odd_proportions(analysis.as_written)]
    return "\n".join(
        [*told, "what drives it and would mend it: cyclo check"] if told else ["no verdict on partial results"]
    )


def _engine(arguments: argparse.Namespace) -> Engine:
    from ltca.commands.compliance_arguments import compliance_of
    from ltca.errors import DriveError

    if arguments.pressure is not None and arguments.compliance != "half-space":
        raise DriveError(
            [f"--pressure: fields over the width need --compliance half-space, not {arguments.compliance}"]
        )
    return compliance_of(arguments)


def _analyse(
    cases: dict[str, Drive], angles: FloatArray, torque: float | None, engine: Engine, title: str
) -> tuple[dict[str, LoadedAnalysis], dict[str, ConvergenceError]]:
    """Analyses of all cases; those without an answer at some positions, and why."""
    from ltca.analysis.loaded_analysis import analyse
    from ltca.output.progress import progress

    analyses, failures = {}, {}
    with progress(title, len(cases)) as advance:
        for name, drive in cases.items():
            try:
                analyses[name] = analyse(drive, angles, torque, engine)
            except ConvergenceError as error:
                failures[name] = error
                if error.partial is not None:
                    analyses[name] = error.partial
            advance(name)
    if not analyses:
        raise next(iter(failures.values()))
    return analyses, failures


def _draw(dataset: Dataset, fields: Dataset | None, cases: dict[str, Drive], folder: Path) -> None:
    from ltca.figures.run_figures import figure_names, write_figures
    from ltca.output.progress import progress

    names = figure_names(dataset.sizes["disc"], dataset.sizes["hole"], dataset.sizes["crank"])
    with progress("figures", len(names)) as advance:
        for path in write_figures(dataset, folder):
            advance(path.name)
    print(f"figures: {folder} ({len(names)} as SVG and PNG)")
    if fields is None:
        return
    from ltca.figures.pressure_figures import write_pressure_figures

    with progress("pressure figures", 3 + len(cases)) as advance:
        for path in write_pressure_figures(dataset, fields, next(iter(cases.values())), folder):
            advance(path.name)


def _crank_angles(arguments: argparse.Namespace) -> FloatArray:
    import numpy as np

    from ltca.geometry.placement import position_angles

    if arguments.angles is not None:
        return np.array(arguments.angles)
    return position_angles(DEFAULT_POSITIONS if arguments.positions is None else arguments.positions)


def _pressure_angles(arguments: argparse.Namespace) -> FloatArray | None:
    import numpy as np

    return None if arguments.pressure is None else np.array(arguments.pressure or [0.0])


ROWS = (
    ("mean bearing load", "mean_bearing_load_N", "N", "{:.1f}"),
    ("  radial", "mean_radial_bearing_load_N", "N", "{:.1f}"),
    ("  tangential", "mean_tangential_bearing_load_N", "N", "{:.1f}"),
    ("  tangential, peak to peak", "ptp_tangential_bearing_load_N", "N", "{:.1f}"),
    ("largest bearing load", "max_bearing_load_N", "N", "{:.1f}"),
    ("largest pin load", "max_pin_load_N", "N", "{:.1f}"),
    ("largest pin pressure, mid-width", "max_pin_pressure_mid_MPa", "MPa", "{:.1f}"),
    ("  anywhere (end cell a hundredth)", "max_pin_pressure_max_MPa", "MPa", "{:.1f}"),
    ("largest roller load", "max_roller_load_N", "N", "{:.1f}"),
    ("largest roller pressure, mid-width", "max_roller_pressure_mid_MPa", "MPa", "{:.1f}"),
    ("  anywhere (end cell a hundredth)", "max_roller_pressure_max_MPa", "MPa", "{:.1f}"),
    ("largest pin-shaft load", "max_pin_shaft_load_N", "N", "{:.1f}"),
    ("largest pin-shaft pressure, mid-width", "max_pin_shaft_pressure_mid_MPa", "MPa", "{:.1f}"),
    ("  anywhere (end cell a hundredth)", "max_pin_shaft_pressure_max_MPa", "MPa", "{:.1f}"),
    ("pin-shaft loaded range", "pin_shaft_loaded_range_deg", "°", "{:.1f}"),
    ("loaded wheel pins, mean", "mean_loaded_pins", "", "{:.2f}"),
    ("loaded rollers, mean", "mean_loaded_rollers", "", "{:.2f}"),
    ("loaded pin-shaft pins, mean", "mean_loaded_pin_shaft_pins", "", "{:.2f}"),
    ("transmission error, peak to peak", "ptp_transmission_error_arcsec", "″", "{:.2f}"),
    ("  at the light torque", "ptp_transmission_error_light_arcsec", "″", "{:.2f}"),
    ("backlash at the disc", "backlash_disc_arcmin", "′", "{:z.2f}"),
    ("backlash at the wheel", "backlash_wheel_arcmin", "′", "{:z.2f}"),
)
RESIDUAL_PART = "residual_part"
RESIDUAL_ROWS = (
    ("largest residual", "max_equilibrium_residual_N", "N", "{:.1e}"),
    ("  as a part of the largest bearing load", RESIDUAL_PART, "", "{:.1e}"),
)
HEAD = 44
"""Width of the names of the rows."""


RIGID_SHAFT_PINS = (
    "pin-shaft pressures: shaft pins are rigid here, their material is not used; of elastic ones see "
    "--no-hole-near-field"
)
OUTPUT_ROWS = (("  at the output", "backlash_output_arcmin", "′", "{:z.2f}"),)
INTERFERENCE_ROWS = (("  pins and flank overlap at rest by", "interference_mm", "mm", "{:.4f}"),)
SEAT_ROWS = (
    ("largest pressure in wheel-pin seats", "max_pin_seat_pressure_MPa", "MPa", "{:.1f}"),
    ("largest pressure in shaft-pin sleeves", "max_hole_seat_pressure_MPa", "MPa", "{:.1f}"),
    ("largest deflection of a wheel pin", "max_pin_deflection_mm", "mm", "{:.4f}"),
    ("largest deflection of a shaft pin", "max_shaft_pin_deflection_mm", "mm", "{:.4f}"),
)
FRICTION_ROWS = (
    ("efficiency, mean", "mean_efficiency", "", "{:.4f}"),
    ("  with the motion reversed", "mean_efficiency_back", "", "{:.4f}"),
    ("  moves back (1) or locks itself (0)", "moves_back", "", "{:.0f}"),
    ("torque of the cranks, mean", "mean_crank_torque_Nmm", "N·mm", "{:.1f}"),
    ("power lost", "power_loss_W", "W", "{:.3g}"),
    ("  flank on wheel pins", "power_loss_pin_W", "W", "{:.3g}"),
    ("  seats of pins and sleeves", "power_loss_seat_W", "W", "{:.3g}"),
    ("  holes on shaft pins", "power_loss_hole_W", "W", "{:.3g}"),
    ("  rolling of the crank bearings", "power_loss_roller_W", "W", "{:.3g}"),
    ("  bearings of cranks and wheel", "power_loss_support_bearing_W", "W", "{:.3g}"),
    ("  seals and oil", "power_loss_no_load_W", "W", "{:.3g}"),
    ("largest p·v at the flank", "max_pin_pv_MPa_m_s", "MPa m/s", "{:.4g}"),
    ("largest p·v at the holes", "max_pin_shaft_pv_MPa_m_s", "MPa m/s", "{:.4g}"),
)
WALL_ROWS = (
    ("largest stress along lobe roots", "max_root_stress_MPa", "MPa", "{:.1f}"),
    ("  along hole walls", "max_hole_stress_MPa", "MPa", "{:.1f}"),
    ("  along the bore", "max_bore_stress_MPa", "MPa", "{:.1f}"),
)


def _table(summaries: dict[str, dict[str, float | None]], loads: dict[str, str], yields: bool) -> str:
    from ltca.analysis.summary import refined_value

    summaries = {name: {**case, RESIDUAL_PART: _residual_part(case)} for name, case in summaries.items()}
    width = max(10, *(len(word) + 2 for word in (*summaries, *loads.values())))
    lines = [
        f"{'case':<{HEAD}}" + "".join(f"{name:>{width}}" for name in summaries),
        f"{'torque, direction of the crank':<{HEAD}}" + "".join(f"{load:>{width}}" for load in loads.values()),
    ]
    walls = WALL_ROWS if all(key in case for case in summaries.values() for _, key, _, _ in WALL_ROWS) else ()
    shares = (*_share_rows(summaries), *_compliance_rows(summaries, yields))
    output = (
        OUTPUT_ROWS
        if any(row["backlash_output_arcmin"] != row["backlash_wheel_arcmin"] for row in summaries.values())
        else ()
    )
    pressed = INTERFERENCE_ROWS if any(case["interference_mm"] for case in summaries.values()) else ()
    seats = [
        row for row in (*SEAT_ROWS, *FRICTION_ROWS) if any(case.get(row[1]) is not None for case in summaries.values())
    ]
    for title, key, unit, form in (*ROWS, *output, *seats, *shares, *RESIDUAL_ROWS, *pressed, *walls):
        head = f"{title}{f' [{unit}]' if unit else ''}"
        values = [refined_value(case, key) if key in case else None for case in summaries.values()]
        lines.append(f"{head:<{HEAD}}" + "".join(f"{'–' if v is None else form.format(v):>{width}}" for v in values))
    return "\n".join(lines)


def _residual_part(case: Mapping[str, float | None]) -> float | None:
    """What the residual is against: very stiff supports leave round-off of tenths of a newton."""
    residual, load = case["max_equilibrium_residual_N"], case["max_bearing_load_N"]
    return residual / load if residual is not None and load else None


def _share_rows(summaries: dict[str, dict[str, float | None]]) -> Iterator[tuple[str, str, str, str]]:
    """Parts of the torque, of several discs."""
    discs = sum(key.startswith("mean_torque_share_disc_") for key in next(iter(summaries.values())))
    for disc in range(discs if discs > 1 else 0):
        yield f"part of the torque on disc {disc}, mean", f"mean_torque_share_disc_{disc}", "", "{:.4f}"
        yield "  largest at the positions", f"max_torque_share_disc_{disc}", "", "{:.4f}"


def _compliance_rows(
    summaries: dict[str, dict[str, float | None]], yields: bool
) -> Iterator[tuple[str, str, str, str]]:
    """What yields how much, where more does than contacts of a central crank; torques of several cranks."""
    from ltca.equilibrium.compliance_shares import PARTS

    first = next(iter(summaries.values()))
    cranks = sum(key.startswith("mean_torque_crank_") for key in first)
    for crank in range(cranks if cranks > 1 else 0):
        yield f"torque of crank {crank}, mean", f"mean_torque_crank_{crank}_Nmm", "N mm", "{:.0f}"
        yield "  largest bearing load at the positions", f"max_bearing_load_crank_{crank}_N", "N", "{:.1f}"
    for crank in range(cranks):
        key = f"max_crank_deflection_crank_{crank}_mm"
        if any(key in case for case in summaries.values()):
            of = f" of crank {crank}" if cranks > 1 else " of the crank"
            yield f"largest deflection{of}", key, "mm", "{:.4f}"
    told = [part for part in PARTS if any(case[f"compliance_share_{part}"] for case in summaries.values())]
    for number, part in enumerate(told if yields or cranks > 1 else ()):
        title = "part of the compliance: " if number == 0 else "  "
        yield title + part.replace("_", " "), f"compliance_share_{part}", "", "{:.4f}"


def _many(angles: FloatArray) -> str:
    return f"{angles.size} positions" if angles.size > 1 else f"1 position, φ_C = {angles[0]:g} rad"


def _sampling(
    analyses: dict[str, LoadedAnalysis], summaries: dict[str, dict[str, float | None]], angles: FloatArray
) -> str:
    """What the values stand for: which positions, whether they see the mesh, and what to know of drive and answer."""
    from ltca.analysis.extremes import is_full_turn, sampling_warning

    many = _many(angles)
    whole = is_full_turn(angles)
    lines = [f"means over {many}; extremes over the turn, refined between them" if whole else f"values of {many}"]
    warnings = {
        warning
        for analysis in analyses.values()
        for warning in (sampling_warning(analysis.drive, angles), *analysis.warnings)
        if warning is not None
    }
    for name, case in summaries.items():
        if whole and analyses[name].is_complete and case["refined_max_pin_load_N"] is None:
            warnings.add(f"extremes of case {name} are those of its positions: one between them has no answer")
    return "\n".join([*lines, *(f"warning: {text}" for text in sorted(warnings))])
