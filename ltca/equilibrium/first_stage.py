r"""First stage: forces of the sun on the planets of the cranks, and what its teeth add to the angle of the output.

A planet holds its crank with the moment T (`ltca.equilibrium.crank_moments`). At the pitch point, which lies r_w from the axis
of the crank towards the sun, the tooth of the sun pushes with

.. math:: F_t = T/r_w, \quad F_r = |F_t| \tan\alpha_{wt}, \quad F_a = -F_t \tan\beta_w

along the tangent (positive where it turns the planet ccw), away from the sun, and along z of a right-handed planet. Without
profile shift :math:`\tan\alpha_{wt} = \tan\alpha_n/\cos\beta`. The axial force stands r_w off the axis and bends the crank by the
couple :math:`F_a r_w`.

Where cranks yield these forces act on the shafts beside those of the discs. In the coordinates of the crank at the discs a
force elsewhere on the shaft is what holds the planes of the discs still under it.

The teeth of the sun stand still while the input is held. Cranks turn together, so the crank lags behind its ideal angle by the
mean over all cranks of what the mesh yields, :math:`T/c r_b^2`, of what the crank gives way at the planet, and of half the
backlash, on the side to which the moments turn. The wheel follows by 1/u of that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.parts import Drive
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.placement import BatchScalar
from ltca.laws.beam import shaft_flexibility, support_parts


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshForces:
    """Forces of the sun on the planets.

    Attributes
    ----------
    tangential : array, shape (positions, cranks)
        F_t, positive where it turns the planet counter-clockwise, N.
    radial : array, shape (positions, cranks)
        F_r, away from the sun, N.
    axial : array, shape (positions, cranks)
        F_a along z, N.
    in_plane : array of complex, shape (positions, cranks)
        F_t and F_r in the fixed frame, N.
    couple : array of complex, shape (positions, cranks)
        F_a r_w as a pair of opposite radial forces times their distance along z, N·mm.
    """

    tangential: FloatArray
    radial: FloatArray
    axial: FloatArray
    in_plane: ComplexArray
    couple: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class StageMesh:
    """Mesh of the sun with the planets of all cranks.

    Attributes
    ----------
    pitch_radius : float
        r_w of the planets, mm.
    separating, axial : float
        tan α_wt, and tan β_w, positive where planets are right-handed.
    twist : float
        Rotation of a crank by its moment while the sun is held, 1/(c r_b²), rad/(N·mm); 0 where teeth are rigid.
    half_free : float
        Half of the angle by which a planet is free to turn, rad.
    sun_radius : float
        Radius of the pitch circle of the sun, mm.
    plane : float
        Axial place of the planets, mm.
    reduction_ratio : float
        u.
    outward : array of complex, shape (cranks,)
        Directions from the sun to the cranks.
    bending : array, shape (discs, 2)
        Forces at the discs that move the crank there as a unit force and a unit couple at the planet do, and, by reciprocity,
        displacement and slope at the planet by displacements at the discs; zero where cranks are rigid.
    own : array, shape (2, 2)
        Displacement and slope at the planet by a unit force and couple there while the planes of the discs stand still, mm/N.
    on_supports : array, shape (supports, 2)
        Part of that force and couple that each bearing of the crank carries; of rigid cranks one at the planet carries the
        force, behind those beside the discs.
    yields : bool
        Whether cranks yield.
    carried : bool
        Whether the carrier is the output, which the main bearing holds against what the sun presses on its planets.
    """

    pitch_radius: BatchScalar = by_drive(0)
    separating: BatchScalar = by_drive(0)
    axial: BatchScalar = by_drive(0)
    twist: BatchScalar = by_drive(0)
    half_free: BatchScalar = by_drive(0)
    sun_radius: BatchScalar = by_drive(0)
    plane: BatchScalar = by_drive(0)
    reduction_ratio: float
    outward: ComplexArray = by_drive(1)
    bending: FloatArray = by_drive(2)
    own: FloatArray = by_drive(2)
    on_supports: FloatArray = by_drive(2)
    yields: bool
    carried: bool

    @classmethod
    def of_drive(cls, drive: Drive) -> StageMesh | None:
        """Return the mesh of a drive; None where its first stage has no teeth."""
        stage, distance = drive.first_stage, drive.crank.circle_radius
        if stage is None or distance is None:
            return None
        mesh, places = stage.mesh(distance), np.array(drive.crank.places)
        stiffness, support, discs = stage.mesh_stiffness, drive.crank.support, drive.disc.number_of_discs
        bending: FloatArray = np.zeros((discs, 2))
        own: FloatArray = np.zeros((2, 2))
        on_supports: FloatArray = np.eye(discs + 1, 2, -discs)
        if support is not None:
            planes = drive.disc.disc_planes
            whole = shaft_flexibility(
                [*planes, stage.plane], support.positions, support.stiffness, support.diameter,
                drive.materials.crankshaft.youngs_modulus, [stage.plane],
            )  # fmt: skip
            bending = np.asarray(np.linalg.solve(whole[:discs, :discs], whole[:discs, discs:]), dtype=float)
            own = whole[discs:, discs:] - whole[discs:, :discs] @ bending
            on_supports = support_parts([stage.plane], support.positions, [stage.plane])
        return cls(
            pitch_radius=mesh.pitch_radius,
            separating=mesh.separating,
            axial=mesh.axial,
            twist=0.0 if stiffness is None else 1.0 / (stiffness * mesh.base_radius**2),
            half_free=0.5 * mesh.backlash_angle(stage.backlash),
            sun_radius=distance - mesh.pitch_radius,
            plane=stage.plane,
            reduction_ratio=drive.reduction_ratio,
            outward=places / np.abs(places),
            bending=bending,
            own=own,
            on_supports=on_supports,
            yields=support is not None,
            carried=drive.wheel_is_held,
        )

    @property
    def play(self) -> BatchScalar:
        """Free play of the wheel by the backlash of the teeth, both ways, rad."""
        return 2.0 * self.half_free / abs(self.reduction_ratio)

    def forces(self, moments: FloatArray) -> MeshForces:
        """Return the forces at moments that hold the cranks, ccw positive, N·mm, shape (positions, cranks)."""
        tangential = moments / self.pitch_radius
        radial = np.abs(tangential) * self.separating
        axial = -tangential * self.axial
        return MeshForces(
            tangential=tangential,
            radial=radial,
            axial=axial,
            in_plane=(radial - 1j * tangential) * self.outward,
            couple=axial * self.pitch_radius * self.outward,
        )

    def on_wheel(self, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the force of the sun on all planets as one on the wheel relative to the carrier, N, shape (positions,), and its
        derivatives by the moments of the cranks, 1/mm, shape (positions, cranks); zero where the carrier is held.
        """
        sign = -1.0 if self.carried else 0.0
        return sign * self.forces(moments).in_plane.sum(axis=1), sign * self._slope(np.sign(moments))[0]

    def on_bearings(self, moments: FloatArray) -> ComplexArray:
        """Return what bearings of the cranks carry of the forces of the teeth, N, shape (positions, cranks, supports)."""
        forces = self.forces(moments)
        both = np.stack((forces.in_plane, forces.couple), axis=-1)
        return np.asarray(np.matmul(both, np.swapaxes(self.on_supports, -1, -2)))

    def on_cranks(self, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the forces of the teeth in the coordinates of the cranks, N, shape (positions, discs, cranks), and their
        derivatives by the moment of their own crank, 1/mm.
        """
        sense = np.sign(moments)
        forces = self.forces(moments)
        slope = self._slope(sense)
        found = [
            np.einsum("...dk,...ck->...dc", self.bending, np.stack(parts, axis=-1))
            for parts in ((forces.in_plane, forces.couple), slope)
        ]
        return np.asarray(found[0]), np.asarray(found[1])

    def _slope(self, sense: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Derivatives of force and couple by the moments of the cranks, whose senses are given."""
        in_plane = (self.separating * sense - 1j) / self.pitch_radius * self.outward
        return np.asarray(in_plane), np.asarray(-self.axial * self.outward * np.ones(sense.shape))

    def crank_lag(self, moments: FloatArray, displaced: ComplexArray) -> FloatArray:
        """Return the angle of the cranks less the one that the held sun gives rigid teeth without play, rad, shape (positions,).

        `displaced` are the displacements of the cranks at the discs in the fixed frame, mm, shape (positions, discs, cranks);
        without cranks where these are rigid.
        """
        each = self.twist * moments
        if self.yields:
            forces = self.forces(moments)
            both = np.stack((forces.in_plane, forces.couple), axis=-1)
            moved = np.einsum("...dk,...dc->...ck", self.bending, displaced)
            moved = moved + np.matmul(both, np.swapaxes(self.own, -1, -2))
            slope = np.stack(self._slope(np.sign(moments)), axis=-1)
            each = each + (slope.conjugate() * moved).real.sum(axis=-1)
        total = moments.sum(axis=1)
        free = np.sign(total)[:, None] * self.half_free
        return np.asarray(-(each.mean(axis=1) + np.broadcast_to(free, (total.size, 1))[:, 0]))


def displaced_cranks(coordinates: Coordinates, pose: FloatArray) -> ComplexArray:
    """Return the displacements of the cranks at every disc in the fixed frame, mm, shape (positions, discs, cranks)."""
    each = pose[:, : coordinates.discs * coordinates.own].reshape(-1, coordinates.discs, coordinates.own)
    first = coordinates.crank(0)
    return np.asarray(each[..., first::2] + 1j * each[..., first + 1 :: 2])
