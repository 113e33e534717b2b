"""Data for the script of the report: the drive at each position, with place, direction and numbers of every contact."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.units.quantities import ARCSEC
from ltca.geometry.pairs import ContactGeometry
from ltca.page.scene import circles, point
from validation.compare.compared_positions import ComparedPosition
from validation.compare.comparison import Kind, PositionAnswer
from validation.compare.model_positions import FULL
from validation.rows import rounded

Line: TypeAlias = tuple[str, int, float | None]
"""Title, digits behind the point and value of one line of a table."""


def position_scene(compared: ComparedPosition) -> dict[str, Any]:
    """Return one position for the page: parts at the pose of the full solution and the contacts' numbers in all models.

    A contact has its place, the direction of the force on the disc (inner race: on the roller) and, by model, load, pressure and
    half-width.
    """
    answers = {FULL: compared.full.answer, **compared.answers}
    parts = _places(compared)
    contacts = [
        {
            "name": compared.full.answer.contact_name(kind, number),
            "kind": kind,
            "at": point(centres[number] + radii[number] * towards[number]),
            "to": point(towards[number]),
            "models": {model: _numbers(answer, kind, number) for model, answer in answers.items()},
        }
        for kind, (centres, radii, towards) in parts.items()
        for number in _loaded(list(answers.values()), kind)
    ]
    full, place = compared.full.answer, ContactGeometry.of_drive(compared.drive).placement
    races = place.races(np.array([compared.full.crank_angle])).centre[0]
    return {
        "case": compared.full.case,
        "angle": rounded(compared.full.crank_angle),
        "disc": [*point(_disc_centre(compared)), rounded(full.disc_rotation)],
        "cranks": [[*point(axis), *point(race)] for axis, race in zip(place.crank_axes, races, strict=True)],
        "pins": circles(*parts["pin"][:2]),
        "rollers": circles(*parts["roller_outer"][:2]),
        "shafts": circles(*parts["hole"][:2]),
        "contacts": contacts,
        "totals": _totals(answers),
        "unknowns": compared.full.unknowns,
    }


def _loaded(answers: list[PositionAnswer], kind: Kind) -> list[int]:
    """Return the contacts of a kind that carry load in any answer."""
    loads = np.stack([answer.kinds[kind].load for answer in answers])
    return [int(number) for number in np.flatnonzero(loads.max(axis=0) > 0.0)]


def _disc_centre(compared: ComparedPosition) -> complex:
    angle, answer = compared.full.crank_angle, compared.full.answer
    place = ContactGeometry.of_drive(compared.drive).placement
    shift = complex(answer.disc_radial, answer.disc_tangential) * place.eccentric_direction(np.array([angle]))[0]
    return complex(place.races(np.array([angle])).middle[0] + shift)


def _places(compared: ComparedPosition) -> dict[Kind, tuple[ComplexArray, FloatArray, ComplexArray]]:
    """Return centres, radii and directions from the centre to the contact of all parts, by kind."""
    geometry, answer = ContactGeometry.of_drive(compared.drive), compared.full.answer
    place, angle = geometry.placement, np.array([compared.full.crank_angle])
    disc, turn = _disc_centre(compared), np.exp(1j * answer.disc_rotation)
    shift = disc - complex(place.races(angle).middle[0])
    pose = np.array([[shift.real, shift.imag, answer.disc_rotation, answer.wheel_angle]])
    flank = geometry.flank(angle, pose)
    rays, cranks = geometry.rollers(angle).direction[0], place.roller_cranks
    roller_centres = place.races(angle).centre[0][cranks] + (place.inner_race_radius + place.roller_radii) * rays
    pins = place.wheel_pin_centres * np.exp(1j * (place.wheel_rotation(angle)[0] + answer.wheel_angle))
    play = place.shaft_pin_centres - (disc + turn * place.hole_centres)
    outward = roller_centres - (disc + turn * place.bore_centres)[cranks]
    return {
        "pin": (pins, place.wheel_pin_radii, -geometry.profile.normal(flank.parameter[0]) * turn),
        "roller_outer": (roller_centres, place.roller_radii, outward / np.abs(outward)),
        "roller_inner": (roller_centres, place.roller_radii, -rays),
        "hole": (place.shaft_pin_centres, place.shaft_pin_radii, play / np.abs(play)),
    }


def _numbers(answer: PositionAnswer, kind: Kind, number: int) -> list[float | None]:
    own = answer.kinds[kind]
    width = float(own.half_width[number])
    return [
        _short(float(own.load[number])),
        _short(float(own.pressure[number])),
        _short(1e3 * width),
    ]


def _totals(answers: dict[str, PositionAnswer]) -> list[dict[str, Any]]:
    """Return the lines of the table of wheel, bearing forces, pose and number of contacts."""
    found: dict[str, list[Line]] = {model: _total_lines(answer) for model, answer in answers.items()}
    return [
        {"title": title, "digits": digits, "models": {model: lines[number][2] for model, lines in found.items()}}
        for number, (title, digits, _) in enumerate(next(iter(found.values())))
    ]


def _total_lines(answer: PositionAnswer) -> list[Line]:
    cranks = answer.bearing_radial.size
    names = [""] if cranks == 1 else [f" of crank {crank}" for crank in range(cranks)]
    bearings: list[Line] = []
    for name, radial, tangential in zip(
        names, answer.bearing_radial.tolist(), answer.bearing_tangential.tolist(), strict=True
    ):
        bearings += [
            (f"bearing{name}, radial, N", 0, _short(radial)),
            (f"bearing{name}, tangential, N", 0, _short(tangential)),
        ]
    counted: dict[str, Kind] = {"pins": "pin", "rollers": "roller_outer", "shaft pins": "hole"}
    return [
        ("wheel angle, ″", 2, rounded(answer.wheel_angle * ARCSEC)),
        *bearings,
        ("disc, radial, µm", 2, _short(1e3 * answer.disc_radial)),
        ("disc, tangential, µm", 2, _short(1e3 * answer.disc_tangential)),
        ("disc rotation, ″", 2, _short(answer.disc_rotation * ARCSEC)),
        *(
            (f"loaded {name}", 0, float(answer.loaded(kind)))
            for name, kind in counted.items()
            if answer.kinds[kind].load.size
        ),
    ]


def _short(value: float) -> float | None:
    return None if not np.isfinite(value) else float(f"{value:.5g}")
