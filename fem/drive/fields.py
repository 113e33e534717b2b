"""Fields of a full solution on the nodes of every body, in the fixed frame at the loaded pose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem.body.stress import Stress, recover_stress
from fem.contact.coupling import Pose
from fem.contact.pressure_measures import vertex_means
from fem.drive.contact_kinds import PairKind
from fem.drive.full_solution import FullSolution
from fem.drive.model import DriveModel
from fem.drive.pose import PoseSolution
from fem.mesh.body_mesh import BodyMesh, move_nodes
from fem.mesh.placed_body import PlacedBody
from ltca.arrays import ComplexArray, FloatArray

_BODY_KINDS = {"pin": "pin", "roller_outer": "roller", "roller_inner": "roller", "hole": "shaft_pin"}


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyField:
    """Displacement and stress of one body.

    Attributes
    ----------
    kind : str
        "disc", "pin", "roller", "shaft_pin" (elastic ones) or "inner_race".
    body : BodyMesh
        Its mesh in its own frame.
    pose : Pose
        Of that frame in the loaded pose.
    rigid : array of complex, shape (nodes,)
        Motion of the rigid body from its nominal place to the loaded pose, mm.
    elastic : array of complex, shape (nodes,)
        Displacement by deformation, on top of it, mm.
    stress : Stress
        Averaged at the nodes, fixed axes, MPa.
    pressure : array, shape (nodes,)
        Contact pressure where the body carries it (disc and inner race), MPa.
    """

    kind: str
    body: BodyMesh
    pose: Pose
    rigid: ComplexArray
    elastic: ComplexArray
    stress: Stress
    pressure: FloatArray

    @property
    def places(self) -> ComplexArray:
        """Nodes of the rigid body in the loaded pose, mm."""
        return self.pose.place(self.body.places)

    @property
    def placed_mesh(self) -> BodyMesh:
        """The mesh at that place."""
        nodes = self.places
        return BodyMesh(name=self.body.name, mesh=move_nodes(self.body.mesh, np.vstack([nodes.real, nodes.imag])))

    @property
    def placed(self) -> PlacedBody:
        """The mesh at that place, to draw."""
        return PlacedBody(body=self.body, centre=self.pose.centre, rotation=self.pose.rotation, kind=self.kind)


def recover_fields(full: FullSolution) -> tuple[BodyField, ...]:
    """Return the fields of disc, wheel pins, rollers, elastic shaft pins, and then the inner race of each crank."""
    model, solution = full.plane, full.state
    pressure = solution.contact.pressure
    meshes, materials, pose = model.meshes, model.drive.materials, solution.pose
    ideal = model.start_pose((0.0, 0.0, 0.0, 0.0))
    fields = []

    def add(kind: str, body: BodyMesh, at: Pose, nominal: Pose, elastic: FloatArray, crank: int = 0) -> None:
        local = body.places
        material = {
            "disc": materials.disc,
            "pin": materials.wheel_pin,
            "roller": materials.roller,
            "inner_race": materials.inner_race,
            "shaft_pin": materials.shaft_pin,
        }[kind]
        stress = turn_stress(recover_stress(body, elastic, material, state=full.options.plane), at.rotation)
        carried = np.zeros(body.node_count)
        if kind in ("disc", "inner_race"):
            carried = _pressure_on(model, pressure, body.node_count, crank if kind == "inner_race" else None)
        fields.append(
            BodyField(
                kind=kind,
                body=body,
                pose=at,
                rigid=at.place(local) - nominal.place(local),
                elastic=at.turn(elastic[0::2] + 1j * elastic[1::2]),
                stress=stress,
                pressure=carried,
            )
        )

    add("disc", meshes.disc, model.disc_pose(pose), model.disc_pose(ideal), model.disc_displacement(pressure))
    round_displacements = _round_displacements(model, solution)
    centres: tuple[tuple[str, PairKind, tuple[BodyMesh, ...]], ...] = (
        ("pin", "pin", meshes.wheel_pins),
        ("roller", "roller_outer", meshes.rollers),
        ("shaft_pin", "hole", meshes.shaft_pins),
    )
    for kind, pair_kind, bodies in centres:
        for index, body in enumerate(bodies):
            elastic = round_displacements.get((kind, index), np.zeros(body.unknowns))
            at = Pose(centre=model.circle_centre(pair_kind, index, pose))
            add(kind, body, at, Pose(centre=model.circle_centre(pair_kind, index, ideal)), elastic)
    cranks = model.placement.cranks
    for crank, centre in enumerate(model.race_centres.tolist()):
        name = meshes.inner_race.name if cranks == 1 else f"{meshes.inner_race.name}_{crank}"
        body, at, elastic = (
            replace(meshes.inner_race, name=name),
            Pose(centre=centre),
            model.race_displacement(crank, pressure),
        )
        add("inner_race", body, at, at, elastic, crank)
    return tuple(fields)


def _round_displacements(model: DriveModel, solution: PoseSolution) -> dict[tuple[str, int], FloatArray]:
    """Return the nodal displacements of loaded pins and rollers in fixed axes."""
    loads: dict[tuple[str, int], FloatArray] = {}
    turns: dict[tuple[str, int], tuple[int, float]] = {}
    for pair, integral in zip(model.pairs, solution.integrals, strict=True):
        if pair.group < 0:
            continue
        key = (_BODY_KINDS[pair.kind], pair.index)
        own = integral.opposite_loads @ solution.contact.pressure[pair.unknowns]
        # Outer comes before inner for every roller, as in its group.
        loads[key] = np.concatenate([loads[key], own]) if key in loads else own
        turns[key] = (pair.group, pair.turn)
    found = {}
    for key, amount in loads.items():
        group, turn = turns[key]
        u = model.groups[group].condensed.displacement(amount)
        turned = (u[0::2] + 1j * u[1::2]) * np.exp(1j * turn)
        found[key] = np.column_stack([turned.real, turned.imag]).ravel()
    return found


def _pressure_on(model: DriveModel, pressure: FloatArray, nodes: int, crank: int | None) -> FloatArray:
    """Return the pressure on the nodes of the inner race of a crank, of the disc for None."""
    field = np.zeros(nodes)
    for pair in model.pairs:
        if (model.crank_of(pair.index) if pair.kind == "roller_inner" else None) == crank:
            full = vertex_means(pair.zone.arc, pair.zone.at_vertices(pressure[pair.unknowns]))
            field[pair.zone.nodes[:, 0]] = full[:-1]
            field[pair.zone.nodes[:, 1]] = 0.5 * (full[:-1] + full[1:])
    return field


def turn_stress(stress: Stress, angle: float) -> Stress:
    """Return the components of a stress in axes the body has been turned from by `angle`, rad."""
    c, s = np.cos(angle), np.sin(angle)
    return Stress(
        xx=c * c * stress.xx + s * s * stress.yy - 2.0 * c * s * stress.xy,
        yy=s * s * stress.xx + c * c * stress.yy + 2.0 * c * s * stress.xy,
        xy=c * s * (stress.xx - stress.yy) + (c * c - s * s) * stress.xy,
        zz=stress.zz,
    )


def bore_motion(full: FullSolution) -> tuple[complex, float]:
    """Return displacement (fixed axes, mm) and rotation (rad) of the disc fitted to its bore circle, or to all of them."""
    pose = full.pose
    x, y, rotation = full.model.bore_fit(full.state.contact.pressure).tolist()
    return pose.disc_displacement + complex(x, y) * np.exp(1j * pose.disc_rotation), pose.disc_rotation + rotation
