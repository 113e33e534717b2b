"""Picture of a solved drive for its page, as the page of a run has it: parts, an arrow for each load, a dot for each pressure.

It is SVG written here, in the colours of the page: nothing is rendered, which would take as long as the solution.
"""

from __future__ import annotations

from math import degrees
from xml.sax.saxutils import escape

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.contact_results import deformed_contacts
from fem.drive.full_solution import FullSolution
from fem.reducer.solution import ReducerSolution
from ltca.arrays import ComplexArray
from ltca.page.study_page import Picture

NAME = "loads"
POINTS_PER_LOBE = 36
REACH = 1.1
"""Half side of the picture by the distance of the outermost part."""
THIN = 1.0 / 400.0
"""Width of a line by the half side, the measure of everything that is no part of the drive."""
LONGEST = 0.3
"""Length of the largest load's arrow by the half side."""
ARROW, DOT = 5.0, 4.5
"""Width of an arrow and radius of a dot, in thin lines."""
BESIDE, INSIDE, LEAST = 20.0, 15.0, 9.0
"""Size of numbers beside small pins, largest size of those in parts, and the least that is written, in thin lines."""
COLOURS = 10
"""Steps of the scale of pressures, ``p0`` to ``p9`` of ``study.css``."""
CLASSES: dict[PairKind, str] = {"pin": "k-pin", "roller_outer": "k-outer", "hole": "k-hole"}
"""Of the loads on the disc; a roller's is drawn once, in its bore."""
PARTS = {"k-pin": "wheel pins", "k-outer": "rollers", "k-hole": "shaft pins"}


def draw_loads(solution: ReducerSolution) -> Picture:
    """Return the drive at the solved position, a panel for each disc, all with one scale of loads and one of pressures."""
    found = [disc.contacts.loaded for disc in solution.discs]
    load = max(load for contacts in found for _, _, load, _, _ in contacts)
    pressure = max(pressure for contacts in found for _, _, _, pressure, _ in contacts)
    panels = []
    for number, disc in enumerate(solution.discs):
        share = 100.0 * float(solution.torque_share[number])
        told = f"Disc {number}, {share:.2f} % of the torque" if len(solution.discs) > 1 else ""
        panels.append((told, _disc_svg(disc, told or "The drive", load, pressure)))
    kinds = {CLASSES[kind] for contacts in found for kind, *_ in contacts if kind in CLASSES}
    keys = [("", f"key {kind}", words) for kind, words in PARTS.items() if kind in kinds]
    keys += [
        ("", "", f"longest arrow {_figure(load)} N"),
        ("pressure 0", "scale pressures", f"{_figure(pressure)} MPa"),
    ]
    angle = f"Crank at {degrees(solution.crank_angle):.6g}° ({solution.crank_angle:.6g} rad)".replace("-", "−")
    torque = solution.drive.load_words(solution.torque)
    return Picture(
        name=NAME,
        title=f"{angle}, {torque} at the output. Forces on the disc, largest pressure of each contact.",
        panels=panels,
        keys=keys,
    )


def _disc_svg(disc: FullSolution, told: str, load: float, pressure: float) -> str:
    model, pose, place = disc.model, disc.pose, disc.model.placement
    pins = np.array([model.circle_centre("pin", k, pose) for k in range(len(place.wheel_pin_radii))])
    rollers = np.array([model.circle_centre("roller_outer", k, pose) for k in range(len(place.roller_radii))])
    shafts = place.shaft_pin_centres + pose.shaft_pin_displacements
    outermost = float(np.max(np.abs(pins) + place.wheel_pin_radii))
    ring = model.drive.ring
    reach = REACH * (outermost if ring is None else max(outermost, ring.outer_radius))
    thin = THIN * reach
    parts = [
        f'<svg class="drive" viewBox="{-reach:.3f} {-reach:.3f} {2 * reach:.3f} {2 * reach:.3f}" role="img" '
        f'aria-label="{escape(told)}: parts, loads and pressures" stroke-width="{thin:.4f}">'
    ]
    if ring is not None:
        edges = _circle(0j, ring.outer_radius) + _circle(0j, ring.inner_radius)
        parts.append(f'<path class="wheelring" fill-rule="evenodd" d="{edges}"/>')
    frame, shape = model.disc_pose(pose), model.shapes.disc
    count = POINTS_PER_LOBE * model.drive.disc.number_of_teeth
    outline = frame.place(shape.flank.points(2.0 * np.pi * np.arange(count) / count))
    holes = [_circle(complex(frame.place(np.array(hole.centre))), hole.radius) for hole in (*shape.bores, *shape.holes)]
    edges = "M" + "L".join(map(_xy, outline.tolist())) + "Z" + "".join(holes)
    parts.append(f'<path class="disc" fill-rule="evenodd" d="{edges}"/>')
    races = model.race_centres.tolist()
    parts += [f'<path class="race" d="{_circle(centre, float(place.inner_race_radius))}"/>' for centre in races]
    each = len(rollers) // place.cranks  # numbered in every bearing anew
    groups = (
        ("pins", pins, place.wheel_pin_radii, len(pins)),
        ("rollers", rollers, place.roller_radii, each),
        ("shafts", shafts, place.shaft_pin_radii, len(shafts)),
    )
    for kind, centres, radii, numbers in groups:
        circles = zip(centres.tolist(), radii.tolist(), strict=True)
        parts += [f'<path class="part {kind}" d="{_circle(centre, radius)}"/>' for centre, radius in circles]
        parts += _numbers(kind, centres, float(np.min(radii, initial=np.inf)), numbers, thin)
    for crank, (axis, centre) in enumerate(zip(place.crank_axes.tolist(), races, strict=True)):
        parts.append(f'<path class="arm" stroke-width="{2 * thin:.4f}" d="M{_xy(axis)}L{_xy(centre)}"/>')
        parts.append(f'<path class="axis" d="{_circle(axis, 3 * thin)}"/>')
        if place.cranks > 1:
            parts.append(_text(centre - 2j * 13 * thin, 13 * thin, f"crank {crank}"))
    parts += _contacts(disc, reach, load, pressure)
    return "".join([*parts, "</svg>"])


