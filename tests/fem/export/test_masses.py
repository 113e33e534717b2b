"""Masses against what the geometry kernel integrates over the solids of a STEP file."""

from __future__ import annotations

import gmsh
import numpy as np
import pytest

from fem.export.solids import VOLUME, write_solids
from fem.mesh.gmsh_session import gmsh_model
from ltca.dynamics.masses import drive_masses
from ltca.export.parts import make_parts
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

SAME = 1e-4
"""The kernel integrates each face by a fixed rule to some 1e-5 (`fem.export.solids`), and a tenth of that of lofted flanks is
between their outlines; a hole that is left out is 1e-2."""


def uneven(drive):
    """A disc whose centre of mass is off, with a crown and a slope along its width."""
    holes = [0.3, 0.0, -0.2, 0.0, 0.1, 0.0, 0.0, 0.4]
    return with_fields(
        drive,
        {
            "disc.runout.amount": 0.2,
            "disc.runout.angle": 0.7,
            "disc.hole_errors.radial": holes,
            "disc.hole_errors.diameter": holes,
            "contact.slices": 3,
            "disc.lead_crown_drop": 0.05,
            "disc.lead_slope": 2e-3,
        },
    )


def of_export(name, drive):
    """The name that a part has among the bodies of the assembly."""
    several = drive.disc.number_of_discs > 1
    for crank in range(drive.crank.number):
        for disc in range(drive.disc.number_of_discs):
            if name == f"eccentric {disc} of crank {crank}":
                of = f"disc {disc}" if several else "disc"
                return f"inner race of {of}" + (f" {crank}" if drive.crank.number > 1 else "")
    for mine, theirs in (
        ("sleeve of wheel pin", "sleeve"),
        ("sleeve of shaft pin", "shaft sleeve"),
        ("wheel pin", "pin"),
    ):
        if name.startswith(mine):
            return name.replace(mine, theirs)
    if name == "ring":
        return "ring of the wheel"
    return name if several else name.replace("disc 0", "disc")


DRIVES = {
    "an uneven disc": lambda: uneven(load_drive("paper").cases["CS-3"]),
    "loose pins and sleeves": lambda: load_drive("sleeved").cases["nominal"],
    "three cranks": lambda: load_drive("rv").cases["nominal"],
    "a ring and posts": lambda: with_fields(
        load_drive("robot-joint").cases["nominal"],
        {
            "ring.inner_radius": 60.0,
            "ring.outer_radius": 70.0,
            "ring.width": 24.0,
            "pin_shaft.stiffness": None,
            "pin_shaft.beam.tip": "tied-clamped",
            "carrier.posts.number": 4,
            "carrier.posts.radius": 25.0,
            "carrier.posts.size": 6.0,
        },
    ),
}


NIGHTLY = ("loose pins and sleeves", "a ring and posts")


@pytest.mark.slow
@pytest.mark.parametrize(
    "which", [pytest.param(name, marks=pytest.mark.nightly) if name in NIGHTLY else name for name in DRIVES]
)
def test_volume_centre_and_inertia_are_those_of_the_solids(which, tmp_path):
    drive = DRIVES[which]()
    (part,) = make_parts(drive, "nominal", "assembly")
    path = tmp_path / "assembly.step"
    write_solids(part, path)
    solids = {of_export(solid.name, drive): solid for solid in drive_masses(drive).solids}
    exported = [body.name for body in part.bodies]
    # Shafts beside the eccentrics are in no assembly.
    assert {name for name in solids if not name.startswith("shaft") or "pin" in name or "sleeve" in name} == set(
        exported
    )
    with gmsh_model("masses"):
        found = gmsh.model.occ.importShapes(str(path))
        tags = [tag for dimension, tag in found if dimension == VOLUME]
        assert len(tags) == len(exported)
        for tag, name in zip(tags, exported, strict=True):
            solid, size = solids[name], gmsh.model.occ.getMass(VOLUME, tag)
            radius = np.sqrt(solid.volume_moments.max() / solid.volume)
            tensor = np.reshape(gmsh.model.occ.getMatrixOfInertia(VOLUME, tag), (3, 3))
            assert solid.volume == pytest.approx(size, rel=SAME), name
            centre = gmsh.model.occ.getCenterOfMass(VOLUME, tag)
            assert np.max(np.abs(solid.centre - centre)) < SAME * radius, name
            assert np.max(np.abs(solid.volume_moments - tensor)) < SAME * tensor.max(), name
