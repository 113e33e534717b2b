"""Which parts of quite different drives yield in the torsional stiffness, and which are rigid because a file leaves them out."""

from __future__ import annotations

import pytest

from ltca.drive.yielding_parts import removable_parts, with_rigid, yielding_parts
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ROWS = {
    f"main_bearing.bearings.{row}.{name}": value
    for row, plane in enumerate((-30.0, 30.0))
    for name, value in {
        "plane": plane, "kind": "angular-contact ball", "contact_angle": "40 deg", "pitch_radius": 95.0, "load_constant": 3e6,
    }.items()
}  # fmt: skip
POSTS = {"carrier.posts.number": 6, "carrier.posts.radius": 42.0, "carrier.posts.size": 16.0}
ENDS = {"first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.plane": 40.0}


def ring(circle, **fields):
    shape = {"ring.inner_radius": circle, "ring.outer_radius": circle + 15.0, "ring.width": 20.0}
    return shape | {f"ring.{name}": value for name, value in fields.items()}


BOLTS = {"bolts.number": 8, "bolts.circle_radius": 90.0, "bolts.stiffness": 1e6}
DRIVES = {
    "paper: one disc, springs": ("paper", {}, set()),
    "free ring": ("robot-joint", ring(60.0), {"ring"}),
    "built-in ring, loose main bearing": (
        "robot-joint",
        ring(60.0, flange="built-in") | {"main_bearing.radial_stiffness": 1e6, "main_bearing.clearance": 0.02},
        {"ring", "main_bearing"},
    ),
    "bolted ring of finite elements": ("rv", ring(80.0, model="fe", **BOLTS), {"crank.support", "ring"}),
    "carrier that twists": (
        "rv", {"carrier.stiffness_torsion": 4e8}, {"crank.support", "carrier.stiffness_torsion"},
    ),
    "flanges on posts": ("rv", POSTS | {"carrier.flange": (10.0, 8.0)}, {"crank.support", "carrier.posts"}),
    "pins tied by a ring that floats": ("sleeved", {}, {"pin_wheel.beam"}),
    "pins tied by a flange on posts": ("sleeved", POSTS | {"carrier.posts.radius": 44.0}, {"pin_wheel.beam", "carrier.posts"}),
    "preloaded rows": ("rv", ROWS | {"main_bearing.preload": "2 kN"}, {"crank.support", "main_bearing"}),
    "older name, arm": (
        "rv", {"pin_wheel.support_stiffness": 1e6, "load.external.0.force.x": 1e3}, {"crank.support", "main_bearing"},
    ),
    "loose cranks that twist": (
        "rv",
        {"crank.support.clearance": 0.01, "crank.support.torsion": True, "crank.support.spline_plane": 40.0},
        {"crank.support", "crank.support.torsion"},
    ),
    "tapered rollers": (
        "rv",
        {
            "crank.support.stiffness": (), "crank.support.contact_angle": "15 deg", "crank.support.load_constant": 3e5,
            "crank.support.preload": "500 N",
        },
        {"crank.support"},
    ),
    "rigid teeth": ("rv", ENDS, {"crank.support"}),
    "teeth that yield": ("rv", ENDS | {"first_stage.mesh_stiffness": 3e5}, {"crank.support", "first_stage.mesh_stiffness"}),
}  # fmt: skip
EVERY = {
    "pin_wheel.beam": "bending of wheel pins",
    "crank.support": "crankshafts and their bearings",
    "crank.support.torsion": "torsion of the crankshafts",
    "main_bearing": "main bearing",
    "ring": "ring that carries the wheel pins",
    "carrier.posts": "flanges and posts of the carrier",
    "carrier.stiffness_torsion": "torsion of the carrier",
    "first_stage.mesh_stiffness": "first stage",
}
ABSENT = {
    # one central crank is the input itself
    "paper": {"first_stage.mesh_stiffness"},
    "robot-joint": {"first_stage.mesh_stiffness"},
    "rv": set(),
    # the tips of its pins float, no flange there is rigid
    "sleeved": {"first_stage.mesh_stiffness", "carrier.posts"},
}


@pytest.mark.parametrize("name", DRIVES)
def test_every_part_is_told_as_it_is(name):
    shipped, changes, yields = DRIVES[name]
    drive = with_fields(next(iter(load_drive(shipped).cases.values())), changes)
    found = yielding_parts(drive)
    holes = () if drive.pin_shaft is None else ("shaft pins and holes",)
    assert {*found.reducer} == {"flanks and wheel pins", "crank bearings", *holes, *(EVERY[path] for path in yields)}
    assert {*found.reducer} - {*found.cycloid_stage} == {
        EVERY[path] for path in yields & {"first_stage.mesh_stiffness"}
    }
    rigid = EVERY.keys() - yields - ABSENT[shipped]
    assert {*found.rigid} == {f"{EVERY[path]} ({path})" for path in rigid}
    assert {*removable_parts(drive)} == {EVERY[path] for path in yields}
    # Posts that hold pins stay, and are rigid.
    stiff = with_rigid(drive, removable_parts(drive))
    assert {*removable_parts(stiff)} == (
        {EVERY["carrier.posts"]} if shipped == "sleeved" and "carrier.posts" in yields else set()
    )
