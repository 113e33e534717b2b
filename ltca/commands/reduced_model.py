"""``cyclo export --for``: a reduced model of a drive for simulators of robots and machines."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    check_compliance,
    compliance_of,
    find_coefficients_of,
    settle_compliance,
)
from ltca.errors import DriveError
from ltca.reading.arguments import default_folder, quantity_argument, refuse_impossible_torques, tell_unit_mistakes

SIMULATORS = ("json", "mujoco", "urdf", "modelica", "fmu")
ONLY_SIMULATORS = ("compliance", "quick", "coefficients", "bodies", "no_hole_near_field", "speed")
"""Arguments of `add_simulator_arguments`, none of which is given by default."""


def add_simulator_arguments(parser: argparse.ArgumentParser, which: argparse._MutuallyExclusiveGroup) -> None:
    """Add the simulator to the options of which one is given, and how bodies yield in what its model is made of."""
    which.add_argument(
        "--for",
        dest="simulator",
        choices=SIMULATORS,
        help="in place of --format: a reduced model of the drive (wind-up with play and hysteresis, friction, transmission "
        "error, inertias, limits) as lookup tables, MJCF, URDF, Modelica package or functional mock-up unit",
    )
    parser.add_argument(
        "--speed",
        metavar="N",
        type=quantity_argument("--speed", "rpm", gt=0.0),
        help="with --for: largest speed of the input in turns a minute (or a text such as '3000 rpm'), as if it were load.speed "
        "of the drive file: the limit of the joint, which URDF must have; not with [[duty]], whose largest speed counts",
    )
    add_compliance_arguments(parser)


def refuse_simulator_options(arguments: argparse.Namespace) -> None:
    """Refuse what is said of a simulator's model where parts are written as they are made."""
    for name in ONLY_SIMULATORS:
        if getattr(arguments, name):
            raise DriveError([f"--{name.replace('_', '-')}: has no effect with --format, only with --for"])


def export_model(arguments: argparse.Namespace) -> int:
    """Reduce a case and write it in the format of a simulator; return the exit status."""
    from glob import escape

    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    name = next(iter(file.select([arguments.case] if arguments.case else None)))
    cases = file.select_warm([name])
    settle_compliance(arguments, cases.values())
    refuse_impossible_torques([file.cases[name]])
    tell_unit_mistakes([file.cases[name]])
    out = arguments.out or default_folder(file.name, "export")
    require_folder(out)
    from ltca.analysis.engines import lending_between
    from ltca.commands.actions.reduced_model import check_drive, reduce_and_write
    from ltca.export.simulators.files import CALLBACK, LAW, file_names, model_name

    own, drive = model_name(file.name, name, file.cases), file.cases[name]
    if arguments.speed is not None:
        if drive.duty:
            raise DriveError(
                [f"--speed {arguments.speed:g} rpm: has no effect beside [[duty]], whose largest speed counts"]
            )
        drive = drive.with_fields({"load.speed": arguments.speed})
    check_drive(arguments.simulator, drive)
    engine = lending_between(file.cases.values(), compliance_of(arguments, cases.values()))
    names = file_names(arguments.simulator, own)
    writes = [escape(one) for one in names]
    # Callback and law are those of every drive.
    origins = {one: f"drive {file.name}, case {name}" for one in names if one not in (CALLBACK, LAW)}
    with claimed_folder(out, "export", writes=writes, adding=True, origins=origins):
        find_coefficients_of(cases, engine, arguments)
        return reduce_and_write(arguments.simulator, drive, engine, own, out)
