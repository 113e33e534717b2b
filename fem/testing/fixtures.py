"""Regenerates the small meshes in ``meshes/``: ``python -m fem.testing.fixtures [--out meshes]``.

The meshes are coarse on purpose (two elements for each expected half-width, fast growth), small enough for
the repository and for tests that take seconds; they are for regression, not for accurate pressures.
"""

from __future__ import annotations

import argparse
import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fem.drive.expected_contacts import expect_contacts
from fem.drive.meshes import disc_refinements, race_refinements
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.element_size import Refinement
from fem.mesh.gmsh_session import load_gmsh
from fem.mesh.mesh_file import write_msh
from fem.mesh.quality import measure_quality
from fem.mesh.triangulation import mesh_circle, mesh_disc, mesh_ring
from fem.shapes import CircleShape, DiscShape, DriveShapes
from fem.testing.seated_pin import SleeveOnPin
from ltca.drive.parts import Material
from ltca.drive.single_discs import single_discs
from ltca.output.files import whole_file
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

CASE = "CS-1"
CRANK_ANGLE = 0.5
SCALE = 4.0  # times b/8: two elements for each half-width
GROWTH = 0.6
PIN, ROLLER = 3, 2
# The second disc of the reducer with three cranks, its flank turned by half a tooth; few teeth keep the mesh small.
REDUCER_PINS = 16
# Two equal steel cylinders, R = 10 mm: 2 kN for each mm of length gives a half-width of 0.335 mm.
CYLINDER_RADIUS = 10.0
CYLINDER_ZONE = 0.5
CYLINDER_SIZES = {"cylinder_lower": 0.042, "cylinder_upper": 0.037}
# A thin steel sleeve on its pin, 1150 N over 12 mm between the pin and a patch outside of Hertz' half-width on a flat.
SLEEVE = SleeveOnPin(
    pin=Material(),
    sleeve=Material(),
    pin_radius=1.5,
    bore_radius=1.51,
    outer_radius=2.5,
    length=12.0,
    half_angle=0.3,
    patch_half_width=0.052,
)
SLEEVE_ELEMENTS = 12.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixture:
    """One mesh and what made it."""

    body: BodyMesh
    parameters: str


def make_fixtures() -> list[Fixture]:
    """Make all fixture meshes.

    Disc, pin 3, roller 2 and race of the paper's drive (CS-1, 0.5 rad), two cylinders, a disc with three bores, and a sleeve
    on its pin.
    """
    drive = load_drive("paper").cases[CASE]
    shapes, contacts = DriveShapes.of_drive(drive), expect_contacts(drive, CRANK_ANGLE)
    common = f"paper, {CASE}, {CRANK_ANGLE} rad, {8.0 / SCALE:g} elements for each half-width, growth {GROWTH}"

    def spot(radius: float, angle: float, half_width: float) -> Refinement:
        return Refinement.polar(radius, angle, size=SCALE * half_width / 8.0, radius=1.5 * half_width)

    pin, roller = shapes.wheel_pins[PIN], shapes.rollers[ROLLER]
    pin_spot = spot(pin.radius, contacts.pins.direction[PIN], contacts.pins.half_width[PIN])
    roller_spots = [
        spot(roller.radius, group.direction[ROLLER], group.half_width[ROLLER])
        for group in (contacts.rollers_outer, contacts.rollers_inner)
    ]
    fixtures = [
        Fixture(
            body=mesh_disc(shapes.disc, disc_refinements(contacts, SCALE), coarse_size=5.0, growth=GROWTH),
            parameters=f"{common}, coarse edge 5 mm",
        ),
        Fixture(body=mesh_circle(pin, [pin_spot], growth=GROWTH), parameters=f"{common}, pin {PIN}, core 2 mm"),
        Fixture(body=mesh_circle(roller, roller_spots, growth=GROWTH), parameters=f"{common}, roller {ROLLER}"),
        Fixture(
            body=mesh_ring(shapes.inner_race, race_refinements(contacts, SCALE), growth=GROWTH),
            parameters=f"{common}, bore 10 mm",
        ),
    ]
    for (name, size), angle in zip(CYLINDER_SIZES.items(), (0.5 * np.pi, -0.5 * np.pi), strict=True):
        cylinder = CircleShape(name=name, radius=CYLINDER_RADIUS)
        place = Refinement.polar(CYLINDER_RADIUS, angle, size=size, radius=CYLINDER_ZONE)
        fixtures.append(
            Fixture(
                body=mesh_circle(cylinder, [place], growth=GROWTH),
                parameters=f"R {CYLINDER_RADIUS:g} mm, edge {size} mm within {CYLINDER_ZONE} mm of the "
                f"{'top' if angle > 0.0 else 'bottom'}, growth {GROWTH}",
            )
        )
    return [*fixtures, _disc_of_several_cranks(), *_sleeve_on_its_pin()]


