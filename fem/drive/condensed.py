"""Condensation of all bodies of a drive: zones on the meshes, one factorisation for each distinct mesh."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.condensation import CondensedBody, condense_body
from fem.body.elasticity import PlaneState, assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes
from fem.drive.model import ContactPair, DriveModel, PairKind, RoundGroup
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import Curve, DriveShapes
from ltca.drive.parts import Drive, Material
from ltca.geometry.placement import Placement

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Reach of the pressure zones and of the zones opposite, in expected half-widths. A load guessed too small by a
# factor of four doubles the half-width and still ends inside.
PRESSURE_REACH = 2.4
OPPOSITE_REACH = 3.6


def condense_drive(
    drive: Drive,
    shapes: DriveShapes,
    contacts: ExpectedContacts,
    meshes: DriveMeshes,
    *,
    state: PlaneState = "strain",
    shaft_pins: tuple[BodyMesh, ...] = (),
) -> DriveModel:
    """Assemble, factorise and condense all bodies.

    Parameters
    ----------
    drive : Drive
        The drive in one case.
    shapes : DriveShapes
        Its shapes.
    contacts : ExpectedContacts
        Expected contacts; those with a half-width become candidates.
    meshes : DriveMeshes
        Meshes graded for them.
    state : {"strain", "stress"}
        Plane strain or plane stress.
    shaft_pins : tuple of BodyMesh
        Meshes of elastic shaft pins, from `fem.drive.shaft_pins.mesh_shaft_pins`; rigid circles without them.

    Returns
    -------
    DriveModel
        Ready for any load and pose near the expected one.

    Raises
    ------
    MeshError
        When a boundary is missing or too coarse for a contact zone.
    """
    place, slab = Placement.of_drive(drive), _Slab(thickness=drive.disc.thickness, state=state)
    materials, holes = drive.materials, contacts.holes
    outer, inner = contacts.rollers_outer, contacts.rollers_inner
    pins = _condense_round(meshes.wheel_pins, (contacts.pins,), materials.wheel_pin, slab, held="core")
    rollers = _condense_round(meshes.rollers, (outer, inner), materials.roller, slab)
    elastic = _condense_round(shaft_pins, (holes,), materials.shaft_pin, slab) if shaft_pins else _RoundBodies()
    pairs = _PairList(thickness=slab.thickness)
    groups = (*pins.groups, *rollers.groups, *elastic.groups)
    rollers = rollers.counted_from(len(pins.groups))
    elastic = elastic.counted_from(len(pins.groups) + len(rollers.groups))
    disc = shapes.disc
    pairs.add("pin", meshes.disc, (disc.flank,), contacts.flank_points, contacts.pins, place.wheel_pin_radii, pins)
    pairs.add("hole", meshes.disc, disc.holes, contacts.hole_points, holes, place.shaft_pin_radii, elastic)
    pairs.add("roller_outer", meshes.disc, (disc.bore,), contacts.bore_points, outer, place.roller_radii, rollers)
    on_disc = len(pairs.found)
    race = shapes.inner_race.curves[0]
    pairs.add("roller_inner", meshes.inner_race, (race,), contacts.race_points, inner, place.roller_radii, rollers)
    return DriveModel(
        drive=drive,
        crank_angle=contacts.crank_angle,
        shapes=shapes,
        meshes=meshes,
        contacts=contacts,
        disc=_condense_carrier(meshes.disc, pairs.found[:on_disc], materials.disc, slab),
        race=_condense_carrier(meshes.inner_race, pairs.found[on_disc:], materials.inner_race, slab, held="inner"),
        groups=groups,
        pairs=tuple(pairs.found),
        placement=place,
        shaft_pins=shaft_pins,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Slab:
    """What all bodies share: thickness in mm and plane state."""

    thickness: float
    state: PlaneState


@dataclass(frozen=True, slots=True, kw_only=True)
class _RoundBodies:
    """Condensed round bodies of one kind: the groups, and of every candidate body its group and its turn there."""

    groups: tuple[RoundGroup, ...] = ()
    places: dict[int, tuple[int, float]] = field(default_factory=dict)

    def counted_from(self, first: int) -> _RoundBodies:
        """Return the same bodies with their groups numbered from `first` on."""
        places = {body: (first + group, turn) for body, (group, turn) in self.places.items()}
        return _RoundBodies(groups=self.groups, places=places)


def _condense_round(
    bodies: tuple[BodyMesh, ...],
    expected: tuple[ContactGroup, ...],
    material: Material,
    slab: _Slab,
    held: str = "",
) -> _RoundBodies:
    """Condense pins or rollers: bodies of one mesh share a factorisation; `held` is a boundary that does not move."""
    directions = expected[0].direction
    shared: dict[int, list[int]] = {}
    for index, body in enumerate(bodies):
        if expected[0].half_width[index] > 0.0:
            shared.setdefault(id(body.mesh.t), []).append(index)
    groups: list[RoundGroup] = []
    places: dict[int, tuple[int, float]] = {}
    for members in shared.values():
        first, body = members[0], bodies[members[0]]
        radius = float(np.abs(body.mesh.doflocs[0] + 1j * body.mesh.doflocs[1]).max())
        zones = []
        for side in expected:
            place = radius * np.exp(1j * side.direction[first])
            reach = OPPOSITE_REACH * float(side.half_width[members].max())
            zones.append(OppositeZone.on_circle(body, "surface", complex(place), reach))
        loads = sp.hstack([zone.unit_loads(body.unknowns) for zone in zones], format="csc")
        condensed = _condense(body, loads, material, slab, held)
        for index in members:
            places[index] = (len(groups), float(directions[index] - directions[first]))
        groups.append(RoundGroup(body=body, condensed=condensed, zones=tuple(zones)))
    return _RoundBodies(groups=tuple(groups), places=places)


def _condense_carrier(
    body: BodyMesh, pairs: list[ContactPair], material: Material, slab: _Slab, held: str = ""
) -> CondensedBody:
    """Condense the disc or the race under the pressures of its pairs."""
    loads = sp.hstack([pair.zone.load_shapes(body.unknowns) for pair in pairs], format="csc")
    return _condense(body, loads, material, slab, held)


def _condense(body: BodyMesh, loads: sp.csc_matrix, material: Material, slab: _Slab, held: str) -> CondensedBody:
    stiffness = assemble_stiffness(body, material, thickness=slab.thickness, state=slab.state)
    return condense_body(body, stiffness, loads, fixed=unknowns_of_boundary(body, held) if held else None)


@dataclass(frozen=True, slots=True, kw_only=True)
class _PairList:
    """Candidate contacts, their pressure unknowns counted on from one to the next."""

    thickness: float
    found: list[ContactPair] = field(default_factory=list)

    def add(
        self,
        kind: PairKind,
        body: BodyMesh,
        curves: tuple[Curve, ...],
        points: ComplexArray,
        expected: ContactGroup,
        radii: FloatArray,
        opposite: _RoundBodies,
    ) -> None:
        """Add the pairs of one kind: pressure on `body`, along one curve or along one for each pair."""
        width, load = expected.half_width, expected.load
        for index in np.flatnonzero(width > 0.0).tolist():
            reach = PRESSURE_REACH * float(width[index])
            curve = curves[index] if len(curves) > 1 else curves[0]
            zone = PressureZone.on_boundary(body, curve, complex(points[index]), reach, thickness=self.thickness)
            first = self.found[-1].unknowns.stop if self.found else 0
            group, turn = opposite.places.get(index, (-1, 0.0))
            self.found.append(
                ContactPair(
                    kind=kind,
                    index=index,
                    zone=zone,
                    unknowns=slice(first, first + zone.unknown_count),
                    radius=float(radii[index]),
                    group=group,
                    turn=turn,
                    expected_half_width=float(width[index]),
                    expected_load=float(load[index]),
                )
            )
