"""Picture of a drive at one crank angle: its parts with their numbers, contact normals, and loads as arrows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Circle, Polygon

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.figures.free_labels import FreeLabels
from ltca.figures.house_style import CRANK_ANGLE, STYLE, save_figure, shortened_label
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y

STEEL, PIN, ROLLER, RACE, SHAFT = "#e9edf2", "#cfd6de", "#d9dde3", "#bfc8d2", "#c9cfd8"
SLEEVE, SLOT = "#e6d9bf", "#8a6f3c"
EDGE = "#4a5560"
LOAD, NORMAL = "#B34A00", "#5B7FA6"
NUMBER = "#3a4550"
INCHES = 8.0
"""Side of the square in which a disc stands."""
FITS = 0.72
"""Height of a number by the radius of the pin it stands in."""
SMALLEST, LARGEST = 5.0, 8.0
"""Sizes of numbers, points; beside a pin where they would not fit into it."""
APART = 26.0
"""Points between wheel pins with a number and a force: of closer ones every second has them, or every fifth."""


def _circles(axes: Any, centres: Any, radii: Any, colour: str, zorder: int) -> None:
    patches = [Circle((c.real, c.imag), r) for c, r in zip(centres, np.broadcast_to(radii, centres.shape), strict=True)]
    axes.add_collection(PatchCollection(patches, facecolor=colour, edgecolor=EDGE, linewidth=0.7, zorder=zorder))


def draw_drive(drive: Drive, analysis: LoadedAnalysis, position: int, path: Path, case: str = "") -> None:
    """Write a picture of the drive at one analysed position, several discs beside each other; the suffix chooses the format."""
    save_figure(drive_figure(drive, analysis, position, case), path)


def drive_figure(drive: Drive, analysis: LoadedAnalysis, position: int, case: str = "") -> Figure:
    """Return the picture that `draw_drive` writes."""
    discs = analysis.discs
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=((INCHES + 0.6) * len(discs), INCHES + 1.4))
        panels = np.atleast_1d(figure.subplots(1, len(discs), sharey=True))
        shown = [_Position(disc, position) for disc in discs]
        largest = max(one.largest for one in shown)
        for number, (axes, one) in enumerate(zip(panels, shown, strict=True)):
            _draw_disc(axes, one)
            if len(discs) > 1:
                axes.set_title(f"disc {number}, seen from the same side", fontsize=9.5)
        panels[0].set_ylabel("y [mm]")
        name = shortened_label(drive.name + (f", {case}" if case else ""), 48)
        angle = shown[0].crank_angle
        # A name may hold a dollar sign: the formula stands in a text of its own.
        held = ", wheel held" if drive.wheel_is_held else ""
        figure.suptitle(f"{name}: forces on the disc{'s' if len(discs) > 1 else ''}")
        told = (
            f"{CRANK_ANGLE} = {np.degrees(angle):.4g}° ({angle:.4g} rad), torque {analysis.torque / 1000.0:g} N·m{held}"
        )
        figure.text(0.5, 1.0 - 0.42 / figure.get_figheight(), told, ha="center", va="center", parse_math=True)
        layout: Any = figure.get_layout_engine()
        layout.set(rect=(0.0, 0.0, 1.0, 1.0 - 0.30 / figure.get_figheight()))
        figure.legend(
            handles=_legend(drive, largest), loc="outside lower center", ncols=5 if len(discs) == 1 else 8, frameon=False,
            fontsize=8.0, handlelength=1.6, columnspacing=1.4,
        )  # fmt: skip
        layout.execute(figure)
        for axes, one in zip(panels, shown, strict=True):
            _draw_loads(figure, axes, one, largest)
        # Words keep the places found for them.
        figure.set_layout_engine("none")
    return figure


def _legend(drive: Drive, largest: float) -> list[Any]:
    """What the marks stand for; slots and sleeves where there are any."""
    kinds = {part.seat.kind for part in (drive.pin_wheel, drive.pin_shaft) if part is not None}
    black: dict[str, Any] = {"color": "black", "linestyle": "none"}
    marks = [
        Line2D([], [], color=LOAD, marker=">", markersize=5, linewidth=1.4, label=f"force, longest {largest:.0f} N"),
        Line2D([], [], color=NORMAL, linewidth=0.9, label="contact normal"),
        Line2D([], [], marker="+", markersize=9, label="crank axis", **black),
        Line2D([], [], marker="o", markersize=3, label="centre of the inner race", **black),
    ]
    if "slot" in kinds:
        marks.append(Line2D([], [], color=SLOT, linewidth=2.4, label="slot"))
    if "sleeve" in kinds:
        marks.append(Line2D([], [], color=SLEEVE, marker="o", markersize=7, linestyle="none", label="sleeve"))
    return marks


def _draw_disc(axes: Any, shown: _Position) -> None:
    _draw_parts(axes, shown)
    for axis, race in zip(shown.cranks, shown.races, strict=True):
        axes.plot([axis.real, race.real], [axis.imag, race.imag], color="black", linewidth=1.2, zorder=6)
        axes.plot([axis.real], [axis.imag], marker="+", color="black", markersize=9, zorder=6)
        axes.plot([race.real], [race.imag], marker="o", color="black", markersize=3, zorder=6)
    if shown.cranks.size > 1:  # on the side of the axis that the eccentric leaves free
        for number, (axis, race) in enumerate(zip(shown.cranks, shown.races, strict=True)):
            below = -1.0 if (race - axis).imag >= 0.0 else 1.0
            place = axis + 0.5j * below * shown.place.inner_race_radius
            axes.text(place.real, place.imag, f"crank {number}", fontsize=8.0, ha="center", va="center", zorder=6)
    reach = 1.04 * (np.abs(shown.pins).max() + shown.place.wheel_pin_radii.max())
    if _room_for_numbers(reach, float(shown.place.wheel_pin_radii.min())) is None:
        reach *= 1.04
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel("x [mm]")


class _Position:
    """Where the parts of a drive of one disc stand at one analysed position, as complex numbers in the fixed frame."""

    def __init__(self, analysis: LoadedAnalysis, position: int) -> None:
        geometry = analysis.model.discs[0].geometry
        self.profile, self.place = geometry.profile, geometry.placement
        full, place = analysis.full, geometry.placement
        self.crank_angle = float(full.crank_angle[position])
        pose, coordinates = full.pose[position], geometry.coordinates
        at = np.asarray(self.crank_angle)
        self.disc = complex(place.races(at).middle) + complex(pose[X], pose[Y])
        self.turn = np.exp(1j * pose[DISC_ROTATION])
        yielding = np.zeros(place.cranks, dtype=complex)
        for crank in range(coordinates.cranks):
            yielding[crank] = complex(*pose[coordinates.crank(crank) :][:2])
        self.cranks, self.races = place.crank_axes + yielding, place.races(at).centre + yielding
        self.bores = self.disc + self.turn * place.bore_centres
        wheel_turn = self.crank_angle / place.reduction_ratio + pose[WHEEL_ANGLE]
        moved = complex(*pose[coordinates.wheel_place]) if coordinates.wheel else 0.0
        self.pins = place.wheel_axis + moved + place.wheel_pin_centres * np.exp(1j * wheel_turn)
        self.holes = self.disc + self.turn * place.hole_centres
        contacts, drive = full.response, analysis.drive
        rays = geometry.rollers(np.array([self.crank_angle]))
        races = np.repeat(self.races, place.roller_radii.size // place.cranks)
        self.rollers = races + rays.direction[0] * (rays.outermost - contacts.rollers.inner_approach[position])
        play = place.shaft_pin_centres - self.holes
        normal = -geometry.profile.normal(contacts.flank.parameter[position]) * self.turn
        pushed = contacts.rollers.outer_direction[position]
        self.wheel, self.shaft = drive.pin_wheel, drive.pin_shaft
        # Loose pins and sleeves lie where the flank, or the hole, pushes or would push them.
        grown = place.wheel_pin_radii - self.wheel.pin_radius if self.wheel.seat.kind == "slot" else 0.0
        self.touched_pins = self.pins - (self.wheel.seat_play - grown) * normal
        inward = play / np.abs(play)
        sleeve_play = 0.0 if self.shaft is None else self.shaft.seat_play
        self.touched_shaft_pins = place.shaft_pin_centres - sleeve_play * inward
        # Centres of pins, rollers and shaft pins, their loads and radii, and the directions toward their contacts.
        self.loads = [
            (self.touched_pins, contacts.pin_load[position], place.wheel_pin_radii, normal),
            (self.rollers, contacts.rollers.outer_load[position], place.roller_radii, pushed),
            (self.touched_shaft_pins, contacts.hole_load[position], place.shaft_pin_radii, inward),
        ]

    @property
    def largest(self) -> float:
        """Largest load, N."""
        return max(float(np.max(load, initial=0.0)) for _, load, _, _ in self.loads)


def _draw_parts(axes: Any, shown: _Position) -> None:
    place = shown.place
    outline = shown.disc + shown.turn * shown.profile.flank(np.linspace(0.0, 2.0 * np.pi, 4000))
    axes.add_patch(
        Polygon(np.column_stack((outline.real, outline.imag)), facecolor=STEEL, edgecolor="#4a5560", linewidth=0.9)
    )
    _circles(axes, shown.holes, place.hole_radii, "white", 2)
    if shown.shaft is not None:
        _pins(axes, shown.shaft, place.shaft_pin_centres, shown.touched_shaft_pins, place.shaft_pin_radii, SHAFT)
    _circles(axes, shown.bores, place.bore_radius, "white", 2)
    _circles(axes, shown.races, place.inner_race_radius, RACE, 3)
    _circles(axes, shown.rollers, place.roller_radii, ROLLER, 4)
    _pins(axes, shown.wheel, shown.pins, shown.touched_pins, place.wheel_pin_radii, PIN)


def _pins(axes: Any, part: PinWheel | PinShaft, seats: Any, touched: Any, radii: Any, colour: str) -> None:
    """Pins as they sit, by the centres of their seats and of what is touched: fixed, in slots or under sleeves."""
    if part.seat.kind == "sleeve":
        _circles(axes, touched, radii, SLEEVE, 4)
        _circles(axes, touched, part.seat.bore_radius, "white", 5)
        _circles(axes, seats, part.seat.pin_radius, colour, 5)
        return
    _circles(axes, touched, radii, colour, 4)
    if isinstance(part, PinWheel) and part.seat.kind == "slot":
        # The outer half, which carries: the inner one is open to the disc.
        size = 2.0 * (part.seat.radius or 0.0)
        for seat in seats:
            outward = float(np.degrees(np.angle(seat)))
            arc = Arc((seat.real, seat.imag), size, size, theta1=outward - 90.0, theta2=outward + 90.0)
            arc.set(color=SLOT, linewidth=2.4, zorder=5)
            axes.add_patch(arc)


def _room_for_numbers(reach: float, radius: float) -> float | None:
    """Size of numbers inside of pins of a radius, points; None where they would not fit."""
    points = FITS * radius / (2.0 * reach) * INCHES * 72.0
    return min(points, LARGEST) if points >= SMALLEST else None


def _pins_named(shown: _Position, reach: float) -> int:
    """Which wheel pins have their number and their force written: every one, every second, every fifth and so on."""
    apart = float(np.abs(shown.pins).max()) * np.pi / reach * INCHES * 72.0 / shown.pins.size
    return next((every for every in (1, 2, 5, 10, 20) if every * apart >= APART), 50)


def _draw_numbers(axes: Any, shown: _Position, labels: FreeLabels) -> None:
    """The number of each pin, roller and shaft pin: in it, or beside it on the side away from the disc."""
    reach = float(axes.get_xlim()[1])
    outward = shown.pins / np.abs(shown.pins)
    kinds = (
        (shown.pins, shown.place.wheel_pin_radii, outward),
        (shown.rollers, shown.place.roller_radii, None),
        (shown.touched_shaft_pins, shown.place.shaft_pin_radii, None),
    )
    each, every = shown.rollers.size // shown.cranks.size, _pins_named(shown, reach)
    for centres, radii, beside in kinds:
        if not centres.size:
            continue
        size = _room_for_numbers(reach, float(np.min(radii)))
        if size is None and beside is None:
            continue
        for number, (centre, radius) in enumerate(zip(centres, np.broadcast_to(radii, centres.shape), strict=True)):
            if centres is shown.pins and number % every:
                continue
            place = centre
            if size is None and beside is not None:
                place = centre + beside[number] * (radius + 0.02 * reach)
            told = number % each if centres is shown.rollers else number
            text = axes.text(
                place.real, place.imag, f"{told}", fontsize=size or SMALLEST, color=NUMBER, ha="center",
                va="center_baseline", zorder=7,
            )  # fmt: skip
            labels.keep(text)


def _draw_loads(figure: Figure, axes: Any, shown: _Position, largest: float) -> None:
    """Draw normals and forces; numbers first, for their places are fixed, then each force where there is room."""
    longest = 0.2 * float(shown.place.mean_eccentricity[0]) * shown.place.reduction_ratio + 12.0
    labels, arrows, normals = FreeLabels(figure, axes), [], []
    every = _pins_named(shown, float(axes.get_xlim()[1]))
    for centres, load, radii, towards in shown.loads:
        named = np.ones(load.size, dtype=bool)
        if centres is shown.touched_pins and every > 1:
            named = (np.arange(load.size) % every == 0) | (load == load.max())
            for pin in shown.pins:  # between close pins a force would stand on them
                labels.keep_circle(pin, float(np.max(radii)))
        for centre, force, radius, direction, told in zip(centres, load, radii, towards, named, strict=True):
            contact = centre + radius * direction
            normals.append([contact - 0.3 * radius * direction, contact + 0.6 * radius * direction])
            if force > 1e-3 * largest:
                arrows.append((contact, contact + direction * longest * force / largest, float(force), bool(told)))
    ends = np.array(normals)
    segments: Any = np.stack([ends.real, ends.imag], axis=-1)
    axes.add_collection(LineCollection(segments, colors=NORMAL, linewidths=0.8, zorder=6))
    _draw_numbers(axes, shown, labels)
    for contact, tip, *_ in arrows:
        axes.annotate(
            "",
            xy=(tip.real, tip.imag),
            xytext=(contact.real, contact.imag),
            arrowprops={"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0},
            zorder=7.5,
        )
        labels.keep_line(contact, tip)
    halo = [patheffects.withStroke(linewidth=2.0, foreground="white", alpha=0.85)]
    for contact, tip, force, told in sorted(arrows, key=lambda arrow: -arrow[2]):
        if told:
            labels.place(f"{force:.0f} N", tip, tip - contact, fontsize=7.0, color=LOAD, zorder=8, path_effects=halo)