def _disc_of_several_cranks() -> Fixture:
    changes = {"pin_wheel.number_of_pins": REDUCER_PINS, "disc.number_of_teeth": REDUCER_PINS - 1}
    drive = with_fields(parse_drive(shipped_drive("rv"), "rv").cases["nominal"], changes)
    shape = replace(DiscShape.of_drive(single_discs(drive)[1]), name="reducer_disc")
    return Fixture(
        body=mesh_disc(shape, coarse_size=8.0, growth=GROWTH),
        parameters=f"rv with {REDUCER_PINS} pins, disc 1, no contacts, growth {GROWTH}, coarse edge 8 mm",
    )


def _sleeve_on_its_pin() -> list[Fixture]:
    parameters = (
        f"{SLEEVE.pin_radius:g} mm in {SLEEVE.bore_radius:g} mm, outside {SLEEVE.outer_radius:g} mm, "
        f"{SLEEVE_ELEMENTS:g} elements over the arc of {2.0 * SLEEVE.half_angle:g} rad, growth {GROWTH}"
    )
    return [Fixture(body=body, parameters=parameters) for body in SLEEVE.meshes(SLEEVE_ELEMENTS, GROWTH)]


def describe_fixtures(fixtures: list[Fixture], hashes: dict[str, str]) -> str:
    """Return the README of the folder."""
    rows = []
    for fixture in fixtures:
        name, quality = fixture.body.name, measure_quality(fixture.body)
        rows.append(
            f"| {name}.msh | {', '.join(fixture.body.boundary_names)} | {quality.elements} | {quality.nodes} | "
            f"{np.degrees(quality.smallest_angle):.1f}° | {quality.scaled_jacobian:.3f} | {fixture.parameters} | "
            f"`{hashes[name]}` |"
        )
    table = "\n".join(rows)
    return f"""# Small meshes for regression tests

Curved quadratic triangles, gmsh 2.2 text, named boundaries as physical groups, each body in its own frame (mm).
They are coarse on purpose: for tests that take seconds, not for accurate pressures.

Made by `python -m fem.testing.fixtures --out meshes` with gmsh {load_gmsh().__version__} (frontal Delaunay, one thread,
fixed seed); it writes this file too. A change in them is to be reviewed like a change of code.

| file | boundaries | elements | nodes | smallest angle | scaled Jacobian | parameters | SHA-256 |
|---|---|---|---|---|---|---|---|
{table}
"""


def write_fixtures(folder: Path) -> list[Path]:
    """Write all fixture meshes and their README into a folder; return the paths."""
    fixtures = make_fixtures()
    paths = [write_msh(fixture.body, folder / f"{fixture.body.name}.msh") for fixture in fixtures]
    hashes = {path.stem: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}
    readme = folder / "README.md"
    with whole_file(readme) as part:
        part.write_text(describe_fixtures(fixtures, hashes), encoding="utf-8", newline="\n")
    return [*paths, readme]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        prog="python -m fem.testing.fixtures", description="Regenerate the meshes in meshes/."
    )
    parser.add_argument("--out", type=Path, default=Path("meshes"), help="folder (default: meshes)")
    for written in write_fixtures(parser.parse_args().out):
        print(written)
