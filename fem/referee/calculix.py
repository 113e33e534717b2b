"""CalculiX as a second opinion: runs the exported deck, reads contact forces and pressures, compares.

CalculiX may end an increment while contact points still pull and append one of size zero that frees them; it prints
both, and only the last one is the answer. Without what the deck asks of its contact (`fem.referee.calculix_deck`) it did so
on the paper's drive with three times the default size (CS-1, 0.5 rad): 402 of 17,544 points of the first one pull with up
to 9,440 MPa, and its wheel angle is 0.27″ off that of the last one. With the default size even points of the last one pulled.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from fem.drive.full_solution import FullSolution
from fem.referee.calculix_deck import pair_name, slave_faces, write_deck
from ltca.arrays import FloatArray
from ltca.errors import CycloError
from ltca.output.files import whole_file
from ltca.output.processes import supervised

TIME_LIMIT = 3600.0
CONTACT_STRESS = "contact stress"
# The points have come to rest (see `fem.referee.calculix_deck`), so none pulls but those that changed sides in the last
# iteration as many one way as the other: these are next to the rim, where there is next to no pressure.
PULLING_SHARE = 0.01


@dataclass(frozen=True, slots=True, kw_only=True)
class RefereeAnswer:
    """Answer of CalculiX.

    Attributes
    ----------
    load : dict of str to float
        Normal force of each contact pair, N, by its name in the deck.
    peak_pressure : dict of str to float
        Largest mean pressure of an element face of each pair, MPa.
    wheel_angle : float
        With the turn of the wheel from the pose of the deck, rad.
    seconds : float
        Wall time of ccx.
    """

    load: dict[str, float]
    peak_pressure: dict[str, float]
    wheel_angle: float
    seconds: float


def run_calculix(deck: Path, program: str, *, limit: float = TIME_LIMIT) -> tuple[str, float]:
    """Run ccx on a deck in a temporary folder; return the text of its .dat file and the seconds it took.

    CycloError when ccx fails, does not end within `limit` seconds or leaves no results.
    """
    with tempfile.TemporaryDirectory(prefix="cyclo-ccx-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        try:
            (folder / "job.inp").symlink_to(deck.resolve())
        except OSError:  # Windows leaves links to administrators
            shutil.copyfile(deck, folder / "job.inp")
        environment = {**os.environ, "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "1")}
        said = folder / "said.txt"
        start = time.perf_counter()
        try:
            with (
                said.open("wb") as stream,
                supervised(
                    [program, "job"], folder, cwd=folder, stdout=stream, stderr=subprocess.STDOUT, env=environment
                ) as run,
            ):
                status = run.wait(limit)
        except subprocess.TimeoutExpired as error:
            raise CycloError(f"ccx did not end within {limit:.0f} s on {deck}") from error
        except OSError as error:
            raise CycloError(f"{program} cannot be run: {error}") from error
        seconds = time.perf_counter() - start
        output = said.read_text(encoding="utf-8", errors="replace")
        result = folder / "job.dat"
        text = result.read_text(encoding="utf-8", errors="replace") if result.exists() else ""
        if status != 0 or "Job finished" not in output or "total surface force" not in text:
            tail = " / ".join(line.strip() for line in output.splitlines() if "ERROR" in line) or output[-400:]
            raise CycloError(f"ccx failed on {deck} (exit status {status}): {tail}")
        return text, seconds


def last_output(text: str) -> str:
    """Return the part of a .dat file on the last increment, from its contact stresses on.

    CycloError when nothing was printed, or contact points still pull by more than `PULLING_SHARE` of the largest pressure.
    """
    place = text.rfind(CONTACT_STRESS)
    if place < 0:
        raise CycloError("ccx printed no contact stresses")
    last = text[place:]
    pressures = [value for values in read_pressures(last).values() for value in values]
    lowest, highest = min(pressures, default=0.0), max(pressures, default=0.0)
    if lowest < -PULLING_SHARE * highest:
        raise CycloError(f"ccx ended with contacts that pull: {lowest:.4g} MPa, largest pressure {highest:.4g} MPa")
    return last


def read_forces(text: str) -> dict[str, FloatArray]:
    """Return the total force of each slave surface, N, from one increment of a .dat file."""
    forces: dict[str, FloatArray] = {}
    name = ""
    wanted = False
    for line in text.splitlines():
        if "statistics for slave set" in line:
            name = line.split("slave set")[1].split(",")[0].strip().removeprefix("S_")
        elif "total surface force" in line:
            wanted = True
        elif wanted and line.strip():
            forces[name] = np.array([float(word) for word in line.split()[:3]])
            wanted = False
    return forces


def read_pressures(text: str) -> dict[tuple[int, int], list[float]]:
    """Return the pressures at the contact points of each slave face (element, face), MPa, from one increment."""
    pressures: dict[tuple[int, int], list[float]] = {}
    inside = False
    for line in text.splitlines():
        if CONTACT_STRESS in line:
            inside = True
        elif inside and line.strip():
            words = line.split()
            if len(words) != 5 or not words[0].isdigit():
                inside = False
                continue
            pressures.setdefault((int(words[0]), int(words[1])), []).append(float(words[2]))
    return pressures


def read_wheel_turn(text: str) -> float:
    """Return the turn of the wheel from the pose of the deck, rad, from one increment of a .dat file."""
    lines = [line for line in text.splitlines() if line.strip()]
    return next(
        float(following.split()[1])
        for line, following in pairwise(lines)
        if "displacements" in line and "WHEEL" in line
    )


def ask_calculix(solution: FullSolution, deck: Path, program: str) -> RefereeAnswer:
    """Let CalculiX solve the deck of a solution and read its answer."""
    text, seconds = run_calculix(deck, program)
    with whole_file(deck.with_suffix(".dat")) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    last = last_output(text)
    forces, pressures = read_forces(last), read_pressures(last)
    # ccx counts the faces of the expanded wedge: 1 and 2 are front and back, the sides of the triangle follow.
    faces = slave_faces(solution)
    peaks = {
        name: max((float(np.mean(pressures[face])) for face in own if face in pressures), default=0.0)
        for name, own in faces.items()
    }
    return RefereeAnswer(
        load={name: float(np.hypot(force[0], force[1])) for name, force in forces.items()},
        peak_pressure=peaks,
        wheel_angle=solution.pose.wheel_angle + read_wheel_turn(last),
        seconds=seconds,
    )


def compare_with_calculix(solution: FullSolution, deck: Path, program: str) -> list[str]:
    """Write the deck of a solution (``.inp``), run CalculiX and return a table of both answers, line by line.

    What CalculiX prints is written beside the deck as ``.dat``.
    """
    return tabulate_answers(solution, ask_calculix(solution, write_deck(solution, deck), program))


def load_differences(solution: FullSolution, answer: RefereeAnswer) -> dict[str, float]:
    """Return our load less CalculiX's, as a part of the largest of its kind, of every pair by its name in the deck."""
    largest: dict[str, float] = {}
    for pair, detail in zip(solution.model.pairs, solution.contacts.details, strict=True):
        largest[pair.kind] = max(largest.get(pair.kind, 0.0), detail.load)
    # A kind that carries nothing here has no part to speak of: its loads are compared with a newton.
    return {
        pair_name(pair): (detail.load - answer.load.get(pair_name(pair), 0.0)) / (largest[pair.kind] or 1.0)
        for pair, detail in zip(solution.model.pairs, solution.contacts.details, strict=True)
    }


