"""Places and radii of pins, rollers and holes, errors included, as complex numbers in mm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.deviations import PlacementErrors
from ltca.drive.parts import Drive
from ltca.geometry.rotation import unit
from ltca.quantities import QUANTITIES

BatchScalar: TypeAlias = float | FloatArray
"""A number for one drive, an array of shape (positions, 1) for a batch of drives."""


def _filled(values: Sequence[float], count: int) -> FloatArray:
    return np.array(values, dtype=float) if len(values) else np.zeros(count)


def _circle(radius: float, count: int, errors: PlacementErrors) -> ComplexArray:
    """Places of the parts of a circle, mm."""
    rays = np.exp(2j * np.pi * np.arange(count) / count)
    return np.asarray((radius + _filled(errors.radial, count) + 1j * _filled(errors.tangential, count)) * rays)


def _of_shaft(drive: Drive) -> dict[str, Any]:
    """Pins of the pin shaft and their holes; empty arrays without pin shaft."""
    shaft, count = drive.pin_shaft, drive.number_of_holes
    if shaft is None:
        nowhere = dict.fromkeys(
            ("hole_centres", "shaft_pin_centres", "hole_leans", "shaft_pin_leans"), np.zeros(0, complex)
        )
        return nowhere | dict.fromkeys(("hole_radii", "shaft_pin_radii", "shaft_pin_plays"), np.zeros(0))
    leans = shaft.inclination.lean + _leans(shaft.pin_errors, count)
    (plane,) = drive.disc.disc_planes
    return {
        "hole_centres": _circle(shaft.pin_circle_radius, count, drive.disc.hole_errors),
        "hole_radii": drive.hole_radius + 0.5 * _filled(drive.disc.hole_errors.diameter, count),
        "shaft_pin_centres": _circle(shaft.pin_circle_radius, count, shaft.pin_errors) + plane * leans,
        "shaft_pin_radii": shaft.pin_radius + 0.5 * _filled(shaft.pin_errors.diameter, count),
        "shaft_pin_plays": np.full(count, shaft.seat_play),
        "hole_leans": _leans(drive.disc.hole_errors, count),
        "shaft_pin_leans": leans,
    }


def _leans(errors: PlacementErrors, count: int) -> ComplexArray:
    """Lean of the parts of a circle in the frame of the body that carries them (`ltca.geometry.coordinates`)."""
    return np.asarray(_filled(errors.inclination_y, count) - 1j * _filled(errors.inclination_x, count))


def _bore_centres(drive: Drive) -> ComplexArray:
    """Centres of the bores in the frame of the disc, errors of place included."""
    places, count = np.array(drive.crank.places), drive.crank.number
    errors = drive.disc.of[0].bore_errors if drive.disc.of else None
    if errors is None:
        return places
    shift = _filled(errors.radial, count) + 1j * _filled(errors.tangential, count)
    return np.asarray(places + shift * places / np.abs(places))


class Races(NamedTuple):
    """Inner races: centres from the crank axes and from the origin, mm, shape (…, cranks), in the fixed frame (Eq. 47)."""

    lever: ComplexArray
    centre: ComplexArray

    @property
    def middle(self) -> ComplexArray:
        """Nominal place of the disc, mm: the centre of its inner race, the mean of several, shape (…,)."""
        return _mean(self.centre)

    @property
    def velocity(self) -> ComplexArray:
        """Derivative of `middle` by the crank angle, mm/rad, shape (…,)."""
        return 1j * _mean(self.lever)


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """Places and radii of pins, rollers (crank after crank) and holes, counter-clockwise, of a drive or a batch, mm and rad.

    Of a batch the position is on axis 0, single numbers have the shape (positions, 1). Wheel pins and their leans are in the
    frame of the wheel, holes in that of the disc, all else in the fixed frame.
    """

    wheel_pin_centres: ComplexArray = by_drive(1)
    wheel_pin_radii: FloatArray = by_drive(1)  # those of sleeves where there are some
    wheel_pin_plays: FloatArray = by_drive(1)  # radial: the flank sees a loose pin as a fixed one of radius r − play
    hole_centres: ComplexArray = by_drive(1)
    hole_radii: FloatArray = by_drive(1)  # with the pin-hole clearance
    shaft_pin_centres: ComplexArray = by_drive(1)
    shaft_pin_radii: FloatArray = by_drive(1)
    shaft_pin_plays: FloatArray = by_drive(1)
    roller_cage_angles: FloatArray = by_drive(1)
    roller_radii: FloatArray = by_drive(1)
    inner_race_radius: BatchScalar = by_drive(0)
    bore_radius: BatchScalar = by_drive(0)  # r_o with half the bearing clearance
    eccentricity: FloatArray = by_drive(1)  # actual ones of each crank, as the phases
    eccentric_phase: FloatArray = by_drive(1)
    crank_axes: ComplexArray = by_drive(1)
    bore_centres: ComplexArray = by_drive(1)
    wheel_axis: complex | ComplexArray = by_drive(0)
    wheel_pin_leans: ComplexArray = by_drive(1)  # without that of the wheel's axis
    hole_leans: ComplexArray = by_drive(1)
    shaft_pin_leans: ComplexArray = by_drive(1)
    wheel_lean: complex | ComplexArray = by_drive(0)
    crank_lean: complex | ComplexArray = by_drive(0)
    cage_speed: BatchScalar = by_drive(0)  # cage angle by crank angle, r_i/(r_i + r_o) with the nominal r_o
    reduction_ratio: float

    @classmethod
    def of_drive(cls, drive: Drive) -> Placement:
        """Return the places of the parts of a drive of one disc, `ltca.drive.single_discs` (Eq. 49–50, 78)."""
        drive.require_warmed()
        wheel, bearing, crank = drive.pin_wheel, drive.crank_bearing, drive.crank
        pins, rollers = wheel.number_of_pins, bearing.number_of_rollers
        oversize = 0.5 * _filled(wheel.pin_errors.diameter, pins)
        pitch_radius = bearing.inner_race_radius + bearing.roller_radius
        pocket_error = _filled(bearing.roller_errors.tangential, rollers) / pitch_radius
        cage_angles = 2.0 * np.pi * np.arange(rollers) / rollers + pocket_error + drive.disc.phase
        roller_radii = bearing.roller_radius + 0.5 * _filled(bearing.roller_errors.diameter, rollers)
        eccentrics = [crank.eccentric(0, number) for number in range(crank.number)]
        errors = [entry.eccentricity_error for entry in eccentrics]
        # Inclined axes pass through the places of their parts at the zero of the planes.
        (plane,) = drive.disc.disc_planes
        pin_leans = _leans(wheel.pin_errors, pins)
        return cls(
            wheel_pin_centres=_circle(wheel.pin_circle_radius, pins, wheel.pin_errors) + plane * pin_leans,
            wheel_pin_radii=wheel.pin_radius + oversize,
            wheel_pin_plays=wheel.seat_play - (oversize if wheel.seat.kind == "slot" else np.zeros(pins)),
            **_of_shaft(drive),
            roller_cage_angles=np.tile(cage_angles, crank.number),
            roller_radii=np.tile(roller_radii, crank.number),
            inner_race_radius=bearing.inner_race_radius,
            bore_radius=drive.bore_radius,
            eccentricity=crank.eccentricity + np.array([crank.eccentricity_error if e is None else e for e in errors]),
            eccentric_phase=drive.disc.phase + np.array([entry.phase_error for entry in eccentrics]),
            crank_axes=crank.axis_offset.place + np.array(crank.places) + plane * crank.inclination.lean,
            bore_centres=_bore_centres(drive),
            wheel_axis=wheel.axis_offset.place + plane * wheel.inclination.lean,
            wheel_pin_leans=pin_leans,
            wheel_lean=wheel.inclination.lean,
            crank_lean=crank.inclination.lean,
            cage_speed=bearing.inner_race_radius / (bearing.inner_race_radius + bearing.outer_race_radius),
            reduction_ratio=drive.reduction_ratio,
        )

    @property
    def cranks(self) -> int:
        """Number of cranks."""
        return int(self.eccentricity.shape[-1])

    @property
    def roller_cranks(self) -> NDArray[np.intp]:
        """Number of the crank of each roller, shape (cranks · n_BR,)."""
        rollers = self.roller_radii.shape[-1]
        return np.asarray(np.arange(rollers) // (rollers // self.cranks))

    @property
    def mean_eccentricity(self) -> FloatArray:
        """Mean e of the cranks, mm, shape (1,), of a batch (positions, 1)."""
        return np.asarray(self.eccentricity.mean(axis=-1, keepdims=True))

    @property
    def inner_effective_radii(self) -> FloatArray:
        """Effective radii of rollers and inner race, 1/(1/r_BR + 1/r_i), mm, shape (cranks · n_BR,)."""
        return np.asarray(1.0 / (1.0 / self.roller_radii + 1.0 / self.inner_race_radius))

    @property
    def outer_effective_radii(self) -> FloatArray:
        """Effective radii of rollers and bore, 1/(1/r_BR − 1/r_o), mm, shape (cranks · n_BR,)."""
        return np.asarray(1.0 / (1.0 / self.roller_radii - 1.0 / self.bore_radius))

    @property
    def hole_effective_radii(self) -> FloatArray:
        """Effective radii of shaft pins and holes, 1/(1/r_PS − 1/r_PSH), mm, shape (z_PS,)."""
        return np.asarray(1.0 / (1.0 / self.shaft_pin_radii - 1.0 / self.hole_radii))

    def eccentric_directions(self, crank_angle: FloatArray) -> ComplexArray:
        """Return unit vectors from crank axes to inner-race centres, the radial directions; tangential times i (Eq. 75–76)."""
        return unit(np.asarray(crank_angle)[..., None] + self.eccentric_phase)

    def eccentric_direction(self, crank_angle: FloatArray) -> ComplexArray:
        """Return the unit vector of the disc's eccentricity, at the mean phase of its eccentrics, in the fixed frame."""
        return unit(np.asarray(crank_angle) + self.eccentric_phase.mean(axis=-1))

    def races(self, crank_angle: FloatArray) -> Races:
        """Return the inner races at crank angles, rad, shape (…,) (Eq. 45, 47)."""
        lever = self.eccentricity * self.eccentric_directions(crank_angle)
        return Races(lever, self.crank_axes + lever)

    def roller_angles(self, crank_angle: FloatArray) -> FloatArray:
        """Return θ_b,n of all rollers (Eq. 14), rad, shape (…, cranks · n_BR)."""
        return np.asarray(self.cage_speed * np.asarray(crank_angle)[..., None] + self.roller_cage_angles)

    def roller_rays(self, crank_angle: FloatArray) -> ComplexArray:
        """Return the unit vectors of the cage rays, e^{iθ_b,n}, in the fixed frame, shape (…, cranks · n_BR)."""
        turn = unit(self.cage_speed * np.asarray(crank_angle)[..., None])
        return np.asarray(turn * unit(self.roller_cage_angles))

    def wheel_rotation(self, crank_angle: FloatArray) -> FloatArray:
        """Return φ_P = φ_C/u, the ideal rotation of the wheel, rad."""
        return np.asarray(crank_angle) / self.reduction_ratio