def _contacts(disc: FullSolution, reach: float, largest: float, highest: float) -> list[str]:
    """Arrows of the loads on the disc, and over them a dot for every contact, the races' too."""
    model, results, place = disc.model, disc.contacts, disc.model.placement
    points, frame = deformed_contacts(model, disc.state), model.disc_pose(disc.pose)
    races = model.race_centres[place.roller_cranks] + float(place.inner_race_radius) * model.roller_rays
    at: dict[PairKind, ComplexArray] = {
        "pin": frame.place(points.flank_points),
        "roller_outer": frame.place(points.bore_points),
        "hole": frame.place(points.hole_points),
        "roller_inner": races,
    }
    forces: dict[PairKind, ComplexArray] = {
        "pin": results.pin_force,
        "roller_outer": results.roller_force,
        "hole": results.shaft_pin_force,
    }
    thin, arrows, dots = THIN * reach, list[str](), list[str]()
    for kind, index, load, pressure, _ in results.loaded:
        start = complex(at[kind][index])
        name = CONTACT_KINDS[kind].title_of(index, place)
        title = f"<title>{escape(name)}: {_figure(load)} N, {_figure(pressure)} MPa</title>"
        if kind in CLASSES:
            force = complex(forces[kind][index])
            arrow = _arrow(start, force / abs(force), LONGEST * reach * load / largest, ARROW * thin)
            arrows.append(f'<g class="load {CLASSES[kind]}">{title}{arrow}</g>')
        step = min(COLOURS - 1, int(COLOURS * pressure / highest))
        dots.append(
            f'<path class="pressed p{step}" stroke-width="{0.8 * thin:.4f}" d="{_circle(start, DOT * thin)}">{title}</path>'
        )
    return arrows + dots


def _arrow(start: complex, along: complex, length: float, width: float) -> str:
    head = min(2.6 * width, 0.6 * length)
    base, tip, half = start + along * (length - head), start + along * length, 1.2j * width * along
    return (
        f'<path class="shaft" stroke-width="{width:.4f}" d="M{_xy(start)}L{_xy(base)}"/>'
        f'<path class="head" d="M{_xy(tip)}L{_xy(base + half)}L{_xy(base - half)}Z"/>'
    )


def _numbers(kind: str, centres: ComplexArray, radius: float, numbered: int, thin: float) -> list[str]:
    """Numbers in the parts; of small wheel pins outside, of as many as have room; of other small parts none."""
    size, every, shift = min(1.1 * radius, INSIDE * thin), 1, 0.0
    if 1.1 * radius < LEAST * thin:
        if kind != "pins":
            return []
        size, shift = BESIDE * thin, radius + BESIDE * thin
        apart = 2.0 * np.pi * abs(centres[0]) / len(centres)
        every = next((each for each in (1, 2, 5, 10, 20, 50) if each * apart >= 2.4 * size), 100)
    return [
        _text(centre + shift * centre / abs(centre), size, str(number % numbered))
        for number, centre in enumerate(centres.tolist())
        if number % every == 0
    ]


def _text(at: complex, size: float, words: str) -> str:
    place = f'x="{at.real:.3f}" y="{-at.imag:.3f}" dy="0.35em"'
    return f'<text class="number" stroke="none" {place} font-size="{size:.3f}">{words}</text>'


def _circle(centre: complex, radius: float) -> str:
    size = f"{radius:.4f}".rstrip("0").rstrip(".")
    across = f"{2.0 * radius:.4f}".rstrip("0").rstrip(".")
    return f"M{_xy(centre - radius)}a{size},{size} 0 1,0 {across},0a{size},{size} 0 1,0 -{across},0Z"


def _xy(point: complex) -> str:
    """A point in the picture, whose y runs down."""
    return f"{point.real:.3f},{-point.imag:.3f}"


def _figure(value: float) -> str:
    return f"{value:.0f}" if value >= 1000.0 else f"{value:.4g}"
