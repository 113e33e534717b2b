"""``cyclo curves``: torque against wind-up, orders of the transmission error, bearing life, pressure safety."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltca.drive.parts import Drive

SUMMARY = "torque curve and lost motion, orders of the transmission error, bearing life, pressure safety"
POSITIONS_PER_TURN = 192
ANGLES = 4
HARMONICS = 7


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("drive", metavar="DRIVE", help="drive file (TOML), or 'paper' for the shipped drive")
    parser.add_argument("--case", metavar="NAME", help="case; default the first")
    parser.add_argument("--turns", metavar="N", type=int, help="crank turns behind the orders; default z_P")
    parser.add_argument(
        "--pressure-limit", metavar="P", default="1500", help="permissible flank pressure in MPa; default 1500"
    )
    parser.add_argument("--speed", metavar="N", type=float, help="crank speed in turns a minute, for the life in hours")
    parser.add_argument("--load-rating", metavar="C", help="dynamic load rating of the crank bearing in N; by ISO 281")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder for the results; default out/<drive>_curves")
    parser.add_argument("--no-figures", action="store_true", help="write curves.json only")


def execute(arguments: argparse.Namespace) -> int:
    """Solve, write curves.json and the figures, print what they say."""
    from ltca.drive.units import parse_quantity
    from ltca.errors import DriveError
    from ltca.output.files import write_json
    from ltca.reading.drive_file import load_drive

    limit = parse_quantity(arguments.pressure_limit, "MPa", "--pressure-limit")
    if limit <= 0.0:
        raise DriveError([f"--pressure-limit = {limit:g}: must be greater than 0 MPa"])
    rating = None if arguments.load_rating is None else parse_quantity(arguments.load_rating, "N", "--load-rating")
    if rating is not None and rating <= 0.0:
        raise DriveError([f"--load-rating = {rating:g}: must be greater than 0 N"])
    if arguments.speed is not None and not arguments.speed > 0.0:
        raise DriveError([f"--speed = {arguments.speed:g}: must be greater than 0 turns a minute"])
    file = load_drive(arguments.drive)
    case = arguments.case or next(iter(file.cases))
    drive = file.select([case])[case]
    turns = drive.pin_wheel.number_of_pins if arguments.turns is None else arguments.turns
    if not 1 <= turns <= 1000:
        raise DriveError([f"--turns = {turns}: must be from 1 to 1000"])
    out = arguments.out or Path("out") / f"{file.name}_curves"
    content = _solve(drive, f"{file.name} {case}", turns, limit, rating, arguments, out)
    write_json(out / "curves.json", content)
    print(f"results: {out / 'curves.json'}")
    return 0


def _solve(
    drive: Drive,
    title: str,
    turns: int,
    limit: float,
    rating: float | None,
    arguments: argparse.Namespace,
    out: Path,
) -> dict[str, Any]:
    from dataclasses import replace

    import numpy as np

    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.pressure_safety import pressure_safety
    from ltca.analysis.rating_life import RollerBearing, rating_life
    from ltca.analysis.torque_curve import torque_curve
    from ltca.analysis.transmission_error_orders import fit_orders, known_orders
    from ltca.drive.units import ARCMIN, ARCSEC
    from ltca.figures import curve_figures as figures

    mesh = 2.0 * np.pi / drive.disc.number_of_teeth
    curve = torque_curve(drive, mesh * np.arange(ANGLES) / ANGLES)
    angle = 2.0 * np.pi * np.arange(turns * POSITIONS_PER_TURN) / POSITIONS_PER_TURN
    analysis = analyse(drive, angle)
    try:
        spectrum = fit_orders(angle, analysis.full.pose[:, 3], known_orders(drive, harmonics=HARMONICS))
    except ValueError as error:
        from ltca.errors import DriveError

        raise DriveError([f"--turns = {turns}: {error}"]) from error
    pressure = analysis.pressures.pins.mid
    safety = pressure_safety(pressure, limit)
    part = drive.crank_bearing
    bearing = RollerBearing(
        rollers=part.number_of_rollers,
        roller_diameter=2.0 * part.roller_radius,
        roller_length=part.roller_length,
        pitch_diameter=part.inner_race_radius + part.outer_race_radius,
    )
    rollers = analysis.full.response.rollers
    life = rating_life(
        bearing,
        rollers.inner_load,
        rollers.outer_load,
        relieved=not part.roller_profile.is_cylinder,
        dynamic_load_rating=rating,
    )
    # The crank turns against the disc, which does not turn: every turn of the crank is one of the bearing.
    hours = None if arguments.speed is None else life.life * 1e6 / (60.0 * arguments.speed)

    def per_arcmin(stiffness: Any) -> Any:
        return stiffness / ARCMIN / 1e3

    print(f"{title}: torque curve at {ANGLES} crank angles over one mesh")
    print(f"  backlash at the wheel, disc floating      {_range(curve.backlash * ARCMIN)}′")
    print(f"  lost motion at ±3 % of the rated torque   {_range(curve.lost_motion * ARCMIN)}′")
    print(f"  torsional stiffness, 50 … 100 %           {_range(per_arcmin(curve.stiffness))} N m/′")
    print(f"orders of the transmission error over {turns} turns, {angle.size} positions")
    order = np.argsort(-spectrum.amplitude)
    for number in order[:8]:
        entry = spectrum.orders[number]
        print(f"  {entry.value:>9.4f}  {entry.name:<32}{spectrum.amplitude[number] * ARCSEC:>9.4f}″")
    print(f"  unexplained, rms{'':<29}{spectrum.residual * ARCSEC:>9.4f}″")
    print("rating life of the crank bearing (load stands still to the inner race)")
    print(f"  C {life.dynamic_load_rating:.0f} N, P {life.equivalent_load:.0f} N, L10r {life.life:.1f} million turns")
    if hours is not None:
        print(f"  {hours:.0f} h at {arguments.speed:g} turns a minute")
    print(f"flank pressure {safety.largest:.1f} MPa, safety {safety.safety:.3f} against {limit:g} MPa")
    if not arguments.no_figures:
        folder = out / "figures"
        first = safety.position - safety.position % POSITIONS_PER_TURN
        turn = slice(first, first + POSITIONS_PER_TURN)
        paths = [
            figures.draw_torque_curve(curve, title, folder / "torque_curve"),
            figures.draw_spectrum(spectrum, title, folder / "transmission_error_orders"),
            # The turn that holds the largest pressure of all: what is drawn is what is printed.
            figures.draw_pressure(
                angle[turn], pressure[turn], replace(safety, position=safety.position - turn.start), title,
                folder / "flank_pressure",
            ),
        ]  # fmt: skip
        print(f"figures: {folder} ({len(paths)} as SVG and PNG)")
    return {
        "drive": title,
        "torque_curve": {
            "crank_angle_rad": curve.crank_angle.tolist(),
            "torque_N_mm": curve.torque.tolist(),
            "wheel_angle_rad": curve.wheel_angle.tolist(),
            "backlash_rad": curve.backlash.tolist(),
            "lost_motion_rad": curve.lost_motion.tolist(),
            "stiffness_N_mm_per_rad": curve.stiffness.tolist(),
        },
        "transmission_error_orders": {
            "turns": turns,
            "orders": [
                {"order": entry.value, "name": entry.name, "amplitude_rad": float(size), "phase_rad": float(phase)}
                for entry, size, phase in zip(spectrum.orders, spectrum.amplitude, spectrum.phase, strict=True)
            ],
            "residual_rms_rad": spectrum.residual,
        },
        "bearing_life": {
            "million_turns": life.life,
            "hours": hours,
            "dynamic_load_rating_N": life.dynamic_load_rating,
            "equivalent_load_N": life.equivalent_load,
            "inner_roller_load_N": life.inner_load,
            "outer_roller_load_N": life.outer_load,
        },
        "pressure_safety": {
            "limit_MPa": limit,
            "largest_MPa": safety.largest,
            "safety": safety.safety,
            "load_factor": safety.load_factor,
            "pin": safety.pin,
        },
    }


def _range(values: Any) -> str:
    return f"{values.min():.4g} … {values.max():.4g}"
