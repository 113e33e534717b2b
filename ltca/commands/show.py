"""``cyclo show``: what a drive is, before and beside its analysis."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.reading.arguments import (
    add_angle_argument,
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    default_folder,
)

if TYPE_CHECKING:
    from ltca.analysis.loaded_analysis import LoadedAnalysis
    from ltca.drive.parts import Drive
    from ltca.geometry.pairs import FloatArray

SUMMARY = "derived geometry, backlash, checks and a picture with contact normals and loads"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case to show, repeatable; default the first")
    add_angle_argument(parser)
    add_out_argument(parser, "show", "folder for the picture")


def execute(arguments: argparse.Namespace) -> int:
    """Print the drive and write its picture."""
    from glob import escape

    import numpy as np

    from ltca.output.run_folder import claimed_folder
    from ltca.reading.drive_file import load_drive

    angle = arguments.angle
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case or [next(iter(file.cases))])
    out = arguments.out or default_folder(file.name, "show")
    print(f"{file.name} ({file.source}): cases {', '.join(file.cases)}; all checks passed")
    with claimed_folder(out, "show", writes=[f"drive_{escape(name)}.png" for name in cases], adding=True):
        _show(cases, np.array([angle]), out)
    return 0


def _show(cases: dict[str, Drive], angle: FloatArray, out: Path) -> None:
    from ltca.analysis.engines import describe_engine
    from ltca.analysis.loaded_analysis import analyse
    from ltca.figures.drive_picture import draw_drive

    for name, drive in cases.items():
        print(f"\ncase {name}")
        analysis = analyse(drive, angle)
        for warning in analysis.warnings:
            print(f"  warning: {warning}")
        for title, value in _properties(drive):
            print(f"  {title:<48}{value}")
        print(f"  at φ_C = {angle[0]:g} rad, {drive.load_words()}, {describe_engine(analysis.engine)}")
        for title, value in _loads(analysis):
            print(f"    {title:<46}{value}")
        path = out / f"drive_{name}.png"
        draw_drive(drive, analysis, 0, path)
        print(f"  picture: {path}")


def _properties(drive: Drive) -> list[tuple[str, str]]:
    import numpy as np

    from ltca.drive.units import ARCMIN
    from ltca.geometry.first_contact import backlash
    from ltca.geometry.pairs import DISC_ROTATION, WHEEL_ANGLE, ContactGeometry
    from ltca.geometry.placement import position_angles

    geometry = ContactGeometry.of_drive(drive)
    profile, place = geometry.profile, geometry.placement
    parameter = np.linspace(0.0, 2.0 * np.pi / drive.reduction_ratio, 2001)
    curvature = profile.curvature(parameter)
    locus = profile.locus_curvature(parameter)
    gap = -geometry.flank(position_angles(90), np.zeros((90, 4))).approach
    disc, wheel = (backlash(geometry, position_angles(360), c) * ARCMIN for c in (DISC_ROTATION, WHEEL_ANGLE))
    e = place.eccentricity
    bearing = drive.crank_bearing
    pitch = bearing.inner_race_radius + bearing.roller_radius
    between_rollers = 2.0 * (pitch * np.sin(np.pi / bearing.number_of_rollers) - bearing.roller_radius)
    roller_play = drive.bore_radius - bearing.inner_race_radius - 2.0 * bearing.roller_radius
    tangential = drive.load.torque * drive.disc.torque_share / (drive.reduction_ratio * e)
    hole_wall = profile.root_radius - drive.pin_shaft.pin_circle_radius - drive.hole_radius
    bore_wall = drive.pin_shaft.pin_circle_radius - drive.hole_radius - drive.bore_radius
    return [
        ("reduction ratio u (pin shaft fixed)", f"{drive.reduction_ratio:g}"),
        ("e z_P/R_C", f"{e * drive.reduction_ratio / drive.pin_wheel.pin_circle_radius:.4f} (must be below 1)"),
        ("disc radius at root, tip", f"{profile.root_radius:.4f}, {profile.tip_radius:.4f} mm"),
        ("smallest flank radius, convex", f"{1.0 / curvature.max():.4f} mm"),
        ("smallest flank radius, concave", f"{-1.0 / curvature.min():.4f} mm"),
        ("pin radius at which the flank is undercut", f"{1.0 / locus.max() - drive.disc.equidistant_offset:.4f} mm"),
        ("gap between pins and flank, nominal position", f"{gap.min():.4f} … {gap.max():.4f} mm"),
        ("backlash at the disc, wheel held", f"{disc.mean():.2f}′ ({disc.min():.2f}′ … {disc.max():.2f}′)"),
        ("backlash at the wheel, disc held", f"{wheel.mean():.2f}′ ({wheel.min():.2f}′ … {wheel.max():.2f}′)"),
        ("bore radius with clearance", f"{drive.bore_radius:.4f} mm"),
        ("play of a roller between the races", f"{roller_play:.4f} mm"),
        ("gap between neighbouring rollers", f"{between_rollers:.4f} mm"),
        ("hole radius with clearance", f"{drive.hole_radius:.4f} mm"),
        ("wall between hole and root circle, bore", f"{hole_wall:.4f}, {bore_wall:.4f} mm"),
        ("mean tangential bearing load T/(u e)", f"{tangential:.1f} N"),
    ]  # fmt: skip


def _loads(analysis: LoadedAnalysis) -> list[tuple[str, str]]:
    import numpy as np

    from ltca.drive.units import ARCMIN

    contacts = analysis.full.response
    x, y, rotation, wheel_angle = analysis.full.pose[0]
    radial, tangential = analysis.bearing_radial[0], analysis.bearing_tangential[0]

    def loaded(load: FloatArray) -> str:
        values = load[0]
        numbers = np.nonzero(values > 1e-3 * values.max())[0]
        return ", ".join(f"{n}: {values[n]:.0f} N" for n in numbers)

    return [
        ("wheel pins", loaded(contacts.pin_load)),
        ("rollers, on the bore", loaded(contacts.rollers.outer_load)),
        ("shaft pins", loaded(contacts.hole_load)),
        ("bearing load on the disc, radial, tangential", f"{radial:.1f}, {tangential:.1f} N"),
        ("disc displacement x, y", f"{1e3 * x:.2f}, {1e3 * y:.2f} µm"),
        ("disc rotation, wheel angle", f"{rotation * ARCMIN:.4f}′, {wheel_angle * ARCMIN:.4f}′"),
    ]  # fmt: skip
