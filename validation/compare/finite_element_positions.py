"""Full finite-element solutions of chosen positions, kept in one file for each position as soon as it is solved.

A file belongs to a drive in a case (by fingerprint), a crank angle, the options of the solution and the code that found
it; a file that does not fit, or is damaged, is solved again. So a run that was killed continues where it stopped and ends with
the same numbers, and no number of older code is compared.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.disc_stress import recover_disc_stress
from fem.drive.fields import recover_fields
from fem.drive.full_solution import FullSolution
from fem.drive.model import RoundGroup
from fem.options import SolutionOptions
from fem.pictures.solution_pictures import draw_solution
from fem.reducer.solution import solve_reducer
from fem.reducer.solution_files import summarise
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement
from ltca.output.files import write_json
from ltca.output.provenance import code_hash, code_version
from ltca.output.regular_files import read_regular
from ltca.page.study_page import Picture
from ltca.quantities import QUANTITIES
from validation.compare.comparison import KindAnswer, PositionAnswer
from validation.compare.disc_stresses import DiscStressAnswer, answer_of_content, stress_content

FORMAT = 4
LARGEST_KEPT = 200_000_000
"""Bytes of one kept position."""
ANSWER = ("summary", "stress")
"""What a kept position holds beside its key."""
PICTURES = "pictures.json"
"""Pictures of a disc for the page, kept beside those for print."""
PICTURE_SIDE = 1200


@dataclass(frozen=True, slots=True, kw_only=True)
class FullPosition:
    """Full solution of one disc at one position as it is kept.

    Attributes
    ----------
    case : str
        Case of the drive, of several discs with the number of the disc.
    disc : int
        Number of the disc.
    crank_angle : float
        rad.
    answer : PositionAnswer
        Loads, pressures, pose.
    stress : DiscStressAnswer
        Stress in the disc.
    residual : float
        Largest unbalanced force, N, of all discs.
    unknowns : int
        Of the solution, all discs.
    seconds : float
        Wall time when it was solved, all discs: for the account of costs, never for the report.
    pictures : Path or None
        Kept pictures (`kept_pictures`); None when they were not asked for.
    """

    case: str
    crank_angle: float
    answer: PositionAnswer
    stress: DiscStressAnswer
    residual: float
    unknowns: int
    seconds: float
    pictures: Path | None
    disc: int = 0


def solve_positions(
    drive: Drive,
    case: str,
    crank_angles: Iterable[float],
    folder: Path,
    options: SolutionOptions,
    *,
    pictured: float | None = None,
    title: str = "",
    begin: Callable[[str], None] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Iterator[tuple[FullPosition, ...]]:
    """Yield the full solutions at one crank angle (rad) after the other, disc by disc, from kept files where they fit.

    Condensed pins and rollers serve the next angle, which saves time and changes no bit of a file. Every answer is read back
    from its file, so that a resumed run sees the same digits. Pictures are drawn at the crank angle `pictured`, under `title`
    and the angle; `begin` is called with a line before each angle, `progress` with one for each step of a solution.
    """
    rounds: tuple[RoundGroup, ...] = ()
    for angle in crank_angles:
        if begin is not None:
            begin(f"full FE of {case} at {angle:.4g} rad")
        positions, rounds = _solve_kept(
            drive, case, angle, folder, options, rounds, angle == pictured, f"{title}, {angle:.4g} rad", progress
        )
        yield positions


def _solve_kept(
    drive: Drive,
    case: str,
    crank_angle: float,
    folder: Path,
    options: SolutionOptions,
    rounds: tuple[RoundGroup, ...],
    pictures: bool,
    title: str,
    progress: Callable[[str], None] | None,
) -> tuple[tuple[FullPosition, ...], tuple[RoundGroup, ...]]:
    """Return a position, and condensed pins and rollers for the next one."""
    key = position_key(drive, case, crank_angle, options)
    path = folder / f"{position_name(drive, case, crank_angle, options)}.json"
    singles = single_discs(drive)
    count = len(singles)
    prefixes = [f"disc_{disc}_" if count > 1 else "" for disc in range(count)]
    images = [path.with_suffix("") / f"{prefix}{PICTURES}" for prefix in prefixes]
    content = read_kept(path, key, ANSWER)
    if content is None or (pictures and not all(image.exists() for image in images)):
        # Stresses along the walls are compared.
        with_walls = replace(options, fine_walls=True)
        solution = solve_reducer(drive, crank_angle, with_walls, rounds=rounds, progress=progress)
        rounds = solution.rounds
        if pictures:
            for disc, prefix in zip(solution.discs, prefixes, strict=True):
                _draw(disc, title, path.with_suffix(""), prefix)
        if content is None:
            stress = [stress_content(recover_disc_stress(disc)) for disc in solution.discs]
            answer = {"summary": summarise(solution), "stress": stress}
            write_json(path, sealed(key, answer))
            content = read_kept(path, key, ANSWER)
    assert content is not None
    summary = content["summary"]
    positions = tuple(
        FullPosition(
            case=disc_case(case, disc, count),
            crank_angle=crank_angle,
            answer=answer_of_summary(summary, single, disc),
            stress=answer_of_content(content["stress"][disc]),
            residual=float(summary["equilibrium_residual_N"]),
            unknowns=int(summary["dof"]),
            seconds=float(summary["seconds"]),
            pictures=images[disc] if pictures else None,
            disc=disc,
        )
        for disc, single in enumerate(singles)
    )
    return positions, rounds


def disc_case(case: str, disc: int, discs: int) -> str:
    """Return the label of one disc of a case in rows and report: the case itself where it is the only disc.

    Examples
    --------
    >>> disc_case("CS-1", 0, 1), disc_case("CS-1", 1, 2)
    ('CS-1', 'CS-1, disc 1')
    """
    return case if discs == 1 else f"{case}, disc {disc}"


def position_name(drive: Drive, case: str, crank_angle: float, options: SolutionOptions) -> str:
    """Return the name of the file of a position."""
    return f"{drive.fingerprint()}_{case}_{crank_angle:.9f}_{options.plane}_{options.size:g}"


def position_key(drive: Drive, case: str, crank_angle: float, options: SolutionOptions) -> dict[str, Any]:
    """Return what a kept file must have been made for."""
    return {
        "format": FORMAT,
        "version": code_version(),
        "code": code_hash("fem", "ltca"),
        "fingerprint": drive.fingerprint(),
        "case": case,
        "crank_angle_rad": crank_angle,
        "size": options.size,
        "plane": options.plane,
    }


def sealed(key: dict[str, Any], answer: dict[str, Any]) -> dict[str, Any]:
    """Return the content of a kept file: its key, a checksum and the answer."""
    return {"key": key, "checksum": _checksum(answer), **answer}


def read_kept(path: Path, key: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any] | None:
    """Return the content of a file that fits its key, with an answer of these names; None when it has to be solved."""
    try:
        content: dict[str, Any] = json.loads(read_regular(path, LARGEST_KEPT))
    except (OSError, ValueError):
        return None
    if not isinstance(content, dict) or content.get("key") != key:
        return None
    answer = {name: content.get(name) for name in names}
    return content if content.get("checksum") == _checksum(answer) else None


def _checksum(answer: object) -> str:
    return hashlib.sha256(json.dumps(answer, sort_keys=True).encode()).hexdigest()


def _draw(solution: FullSolution, title: str, folder: Path, prefix: str) -> None:
    fields = recover_fields(solution)
    folder.mkdir(parents=True, exist_ok=True)
    drawn = draw_solution(solution, fields, title, folder, side=PICTURE_SIDE, prefix=prefix)
    write_json(folder / f"{prefix}{PICTURES}", {"pictures": [asdict(picture) for picture in drawn.pictures]})


def kept_pictures(path: Path) -> list[Picture]:
    """Return the pictures of a disc that were kept."""
    return [Picture(**each) for each in json.loads(read_regular(path, LARGEST_KEPT))["pictures"]]


def answer_of_summary(summary: dict[str, Any], single: Drive, disc: int) -> PositionAnswer:
    """Return the answer of one disc in the summary of a full solution (`fem.reducer.solution_files.summarise`).

    `single` is the drive of that disc alone.
    """

    def of_disc(name: str) -> FloatArray:
        return np.array(summary[QUANTITIES[name].older_fem_key][disc], dtype=float)

    discs = len(summary["pin_load_N"])

    def own(name: str) -> Any:
        """Return a value of the disc, which is a list by disc only where there are several."""
        return summary[name][disc] if discs > 1 else summary[name]

    shift = own("disc_displacement")
    direction = Placement.of_drive(single).eccentric_direction(np.asarray(summary["crank_angle_rad"]))
    along = complex(shift["x_mm"], shift["y_mm"]) * complex(direction).conjugate()
    return PositionAnswer(
        kinds={
            kind: KindAnswer(
                load=of_disc(names.load), pressure=of_disc(names.pressure), half_width=of_disc(names.half_width)
            )
            for kind, names in CONTACT_KINDS.items()
        },
        bearing_radial=np.array(own("bearing_radial_N"), dtype=float, ndmin=1),
        bearing_tangential=np.array(own("bearing_tangential_N"), dtype=float, ndmin=1),
        wheel_angle=float(summary["wheel_angle_rad"]),
        disc_radial=float(along.real),
        disc_tangential=float(along.imag),
        disc_rotation=float(shift["rotation_rad"]),
    )
