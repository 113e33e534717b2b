"""Influence coefficients of bodies in closed form: a coefficient file without finite elements.

Disc, wheel pins and race are half-planes with a datum at a depth (pins and race rings held inside, where the drive says on
which core or bore), rollers are cylinders between two loads (K. L. Johnson,
*Contact Mechanics* (1985), section 5.6). Contacts of one boundary are coupled as on a half-plane, different boundaries are
not coupled. Results with such a file can be worked out by hand. Solid bodies are the same under loads linear along the width,
12/t² times it, with a datum of their own and rollers as long as they are.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.contact.round_bodies import held_ring_approach
from ltca.drive.parts import Drive, Material
from ltca.drive.single_discs import nominal_shape
from ltca.geometry.boundary_stations import LAGRANGE_POINTS, Boundary
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement
from ltca.reading.coefficient_schema import elastic_constants

if TYPE_CHECKING:
    import xarray as xr


PER_LOBE, BORE, PER_HOLE, RACE_ANGLES = 8, 12, 8, 24
CROSS_SHARE = 0.1
"""Approach at one end of a roller by the load at the other, as a fraction of the half-plane's unit."""


def closed_form_coefficients(
    drive: Drive, *, half_width: float, depth: float, tilt_depth: float | None = None
) -> xr.Dataset:
    """Return the content of a coefficient file of a drive in closed form (``docs/theory/coefficients.md``).

    `half_width` is that of all patches, mm, small against their distances; `depth` is the datum depth of disc, pins and
    race, mm. It must exceed the size of the disc (some 200 mm for the paper's), or loads in equilibrium do negative work
    and the file is refused. With a `tilt_depth`, that of linear loads, mm, bodies are solid.
    """
    found = _even_along_the_width(drive, half_width=half_width, depth=depth)
    if tilt_depth is None:
        return found
    wide, long = drive.disc.thickness, drive.roller_length
    linear = _even_along_the_width(drive, half_width=half_width, depth=tilt_depth)
    tilts = {f"{body}_tilt_approach": 12.0 / wide**2 * linear[f"{body}_approach"] for body in ("disc", "pin", "race")}
    tilts["roller_tilt_approach"] = 12.0 / long**2 * wide / long * linear["roller_approach"]
    solid = {
        "dimensions": 3,
        "plane": "solid",
        "shape": json.dumps(drive.body_shape("solid")),
        "fingerprint": drive.shape_fingerprint("solid"),
        "roller_length": long,
    }
    rollers = {"roller_approach": wide / long * found["roller_approach"]}
    return found.assign({**tilts, **rollers}).assign_attrs(solid)


def _even_along_the_width(drive: Drive, *, half_width: float, depth: float) -> xr.Dataset:
    """Content of the file of plane bodies."""
    import xarray as xr

    thickness, parts = drive.disc.thickness, drive.body_materials
    boundaries, normals = _stations(drive)
    numbers = [len(places) for places in boundaries]
    boundary = np.repeat(np.arange(len(boundaries)), numbers)
    parameter = np.concatenate([2.0 * np.pi * np.arange(number) / number for number in numbers])
    places = np.concatenate(boundaries)
    same = boundary[:, None] == boundary[None, :]
    disc = np.where(same, _half_plane(places, parts.disc, thickness, half_width, depth), 0.0)
    angle = 2.0 * np.pi * np.arange(RACE_ANGLES) / RACE_ANGLES
    on_race = drive.crank_bearing.inner_race_radius * np.exp(1j * angle)
    wheel, bearing = drive.pin_wheel, drive.crank_bearing
    race = _half_plane(on_race, parts.inner_race, thickness, half_width, depth)[0]
    if bearing.race_bore_radius is not None:
        radii = bearing.race_bore_radius, bearing.inner_race_radius
        race = _held_ring(*radii, parts.inner_race, thickness, half_width, angle)
    pin = _half_plane(np.zeros(1), parts.wheel_pin, thickness, half_width, depth)[0, 0]
    if wheel.core_radius is not None:
        pin = _held_ring(wheel.core_radius, wheel.pin_radius, parts.wheel_pin, thickness, half_width, np.zeros(1))[0]
    unit = _unit(parts.roller, thickness)
    squeezed = cylinder_approach(
        1.0 / thickness,
        half_width,
        drive.crank_bearing.roller_radius,
        parts.roller.youngs_modulus,
        parts.roller.poisson_ratio,
    )
    across = CROSS_SHARE * unit
    own = float(squeezed) - 0.25 * unit - across
    return xr.Dataset(
        {
            "station_boundary": ("station", boundary),
            "station_x": ("station", places.real),
            "station_y": ("station", places.imag),
            "station_parameter": ("station", parameter),
            "station_normal_x": ("station", normals.real),
            "station_normal_y": ("station", normals.imag),
            "station_half_width": ("station", np.full(places.shape, half_width)),
            "disc_approach": (("station", "station_loaded"), disc),
            "pin_approach": ((), pin),
            "pin_half_width": ((), half_width),
            "roller_approach": (("roller_end", "roller_end_loaded"), [[own, across], [across, own]]),
            "roller_half_width": ("roller_end", [half_width, half_width]),
            "race_angle": ("race_angle", angle),
            "race_approach": ("race_angle", race),
            "race_half_width": ((), half_width),
        },
        attrs={
            "drive": drive.name,
            "plane": "strain",
            "thickness": thickness,
            "fingerprint": drive.shape_fingerprint(),
            "shape": json.dumps(drive.body_shape()),
            "bearing_clearance": drive.clearance.bearing,
            "pin_hole_clearance": drive.clearance.pin_hole,
            "clearances_left_out": 0,
            "roller_radius": drive.crank_bearing.roller_radius,
            **elastic_constants(parts),
        },
    )


