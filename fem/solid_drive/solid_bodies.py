"""Condensation of disc, pins, rollers and race as extruded bodies; the memory they need."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import scipy.sparse as sp

from fem.drive.condensed import RoundPlaces, counted_from, distinct_loads, distinct_rounds, list_pairs, zones_of_round
from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.expected_contacts import ContactGroup, ExpectedContacts
from fem.drive.meshes import DriveMeshes, RoundMesh
from fem.drive.model import bore_weights
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import DriveShapes
from fem.solid.extruded import ExtrudedBody
from fem.solid.section import Section
from fem.solid_contact.bodies import CondensedSolid, Face, Held, Probes, condense_solid
from fem.solid_drive.along_width import DriveWidths
from fem.solid_drive.solid_model import SolidModel, SolidRound
from ltca.arrays import BoolArray, IntArray
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
    ) -> tuple[list[SolidRound], RoundPlaces]:
        distinct, bodies = distinct_rounds(unturned, expected)
        found = []
        for mesh in distinct:
            zones = zones_of_round(mesh.grading, mesh.body)
            faces = [Face(plane=zone.unit_loads(mesh.body.unknowns), width=widths.grid(name)) for zone in zones]
            solid = condensed(mesh.body, faces, material, name, held)
            found.append(SolidRound(compliance=solid.compliance, zones=zones, unknowns=solid.unknowns))
        return found, bodies

    def condensed(
        body: BodyMesh, faces: list[Face], material: Material, name: str, held: str, probes: Probes | None = None
    ) -> CondensedSolid:
        section, layers, still = Section.of_body(body), widths.layers_of(name), _hold(body, held)
        return condense_solid(section, layers, material, faces, still, progress, probes=probes, keep_factors=False)

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
        if inner:
            # Rollers of several cranks press on the same places.
            plane = sp.hstack([face.plane for face in faces], format="csc")[:, first_of_each]
            faces = [Face(plane=plane, width=grids["roller_inner"])]
        return condensed(
            body, faces, material, name, held, None if inner else partial(_disc_probes, meshes, shapes, nodes)
        )

    per_vertex = heights["roller_inner"]
    race_loads, first_of_each = distinct_loads([pair for pair in pairs if pair.kind == "roller_inner"])
    nodes = _nodes_without_contact(meshes.disc, contacts)
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
        disc=carrier(meshes.disc, False, materials.disc, "disc"),
        race=carrier(meshes.inner_race, True, materials.inner_race, "inner_race", "inner"),
        race_loads=(race_loads[:, None] * per_vertex + np.arange(per_vertex)).ravel(),
        groups=(*pins, *rollers, *elastic),
        probed_places=meshes.disc.places[nodes],
    )


def _nodes_without_contact(disc: BodyMesh, contacts: ExpectedContacts) -> IntArray:
    """The nodes of the disc next to where pins, rollers and holes that are no candidates would touch it."""
    groups = (
        (contacts.flank_points, contacts.pins),
        (contacts.bore_points, contacts.rollers_outer),
        (contacts.hole_points, contacts.holes),
    )
    points = np.concatenate([places[~(group.half_width > 0.0)] for places, group in groups])
    return np.array([int(np.argmin(np.abs(disc.places - point))) for point in points], dtype=np.intp)


def _disc_probes(meshes: DriveMeshes, shapes: DriveShapes, nodes: IntArray, solid: ExtrudedBody) -> sp.spmatrix:
    """Fit of the bores as a mean along the width and displacements of nodes at mid-width; in the other class the fit by height.

    By height it is (12/t³) ∫ u z dz, what a linear load measures.
    """
    on_bores, fit = bore_weights(meshes.disc, shapes.disc)
    layers = solid.layers
    along = layers.moments(layers.unit_load)[layers.free_in_plane]
    columns = np.concatenate([solid.unknowns_of(on_bores, axis) for axis in (0, 1)])
    weights = (fit[:, :, None] * along).reshape(3, -1)
    rows = np.repeat(np.arange(3), weights.shape[1])
    of_bores = sp.csr_matrix((weights.ravel(), (rows, np.tile(columns.ravel(), 3))), shape=(3, solid.unknowns))
    if layers.parity == "antisymmetric":
        return of_bores
    at = np.column_stack([solid.unknowns_of(nodes, axis)[:, 0] for axis in (0, 1)]).ravel()
    return sp.vstack([of_bores, sp.csr_matrix((np.ones(at.size), (np.arange(at.size), at)), (at.size, solid.unknowns))])


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
