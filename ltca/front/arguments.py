"""Arguments that the functions of ``import ltca`` share: checked at once, quantities as numbers or texts with a unit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis.engines import Engine, engine_of
from ltca.analysis.loaded_analysis import check_torque
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import parse_quantity
from ltca.errors import DriveError, shortened
from ltca.reading.arguments import torque_argument


def require_drive(drive: Drive) -> None:
    """Refuse what is no drive, a drive file above all."""
    if not isinstance(drive, Drive):
        raise DriveError([f"drive: must be one Drive, not a {type(drive).__name__}; a drive file has them in .cases"])


def counted(number: int, name: str, least: int, most: int) -> int:
    """Return a whole number within its bounds; DriveError for anything else."""
    if isinstance(number, bool) or not isinstance(number, int | np.integer) or not least <= number <= most:
        raise DriveError([f"{name} = {shortened(number)}: must be a whole number from {least} to {most}"])
    return int(number)


def torque_given(drive: Drive, torque: float | str | None) -> float:
    """Return the output torque asked for, a number or a text with a unit, the drive's own for None, N·mm."""
    return check_torque(drive, torque_argument(torque, "torque") if isinstance(torque, str) else torque)


def engine_given(
    drive: Drive,
    compliance: str | Engine | None,
    *,
    method: str | None = None,
    contacts: str | None = None,
    coefficients: InfluenceCoefficients | Path | str | None = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> Engine:
    """Return the engine that the arguments ask for, or else the drive (`engine_of`); coefficients may be the name of a file."""
    given: Any = Path(coefficients) if isinstance(coefficients, str) else coefficients
    return engine_of(
        [drive],
        compliance,
        method=method,
        contacts=contacts,
        coefficients=given,
        hole_near_field=hole_near_field,
        bodies=bodies,
    )


def angles_given(crank_angle: Any) -> Any:
    """Return crank angles as they were given, texts with a unit as numbers in rad; DriveError for other texts.

    Examples
    --------
    >>> angles_given(["90 deg", 0.5])
    [1.5707963267948966, 0.5]
    """
    if isinstance(crank_angle, str):
        return [parse_quantity(crank_angle, "rad", "crank_angle")]
    if isinstance(crank_angle, np.ndarray) and crank_angle.dtype.kind == "U":
        crank_angle = crank_angle.tolist()
    if not isinstance(crank_angle, list | tuple):
        return np.asarray(crank_angle)
    return [parse_quantity(one, "rad", "crank_angle") if isinstance(one, str) else one for one in crank_angle]
