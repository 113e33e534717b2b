"""One pair of bodies cut out of a drive: surfaces, lengths, materials, profile and lead, and the load to be expected.

Of every pair the disc or the race carries the pressure, and what is opposite is round: pin, roller or shaft pin. The
frame is that of the contact, see `fem.solid_contact.block`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.expected_contacts import ContactGroup, guess_contacts
from fem.errors import MeshError
from fem.shapes import CircleCurve, Curve, FlankCurve
from fem.solid_contact.block import Height, circle_height
from fem.solid_contact.reliefs import relief_of
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.engine_support import require
from ltca.drive.hole_contact import shaft_pins_yield
from ltca.drive.parts import Drive, Material, contact_modulus
from ltca.drive.single_discs import single_discs
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement

PairName = Literal["flank", "bore", "race", "hole"]
PAIRS: tuple[PairName, ...] = ("flank", "bore", "race", "hole")
"""Wheel pin on the flank, roller in the bore, roller on the race, shaft pin in its hole."""
KIND_OF_PAIR: dict[PairName, PairKind] = {
    "flank": "pin",
    "bore": "roller_outer",
    "race": "roller_inner",
    "hole": "hole",
}
TRUE_SHAPE = 0.5
"""Surfaces have their true shape up to this part of the smaller radius from the contact, and go on along their tangent beyond."""
_SAMPLES = 801


def straight(z: FloatArray) -> FloatArray:
    """Return the relief of a straight line: none."""
    return np.zeros(np.shape(z))


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidPair:
    """Two bodies with a line of contact, in the frame of the contact.

    Attributes
    ----------
    name : str
        Of the contact.
    carrier, opposite : str
        Names of the bodies.
    curve : Curve
        Exact surface of the carrier.
    carrier_height : callable
        Its height over x, mm.
    effective_radius : float
        ρ where they touch, mm.
    radius : float
        Of the body opposite, mm.
    shape_reach : float
        Up to which distance from the contact the surfaces have their true shape, mm.
    carrier_material : Material
        Elastic constants.
    opposite_material : Material or None
        None for a rigid body.
    carrier_length, opposite_length : float
        Along the axis, mm; both are centred at z = 0.
    relief : callable
        By how much both together fall short of straight surfaces at heights, mm.
    breaks : tuple of float
        Heights of its kinks, mm.
    even : bool
        Whether the relief is even along the width.
    symmetric : bool
        Whether both surfaces are their own mirror images in x = 0.
    expected_load : float
        N, of the springs of `fem.drive.expected_contacts`; 0 where open.
    """

    name: str
    carrier: str
    opposite: str
    curve: Curve
    carrier_height: Height
    effective_radius: float
    radius: float
    shape_reach: float
    carrier_material: Material
    opposite_material: Material | None
    carrier_length: float
    opposite_length: float
    relief: Callable[[FloatArray], FloatArray] = straight
    breaks: tuple[float, ...] = ()
    even: bool = True
    symmetric: bool = True
    expected_load: float = 0.0

    @property
    def length(self) -> float:
        """Of the line of contact, mm: that of the shorter body."""
        return min(self.carrier_length, self.opposite_length)

    @property
    def contact_modulus(self) -> float:
        """E*, MPa."""
        if self.opposite_material is None:
            return 1.0 / self.carrier_material.plane_strain_compliance
        return contact_modulus(self.carrier_material, self.opposite_material)

    @classmethod
    def round_bodies(
        cls,
        radius: float,
        carrier_curvature: float,
        material: Material,
        length: float,
        *,
        carrier_length: float | None = None,
        relief: Callable[[FloatArray], FloatArray] = straight,
        even: bool = True,
    ) -> SolidPair:
        """Return a cylinder of a radius, mm, on one of a curvature, 1/mm, negative where convex; a flat for 0."""
        # A flat as a circle of 1e7 mm: its height over a block of 100 mm is 0.5 nm.
        curvature = carrier_curvature if carrier_curvature != 0.0 else -1e-7
        other = 1.0 / curvature
        reach = TRUE_SHAPE * min(radius, abs(other))
        return cls(
            name="two cylinders",
            carrier="carrier",
            opposite="roller",
            curve=CircleCurve(name="surface", radius=abs(other), centre=1j * other, encloses_body=other < 0.0),
            carrier_height=circle_height(curvature, reach),
            effective_radius=1.0 / (1.0 / radius - curvature),
            radius=radius,
            shape_reach=reach,
            carrier_material=material,
            opposite_material=material,
            carrier_length=length if carrier_length is None else carrier_length,
            opposite_length=length,
            relief=relief,
            even=even,
        )

    @classmethod
    def of_drive(
        cls, drive: Drive, pair: PairName, crank_angle: float, number: int | None = None, *, torque: float | None = None
    ) -> SolidPair:
        """Return a pair of the first disc of a drive at a crank angle.

        Parameters
        ----------
        drive : Drive
            The drive in one case.
        pair : {"flank", "bore", "race", "hole"}
            Which.
        crank_angle : float
            φ_C, rad.
        number : int, optional
            Of the pin, roller or hole; by default the one with the largest expected load.
        torque : float, optional
            Output torque of the expected loads, N·mm; the drive's own by default.

        Raises
        ------
        DriveError
            For what a pair alone cannot represent.
        MeshError
            When there is no such contact.
        """
        require(drive, "solid pair")
        drive = single_discs(drive)[0]
        expected = guess_contacts(drive, crank_angle, torque=torque)
        groups = {
            "flank": expected.pins, "bore": expected.rollers_outer, "race": expected.rollers_inner, "hole":
            expected.holes
        }  # fmt: skip
        place, group = Placement.of_drive(drive), groups[pair]
        index = _chosen(pair, group, number)
        load = float(group.load[index])
        name = CONTACT_KINDS[KIND_OF_PAIR[pair]].title_of(index, place)
        if pair == "flank":
            flank = _on_flank(drive, place, index, complex(expected.flank_points[index]), name, load)
            return _relieved(flank, drive, pair)
        parts, disc, rollers = drive.materials, drive.disc.thickness, drive.roller_length
        if pair == "hole":
            material = drive.hole_pin if shaft_pins_yield(drive) else None
            radii = float(place.hole_radii[index]), float(place.shaft_pin_radii[index])
            return _round(name, "disc", "shaft pin", radii[0], radii[1], parts.disc, material, disc, disc, load)
        radius = float(place.roller_radii[index])
        if pair == "bore":
            found = _round(
                name, "disc", "roller", float(place.bore_radius), radius, parts.disc, parts.roller, disc, rollers, load
            )
        else:
            # A race is no shorter than what rolls on it.
            race = max(disc, rollers)
            outer = -float(place.inner_race_radius)
            found = _round(name, "race", "roller", outer, radius, parts.inner_race, parts.roller, race, rollers, load)
        return _relieved(found, drive, pair)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedCurve:
    """A curve in the frame of a contact.

    Attributes
    ----------
    curve : Curve
        In the frame of its body.
    origin : complex
        Point of contact there, mm.
    normal : complex
        Unit normal out of the body there.
    """

    curve: Curve
    origin: complex
    normal: complex

    @property
    def name(self) -> str:
        """Name of the boundary."""
        return self.curve.name

    @property
    def encloses_body(self) -> bool:
        """Whether the body lies inside the curve."""
        return self.curve.encloses_body

    @property
    def samples(self) -> int:
        """How many equally spaced parameters resolve the shape."""
        return self.curve.samples

    @property
    def corners(self) -> tuple[float, ...]:
        """Parameters at which an edge has to end."""
        return self.curve.corners

    def points(self, parameter: FloatArray) -> ComplexArray:
        """Return points, mm."""
        return np.asarray((self.curve.points(parameter) - self.origin) * (1j * np.conj(self.normal)))

    def normals(self, parameter: FloatArray) -> ComplexArray:
        """Return unit normals out of the body."""
        return np.asarray(self.curve.normals(parameter) * (1j * np.conj(self.normal)))

    def curvature_radius(self, parameter: FloatArray) -> FloatArray:
        """Return the size of the radius of curvature, mm."""
        return self.curve.curvature_radius(parameter)

    def parameter_of(self, point: ComplexArray) -> FloatArray:
        """Return the parameter of the nearest point."""
        return self.curve.parameter_of(self.origin + np.asarray(point) * (-1j * self.normal))


def _chosen(pair: str, group: ContactGroup, number: int | None) -> int:
    if not group.load.size:
        raise MeshError(f"--pair {pair}: the drive has no such contact")
    if number is None:
        if not np.any(group.load > 0.0):
            raise MeshError(f"--pair {pair}: no such contact carries anything at this crank angle; give --contact")
        return int(np.argmax(group.load))
    if not 0 <= number < group.load.size:
        raise MeshError(f"--contact {number}: must be between 0 and {group.load.size - 1} for --pair {pair}")
    return number


def _relieved(found: SolidPair, drive: Drive, pair: PairName) -> SolidPair:
    """A pair with the relief that its kind of contacts has in a drive."""
    relief, kinks = relief_of(drive, KIND_OF_PAIR[pair])
    return found if relief is None else replace(found, relief=relief, breaks=tuple(kinks.tolist()))


def _round(
    name: str,
    carrier: str,
    opposite: str,
    wall: float,
    radius: float,
    carrier_material: Material,
    opposite_material: Material | None,
    carrier_length: float,
    opposite_length: float,
    load: float,
) -> SolidPair:
    """A round body on a wall of a radius, negative where that is convex."""
    return SolidPair(
        name=name,
        carrier=carrier,
        opposite=opposite,
        curve=CircleCurve(name="surface", radius=abs(wall), centre=1j * wall, encloses_body=wall < 0.0),
        carrier_height=circle_height(1.0 / wall, TRUE_SHAPE * min(abs(wall), radius)),
        effective_radius=1.0 / (1.0 / radius - 1.0 / wall),
        radius=radius,
        shape_reach=TRUE_SHAPE * min(abs(wall), radius),
        carrier_material=carrier_material,
        opposite_material=opposite_material,
        carrier_length=carrier_length,
        opposite_length=opposite_length,
        expected_load=load,
    )


def _on_flank(drive: Drive, place: Placement, index: int, point: complex, name: str, load: float) -> SolidPair:
    flank = FlankCurve(profile=FlankProfile.of_drive(drive))
    parameter = flank.parameter_of(np.array([point]))
    origin, normal = complex(flank.points(parameter)[0]), complex(flank.normals(parameter)[0])
    curve = PlacedCurve(curve=flank, origin=origin, normal=normal)
    radius, thickness = float(place.wheel_pin_radii[index]), drive.disc.thickness
    reach = TRUE_SHAPE * min(radius, float(flank.curvature_radius(parameter)[0]))
    return SolidPair(
        name=name,
        carrier="disc",
        opposite="wheel pin",
        curve=curve,
        carrier_height=_curve_height(curve, float(parameter[0]), reach),
        effective_radius=float(flank.profile.effective_radius(parameter, np.array([radius]))[0]),
        radius=radius,
        shape_reach=reach,
        carrier_material=drive.materials.disc,
        opposite_material=drive.flank_pin,
        carrier_length=thickness,
        opposite_length=thickness,
        even=drive.disc.lead_slope == 0.0,
        symmetric=False,
        expected_load=load,
    )


def _curve_height(curve: PlacedCurve, parameter: float, reach: float) -> Height:
    """Height over x of a smooth curve about a parameter, exact; along its tangents beyond the reach."""
    step = 1e-6
    speed = abs(complex(np.diff(curve.points(parameter + np.array([-step, step])))[0])) / (2.0 * step)
    around = parameter + np.linspace(-1.5, 1.5, _SAMPLES) * reach / speed
    along = curve.points(around).real
    order = np.argsort(along)
    if not (np.all(np.diff(along[order]) > 0.0) and along.min() < -reach and along.max() > reach):
        raise MeshError(f"the flank turns away within {reach:.3g} mm of the contact: no block can be cut there")
    inverse = CubicSpline(along[order], around[order])

    def height(x: FloatArray) -> FloatArray:
        inner = np.clip(x, -reach, reach)
        found = inverse(inner)
        # The spline is within 1e-9 of the place; one step of Newton's method makes it exact.
        points, normals = curve.points(found), curve.normals(found)
        slope = -normals.real / normals.imag
        return np.asarray(points.imag + slope * (x - points.real))

    return height
