"""Condensation of all bodies of a drive: zones on the meshes, one factorisation for each distinct mesh."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.condensation import CondensedBody, condense_body
from fem.body.elasticity import PlaneState, assemble_stiffness, unknowns_of_boundary
from fem.body.surface import OppositeZone, PressureZone
from fem.drive.expected_contacts import ExpectedContacts
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
    thickness, materials = drive.disc.thickness, drive.materials
    groups: list[RoundGroup] = []
    pairs: list[ContactPair] = []
    place = Placement.of_drive(drive)

    def condense_round(
        bodies: tuple[BodyMesh, ...],
        directions: tuple[FloatArray, ...],
        widths: tuple[FloatArray, ...],
        material: Material,
        core: bool,
    ) -> dict[int, tuple[int, float]]:
        """Return group and turn of every candidate body."""
        found: dict[int, tuple[int, float]] = {}
        shared: dict[int, list[int]] = {}
        for index, body in enumerate(bodies):
            if widths[0][index] > 0.0:
                shared.setdefault(id(body.mesh.t), []).append(index)
        for members in shared.values():
            body = bodies[members[0]]
            radius = float(np.abs(body.mesh.doflocs[0] + 1j * body.mesh.doflocs[1]).max())
            zones = []
            for direction, width in zip(directions, widths, strict=True):
                place_on = radius * np.exp(1j * direction[members[0]])
                reach = OPPOSITE_REACH * float(width[members].max())
                zones.append(OppositeZone.on_circle(body, "surface", complex(place_on), reach))
            loads = sp.hstack([zone.unit_loads(body.unknowns) for zone in zones], format="csc")
            stiffness = assemble_stiffness(body, material, thickness=thickness, state=state)
            fixed = unknowns_of_boundary(body, "core") if core else None
            condensed = condense_body(body, stiffness, loads, fixed=fixed)
            groups.append(RoundGroup(body=body, condensed=condensed, zones=tuple(zones)))
            for index in members:
                turn = float(directions[0][index] - directions[0][members[0]])
                found[index] = (len(groups) - 1, turn)
        return found

    pin_groups = condense_round(
        meshes.wheel_pins, (contacts.pins.direction,), (contacts.pins.half_width,), materials.wheel_pin, True
    )
    outer, inner = contacts.rollers_outer, contacts.rollers_inner
    roller_groups = condense_round(
        meshes.rollers,
        (outer.direction, inner.direction),
        (outer.half_width, inner.half_width),
        materials.roller,
        False,
    )

    hole_groups: dict[int, tuple[int, float]] = {}
    if shaft_pins:
        holes_expected = contacts.holes
        hole_groups = condense_round(
            shaft_pins, (holes_expected.direction,), (holes_expected.half_width,), materials.shaft_pin, False
        )

    def add_pairs(
        kind: PairKind,
        body: BodyMesh,
        curves: tuple[Curve, ...],
        points: ComplexArray,
        width: FloatArray,
        load: FloatArray,
        radii: FloatArray,
        found: dict[int, tuple[int, float]],
    ) -> None:
        for index in np.flatnonzero(width > 0.0).tolist():
            reach = PRESSURE_REACH * float(width[index])
            curve = curves[index] if len(curves) > 1 else curves[0]
            zone = PressureZone.on_boundary(body, curve, complex(points[index]), reach, thickness=thickness)
            first = pairs[-1].unknowns.stop if pairs else 0
            group, turn = found.get(index, (-1, 0.0))
            pairs.append(
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

    disc, race = meshes.disc, meshes.inner_race
    flank, bore, holes = shapes.disc.flank, shapes.disc.bore, shapes.disc.holes
    pins = contacts.pins
    add_pairs(
        "pin", disc, (flank,), contacts.flank_points, pins.half_width, pins.load, place.wheel_pin_radii, pin_groups
    )
    add_pairs(
        "hole",
        disc,
        holes,
        contacts.hole_points,
        contacts.holes.half_width,
        contacts.holes.load,
        place.shaft_pin_radii,
        hole_groups,
    )
    add_pairs(
        "roller_outer",
        disc,
        (bore,),
        contacts.bore_points,
        outer.half_width,
        outer.load,
        place.roller_radii,
        roller_groups,
    )
    split = len(pairs)
    add_pairs(
        "roller_inner",
        race,
        (shapes.inner_race.curves[0],),
        contacts.race_points,
        inner.half_width,
        inner.load,
        place.roller_radii,
        roller_groups,
    )

    def condense_carrier(body: BodyMesh, own: list[ContactPair], material: Material, free: bool) -> CondensedBody:
        stiffness = assemble_stiffness(body, material, thickness=thickness, state=state)
        loads = sp.hstack([pair.zone.load_shapes(body.unknowns) for pair in own], format="csc")
        return condense_body(body, stiffness, loads, fixed=None if free else unknowns_of_boundary(body, "inner"))

    return DriveModel(
        drive=drive,
        crank_angle=contacts.crank_angle,
        shapes=shapes,
        meshes=meshes,
        contacts=contacts,
        disc=condense_carrier(disc, pairs[:split], materials.disc, True),
        race=condense_carrier(race, pairs[split:], materials.inner_race, False),
        groups=tuple(groups),
        pairs=tuple(pairs),
        placement=place,
        shaft_pins=shaft_pins,
    )
