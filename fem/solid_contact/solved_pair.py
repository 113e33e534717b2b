"""Two blocks pressed together: meshes graded to the contact, solution, pressures along the width, errors.

The blocks are as wide and as deep as asked for, held in all directions at sides and bottom, with free ends along the
axis. Half of them serves where surfaces are symmetric, and half of their length in each class. Meshes are graded for
the contact that is expected; where another is found they are graded again.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fem.contact.coupling import PairIntegrals, Pose, integrate_pair
from fem.contact.pressure_measures import peak_of, pressure_moments
from fem.errors import MeshError
from fem.mesh.memory_need import require_memory
from fem.solid.layers import Layers, Parity, with_middles
from fem.solid_contact.block import Block, circle_height, graded_columns, graded_rows, make_block
from fem.solid_contact.bodies import CondensedSolid, Face, condense_solid
from fem.solid_contact.displaced import surface_gaps, weighted_correction
from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.pressing import PressedFaces, press_faces
from fem.solid_contact.widths import WidthGrid
from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError

ELEMENTS_PER_HALF_WIDTH = 8
FEWEST_ELEMENTS = 4
"""Elements for the half-width below which a pair is told to be coarse: with two of them load and pressure of a pin in its hole
were 1 and 4 % off another code's on the same mesh, with four 0.2 % and less."""
CELLS_PER_OVERLAP = 8
"""Layers over half of the length in contact, beside those that become thinner at its ends."""
ROOM, END_ROOM = 1.3, 1.9
"""Width of the zone by the half-width expected: at an end that carries a contact bulges."""
GROWTH_ALONG = 0.4
"""By how much layers grow by the distance from the end of the contact."""
END_CELL = 1.0 / 3.0
"""Thickness of the last layer at an end that carries, by the half-width."""
RIM, RIM_CELL = 0.15, 0.4
"""Stretch to both sides of the end of a contact that does not reach the end of the line, by its height, and the thickness of
layers there by that in the middle."""
NARROWEST = 5e-4
"""Least half-width by the depth of the block: meshes span both, and get larger without end; a surface is rough long before."""
ROUNDS = 4
"""Of meshes at most."""
REFINE, COARSEN = 1.15, 0.6
"""Meshes are graded again where the half-width expected is more than the first, or less than the second, of the one found."""
# Entries of CHOLMOD's factor of a block by unknowns^(4/3): 24.3, 24.9, 24.6 measured with 14,000, 43,000, 105,000 of them.
ENTRIES = 25.0
# Entries of the matrix for an unknown, 160 to 175, held as such and as the factor's input with their indices.
MATRIX_ENTRIES = 600.0
CORRECTION_TOLERANCE, CORRECTIONS = 1e-5, 12
"""Change of the gaps between displaced surfaces by the approach at which they have settled, and how often they are found anew:
each time leaves about the strain's share of the change before, some per cent in plastics."""
BEARING = 0.1
"""Gaps left are told where the pressure is above this part of the largest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PairLoad:
    """By what a pair is pressed.

    Attributes
    ----------
    load, approach : float or None
        One of them: N, or mm at mid-height from the first touch of straight surfaces.
    tilt : float
        rad; positive presses positive z.
    """

    load: float | None = None
    approach: float | None = None
    tilt: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PairMeshes:
    """Sizes to which the meshes of a pair are graded.

    Attributes
    ----------
    size : float
        Element edge as a multiple of the default, an eighth of the half-width.
    block : float
        Half the width of the blocks, and their depth, mm.
    overhang : float
        Of bodies beyond their own length at each end, mm: 0 for true ends; large ones make half-spaces of them.
    """

    size: float = 1.0
    block: float
    overhang: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SolvedPair:
    """Two bodies pressed together.

    Attributes
    ----------
    pair : SolidPair
        The bodies.
    meshes : PairMeshes
        Their sizes.
    blocks : tuple of Block
        Meshes of the cross-sections: carrier, body opposite.
    layers : tuple of array
        Ends of the layers of both for z ≥ 0, mm.
    width : WidthGrid
        Heights of the pressure.
    x : array, shape (n,)
        Places of the pressures along the arc, ascending, mm; of half a contact its mirror image as well.
    pressure : array, shape (n, heights)
        MPa, over all heights of `height`.
    height : array, shape (heights,)
        mm.
    approach, tilt, load, moment : float
        mm, rad, N, N·mm, of the whole pair.
    line_load, peak, half_width : array, shape (heights,)
        N/mm, MPa and mm along the width.
    largest_pressure, largest_height : float
        MPa, and at which height, mm.
    energy, energy_error : float
        Strain energy of the whole pair, N·mm; relative difference of the displacements' energy and the pressures' work.
    gap_left : tuple of float
        Root mean square and largest gap or overlap left at the nodes where pressure is high, by the approach.
    unknowns, rounds : int
        Of both bodies; meshes that were graded.
    seconds : float
        Wall time.
    """

    pair: SolidPair
    meshes: PairMeshes
    blocks: tuple[Block, Block]
    layers: tuple[FloatArray, FloatArray]
    width: WidthGrid
    x: FloatArray
    pressure: FloatArray
    height: FloatArray
    approach: float
    tilt: float
    load: float
    moment: float
    line_load: FloatArray
    peak: FloatArray
    half_width: FloatArray
    largest_pressure: float
    largest_height: float
    energy: float
    energy_error: float
    gap_left: tuple[float, float]
    unknowns: int
    rounds: int
    seconds: float

    @property
    def element_edge(self) -> float:
        """Width of the elements where there is contact, mm."""
        return float(np.diff(self.x).max())

    @property
    def elements_per_half_width(self) -> float:
        """Elements for the largest half-width; 0 where the pair is open."""
        return float(self.half_width.max(initial=0.0) / self.element_edge)

    @property
    def load_factor(self) -> float:
        """K_Hβ: largest by mean line load."""
        mean = self.load / self.pair.length
        return float(self.line_load.max() / mean) if mean > 0.0 else 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class _Expected:
    """What meshes are graded for: half-width, overlap at heights |z| up to `reach`, mm, and whether the ends carry."""

    half_width: float
    reach: float
    ends: bool


def solve_pair(
    pair: SolidPair, load: PairLoad, meshes: PairMeshes, progress: Callable[[str], None] = lambda _: None
) -> SolvedPair:
    """Press a pair together; see `PairLoad` and `PairMeshes`.

    Raises
    ------
    MeshError
        When sizes do not go together or memory would not do.
    ConvergenceError
        When meshes do not settle, or no pressures balance the load.
    """
    start = time.perf_counter()
    if (load.load is None) == (load.approach is None):
        raise MeshError("give either a load or an approach of the pair")
    expected = _expect(pair, load, meshes)
    history: list[float] = []
    for number in range(1, ROUNDS + 1):
        solved = _solve_on(pair, load, meshes, expected, progress, number, start)
        history.append(expected.half_width)
        found = float(solved.half_width.max(initial=0.0))
        if solved.load == 0.0:
            return solved
        first_column = 0 if not pair.symmetric else -1
        runs_out = bool(np.any(solved.pressure[-1] > 0.0) or np.any(solved.pressure[first_column] > 0.0))
        bad = found * REFINE < expected.half_width or found * COARSEN > expected.half_width
        # Where an end carries that was not expected to, or the contact reaches further.
        touched = np.abs(solved.height[solved.line_load > 0.0]).max(initial=0.0)
        ends = bool(touched >= 0.5 * pair.length * (1.0 - 1e-9))
        further = touched > 1.15 * expected.reach or (ends and not expected.ends)
        if not (runs_out or bad or further):
            return solved
        widened = 1.3 * found if runs_out and not bad else found
        expected = _Expected(half_width=widened, reach=max(touched, 1e-3 * pair.length), ends=ends)
    raise ConvergenceError("meshes of the pair did not settle; half-widths they were graded for, mm", history)


def _expect(pair: SolidPair, load: PairLoad, meshes: PairMeshes) -> _Expected:
    """The contact of slices side by side, each with the stiffness of a line in a block."""
    z = np.linspace(-0.5, 0.5, 401) * pair.length
    relief = np.nan_to_num(pair.relief(z), posinf=1e3)
    modulus, radius = pair.contact_modulus, pair.effective_radius

    def overlap(approach: float) -> FloatArray:
        return np.maximum(approach + load.tilt * z - relief, 0.0)

    slope = np.pi * modulus / 8.0
    if load.approach is not None:
        depth = overlap(load.approach)
        if not depth.max() > 0.0:
            first = float(np.min(relief - load.tilt * z))
            raise MeshError(
                f"approach = {load.approach:g} mm of {pair.name}: must be greater than {first:.3g} mm, where surfaces touch first"
            )
    else:
        wanted = float(load.load or 0.0)
        if not wanted > 0.0:
            raise MeshError(f"load {wanted:g} N of the pair: must be greater than 0 N")

        def missing(approach: float) -> float:
            return float(slope * np.mean(overlap(approach)) * pair.length - wanted)

        low = float(relief.min()) - abs(load.tilt) * pair.length
        high = low + 2.0 * abs(load.tilt) * pair.length + 1e-6
        while missing(high) < 0.0:
            high = low + 2.0 * (high - low)
        depth = overlap(float(brentq(missing, low, high)))
    half_width = float(np.sqrt(4.0 * slope * depth.max() * radius / (np.pi * modulus)))
    pressed = np.abs(z[depth > 0.0])
    return _Expected(
        half_width=half_width,
        reach=float(pressed.max()),
        ends=bool(max(depth[0], depth[-1]) > 0.02 * depth.max()),
    )


def grade_heights(
    length: float, extent: float, expected_reach: float, ends: bool, half_width: float, size: float
) -> tuple[FloatArray, int]:
    """Return ends of layers for 0 ≤ z ≤ `extent`, mm, and how many layers the half-length of the contact has.

    Parameters
    ----------
    length : float
        Of the line of contact, mm.
    extent : float
        Half the length of the body, mm, at least half of the line.
    expected_reach : float
        Height up to which there is contact, mm.
    ends : bool
        Whether the ends of the line carry.
    half_width, size : float
        mm, and the multiple of the default sizes.
    """
    half = 0.5 * length
    coarsest = size * min(expected_reach, half) / CELLS_PER_OVERLAP
    finest = min(size * END_CELL * half_width, coarsest)

    def within(z: FloatArray) -> FloatArray:
        if ends:
            return np.minimum(coarsest, finest + GROWTH_ALONG * (half - z))
        # Thinner about the end of the contact: where it lies within a layer moves the moment.
        away = np.maximum(np.abs(z - expected_reach) - RIM * expected_reach, 0.0)
        rise = RIM_CELL * coarsest + GROWTH_ALONG * away
        return np.where(z > expected_reach, rise, np.minimum(coarsest, rise))

    inner = _divide(0.0, half, within)
    last = inner[-1] - inner[-2]
    outer = (
        _divide(half, extent, lambda z: last + 2.0 * GROWTH_ALONG * (z - half)) if extent > half + 1e-9 else inner[-1:]
    )
    return np.concatenate([inner, outer[1:]]), inner.size - 1


def _divide(low: float, high: float, size: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Divide a stretch into cells of about a size that varies along it."""
    z = np.linspace(low, high, 2001)
    density = 1.0 / size(z)
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(z))])
    number = max(int(np.ceil(count[-1] - 1e-6)), 1)
    found = np.interp(np.linspace(0.0, count[-1], number + 1), count, z)
    found[0], found[-1] = low, high
    return np.asarray(found)


