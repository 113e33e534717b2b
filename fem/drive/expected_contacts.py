r"""Where contacts are to be expected at a crank angle, with which load and half-width: a guess, for grading meshes.

All contacts are one-sided linear springs between rigid bodies, of stiffness π E* L/8 for a line contact (a
typical value: the approach depends on the load by a logarithm only), half of it for a roller with its two
contacts, and k_PS for a shaft pin. The potential of disc (x, y, rotation) and wheel (rotation) is minimised.
The guess places and sizes the small elements and may start the iteration of the pose; no result contains it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.drive.rigid_bodies import DISC_ROTATION, WHEEL_ANGLE, RigidBodies, X, Y
from fem.drive.supports import mean_spring
from ltca.arrays import BoolArray, ComplexArray, FloatArray
from ltca.drive.engine_support import require
from ltca.drive.hole_contact import hole_modulus, shaft_pins_yield
from ltca.drive.parts import Drive, contact_modulus
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.errors import ConvergenceError, DriveError, Problem

# Contacts under this share of the largest load get elements as if they carried it (design.md: 5 %).
SMALLEST_LOAD_SHARE = 0.05
# A contact open by less than this share of the largest approach may close in the real solution: refine it too.
OPEN_MARGIN = 0.25
APPROACH_LOGARITHM = 8.0


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


@dataclass(frozen=True, slots=True, kw_only=True)
class HertzContacts:
    """Half-widths of all contacts of a drive by the formula of Hertz.

    Attributes
    ----------
    drive : Drive
        For materials and lengths.
    rigid : RigidBodies
        For curvature and radii.
    smallest_share : float
        Candidates get the half-width of at least this share of the largest load of their kind.
    """

    drive: Drive
    rigid: RigidBodies
    smallest_share: float

    @property
    def pin_modulus(self) -> float:
        """E* of wheel pin and flank, MPa."""
        return contact_modulus(self.drive.materials.disc, self.drive.materials.wheel_pin)

    @property
    def outer_modulus(self) -> float:
        """E* of roller and bore, MPa."""
        return contact_modulus(self.drive.materials.disc, self.drive.materials.roller)

    @property
    def inner_modulus(self) -> float:
        """E* of roller and inner race, MPa."""
        return contact_modulus(self.drive.materials.inner_race, self.drive.materials.roller)

    def on_flank(
        self, load: FloatArray, candidate: BoolArray, theta: FloatArray, direction: ComplexArray
    ) -> ContactGroup:
        """Return the contacts of wheel pins with the flank at θ; directions toward them, of any length."""
        radius = self.rigid.profile.effective_radius(theta, self.rigid.placement.wheel_pin_radii)
        return self._group(load, candidate, direction, radius, self.pin_modulus, self.drive.disc.thickness)

    def on_bore(self, load: FloatArray, candidate: BoolArray, direction: ComplexArray) -> ContactGroup:
        """Return the contacts of rollers with the bores."""
        roller, bore = self.rigid.placement.roller_radii, self.rigid.placement.bore_radius
        radius, length = roller * bore / (bore - roller), self.drive.roller_length
        return self._group(load, candidate, direction, radius, self.outer_modulus, length)

    def on_race(self, load: FloatArray, candidate: BoolArray, direction: ComplexArray) -> ContactGroup:
        """Return the contacts of rollers with the inner races."""
        roller, race = self.rigid.placement.roller_radii, self.rigid.placement.inner_race_radius
        radius, length = roller * race / (race + roller), self.drive.roller_length
        return self._group(load, candidate, direction, radius, self.inner_modulus, length)

    def in_holes(self, load: FloatArray, candidate: BoolArray, direction: ComplexArray) -> ContactGroup:
        """Return the contacts of shaft pins with the holes."""
        pin, hole = self.rigid.placement.shaft_pin_radii, self.rigid.placement.hole_radii
        modulus = hole_modulus(self.drive, rigid_shaft_pins=not shaft_pins_yield(self.drive))
        return self._group(load, candidate, direction, pin * hole / (hole - pin), modulus, self.drive.disc.thickness)

    def _group(
        self,
        load: FloatArray,
        candidate: BoolArray,
        direction: ComplexArray,
        radius: FloatArray,
        modulus: float,
        length: float,
    ) -> ContactGroup:
        graded = np.maximum(load, self.smallest_share * float(load.max(initial=0.0)))
        width = hertz_half_width(graded / length, radius, modulus)
        return ContactGroup(load=load, half_width=np.where(candidate, width, 0.0), direction=np.angle(direction))


def hertz_half_width(line_load: FloatArray, radius: FloatArray, modulus: float) -> FloatArray:
    r"""Return the half-width of a line contact, mm: :math:`\sqrt{4 q R/(\pi E^*)}` (Johnson, 1985, Eq. 4.43).

    q is the load by length, N/mm, R the effective radius, mm, and E* the contact modulus, MPa.

    Examples
    --------
    >>> round(float(hertz_half_width(100.0, 10.0, 113187.0)), 5)
    0.10606
    """
    return np.asarray(np.sqrt(4.0 * line_load * radius / (np.pi * modulus)))


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


def require_one_disc(drive: Drive) -> None:
    """Raise DriveError for a drive of several discs, where each disc is a problem by itself."""
    count = drive.disc.number_of_discs
    if count != 1:
        said = "must be 1 for finite elements of one disc alone"
        raise DriveError([Problem.of("disc.number_of_discs", f"= {count}", said, bound=("equal to", 1))])


def _minimise(rigid: RigidBodies, stiffness: FloatArray, moment: float) -> tuple[FloatArray, FloatArray]:
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
    require(drive, "FE mesh")
    return guess_contacts(drive, crank_angle, torque=torque, wheel_moment=wheel_moment)


def guess_contacts(
    drive: Drive, crank_angle: float, *, torque: float | None = None, wheel_moment: float | None = None
) -> ExpectedContacts:
    """Return what `expect_contacts` does, of a drive that has been accepted by a model: it looks at the plane alone."""
    rigid = RigidBodies.of_drive(drive, crank_angle)
    profile, placement = rigid.profile, rigid.placement
    hertz = HertzContacts(drive=drive, rigid=rigid, smallest_share=SMALLEST_LOAD_SHARE)
    pins, rollers = len(placement.wheel_pin_radii), len(placement.roller_radii)
    flank_stiffness = np.pi * hertz.pin_modulus * drive.disc.thickness / APPROACH_LOGARITHM
    roller_modulus = 1.0 / (1.0 / hertz.outer_modulus + 1.0 / hertz.inner_modulus)
    roller_stiffness = np.pi * roller_modulus * drive.roller_length / APPROACH_LOGARITHM
    counts = [pins, rollers, len(placement.hole_radii)]
    stiffness = np.repeat([flank_stiffness, roller_stiffness, mean_spring(drive)], counts)
    moment = drive.wheel_moment(torque) if wheel_moment is None else wheel_moment
    pose, approach = _minimise(rigid, stiffness, moment)
    ends = np.cumsum(counts)[:-1]
    loads = np.split(stiffness * np.maximum(approach, 0.0), ends)
    nearly = np.split(approach > -OPEN_MARGIN * approach.max(), ends)

    theta = rigid.flank_parameters(pose)
    n = profile.normal(theta) * np.exp(1j * pose[DISC_ROTATION])
    rays, hole_rays = rigid.roller_rays(), rigid.hole_rays(pose)
    turn_back = np.exp(-1j * pose[DISC_ROTATION])
    hole_direction = hole_rays / np.abs(hole_rays)
    return ExpectedContacts(
        crank_angle=float(crank_angle),
        disc_x=float(pose[X]),
        disc_y=float(pose[Y]),
        disc_rotation=float(pose[DISC_ROTATION]),
        wheel_angle=float(pose[WHEEL_ANGLE]),
        pins=hertz.on_flank(loads[0], nearly[0], theta, -n),
        flank_points=profile.flank(theta),
        rollers_outer=hertz.on_bore(loads[1], nearly[1], rays),
        rollers_inner=hertz.on_race(loads[1], nearly[1], -rays),
        bore_points=placement.bore_centres[placement.roller_cranks] + placement.bore_radius * rays * turn_back,
        race_points=placement.inner_race_radius * rays,
        holes=hertz.in_holes(loads[2], nearly[2], hole_direction),
        hole_points=placement.hole_centres + placement.hole_radii * hole_direction * turn_back,
    )
