"""A plausible change of every leaf field of a drive, for the test of the contract.

The contract: every field of a drive is used by every model and command, or refused by name. So every leaf field is
changed by a plausible amount, and either the answer changes or a `DriveError` names the field.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.engine_support import ENGINES, refusal
from ltca.drive.fields import ANY, element_count, field_kind, field_kinds, missing_part, read_field
from ltca.drive.materials import JUDGED_BY, PARTS
from ltca.drive.members.width import needs_slices
from ltca.drive.parts import Drive
from ltca.errors import CycloError, DriveError
from ltca.reading.changes import with_fields

# Factors of fields that allow small changes only, or the drive becomes unsound.
_CLOSE = {
    "crank.eccentricity": 0.999,
    "pin_wheel.pin_circle_radius": 1.0005,
    "crank_bearing.inner_race_radius": 0.9995,
    "crank_bearing.outer_race_radius": 1.0005,
    "crank_bearing.roller_radius": 0.9995,
    "pin_shaft.pin_radius": 0.999,
    "pin_shaft.hole_radius": 1.001,
    "pin_shaft.pin_circle_radius": 1.002,
    "pin_wheel.pin_radius": 0.9995,
    "pin_wheel.beam.span": 1.1,
    "pin_shaft.beam.span": 1.1,
    "pin_wheel.seat.radius": 1.001,
    "pin_wheel.seat.pin_radius": 0.999,
    "pin_wheel.seat.bore_radius": 1.001,
    "pin_shaft.seat.pin_radius": 0.999,
    "pin_shaft.seat.bore_radius": 1.001,
}
_SUPPORT = {
    "crank.support.diameter": 8.0,
    "crank.support.positions": (-10.0, 12.0),
    "crank.support.stiffness": (2e5, 3e5),
}
_ROWS = {
    f"main_bearing.bearings.{number}.{name}": value
    for number, plane in enumerate((-15.0, 15.0))
    for name, value in {
        "plane": plane,
        "kind": "angular-contact ball",
        "contact_angle": 0.6,
        "pitch_radius": 40.0,
        "load_constant": 2e7,
    }.items()
} | {"main_bearing.preload.force": 2e3}
"""Two angular-contact bearings in O arrangement."""
GOES_WITH = {
    "materials.crankshaft": "crank.support",
    # Posts need shaft pins that are beams, which some engines refuse first.
    **dict.fromkeys(("carrier.flange", "carrier.posts", "materials.carrier"), "pin_shaft.beam"),
    "materials.sleeve": "pin_wheel.seat",
    "materials.wheel_seat": "pin_wheel.seat",
    "load.speed": "friction",
    "load.driven_by": "friction",
    "friction": "friction",
    "ring": "ring",
    "ring.material": "ring",
    "ring.bolts": "ring",
    **dict.fromkeys(("first_stage", "first_stage.sun_runout", "first_stage.planet_runout"), "first_stage"),
    "load.external.0": "load.external",
    "inertia.output_mass": "pin_wheel.support_stiffness",
    "load.external.0.force": "load.external",
    "load.external.0.moment": "load.external",
    "load.external.0.at": "load.external",
}
"""Tables that fields of other tables belong to, in whose names they are refused."""
_LEFT_OUT = {
    "load.speed": 1500.0,
    "pin_wheel.support_stiffness": 5e5,
    "pin_wheel.core_radius": 0.3,
    "crank_bearing.race_bore_radius": 1.0,
    "main_bearing.radial_stiffness": 5e5,
    "main_bearing.tilt_stiffness": 1e9,
    "main_bearing.axial_stiffness": 5e5,
    "main_bearing.clearance": 0.02,
    "main_bearing.preload.force": 20.0,
    "main_bearing.preload.displacement": 1e-4,
    "crank.support.clearance": 0.01,
    "crank.support.preload.force": 50.0,
    "crank.support.preload.displacement": 2e-4,
    "main_bearing.bearings.0.preload.force": 2.01e3,
    "main_bearing.bearings.0.preload.displacement": 2.157e-3,
    "installation.first_stage_ratio": 2.0,
    "first_stage.module": 1.42,
    "first_stage.mesh_stiffness": 3e5,
    "crank.circle_radius": 6.0,
    "crank_bearing.dynamic_load_rating": 5e4,
    "crank_bearing.static_load_rating": 6e4,
    "carrier.stiffness_torsion": 2e8,
    "carrier.flange": (8.0, 6.0),
    "disc.axial_play": 0.2,
}
_LEFT_OUT |= {
    "inertia.input": 1e-3,
    "inertia.output": 0.2,
    "inertia.output_mass": 10.0,
    "inertia.crank": 1e-3,
    "inertia.crank_mass": 2.0,
    "damping.ratio": 0.02,
    "damping.loss_factor": 0.04,
}
_LEFT_OUT |= {
    f"materials.{part}.{name}": value
    for part in PARTS
    for name, value in {
        "allowable_pressure": 1500.0,
        "yield_strength": 1200.0,
        "bending_fatigue_limit": 400.0,
        "hardness": 700.0,
        "hardness_depth": 0.8,
        "density": 7850.0,
        "thermal_expansion": 1.2e-5,
    }.items()
}
_LEFT_OUT |= {
    path.replace("materials.disc.", "ring.material."): value
    for path, value in _LEFT_OUT.items()
    if path.startswith("materials.disc.")
}
"""Plausible values of fields that may be left out."""
_FIRST_STAGE = {
    "first_stage.sun_teeth": 20,
    "first_stage.planet_teeth": 40,
    "first_stage.helix_angle": 0.1,
    "first_stage.plane": 40.0,
    "installation.first_stage_ratio": None,
}
_RUNOUT = {
    "first_stage.backlash": 0.05,
    "first_stage.sun_runout.amount": 0.01,
    "first_stage.sun_runout.angle": 0.1,
    "first_stage.planet_runout.amount": (0.01, -0.004, 0.006),
    "first_stage.planet_runout.angle": (0.1, 0.2, 0.3),
}
"""Eccentricities of teeth, with the backlash that they need."""
_EXTERNAL = {f"load.external.0.{name}": 300.0 for name in ("force.x", "force.y", "force.z", "at.z")}
_FROM_ZERO = {"mm": 1e-3, "rad": 0.3, "dimensionless": 0.5}
_RELIEF = {"end_relief_length": 0.8, "end_relief_depth": 0.002}
_LEAD_RELIEF = {"lead_relief_length": 0.8, "lead_relief_depth": 0.002}
ROUND_OFF = 1e-6
"""Relative change of a number above which an answer differs: a thousand times the tolerance of equilibrium."""

DIAMETERS = tuple(path for path in field_kinds() if path.endswith("_errors.diameter") and ANY not in path.split("."))
_NAME = {
    "disc.axial_play": "the tilt of discs is judged by it, nothing moves",
    "name": "names a drive and its files, nothing else",
    "analysis.compliance": "chooses the engine where none is named; here one is",
    "analysis.bodies": "chooses the bodies of the engine where none is named; here one is",
    "disc.planes": "axial places have no effect where neither pins nor cranks bend",
    "disc.gap": "axial places have no effect where neither pins nor cranks bend",
    **dict.fromkeys(
        ("main_bearing.arrangement", "main_bearing.bearings.0.plane", "main_bearing.bearings.0.pitch_radius"),
        "places the pressure centres, which concern tilts alone: they are told, and the wheel does not tilt yet",
    ),
    "materials.crankshaft.poisson_ratio": "a shaft without shear and torsion bends by its modulus alone",
}
_NAME |= {f"materials.{part}.{name}": "moves no load: results are judged by it" for part in PARTS for name in JUDGED_BY}
_NAME |= {f"ring.material.{name}": "moves no load; named materials have it" for name in JUDGED_BY}
_OF_LIFE = dict.fromkeys(
    ("duty.0.torque", "duty.0.speed", "duty.0.share", "lubricant.viscosity", "lubricant.contamination"),
    "duty and lubricant concern lives of bearings alone, and here none is told",
)
_OF_LIFE |= dict.fromkeys(
    ("crank_bearing.dynamic_load_rating", "crank_bearing.static_load_rating"),
    "ratings of the maker concern lives of bearings alone, and here none is told",
)
_NAME |= dict.fromkeys(
    [f"inertia.{name}" for name in ("input", "output", "output_mass", "crank", "crank_mass")]
    + [f"damping.{name}" for name in ("ratio", "loss_factor")],
    "inertias and damping concern vibrations alone, and here the drive stands or turns slowly",
)
_EVERYWHERE = _NAME | _OF_LIFE
_TILTING = dict.fromkeys(
    [
        "main_bearing.axial_stiffness",
        *(f"load.external.0.{name}" for name in ("force.z", "moment.x", "moment.y", "at.z")),
    ],
    "what tilts the output or pushes it along the axis loads the main bearing alone, which here is not told",
)
_BODIES = dict.fromkeys(
    ("pin_wheel.core_radius", "crank_bearing.race_bore_radius"),
    "half-spaces have no bodies to support; said where given",
)
_SPRINGS = (
    _EVERYWHERE
    | {
        "pin_shaft.elastic_contact": "half-spaces have springs in the holes, which stand for all that yields there; said where "
        "false"
    }
    | _BODIES
)
_SPRINGS_ALONE = {path: reason for path, reason in _SPRINGS.items() if path not in _EVERYWHERE}
_SHAFT_PIN = ("materials.shaft_pin.youngs_modulus", "materials.shaft_pin.poisson_ratio", "pin_shaft.elastic_contact")
_VIBRATIONS = {
    "name": _NAME["name"],
    **{
        path: reason
        for path, reason in _NAME.items()
        if path.startswith("materials.") and not path.endswith(".density")
    },
    **{
        path: reason
        for path, reason in _NAME.items()
        if path.startswith("ring.material.") and not path.endswith(".density")
    },
    **{
        path: _NAME[path]
        for path in ("disc.axial_play", "analysis.compliance", "analysis.bodies", "disc.planes", "disc.gap")
    },
    **{path: _NAME[path] for path in _NAME if path.startswith("main_bearing.")},
    **{path: reason for path, reason in _OF_LIFE.items() if path != "duty.0.speed"},
    **dict.fromkeys(
        ("duty.0.torque", "duty.0.share"),
        "vibrations are those about the load; of the duty its speeds bound critical ones",
    ),
    **dict.fromkeys(
        [path for path in field_kinds() if path.startswith("friction.")] + ["load.driven_by"],
        "vibrations are those without friction, whose place damping takes",
    ),
    "load.light_torque": "vibrations are those about the load and parts of it",
}
"""Of vibrations, on half-spaces."""
EXCEPTIONS: Mapping[str, Mapping[str, str]] = {
    "tables": _SPRINGS,
    "direct": _SPRINGS | _TILTING | {"load.light_torque": "direct is walked at full load alone"},
    "paper": _SPRINGS | {"load.light_torque": "the paper's iteration is walked at full load alone"},
    "hybrid": _EVERYWHERE,
    "fe": _EVERYWHERE,
    "curves": _NAME
    | _BODIES
    | _TILTING
    | {"load.light_torque": "curves are those of full load"}
    | dict.fromkeys(_SHAFT_PIN, "curves tell no pressure of the holes, and in half-spaces nothing else sees it"),
    "studies": _SPRINGS | _TILTING,
    "dynamics": _VIBRATIONS
    | _SPRINGS_ALONE
    | _TILTING
    | dict.fromkeys(_SHAFT_PIN, "vibrations tell no pressure of the holes, and in half-spaces nothing else sees it")
    | {"materials.wheel_seat.density": "slots are in the housing, whose size no file gives and which has no mass"},
    "time": {
        path: reason for path, reason in _VIBRATIONS.items() if not path.startswith(("friction.", "load.", "duty."))
    }
    | _SPRINGS_ALONE
    | _TILTING
    | dict.fromkeys(("load.speed", "load.light_torque"), "a run in time has a speed and a load of its own")
    | dict.fromkeys(
        ("duty.0.torque", "duty.0.speed", "duty.0.share"), "a run in time has a speed and a load of its own"
    )
    | dict.fromkeys(_SHAFT_PIN, "runs in time tell no pressure of the holes, and in half-spaces nothing else sees it")
    | {"materials.wheel_seat.density": "slots are in the housing, whose size no file gives and which has no mass"},
    "full FE": _EVERYWHERE
    | {
        "load.light_torque": "a full solution is one of full load",
        "ring.model": "the ring of full finite elements is one of finite elements",
    },
}
"""Fields without effect on the answer of a model, with the reason."""


def leaf_fields() -> tuple[str, ...]:
    """Return the dotted paths of all leaf fields of a drive; those of entries are of entry 0."""
    return tuple(path.replace(f".{ANY}.", ".0.") for path in field_kinds())


def sensible_change(drive: Drive, path: str) -> Any:
    """Return a plausible other value for a field of a drive, one of `leaf_fields`, for `ltca.reading.changes.with_fields`.

    It may make the drive unsound, which then must be reported by the name of the field.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> sensible_change(drive, "load.direction")
    'cw'
    >>> sensible_change(drive, "crank.axis_offset.x")
    0.001
    """
    value, kind = read_field(drive, path), field_kind(path)
    if kind is None:
        raise KeyError(path)
    if path == "disc.planes":
        return value  # of one disc there is no other, and none has an effect yet
    if path == "name":
        return f"{value} too"
    if path == "contact.slices":
        return 5
    if kind.choices:
        return kind.choices[(kind.choices.index(value) + 1) % len(kind.choices)]
    if isinstance(value, bool):
        return not value
    if _is_count(path):
        return value + (-1 if path == "crank_bearing.number_of_rollers" else 1)
    if kind.is_array:
        return _changed_array(drive, path, list(value))
    if path in _CLOSE:
        return value * _CLOSE[path]
    if path.endswith("roller_length"):
        return 0.8 * value
    if path.endswith("phase_error"):
        return 1e-3
    if value == 0.0 and needs_slices(path):
        return 2e-4 if kind.unit == "rad" else 1e-3
    if value == 0.0:
        return _FROM_ZERO.get(kind.unit, 1.0)
    return 0.9 * value


def _is_count(path: str) -> bool:
    kind = field_kind(path)
    return kind is not None and kind.kind == "count" and not kind.is_array


def _changed_array(drive: Drive, path: str, values: list[Any]) -> tuple[Any, ...]:
    if path.endswith("profile_errors.orders"):
        return (values[0] + 1, *values[1:]) if values else (2,)
    if path.endswith("profile_errors.parameter"):
        return (*values[:-1], values[-1] + 0.1) if values else ()
    kind = field_kind(path)
    if path == "carrier.flange" or (kind is not None and kind.unit == "N/mm"):
        return tuple(1.1 * value for value in values)
    count = element_count(drive, path)
    # Different amounts for the parts: a circle that shifts or grows as a whole could be hidden by a free motion.
    step = 1e-3
    return tuple(value + step * (1.0 if number % 2 else -0.6) for number, value in enumerate(values[: count or 0]))


def _is_left_out(drive: Drive, path: str) -> bool:
    try:
        read_field(drive, path)
    except DriveError:
        return True
    return False


def _seat(drive: Drive, path: str, kind: str) -> dict[str, Any]:
    """All fields of a seat of a kind, with a usual play."""
    radius = float(read_field(drive, f"{path}.pin_radius"))
    radii = {
        "fixed": {},
        "slot": {"radius": 1.002 * radius},
        "sleeve": {"pin_radius": 0.7 * radius, "bore_radius": 0.702 * radius},
    }[kind]
    names = [field for field in field_kinds() if field.startswith(f"{path}.seat.")]
    found = {name: radii.get(name.rpartition(".")[2]) for name in names} | {f"{path}.seat.kind": kind}
    # Sleeves yield: rigid shaft pins are refused beside them.
    return found | ({"pin_shaft.elastic_contact": True} if (path, kind) == ("pin_shaft", "sleeve") else {})


def _warmth(drive: Drive, path: str) -> dict[str, Any]:
    """Temperatures, and the expansion of all materials of the drive and of the one that is changed."""
    part = path.split(".")[1]
    parts = {"disc", "wheel_pin", "roller", "inner_race"} | ({"shaft_pin"} if drive.pin_shaft else set())
    parts |= {"sleeve"} if "sleeve" in (drive.pin_wheel.seat.kind, part) else set()
    seat = _seat(drive, "pin_wheel", "sleeve") if part == "sleeve" and drive.pin_wheel.seat.kind == "fixed" else {}
    parts |= {part} if path.startswith("materials.") else set()
    expansion = {f"materials.{one}.thermal_expansion": 1.1e-5 for one in parts}
    return seat | expansion | {"temperature.housing": 30.0, "temperature.disc": 40.0, "temperature.shaft": 50.0}


def _ring(drive: Drive, path: str) -> dict[str, Any]:
    """A ring in which the pins stand half, with bolts where the path is one of theirs."""
    circle, pin = drive.pin_wheel.pin_circle_radius, drive.pin_wheel.pin_radius
    found = {"ring.inner_radius": circle, "ring.outer_radius": circle + 2.5 * pin, "ring.width": drive.disc.thickness}
    if not path.startswith("ring.bolts."):
        return found
    bolts = {"number": 5, "circle_radius": circle + 2.0 * pin, "stiffness": 2e5}
    return found | {f"ring.bolts.{name}": value for name, value in bolts.items()}


def _carrier(drive: Drive, path: str, span: float) -> dict[str, Any]:
    """A carrier with what a field of it needs, its pins tied to the far flange."""
    if path == "carrier.stiffness_torsion":
        return {} if drive.carrier is not None else {path: 1e8}
    given: dict[str, Any] = {}
    if drive.posts is None:
        circle = drive.crank.circle_radius if drive.pin_shaft is None else drive.pin_shaft.pin_circle_radius
        radius = 0.9 * (circle or 0.0)
        given = {"carrier.posts.number": 4, "carrier.posts.radius": radius, "carrier.posts.size": 0.3 * radius}
        given |= {} if path == "carrier.flange" else {"carrier.flange": (8.0, 8.0)}
    shaft = drive.pin_shaft
    if shaft is not None and (shaft.beam is None or shaft.beam.tip == "free"):
        given |= {"pin_shaft.stiffness": None, "pin_shaft.beam.span": span, "pin_shaft.beam.tip": "tied-clamped"}
    return given


def _beside(drive: Drive, path: str) -> dict[str, Any]:
    """Further fields that a field needs to have an effect, where the drive is without them."""
    if needs_slices(path):
        bearing = _of_main_bearing(path) if path.startswith("main_bearing.") and drive.main_bearing is None else {}
        return bearing | ({"contact.slices": 5} if drive.contact.slices == 1 else {})
    if path == "contact.slices":  # in plane strain straight contacts are the same with any number of them
        return {path: 3, "disc.lead_crown_drop": 1e-3}
    if path.startswith("ring.") and drive.ring is None:
        return _ring(drive, path) | (_warmth(drive, path) if path.endswith(".thermal_expansion") else {})
    span = 3.0 * (2.0 * max(map(abs, drive.disc.disc_planes)) + drive.disc.thickness)
    wheel, shaft, name = drive.pin_wheel, drive.pin_shaft, path.rpartition(".")[2]
    if path.endswith(".thermal_expansion") or path.startswith("temperature."):
        return _warmth(drive, path)
    if path in ("crank.support.contact_angle", "crank.support.load_constant"):
        support = _SUPPORT if drive.crank.support is None else {}
        tapered = {"contact_angle": 0.25, "load_constant": 5e6, "preload.force": 1e4, "stiffness": ()}
        return {**support, **{f"crank.support.{name}": value for name, value in tapered.items()}}
    if path == "crank.support.spline_plane":
        support = _SUPPORT if drive.crank.support is None else {}
        return {**support, "crank.support.torsion": True, path: 40.0}
    if path.startswith(("crank.support.", "materials.crankshaft.")) and drive.crank.support is None:
        return _SUPPORT
    if path.startswith("crank.support.preload.") and drive.crank.support is not None:
        return {}
    if path.startswith("main_bearing.") and drive.main_bearing is None:
        return _of_main_bearing(path)
    kinds = {
        "pin_wheel.seat.radius": "slot",
        "pin_wheel.seat.pin_radius": "sleeve",
        "pin_wheel.seat.bore_radius": "sleeve",
    }
    kinds |= {f"materials.{part}.{name}": kind for part, kind in (("wheel_seat", "slot"), ("sleeve", "sleeve"))}
    if path in kinds and wheel.seat.kind != kinds[path]:
        return _seat(drive, "pin_wheel", kinds[path])
    if path.startswith("friction.") or path in ("load.driven_by", "load.speed"):
        needed = {} if drive.friction is not None else {"friction.pin": 0.05, "friction.hole": 0.04 * bool(shaft)}
        if path.startswith("friction.support_bearing"):
            needed |= {"friction.support_bearing": 0.002, "friction.support_bearing_radius": 10.0}
        if path == "friction.seat" and wheel.seat.kind == "fixed":
            needed |= _seat(drive, "pin_wheel", "slot") | {path: 0.02}
        return needed
    if path == "inertia.output_mass" and not drive.wheel_yields:
        return {"pin_wheel.support_stiffness": 5e5}
    if path.startswith("first_stage.") and drive.first_stage is None:
        return _FIRST_STAGE | (_RUNOUT if "_runout." in path else {})
    if path.startswith("load.external.") and not drive.load.external:
        return _EXTERNAL | {"pin_wheel.support_stiffness": drive.pin_wheel.support_stiffness or 5e5}
    if path.startswith("duty.") and not drive.duty:
        entries: list[dict[str, float]] = [
            {"torque": 0.5 * drive.load.torque, "speed": 900.0, "share": 0.4},
            {"torque": drive.load.torque, "speed": 1500.0, "share": 0.6},
        ]
        return {f"duty.{number}.{name}": value for number, entry in enumerate(entries) for name, value in entry.items()}
    if path.startswith("lubricant.") and drive.lubricant is None:
        speed = {} if drive.duty or drive.load.speed is not None else {"load.speed": 1500.0}
        return {"lubricant.viscosity": 60.0, "lubricant.contamination": 0.5} | speed
    if path in ("pin_shaft.seat.pin_radius", "pin_shaft.seat.bore_radius") and shaft and shaft.seat.kind == "fixed":
        return _seat(drive, "pin_shaft", "sleeve")
    if path.startswith(("carrier.", "materials.carrier.")):
        return _carrier(drive, path, span)
    if path.startswith("pin_wheel.beam.") and wheel.beam is None:
        return {"pin_wheel.beam.span": span, "pin_wheel.beam.ends": "supported"}
    if path.startswith("pin_shaft.beam.") and shaft and shaft.beam is None:
        return {"pin_shaft.stiffness": None, "pin_shaft.beam.span": span, "pin_shaft.beam.tip": "free"}
    return {}


def _of_main_bearing(path: str) -> dict[str, Any]:
    """A main bearing in which a field of it has an effect: rows of its own, or its stiffness."""
    name = path.removeprefix("main_bearing.")
    if name == "bearings.0.radial_stiffness":
        return {
            "main_bearing.bearings.0.plane": 0.0,
            "main_bearing.bearings.0.kind": "cylindrical",
            "main_bearing.bearings.0.radial_stiffness": 5e5,
        }
    if name == "bearings.0.axial_stiffness":
        rows = {one: value for one, value in _ROWS.items() if not one.endswith("load_constant")}
        return rows | {f"main_bearing.bearings.{number}.axial_stiffness": 5e5 for number in (0, 1)}
    if name == "axial_stiffness":
        return _EXTERNAL | {"main_bearing.radial_stiffness": 5e5, path: 4e5}
    if name == "arrangement" or name.startswith("bearings."):
        return _ROWS
    return {} if name == "radial_stiffness" else {"main_bearing.radial_stiffness": 5e5}


def is_refused_by_name(path: str, told: str) -> bool:
    """Tell whether a message names a field, its table, or the table that a material belongs to."""
    table = path.rpartition(".")[0]
    return path in told or table in told or goes_with(path) in told


def goes_with(path: str) -> str:
    """Return the name in the refusal of a field: the field, or the table or field that it belongs to."""
    if needs_slices(path):
        return "contact.slices"
    return GOES_WITH.get(path) or GOES_WITH.get(path.rpartition(".")[0], path)


def change_of(drive: Drive, path: str) -> tuple[Drive, dict[str, Any]]:
    """Return a drive in which a field has an effect, for comparison, and the change of the field for `with_fields`.

    Numbers of parts change together with what depends on them (teeth with pins; errors of single parts are left out), and
    of an end relief the other of length and depth is given, without which neither has an effect.
    """
    parent, _, name = path.rpartition(".")
    if parent.endswith(("pin_profile", "roller_profile")):
        # Tables of profiled parts are dear where radii differ: diameters are as drawn.
        drive = with_fields(drive, dict.fromkeys(DIAMETERS, ()))
    if needed := _beside(drive, path):
        if path.startswith("first_stage.") and drive.crank.number == 1:  # refused as a whole
            return drive, needed | {path: _LEFT_OUT.get(path) or _FIRST_STAGE.get(path, needed.get(path, 0.1))}
        drive = with_fields(drive, needed)
    if path == "crank.support.torsion":
        return drive, {path: True, "crank.support.spline_plane": 40.0}
    if path.endswith(".seat.kind"):
        return drive, _seat(drive, parent.removesuffix(".seat"), sensible_change(drive, path))
    if path in _LEFT_OUT and _is_left_out(drive, path):
        return drive, {path: _LEFT_OUT[path]}
    if name in _RELIEF:
        other = next(relief for relief in _RELIEF if relief != name)
        return with_fields(drive, {f"{parent}.{other}": _RELIEF[other]}), {path: _RELIEF[name]}
    if name in _LEAD_RELIEF:  # refused one without the other
        given = {f"{parent}.{relief}": value for relief, value in _LEAD_RELIEF.items()}
        return with_fields(drive, given), {path: 0.5 * _LEAD_RELIEF[name]}
    if path == "disc.thickness":  # rollers no longer than the disc; in plane strain as long as it is
        return drive, {path: 1.1 * read_field(drive, path)} | (
            {"crank_bearing.roller_length": 1.1 * read_field(drive, "crank_bearing.roller_length")}
        )
    if path == "duty.0.share":
        return drive, {path: 0.5 * read_field(drive, path), "duty.1.share": 1.0 - 0.5 * read_field(drive, path)}
    if _is_count(path):
        cleared = {
            field: ()
            for field, kind in field_kinds().items()
            if kind.is_array and "profile_errors" not in field and ANY not in field.split(".")
            if not field.startswith(("crank.support.", "carrier.")) and missing_part(drive, field) is None
        }
        base = with_fields(drive, cleared)
        change = {path: sensible_change(base, path)}
        partner = {
            "pin_wheel.number_of_pins": "disc.number_of_teeth",
            "disc.number_of_teeth": "pin_wheel.number_of_pins",
        }
        if path in partner:
            change[partner[path]] = sensible_change(base, partner[path])
        return base, change
    return drive, {path: sensible_change(drive, path)}


def with_densities(drive: Drive) -> Drive:
    """Return a drive with the densities of sleeves, carrier and ring that a change has put into it."""
    given: dict[str, Any] = {}
    for part in ("sleeve", "carrier"):
        if getattr(drive.materials, part).density is None:
            given[f"materials.{part}.density"] = 7000.0
    if drive.ring is not None and drive.ring.material.density is None:
        given["ring.material.density"] = 7000.0
    used = {
        "sleeve": "sleeve" in (drive.pin_wheel.seat.kind, drive.pin_shaft and drive.pin_shaft.seat.kind),
        "carrier": drive.posts,
    }
    return with_fields(drive, {path: value for path, value in given.items() if used.get(path.split(".")[1], True)})


def moves(before: FloatArray, after: FloatArray) -> bool:
    """Tell whether an answer differs from another by more than `ROUND_OFF` in any number, or in their count."""
    if before.shape != after.shape or not np.array_equal(np.isnan(before), np.isnan(after)):
        return True
    known = ~np.isnan(before)
    first, second = before[known], after[known]
    size = np.maximum(np.maximum(np.abs(first), np.abs(second)), 1e-9)
    return bool(np.any(np.abs(first - second) > ROUND_OFF * size))


def fault_of_field(
    path: str,
    model: str,
    before: FloatArray | CycloError,
    after: FloatArray | CycloError,
    *,
    accepted: Callable[[], bool],
    by_table: bool = False,
) -> str:
    """Return how a model breaks the contract for a field, in words; empty where it keeps it.

    Parameters
    ----------
    path : str
        Of the field, one of `leaf_fields`.
    model : str
        Key of `EXCEPTIONS`.
    before, after : array, shape (numbers,), or CycloError
        Answers before and after the change of the field, or the errors by which the model refused the drives.
    accepted : callable
        Whether another model takes the changed drive; called where an engine refuses it beyond `ltca.drive.engine_support`.
    by_table : bool, optional
        Whether the table of a field is its name in a refusal, too.
    """
    named = any(refusal(model, name.replace(".0.", ".N.")) is not None for name in (path, goes_with(path)))
    if isinstance(after, CycloError):
        message = " ".join(str(after).split())
        if not (goes_with(path) in message or path in message or (by_table and is_refused_by_name(path, message))):
            return f"{path} is refused by {model} without its name: {message[:200]}"
        if model in ENGINES and not named and accepted():
            return f"{path} is refused by {model}, but not listed in ltca.drive.engine_support"
        return ""
    if isinstance(before, CycloError):
        return f"{path}: {model} refuses the drive before the change: {before}"
    if refusal(model, path.replace(".0.", ".N.")) is not None:
        return f"{path} is accepted by {model}, but listed as refused in ltca.drive.engine_support"
    if moves(before, after) and path in EXCEPTIONS[model]:
        return f"{path} is listed as an exception of {model}, but moves the answer"
    if not moves(before, after) and path not in EXCEPTIONS[model]:
        return f"{path} is ignored by {model}"
    return ""