def factor_memory(unknowns: int) -> float:
    """Return the bytes that matrix and factor of a block take."""
    return float(8.0 * (ENTRIES * float(unknowns) ** (4.0 / 3.0) + MATRIX_ENTRIES * unknowns))


def _solve_on(
    pair: SolidPair,
    load: PairLoad,
    meshes: PairMeshes,
    expected: _Expected,
    progress: Callable[[str], None],
    number: int,
    start: float,
) -> SolvedPair:
    size, width = meshes.size, expected.half_width
    edge = size * width / ELEMENTS_PER_HALF_WIDTH
    zone = (END_ROOM if expected.ends else ROOM) * width
    if not zone < min(meshes.block, pair.shape_reach):
        raise MeshError(
            f"the contact of {pair.name} is {width:.3g} mm wide to each side: too wide for a block of "
            f"{meshes.block:g} mm whose surfaces have their shape up to {pair.shape_reach:.3g} mm"
        )
    if width < NARROWEST * meshes.block:
        raise MeshError(
            f"the contact of {pair.name} is {width:.2g} mm wide to each side: must be at least {NARROWEST:g} of the depth of the "
            f"block, {NARROWEST * meshes.block:.2g} mm; give a larger load or approach, or a smaller block"
        )
    columns, zone_columns = graded_columns(edge, zone, meshes.block)
    rows = graded_rows(edge, 0.5 * width, meshes.block)
    lower = make_block(
        pair.carrier, pair.carrier_height, columns, zone_columns, rows, above=False, symmetric=pair.symmetric
    )
    upper = make_block(
        pair.opposite, circle_height(1.0 / pair.radius, pair.shape_reach), columns, zone_columns, rows,
        above=True, symmetric=pair.symmetric,
    )  # fmt: skip
    layers = []
    for extent in (pair.carrier_length, pair.opposite_length):
        half = 0.5 * extent + meshes.overhang
        layers.append(grade_heights(pair.length, half, expected.reach, expected.ends, width, size))
    inner = layers[0][0][: layers[0][1] + 1]
    even = pair.even and load.tilt == 0.0
    heights = WidthGrid(heights=inner if even else np.concatenate([-inner[:0:-1], inner]), even=even)
    parities: tuple[Parity, ...] = ("symmetric",) if even else ("symmetric", "antisymmetric")
    blocks = (lower, upper) if pair.opposite_material is not None else (lower,)
    classes = [[Layers(vertices=ends, parity=parity) for parity in parities] for ends, _ in layers]
    unknowns = [
        block.section.node_count * each.unknowns_per_node
        for block, own in zip(blocks, classes, strict=False)
        for each in own
    ]
    needed = sum(factor_memory(count) for count in unknowns)
    require_memory(sum(unknowns), needed, f"blocks of {pair.name} with size {size:g}")
    progress(
        f"mesh {number}: {sum(unknowns):,} unknowns, about {needed / 1e9:.2g} GB; an interrupt waits for a body's factor"
    )
    zone_below = lower.pressure_zone(pair.curve)
    opposite = upper.opposite_zone(1j * pair.radius) if len(blocks) == 2 else None
    integrals = integrate_pair(zone_below, Pose(), Pose(centre=1j * pair.radius), pair.radius, opposite)
    faces = [Face(plane=zone_below.load_shapes(2 * lower.section.node_count), width=heights)]
    if opposite is not None:
        faces.append(Face(plane=upper.plane_loads(opposite, integrals.opposite_loads), width=heights))
    materials = (pair.carrier_material, pair.opposite_material)
    bodies = tuple(
        condense_solid(
            block.section, own, material, [face], block.held, progress
        )
        for block, own, material, face in zip(blocks, classes, materials, faces, strict=False)
        if material is not None
    )  # fmt: skip
    share = 2.0 if pair.symmetric else 1.0
    pressed = _press(pair, load, (lower, upper), heights, bodies, integrals, share)
    return _read(
        pair,
        meshes,
        (lower, upper),
        (layers[0][0], layers[1][0]),
        heights,
        bodies,
        integrals,
        pressed,
        share,
        number,
        start,
    )


