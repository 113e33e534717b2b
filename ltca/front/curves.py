"""`ltca.curves`: torque curve, orders, lives and pressure of ``cyclo curves`` on one drive."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ltca.analysis.drive_curves import CurveSettings, DriveCurves, allowed_pressure, require_turns, solve_curves
from ltca.analysis.engines import Engine, lending_between
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import parse_quantity
from ltca.errors import DriveError
from ltca.front.arguments import counted, engine_given
from ltca.front.checks import drive_and_limits
from ltca.output.threads import on_one_thread
from ltca.reading.arguments import refuse_impossible_torques
from ltca.reading.drive_file import DriveFile

MOST_TURNS = 1000


@on_one_thread
def curves(
    drive: Drive | DriveFile,
    turns: int | None = None,
    *,
    case: str | None = None,
    limits: Mapping[str, Any] | None = None,
    pressure_limit: float | str | None = None,
    lost_motion: float | str = 0.03,
    parts: bool = False,
    speed: float | str | None = None,
    load_rating: float | str | None = None,
    compliance: str | Engine | None = None,
    coefficients: InfluenceCoefficients | Path | str | None = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> DriveCurves:
    """Compute torque curve and lost motion, orders of the transmission error, bearing lives and pressure safety.

    Parameters
    ----------
    drive : DriveFile or Drive
        A drive file, whose ``[limits]`` count, or one drive.
    turns : int, optional
        Crank turns behind orders, lives and pressure; as many as there are wheel pins by default, after which everything
        comes again.
    case : str, optional
        Which case of the file, where it has several.
    limits : mapping of str to Limit, number or str, optional
        As for `ltca.check`; of these the flank pressure is judged here.
    pressure_limit : float or str, optional
        Permissible flank pressure, MPa; that of the limits or of the materials by default.
    lost_motion : float or str
        Part of the rated torque at which lost motion is read, 0.03 or ``"3 %"``.
    parts : bool
        Whether the stiffness is told with and without each part that the file describes, too.
    speed : float or str, optional
        Of the crank, turns a minute, for lives in hours: of a central crank against the held member, of several cranks
        against the carrier; by default from ``load.speed``. Not with ``[[duty]]``.
    load_rating : float or str, optional
        Dynamic load rating of the crank bearing, N; by ISO 281 when left out.
    compliance : {"half-space", "fe", "hybrid"} or engine, optional
        How the bodies yield; left out, ``drive.analysis.compliance`` says it: ``hybrid`` unless the drive file has another.
    coefficients : InfluenceCoefficients or path, optional
        Of the bodies, for ``fe`` and ``hybrid``; found in the cache or derived when left out.
    hole_near_field : bool, optional
        Whether hole walls yield like a Hertz contact (``fe`` and ``hybrid``); they do by default.
    bodies : {"plane", "solid"}, optional
        What bodies the coefficients of ``fe`` and ``hybrid`` are of: plane sections, or solids with their ends; left out,
        ``drive.analysis.bodies`` says it.

    Returns
    -------
    DriveCurves
        ``curve``, ``spectrum``, ``lives``, ``safety``, ``parts``; ``content`` has all of it as in ``curves.json``.

    Raises
    ------
    DriveError
        When a name, a number or their combination makes no sense, or turns are too few to tell the orders apart.
    ConvergenceError
        When a position does not balance.

    Examples
    --------
    >>> import ltca
    >>> found = ltca.curves(ltca.load_drive("paper"), 4, case="CS-3", speed="1500 rpm")
    >>> stiffness = found.curve.stiffness.mean() / 1e3 * 3.141592653589793 / 10800.0
    >>> print(f"{stiffness:.0f} N·m/arcmin, order 13: {found.spectrum.of(13.0) * 206264.8:.2f}″")
    212 N·m/arcmin, order 13: 1.25″
    """
    one, known = drive_and_limits(drive, case, limits)
    refuse_impossible_torques([one])
    if one.duty and speed is not None:
        raise DriveError(["speed: has no effect with [[duty]], whose entries have their own"])
    rotations = one.pin_wheel.number_of_pins if turns is None else counted(turns, "turns", 1, MOST_TURNS)
    warm = warm_drive(one)
    if turns is not None:
        require_turns(warm, rotations, "turns")
    pressure = _given(pressure_limit, "MPa", "pressure_limit", gt=0.0)
    settings = CurveSettings(
        pressure=allowed_pressure(warm, known) if pressure is None else pressure,
        load_rating=_given(load_rating, "N", "load_rating", gt=0.0),
        speed=_given(speed, "rpm", "speed", gt=0.0),
        lost_motion=parse_quantity(lost_motion, "dimensionless", "lost_motion", ge=0.001, le=0.5),
        parts=parts,
    )
    engine = engine_given(one, compliance, coefficients=coefficients, hole_near_field=hole_near_field, bodies=bodies)
    if isinstance(drive, DriveFile):
        engine = lending_between(drive.cases.values(), engine)
    return solve_curves(warm, rotations, settings, engine)


def _given(value: float | str | None, unit: str, name: str, *, gt: float) -> float | None:
    return None if value is None else parse_quantity(value, unit, name, gt=gt)
