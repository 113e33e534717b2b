"""Condensation of all bodies of a drive: zones on the meshes, one factorisation for each distinct mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.condensation import CondensedBody, condense_body
from fem.body.elasticity import PlaneState, assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.drive.contact_kinds import PairKind
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes, RoundGrading, RoundMesh
from fem.drive.model import ContactPair, DriveModel, RoundBody, RoundGroup
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import Curve, DriveShapes
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive, Material
from ltca.geometry.placement import Placement

# Reach of the pressure zones and of the zones opposite, in expected half-widths. A load guessed too small by a
# factor of four doubles the half-width and still ends inside.
PRESSURE_REACH = 2.4
OPPOSITE_REACH = 3.6
# Numbers in condensed pins and rollers that travel from one position to the next, half a gigabyte: twice what the paper's
# drive needs for a turn of the crank.
ENTRIES_KEPT = 40_000_000


def condense_drive(
    drive: Drive,
    shapes: DriveShapes,
    contacts: ExpectedContacts,
    meshes: DriveMeshes,
    *,
    plane: PlaneState = "strain",
    known: tuple[RoundGroup, ...] = (),
) -> DriveModel:
    """Assemble, factorise and condense all bodies on meshes graded for the expected contacts.

    Contacts with an expected half-width become candidates. Pins and rollers condensed before (`known`) are reused where grading,
    material, thickness and plane state are the same. MeshError when a boundary is missing or too coarse for a contact zone.
    """
    place, slab = Placement.of_drive(drive), _Slab(thickness=drive.disc.thickness, state=plane)
    materials, holes = drive.materials, contacts.holes
    outer = contacts.rollers_outer
    stock = {group.made_of: group for group in known}
    pins = _condense_round(meshes.unturned_pins, contacts.pins, materials.wheel_pin, slab, stock, held="core")
    rollers = _condense_round(meshes.unturned_rollers, outer, materials.roller, slab, stock)
    elastic = _condense_round(meshes.unturned_shaft_pins, holes, materials.shaft_pin, slab, stock)
    groups = (*pins.groups, *rollers.groups, *elastic.groups)
    places = (
        pins.places,
        counted_from(len(pins.groups), rollers.places),
        counted_from(len(pins.groups) + len(rollers.groups), elastic.places),
    )
    pairs = list_pairs(shapes, contacts, meshes, place, places, thickness=slab.thickness)
    on_disc = sum(pair.kind != "roller_inner" for pair in pairs)
    race_loads, first_of_each = distinct_loads(pairs[on_disc:])
    return DriveModel(
        drive=drive,
        crank_angle=contacts.crank_angle,
        shapes=shapes,
        meshes=meshes,
        contacts=contacts,
        disc=_condense_carrier(meshes.disc, pairs[:on_disc], materials.disc, slab),
        race=_condense_carrier(
            meshes.inner_race, pairs[on_disc:], materials.inner_race, slab, held="inner", among=first_of_each
        ),
        groups=groups,
        pairs=tuple(pairs),
        placement=place,
        race_loads=race_loads,
    )


def keep_rounds(known: tuple[RoundGroup, ...], used: tuple[RoundGroup, ...]) -> tuple[RoundGroup, ...]:
    """Return the condensed pins and rollers to keep for further solutions.

    Those just used are last; the oldest of the others are dropped beyond `ENTRIES_KEPT` numbers in all.
    """
    just_used = {group.made_of for group in used}
    room = ENTRIES_KEPT - sum(group.entries for group in used)
    kept: list[RoundGroup] = []
    for group in reversed([group for group in known if group.made_of not in just_used]):
        room -= group.entries
        if room < 0:
            break
        kept.insert(0, group)
    return (*kept, *used)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Slab:
    """Thickness, mm, and plane state of all bodies."""

    thickness: float
    state: PlaneState


@dataclass(frozen=True, slots=True, kw_only=True)
class _RoundBodies:
    """Condensed round bodies of one kind: the groups, and group and rotation of every candidate body."""

    groups: tuple[RoundGroup, ...]
    places: RoundPlaces


RoundPlaces = dict[int, tuple[int, float]]
"""Number of the group and rotation, rad, of every candidate pin or roller by its number."""


def counted_from(first: int, places: RoundPlaces) -> RoundPlaces:
    """Return places with their groups numbered from `first` on."""
    return {body: (first + group, turn) for body, (group, turn) in places.items()}


def distinct_rounds(meshes: tuple[RoundMesh, ...], expected: ContactGroup) -> tuple[list[RoundMesh], RoundPlaces]:
    """Return the meshes of candidate pins or rollers, one for each grading, and which of them every body has."""
    numbers: dict[RoundGrading, int] = {}
    found: list[RoundMesh] = []
    places: RoundPlaces = {}
    for index, mesh in enumerate(meshes):
        if not expected.half_width[index] > 0.0:
            continue
        if mesh.grading not in numbers:
            numbers[mesh.grading] = len(found)
            found.append(mesh)
        places[index] = (numbers[mesh.grading], mesh.turn)
    return found, places


def _condense_round(
    meshes: tuple[RoundMesh, ...],
    expected: ContactGroup,
    material: Material,
    slab: _Slab,
    stock: dict[RoundBody, RoundGroup],
    held: str = "",
) -> _RoundBodies:
    """Condense pins or rollers: equal ones share a factorisation; `held` is a boundary that does not move."""
    distinct, places = distinct_rounds(meshes, expected)
    groups = []
    for mesh in distinct:
        made_of = RoundBody(
            grading=mesh.grading, material=material, thickness=slab.thickness, state=slab.state, held=held
        )
        groups.append(stock.get(made_of) or condense_round_body(made_of, mesh.body))
    return _RoundBodies(groups=tuple(groups), places=places)


def zones_of_round(grading: RoundGrading, body: BodyMesh) -> tuple[OppositeZone, ...]:
    """Return the zones of a pin or roller opposite its contacts, the first at polar angle 0."""
    return tuple(
        OppositeZone.on_circle(body, "surface", complex(side * grading.radius), OPPOSITE_REACH * end.half_width)
        for side, end in zip((1.0, -1.0), grading.ends, strict=False)
    )


def condense_round_body(made_of: RoundBody, body: BodyMesh) -> RoundGroup:
    """Condense a pin or roller, its first contact at polar angle 0, to unit forces on the nodes of its zones."""
    zones = zones_of_round(made_of.grading, body)
    loads = sp.hstack([zone.unit_loads(body.unknowns) for zone in zones], format="csc")
    slab = _Slab(thickness=made_of.thickness, state=made_of.state)
    condensed = _condense(body, loads, made_of.material, slab, made_of.held)
    return RoundGroup(made_of=made_of, body=body, condensed=condensed, zones=zones)


def _condense_carrier(
    body: BodyMesh,
    pairs: list[ContactPair],
    material: Material,
    slab: _Slab,
    held: str = "",
    among: NDArray[np.intp] | None = None,
) -> CondensedBody:
    """Condense the disc or the race under the pressures of its pairs, or `among` all of them those given."""
    loads = sp.hstack([pair.zone.load_shapes(body.unknowns) for pair in pairs], format="csc")
    return _condense(body, loads if among is None else loads[:, among], material, slab, held)


def distinct_loads(pairs: list[ContactPair]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the unit load of each pressure unknown of the inner races, and of each unit load its first unknown.

    Rollers of several cranks press on the same places of one body that stands for all races: the load about a vertex
    is one unit load for all of them.
    """
    vertices = np.concatenate([pair.zone.nodes[1:, 0] for pair in pairs])
    _, first, number = np.unique(vertices, return_index=True, return_inverse=True)
    # Unit loads stand in the order of the unknowns, not of the nodes.
    order = np.argsort(first)
    return np.argsort(order)[number], first[order]


