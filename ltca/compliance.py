"""Loads of all contact pairs at a pose, with half-space compliance: pairs that do not feel each other.

A compliance model answers one question for a batch of positions, `respond`: which generalised force do the
contacts exert at this pose, and what is its tangent? `ltca.equilibrium` asks nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ltca.drive import Drive, contact_modulus
from ltca.line_contact import LineContactLaw
from ltca.pairs import ContactGeometry, FlankMotion, PairMotion
from ltca.roller_series import RollerLaws, RollerState, balance_rollers

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def law_for_profile(profile, *, length, radius, contact_modulus, effective_radii):  # TEMPORARY
    return LineContactLaw(length, contact_modulus)


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Contacts of a batch of positions at given poses.

    Attributes
    ----------
    force : array, shape (positions, 4)
        Generalised contact force Σ F ∂δ/∂q: N, N, N·mm, N·mm.
    tangent : array, shape (positions, 4, 4)
        Its derivative by the pose.
    flank : FlankMotion
        Kinematics of the wheel pins.
    holes : PairMotion
        Kinematics of the pin holes.
    rollers : RollerState
        Balanced rollers.
    pin_load, hole_load : array, shape (positions, pairs)
        N.
    """

    force: FloatArray
    tangent: FloatArray
    flank: FlankMotion
    holes: PairMotion
    rollers: RollerState
    pin_load: FloatArray
    hole_load: FloatArray


class ComplianceModel(Protocol):
    """What `ltca.equilibrium` needs of a compliance model."""

    @property
    def geometry(self) -> ContactGeometry:
        """The contact geometry of the drive."""
        ...

    def respond(self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None) -> Response:
        """Return the contact forces at the poses of a batch of positions."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """Inner unknowns of a neighbouring pose, to start from.

    Attributes
    ----------
    parameter : array, shape (positions, z_P)
        Contact parameters on the flank, rad.
    share : array, shape (positions, n_BR)
        Shares of `ltca.roller_series`.
    """

    parameter: FloatArray
    share: FloatArray

    @classmethod
    def after(cls, response: Response) -> Start:
        """Return the start that a response gives for the next pose."""
        return cls(parameter=response.flank.parameter, share=response.rollers.share)

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Start:
        """Return the start of some of the positions."""
        return Start(parameter=self.parameter[rows], share=self.share[rows])


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfSpaceCompliance:
    """Half-space laws for pins and rollers, springs for the pin holes (the paper's model).

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    pin_law : LineContactLaw
        Law of wheel pin and flank.
    roller_laws : RollerLaws
        Laws of the rollers.
    hole_stiffness : float
        k_PS, N/mm.
    """

    geometry: ContactGeometry
    pin_law: LineContactLaw
    roller_laws: RollerLaws
    hole_stiffness: float

    @classmethod
    def of_drive(cls, drive: Drive) -> HalfSpaceCompliance:
        """Return the half-space model of a drive."""
        geometry = ContactGeometry.of_drive(drive)
        place, bearing, parts = geometry.placement, drive.crank_bearing, drive.materials
        inner_radius = 1.0 / (1.0 / place.roller_radii + 1.0 / place.inner_race_radius)
        outer_radius = 1.0 / (1.0 / place.roller_radii - 1.0 / place.bore_radius)
        turn = np.linspace(0.0, 2.0 * np.pi / geometry.profile.reduction_ratio, 181)
        pin_radii = geometry.profile.effective_radius(turn[:, None], place.wheel_pin_radii)
        return cls(
            geometry=geometry,
            pin_law=law_for_profile(
                drive.pin_wheel.pin_profile,
                length=drive.disc.thickness,
                radius=drive.pin_wheel.pin_radius,
                contact_modulus=contact_modulus(parts.disc, parts.wheel_pin),
                effective_radii=pin_radii,
            ),
            roller_laws=RollerLaws(
                inner=law_for_profile(
                    bearing.roller_profile,
                    length=bearing.roller_length,
                    radius=bearing.roller_radius,
                    contact_modulus=contact_modulus(parts.inner_race, parts.roller),
                    effective_radii=inner_radius,
                ),
                outer=law_for_profile(
                    bearing.roller_profile,
                    length=bearing.roller_length,
                    radius=bearing.roller_radius,
                    contact_modulus=contact_modulus(parts.disc, parts.roller),
                    effective_radii=outer_radius,
                ),
                inner_radius=inner_radius,
                outer_radius=outer_radius,
            ),
            hole_stiffness=drive.pin_shaft.stiffness,
        )

    def respond(self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None) -> Response:
        """Return the contact forces at the poses of a batch of positions.

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        pose : array, shape (positions, 4)
            q of `ltca.pairs`.
        start : Start, optional
            Inner unknowns of a neighbouring pose.

        Returns
        -------
        Response
            Generalised force, tangent and every pair's load.

        Notes
        -----
        A load depends on its place through ρ(θ) as well. That derivative is left out of the tangent, and the
        force it would add to the gradient of the energy (about 1e-5 of the load, along the flank) is no contact
        force without friction: the force acts along the common normal.
        """
        flank = self.geometry.flank(crank_angle, pose, None if start is None else start.parameter)
        pin_load, pin_stiffness = self.pin_law.load_and_stiffness(flank.approach, flank.effective_radius)
        holes = self.geometry.holes(crank_angle, pose)
        hole_load = self.hole_stiffness * np.maximum(holes.approach, 0.0)
        hole_stiffness = np.where(holes.approach > 0.0, self.hole_stiffness, 0.0)
        rollers = balance_rollers(
            self.geometry.rollers(crank_angle),
            pose[:, 0] + 1j * pose[:, 1],
            self.roller_laws,
            None if start is None else start.share,
        )
        force = resultant(flank, pin_load, holes, hole_load, rollers)
        tangent = _pair_tangent(flank, pin_load, pin_stiffness) + _pair_tangent(holes, hole_load, hole_stiffness)
        tangent[:, :2, :2] += rollers.tangent.sum(axis=1)
        return Response(
            force=force,
            tangent=tangent,
            flank=flank,
            holes=holes,
            rollers=rollers,
            pin_load=pin_load,
            hole_load=hole_load,
        )


def resultant(
    flank: FlankMotion, pin_load: FloatArray, holes: PairMotion, hole_load: FloatArray, rollers: RollerState
) -> FloatArray:
    """Return the generalised force of all contacts, Σ F ∂δ/∂q, shape (positions, 4); N and N·mm."""
    force = np.einsum("bi,bij->bj", pin_load, flank.gradient)
    force += np.einsum("bi,bij->bj", hole_load, holes.gradient)
    push = (rollers.outer_load * rollers.outer_direction).sum(axis=1)
    force[:, 0] -= push.real
    force[:, 1] -= push.imag
    return np.asarray(force)


def _pair_tangent(motion: PairMotion, load: FloatArray, stiffness: FloatArray) -> FloatArray:
    scaled = stiffness[..., None] * motion.gradient
    tangent = np.matmul(motion.gradient.swapaxes(1, 2), scaled)
    positions, pairs = load.shape
    bend = np.matmul(load[:, None, :], motion.curvature.reshape(positions, pairs, 16))
    return np.asarray(tangent + bend.reshape(positions, 4, 4))
