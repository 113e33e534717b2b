r"""Loaded tooth contact analysis of a drive without bearing and pin-hole clearance: one linear system (Eq. 7–40).

About the position of the tooth contact analysis (disc centre on the eccentricity, wheel turned to first contact)
every approach is linear in the displacements u of disc, wheel and rollers. Pressures of all contact cells and
displacements are the unknowns of one symmetric system,

.. math::

    \begin{bmatrix} S & -G \\ -G^T & -K \end{bmatrix} \begin{bmatrix} p \\ u \end{bmatrix} =
    \begin{bmatrix} S_a(\delta_0 - h) \\ K \delta_0 - t \end{bmatrix},

with the influence coefficients S, the cell areas times the directions of the approaches G, the springs of the pin
holes K and the load t. It is factored (LU) and solved again with the cells that pull left out, and those that
overlap taken back, until all pressures are positive.

The crank is held and the wheel turns; the paper holds the wheel and lets the crank lead, which is the same system
to first order. What it leaves out against `ltca.equilibrium.balance` is the change of normals, levers and curvature with the
displacements, a few micrometres against millimetres.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from fem.body.sparse_factor import factor_sparse
from ltca.arrays import FloatArray
from ltca.contact.hertz import line_half_width
from ltca.contact.pressure_cells import PatchGrid, PatchSolution, end_grading, solve_patch
from ltca.drive.engine_support import require
from ltca.drive.parts import Drive, contact_modulus
from ltca.errors import ConvergenceError, DriveError, Problem
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import first_contact
from ltca.geometry.pairs import ContactGeometry
from validation.methods.unloaded import carrying_holes, carrying_rollers

WHEEL = 3
"""Place of the wheel angle in the unknowns: behind the disc, before the rollers."""

CELLS = 12
MAX_GRID_PASSES = 4
MAX_FACTORISATIONS = 60
LOADED_ZONE = np.radians(110.0)
"""Rollers this near the expected bearing force start as effective (θ_predict of Eq. 5)."""
HALF_WIDTH_TOLERANCE = 5e-3
"""Relative change of the half-widths below which the grids are kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ClearanceFreeSolution:
    """Loads of a drive without clearances at one crank angle.

    Attributes
    ----------
    pose : array, shape (4,)
        Displacements of disc and wheel, as in `ltca.geometry.pairs`.
    pin_load : array, shape (z_P,)
        N.
    roller_load : array, shape (n_BR,)
        N, of both sides.
    pin_shaft_load : array, shape (z_PS,)
        N.
    pin_pressure_mid : array, shape (z_P,)
        MPa.
    factorisations : int
        LU factorisations in all passes.
    residual : float
        Largest unbalanced force, moments by their lever arms, N.
    """

    pose: FloatArray
    pin_load: FloatArray
    roller_load: FloatArray
    pin_shaft_load: FloatArray
    pin_pressure_mid: FloatArray
    factorisations: int
    residual: float


def analyse_without_clearance(
    drive: Drive, crank_angle: float, torque: float | None = None, *, cells: int = CELLS
) -> ClearanceFreeSolution:
    """Solve the clearance-free LTCA at one crank angle.

    Parameters
    ----------
    drive : Drive
        A drive without bearing and pin-hole clearance, with uncrowned pins and rollers.
    crank_angle : float
        φ_C, rad.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    cells : int
        Contact cells over the half-width and over half the length.

    Returns
    -------
    ClearanceFreeSolution
        Loads and displacements.

    Raises
    ------
    DriveError
        When the drive has clearances, errors of single parts, or profiles along the length.
    ConvergenceError
        When the set of carrying cells does not settle; the history holds the number of changes.
    """
    _refuse_clearance(drive)
    system = _System(drive, crank_angle, drive.wheel_moment(torque), cells)
    factorisations = 0
    for _ in range(MAX_GRID_PASSES):
        factorisations += system.solve()
        if system.refit_grids() < HALF_WIDTH_TOLERANCE:
            break
    return system.solution(factorisations)


