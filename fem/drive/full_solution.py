"""Finite-element solution of one disc with wheel, crank and pin shaft at one crank angle, and what follows from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.body.elasticity import PlaneState
from fem.drive.contact_results import ContactResults
from fem.drive.model import DriveModel, DrivePose, RoundGroup
from fem.drive.pose import PoseSolution, pair_forces


@dataclass(frozen=True, slots=True, kw_only=True)
class FullSolution:
    """Finite-element solution of a drive at one crank angle.

    Attributes
    ----------
    model : DriveModel
        Condensed bodies, meshes, candidate pairs.
    state : PoseSolution
        Pressures at the loaded pose.
    contacts : ContactResults
        Loads, peak pressures, half-widths of all parts, and forces on the disc.
    scale : float
        Element edge as a multiple of an eighth of each half-width.
    plane_state : {"strain", "stress"}
        Plane strain or plane stress.
    fine_walls : bool
        Whether the walls of the disc are meshed finely enough for the stress along them.
    pose_iterations : int
        Steps on the final meshes.
    rounds : tuple of RoundGroup
        Condensed pins and rollers, coarse ones, too, to start another solution with.
    seconds : dict of str to float
        Wall time of each stage; ``total`` is their sum.
    """

    model: DriveModel
    state: PoseSolution
    contacts: ContactResults
    scale: float
    plane_state: PlaneState
    fine_walls: bool
    pose_iterations: int
    rounds: tuple[RoundGroup, ...]
    seconds: dict[str, float]

    @property
    def pose(self) -> DrivePose:
        """Loaded pose."""
        return self.state.pose

    @property
    def bearing_components(self) -> tuple[float, float]:
        """Bearing force on the disc along its own eccentricity and 90° ahead of it, N."""
        model = self.model
        direction = model.placement.eccentric_direction(np.asarray(model.crank_angle))
        along = self.contacts.bearing_force * complex(direction).conjugate()
        return along.real, along.imag

    @property
    def crank_moment(self) -> float:
        """External moment that holds the crank against this disc, ccw positive, N·mm.

        That of the rollers' forces on the disc about the crank axis, as if they acted at the centre of the race, and by the
        part `cage_speed` of the crank's angle what they take of the cage: their moment about that centre.
        """
        model, place = self.model, self.model.placement
        forces = pair_forces(model, list(self.state.integrals), self.state.contact.pressure)
        on_disc = -sum(force for pair, force in zip(model.pairs, forces, strict=True) if pair.kind == "roller_outer")
        push = complex(on_disc[0], on_disc[1])
        lever = model.race_centre - complex(place.crank_axes[0])
        about_race = float(on_disc[2]) - (model.race_centre.conjugate() * push).imag
        return (lever.conjugate() * push).imag + float(place.cage_speed) * about_race

    @property
    def unknowns(self) -> int:
        """Displacement unknowns of all bodies and pressure unknowns."""
        pins = sum(body.unknowns for body in self.model.shaft_pins)
        return self.model.meshes.unknowns + pins + self.model.unknown_count
