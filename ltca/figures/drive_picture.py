"""Picture of a drive at one crank angle: its parts, contact normals, and loads as arrows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib import patheffects
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.figures.labelled_curves import STYLE
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.output.files import whole_file

STEEL, PIN, ROLLER, RACE, SHAFT = "#e9edf2", "#cfd6de", "#d9dde3", "#bfc8d2", "#c9cfd8"
SLEEVE, SLOT = "#e6d9bf", "#8a6f3c"
LOAD, NORMAL = "#D55E00", "#5B7FA6"


def _circles(axes: Any, centres: Any, radii: Any, colour: str, zorder: int) -> None:
    patches = [Circle((c.real, c.imag), r) for c, r in zip(centres, np.broadcast_to(radii, centres.shape), strict=True)]
    axes.add_collection(PatchCollection(patches, facecolor=colour, edgecolor="#4a5560", linewidth=0.7, zorder=zorder))


def draw_drive(drive: Drive, analysis: LoadedAnalysis, position: int, path: Path) -> None:
    """Write a picture of the drive at one analysed position, of several discs each beside the other.

    Parameters
    ----------
    drive : Drive
        The drive.
    analysis : LoadedAnalysis
        Its analysis.
    position : int
        Which position of the analysis.
    path : Path
        Picture file; the suffix chooses the format.
    """
    discs = analysis.discs
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0 * len(discs), 8.6))
        panels = np.atleast_1d(figure.subplots(1, len(discs), sharey=True))
        largest = max(_Position(disc, position).largest for disc in discs)
        for number, (axes, disc) in enumerate(zip(panels, discs, strict=True)):
            shown = _Position(disc, position)
            _draw_disc(axes, shown, largest)
            held = "wheel held, " if drive.wheel_is_held else ""
            name = drive.name if len(discs) == 1 else f"{drive.name}, disc {number}"
            axes.set_title(
                f"{name}: forces on the disc at φ_C = {shown.crank_angle:.4g} rad, {held}"
                f"torque {analysis.torque / 1000.0:g} N·m\n"
                f"blue: contact normals; + crank axis, • inner-race centre (eccentricity)"
                f"{', number of the crank' if drive.crank.number > 1 else ''}{_legend(drive)}",
                fontsize=9.0,
            )
        with whole_file(path) as part:
            figure.savefig(part, dpi=130)


def _legend(drive: Drive) -> str:
    """What stands for slots and sleeves, where there are any."""
    kinds = {part.seat.kind for part in (drive.pin_wheel, drive.pin_shaft) if part is not None}
    told = {"slot": "brown arcs: slots", "sleeve": "sand: sleeves"}
    named = [text for kind, text in told.items() if kind in kinds]
    return f"; {', '.join(named)}" if named else ""


def _draw_disc(axes: Any, shown: _Position, largest: float) -> None:
    _draw_parts(axes, shown)
    _draw_loads(axes, shown, largest)
    for axis, race in zip(shown.cranks, shown.races, strict=True):
        axes.plot([axis.real, race.real], [axis.imag, race.imag], color="black", linewidth=1.2, zorder=6)
        axes.plot([axis.real], [axis.imag], marker="+", color="black", markersize=9, zorder=6)
        axes.plot([race.real], [race.imag], marker="o", color="black", markersize=3, zorder=6)
    if shown.cranks.size > 1:  # on the side of the axis that the eccentric leaves free
        for number, (axis, race) in enumerate(zip(shown.cranks, shown.races, strict=True)):
            place = axis - 0.55 * shown.place.inner_race_radius * (race - axis) / np.abs(race - axis)
            axes.text(place.real, place.imag, f"{number}", fontsize=10.0, ha="center", va="center", zorder=6)
    reach = 1.06 * (np.abs(shown.pins).max() + shown.place.wheel_pin_radii.max())
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")


class _Position:
    """Where the parts of a drive of one disc stand at one analysed position, as complex numbers in the fixed frame."""

    def __init__(self, analysis: LoadedAnalysis, position: int) -> None:
        geometry = analysis.model.discs[0].geometry
        self.profile, self.place = geometry.profile, geometry.placement
        full, place = analysis.full, geometry.placement
        self.crank_angle = float(full.crank_angle[position])
        pose, coordinates = full.pose[position], geometry.coordinates
        at = np.asarray(self.crank_angle)
        self.disc = complex(place.race_centre(at)) + complex(pose[X], pose[Y])
        self.turn = np.exp(1j * pose[DISC_ROTATION])
        yielding = np.zeros(place.cranks, dtype=complex)
        for crank in range(coordinates.cranks):
            yielding[crank] = complex(*pose[coordinates.crank(crank) :][:2])
        self.cranks, self.races = place.crank_axes + yielding, place.race_centres(at) + yielding
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


def _draw_loads(axes: Any, shown: _Position, largest: float) -> None:
    longest = 0.2 * float(shown.place.mean_eccentricity[0]) * shown.place.reduction_ratio + 12.0
    reach, labels = float(np.abs(shown.pins).max()), list[complex]()
    for centres, load, radii, towards in shown.loads:
        for centre, force, radius, direction in zip(centres, load, radii, towards, strict=True):
            contact = centre + radius * direction
            ends = np.array([contact - 0.6 * radius * direction, contact + 0.6 * radius * direction])
            axes.plot(ends.real, ends.imag, color=NORMAL, linewidth=0.7, zorder=6)
            if force > 1e-3 * largest:
                tip = contact + direction * longest * force / largest
                axes.annotate(
                    "",
                    xy=(tip.real, tip.imag),
                    xytext=(contact.real, contact.imag),
                    arrowprops={"arrowstyle": "-|>", "color": LOAD, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0},
                    zorder=7,
                )
                side = 1.0 if direction.real >= 0 else -1.0
                middle = tip + 0.06 * reach * side
                while any(_overlap(middle - other, reach) for other in labels):
                    middle += 0.04j * reach
                labels.append(middle)
                axes.text(
                    tip.real, middle.imag, f" {force:.0f} N", fontsize=6.5, color=LOAD, zorder=8,
                    ha="left" if side > 0.0 else "right", va="center",
                    path_effects=[patheffects.withStroke(linewidth=2.0, foreground="white", alpha=0.8)],
                )  # fmt: skip


def _overlap(distance: complex, reach: float) -> bool:
    """Tell whether labels with their middles at a distance cover each other, in a picture of some reach about its middle."""
    return abs(distance.real) < 0.13 * reach and abs(distance.imag) < 0.039 * reach