def _refuse_clearance(drive: Drive) -> None:
    require(drive, "clearance-free")
    said = "must be 0 mm for the clearance-free analysis"
    problems: list[str] = [
        Problem.of(f"clearance.{name}", f"= {value:g} mm", said, bound=("equal to", 0.0))
        for name, value in (("bearing", drive.clearance.bearing), ("pin_hole", drive.clearance.pin_hole))
        if value != 0.0
    ]
    play = drive.bore_radius - drive.crank_bearing.inner_race_radius - 2.0 * drive.crank_bearing.roller_radius
    if abs(play) > 1e-9 and not problems:
        problems.append(f"crank_bearing.outer_race_radius: rollers have {play:g} mm of play, must be 0 mm")
    for path, profile in (
        ("crank_bearing.roller_profile", drive.crank_bearing.roller_profile),
        ("pin_wheel.pin_profile", drive.pin_wheel.pin_profile),
    ):
        if not profile.is_cylinder:
            problems.append(f"{path}: the clearance-free analysis takes uncrowned cylinders only")
    if problems:
        raise DriveError(problems)


@dataclass(slots=True, kw_only=True)
class _Patch:
    """One contact in the system: its cells, its approach δ₀ + g·u, and which cells carry."""

    contact_modulus: float
    radius: float
    length: float
    approach: float
    direction: FloatArray
    half_width: float
    cells: int
    effective: bool
    grid: PatchGrid = field(init=False)
    separation: FloatArray = field(init=False)
    carrying: NDArray[np.bool_] = field(init=False)
    pressure: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.lay_grid()

    def lay_grid(self) -> None:
        """Lay the grid over the half-width; the cells within it carry to begin with, if the contact is effective."""
        grading = end_grading(self.length / self.half_width)
        self.grid = PatchGrid.fitted(self.length, self.half_width, cells=self.cells, grading=grading)
        x = self.grid.x_edges
        drop = (x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / (6.0 * self.radius)
        self.separation = np.repeat(drop, self.grid.shape[1])
        self.carrying = self.effective & (self.separation <= 0.5 * self.half_width**2 / self.radius)
        self.pressure = np.zeros(self.separation.size)

    @property
    def weights(self) -> FloatArray:
        """Area of each cell with its mirror images, mm²."""
        return self.grid.images * self.grid.areas.ravel()

    @property
    def influence(self) -> FloatArray:
        """Displacement by pressure, both weighted with the areas (mm³/MPa): symmetric positive definite."""
        return self.grid.images / (np.pi * self.contact_modulus) * self.grid.influence

    @property
    def load(self) -> float:
        """N."""
        return float(self.weights @ self.pressure)

    def exchange(self, displacement: FloatArray) -> int:
        """Leave out cells that pull, take back cells that overlap; return how many changed."""
        indented = self.influence @ self.pressure / self.weights
        overlap = self.approach + self.direction @ displacement - self.separation - indented
        pulling = self.carrying & (self.pressure < 0.0)
        # Overlaps of round-off size (1e-12 mm) would be exchanged for ever.
        overlapping = ~self.carrying & (overlap > 1e-12)
        self.carrying = (self.carrying & ~pulling) | overlapping
        return int(pulling.sum() + overlapping.sum())

    def alone(self, displacement: FloatArray) -> PatchSolution | None:
        """Return the contact solved by itself at its approach, for its half-width and pressure; None when open."""
        approach = float(self.approach + self.direction @ displacement)
        if approach <= 0.0:
            return None
        return solve_patch(self.grid, self.separation.reshape(self.grid.shape), self.contact_modulus, approach)


class _System:
    """The linear system of one position."""

    def __init__(self, drive: Drive, crank_angle: float, wheel_moment: float, cells: int) -> None:
        geometry = ContactGeometry.of_drive(drive)
        place = geometry.placement
        angle = np.array([crank_angle])
        self.start = np.zeros((1, 4))
        sense = -1 if wheel_moment < 0.0 else 1
        self.start[:, WHEEL_ANGLE], _ = first_contact(geometry, angle, WHEEL_ANGLE, sense)
        self.pins, self.rollers = place.wheel_pin_radii.size, place.roller_radii.size
        # Rotations enter as lengths, multiplied by their lever arms, so that all unknowns are of one size.
        wheel_lever = float(place.mean_eccentricity[0]) * place.reduction_ratio
        self.lever = np.array([1.0, 1.0, wheel_lever - float(place.mean_eccentricity[0]), wheel_lever])
        self.load = np.zeros(4 + self.rollers)
        self.load[WHEEL] = wheel_moment / wheel_lever
        self.displacement = np.zeros(4 + self.rollers)
        self.cells = cells
        # Some ten elastic approaches. A longer step comes from too few carrying cells: followed in parts, it meets
        # the cells that will carry before the disc has left the others.
        modulus = contact_modulus(drive.materials.disc, drive.materials.wheel_pin)
        self.step_bound = abs(self.load[WHEEL]) / (0.1 * modulus * drive.disc.thickness)

        parts, length = drive.materials, drive.roller_length
        flank = geometry.flank(angle, self.start)
        self.patches: dict[tuple[str, int], _Patch] = {}
        for pin in range(self.pins):
            direction = np.zeros(4 + self.rollers)
            direction[:4] = flank.gradient[0, pin] / self.lever
            # Pins that the load presses on the flank start; without backlash the radial displacement of the disc
            # loads pins behind the pitch line as well, which then overlap and are taken in.
            effective = direction[WHEEL] * self.load[WHEEL] > 0.0
            modulus = contact_modulus(parts.disc, parts.wheel_pin)
            radius, approach = float(flank.effective_radius[0, pin]), float(flank.approach[0, pin])
            self._add(("pin", pin), modulus, radius, drive.disc.thickness, approach, direction, effective)
        ray = geometry.rollers(angle).direction[0]
        # The pins push the disc inward and back, the bearing outward and ahead.
        zone = carrying_rollers(geometry, angle, angle - 0.25 * np.pi * sense, LOADED_ZONE)[0]
        for roller in range(self.rollers):
            outward, inward = np.zeros(4 + self.rollers), np.zeros(4 + self.rollers)
            outward[:2] = -ray[roller].real, -ray[roller].imag
            outward[4 + roller], inward[4 + roller] = 1.0, -1.0
            modulus = contact_modulus(parts.disc, parts.roller)
            effective = float(place.outer_effective_radii[roller])
            self._add(("outer", roller), modulus, effective, length, 0.0, outward, bool(zone[roller]))
            modulus = contact_modulus(parts.inner_race, parts.roller)
            effective = float(place.inner_effective_radii[roller])
            self._add(("inner", roller), modulus, effective, length, 0.0, inward, bool(zone[roller]))
        holes = geometry.holes(angle, self.start)
        self.hole_stiffness = drive.hole_stiffness
        self.hole_approach = holes.approach[0]
        self.hole_direction = np.zeros((self.hole_approach.size, 4 + self.rollers))
        self.hole_direction[:, :4] = holes.gradient[0] / self.lever
        self.hole_carrying = carrying_holes(geometry, angle, -sense)[0]

    def _add(
        self,
        key: tuple[str, int],
        modulus: float,
        radius: float,
        length: float,
        approach: float,
        direction: FloatArray,
        effective: bool,
    ) -> None:
        guess = 0.5 * abs(self.load[WHEEL])  # a few contacts share the load; grids are laid anew anyway
        self.patches[key] = _Patch(
            contact_modulus=modulus,
            radius=radius,
            length=length,
            approach=approach,
            direction=direction,
            half_width=float(line_half_width(guess / length, radius, modulus)),
            cells=self.cells,
            effective=effective,
        )

    def solve(self) -> int:
        """Solve with the present grids; return the number of factorisations."""
        history: list[float] = []
        for count in range(1, MAX_FACTORISATIONS + 1):
            floating = not self._factor_and_solve()
            changes = int(floating) + sum(patch.exchange(self.displacement) for patch in self.patches.values())
            opening = self.hole_carrying != (self.hole_approach + self.hole_direction @ self.displacement > 0.0)
            self.hole_carrying = self.hole_carrying ^ opening
            changes += int(opening.sum())
            history.append(changes)
            if changes == 0:
                return count
        raise ConvergenceError("the carrying cells do not settle; changes in the last rounds", history)

    def _factor_and_solve(self) -> bool:
        """Move to the solution of the carrying cells, as far as the step bound goes; return whether it was reached."""
        patches = list(self.patches.values())
        blocks = [patch.influence[np.ix_(patch.carrying, patch.carrying)] for patch in patches]
        coupling = np.vstack([np.outer(patch.weights[patch.carrying], patch.direction) for patch in patches])
        indentation = [
            patch.weights[patch.carrying] * (patch.approach - patch.separation[patch.carrying]) for patch in patches
        ]
        direction = self.hole_direction[self.hole_carrying]
        springs = self.hole_stiffness * direction.T @ direction
        preload = self.hole_stiffness * direction.T @ self.hole_approach[self.hole_carrying]
        # A roller none of whose cells carries is no part of the system: it is held where it is.
        idle = np.zeros(self.load.size, dtype=bool)
        idle[4:] = np.abs(coupling[:, 4:]).sum(axis=0) == 0.0
        springs += np.diag(np.where(idle, self.hole_stiffness, 0.0))
        right = np.concatenate((*indentation, preload - self.load))
        held = True
        try:
            solved = _factor(blocks, coupling, springs).solve(right)
        except RuntimeError:
            # Too few cells are left to hold the disc: a soft ground shows where it moves and which cells it meets.
            held = False
            ground = 1e-3 * self.hole_stiffness * np.eye(self.load.size)
            solved = _factor(blocks, coupling, springs + ground).solve(right)
        ends = np.cumsum([int(patch.carrying.sum()) for patch in patches])
        *pressures, displacement = np.split(solved, ends)
        step = displacement - self.displacement
        fraction = min(1.0, self.step_bound / max(float(np.max(np.abs(step))), 1e-300))
        self.displacement = self.displacement + fraction * step
        for patch, part in zip(patches, pressures, strict=True):
            pressure = np.zeros(patch.carrying.size)
            pressure[patch.carrying] = part
            patch.pressure = patch.pressure + fraction * (pressure - patch.pressure)
        return held and fraction == 1.0

    def refit_grids(self) -> float:
        """Lay the grids over the half-widths found; return the largest relative change of a loaded contact."""
        largest = max(patch.load for patch in self.patches.values())
        change = 0.0
        for patch in self.patches.values():
            found = patch.alone(self.displacement)
            if found is None or found.half_width == 0.0:
                continue
            if patch.load > 1e-2 * largest:
                change = max(change, abs(found.half_width / patch.half_width - 1.0))
            patch.half_width = found.half_width
        if change >= HALF_WIDTH_TOLERANCE:
            for patch in self.patches.values():
                patch.lay_grid()
        return change

    def solution(self, factorisations: int) -> ClearanceFreeSolution:
        """Return pose, loads and pressures."""
        loads = {key: patch.load for key, patch in self.patches.items()}
        alone = {key: patch.alone(self.displacement) for key, patch in self.patches.items() if key[0] == "pin"}
        approach = self.hole_approach + self.hole_direction @ self.displacement
        hole_load = self.hole_stiffness * np.maximum(approach, 0.0)
        unbalanced = hole_load @ self.hole_direction - self.load
        for key, patch in self.patches.items():
            unbalanced += loads[key] * patch.direction
        pressures = {pin: found.mid_pressure for (_, pin), found in alone.items() if found is not None}
        return ClearanceFreeSolution(
            pose=self.start[0] + self.displacement[:4] / self.lever,
            pin_load=np.array([loads.get(("pin", pin), 0.0) for pin in range(self.pins)]),
            roller_load=np.array([loads[("outer", roller)] for roller in range(self.rollers)]),
            pin_shaft_load=hole_load,
            pin_pressure_mid=np.array([pressures.get(pin, 0.0) for pin in range(self.pins)]),
            factorisations=factorisations,
            residual=float(np.max(np.abs(unbalanced))),
        )


def _factor(blocks: list[FloatArray], coupling: FloatArray, springs: FloatArray) -> SuperLU:
    """LU of the matrix of Eq. 30; RuntimeError when it is singular."""
    matrix = sparse.bmat(
        [
            [sparse.block_diag([*map(sparse.coo_array, blocks)]), sparse.csr_array(-coupling)],
            [sparse.csr_array(-coupling.T), -springs],
        ],
        format="csc",
    )
    return factor_sparse(matrix)
