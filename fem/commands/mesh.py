"""``cyclo mesh``: meshes of all bodies of a drive, as files and a picture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from fem.commands.position_arguments import add_position_arguments, body_files, chosen_drive, disc_prefix
from ltca.reading.arguments import add_out_argument, count_argument, default_folder

if TYPE_CHECKING:
    from fem.drive.expected_contacts import ExpectedContacts
    from fem.drive.meshes import DriveMeshes
    from fem.mesh.body_mesh import BodyMesh
    from fem.shapes import DriveShapes
    from ltca.drive.parts import Drive

SUMMARY: str = "mesh the bodies of a drive for the contacts expected at a crank angle"
EXAMPLES = (
    ("cyclo mesh paper --case CS-1 --angle 0.5", "meshes of all bodies of one position"),
    ("cyclo mesh my.toml --size 2", "with elements twice as large"),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_position_arguments(parser)
    parser.add_argument(
        "--order",
        type=count_argument("--order", 1, 2),
        choices=(1, 2),
        default=2,
        help="1 straight, 2 curved triangles; default 2",
    )
    add_out_argument(parser, "mesh")


def execute(arguments: argparse.Namespace) -> int:
    """Mesh the drive, write ``.msh`` and ``.vtu`` of each body and ``mesh.png``.

    Returns
    -------
    int
        0.

    Raises
    ------
    CycloError
        For wrong input, missing libraries or a mesh that would not fit into memory.
    """
    from ltca.output.run_folder import claimed_folder

    name, case, drive = chosen_drive(arguments)
    out = arguments.out or default_folder(name, "mesh")
    discs = drive.disc.number_of_discs
    writes = [f"{disc_prefix(disc, discs)}mesh.png" for disc in range(discs)]
    writes += [file for ending in ("msh", "vtu") for file in body_files(ending, discs)]
    writes += [] if drive.ring is None else ["pin_ring.msh", "pin_ring.vtu"]
    with claimed_folder(out, "mesh", writes=writes):
        _mesh_and_write(name, case, drive, arguments, out)
    return 0


def _mesh_and_write(name: str, case: str, drive: Drive, arguments: argparse.Namespace, out: Path) -> None:
    from ltca.drive.engine_support import require
    from ltca.drive.single_discs import single_discs

    require(drive, "FE mesh")
    print(f"{name} {case}, {drive.load_words()}, φ_C = {arguments.angle:g} rad", flush=True)
    title = f"{name}, {case}, crank angle {arguments.angle:g} rad"
    singles = single_discs(drive)
    if len(singles) == 1:
        _mesh_disc(singles[0], drive.wheel_moment(), title, (0, 1), arguments, out)
    else:
        moment = drive.wheel_moment() / len(singles)
        for number, single in enumerate(singles):
            print(f"disc {number}, {moment / 1e3:.6g} N·m on the wheel expected", flush=True)
            _mesh_disc(single, moment, f"{title}, disc {number}", (number, len(singles)), arguments, out)
    if drive.ring is not None:
        _mesh_ring(drive, arguments, out)
    print(f"written to {out}")


def _mesh_ring(drive: Drive, arguments: argparse.Namespace, out: Path) -> None:
    """Mesh the ring of the wheel pins, once for all discs; it is not drawn."""
    from fem.body.pin_ring import bolts_of_drive, mesh_ring_for_seats, ring_of_drive
    from fem.mesh.mesh_file import write_msh, write_vtu
    from fem.mesh.quality import measure_quality
    from ltca.drive.ring_shape import bolt_patch_radius

    patch, size = bolt_patch_radius(drive), arguments.size
    body = mesh_ring_for_seats(ring_of_drive(drive), bolts_of_drive(drive), patch, size, order=arguments.order)
    print(f"{body.name}: {measure_quality(body).describe()}", flush=True)
    write_msh(body, out / f"{body.name}.msh")
    write_vtu(body, out / f"{body.name}.vtu")


def _mesh_disc(
    drive: Drive, wheel_moment: float, title: str, place: tuple[int, int], arguments: argparse.Namespace, out: Path
) -> None:
    """Mesh one disc; `place` is its number and the number of discs."""
    import time

    from fem.drive.expected_contacts import expect_contacts
    from fem.drive.meshes import mesh_drive
    from fem.mesh.quality import measure_quality
    from fem.options import SolutionOptions
    from fem.shapes import DriveShapes

    def report(body: BodyMesh) -> None:
        print(f"{body.name}: {measure_quality(body).describe()}", flush=True)

    start = time.perf_counter()
    contacts = expect_contacts(drive, arguments.angle, wheel_moment=wheel_moment)
    shapes = DriveShapes.of_drive(drive)
    meshes = mesh_drive(shapes, contacts, SolutionOptions(size=arguments.size), order=arguments.order, report=report)
    print(
        f"{meshes.unknowns:,} unknowns in {len(meshes.bodies)} bodies, {time.perf_counter() - start:.2f} s", flush=True
    )
    _write_files(meshes, out, place)
    _draw(
        drive,
        shapes,
        contacts,
        meshes,
        out / f"{disc_prefix(*place)}mesh.png",
        f"{title}: {meshes.unknowns:,} unknowns",
    )


def _write_files(meshes: DriveMeshes, out: Path, place: tuple[int, int]) -> None:
    from fem.mesh.mesh_file import body_stem, write_msh, write_vtu

    for body in meshes.bodies:
        stem = body_stem(body.name, *place)
        write_msh(body, out / f"{stem}.msh")
        write_vtu(body, out / f"{stem}.vtu")


def _draw(
    drive: Drive, shapes: DriveShapes, contacts: ExpectedContacts, meshes: DriveMeshes, path: Path, headline: str
) -> None:
    from fem.pictures.mesh_picture import choose_zooms, draw_drive_mesh, place_bodies
    from ltca.geometry.placement import Placement

    placement = Placement.of_drive(drive)
    rigid = [] if shapes.shaft_pins else zip(placement.shaft_pin_centres, placement.shaft_pin_radii, strict=True)
    shaft_pins = [(complex(centre), float(radius)) for centre, radius in rigid]
    problem = draw_drive_mesh(
        path, place_bodies(meshes, placement, contacts), choose_zooms(contacts, placement), shaft_pins, headline
    )
    if problem:
        print(f"drawn with matplotlib, because pyvista cannot render here: {problem}")
