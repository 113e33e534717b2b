"""Condensation of all bodies of a drive: zones on the meshes, one factorisation for each distinct mesh."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.condensation import CondensedBody, condense_body
from fem.body.elasticity import PlaneState, assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.drive.contact_kinds import PairKind
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes, RoundMesh
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
    ring: FloatArray | None = None,
    by_others: ComplexArray | None = None,
) -> DriveModel:
    """Assemble, factorise and condense all bodies on meshes graded for the expected contacts.

    Contacts with an expected half-width become candidates. Pins and rollers condensed before (`known`) are reused where grading,
    material, thickness and plane state are the same; `ring` and `by_others` are those of `DriveModel`. MeshError when a boundary
    is missing or too coarse for a contact zone.
    """
    place, slab = Placement.of_drive(drive), _Slab(thickness=drive.disc.thickness, state=plane)
    materials, holes = drive.materials, contacts.holes
    outer, inner = contacts.rollers_outer, contacts.rollers_inner
    stock = {group.made_of: group for group in known}
    pins = _condense_round(meshes.unturned_pins, contacts.pins, materials.wheel_pin, slab, stock, held="core")
    rollers = _condense_round(meshes.unturned_rollers, outer, materials.roller, slab, stock)
    elastic = _condense_round(meshes.unturned_shaft_pins, holes, materials.shaft_pin, slab, stock)
    pairs = _PairList(thickness=slab.thickness)
    groups = (*pins.groups, *rollers.groups, *elastic.groups)
    rollers = rollers.counted_from(len(pins.groups))
    elastic = elastic.counted_from(len(pins.groups) + len(rollers.groups))
    disc = shapes.disc
    flanks = (disc.flank,) * len(place.wheel_pin_radii)
    bores = tuple(disc.bores[crank] for crank in place.roller_cranks)
    races = (shapes.inner_race.curves[0],) * len(place.roller_radii)
    pairs.add("pin", meshes.disc, flanks, contacts.flank_points, contacts.pins, place.wheel_pin_radii, pins)
    pairs.add("hole", meshes.disc, disc.holes, contacts.hole_points, holes, place.shaft_pin_radii, elastic)
    pairs.add("roller_outer", meshes.disc, bores, contacts.bore_points, outer, place.roller_radii, rollers)
    on_disc = len(pairs.found)
    pairs.add("roller_inner", meshes.inner_race, races, contacts.race_points, inner, place.roller_radii, rollers)
    race_loads, first_of_each = _distinct_loads(pairs.found[on_disc:])
    return DriveModel(
        drive=drive,
        crank_angle=contacts.crank_angle,
        shapes=shapes,
        meshes=meshes,
        contacts=contacts,
        disc=_condense_carrier(meshes.disc, pairs.found[:on_disc], materials.disc, slab),
        race=_condense_carrier(
            meshes.inner_race, pairs.found[on_disc:], materials.inner_race, slab, held="inner", among=first_of_each
        ),
        groups=groups,
        pairs=tuple(pairs.found),
        placement=place,
        race_loads=race_loads,
        ring=ring,
        by_others=np.zeros(len(place.wheel_pin_radii), dtype=complex) if by_others is None else by_others,
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

    groups: tuple[RoundGroup, ...] = ()
    places: dict[int, tuple[int, float]] = field(default_factory=dict)

    def counted_from(self, first: int) -> _RoundBodies:
        """Return the same bodies with their groups numbered from `first` on."""
        places = {body: (first + group, turn) for body, (group, turn) in self.places.items()}
        return _RoundBodies(groups=self.groups, places=places)


def _condense_round(
    meshes: tuple[RoundMesh, ...],
    expected: ContactGroup,
    material: Material,
    slab: _Slab,
    stock: dict[RoundBody, RoundGroup],
    held: str = "",
) -> _RoundBodies:
    """Condense pins or rollers: equal ones share a factorisation; `held` is a boundary that does not move."""
    groups: list[RoundGroup] = []
    numbers: dict[RoundBody, int] = {}
    places: dict[int, tuple[int, float]] = {}
    for index, mesh in enumerate(meshes):
        if not expected.half_width[index] > 0.0:
            continue
        made_of = RoundBody(
            grading=mesh.grading, material=material, thickness=slab.thickness, state=slab.state, held=held
        )
        if made_of not in numbers:
            numbers[made_of] = len(groups)
            groups.append(stock.get(made_of) or condense_round_body(made_of, mesh.body))
        places[index] = (numbers[made_of], mesh.turn)
    return _RoundBodies(groups=tuple(groups), places=places)


def condense_round_body(made_of: RoundBody, body: BodyMesh) -> RoundGroup:
    """Condense a pin or roller, its first contact at polar angle 0, to unit forces on the nodes of its zones."""
    grading = made_of.grading
    zones = tuple(
        OppositeZone.on_circle(body, "surface", complex(side * grading.radius), OPPOSITE_REACH * end.half_width)
        for side, end in zip((1.0, -1.0), grading.ends, strict=False)
    )
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


def _distinct_loads(pairs: list[ContactPair]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
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
        """Add the pairs of one kind: pressure on `body`, along the curve of each part."""
        width, load = expected.half_width, expected.load
        for index in np.flatnonzero(width > 0.0).tolist():
            reach = PRESSURE_REACH * float(width[index])
            zone = PressureZone.on_boundary(
                body, curves[index], complex(points[index]), reach, thickness=self.thickness
            )
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
