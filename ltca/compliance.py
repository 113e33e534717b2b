"""Loads of all contact pairs at a pose, with half-space compliance: pairs that do not feel each other.

A compliance model answers one question for a batch of positions, `respond`: which generalised force do the
contacts exert at this pose, and what is its tangent? `ltca.equilibrium` asks nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ltca.contact_grid import ContactKind, ContactKinds
from ltca.contact_law import ContactLaw
from ltca.drive import Drive, contact_modulus
from ltca.end_pressure import largest_pressure_ratio
from ltca.generator_profile import law_for_profile
from ltca.pairs import ContactGeometry, FlankMotion, PairMotion
from ltca.roller_series import RollerLaws, RollerState, balance_rollers

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


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
    memory : array of object, shape (positions,)
        What a model wants to find again at the next pose of each position; None where it wants nothing.
    """

    force: FloatArray
    tangent: FloatArray
    flank: FlankMotion
    holes: PairMotion
    rollers: RollerState
    pin_load: FloatArray
    hole_load: FloatArray
    memory: NDArray[np.object_]


@dataclass(frozen=True, slots=True, kw_only=True)
class KindPressures:
    """Pressures and half-widths of all pairs of one kind, zero where open.

    Attributes
    ----------
    mid : array, shape (positions, pairs)
        Largest pressure at mid-width, MPa.
    largest : array, shape (positions, pairs)
        Largest pressure anywhere, MPa: at unrelieved ends it is singular and depends on the end cell.
    half_width : array, shape (positions, pairs)
        Contact half-width at mid-width, mm.
    end_cell : float
        Length of the end cell behind `largest`, mm.
    """

    mid: FloatArray
    largest: FloatArray
    half_width: FloatArray
    end_cell: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactPressures:
    """Pressures of wheel pins and flank, rollers in the bore (outer) and on the inner race (inner)."""

    pins: KindPressures
    outer: KindPressures
    inner: KindPressures


class ComplianceModel(Protocol):
    """What `ltca.equilibrium` needs of a compliance model."""

    @property
    def geometry(self) -> ContactGeometry:
        """The contact geometry of the drive."""
        ...

    def respond(self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None) -> Response:
        """Return the contact forces at the poses of a batch of positions."""
        ...

    def pressures(self, response: Response) -> ContactPressures:
        """Return the pressures behind a response of this model."""
        ...


