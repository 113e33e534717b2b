"""Friction: slip and losses of wheel pins, efficiency of a catalogue reducer."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.losses import losses
from ltca.analysis.loaded_analysis import analyse
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive, Friction
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive, load_drive
from validation.manual.case import Case, Figure, Reference, absolute_figure, relative_figure

WANG_ANGLES = 2.0 * np.pi * np.arange(6) / (6 * 43)
"""Over one mesh period."""
WANG_PIN_FRICTION, WANG_SLEEVE_FRICTION = 0.055, 0.023
"""μ and f, with which their formula meets both printed rows; they are not printed."""
PRINTED_EFFICIENCY = {"initial": 0.862, "least volume": 0.875}


def wang_reducer(shortening: float = 0.611, pin: float = 5.0, wall: float = 1.0) -> Drive:
    """Return their initial design, or one changed in shortening, pin radius (mm) or sleeve wall (mm).

    Pin circle 144, output pins of 12 on 90, eight of them, both as diameters, mm.
    """
    e = shortening * 72.0 / 44
    outer = 6.0 + wall
    return build_drive({
        "name": "wang-2016",
        "crank": {"eccentricity": e},
        "pin_wheel": {"number_of_pins": 44, "pin_circle_radius": 72.0, "pin_radius": pin},
        "disc": {"number_of_teeth": 43, "thickness": 11.0, "number_of_discs": 2},
        "crank_bearing": {
            "inner_race_radius": 18.75, "outer_race_radius": 26.75, "number_of_rollers": 16, "roller_radius": 4.0,
            "roller_length": 11.0,
        },
        "pin_shaft": {
            "number_of_pins": 8, "pin_circle_radius": 45.0, "pin_radius": outer, "hole_radius": outer + e + 0.01,
            "stiffness": 3e5,
            "seat": {"kind": "sleeve", "pin_radius": 6.0, "bore_radius": 6.01},
        },
        "installation": {"held": "pin-wheel"},
        "load": {"torque": 4974.0 * 43 * 0.862, "speed": 1440.0},
        "friction": {"pin": WANG_PIN_FRICTION, "hole": 0.1, "seat": WANG_SLEEVE_FRICTION},
    })  # fmt: skip


def wang_formula(
    shortening: float = 0.611, pin: float = 5.0, wall: float = 1.0, circle: float = 144.0, sleeve: float = 12.0
) -> float:
    """Return η_x η_sx, their losses of pins and of output pins; circle and sleeve are diameters, mm."""
    teeth = 43
    part = 4.0 * WANG_PIN_FRICTION * (circle - 2.0 * pin) / (shortening * circle * np.pi)
    at_pins = (1.0 - part / teeth) / (1.0 + part)
    return float(
        at_pins
        * (1.0 - 4.0 * WANG_SLEEVE_FRICTION * shortening * sleeve * circle / (np.pi * 90.0 * (sleeve + 2.0 * wall)))
    )


def _slip_loss() -> float:
    """What slip loses of loads as they take them, in proportion to the lever about the disc, by what is useful."""
    drive = with_fields(wang_reducer(), {"installation.held": "pin-shaft"})
    geometry, angle = ContactGeometry.of_drive(single_discs(drive)[0]), WANG_ANGLES
    pose = np.zeros((angle.size, 4))
    flank, holes = geometry.flank(angle, pose), geometry.holes(angle, pose)
    load = np.maximum(flank.gradient[..., DISC_ROTATION], 0.0)
    contacts = cast("Any", SimpleNamespace(flank=flank, holes=holes))
    slip = np.abs(Slip.of_disc(geometry, angle, pose, contacts).by_crank[:, :44])
    lost = (WANG_PIN_FRICTION * load * slip).sum(axis=1)
    useful = (load * np.abs(flank.gradient[..., WHEEL_ANGLE])).sum(axis=1) / drive.reduction_ratio
    return float(np.mean(lost) / np.mean(useful))


def _wang() -> list[Figure]:
    others = 0.99 * 0.995**2
    theirs = wang_formula()
    found = analyse(wang_reducer(), WANG_ANGLES).losses
    assert found is not None
    efficiency = found.mean_efficiency
    part = 4.0 * WANG_PIN_FRICTION * 134.0 / (0.611 * 144.0 * np.pi)
    copied = "shows that their formula is copied right: no result of this program; μ and f were fitted to both rows"
    return [
        absolute_figure(
            "efficiency by their formula, initial design", theirs * others, PRINTED_EFFICIENCY["initial"], "", None, copied,
            numerical_error=0.0, numerical_origin="a formula", reference_error=5e-4,
        ),
        absolute_figure(
            "efficiency by their formula, least volume",
            wang_formula(shortening=0.778, pin=4.95, circle=140.0, sleeve=13.2) * others, PRINTED_EFFICIENCY["least volume"], "",
            None, copied, numerical_error=0.0, numerical_origin="a formula", reference_error=5e-4,
        ),
        relative_figure(
            "loss of the wheel pins by slip, loads by levers, against 4μ(D_p − d_rp)/(K₁ D_p π)", _slip_loss(),
            float(part), "", 0.02,
            "their mean over the half of the pins that carry is an integral; 44 pins make a sum of it",
            numerical_error=1e-12, numerical_origin="round-off",
        ),
        absolute_figure(
            "loss of our reducer by that of their formula", (1.0 - efficiency) / (1.0 - theirs), 1.0, "times", 1.0,
            "larger by less than as much again: theirs is of a disc that stands still in its bearing; ours yields "
            "there and pins far from "
            "the pitch point carry", numerical_error=1e-3, numerical_origin="six positions over a mesh period, estimated",
        ),
    ]  # fmt: skip


def pitch_point_loss(positions: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what a friction of 1e-4 at the wheel pins costs by radian of the crank, N·mm, shape (positions,).

    By the distance of each contact from the pitch point, by the power of slip, and by half the difference of the crank torques
    of both senses of rotation.
    """
    paper, size = load_drive("paper").cases["CS-6"], 1e-4
    drive = replace(paper, friction=Friction(pin=size))
    angle = position_angles(positions)
    model, torque = HalfSpace().prepare(drive).model, paper.load.torque
    plain = solve_at_output(HalfSpace().prepare(paper).model, [paper], angle, torque)
    found = solve_at_output(model, [drive], angle, torque)
    assert model.friction is not None
    back = replace(model, friction=model.friction.reversed())
    other = solve_at_output(back, [drive], angle, torque)
    crank = [one.crank_moments(angle, at.pose, at.response.parts)[:, 0] for one, at in ((model, found), (back, other))]
    place, flank, u = model.discs[0].geometry.placement, plain.response.flank, paper.reduction_ratio
    outward = flank.gradient[..., 0] + 1j * flank.gradient[..., 1]
    turned = np.exp(1j * (angle / u + plain.pose[:, WHEEL_ANGLE]))[:, None]
    contact = place.wheel_axis + place.wheel_pin_centres * turned - place.wheel_pin_radii * outward
    # At e·u from the wheel's axis, e that of the disc as it stands.
    disc = place.races(angle).middle + plain.pose[:, 0] + 1j * plain.pose[:, 1]
    pitch = place.wheel_axis + (disc - place.crank_axes[0])[:, None] * u
    lost = (size * plain.response.pin_load * np.abs(contact - pitch) / u).sum(axis=1)
    told = losses(model, [drive], found, torque).by_kind["pin"]
    return np.asarray(lost), np.asarray(told), np.asarray(0.5 * (crank[0] - crank[1]))


