"""`ltca.check`: the verdict of ``cyclo check`` on one drive."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ltca.analysis.engines import Engine, lending_between
from ltca.analysis.verdict.drive_check import DriveCheck, check_drive
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.members.limits import Limit, Limits, parse_limits
from ltca.drive.parts import Drive
from ltca.errors import DriveError, shortened
from ltca.front.arguments import counted, engine_given, require_drive, torque_given
from ltca.output.threads import on_one_thread
from ltca.reading.arguments import refuse_impossible_torques
from ltca.reading.drive_file import DriveFile, listed

MOST_POSITIONS = 100_000


@on_one_thread
def check(
    drive: Drive | DriveFile,
    positions: int = 360,
    *,
    case: str | None = None,
    limits: Mapping[str, Any] | None = None,
    torque: float | str | None = None,
    advice: bool = True,
    compliance: str | Engine | None = None,
    coefficients: InfluenceCoefficients | Path | str | None = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> DriveCheck:
    """Judge a drive: value, limit and safety of every check, what drives it and what would mend it.

    Parameters
    ----------
    drive : DriveFile or Drive
        A drive file, whose ``[limits]`` count, or one drive alone, without limits but those given here.
    positions : int
        Crank angles 2πk/N of a turn.
    case : str, optional
        Which case of the file, where it has several.
    limits : mapping of str to Limit, number or str, optional
        Bounds by the names of ``[limits]``, ``{"max_pin_pressure_mid": "1.4 GPa"}`` or ``file.limits["CS-1"]``; they replace
        those of the file with the same name. Materials, geometry and theory have limits in any case.
    torque : float or str, optional
        Output torque, N·mm, or a text with a unit; the drive's own by default.
    advice : bool
        Whether to tell what drives each value, which takes several times as long.
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
    DriveCheck
        ``checks``, ``passes``, ``failed``, ``drivers``, ``notes``; printed as a table.

    Raises
    ------
    DriveError
        When a name, a number or their combination makes no sense.
    ConvergenceError
        When a position does not balance.

    Examples
    --------
    >>> import ltca
    >>> file = ltca.load_drive("paper")
    >>> found = ltca.check(file, 28, case="CS-1", limits={"max_pin_pressure_mid": "900 MPa"}, advice=False)
    >>> pressure = found["pin_pressure_mid"]
    >>> print(f"{pressure.verdict}: safety {pressure.safety:.2f}, {pressure.value.part}")
    fail: safety 0.65, wheel pin 5
    """
    judged, known = drive_and_limits(drive, case, limits)
    if not isinstance(advice, bool):
        raise DriveError([f"advice = {shortened(advice)}: must be true or false"])
    asked = torque_given(judged, torque)
    refuse_impossible_torques([judged], asked, in_parts=True)
    engine = engine_given(judged, compliance, coefficients=coefficients, hole_near_field=hole_near_field, bodies=bodies)
    return check_drive(
        judged,
        known,
        lending_between(drive.cases.values(), engine) if isinstance(drive, DriveFile) else engine,
        positions=counted(positions, "positions", 2, MOST_POSITIONS),
        torque=asked,
        advice=advice,
    )


def drive_and_limits(
    drive: Drive | DriveFile, case: str | None, limits: Mapping[str, Any] | None
) -> tuple[Drive, Limits]:
    """Return the drive that is judged and its limits: those of its file, replaced by own ones of the same name."""
    if not isinstance(drive, DriveFile):
        require_drive(drive)
        if case is not None:
            raise DriveError([f"case = {shortened(case)}: has no effect with one Drive; a drive file has cases"])
        return drive, _limits(limits)
    if case is None and len(drive.cases) > 1:
        raise DriveError([f"case: must be given, one of {listed(drive.cases)}"], drive.source)
    ((name, one),) = drive.select(None if case is None else [case]).items()
    return one, {**drive.limits[name], **_limits(limits)}


def _limits(given: Mapping[str, Any] | None) -> Limits:
    """Limits by their keys: of a file, or values as a file has them."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise DriveError([f"limits = {shortened(given)}: must be limits by name, as max_pin_pressure_mid"])
    table = {
        key: {"value": limit.value, "source": limit.source} if isinstance(limit, Limit) and limit.key == key else limit
        for key, limit in given.items()
    }
    problems: list[str] = []
    found = parse_limits(table, problems)
    if problems:
        raise DriveError(problems)
    return found
