"""Finite-element solution of one disc with wheel, crank and pin shaft at one crank angle, and what follows from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.drive.contact_results import ContactResults
from fem.drive.expected_contacts import ExpectedContacts
from fem.drive.meshes import DriveMeshes
from fem.drive.model import DriveModel, DrivePose, PlacedContacts, RoundGroup
from fem.drive.pose import PoseSolution, moments_on_cranks, pair_forces
from fem.mesh.uniform_refinement import CHILDREN
from fem.options import SolutionOptions
from fem.shapes import DriveShapes
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class CoarseSolution:
    """What a solution on refined meshes starts from; without the factors of the coarser ones, which fill the memory.

    Attributes
    ----------
    drive : Drive
        Of one disc.
    shapes : DriveShapes
        Exact shapes.
    contacts : ExpectedContacts
        For which the coarsest meshes were graded.
    meshes : DriveMeshes
        Meshes of the shapes.
    pose : DrivePose
        Loaded pose.
    wheel_moment : float
        External moment on the wheel that the disc carries, N·mm.
    options : SolutionOptions
        How it was solved.
    """

    drive: Drive
    shapes: DriveShapes
    contacts: ExpectedContacts
    meshes: DriveMeshes
    pose: DrivePose
    wheel_moment: float
    options: SolutionOptions

    @property
    def refined_unknowns(self) -> int:
        """Displacement unknowns of the refined meshes that are factorised, about."""
        return CHILDREN * self.meshes.factorised_unknowns


@dataclass(frozen=True, slots=True, kw_only=True)
class FullSolution:
    """Finite-element solution of a drive at one crank angle.

    Attributes
    ----------
    model : PlacedContacts
        Condensed bodies, meshes, candidate pairs.
    state : PoseSolution
        Pressures at the loaded pose.
    contacts : ContactResults
        Loads, peak pressures, half-widths of all parts, and forces on the disc.
    options : SolutionOptions
        How it was solved.
    rounds : tuple of RoundGroup
        Condensed pins and rollers, coarse ones, too, to start another solution with.
    seconds : dict of str to float
        Wall time of each stage; ``total`` is their sum.
    """

    model: PlacedContacts
    state: PoseSolution
    contacts: ContactResults
    options: SolutionOptions
    rounds: tuple[RoundGroup, ...]
    seconds: dict[str, float]

    @property
    def pose(self) -> DrivePose:
        """Loaded pose."""
        return self.state.pose

    @property
    def pose_iterations(self) -> int:
        """Steps on the final meshes."""
        return self.state.iterations

    @property
    def plane(self) -> DriveModel:
        """The model of plane bodies."""
        assert isinstance(self.model, DriveModel), "fields in the plane are those of plane bodies"
        return self.model

    @property
    def coarse(self) -> CoarseSolution:
        """What a solution on refined meshes starts from."""
        model = self.model
        return CoarseSolution(
            drive=model.drive,
            shapes=model.shapes,
            contacts=model.contacts,
            meshes=model.meshes,
            pose=self.pose,
            wheel_moment=self.state.wheel_moment,
            options=self.options,
        )

    @property
    def bearing_components(self) -> FloatArray:
        """Bearing force of each crank on the disc along its eccentric and 90° ahead of it, N, shape (cranks, 2)."""
        model = self.model
        directions = model.placement.eccentric_directions(np.asarray(model.crank_angle))
        along = self.contacts.bearing_force * directions.conjugate()
        return np.column_stack([along.real, along.imag])

    @property
    def crank_moments(self) -> FloatArray:
        """External moment that holds each crank against this disc, ccw positive, N·mm, shape (cranks,)."""
        return moments_on_cranks(self.model, self.pair_forces)

    @property
    def pair_forces(self) -> FloatArray:
        """Force (x, y, N) and moment about the origin (N·mm) on the round side of each pair, shape (pairs, 3)."""
        return pair_forces(self.model, self.state.integrals, self.state.contact.pressure)

    @property
    def unknowns(self) -> int:
        """Displacement unknowns of all bodies and pressure unknowns."""
        return self.model.displacement_count + self.model.unknown_count