def tabulate_answers(solution: FullSolution, answer: RefereeAnswer) -> list[str]:
    """Return a table of our answer and CalculiX's, line by line."""
    changes = load_differences(solution, answer)
    lines = [
        f"{'':<16}{'load, N':>22}{'of largest':>12}{'peak, MPa':>20}{'difference':>12}",
        f"{'contact':<16}{'cyclo':>11}{'ccx':>11}{'%':>12}{'cyclo':>10}{'ccx':>10}{'%':>12}",
    ]
    for pair, detail in zip(solution.model.pairs, solution.contacts.details, strict=True):
        name = pair_name(pair)
        if detail.load <= 0.0 and answer.load.get(name, 0.0) <= 0.0:
            continue
        load, peak = answer.load.get(name, 0.0), answer.peak_pressure.get(name, 0.0)
        rise = f"{100.0 * (detail.peak_pressure / peak - 1.0):12.2f}" if peak > 0.0 else f"{'':>12}"
        lines.append(
            f"{name.lower():<16}{detail.load:>11.2f}{load:>11.2f}{100.0 * changes[name]:>12.3f}"
            f"{detail.peak_pressure:>10.1f}{peak:>10.1f}{rise}"
        )
    arcseconds = np.degrees(solution.pose.wheel_angle - answer.wheel_angle) * 3600.0
    lines.append(
        f'wheel angle: {solution.pose.wheel_angle:.7f} rad, ccx {answer.wheel_angle:.7f} rad ({arcseconds:+.3f}")'
    )
    lines.append(f"seconds: {solution.seconds['total']:.1f}, ccx {answer.seconds:.1f}")
    return lines
