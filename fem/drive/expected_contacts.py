r"""Where contacts are to be expected at a crank angle, with which load and half-width: a guess, for grading meshes.

All contacts are one-sided linear springs between rigid bodies, of stiffness π E* L/8 for a line contact (a
typical value: the approach depends on the load by a logarithm only), half of it for a roller with its two
contacts, and k_PS for a shaft pin. The potential of disc (x, y, rotation) and wheel (rotation) is minimised.
The guess places and sizes the small elements and may start the iteration of the pose; no result contains it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.contact.hertz import hertz_half_width
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.engine_support import require
from ltca.drive.hole_contact import hole_modulus, shaft_pins_yield
from ltca.drive.parts import Drive, contact_modulus
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement

# Contacts under this share of the largest load get elements as if they carried it (design.md: 5 %).
SMALLEST_LOAD_SHARE = 0.05
# A contact open by less than this share of the largest approach may close in the real solution: refine it too.
OPEN_MARGIN = 0.25
APPROACH_LOGARITHM = 8.0
# Places of the coordinates in a pose.
X, Y, DISC_ROTATION, WHEEL_ANGLE = range(4)


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactGroup:
    """Contacts of one kind at one crank angle; arrays over all parts of the kind.

    Attributes
    ----------
    load : array of float
        Expected load, N; 0 where open.
    half_width : array of float
        Hertz half-width, mm, at the expected load or 5 % of the largest load, whichever is more; 0 where no
        contact is to be expected, not even nearly.
    direction : array of float
        Polar angle, fixed axes, of the contact as seen from the centre of pin, roller, race or hole, rad.
    """

    load: FloatArray
    half_width: FloatArray
    direction: FloatArray

    @classmethod
    def of_loads(
        cls,
        load: FloatArray,
        candidate: NDArray[np.bool_],
        direction: ComplexArray,
        *,
        smallest_share: float,
        length: float,
        effective_radius: FloatArray,
        modulus: float,
    ) -> ContactGroup:
        """Return contacts with the half-widths that Hertz gives their loads.

        Parameters
        ----------
        load : array
            N.
        candidate : array of bool
            Which of them get a half-width.
        direction : array of complex
            Toward the contact, of any length.
        smallest_share : float
            Share of the largest load for which candidates get a half-width at least.
        length : float
            Of the line contacts, mm.
        effective_radius : array
            mm.
        modulus : float
            E*, MPa.
        """
        graded = np.maximum(load, smallest_share * float(load.max(initial=0.0)))
        width = hertz_half_width(graded / length, effective_radius, modulus)
        return cls(load=load, half_width=np.where(candidate, width, 0.0), direction=np.angle(direction))


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedContacts:
    """Expected contacts of a drive at one crank angle.

    Attributes
    ----------
    crank_angle : float
        rad.
    disc_x, disc_y, disc_rotation, wheel_angle : float
        Pose of the guess: displacement of the disc from its nominal place, fixed axes, mm; rad.
    pins : ContactGroup
        Wheel pin against flank; direction from the pin centre.
    flank_points : array of complex, shape (z_P,)
        The same contacts on the flank, disc frame, mm.
    rollers_outer, rollers_inner : ContactGroup
        Roller against bore and race; direction from the roller centre.
    bore_points : array of complex, shape (cranks · n_BR,)
        Outer contacts on the bores, disc frame, mm.
    race_points : array of complex, shape (cranks · n_BR,)
        Inner contacts on the races, each about its own centre, mm.
    holes : ContactGroup
        Shaft pin against hole; direction from the hole centre.
    hole_points : array of complex, shape (z_PS,)
        The same contacts on the hole walls, disc frame, mm.
    """

    crank_angle: float
    disc_x: float
    disc_y: float
    disc_rotation: float
    wheel_angle: float
    pins: ContactGroup
    flank_points: ComplexArray
    rollers_outer: ContactGroup
    rollers_inner: ContactGroup
    bore_points: ComplexArray
    race_points: ComplexArray
    holes: ContactGroup
    hole_points: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class _RigidDrive:
    """Approaches of all contacts of rigid bodies at a pose (x, y, disc rotation, wheel angle)."""

    profile: FlankProfile
    placement: Placement
    crank_angle: float

    def wheel_pins(self, wheel_angle: float) -> ComplexArray:
        turn = self.crank_angle / self.placement.reduction_ratio + wheel_angle
        return np.asarray(self.placement.wheel_pin_centres * np.exp(1j * turn))

    def flank_parameters(self, pose: FloatArray) -> FloatArray:
        centre = self.disc_centre(pose)
        in_disc = (self.wheel_pins(pose[WHEEL_ANGLE]) - centre) * np.exp(-1j * pose[DISC_ROTATION])
        count = len(self.placement.wheel_pin_radii)
        start = self.crank_angle / self.placement.reduction_ratio + 2.0 * np.pi * np.arange(count) / count
        return self.profile.nearest_parameter(in_disc, on_turned_flank(self.profile, start))

    def disc_centre(self, pose: FloatArray) -> complex:
        return complex(self.placement.race_centre(np.asarray(self.crank_angle))) + complex(pose[X], pose[Y])

    def roller_rays(self) -> ComplexArray:
        return np.asarray(np.exp(1j * self.placement.roller_angles(np.asarray(self.crank_angle))))

    def hole_rays(self, pose: FloatArray) -> ComplexArray:
        """Vectors from hole centres to shaft-pin centres."""
        centres = self.disc_centre(pose) + self.placement.hole_centres * np.exp(1j * pose[DISC_ROTATION])
        return np.asarray(self.placement.shaft_pin_centres - centres)

    def approaches(self, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return approaches (pins, rollers, holes in a row) and their gradients, shape (contacts, 4)."""
        place, centre, turn = self.placement, self.disc_centre(pose), np.exp(1j * pose[DISC_ROTATION])
        pins = self.wheel_pins(pose[WHEEL_ANGLE])
        theta = self.flank_parameters(pose)
        in_disc = (pins - centre) / turn
        n = self.profile.normal(theta) * turn
        flank = place.wheel_pin_radii - self.profile.distance(in_disc, theta)
        flank_gradient = np.column_stack(
            [n.real, n.imag, (n.conjugate() * 1j * (pins - centre)).real, -(n.conjugate() * 1j * pins).real]
        )
        d = self.roller_rays()
        play = place.bore_radius - place.inner_race_radius - 2.0 * place.roller_radii
        shift = complex(pose[X], pose[Y])
        bores = bore_displacements(place, self.crank_angle, shift, pose[DISC_ROTATION])[place.roller_cranks]
        bearing = -(bores.real * d.real + bores.imag * d.imag) - play
        arm = (1j * place.bore_centres * turn)[place.roller_cranks]
        bearing_gradient = np.column_stack([-d.real, -d.imag, -(d.conjugate() * arm).real, np.zeros(len(d))])
        ray = self.hole_rays(pose)
        m = ray / np.abs(ray)
        hole = np.abs(ray) + place.shaft_pin_radii - place.hole_radii
        arm = 1j * place.hole_centres * turn
        zero = np.zeros(len(m))
        hole_gradient = np.column_stack([-m.real, -m.imag, -(m.conjugate() * arm).real, zero])
        return (
            np.concatenate([flank, bearing, hole]),
            np.vstack([flank_gradient, bearing_gradient, hole_gradient]),
        )