class BatchModel(ComplianceModel, Protocol):
    """A model whose positions may belong to different drives (`ltca.placement.Placement.is_batch`)."""

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> BatchModel:
        """Return the model of some of the positions."""
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
    memory : array of object, shape (positions,)
        Memory of the model, see `Response`.
    """

    parameter: FloatArray
    share: FloatArray
    memory: NDArray[np.object_]

    @classmethod
    def after(cls, response: Response) -> Start:
        """Return the start that a response gives for the next pose."""
        return cls(parameter=response.flank.parameter, share=response.rollers.share, memory=response.memory)

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Start:
        """Return the start of some of the positions."""
        return Start(parameter=self.parameter[rows], share=self.share[rows], memory=self.memory[rows])

    def replaced(self, rows: NDArray[np.intp] | NDArray[np.bool_], other: Start) -> Start:
        """Return a copy with some positions taken from another start, given for just these."""
        fresh = Start(parameter=self.parameter.copy(), share=self.share.copy(), memory=self.memory.copy())
        fresh.parameter[rows], fresh.share[rows], fresh.memory[rows] = other.parameter, other.share, other.memory
        return fresh


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfSpaceCompliance:
    """Half-space laws for pins and rollers, springs for the pin holes (the paper's model).

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    pin_law : ContactLaw
        Law of wheel pin and flank.
    roller_laws : RollerLaws
        Laws of the rollers.
    hole_stiffness : float
        k_PS, N/mm.
    kinds : ContactKinds
        The contacts as grids see them, for what no table holds.
    """

    geometry: ContactGeometry
    pin_law: ContactLaw
    roller_laws: RollerLaws[ContactLaw]
    hole_stiffness: float | FloatArray
    kinds: ContactKinds

    @classmethod
    def of_drive(cls, drive: Drive) -> HalfSpaceCompliance:
        """Return the half-space model of a drive."""
        geometry = ContactGeometry.of_drive(drive)
        turn = np.linspace(0.0, 2.0 * np.pi / geometry.profile.reduction_ratio, 181)
        pin_radii = geometry.profile.effective_radius(turn[:, None], geometry.placement.wheel_pin_radii)
        return cls._of_geometry(geometry, drive, pin_radii, drive.pin_shaft.stiffness)

    @classmethod
    def of_drives(cls, drives: Sequence[Drive], positions: int) -> HalfSpaceCompliance:
        """Return the model of a batch: every drive at the same number of positions, drive by drive.

        Parameters
        ----------
        drives : sequence of Drive
            Drives that agree in what `batch_signature` tells.
        positions : int
            Positions of each drive; drive s takes the rows s·positions … (s + 1)·positions − 1.
        """
        geometry = ContactGeometry.of_drives(drives, positions)
        stiffness = np.repeat([[drive.pin_shaft.stiffness] for drive in drives], positions, axis=0)
        each = geometry.take(np.arange(len(drives)) * positions)
        turn = np.linspace(0.0, 2.0 * np.pi, 181 * drives[0].pin_wheel.number_of_pins)
        pin_radii = np.ones((1, 1))
        if not drives[0].pin_wheel.pin_profile.is_cylinder:
            radii = each.placement.wheel_pin_radii
            pin_radii = np.stack(
                [
                    each.profile.effective_radius(turn[None, :], r(radii, axis=1, keepdims=True))
                    for r in (np.min, np.max)
                ]
            )
        return cls._of_geometry(geometry, drives[0], pin_radii, stiffness)

    @classmethod
    def _of_geometry(
        cls, geometry: ContactGeometry, drive: Drive, pin_radii: FloatArray, hole_stiffness: float | FloatArray
    ) -> HalfSpaceCompliance:
        place, bearing, parts = geometry.placement, drive.crank_bearing, drive.materials
        inner_radius = 1.0 / (1.0 / place.roller_radii + 1.0 / place.inner_race_radius)
        outer_radius = 1.0 / (1.0 / place.roller_radii - 1.0 / place.bore_radius)
        # Batches differ little from each other: on a ladder they share the tables of profiled parts.
        rungs = _rungs if place.is_batch else np.asarray
        return cls(
            geometry=geometry,
            pin_law=law_for_profile(
                drive.pin_wheel.pin_profile,
                length=drive.disc.thickness,
                radius=drive.pin_wheel.pin_radius,
                contact_modulus=contact_modulus(parts.disc, parts.wheel_pin),
                effective_radii=rungs(pin_radii),
            ),
            roller_laws=RollerLaws(
                inner=law_for_profile(
                    bearing.roller_profile,
                    length=bearing.roller_length,
                    radius=bearing.roller_radius,
                    contact_modulus=contact_modulus(parts.inner_race, parts.roller),
                    effective_radii=rungs(inner_radius),
                ),
                outer=law_for_profile(
                    bearing.roller_profile,
                    length=bearing.roller_length,
                    radius=bearing.roller_radius,
                    contact_modulus=contact_modulus(parts.disc, parts.roller),
                    effective_radii=rungs(outer_radius),
                ),
                inner_radius=inner_radius,
                outer_radius=outer_radius,
            ),
            hole_stiffness=hole_stiffness,
            kinds=ContactKinds.of_drive(drive),
        )

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> HalfSpaceCompliance:
        """Return the model of some positions: itself for one drive, these rows of a batch."""
        if not self.geometry.placement.is_batch:
            return self
        laws = self.roller_laws
        return HalfSpaceCompliance(
            geometry=self.geometry.take(rows),
            pin_law=self.pin_law,
            roller_laws=RollerLaws(
                inner=laws.inner,
                outer=laws.outer,
                inner_radius=laws.inner_radius[rows],
                outer_radius=laws.outer_radius[rows],
            ),
            hole_stiffness=np.asarray(self.hole_stiffness)[rows],
            kinds=self.kinds,
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
        hole_load, hole_stiffness = spring_load_and_stiffness(holes.approach, self.hole_stiffness)
        rollers = balance_rollers(
            self.geometry.rollers(crank_angle),
            pose[:, 0] + 1j * pose[:, 1],
            self.roller_laws,
            None if start is None else start.share,
        )
        return assemble_response(flank, pin_load, pin_stiffness, holes, hole_load, hole_stiffness, rollers)

    def pressures(self, response: Response) -> ContactPressures:
        """Return the pressures at mid-width from the laws."""
        flank, rollers, laws, kinds = response.flank, response.rollers, self.roller_laws, self.kinds
        return ContactPressures(
            pins=_read_law(self.pin_law, kinds.pins, flank.approach, flank.effective_radius),
            outer=_read_law(laws.outer, kinds.outer, rollers.outer_approach, laws.outer_radius),
            inner=_read_law(laws.inner, kinds.inner, rollers.inner_approach, laws.inner_radius),
        )


def _read_law(law: ContactLaw, kind: ContactKind, approach: FloatArray, radius: FloatArray) -> KindPressures:
    mid = law.mid_pressure(approach, radius)
    return KindPressures(
        mid=mid,
        largest=mid * largest_pressure_ratio(kind, approach, radius),
        half_width=law.half_width(approach, radius),
        end_cell=kind.end_cell,
    )


def batch_signature(drive: Drive) -> tuple[object, ...]:
    """Return what drives of one batch have in common: numbers of parts, contact laws, shape of the deviations."""
    wheel, disc, bearing, errors = drive.pin_wheel, drive.disc, drive.crank_bearing, drive.disc.profile_errors
    # A logarithmic profile scales with the diameter of its part.
    pin = None if wheel.pin_profile.is_cylinder else (wheel.pin_profile, wheel.pin_radius)
    roller = None if bearing.roller_profile.is_cylinder else (bearing.roller_profile, bearing.roller_radius)
    numbers = (wheel.number_of_pins, disc.number_of_teeth, bearing.number_of_rollers, drive.pin_shaft.number_of_pins)
    lengths = (disc.thickness, bearing.roller_length)
    return (*numbers, *lengths, pin, roller, drive.materials, errors.orders, errors.parameter, errors.deviation)


def _rungs(radii: FloatArray) -> FloatArray:
    """Range of radii rounded outward to powers of 1.25."""
    step = np.log(1.25)
    ends = np.log([np.min(radii), np.max(radii)]) / step
    return np.asarray(np.exp(step * np.array([np.floor(ends[0]), np.ceil(ends[1])])))


def assemble_response(
    flank: FlankMotion,
    pin_load: FloatArray,
    pin_stiffness: FloatArray,
    holes: PairMotion,
    hole_load: FloatArray,
    hole_stiffness: FloatArray,
    rollers: RollerState,
    memory: NDArray[np.object_] | None = None,
) -> Response:
    """Put the loads of uncoupled pairs together: generalised force and tangent.

    Parameters
    ----------
    flank, holes, rollers : FlankMotion, PairMotion, RollerState
        Kinematics of the pairs, balanced rollers.
    pin_load, pin_stiffness, hole_load, hole_stiffness : array, shape (positions, pairs)
        N and N/mm.
    memory : array of object, shape (positions,), optional
        See `Response`.
    """
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
        memory=np.full(force.shape[0], None, dtype=object) if memory is None else memory,
    )


def spring_load_and_stiffness(approach: FloatArray, stiffness: float | FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the load of unilateral springs and its derivative, N and N/mm (Eq. 77)."""
    return stiffness * np.maximum(approach, 0.0), np.where(approach > 0.0, stiffness, 0.0)


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
    return np.asarray(np.matmul(motion.gradient.swapaxes(1, 2), scaled) + motion.bend(load))
