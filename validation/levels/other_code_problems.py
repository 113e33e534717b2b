"""Level 2: the problems, with definition, our answer computed now, and the run of the other code.

The definition holds the input of both codes, so that a stored answer of the other code is refused when the
problem has changed. Loads are lists by part, zeros included.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.full_solution import FullSolution
from fem.drive.solution import solve_drive
from fem.options import SolutionOptions
from fem.referee.calculix import ask_calculix
from fem.referee.calculix_deck import PENALTY_FACTOR, find_calculix, pair_name, write_deck
from fem.referee.calculix_pair import PENALTY_FACTOR as SOLID_PENALTY_FACTOR, ask_about_pair, face_means
from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.solved_pair import PairLoad, PairMeshes, SolvedPair, solve_pair
from ltca.arrays import FloatArray
from ltca.drive.materials import elastic_alone
from ltca.drive.parts import Drive, Material, contact_modulus
from ltca.errors import CycloError
from ltca.geometry.length_profile import LOGARITHMIC, Relief
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import ProfiledLineContactLaw
from ltca.reading.drive_file import load_drive

Answer = dict[str, Any]

CASE, CRANK_ANGLE = "CS-1", 0.5
# Two elements for each half-width, four pressures across a contact: with fewer our answer depends on where the
# vertices happen to lie (benchmarks/fem.py --ccx 6 4 3 2).
SIZE = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherCode:
    """Another code and its problem.

    Attributes
    ----------
    name : str
        Of the code.
    installed : callable
        Whether it can be asked here.
    installation : str
        The command that installs it.
    definition : callable
        Everything that defines the problem, as plain numbers and texts.
    ours, theirs : callable
        Our answer, computed now, and the other code's.
    """

    name: str
    installed: Callable[[], bool]
    installation: str
    definition: Callable[[], dict[str, Any]]
    ours: Callable[[], Answer]
    theirs: Callable[[], Answer]

    def fingerprint(self) -> str:
        """Return a hash of the definition of the problem (hex, 16 digits)."""
        text = json.dumps(self.definition(), sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def coarse_drive() -> Drive:
    """Return the drive that is solved by both codes."""
    drive = load_drive("paper").cases[CASE]
    # What results are judged by is no part of the problem: stored answers stay those of the same drive.
    return replace(drive, materials=elastic_alone(drive.materials))


def has_calculix() -> bool:
    """Return whether ccx is installed."""
    try:
        find_calculix()
    except CycloError:
        return False
    return True


def define_drive() -> dict[str, Any]:
    """Return what defines the drive problem: the drive, its position, its mesh, its penalty."""
    drive = coarse_drive()
    return {
        "drive": drive.fingerprint(),
        "crank_angle_rad": CRANK_ANGLE,
        "wheel_moment_N_mm": drive.wheel_moment(),
        "size": SIZE,
        "plane": "strain",
        "penalty": PENALTY_FACTOR,
    }


def our_drive() -> Answer:
    """Solve the drive by our finite elements."""
    solution = solve_drive(coarse_drive(), CRANK_ANGLE, SolutionOptions(size=SIZE))
    loads = {kind.load: getattr(solution.contacts, kind.load).tolist() for kind in CONTACT_KINDS.values()}
    return {**loads, "wheel_angle": solution.pose.wheel_angle}


def their_drive() -> Answer:
    """Solve the drive by CalculiX on the same mesh."""
    solution = solve_drive(coarse_drive(), CRANK_ANGLE, SolutionOptions(size=SIZE))
    with tempfile.TemporaryDirectory(prefix="cyclo-validate-") as folder:
        answer = ask_calculix(solution, write_deck(solution, Path(folder) / "drive.inp"), find_calculix())
    return {**_by_part(solution, answer.load), "wheel_angle": answer.wheel_angle}


def _by_part(solution: FullSolution, load: dict[str, float]) -> Answer:
    found = {kind.load: np.zeros_like(getattr(solution.contacts, kind.load)) for kind in CONTACT_KINDS.values()}
    for pair in solution.model.pairs:
        found[CONTACT_KINDS[pair.kind].load][pair.index] = load.get(pair_name(pair), 0.0)
    return {name: values.tolist() for name, values in found.items()}


STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)


@dataclass(frozen=True, slots=True, kw_only=True)
class PressedRoller:
    """A roller pressed against a flat.

    Attributes
    ----------
    name : str
        In rows.
    length, radius : float
        mm.
    load : float
        N.
    span : float
        Width of the other code's grid, some 3.4 half-widths, mm.
    cells : tuple of int
        Of that grid, across and along.
    relief : Relief or None
        Profile along the length; None for a cylinder.
    """

    name: str
    length: float
    radius: float
    load: float
    span: float
    cells: tuple[int, int]
    relief: Relief | None = None

    @property
    def modulus(self) -> float:
        """E* of roller and flat, MPa."""
        return contact_modulus(STEEL, STEEL)

    def drop(self, place: FloatArray) -> FloatArray:
        """Return the relief of the profile at places along the length from the middle, mm."""
        return np.zeros_like(place) if self.relief is None else np.asarray(self.relief.relief(place))

    def solved(self) -> tuple[float, float]:
        """Return our pressure at mid-length (MPa) and approach (mm)."""
        law: LineContactLaw | ProfiledLineContactLaw
        if self.relief is None:
            law = LineContactLaw(self.length, self.modulus)
        else:
            law = ProfiledLineContactLaw.for_radii(self.relief, self.modulus, self.radius, self.radius)
        approach = float(law.approach_at_load(np.array([self.load]), self.radius)[0][0])
        return float(law.mid_pressure(approach, self.radius)), approach


ROLLERS = (
    PressedRoller(name="uncrowned roller", length=11.8, radius=2.0, load=1500.0, span=0.173, cells=(96, 512)),
    PressedRoller(
        name="roller with ISO 16281:2025 profile",
        length=20.0,
        radius=10.0,
        load=40e3,
        span=1.626,
        cells=(96, 384),
        relief=Relief(length=20.0, logarithm=LOGARITHMIC * 20.0),
    ),
)


def has_tamaas() -> bool:
    """Return whether tamaas is installed."""
    return importlib.util.find_spec("tamaas") is not None


def define_rollers() -> dict[str, Any]:
    """Return what defines the rollers: sizes, load, E*, profile and grid."""
    return {
        roller.name: {
            "length_mm": roller.length,
            "radius_mm": roller.radius,
            "load_N": roller.load,
            "modulus_MPa": f"{roller.modulus:.9g}",
            "cells": list(roller.cells),
            "span_mm": roller.span,
            "drop_mm": [f"{drop:.9g}" for drop in roller.drop(roller.length * np.array([0.0, 0.2, 0.4, 0.48, 0.4999]))],
        }
        for roller in ROLLERS
    }


def our_rollers() -> Answer:
    """Press the rollers with our laws: peak pressure at mid-length and approach by roller."""
    return {roller.name: list(roller.solved()) for roller in ROLLERS}


def their_rollers() -> Answer:
    """Press the rollers by tamaas."""
    return {roller.name: list(_press(roller)) for roller in ROLLERS}


def _press(roller: PressedRoller) -> tuple[float, float]:
    """Return pressure at mid-length and approach by tamaas: uniform cells, FFT of Boussinesq, conjugate gradients."""
    import tamaas

    length, span = roller.length, roller.span
    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [span, length], list(roller.cells))
    model.E, model.nu = roller.modulus, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "free")
    x, y = ((np.arange(n) + 0.5) * size / n - size / 2 for n, size in zip(roller.cells, (span, length), strict=True))
    surface = -(x[:, None] ** 2 / (2.0 * roller.radius) + roller.drop(y)[None, :])
    solver = tamaas.PolonskyKeerRey(model, np.ascontiguousarray(surface), 1e-8)
    solver.setIntegralOperator("free")
    solver.max_iter = 5000
    residual = float(solver.solve(roller.load / (span * length)))
    if not residual < 1e-8:
        raise CycloError(f"tamaas did not converge: residual {residual:.1e}")
    pressure = np.array(model.traction)
    displacement = np.empty_like(pressure)
    model.operators["free"](pressure, displacement)
    loaded = pressure > 0.2 * pressure.max()
    middle = pressure.shape[1] // 2
    peak = float(pressure[:, middle - 1 : middle + 1].mean(axis=1).max())
    return peak, float(np.mean((displacement - surface)[loaded]))


@dataclass(frozen=True, slots=True, kw_only=True)
class CrownedPair:
    """A crowned cylinder pressed on a flat, both solid.

    Attributes
    ----------
    name : str
        In rows.
    tilt : float
        rad.
    radius, length, crown_radius : float
        Of the cylinder, mm.
    approach : float
        At mid-length, mm.
    size : float
        Of the elements, by the default: the same mesh in both codes, C3D20R at a minute.
    block : float
        Depth of the blocks, mm.
    """

    name: str
    tilt: float
    radius: float = 10.0
    length: float = 4.0
    crown_radius: float = 400.0
    approach: float = 5e-3
    size: float = 3.0
    block: float = 3.0

    def relief(self, z: FloatArray) -> FloatArray:
        """Return the crown's relief at heights, mm."""
        return np.asarray(np.square(z) / (2.0 * self.crown_radius))

    def solved(self) -> SolvedPair:
        """Press the pair by our finite elements."""
        pair = SolidPair.round_bodies(self.radius, 0.0, STEEL, self.length, relief=self.relief)
        return solve_pair(
            pair, PairLoad(approach=self.approach, tilt=self.tilt), PairMeshes(size=self.size, block=self.block)
        )


