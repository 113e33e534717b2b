"""Full finite-element solutions of chosen positions, each kept as a file of its own as soon as it is there.

A file belongs to a drive in a case (by fingerprint), a crank angle, the settings of the solution and the code that found
it; whatever does not fit, or was damaged, is solved again. So a run that was killed goes on where it stopped and ends with
the same numbers, and no number of older code is compared.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fem.drive.solution_files import summarise

from fem.body.elasticity import PlaneState
from fem.drive.disc_stress import recover_disc_stress
from fem.drive.fields import recover_fields
from fem.drive.solution import FullSolution, solve_drive
from fem.pictures.solution_pictures import draw_solution
from ltca.drive.parts import Drive
from ltca.output.files import write_json
from ltca.output.provenance import code_hash, code_version
from validation.compare.comparison import KindAnswer, PositionAnswer
from validation.compare.disc_stresses import DiscStressAnswer, answer_of_content, stress_content

FORMAT = 3
PICTURES = ("von_mises", "deformed", "contacts")
PICTURE_SIDE = 1200


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """How full solutions are found.

    Attributes
    ----------
    size : float
        Element edge as a multiple of an eighth of each half-width.
    plane : {"strain", "stress"}
        Plane strain or plane stress.
    """

    size: float = 1.0
    plane: PlaneState = "strain"


@dataclass(frozen=True, slots=True, kw_only=True)
class FullPosition:
    """Full solution of one position as it is kept.

    Attributes
    ----------
    case : str
        Case of the drive.
    crank_angle : float
        rad.
    answer : PositionAnswer
        Loads, pressures, pose.
    stress : DiscStressAnswer
        Stress in the disc.
    residual : float
        Largest unbalanced force, N.
    unknowns : int
        Of the solution.
    seconds : float
        Wall time when it was solved: for the account of costs, never for the report.
    pictures : tuple of Path
        von Mises, contacts, deformed; empty when they were not asked for.
    """

    case: str
    crank_angle: float
    answer: PositionAnswer
    stress: DiscStressAnswer
    residual: float
    unknowns: int
    seconds: float
    pictures: tuple[Path, ...]


def solve_position(
    drive: Drive,
    case: str,
    crank_angle: float,
    folder: Path,
    settings: Settings,
    *,
    pictures: bool = False,
    title: str = "",
    progress: Callable[[str], None] | None = None,
) -> FullPosition:
    """Return the full solution of a position, from its file if there is one that fits.

    Parameters
    ----------
    drive : Drive
        In the case.
    case : str
        Its name.
    crank_angle : float
        rad.
    folder : Path
        Where files are kept.
    settings : Settings
        Of the solution.
    pictures : bool
        Whether stress pictures are wanted.
    title : str
        Headline of the pictures.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    FullPosition
        Always as read from the file, so that a resumed run sees the same digits.

    Raises
    ------
    CycloError
        When the solution fails or a file cannot be written.
    """
    key = _key(drive, case, crank_angle, settings)
    path = folder / f"{position_name(drive, case, crank_angle, settings)}.json"
    images = tuple(path.with_suffix("") / f"{name}.png" for name in PICTURES)
    content = _read(path, key)
    if content is None or (pictures and not all(image.exists() for image in images)):
        solution = solve_drive(
            drive, crank_angle, scale=settings.size, state=settings.plane, fine_walls=True, progress=progress
        )
        if pictures:
            _draw(solution, settings, title, path.with_suffix(""))
        if content is None:
            answer = {"summary": summarise(solution), "stress": stress_content(recover_disc_stress(solution))}
            content = {"key": key, "checksum": _checksum(answer), **answer}
            write_json(path, content)
            content = _read(path, key)
    assert content is not None
    summary = content["summary"]
    return FullPosition(
        case=case,
        crank_angle=crank_angle,
        answer=answer_of_summary(summary),
        stress=answer_of_content(content["stress"]),
        residual=float(summary["equilibrium_residual_N"]),
        unknowns=int(summary["dof"]),
        seconds=float(summary["seconds"]),
        pictures=images if pictures else (),
    )


def position_name(drive: Drive, case: str, crank_angle: float, settings: Settings) -> str:
    """Return the name of the file of a position."""
    return f"{drive.fingerprint()}_{case}_{crank_angle:.9f}_{settings.plane}_{settings.size:g}"


def _key(drive: Drive, case: str, crank_angle: float, settings: Settings) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": code_version(),
        "code": code_hash("fem", "ltca"),
        "fingerprint": drive.fingerprint(),
        "case": case,
        "crank_angle_rad": crank_angle,
        "size": settings.size,
        "plane": settings.plane,
    }


def _read(path: Path, key: dict[str, Any]) -> dict[str, Any] | None:
    """Return the content of a file that fits its key; None when it has to be made (again)."""
    try:
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(content, dict) or content.get("key") != key:
        return None
    answer = {name: content.get(name) for name in ("summary", "stress")}
    return content if content.get("checksum") == _checksum(answer) else None


def _checksum(answer: object) -> str:
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()


def _draw(solution: FullSolution, settings: Settings, title: str, folder: Path) -> None:
    fields = recover_fields(solution.model, solution.state, state=settings.plane)
    folder.mkdir(parents=True, exist_ok=True)
    draw_solution(solution, fields, title, folder, side=PICTURE_SIDE)


def answer_of_summary(summary: dict[str, Any]) -> PositionAnswer:
    """Return the answer in the summary of a full solution (`fem.drive.solution_files.summarise`)."""

    def kind(load: str, pressure: str, width: str) -> KindAnswer:
        # Lists are nested by disc; there is one.
        return KindAnswer(
            load=np.array(summary[f"{load}_N"][0], dtype=float),
            pressure=np.array(summary[f"{pressure}_MPa"][0], dtype=float),
            half_width=np.array(summary[f"{width}_mm"][0], dtype=float),
        )

    disc = summary["disc_displacement"]
    along = complex(disc["x_mm"], disc["y_mm"]) * np.exp(-1j * summary["crank_angle_rad"])
    return PositionAnswer(
        kinds={
            "pin": kind("pin_load", "pin_pressure_max", "pin_half_width"),
            "roller_outer": kind("roller_load_outer", "roller_pressure_max_outer", "roller_half_width_outer"),
            "roller_inner": kind("roller_load_inner", "roller_pressure_max_inner", "roller_half_width_inner"),
            "hole": kind("pin_shaft_load", "pin_shaft_pressure_max", "pin_shaft_half_width"),
        },
        bearing_radial=float(summary["bearing_radial_N"]),
        bearing_tangential=float(summary["bearing_tangential_N"]),
        wheel_angle=float(summary["wheel_angle_rad"]),
        disc_radial=float(along.real),
        disc_tangential=float(along.imag),
        disc_rotation=float(disc["rotation_rad"]),
    )
