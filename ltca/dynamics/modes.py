"""Eigenfrequencies and modes of stiffness and mass matrices, and the bodies that move in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh

from ltca.arrays import ComplexArray, FloatArray
from ltca.dynamics.kinetics import INPUT, OUTPUT, Body, Motion
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION

MASSLESS = 1e-10
"""Mass by the largest one, each coordinate by its own, below which a combination of coordinates has none."""
FIRST_SHIFT, SHIFT_STEP, SHIFTS = 1e-8, 10.0, 12
"""First shift by the mean square frequency (traces of K and M), its growth, and how many are tried."""
TOLD = 0.05
"""Part of the kinetic energy from which a body is named."""
MOST_TOLD = 3
ALIKE = 0.5
"""Cosine of the motions of two discs from which they move together, or against each other."""
ALONG = 0.8
"""Part of the motion of a disc along its eccentricity from which it moves so, and against which it moves across."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Modes at one position; where a drive turns freely the first is its turning, whose square is about 0 of either sign."""

    square: FloatArray  # ω², ascending, 1/s²
    shapes: FloatArray  # coordinates as columns, mm and rad, mass-normalised (t·mm²)
    turns_freely: bool

    @property
    def frequency(self) -> FloatArray:
        """Eigenfrequencies, Hz, shape (modes,); 0 of the free turning."""
        found = np.sqrt(np.maximum(self.square, 0.0)) / (2.0 * np.pi)
        if self.turns_freely:
            found[0] = 0.0
        return np.asarray(found)


def free_coordinates(row: FloatArray, lever: FloatArray) -> FloatArray:
    """Return columns that span the motions under which a row is zero, as displacements by `lever`, mm, shape (n, n − 1 or n)."""
    if not np.any(row):
        return np.diag(1.0 / lever)
    basis = np.linalg.svd((row / lever)[None])[2]
    return np.asarray(basis[1:].T / lever[:, None])


def solve_modes(stiffness: FloatArray, mass: FloatArray, basis: FloatArray, rigid: FloatArray | None) -> Modes:
    """Return the modes of a drive at one position, over a basis of free motions; ConvergenceError where it is not stable."""
    k, m = basis.T @ stiffness @ basis, basis.T @ mass @ basis
    own = np.sqrt(np.maximum(np.diag(m), 0.0))
    own[own == 0.0] = 1.0
    sizes = np.linalg.eigvalsh(m / np.outer(own, own))
    count = int(np.count_nonzero(sizes > MASSLESS * sizes[-1]))
    # A loaded drive that turns freely is pulled on or back by its own transmission error.
    first, shift = FIRST_SHIFT * np.trace(k) / np.trace(m), 0.0
    for trial in range(SHIFTS):
        try:
            cholesky(k + shift * m)
            break
        except LinAlgError:
            shift = first * SHIFT_STEP**trial
    else:
        raise ConvergenceError("no vibration: the drive is not stable there, some of its stiffness is negative", [])
    inverse, shapes = eigh(m, k + shift * m)
    order = np.argsort(-inverse)[:count]
    square, shapes = 1.0 / inverse[order] - shift, basis @ shapes[:, order]
    shapes = shapes / np.sqrt(np.einsum("ij,ik,kj->j", shapes, mass, shapes))
    if rigid is not None:
        # The turning may be faster than the softest vibration where its stiffness is that of the transmission error.
        overlap = np.abs(rigid @ mass @ shapes)
        turning = int(np.argmax(overlap))
        order = np.r_[turning, np.delete(np.arange(square.size), turning)]
        square, shapes = square[order], shapes[:, order]
    return Modes(square=square, shapes=shapes, turns_freely=rigid is not None)


def energy_shares(bodies: Sequence[Body], shape: FloatArray) -> dict[str, float]:
    """Return shares of the kinetic energy of a mode by body and kind of motion, largest first."""
    found: dict[str, float] = {}
    for body in bodies:
        name = "discs" if body.name.startswith("disc") else body.name
        key = f"{name} {'lean' if body.leans else 'turn' if body.turns else 'move'}"
        found[key] = found.get(key, 0.0) + body.size * float(abs(body.row @ shape) ** 2)
    total = sum(found.values())
    return {name: found[name] / total for name in sorted(found, key=lambda name: -found[name])}


def mode_words(motion: Motion, bodies: Sequence[Body], shape: FloatArray, eccentric: ComplexArray) -> str:
    """Return the moving bodies of a mode in words, with shares of the kinetic energy; `eccentric` has directions by disc."""
    told = []
    for name, share in list(energy_shares(bodies, shape).items())[:MOST_TOLD]:
        if share >= TOLD:
            what, how = name.rsplit(" ", 1)
            words = _of_discs(motion, shape, eccentric, how) if what == "discs" else name
            told.append(f"{words}{'s' if what in (INPUT, OUTPUT) else ''} ({100.0 * share:.0f} %)")
    return ", ".join(told)


def _of_discs(motion: Motion, shape: FloatArray, eccentric: ComplexArray, how: str) -> str:
    """How the discs of a mode move, turn or lean: which, along or across their eccentricities, together or against each other."""
    own = np.array([shape[motion.pose.columns(disc)] for disc in range(motion.pose.discs)])
    if how == "turn":
        moved = own[:, DISC_ROTATION].astype(complex)
    else:
        x, y = own[:, DISC_PLACE if how == "move" else motion.pose.lean_place].T
        moved = x + 1j * y
    sizes = np.abs(moved)
    alone = np.count_nonzero(sizes > 0.5 * sizes.max()) == 1
    several = moved.size > 1 and not alone
    one = "disc" if moved.size == 1 else f"disc {int(np.argmax(sizes))}"
    words = f"discs {how}" if several else f"{one} {how}s"
    if how != "turn" and sizes.max() > 0.0:
        along = np.sum((moved * eccentric.conjugate()).real ** 2) / np.sum(sizes**2)
        of = "their eccentricities" if several else "its eccentricity"
        words += f" along {of}" if along > ALONG else f" across {of}" if along < 1.0 - ALONG else ""
    if several:
        pair = (moved[0].conjugate() * moved[1:]).real.sum() / max(sizes[0] * sizes[1:].sum(), 1e-300)
        words += " together" if pair > ALIKE else " against each other" if pair < -ALIKE else ""
    return words