CROWNED_PAIRS = (
    CrownedPair(name="crowned pair", tilt=0.0),
    CrownedPair(name="crowned pair, tilted by 0.5 mrad", tilt=5e-4),
)


def define_pairs() -> dict[str, Any]:
    """Return what defines the solid pairs: shapes, material, approach, tilt, mesh and penalty."""
    return {
        pair.name: {
            "radius_mm": pair.radius,
            "length_mm": pair.length,
            "crown_radius_mm": pair.crown_radius,
            "youngs_modulus_MPa": STEEL.youngs_modulus,
            "poisson_ratio": STEEL.poisson_ratio,
            "approach_mm": pair.approach,
            "tilt_rad": pair.tilt,
            "size": pair.size,
            "block_mm": pair.block,
            "penalty": SOLID_PENALTY_FACTOR,
        }
        for pair in CROWNED_PAIRS
    }


def our_pairs() -> Answer:
    """Press the pairs by our finite elements: load and largest mean pressure of a face by pair."""
    found = {pair.name: pair.solved() for pair in CROWNED_PAIRS}
    return {name: [solved.load, float(face_means(solved).max())] for name, solved in found.items()}


def their_pairs() -> Answer:
    """Press the pairs by CalculiX, C3D20R on the same meshes."""
    found = {}
    for pair in CROWNED_PAIRS:
        with tempfile.TemporaryDirectory(prefix="cyclo-validate-") as folder:
            answer = ask_about_pair(pair.solved(), Path(folder) / "pair.inp", find_calculix())
        found[pair.name] = [answer.load, answer.largest]
    return found


CALCULIX = "sh .ci/system-libraries --referees (Debian: apt install calculix-ccx)"
TAMAAS = "pip install 'cyclo-ltca[referee]'"
CODES = {
    code.name: code
    for code in (
        OtherCode(
            name="CalculiX", installed=has_calculix, installation=CALCULIX,
            definition=define_drive, ours=our_drive, theirs=their_drive,
        ),
        OtherCode(
            name="tamaas", installed=has_tamaas, installation=TAMAAS,
            definition=define_rollers, ours=our_rollers, theirs=their_rollers,
        ),
        OtherCode(
            name="CalculiX C3D20R", installed=has_calculix, installation=CALCULIX,
            definition=define_pairs, ours=our_pairs, theirs=their_pairs,
        ),
    )
}  # fmt: skip