def _read(
    pair: SolidPair,
    meshes: PairMeshes,
    blocks: tuple[Block, Block],
    layers: tuple[FloatArray, FloatArray],
    width: WidthGrid,
    bodies: tuple[CondensedSolid, ...],
    integrals: PairIntegrals,
    pressed: PressedFaces,
    share: float,
    number: int,
    start: float,
) -> SolvedPair:
    """Results of the whole pair from the part that is meshed."""
    pressure = pressed.pressure[::-1]
    zone = blocks[0].pressure_zone(pair.curve)
    arc = zone.arc[-1] - zone.arc[::-1]
    surface = blocks[0].surface_edges
    x = blocks[0].section.places[0][np.append(surface[:, 0], surface[-1, 2])]
    along = width.heights
    if width.even:
        pressure, along = np.concatenate([pressure[:, :0:-1], pressure], axis=1), np.concatenate([-along[:0:-1], along])
    if pair.symmetric:
        pressure, arc = np.concatenate([pressure[:0:-1], pressure]), np.concatenate([-arc[:0:-1], arc])
        x = np.concatenate([-x[:0:-1], x])
    smooth = smooth_along_width(along, pressure)
    line, peak, half = np.zeros(along.size), np.zeros(along.size), np.zeros(along.size)
    for place in range(along.size):
        total, _, square = pressure_moments(arc, smooth[:, place])
        line[place] = total
        if total > 0.0:
            half[place] = 2.0 * float(np.sqrt(square))
            peak[place] = peak_of(arc, smooth[:, place], half[place])
    top = int(np.argmax(peak))
    energy = share * pressed.energy
    strain = share * sum(body.energy(pressed.solution.pressure) for body in bodies)
    error = abs(strain - share * pressed.work) / energy if energy > 0.0 else 0.0
    return SolvedPair(
        pair=pair, meshes=meshes, blocks=blocks, layers=layers, width=width, x=x, pressure=pressure, height=along,
        approach=pressed.approach, tilt=pressed.tilt, load=share * pressed.load, moment=share * pressed.moment,
        line_load=line, peak=peak, half_width=half, largest_pressure=float(peak[top]), largest_height=float(along[top]),
        energy=energy, energy_error=error, gap_left=_gap_left(pair, blocks, width, bodies, pressed),
        unknowns=sum(body.unknowns for body in bodies), rounds=number, seconds=time.perf_counter() - start,
    )  # fmt: skip