def _mean(values: ComplexArray) -> ComplexArray:
    """Mean over the cranks."""
    return values[..., 0] if values.shape[-1] == 1 else np.asarray(values.mean(axis=-1))


def position_angles(positions: int) -> FloatArray:
    """Return the crank angles of a run of N positions over one turn: 2πk/N, rad."""
    return 2.0 * np.pi * np.arange(positions) / positions


def place_coordinates(
    drives: Mapping[str, Drive], discs: Sequence[Sequence[Placement]], crank_angle: FloatArray
) -> dict[str, Any]:
    """Return the coordinates of a dataset without loads: crank angles, numbers and places of the parts of every disc."""
    first = discs[0][0]

    def of_discs(name: str) -> NDArray[Any]:
        return np.array([[getattr(place, name) for place in case] for case in discs])

    wheel_pins, shaft_pins = (of_discs(name)[:, 0] for name in ("wheel_pin_centres", "shaft_pin_centres"))
    holes, cages = of_discs("hole_centres"), of_discs("roller_cage_angles")
    values = {
        "crank_angle": crank_angle,
        "pin_x": wheel_pins.real,
        "pin_y": wheel_pins.imag,
        "hole_x": holes.real,
        "hole_y": holes.imag,
        "shaft_pin_x": shaft_pins.real,
        "shaft_pin_y": shaft_pins.imag,
        "roller_angle": cages.reshape(*cages.shape[:2], first.cranks, -1),
        "disc_phase": [drive.disc.disc_phases for drive in drives.values()],
        "disc_plane": [drive.disc.disc_planes for drive in drives.values()],
        "cage_speed": [float(case[0].cage_speed) for case in discs],
        "driving_sign": [drive.driving_sign for drive in drives.values()],
    }
    sizes = {
        "disc": len(discs[0]),
        "crank": first.cranks,
        "position": crank_angle.size,
        "pin": first.wheel_pin_radii.size,
        "roller": first.roller_radii.size // first.cranks,
        "hole": first.hole_radii.size,
    }
    numbers = {name: np.arange(size) for name, size in sizes.items()}
    return {"case": list(drives), **numbers, **{name: QUANTITIES[name].labelled(each) for name, each in values.items()}}
