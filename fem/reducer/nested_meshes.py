r"""A drive on nested meshes: every figure of its solution with observed order, Richardson's value and error bar.

The coarsest meshes are graded for the contacts and have edges of twice the size asked for; each further solution has every
triangle divided into four (`fem.mesh.uniform_refinement`), the same contact zones and candidates. So one family of meshes stands
behind each estimate (`fem.discretisation_error`), and only the size of its elements changes.

Theory gives the orders above which an observed one counts as chance. A pressure ends like a square root, so the displacement lies
in :math:`H^{5/2 - \epsilon}` and quadratic elements converge in energy by 3/2, whatever their order; displacements of bodies and
loads, which are linear functionals of it, by twice that (Brenner & Scott, *The Mathematical Theory of Finite Element Methods*,
5.4 and 5.7), 3. Pressures are piecewise linear, order 2; the nodal stress along walls, averaged on one side, order 2.

Figures are followed at one place: contacts by their number, walls at that node of the coarsest mesh, clear of contacts on every
mesh, where the finest has the largest stress.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.discretisation_error import ErrorEstimate, estimate_error
from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.contact_results import ContactResults
from fem.drive.disc_stress import DiscStress, recover_disc_stress
from fem.drive.fields import bore_motion
from fem.drive.grading import FINE_SHARE
from fem.errors import MeshError
from fem.mesh.memory_need import require_memory, solution_memory
from fem.mesh.uniform_refinement import CHILDREN
from fem.options import DEFAULT_OPTIONS, SolutionOptions
from fem.reducer.solution import ReducerSolution, settle_pose, solve_reducer, solve_refined
from fem.reducer.wall_references import STRESS_ORDER, WallReference, wall_references
from ltca.arrays import FloatArray
from ltca.drive.members.verdict_words import part_words
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.quantities import QUANTITIES

FEWEST_MESHES, MOST_MESHES = 3, 5
COARSEST_SIZE = 2.0
"""Edge of the coarsest meshes by the size asked for: at a size of 1 four elements to a half-width, which give its pressure."""
NESTED_GROWTH = 0.5
"""Growth of the edge by distance from a contact: all of it is refined, and 0.3 would take half as much memory again."""
ENERGY_ORDER = 3.0
"""Order of displacements of bodies and of loads under contacts whose pressure ends like a square root."""
PRESSURE_ORDER = 2.0
"""Order of pressures and half-widths."""
WALLS = {"root_stress": "flank", "bore_stress": "bore", "hole_stress": "hole"}
"""Largest stresses along walls, and how the names of these boundaries begin."""
SHEARS = {"pin_shear_max": "wheel pin", "roller_shear_max_outer": "roller", "pin_shaft_shear_max": "shaft pin"}
"""Shear stresses below contacts, and the part that presses there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshLevel:
    """Solution on one of the meshes, without its matrices.

    Attributes
    ----------
    size : float
        Element edge as a multiple of the default.
    unknowns : int
        Of all discs.
    seconds : float
        Wall time of the solution.
    wheel_angle : float
        rad.
    bearing : array, shape (discs, cranks, 2)
        Bearing forces on the discs along the eccentric and 90° ahead, N.
    motion : array, shape (discs, 3)
        Displacement x, y (mm) and rotation (rad) of each disc fitted to its bores.
    contacts : tuple of ContactResults
        Of each disc.
    stresses : tuple of DiscStress
        Of each disc.
    """

    size: float
    unknowns: int
    seconds: float
    wheel_angle: float
    bearing: FloatArray
    motion: FloatArray
    contacts: tuple[ContactResults, ...]
    stresses: tuple[DiscStress, ...]

    @classmethod
    def of_solution(cls, solution: ReducerSolution) -> MeshLevel:
        """Return the level of a solution."""
        motions = [bore_motion(disc) for disc in solution.discs]
        return cls(
            size=solution.discs[0].options.refined_size,
            unknowns=solution.unknowns,
            seconds=solution.seconds["total"],
            wheel_angle=solution.wheel_angle,
            bearing=np.array([disc.bearing_components for disc in solution.discs]),
            motion=np.array([(shift.real, shift.imag, rotation) for shift, rotation in motions]),
            contacts=tuple(disc.contacts for disc in solution.discs),
            stresses=tuple(recover_disc_stress(disc) for disc in solution.discs),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class NestedFigure:
    """One figure on all meshes.

    Attributes
    ----------
    quantity : str
        By its name in `ltca.quantities`.
    place : str
        Contact or wall; "" for a figure of the drive.
    disc, part : int or None
        Numbers of disc, and of pin, roller, hole, crank or lobe; None where it has none.
    formal_order : float
        Order that theory allows.
    estimate : ErrorEstimate
        In the unit of the quantity.
    """

    quantity: str
    place: str
    disc: int | None
    part: int | None
    formal_order: float
    estimate: ErrorEstimate

    @property
    def unit(self) -> str:
        """Of values and bar."""
        return QUANTITIES[self.quantity].unit


@dataclass(frozen=True, slots=True, kw_only=True)
class NestedSolution:
    """A drive on nested meshes.

    Attributes
    ----------
    solution : ReducerSolution
        On the finest meshes.
    levels : tuple of MeshLevel
        From the coarsest.
    figures : tuple of NestedFigure
        With their error bars: wheel angle, contacts above 5 % of the largest load of their kind, bearing
        forces, motion of the discs, walls.
    references : tuple of WallReference
        Stress along walls against closed forms, on meshes of the same edges.
    """

    solution: ReducerSolution
    levels: tuple[MeshLevel, ...]
    figures: tuple[NestedFigure, ...]
    references: tuple[WallReference, ...]

    @property
    def largest(self) -> list[NestedFigure]:
        """The wheel angle, and of every other quantity the figure with the largest value on the finest meshes."""
        found: dict[str, NestedFigure] = {}
        for figure in self.figures:
            known = found.get(figure.quantity)
            if known is None or abs(figure.estimate.value) > abs(known.estimate.value):
                found[figure.quantity] = figure
        return list(found.values())


@names_unit_mistakes
def solve_nested(
    drive: Drive,
    crank_angle: float,
    options: SolutionOptions = DEFAULT_OPTIONS,
    *,
    torque: float | None = None,
    meshes: int = FEWEST_MESHES,
    progress: Callable[[str], None] | None = None,
) -> NestedSolution:
    """Solve a drive at one crank angle on nested meshes.

    Parameters
    ----------
    drive : Drive
        The drive in one case, of any number of discs, either member held.
    crank_angle : float
        φ_C, rad.
    options : SolutionOptions
        The coarsest meshes have edges of twice its size.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    meshes : int
        How many, 3 to 5.
    progress : callable, optional
        Called with one line for each step.

    Returns
    -------
    NestedSolution
        All figures with their error bars.

    Raises
    ------
    ConvergenceError, DriveError
        As `fem.reducer.solution.solve_reducer`; the first also when contacts outgrow the zones of the coarsest meshes.
    MemoryLimitError
        When the finest meshes would not fit into memory; checked as soon as the coarsest are known.
    MeshError
        For a number of meshes out of range.
    """
    if not FEWEST_MESHES <= meshes <= MOST_MESHES:
        raise MeshError(f"{meshes} nested meshes: must be {FEWEST_MESHES} to {MOST_MESHES}")
    say = progress or (lambda _: None)
    coarsest = replace(options, size=COARSEST_SIZE * options.size, growth=max(NESTED_GROWTH, options.growth))

    def spoken(number: int) -> Callable[[str], None]:
        return lambda line: say(f"mesh {number} of {meshes}: {line}")

    try:
        solution = solve_reducer(drive, crank_angle, coarsest, torque=torque, progress=spoken(1))
    except MeshError:
        # Fast growth in a narrow place may end in too flat triangles; a drive is not refused for that.
        slow = replace(coarsest, growth=options.growth)
        solution = solve_reducer(drive, crank_angle, slow, torque=torque, progress=spoken(1))
    solution = settle_pose(solution, spoken(1))
    _require_finest(solution, meshes, spoken(1))
    levels = [MeshLevel.of_solution(solution)]
    for number in range(2, meshes + 1):
        coarse, output = solution.coarse, solution.torque
        # Its factors would stay in memory until those of the finer meshes are there.
        del solution
        solution = solve_refined(drive, output, coarse, progress=spoken(number))
        levels.append(MeshLevel.of_solution(solution))
    say("closed forms")
    disc, plane = solution.discs[0].model, options.plane
    return NestedSolution(
        solution=solution,
        levels=tuple(levels),
        figures=tuple(_figures(drive, levels)),
        references=tuple(
            wall_references(
                disc.shapes.disc, drive.materials.disc, plane, size=COARSEST_SIZE * options.size, meshes=meshes
            )
        ),
    )


def _require_finest(solution: ReducerSolution, meshes: int, say: Callable[[str], None]) -> None:
    """Raise MemoryLimitError when the finest of nested meshes would not fit into memory, told from the coarsest."""
    times = CHILDREN ** (meshes - 1)
    unknowns = [times * disc.meshes.factorised_unknowns for disc in solution.coarse]
    needed = sum(solution_memory(count) for count in unknowns)
    require_memory(sum(unknowns), needed, "the finest of the nested meshes")
    say(f"solved; the finest will take about {sum(unknowns):,} factorised unknowns and {needed / 1e9:.1f} GB")


def _figures(drive: Drive, levels: Sequence[MeshLevel]) -> Iterator[NestedFigure]:
    """Yield all figures with their estimates."""
    several = len(levels[-1].contacts) > 1
    singles = single_discs(drive)

    def figure(quantity: str, values: Sequence[float], order: float, **place: Any) -> NestedFigure:
        return NestedFigure(
            quantity=quantity,
            formal_order=order,
            estimate=estimate_error(values, order),
            **({"place": "", "disc": None, "part": None} | place),
        )

    yield figure("wheel_angle", [level.wheel_angle for level in levels], ENERGY_ORDER)
    for disc, single in enumerate(singles):
        of = f", disc {disc}" if several else ""
        yield from _contact_figures(single, levels, disc, of, figure)
        cranks = levels[-1].bearing.shape[1]
        for crank in range(cranks):
            for column, quantity in enumerate(("bearing_radial", "bearing_tangential")):
                yield figure(
                    quantity,
                    [float(level.bearing[disc, crank, column]) for level in levels],
                    ENERGY_ORDER,
                    place=(f"crank {crank}" if cranks > 1 else "disc") + of,
                    disc=disc,
                    part=crank,
                )
        for column, quantity in enumerate(("disc_x", "disc_y", "disc_rotation")):
            values = [float(level.motion[disc, column]) for level in levels]
            along = ", x" if column == 0 else ", y" if column == 1 else ""
            yield figure(quantity, values, ENERGY_ORDER, place="disc" + of + along, disc=disc)
        yield from _stress_figures(single, levels, disc, of, figure)


def _contact_figures(
    drive: Drive, levels: Sequence[MeshLevel], disc: int, of: str, figure: Callable[..., NestedFigure]
) -> Iterator[NestedFigure]:
    """Yield loads, pressures and half-widths of the contacts above 5 % of the largest load of their kind."""
    for names in CONTACT_KINDS.values():
        load = getattr(levels[-1].contacts[disc], names.load)
        for index in np.flatnonzero(load > FINE_SHARE * np.max(load, initial=0.0)).tolist():
            for quantity, order in (
                (names.load, ENERGY_ORDER),
                (names.pressure, PRESSURE_ORDER),
                (names.half_width, PRESSURE_ORDER),
            ):
                yield figure(
                    quantity,
                    [float(getattr(level.contacts[disc], quantity)[index]) for level in levels],
                    order,
                    place=part_words(drive, names.part, index, len(load), 0) + of,
                    disc=disc,
                    part=index,
                )


def _stress_figures(
    drive: Drive, levels: Sequence[MeshLevel], disc: int, of: str, figure: Callable[..., NestedFigure]
) -> Iterator[NestedFigure]:
    """Yield the largest stress along each kind of wall, and the shear stresses below contacts."""
    stresses = [level.stresses[disc] for level in levels]
    for quantity, start in WALLS.items():
        best: tuple[float, str, list[float]] | None = None
        for number, wall in enumerate(stresses[0].walls):
            if not wall.name.startswith(start):
                continue
            clear = np.ones(len(wall.parameter), dtype=bool)
            for stress in stresses:
                # Nodes of the coarsest mesh are nodes of all others.
                own = stress.walls[number].parameter
                nearest = np.argmin(np.abs(np.angle(np.exp(1j * (own - wall.parameter[:, None])))), axis=1)
                clear &= stress.clear[number][nearest]
            if not clear.any():
                continue
            finest = np.where(clear, stresses[-1].walls[number].at(wall.parameter), -np.inf)
            node = int(np.argmax(finest))
            if best is None or finest[node] > best[0]:
                place = wall.parameter[node : node + 1]
                best = float(finest[node]), wall.name, [float(each.walls[number].at(place)[0]) for each in stresses]
        if best is not None:
            yield figure(quantity, best[2], STRESS_ORDER, place=best[1].replace("_", " ") + of, disc=disc)
    for quantity, part in SHEARS.items():
        values = np.array([getattr(stress, quantity) for stress in stresses])
        for index in np.flatnonzero(np.all(values > 0.0, axis=0)).tolist():
            below = "below " + part_words(drive, part, index, values.shape[1], 0) + of
            yield figure(quantity, values[:, index].tolist(), STRESS_ORDER, place=below, disc=disc, part=index)