def _condense(body: BodyMesh, loads: sp.csc_matrix, material: Material, slab: _Slab, held: str) -> CondensedBody:
    stiffness = assemble_stiffness(body, material, thickness=slab.thickness, state=slab.state)
    return condense_body(body, stiffness, loads, fixed=unknowns_of_boundary(body, held) if held else None)


def list_pairs(
    shapes: DriveShapes,
    contacts: ExpectedContacts,
    meshes: DriveMeshes,
    placement: Placement,
    rounds: tuple[RoundPlaces, RoundPlaces, RoundPlaces],
    *,
    thickness: float,
    heights: Mapping[PairKind, int] = MappingProxyType({}),
) -> list[ContactPair]:
    """Return the candidate contacts, those on the disc first.

    `rounds` are the meshed wheel pins, rollers and shaft pins, `thickness` is that of the zones, mm; `heights` are the pressure
    unknowns at each of their vertices by kinds, 1 by default.
    """
    pins, rollers, elastic = rounds
    disc, place = shapes.disc, placement
    flanks = (disc.flank,) * len(place.wheel_pin_radii)
    bores = tuple(disc.bores[crank] for crank in place.roller_cranks)
    races = (shapes.inner_race.curves[0],) * len(place.roller_radii)
    outer, inner, holes = contacts.rollers_outer, contacts.rollers_inner, contacts.holes
    pairs = _PairList(thickness=thickness, heights=heights)
    pairs.add("pin", meshes.disc, flanks, contacts.flank_points, contacts.pins, place.wheel_pin_radii, pins)
    pairs.add("hole", meshes.disc, disc.holes, contacts.hole_points, holes, place.shaft_pin_radii, elastic)
    pairs.add("roller_outer", meshes.disc, bores, contacts.bore_points, outer, place.roller_radii, rollers)
    pairs.add("roller_inner", meshes.inner_race, races, contacts.race_points, inner, place.roller_radii, rollers)
    return pairs.found


@dataclass(frozen=True, slots=True, kw_only=True)
class _PairList:
    """Candidate contacts, their pressure unknowns counted on from one to the next."""

    thickness: float
    heights: Mapping[PairKind, int]
    found: list[ContactPair] = field(default_factory=list)

    def add(
        self,
        kind: PairKind,
        body: BodyMesh,
        curves: tuple[Curve, ...],
        points: ComplexArray,
        expected: ContactGroup,
        radii: FloatArray,
        opposite: RoundPlaces,
    ) -> None:
        """Add the pairs of one kind: pressure on `body`, along the curve of each part."""
        width, load = expected.half_width, expected.load
        for index in np.flatnonzero(width > 0.0).tolist():
            reach = PRESSURE_REACH * float(width[index])
            zone = PressureZone.on_boundary(
                body, curves[index], complex(points[index]), reach, thickness=self.thickness
            )
            first = self.found[-1].unknowns.stop if self.found else 0
            group, turn = opposite.get(index, (-1, 0.0))
            self.found.append(
                ContactPair(
                    kind=kind,
                    index=index,
                    zone=zone,
                    unknowns=slice(first, first + zone.unknown_count * self.heights.get(kind, 1)),
                    radius=float(radii[index]),
                    group=group,
                    turn=turn,
                    expected_half_width=float(width[index]),
                    expected_load=float(load[index]),
                )
            )