def smooth_along_width(along: FloatArray, pressure: FloatArray) -> FloatArray:
    """Return vertex values of a pressure, shape (places, heights), without what projection adds along the width, MPa.

    Vertex values of a projection lie above a smooth pressure by h²|p″|/12, means under their hats below it as much.
    """
    return np.asarray(0.5 * (pressure + _hat_means(along, pressure)))


def _hat_means(along: FloatArray, values: FloatArray) -> FloatArray:
    """Means of piecewise linear values under the hats of the inner vertices; the outer two keep theirs."""
    cell = np.diff(along)
    left, right = cell[:-1], cell[1:]
    inner = left * (values[:, :-2] + 2.0 * values[:, 1:-1]) + right * (2.0 * values[:, 1:-1] + values[:, 2:])
    found = values.copy()
    found[:, 1:-1] = inner / (3.0 * (left + right))
    return found


def _press(
    pair: SolidPair,
    load: PairLoad,
    blocks: tuple[Block, Block],
    width: WidthGrid,
    bodies: tuple[CondensedSolid, ...],
    integrals: PairIntegrals,
    share: float,
) -> PressedFaces:
    """Faces pressed together until gaps close between the displaced surfaces."""
    zone = blocks[0].pressure_zone(pair.curve)
    correction = start = None
    history: list[float] = []
    while True:
        pressed = press_faces(
            bodies, integrals, width, direction=1j, relief=pair.relief, breaks=np.array(pair.breaks),
            approach=load.approach, load=None if load.load is None else load.load / share, tilt=load.tilt,
            correction=correction, start=start,
        )  # fmt: skip
        if pressed.load == 0.0:
            return pressed
        found = weighted_correction(zone, width, surface_gaps(pair, blocks, width, bodies, pressed))
        # Where nothing touches a gap is not what pressures depend on.
        carries = pressed.pressure.ravel() > 0.0
        change = found if correction is None else found - correction
        scale = np.outer(integrals.measure, width.moments(np.ones_like)).ravel() * abs(pressed.approach)
        history.append(float(np.max(np.abs(change / scale)[carries])))
        if history[-1] < CORRECTION_TOLERANCE:
            return pressed
        if len(history) > CORRECTIONS:
            raise ConvergenceError(
                "gaps between displaced surfaces do not settle: strains are too large for linear elasticity; changes by the "
                "approach",
                history,
            )
        correction, start = found, pressed.solution.active


def _gap_left(
    pair: SolidPair,
    blocks: tuple[Block, Block],
    width: WidthGrid,
    bodies: tuple[CondensedSolid, ...],
    pressed: PressedFaces,
) -> tuple[float, float]:
    """Gap or overlap left between displaced surfaces under high pressure, root mean square and largest, by the approach."""
    if pressed.load == 0.0:
        return 0.0, 0.0
    z = with_middles(width.heights)
    at_vertices = pressed.pressure[::-1] @ width.hats(z).T
    spots = np.empty((2 * at_vertices.shape[0] - 1, z.size))
    spots[0::2], spots[1::2] = at_vertices, 0.5 * (at_vertices[1:] + at_vertices[:-1])
    gaps = surface_gaps(pair, blocks, width, bodies, pressed).displaced
    every = gaps[spots > BEARING * pressed.pressure.max()] / np.abs(pressed.approach)
    return float(np.sqrt(np.mean(every**2))), float(np.max(np.abs(every)))
