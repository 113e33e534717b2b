"""Stations: the places of a disc at which influence coefficients are derived, and the patches they carry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fem.errors import MeshError
from fem.mesh.disc_parts import FEWEST_CELLS, Cells, circles_alike, lobe_count, lobes_alike
from fem.shapes import Curve, DiscShape, Shape
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.geometry.boundary_stations import clustered_parameter
from ltca.reading.station_walls import LARGEST_DISTANCE, missed_between_stations

# Error of interpolation between the stations of the flank (six points), measured on the discs of `paper` and `robot-joint`
# against three to four times as many, in units of 2(1 − ν²)/(πEt), of approaches up to 13: at most 0.047 anywhere and 0.025 on
# working flanks, of which 0.02 is the rounding of the meshes. Uniform stations need 32 for each lobe for 0.12 and 0.01.
FLANK_PER_LOBE = 16
# Of flanks whose eccentricity is far from the largest that leaves no loops, e z_P/R up to 0.668: the shipped drives.
LEAST_CLUSTERING = 0.6
# From e z_P/R of 0.98; the stations at the tips are 39 times as far apart as in the roots.
MOST_CLUSTERING = 0.95
# Share of the distance of the poles at which six-point interpolation of the normals is best: see `root_clustering`.
POLE_SHARE = 0.74
# With fewer the strain of a lobe is not followed at all.
FEWEST_PER_LOBE = 8
# In holes 32 leave 0.02, 16 leave 0.2.
BORE = 48
PER_HOLE = 24
RACE_ANGLES = 96
# Half-width of the patches against the smallest radius of curvature and the narrowest wall: what a patch of that
# width feels of the curvature is then 0.3 (b/R)², below 0.1 % of the unit 2(1 − ν²)/(πEt) of the near field.
PATCH_SHARE = 0.05
# Stress stations for each station on bore and holes: from station to station interpolation leaves up to 3 % of the
# largest stress of a disc whose holes leave ligaments of two thirds of their radius.
STRESS_PER_STATION = 2
WIDE_STEP = 16
# A patch twice as wide, up to 0.8 of the distance of stations, stays within its cell.
FEWEST_IN_CELL = 4
# Neighbouring patches keep apart, however many stations there are.
SPACING_SHARE = 0.4


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscStations:
    """Stations of the disc: flank first, then bores, then holes.

    Attributes
    ----------
    boundary : array of int, shape (stations,)
        0 flank, 1 … s the bores of s cranks, then the holes.
    parameter : array, shape (stations,)
        Parameter of the boundary curve over [0, 2π), rad: uniform on bores and holes, closer in the roots of the flank
        (`ltca.geometry.boundary_stations`).
    points : array of complex, shape (stations,)
        In the disc frame, mm.
    normals : array of complex, shape (stations,)
        Unit normals out of the disc.
    half_width : array, shape (stations,)
        Half-width of the patch, mm.
    """

    boundary: IntArray
    parameter: FloatArray
    points: ComplexArray
    normals: ComplexArray
    half_width: FloatArray

    @classmethod
    def of_disc(cls, shape: DiscShape, scale: float = 1.0) -> DiscStations:
        """Return the stations of a disc: `scale` times 16 for each lobe (at least 8), 48 on each bore and 24 on each hole.

        MeshError when the scale is out of bounds.
        """
        if not (np.isfinite(scale) and 0.25 <= scale <= 8.0):
            raise MeshError(
                f"stations {scale:g}: must be at least 0.25 and at most 8 (a multiple of the default number)"
            )
        width = patch_half_width(shape)
        lobes = round(shape.flank.profile.reduction_ratio) - 1
        numbers = [
            max(FEWEST_PER_LOBE, round(FLANK_PER_LOBE * scale)) * lobes,
            *[round(BORE * scale)] * len(shape.bores),
        ]
        numbers += [round(PER_HOLE * scale)] * len(shape.holes)
        parameters = []
        for index, (curve, number) in enumerate(zip(shape.curves, numbers, strict=True)):
            parameters.append(_parameters(number, shape, index))
            spacing = float(np.abs(np.diff(curve.points(np.append(parameters[-1], 2.0 * np.pi)))).min())
            width = min(width, SPACING_SHARE * spacing)
        return cls(
            boundary=np.repeat(np.arange(len(numbers)), numbers),
            parameter=np.concatenate(parameters),
            points=np.concatenate([curve.points(own) for curve, own in zip(shape.curves, parameters, strict=True)]),
            normals=np.concatenate([curve.normals(own) for curve, own in zip(shape.curves, parameters, strict=True)]),
            half_width=np.full(sum(numbers), width),
        )

    @property
    def count(self) -> int:
        """Number of stations."""
        return len(self.boundary)

    def refined(self, shape: DiscShape) -> DiscStations:
        """Return the places at which stresses are measured: the stations on the flank, twice as many on bores and holes.

        Between thin ligaments the stress along a hole changes over a tenth of its length. Patches and measured arcs on one
        wall either coincide or do not overlap.
        """
        parameters, widths = [], []
        for index, curve in enumerate(shape.curves):
            own = self.boundary == index
            count, width = int(np.count_nonzero(own)), float(self.half_width[own].min())
            times = STRESS_PER_STATION if index else 1
            parameters.append(_parameters(times * count, shape, index))
            spacing = float(np.abs(np.diff(curve.points(np.append(parameters[-1], 2.0 * np.pi)))).min())
            widths.append(width if times == 1 else _stress_width(width, spacing))
        numbers = [len(own) for own in parameters]
        return DiscStations(
            boundary=np.repeat(np.arange(len(numbers)), numbers),
            parameter=np.concatenate(parameters),
            points=np.concatenate([curve.points(own) for curve, own in zip(shape.curves, parameters, strict=True)]),
            normals=np.concatenate([curve.normals(own) for curve, own in zip(shape.curves, parameters, strict=True)]),
            half_width=np.repeat(widths, numbers),
        )

    def cells(self, shape: DiscShape) -> list[Cells]:
        """Return the walls of a disc that consist of cells alike: the flank of its lobes, circles of a few stations each.

        There are none where patches differ in width.
        """
        found: list[Cells] = []
        if np.ptp(self.half_width) > 0.0:
            return found
        if lobes_alike(shape):
            lobes = lobe_count(shape)
            last = np.count_nonzero(self.boundary == 0) // lobes // 2
            found.append(Cells(walls=(0,), count=lobes, cut=float(np.mean(self.parameter[last : last + 2]))))
        for first, circles in ((1, shape.bores), (1 + len(shape.bores), shape.holes)):
            own = np.flatnonzero(self.boundary == first)
            count = _cells_of_circle(len(own))
            if count and circles_alike(circles):
                circle, walls = circles[0], range(first, first + len(circles))
                last, width = own[len(own) // count // 2], float(self.half_width[own[0]])
                spacing = 2.0 * np.pi / len(own)
                # Midway between the patch of a station and the arc of the stress station next to it.
                narrow = _stress_width(width, spacing / STRESS_PER_STATION * circle.radius)
                gap = 0.5 * (spacing / STRESS_PER_STATION + (width - narrow) / circle.radius)
                found.append(Cells(walls=tuple(walls), count=count, cut=float(self.parameter[last]) + gap))
        return found

    def of_cell(self, cells: Cells, copy: int, times: int = 1) -> IntArray:
        """Return the stations in a copy of a cell; of stations of which `times` as many were there when it was cut."""
        wall, number = divmod(copy, cells.count)
        own = np.flatnonzero(self.boundary == cells.walls[wall])
        each = len(own) // cells.count
        return own[(times * (each // times // 2) + 1 + each * number + np.arange(each)) % len(own)]

    def wide(self, cells: list[Cells]) -> IntArray:
        """Return the stations that also carry wider patches: some 16 apart, each in the middle of a cell."""
        steps = {wall: each.count for each in cells for wall in each.walls}
        chosen = []
        for wall in np.unique(self.boundary).tolist():
            own = np.flatnonzero(self.boundary == wall)
            each = len(own) // steps[wall] if wall in steps else 1
            chosen.append(own[:: each * max(round(WIDE_STEP / each), 1)])
        return np.concatenate(chosen)

    @property
    def coarse_walls(self) -> str | None:
        """Warning about walls on which the stations are too far apart; None where they are close enough everywhere."""
        missed, wall, distance = missed_between_stations(self.boundary, self.points)
        if missed < 1.0:
            return None
        times = distance / (LARGEST_DISTANCE * wall)
        return (
            f"stations {distance:.3g} mm apart on a wall of {wall:.3g} mm do not follow what happens across it: loads and "
            f"stresses there are coarse, and two laws of the stresses say nothing; {times:.2g} times as many "
            f"(cyclo derive --stations) stand at most {LARGEST_DISTANCE * wall:.3g} mm apart"
        )

    def resultants(self) -> FloatArray:
        """Return force in x, y and moment about the disc centre of a newton into the disc, shape (3, stations)."""
        inward = -self.normals
        return np.stack([inward.real, inward.imag, (self.points.conjugate() * inward).imag])


def _cells_of_circle(stations: int) -> int:
    """Return of how many cells a bore or hole consists: at least four stations each; 0 where their number has no such divisor."""
    counts = [count for count in range(FEWEST_CELLS, stations // FEWEST_IN_CELL + 1) if stations % count == 0]
    return max(counts, default=0)


def _stress_width(width: float, spacing: float) -> float:
    """Return the half-width of the arc of a stress station beside patches of a half-width."""
    return min(width, spacing - width)


def root_clustering(shape: DiscShape) -> float:
    r"""Return how much closer the stations of the flank stand in its roots, a of `ltca.geometry.boundary_stations`.

    The normal of the flank has the direction of :math:`1 - \lambda e^{iz\theta}` against that of the pitch circle, with
    :math:`\lambda = e u/R`: near 1 it turns by more than 90° within the part :math:`1 - \lambda` of a root, with poles at
    :math:`z \theta = \pm i \ln(1/\lambda)`, and approaches turn with it. In the parameter t the poles are farthest from the
    real axis where :math:`\ln(1/\lambda) = y - \tanh y`, :math:`\cosh y = 1/a`. Interpolation over six of 16 stations is best
    at 0.7 to 0.75 of that logarithm (measured for λ from 0.67 to 0.96): the normal is then off by 0.0005 at λ = 0.67, 0.0032 at
    0.85 and 0.0087 at 0.92; with 0.6 for all of them it was off by 0.04 and 0.18 at the latter two.
    """
    profile = shape.flank.profile
    ratio = float(np.max(np.asarray(profile.eccentricity * profile.reduction_ratio / profile.generating_radius)))
    pole = -POLE_SHARE * np.log(min(ratio, 1.0)) if ratio > 0.0 else np.inf
    least, most = np.arccosh(1.0 / MOST_CLUSTERING), np.arccosh(1.0 / LEAST_CLUSTERING)
    if pole >= most - np.tanh(most):
        return LEAST_CLUSTERING
    if pole <= least - np.tanh(least):
        return MOST_CLUSTERING
    return float(1.0 / np.cosh(brentq(lambda y: y - np.tanh(y) - pole, least, most, xtol=1e-12)))


def _parameters(number: int, shape: DiscShape, boundary: int) -> FloatArray:
    """Return the parameters of stations of a boundary, of which 0 is the flank with its lobes, rad."""
    uniform = 2.0 * np.pi * np.arange(number) / number
    lobes = round(shape.flank.profile.reduction_ratio) - 1
    return uniform if boundary else clustered_parameter(uniform, lobes, root_clustering(shape))


def smallest_radius(curves: tuple[Curve, ...]) -> float:
    """Return the smallest radius of curvature of curves, mm."""
    return min(
        float(curve.curvature_radius(np.linspace(0.0, 2.0 * np.pi, 4 * curve.samples, endpoint=False)).min())
        for curve in curves
    )


def patch_half_width(shape: Shape) -> float:
    """Return the half-width of the patches of a body, mm: small against its curvature and its narrowest wall.

    A rigid core is no place of contact; its curvature does not count, the wall around it does.
    """
    curves = tuple(curve for curve in shape.curves if curve.name not in ("core", "inner"))
    return PATCH_SHARE * min(smallest_radius(curves), shape.narrowest_wall)