def _pitch_point() -> list[Figure]:
    lost, told, torque = pitch_point_loss(104)
    rougher = pitch_point_loss(52)
    worst = int(np.argmax(np.abs(told / lost - 1.0)))
    mean, before = float(np.mean(torque) / np.mean(lost)), float(np.mean(rougher[2]) / np.mean(rougher[0]))
    return [
        relative_figure(
            "power of slip at the pins, worst position", float(told[worst]), float(lost[worst]), "N·mm", 2e-3,
            "the normal passes the pitch point by the pose", numerical_error=1e-6,
            numerical_origin="balanced to 1e-9 of the load",
        ),
        relative_figure(
            "rise of the mean crank torque by friction", float(np.mean(torque)), float(np.mean(lost)), "N·mm", 1e-3,
            "a turn is no period of the rollers: means hold to 2e-4 of the torque, of its rise to as much",
            numerical_error=abs(mean / before - 1.0), numerical_origin="change from 52 to 104 positions",
        ),
    ]  # fmt: skip


CASES = (
    Case(
        name="catalogue_efficiency",
        title="Efficiency of a catalogue reducer",
        problem="43 lobes, 44 pins, 0.75 kW at 1440 rpm, two discs, sleeves on the output pins; two designs: efficiency.",
        references=(
            Reference(
                source="Wang, Luo, Su, *Mechanism and Machine Theory* 102 (2016) 135–148: η = η_x · 0.99 · 0.995² · η_sx",
                uncertainty="Three digits. Number of output pins (8), sleeve wall (1 mm), μ and f are not printed: "
                "the case informs on the "
                "size of losses, it proves only the slip.",
            ),
        ),
        model="LTCA with half-space compliance and `[friction]` pin 0.055, seat 0.023; slip from kinematics.",
        input_uncertainty="μ 0.05 to 0.1 and f 0.008 to 0.08 are given as ranges; 0.055 and 0.023 meet both printed rows.",
        model_uncertainty="Their disc stands still in its bearing and shares its load by levers.",
        run=_wang,
    ),
    Case(
        name="pitch_point_loss",
        title="Loss at the wheel pins about the pitch point",
        problem="The paper's drive (CS-6) with a friction of 1e-4 at the wheel pins: what it costs by radian of the crank.",
        references=(
            Reference(
                source="Kinematics: slip is the distance of a contact from the pitch point times φ̇_C/u; power balance",
                uncertainty="Of first order in the pose and in μ.",
            ),
        ),
        model="LTCA with half-space compliance: `ltca.analysis.friction.losses`, and the crank torques of both senses "
        "of rotation.",
        run=_pitch_point,
    ),
)