def bore_displacements(
    placement: Placement, crank_angle: float, displacement: complex, rotation: float
) -> ComplexArray:
    """Return where the centre of each bore stands from that of the inner race in it, fixed axes, mm, shape (cranks,).

    Parameters
    ----------
    placement : Placement
        Places of the parts.
    crank_angle : float
        φ_C, rad.
    displacement : complex
        Of the disc from its nominal place, fixed axes, mm.
    rotation : float
        Of the disc, rad.
    """
    races = placement.race_centres(np.asarray(crank_angle))
    return np.asarray(races.mean() - races + displacement + placement.bore_centres * np.exp(1j * rotation))


def on_turned_flank(profile: FlankProfile, direction: FloatArray) -> FloatArray:
    """Return about which θ of the flank lies in a direction of the disc frame: θ counts from a root, which may be turned.

    Parameters
    ----------
    profile : FlankProfile
        The flank.
    direction : array
        Polar angle in the frame of the disc, rad.
    """
    return np.asarray(direction - np.angle(profile.turn)) if profile.is_turned else direction


def require_one_disc(drive: Drive) -> None:
    """Refuse a drive of several discs where each is a problem of its own.

    Raises
    ------
    DriveError
        Naming their number.
    """
    count = drive.disc.number_of_discs
    if count != 1:
        raise DriveError([f"disc.number_of_discs = {count}: must be 1 for finite elements of one disc alone"])


def _minimise(rigid: _RigidDrive, stiffness: FloatArray, moment: float) -> tuple[FloatArray, FloatArray]:
    """Return pose and approaches at the minimum of ½ Σ k δ₊² − T_load·wheel_angle (damped Newton)."""
    length = abs(rigid.placement.wheel_pin_centres[0])
    scale = np.array([1.0, 1.0, 1.0 / length, 1.0 / length])  # every unknown a length
    external = np.array([0.0, 0.0, 0.0, moment])
    pose = np.zeros(4)
    history: list[float] = []
    damping = 1e-3 * float(stiffness.max())

    def potential(pose: FloatArray, approach: FloatArray) -> float:
        return float(0.5 * np.sum(stiffness * np.maximum(approach, 0.0) ** 2) - moment * pose[WHEEL_ANGLE])

    approach, gradient = rigid.approaches(pose)
    value = potential(pose, approach)
    for _ in range(400):
        pushing = np.where(approach > 0.0, stiffness, 0.0)
        residual = (gradient.T @ (pushing * approach) - external) * scale
        history.append(float(np.max(np.abs(residual))))
        if history[-1] <= 1e-6 * abs(moment) / length:
            return pose, approach
        tangent = (gradient.T * pushing) @ gradient * np.outer(scale, scale)
        step = -scale * np.linalg.solve(tangent + damping * np.eye(4), residual)
        # Bodies that float before the first contact must not jump past it.
        step *= min(1.0, 0.2 / float(np.max(np.abs(step / scale))))
        trial = pose + step
        trial_approach, trial_gradient = rigid.approaches(trial)
        trial_value = potential(trial, trial_approach)
        if trial_value <= value + 1e-12 * abs(value):
            pose, approach, gradient, value = trial, trial_approach, trial_gradient, trial_value
            damping = max(0.2 * damping, 1e-9 * float(stiffness.max()))
        else:
            damping *= 10.0
    raise ConvergenceError(
        f"no balanced guess of the contact loads at crank angle {rigid.crank_angle:g} rad; largest residual in N",
        history,
    )


