r"""First stage: forces of the sun on the planets of the cranks, and the angle that its teeth add to the output.

At the pitch point, r_w from the axis of the crank, the sun pushes (``docs/how-to/several_cranks.md``) with

.. math:: F_t = T/r_w, \quad F_r = |F_t| \tan\alpha_{wt}, \quad F_a = -F_t \tan\beta_w .
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.beam import shaft_flexibility, support_parts
from ltca.drive.parts import Drive
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.placement import BatchScalar
from ltca.geometry.rotation import unit
from ltca.laws.member_bearings import crank_springs, journals


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshForces:
    """Forces of the sun on the planets, N, shape (positions, cranks)."""

    tangential: FloatArray  # positive where it turns the planet counter-clockwise
    radial: FloatArray  # away from the sun
    axial: FloatArray  # along z
    in_plane: ComplexArray  # the first two in the fixed frame


@dataclass(frozen=True, slots=True, kw_only=True)
class StageMesh:
    """Mesh of the sun with the planets of all cranks; lengths are in mm."""

    pitch_radius: BatchScalar = by_drive(0)  # r_w of planets
    separating: BatchScalar = by_drive(0)  # tan α_wt
    axial: BatchScalar = by_drive(0)  # tan β_w, positive of right-handed planets
    twist: BatchScalar = by_drive(0)  # angle of a crank by its moment, 1/(c r_b²), rad/(N·mm)
    half_free: BatchScalar = by_drive(0)  # half of the free angle of a planet, rad
    plane: BatchScalar = by_drive(0)  # axial place of the planets
    sun_radius: BatchScalar = by_drive(0)
    reduction_ratio: float
    outward: ComplexArray = by_drive(1)  # directions from the sun to the cranks
    by_pose: ComplexArray = by_drive(3)  # displacement and slope at the planet, shape (cranks, 2, coordinates)
    by_bearings: FloatArray = by_drive(2)  # the same by displacements in its two bearings, discs standing still
    own: FloatArray = by_drive(2)  # the same by force and couple there, mm/N
    on_supports: FloatArray = by_drive(2)  # part of force and couple that each bearing carries, shape (supports, 2)
    yields: bool  # whether cranks yield, or the far flange in which they stand
    carried: bool  # whether the carrier is the output
    sun_turns: float  # turns of the sun against the carrier by turn of a crank, −z₂/z₁
    sun_runout: ComplexArray = by_drive(1)  # d_s at crank angle zero
    planet_runout: ComplexArray = by_drive(1)  # d_c at crank angle zero

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
        """Return the free play of the wheel by the backlash of the teeth, in the mean of all meshes, rad, shape (positions,)."""
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
        """Return the lag of every crank behind the sun by runout, rad, shape (positions, cranks); `sense` chooses the flank."""
        pushed = self._slope(np.broadcast_to(sense[:, None], (sense.size, self.outward.shape[-1])))[..., 0]
        return np.asarray((pushed.conjugate() * self._stands_off(crank_angle)).real)

    def forces(self, moments: FloatArray) -> MeshForces:
        """Return the forces at moments that hold the cranks, ccw positive, N·mm, shape (positions, cranks)."""
        tangential = moments / self.pitch_radius
        radial = np.abs(tangential) * self.separating
        axial = -tangential * self.axial
        in_plane = (radial - 1j * tangential) * self.outward
        return MeshForces(tangential=tangential, radial=radial, axial=axial, in_plane=in_plane)

    def on_wheel(self, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return force and lean of the wheel by the sun, N and N·mm, shape (positions, 2), and derivatives by cranks' moments."""
        slope = self._slope(np.sign(moments))[..., 0]
        lever = self.sun_radius * self.outward * self.axial / self.pitch_radius
        by_moments = (-1.0 if self.carried else 0.0) * np.stack((slope, self.plane * slope + lever), axis=1)
        return (by_moments * moments[:, None]).sum(axis=2), by_moments

    def on_bearings(self, moments: FloatArray) -> ComplexArray:
        """Return the forces of the teeth on bearings of the cranks, N, shape (positions, cranks, supports)."""
        return np.asarray(np.matmul(self.on_planets(moments)[0], np.swapaxes(self.on_supports, -1, -2)))

    def on_planets(self, moments: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return force and couple on every planet, N and N·mm, shape (positions, cranks, 2), and derivatives by its moment."""
        slope = self._slope(np.sign(moments))
        return slope * moments[..., None], slope

    def together(self, sense: float) -> tuple[float, FloatArray]:
        """Return the lag of all cranks on one flank by their whole moment, shared evenly, rad/(N·mm), and by the coordinates."""
        pushed = self._slope(np.full((1, self.outward.shape[-1]), sense))[0]
        own = np.einsum("ci,ij,cj->c", pushed.conjugate(), self.own, pushed).real
        by_pose = np.einsum("ci,cin->cn", pushed.conjugate(), self.by_pose).real.mean(axis=0)
        return float(np.mean(np.squeeze(self.twist) + own)) / own.size, np.asarray(by_pose)

    def beside_discs(self, on_planets: ComplexArray) -> ComplexArray:
        """Return the forces on the two bearings of every crank while the discs stand still, N, shape (positions, cranks, 2)."""
        return np.asarray(np.matmul(on_planets, np.swapaxes(self.by_bearings, -1, -2)))

    def on_coordinates(self, on_planets: ComplexArray) -> FloatArray:
        """Return the work of forces and couples on the planets by the coordinates, shape (positions, coordinates)."""
        return np.asarray((self.by_pose.conjugate() * on_planets[..., None]).real.sum(axis=(-3, -2)))

    def _slope(self, sense: FloatArray) -> ComplexArray:
        """Derivatives of force and couple by the moments of the cranks of given senses, shape (positions, cranks, 2)."""
        in_plane = (self.separating * sense - 1j) / self.pitch_radius * self.outward
        return np.stack(np.broadcast_arrays(in_plane, -self.axial * self.outward), axis=-1)

    def displaced(self, moments: FloatArray, pose: FloatArray, given: ComplexArray | None) -> ComplexArray:
        """Return displacement and slope of every crank at its planet, mm and rad, shape (positions, cranks, 2)."""
        moved = np.matmul(self.by_pose, pose[:, None, :, None])[..., 0]
        if given is not None:
            moved = moved + np.matmul(given, self.by_bearings)
        return np.asarray(moved + np.matmul(self.on_planets(moments)[0], np.swapaxes(self.own, -1, -2)))

    def crank_lag(
        self, moments: FloatArray, displaced: ComplexArray | None = None, runout: FloatArray | None = None
    ) -> FloatArray:
        """Return the angle of the cranks less that by the held sun on rigid teeth without play, rad, shape (positions,)."""
        each = self.twist * moments
        if displaced is not None:
            each = each + (self._slope(np.sign(moments)).conjugate() * displaced).real.sum(axis=-1)
        total = moments.sum(axis=1)
        free = np.sign(total)[:, None] * self.half_free
        lag = each.mean(axis=1) + np.broadcast_to(free, (total.size, 1))[:, 0]
        return np.asarray(-(lag if runout is None else lag + runout))
