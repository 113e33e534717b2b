"""`ltca.vibration`: modes, critical speeds and response of ``cyclo dynamics`` on one drive."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis import vibration as of_analysis
from ltca.analysis.drive_curves import fewest_turns, require_turns
from ltca.analysis.engines import Engine, lending_between
from ltca.analysis.forced_vibration import ForcedVibration, forced_vibration, response_content, response_notes
from ltca.analysis.vibration import POSITIONS, Vibration, speed_range, vibration_content
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import parse_quantity
from ltca.front.arguments import counted, engine_given
from ltca.front.checks import drive_and_limits
from ltca.output.threads import on_one_thread
from ltca.reading.arguments import refuse_impossible_torques
from ltca.reading.drive_file import DriveFile

LEAST_POSITIONS, MOST_POSITIONS, MOST_TURNS = 4, 1000, 1000


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class DriveVibrations:
    """Vibrations of one drive and its response over speed.

    Attributes
    ----------
    modes : Vibration
        Eigenfrequencies over a turn and over torque, what moves, orders that excite them, critical speeds.
    response : ForcedVibration or None
        Response over the speed of the input; None of a drive without ``[damping]``.
    fastest : float
        Largest speed of the input, turns a minute.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> found = ltca.vibration(drive, positions=4, compliance="half-space", speed="1500 rpm")
    >>> found.response is None, found.fastest  # no [damping] in its file
    (True, 1500.0)
    """

    modes: Vibration
    response: ForcedVibration | None
    fastest: float

    @property
    def content(self) -> dict[str, Any]:
        """What ``dynamics.json`` holds of it, without the options of the engine: lists and numbers, units in the keys.

        Examples
        --------
        >>> import ltca
        >>> drive = ltca.load_drive("paper").cases["CS-1"]
        >>> content = ltca.vibration(drive, positions=4, compliance="half-space").content
        >>> content["input_held"], [mode["number"] for mode in content["modes"]]
        (True, [1, 2, 3, 4])
        """
        answer = None if self.response is None else response_content(self.response, self.modes)
        return {**vibration_content(self.modes, self.fastest), "response": answer}

    def __repr__(self) -> str:
        """Say what vibrates how fast, and what to know of the response."""
        drive = self.modes.drive
        rows = [f"{drive.name} {drive.case}, {drive.load_words()}: {self.modes.ends_words}"]
        for mode, words in enumerate(self.modes.words):
            over = self.modes.at_load[:, mode]
            rows.append(f"  mode {mode + 1}: {over.min():.4g} … {over.max():.4g} Hz  {words}")
        rows.append(f"  {len(self.modes.critical_speeds(self.fastest))} critical speeds up to {self.fastest:g} rpm")
        if self.response is not None:
            worst = max(float(np.max(factor)) for factor in self.response.factors.values())
            rows += [
                f"  largest dynamic factor {worst:.3f}",
                *(f"  {note}" for note in response_notes(self.response, self.modes)),
            ]
        return "\n".join(rows)


@on_one_thread
def vibration(
    drive: Drive | DriveFile,
    *,
    case: str | None = None,
    positions: int = POSITIONS,
    turns: int | None = None,
    speed: float | str | None = None,
    compliance: str | Engine | None = None,
    coefficients: InfluenceCoefficients | Path | str | None = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> DriveVibrations:
    """Compute eigenfrequencies and modes under load, critical speeds and, with damping, the response over speed.

    Parameters
    ----------
    drive : DriveFile or Drive
        A drive file, or one drive; every density known.
    case : str, optional
        Which case of the file, where it has several.
    positions : int
        Crank angles of a turn at which modes are told.
    turns : int, optional
        Crank turns behind the orders of the transmission error; the fewest that tell them apart by default.
    speed : float or str, optional
        Largest speed of the input, turns a minute; by default the largest of ``[[duty]]``, ``load.speed``, or 3000.
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
    DriveVibrations
        ``modes``, ``response``; ``content`` has all of it as in ``dynamics.json``.

    Raises
    ------
    DriveError
        When a name, a number or their combination makes no sense, a density is missing, or turns are too
        few to tell the orders apart.
    ConvergenceError
        When a position does not balance or is not stable.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> found = ltca.vibration(drive, positions=6, compliance="half-space")
    >>> found.modes.frequency.shape  # torques, positions, modes
    (5, 6, 4)
    >>> found.modes.words[0]  # nothing is given behind the output
    'disc turns (60 %), disc moves along its eccentricity (24 %), wheel pins turn (16 %)'
    """
    one, _ = drive_and_limits(drive, case, None)
    refuse_impossible_torques([one])
    warm = warm_drive(one)
    if turns is not None:
        require_turns(warm, counted(turns, "turns", 1, MOST_TURNS), "turns")
    count = counted(positions, "positions", LEAST_POSITIONS, MOST_POSITIONS)
    fastest = speed_range(one)[1] if speed is None else parse_quantity(speed, "rpm", "speed", gt=0.0)
    engine = engine_given(one, compliance, coefficients=coefficients, hole_near_field=hole_near_field, bodies=bodies)
    if isinstance(drive, DriveFile):
        engine = lending_between(drive.cases.values(), engine)
    found = of_analysis.vibration(
        one,
        engine=engine.with_coefficients(warm),
        positions=count,
        turns=turns or fewest_turns(warm, warm.pin_wheel.number_of_pins),
    )
    answer = None if one.damping is None else forced_vibration(found, fastest=fastest)
    return DriveVibrations(modes=found, response=answer, fastest=fastest)