@names_unit_mistakes
def expect_contacts(
    drive: Drive, crank_angle: float, *, torque: float | None = None, wheel_moment: float | None = None
) -> ExpectedContacts:
    """Guess places, loads and half-widths of all contacts at a crank angle.

    Parameters
    ----------
    drive : Drive
        The drive in one case, of one disc.
    crank_angle : float
        φ_C, rad.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    wheel_moment : float, optional
        External moment on the wheel that the disc carries, N·mm; that of the torque in the mean over a turn by default.

    Returns
    -------
    ExpectedContacts
        For grading meshes.

    Raises
    ------
    ConvergenceError
        When nothing can carry the load.
    DriveError
        For several discs, and for what full finite elements refuse at any length (`ltca.drive.engine_support`).
    """
    profile, placement = FlankProfile.of_drive(drive), Placement.of_drive(drive)
    require(drive, "FE mesh")
    rigid = _RigidDrive(profile=profile, placement=placement, crank_angle=float(crank_angle))
    materials, thickness = drive.materials, drive.disc.thickness
    roller_length = drive.crank_bearing.roller_length
    pin_modulus = contact_modulus(materials.disc, materials.wheel_pin)
    outer_modulus = contact_modulus(materials.disc, materials.roller)
    inner_modulus = contact_modulus(materials.inner_race, materials.roller)
    at_hole = hole_modulus(drive, rigid_shaft_pins=not shaft_pins_yield(drive))

    pins, rollers = len(placement.wheel_pin_radii), len(placement.roller_radii)
    flank_stiffness = np.pi * pin_modulus * thickness / APPROACH_LOGARITHM
    roller_modulus = 1.0 / (1.0 / outer_modulus + 1.0 / inner_modulus)
    roller_stiffness = np.pi * roller_modulus * roller_length / APPROACH_LOGARITHM
    counts = [pins, rollers, len(placement.hole_radii)]
    stiffness = np.repeat([flank_stiffness, roller_stiffness, drive.hole_stiffness], counts)
    moment = drive.wheel_moment(torque) if wheel_moment is None else wheel_moment
    pose, approach = _minimise(rigid, stiffness, moment)
    ends = np.cumsum(counts)[:-1]
    loads = np.split(stiffness * np.maximum(approach, 0.0), ends)
    nearly = np.split(approach > -OPEN_MARGIN * approach.max(), ends)

    theta = rigid.flank_parameters(pose)
    n = profile.normal(theta) * np.exp(1j * pose[DISC_ROTATION])
    rays, hole_rays = rigid.roller_rays(), rigid.hole_rays(pose)
    radius, hole_radius = placement.roller_radii, placement.hole_radii
    hole_effective = placement.shaft_pin_radii * hole_radius / (hole_radius - placement.shaft_pin_radii)
    outer_effective = radius * placement.bore_radius / (placement.bore_radius - radius)
    inner_effective = radius * placement.inner_race_radius / (placement.inner_race_radius + radius)

    def group(kind: int, effective: FloatArray, modulus: float, length: float, ray: ComplexArray) -> ContactGroup:
        return ContactGroup.of_loads(
            loads[kind],
            nearly[kind],
            ray,
            smallest_share=SMALLEST_LOAD_SHARE,
            length=length,
            effective_radius=effective,
            modulus=modulus,
        )

    turn_back = np.exp(-1j * pose[DISC_ROTATION])
    hole_direction = hole_rays / np.abs(hole_rays)
    return ExpectedContacts(
        crank_angle=float(crank_angle),
        disc_x=float(pose[X]),
        disc_y=float(pose[Y]),
        disc_rotation=float(pose[DISC_ROTATION]),
        wheel_angle=float(pose[WHEEL_ANGLE]),
        pins=group(0, profile.effective_radius(theta, placement.wheel_pin_radii), pin_modulus, thickness, -n),
        flank_points=profile.flank(theta),
        rollers_outer=group(1, outer_effective, outer_modulus, roller_length, rays),
        rollers_inner=group(1, inner_effective, inner_modulus, roller_length, -rays),
        bore_points=placement.bore_centres[placement.roller_cranks] + placement.bore_radius * rays * turn_back,
        race_points=placement.inner_race_radius * rays,
        holes=group(2, hole_effective, at_hole, thickness, hole_direction),
        hole_points=placement.hole_centres + hole_radius * hole_direction * turn_back,
    )
