"""Condensation of disc, pins, rollers and race as extruded bodies; the memory they need."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem.drive.condensed import RoundPlaces, counted_from, distinct_rounds, list_pairs, zones_of_round
from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes, RoundMesh
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import DriveShapes
from fem.solid.extruded import ExtrudedBody
from fem.solid.section import Section
from fem.solid_contact.bodies import CondensedSolid, Face, Held, condense_solid
from fem.solid_drive.along_width import DriveWidths
from fem.solid_drive.solid_model import SolidGroup, SolidModel
from ltca.arrays import BoolArray
from ltca.drive.parts import Drive, Material
from ltca.geometry.placement import Placement


def condense_solids(
    drive: Drive,
    shapes: DriveShapes,
    contacts: ExpectedContacts,
    meshes: DriveMeshes,
    widths: DriveWidths,
    progress: Callable[[str], None] = lambda _: None,
) -> SolidModel:
    """Assemble, factorise and condense all bodies as solids on plane meshes graded for the expected contacts.

    Contacts with an expected half-width become candidates. MeshError when a boundary is too coarse for a contact zone.
    """
    place, materials = Placement.of_drive(drive), drive.materials
    grids = {kind: widths.grid(kind) for kind in CONTACT_KINDS}

    def rounds(
        unturned: tuple[RoundMesh, ...], expected: ContactGroup, material: Material, name: str, held: str = ""
    ) -> tuple[list[SolidGroup], RoundPlaces]:
        distinct, bodies = distinct_rounds(unturned, expected)
        found = []
        for mesh in distinct:
            zones = zones_of_round(mesh.grading, mesh.body)
            faces = [Face(plane=zone.unit_loads(mesh.body.unknowns), width=widths.grid(name)) for zone in zones]
            solid = condensed(mesh.body, faces, material, name, held)
            found.append(SolidGroup(compliance=solid.compliance, zones=zones, unknowns=solid.unknowns))
        return found, bodies

    def condensed(body: BodyMesh, faces: list[Face], material: Material, name: str, held: str) -> CondensedSolid:
        layers = widths.layers_of(name)
        return condense_solid(Section.of_body(body), layers, material, faces, _hold(body, held), progress)

    pins, pin_places = rounds(meshes.unturned_pins, contacts.pins, materials.wheel_pin, "wheel_pin", "core")
    rollers, roller_places = rounds(meshes.unturned_rollers, contacts.rollers_outer, materials.roller, "roller")
    elastic, elastic_places = rounds(meshes.unturned_shaft_pins, contacts.holes, materials.shaft_pin, "shaft_pin")
    places = (
        pin_places,
        counted_from(len(pins), roller_places),
        counted_from(len(pins) + len(rollers), elastic_places),
    )
    heights = {kind: grid.size for kind, grid in grids.items()}
    pairs = list_pairs(shapes, contacts, meshes, place, places, thickness=1.0, heights=heights)

    def carrier(body: BodyMesh, inner: bool, material: Material, name: str, held: str = "") -> CondensedSolid:
        own = [pair for pair in pairs if (pair.kind == "roller_inner") is inner]
        faces = [Face(plane=pair.zone.load_shapes(body.unknowns), width=grids[pair.kind]) for pair in own]
        return condensed(body, faces, material, name, held)

    race = carrier(meshes.inner_race, True, materials.inner_race, "inner_race", "inner")
    race_compliance, race_unknowns = race.compliance, race.unknowns
    del race
    disc = carrier(meshes.disc, False, materials.disc, "disc")
    return SolidModel(
        drive=drive,
        crank_angle=contacts.crank_angle,
        shapes=shapes,
        meshes=meshes,
        contacts=contacts,
        pairs=tuple(pairs),
        placement=place,
        widths=widths,
        grids=grids,
        disc=disc,
        disc_compliance=disc.compliance,
        race_compliance=race_compliance,
        race_unknowns=race_unknowns,
        groups=(*pins, *rollers, *elastic),
    )


def _hold(body: BodyMesh, boundary: str) -> Held | None:
    """Hold a boundary of a section at every height in all directions; nothing without one."""
    if not boundary:
        return None
    nodes = np.unique(body.boundary_nodes(boundary))

    def held(solid: ExtrudedBody) -> BoolArray:
        still = np.zeros(solid.unknowns, dtype=bool)
        still[solid.all_unknowns_of(nodes)] = True
        return still

    return held