def _unit(material: Material, thickness: float) -> float:
    """2(1 − ν²)/(πEt), the unit of the near field of a half-plane, mm/N."""
    return 2.0 * (1.0 - material.poisson_ratio**2) / (np.pi * material.youngs_modulus * thickness)


def _held_ring(
    inner: float, outer: float, material: Material, thickness: float, half_width: float, angle: FloatArray
) -> FloatArray:
    """Approach of a ring held inside, at angles from a newton, mm."""
    kolosov = 3.0 - 4.0 * material.poisson_ratio
    return _unit(material, thickness) * held_ring_approach(inner, outer, half_width, kolosov, angle)


def _half_plane(
    places: ComplexArray | FloatArray, material: Material, thickness: float, half_width: float, depth: float
) -> FloatArray:
    """Approach between patches of a half-plane with a deep datum by a newton, mm.

    The mean over the loaded patch is a quarter of the unit less than that of its middle, which Johnson's form gives; a
    distant patch moves by −ln(distance) of the unit, and by the square of the width less.
    """
    unit = _unit(material, thickness)
    middle = half_plane_approach(1.0 / thickness, half_width, depth, material.youngs_modulus, material.poisson_ratio)
    own = float(middle) - 0.25 * unit
    distance = np.abs(places[:, None] - places[None, :])
    apart = distance > 0.0
    safe = np.where(apart, distance, half_width)
    # Both have the same part that does not depend on the distance: own is unit (−ln(b/2) + 1/4 + part).
    part = own / unit + np.log(0.5 * half_width) - 0.25
    far = unit * (part - np.log(safe) + half_width**2 / (4.0 * safe**2))
    return np.where(apart, far, own)


def _stations(drive: Drive) -> tuple[list[ComplexArray], ComplexArray]:
    """Return the stations of flank, bores and holes, uniform in their parameters, in the frame of the disc, mm; normals."""
    drive = nominal_shape(drive)
    place = Placement.of_drive(drive)

    def circle(count: int) -> ComplexArray:
        return np.asarray(np.exp(2j * np.pi * np.arange(count) / count))

    lobes = drive.disc.number_of_teeth
    profile, parameter = FlankProfile.of_drive(drive), 2.0 * np.pi * np.arange(PER_LOBE * lobes) / (PER_LOBE * lobes)
    holes = [
        centre + radius * circle(PER_HOLE) for centre, radius in zip(place.hole_centres, place.hole_radii, strict=True)
    ]
    bores = [centre + place.bore_radius * circle(BORE) for centre in place.bore_centres]
    normals = [profile.normal(parameter), *[-circle(BORE)] * len(bores), *[-circle(PER_HOLE)] * len(holes)]
    return [profile.flank(parameter), *bores, *holes], np.concatenate(normals)


def half_plane_approach(
    line_load: ArrayLike, half_width: ArrayLike, depth: ArrayLike, young_modulus: float, poisson_ratio: float
) -> FloatArray:
    """Return the approach of a point at a depth d ≫ b under a Hertz strip toward the surface of a half-plane, mm.

    δ = q (1−ν²)/(π E) (2 ln(2d/b) − ν/(1−ν)), plane strain (Johnson section 5.6).
    """
    q, b, d = (np.asarray(value, dtype=float) for value in (line_load, half_width, depth))
    compliance = (1.0 - poisson_ratio**2) / (np.pi * young_modulus)
    return np.asarray(q * compliance * (2.0 * np.log(2.0 * d / b) - poisson_ratio / (1.0 - poisson_ratio)))


def cylinder_approach(
    line_load: ArrayLike, half_width: ArrayLike, radius: ArrayLike, young_modulus: float, poisson_ratio: float
) -> FloatArray:
    """Return the approach of the centre of a cylinder, squeezed between two opposite contacts, toward one of them, mm.

    δ = q (1−ν²)/(π E) (2 ln(4R/b) − 1), plane strain (Johnson section 5.6, Eq. 5.57). The compression of the
    diameter is the sum of both sides with their half-widths (Eq. 5.58).
    """
    q, b, r = (np.asarray(value, dtype=float) for value in (line_load, half_width, radius))
    return np.asarray(q * (1.0 - poisson_ratio**2) / (np.pi * young_modulus) * (2.0 * np.log(4.0 * r / b) - 1.0))


def without_coupling(drive: Drive) -> InfluenceCoefficients:
    """Return coefficients that add nothing to the half-space: C = 0, the paper's model."""
    cranks, holes = drive.crank.number, drive.number_of_holes
    flank, *walls = [Boundary(first=k * LAGRANGE_POINTS, count=LAGRANGE_POINTS) for k in range(1 + cranks + holes)]
    return InfluenceCoefficients(
        fingerprint=drive.shape_fingerprint(),
        shared=False,
        plane="none",
        thickness=drive.disc.thickness,
        flank=flank,
        bores=tuple(walls[:cranks]),
        holes=tuple(walls[cranks:]),
        disc=np.zeros(((1 + cranks + holes) * LAGRANGE_POINTS,) * 2),
        pin=0.0,
        roller=np.zeros((2, 2)),
        race=np.zeros(LAGRANGE_POINTS),
        disc_logarithm=0.0,
        pin_logarithm=0.0,
        roller_logarithm=0.0,
        race_logarithm=0.0,
    )
