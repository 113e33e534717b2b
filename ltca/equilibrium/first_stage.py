r"""First stage: forces of the sun on the planets of the cranks, and what its teeth add to the angle of the output.

A planet holds its crank with the moment T (`Reducer.crank_moments`). At the pitch point, which lies r_w from the axis
of the crank towards the sun, the tooth of the sun pushes with

.. math:: F_t = T/r_w, \quad F_r = |F_t| \tan\alpha_{wt}, \quad F_a = -F_t \tan\beta_w

along the tangent (positive where it turns the planet ccw), away from the sun, and along z of a right-handed planet. Without
profile shift :math:`\tan\alpha_{wt} = \tan\alpha_n/\cos\beta`. The axial force stands r_w off the axis and bends the crank by the
couple :math:`F_a r_w`.

Where cranks yield these forces act on the shafts beside those of the discs. In the coordinates of the crank at the discs a
force elsewhere on the shaft is what holds the planes of the discs still under it. What the bearings of a crank carry of it
meanwhile acts on what they stand in, the far flange of a carrier, and on the displacement that a clearance or preload leaves
them (`ltca.equilibrium.supports`). By virtual work the same matrices give displacement and slope of the crank at the planet.

The teeth of the sun stand still while the input is held. Cranks turn together, so the crank lags behind its ideal angle by the
mean over all cranks of what the mesh yields, :math:`T/c r_b^2`, of what the crank gives way at the planet, and of half the
backlash, on the side to which the moments turn. The wheel follows by 1/u of that.

Teeth that stand off their axes, those of a planet by :math:`d_c`, which turns with the crank, and those of the sun by
:math:`d_s`, which turns with the input, mesh along a line of action that they displace: involutes turn the planet by the part
of :math:`d_c - d_s` along it, over r_b, and by nothing else of first order. Every planet sees the sun from another side. What
cranks that turn apart by such angles turn the wheel by is their mean weighted by what each takes of a little more torque
(`ltca.equilibrium.output_angle.shares_of_cranks`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.beam import shaft_flexibility, support_parts
from ltca.drive.parts import Drive
from ltca.equilibrium.supports import crank_springs, journals
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.placement import BatchScalar
from ltca.geometry.rotation import unit


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshForces:
    """Forces of the sun on the planets, N, shape (positions, cranks): F_t, positive where it turns the planet counter-clockwise,
    F_r away from the sun, F_a along z, and F_t and F_r in the fixed frame.
    """

    tangential: FloatArray
    radial: FloatArray
    axial: FloatArray
    in_plane: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class StageMesh:
    """Mesh of the sun with the planets of all cranks; lengths are in mm.

    Pitch radii are those of planets, r_w, and sun; `separating` is tan α_wt and `axial` tan β_w, positive where planets are
    right-handed. A crank turns by `twist` by its moment while the sun is held, 1/(c r_b²), rad/(N·mm), 0 of rigid teeth, and a
    planet freely by twice `half_free`, rad. `plane` is the axial place of the planets, `outward` are the directions from the
    sun to the cranks. Runouts, d_s and d_c, are those at crank angle zero; the sun turns against the carrier by `sun_turns` of a
    crank, −z₂/z₁. `yields` tells whether cranks yield, or the far flange in which they stand, and `carried` whether the carrier
    is the output, which the main bearing holds against what the sun presses on its planets.

    Displacement and slope of a crank at the planet follow from the coordinates, without forces there and with its bearings where
    they stand, by `by_pose`, shape (cranks, 2, coordinates). With the planes of the discs standing still they follow from
    displacements in the two bearings by `by_bearings`, which also is the part of force and couple at the planet that each bearing
    then carries (zero where the file says nothing of these), and from a unit force and couple by `own`, mm/N. `on_supports`,
    shape (supports, 2), is the part of these that each bearing of the crank carries; of rigid cranks one at the planet, behind
    those beside the discs, carries the force.
    """

    pitch_radius: BatchScalar = by_drive(0)
    separating: BatchScalar = by_drive(0)
    axial: BatchScalar = by_drive(0)
    twist: BatchScalar = by_drive(0)
    half_free: BatchScalar = by_drive(0)
    plane: BatchScalar = by_drive(0)
    sun_radius: BatchScalar = by_drive(0)
    reduction_ratio: float
    outward: ComplexArray = by_drive(1)
    by_pose: ComplexArray = by_drive(3)
    by_bearings: FloatArray = by_drive(2)
    own: FloatArray = by_drive(2)
    on_supports: FloatArray = by_drive(2)
    yields: bool
    carried: bool
    sun_turns: float
    sun_runout: ComplexArray = by_drive(1)
    planet_runout: ComplexArray = by_drive(1)

    @classmethod
    def of_drive(cls, drive: Drive) -> StageMesh | None:
        """Return the mesh of a drive; None where its first stage has no teeth."""
        stage, distance = drive.first_stage, drive.crank.circle_radius
        if stage is None or distance is None:
            return None
        mesh, places, coordinates = stage.mesh(distance), np.array(drive.crank.places), Coordinates.of_drive(drive)
        stiffness, support, discs = stage.mesh_stiffness, drive.crank.support, drive.disc.number_of_discs
        (planes, slopes), bearings, shaft = journals(drive), drive.crank_supports, drive.materials.crankshaft
        count, number = len(planes) + len(slopes), drive.crank.number
        place = 0.0 if stage.plane is None else stage.plane  # left out where no bearing gives their forces an arm
        bending, own, by_bearings = np.zeros((count, 2)), np.zeros((2, 2)), np.zeros((2, 2))
        on_supports: FloatArray = np.eye(discs + 1, 2, -discs)
        if support is not None:
            whole = shaft_flexibility(
                [*planes, place], support.positions, crank_springs(drive), support.diameter, shaft.youngs_modulus,
                [*slopes, place],
            )  # fmt: skip
            at_planet = np.array([discs, count + 1])
            held = np.setdiff1d(np.arange(count + 2), at_planet)
            beside = whole[np.ix_(held, at_planet)]
            bending = np.asarray(np.linalg.solve(whole[np.ix_(held, held)], beside), dtype=float)
            own = whole[np.ix_(at_planet, at_planet)] - beside.T @ bending
        if bearings is not None:
            on_supports = support_parts([place], bearings, [place])
            by_bearings = on_supports - support_parts(planes, bearings, slopes) @ bending
        by_pose = np.zeros((number, 2, coordinates.size), dtype=complex)
        for crank in range(coordinates.cranks):
            x = coordinates.journals(crank)
            by_pose[crank][:, x], by_pose[crank][:, x + 1] = bending.T, 1j * bending.T
        on_posts = drive.posts is not None
        if on_posts:
            axes = drive.crank.axis_offset.place + places
            seats = np.stack((np.ones_like(axes), np.full_like(axes, 1j), 1j * axes), axis=-1)
            by_pose[..., coordinates.ring_place] = by_bearings[1, :, None] * seats[:, None]
        return cls(
            pitch_radius=mesh.pitch_radius,
            separating=mesh.separating,
            axial=mesh.axial,
            twist=0.0 if stiffness is None else 1.0 / (stiffness * mesh.base_radius**2),
            half_free=0.5 * mesh.backlash_angle(stage.backlash),
            plane=place,
            sun_radius=distance - mesh.pitch_radius,
            reduction_ratio=drive.reduction_ratio,
            outward=places / np.abs(places),
            by_pose=by_pose,
            by_bearings=by_bearings,
            own=own,
            on_supports=on_supports,
            yields=support is not None or on_posts,
            carried=drive.wheel_is_held,
            sun_turns=-stage.ratio,
            sun_runout=stage.sun_runout.amount * unit(np.array([stage.sun_runout.angle])),
            planet_runout=np.array(stage.planet_runout.places(number)),
        )

    @property
    def runs_out(self) -> bool:
        """Whether teeth stand off their axes, in any drive of a batch."""
        return bool(np.any(self.sun_runout) or np.any(self.planet_runout))

    def play(self, crank_angle: FloatArray) -> FloatArray:
        """Return the free play of the wheel by the backlash of the teeth, both ways, rad, shape (positions,).

        Eccentricities open and close the meshes; the wheel has the mean of them, as where its cranks share the torque evenly.
        """
        free = np.asarray(2.0 * self.half_free / abs(self.reduction_ratio))
        if not self.runs_out:
            return np.broadcast_to(free.reshape(-1) if free.ndim else free, crank_angle.shape)
        apart = (self.outward.conjugate() * self._stands_off(crank_angle)).real.mean(axis=-1)
        opened = 2.0 * np.squeeze(self.separating / self.pitch_radius) * apart / abs(self.reduction_ratio)
        return np.asarray(np.squeeze(free) + opened)

    def _stands_off(self, crank_angle: FloatArray) -> ComplexArray:
        """Displacement of the teeth of every planet against those of the sun by their runout, mm, shape (positions, cranks)."""
        planets = self.planet_runout * unit(crank_angle)[:, None]
        return np.asarray(planets - self.sun_runout * unit(self.sun_turns * crank_angle)[:, None])

    def lag_by_runout(self, crank_angle: FloatArray, sense: FloatArray) -> FloatArray:
        """Return the angle by which every crank lags behind the held sun by eccentricities, rad, shape (positions, cranks).

        `sense` is that of the moments that hold the cranks, shape (positions,), by which one flank or the other touches.
        """
        pushed = self._slope(np.broadcast_to(sense[:, None], (sense.size, self.outward.shape[-1])))[..., 0]
        return np.asarray((pushed.conjugate() * self._stands_off(crank_angle)).real)

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
        )

    def on_wheel(self, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the force of the sun on all planets as one on the wheel relative to the carrier, N, and what it presses the lean
        of the wheel with, z F − i M, N·mm, shape (positions, 2), and their derivatives by the moments of the cranks, shape
        (positions, 2, cranks); zero where the carrier is held.
        """
        slope, lever = (
            self._slope(np.sign(moments))[..., 0],
            self.sun_radius * self.outward * self.axial / self.pitch_radius,
        )
        by_moments = (-1.0 if self.carried else 0.0) * np.stack((slope, self.plane * slope + lever), axis=1)
        return (by_moments * moments[:, None]).sum(axis=2), by_moments

    def on_bearings(self, moments: FloatArray) -> ComplexArray:
        """Return what bearings of the cranks carry of the forces of the teeth, N, shape (positions, cranks, supports)."""
        return np.asarray(np.matmul(self.on_planets(moments)[0], np.swapaxes(self.on_supports, -1, -2)))

    def on_planets(self, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return force and couple of the teeth on every planet, N and N·mm, shape (positions, cranks, 2), and their derivatives
        by the moment of their own crank.
        """
        slope = self._slope(np.sign(moments))
        return slope * moments[..., None], slope

    def together(self, sense: float) -> tuple[float, FloatArray]:
        """Return how the cranks of one drive lag together on one flank, by the sense of the moments that hold them, ±1: by the
        moment of all of them, shared evenly, rad/(N·mm), and by the coordinates, rad by mm or rad, shape (coordinates,).
        """
        pushed = self._slope(np.full((1, self.outward.shape[-1]), sense))[0]
        own = np.einsum("ci,ij,cj->c", pushed.conjugate(), self.own, pushed).real
        by_pose = np.einsum("ci,cin->cn", pushed.conjugate(), self.by_pose).real.mean(axis=0)
        return float(np.mean(np.squeeze(self.twist) + own)) / own.size, np.asarray(by_pose)

    def beside_discs(self, on_planets: ComplexArray) -> ComplexArray:
        """Return what the two bearings of every crank carry of forces and couples on the planets while the planes of the discs
        stand still, N, shape (positions, cranks, 2).
        """
        return np.asarray(np.matmul(on_planets, np.swapaxes(self.by_bearings, -1, -2)))

    def on_coordinates(self, on_planets: ComplexArray) -> FloatArray:
        """Return the work of forces and couples on the planets by the coordinates, shape (positions, coordinates)."""
        return np.asarray((self.by_pose.conjugate() * on_planets[..., None]).real.sum(axis=(-3, -2)))

    def _slope(self, sense: FloatArray) -> ComplexArray:
        """Derivatives of force and couple by the moments of the cranks, whose senses are given, shape (positions, cranks, 2)."""
        in_plane = (self.separating * sense - 1j) / self.pitch_radius * self.outward
        return np.stack(np.broadcast_arrays(in_plane, -self.axial * self.outward), axis=-1)

    def displaced(self, moments: FloatArray, pose: FloatArray, given: ComplexArray | None) -> ComplexArray:
        """Return displacement and slope of every crank at its planet in the fixed frame, mm and rad, shape (positions, cranks,
        2), at moments that hold the cranks; `given` are the displacements in their bearings, mm, shape (positions, cranks, 2).
        """
        moved = np.matmul(self.by_pose, pose[:, None, :, None])[..., 0]
        if given is not None:
            moved = moved + np.matmul(given, self.by_bearings)
        return np.asarray(moved + np.matmul(self.on_planets(moments)[0], np.swapaxes(self.own, -1, -2)))

    def crank_lag(
        self, moments: FloatArray, displaced: ComplexArray | None = None, runout: FloatArray | None = None
    ) -> FloatArray:
        """Return the angle of the cranks less the one that the held sun gives rigid teeth without play, rad, shape (positions,).

        `displaced` is that of the cranks at their planets, `runout` what eccentricities add, rad, shape (positions,); None where
        there is none.
        """
        each = self.twist * moments
        if displaced is not None:
            each = each + (self._slope(np.sign(moments)).conjugate() * displaced).real.sum(axis=-1)
        total = moments.sum(axis=1)
        free = np.sign(total)[:, None] * self.half_free
        lag = each.mean(axis=1) + np.broadcast_to(free, (total.size, 1))[:, 0]
        return np.asarray(-(lag if runout is None else lag + runout))
