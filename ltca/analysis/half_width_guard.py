"""Where half-spaces and the parabolas of tables end: contacts wider than the bodies are curved are refused, by name.

A cylinder of radius r on a plane, solved with its true boundary (`ltca.testing.elastic_cylinder`), carries 0.1 % less than the
tables say at b/r = 0.1, 0.6 % at 0.2 and 1.5 % at 0.3; with the true separation, as ``direct`` takes it, these are 0.07, 0.36
and 0.98 %. A flank whose curvature changes within the contact leaves its parabola at far smaller b/r: there the loads of both
are compared.

Displacements of pins and supports are small ones, too: what bends or gives way has one stiffness, and bent pins press along the
normals of straight ones. Where a part yields by a tenth of the eccentricity, the length on which holes lead the disc and flanks
roll, directions change by a tenth of a radian; from there on it is told.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ltca.analysis.methods import load_method
from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.response import ContactPressures, DiscModel, Response, split_shifts
from ltca.drive.members.verdict_words import part_words
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_beam, wheel_pin_beam
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import BORNE
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError, DriveError, OverloadError
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates, X, Y
from ltca.geometry.interference import ROUNDING, drawn_interference
from ltca.geometry.rotation import unit
from ltca.geometry.separation import circle_departure
from ltca.laws.backed import own_flexibility

HALF_WIDTH_BOUND = 0.3
"""Largest contact half-width as a part of the smallest radius in contact: beyond it the bodies are no half-spaces
and the separation is no parabola."""
PARABOLA_DEPARTURE = 0.02
"""Departure from the parabola at the edge of a contact, as a part of it (squared where it leans to one side), below which
tables and true separation differ by less than 0.4 % of the load: 0.39 % was the most among 592 pins of thirty drives."""
LARGE_PARABOLA_DEPARTURE = 0.05
"""The same from which a warning is given where grids cannot check the loads, which then are off by some 1 %."""
LOAD_DIFFERENCE = 0.01
"""Difference of loads by tables and by grids, relative to the largest of their kind, from which a warning is given."""
SMALL_DISPLACEMENT = 0.1
"""Displacement of a pin, crank or wheel by what holds it, as a part of the eccentricity, from which a warning is given:
directions of forces change by about that angle, rad."""
STEEP_TILT = 5e-3
"""Tilt of a disc, rad, beyond which its square counts: among random reducers forces summed height by height leave up to 0.1 % of
the loads at 6 to 9 mrad (`ltca.testing.width_check`)."""
TURNED_NORMALS = 0.01
"""Part of the loads times half the width that moments about x and y may lack because normals turn along the width, from which a
warning is given: as much as slices leave of the moment of a contact (``docs/theory/width.md``)."""
PIN, OUTER, INNER = "wheel pin", "roller on the bore", "roller on the inner race"


def check_half_widths(
    drives: Sequence[Drive], contacts: Response, pressures: ContactPressures, torque: float | None = None
) -> None:
    """Refuse contacts wider than half-spaces stand for.

    Parameters
    ----------
    drives : sequence of Drive
        For the radii: the drives of the batch, often one; all have the same number of positions, drive by drive.
    contacts, pressures : Response, ContactPressures
        Of the solved positions.
    torque : float, optional
        Output torque, N·mm, for the message; that of the drive by default.

    Raises
    ------
    OverloadError
        One sentence for each kind of contact that is too wide, naming the widest.
    """
    each = pressures.pins.half_width.shape[0] // len(drives)
    pin_radius = np.repeat([drive.pin_wheel.pin_radius for drive in drives], each)[:, None]
    roller = np.repeat([drive.crank_bearing.roller_radius for drive in drives], each)[:, None]
    # 1/ρ = 1/r_pin + κ: the radius of a convex flank is a bound as well as the pin's; a concave one is wider than its pin.
    curvature = 1.0 / contacts.flank.effective_radius - 1.0 / pin_radius
    flank_radius = 1.0 / np.maximum(curvature, 1e-9)
    found: list[tuple[str, FloatArray, FloatArray]] = [
        (PIN, pressures.pins.widest, np.minimum(flank_radius, pin_radius)),
        (OUTER, pressures.outer.widest, roller),
        (INNER, pressures.inner.widest, roller),
    ]
    discs = drives[0].disc.number_of_discs  # that of all
    problems = []
    for name, half_width, radius in found:
        ratio = half_width / (HALF_WIDTH_BOUND * radius)
        if np.max(ratio) > 1.0:
            worst = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            bound = float(half_width[worst] / ratio[worst])
            disc, pair = divmod(int(worst[1]), ratio.shape[1] // discs)
            drive = drives[int(worst[0]) // each]
            place = part_words(drive, name, pair, ratio.shape[1] // discs, disc)
            own = drive.load.torque if torque is None else torque
            named = _cause(single_discs(drive)[disc], contacts, name, worst, own)
            problems.append(
                f"{named} cannot be carried: contact half-width {half_width[worst]:.4g} mm of {place}, must "
                f"be at most {bound:.4g} mm ({HALF_WIDTH_BOUND:g} of the smallest radius in contact)"
            )
    if problems:
        raise OverloadError(problems)


def _cause(drive: Drive, contacts: Response, name: str, worst: tuple[np.intp, ...], torque: float) -> str:
    """Field that presses a contact so wide: the fit where most of the approach was there before the load."""
    overlaps = drawn_interference(drive)
    if name == PIN:
        overlap, field, value = overlaps.pins, "disc.equidistant_offset", drive.disc.equidistant_offset
    else:
        overlap, field, value = overlaps.rollers, "crank_bearing.roller_radius", drive.crank_bearing.roller_radius
    if overlap > ROUNDING:
        approach = (
            contacts.flank.approach
            if name == PIN
            else contacts.rollers.inner_approach + contacts.rollers.outer_approach
        )
        if overlap > 0.5 * approach[worst]:
            return f"{field} = {value:g} mm: an overlap of {overlap:.4g} mm as drawn"
    return f"load.torque = {torque:g} N·mm"


def wide_holes_warning(drive: Drive, pressures: ContactPressures) -> str | None:
    """Return a warning where shaft pins touch their holes over more than a half-space stands for; None elsewhere.

    Their loads go through springs and hold; the pressures are those of bodies that are less curved. The verdict has the same
    half-width and bound in its row "half-width by radius", which fails then.
    """
    if drive.pin_shaft is None:
        return None
    radius, widest = drive.pin_shaft.pin_radius, float(np.nanmax(pressures.holes.widest))
    if widest <= HALF_WIDTH_BOUND * radius:
        return None
    return (
        f"shaft pins touch their holes over a half-width of {widest:.4g} mm, more than {HALF_WIDTH_BOUND:g} of their radius "
        f"(pin_shaft.pin_radius = {radius:g} mm): their pressures are not to be trusted, loads are"
    )


def unborne_warning(pressures: ContactPressures) -> str | None:
    """Return a warning where pressures are higher than any steel bears; None below."""
    kinds = (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    largest = max(float(np.nanmax(kind.mid)) for kind in kinds if kind.mid.size)
    if largest <= BORNE:
        return None
    return f"contacts are pressed with up to {largest:.4g} MPa, more than any steel bears (some {BORNE:g} MPa)"


def separation_warning(
    model: DiscModel, drive: Drive, balanced: Equilibrium, pressures: ContactPressures
) -> str | None:
    """Return a warning where tables and the true separation of the surfaces disagree; None elsewhere.

    The model of the disc, its drive, balanced positions and their pressures are those of one disc alone.
    """
    contacts = balanced.response
    largest = max(float(np.max(contacts.pin_load)), 1e-300)
    departure = _departures(model, contacts, pressures) * contacts.pin_load / largest
    row, _ = np.unravel_index(int(np.argmax(departure)), departure.shape)
    rollers = _roller_departure(drive, pressures)
    if max(departure[row].max(), rollers) < PARABOLA_DEPARTURE:
        return None
    angle, pose = balanced.crank_angle[row : row + 1], balanced.pose[row : row + 1]
    at = f"φ_C = {angle[0]:.4g} rad"
    if not drive.pins_are_fixed:
        most = max(float(departure[row].max()), rollers)
        name = "rollers" if most == rollers else f"{PIN} {int(np.argmax(departure[row]))}"
        told = f"at {at} the surfaces at {name} depart from the parabola of the tables by {100.0 * most:.2g} % at the edge of"
        more = "the contact: loads may be a percent off, or more (grids, which would say, know fixed pins alone)"
        return f"{told} {more}" if most >= LARGE_PARABOLA_DEPARTURE else None
    shifts = contacts.parts[0].shifts
    try:
        found = _on_grids(drive, angle, pose, None if shifts is None else shifts[row])
    except DriveError:  # an installation without the package of contact grids is not stopped by a warning
        return f"contacts are wider at {at} than parabolas stand for surely (grids, which would say, are not installed)"
    except ConvergenceError:
        return f"contacts are wider at {at} than the flank goes on: the parabola of the tables does not stand for it"
    worst, name = 0.0, ""
    for kind, tables, grids in (
        (PIN, contacts.pin_load[row], found.pin_load[0]),
        (OUTER, contacts.rollers.outer_load[row], found.rollers.outer_load[0]),
    ):
        difference = np.abs(tables - grids) / max(float(np.max(grids)), 1e-300)
        if np.max(difference) > worst:
            worst, name = (
                float(np.max(difference)),
                part_words(drive, kind, int(np.argmax(difference)), difference.size),
            )
    if worst < LOAD_DIFFERENCE:
        return None
    return (
        f"at {at} the load of {name} differs by {100.0 * worst:.2g} % of the largest between the parabola of the "
        "tables and the true separation, which is right: take --method direct"
    )


def _on_grids(drive: Drive, angle: FloatArray, pose: FloatArray, shifts: ComplexArray | None) -> Response:
    """Contacts on grids at one position of a drive of one disc, with its pins displaced, mm, shape (pairs,)."""
    grids = load_method("grids", "contacts = grids")(drive)
    if shifts is not None:
        place = grids.geometry.placement
        centres = place.wheel_pin_centres + shifts[: place.wheel_pin_radii.size]
        geometry = replace(grids.geometry, placement=replace(place, wheel_pin_centres=centres))
        grids = replace(grids, geometry=geometry)
    return Reducer(discs=(grids,)).respond(angle, pose)


def _departures(model: DiscModel, contacts: Response, pressures: ContactPressures) -> FloatArray:
    """Departure of pin and flank from their parabola at the edges of the contact, as `PARABOLA_DEPARTURE` counts it."""
    profile, flank, half_width = model.geometry.profile, contacts.flank, pressures.pins.half_width
    radius = np.broadcast_to(model.geometry.placement.wheel_pin_radii, half_width.shape)
    closed = half_width > 0.0
    theta, b = flank.parameter, np.where(closed, half_width, 1.0)
    origin, normal = profile.flank(theta), profile.normal(theta)
    sides = []
    for side in (1.0, -1.0):
        away = (profile.flank(theta + side * b / np.abs(profile.flank_tangent(theta))) - origin) * normal.conjugate()
        along = np.where(away.imag != 0.0, away.imag, 1.0)
        sides.append(-away.real * (b / along) ** 2)
    pin = b**2 / (radius + np.sqrt(np.maximum(radius**2 - b**2, 0.0)))
    parabola = b**2 / (2.0 * flank.effective_radius)
    even = (0.5 * (sides[0] + sides[1]) + pin) / parabola - 1.0
    odd = 0.5 * (sides[0] - sides[1]) / parabola
    return np.where(closed, np.maximum(np.abs(even), odd**2), 0.0)


def _roller_departure(drive: Drive, pressures: ContactPressures) -> float:
    """Largest departure of rollers and races, circles all of them, from their parabola at the edges of the contact."""
    radius, largest = drive.crank_bearing.roller_radius, 0.0
    for half_width, race in (
        (pressures.outer.half_width, -drive.bore_radius),
        (pressures.inner.half_width, drive.crank_bearing.inner_race_radius),
    ):
        b = np.array([np.max(half_width)])
        if b[0] > 0.0:
            apart = circle_departure(b, radius) + circle_departure(b, race)
            largest = max(largest, float(apart[0] / (0.5 * b[0] ** 2 * (1.0 / radius + 1.0 / race)) - 1.0))
    return largest


def pin_deflections(drive: Drive, model: Reducer, found: Equilibrium) -> dict[str, FloatArray]:
    """Return how far pins that are beams move at a disc under the forces of all discs, mm, shape (positions, pairs).

    Drive, model and balanced positions are those of one disc; keys are names of the dataset, none where no pins are beams.
    """
    contacts, geometry = found.response.parts[0], model.discs[0].geometry
    moved, by_tips = split_shifts(contacts.shifts, geometry), geometry.moved_by_ring(found.pose)
    others = moved[0]
    if others is not None:
        bent = others if contacts.ring is None else others - contacts.ring
        turned = geometry.placement.wheel_rotation(found.crank_angle) + found.pose[:, WHEEL_ANGLE]
        others = bent * unit(turned)[:, None]
    values: dict[str, FloatArray] = {}
    for name, beam, load, motion, beside in (
        ("pin_deflection", wheel_pin_beam(drive), contacts.pin_load, contacts.flank, (others, None)),
        ("shaft_pin_deflection", shaft_pin_beam(drive), contacts.hole_load, contacts.holes, (moved[1], by_tips)),
    ):
        if beam is not None:
            # The pin yields to its own disc against the direction in which it would be pressed in; in slices this is in its
            # displacement.
            flexibility = own_flexibility(drive, beam) if contacts.leans is None else 0.0
            own = flexibility * load * (motion.gradient[..., X] + 1j * motion.gradient[..., Y])
            values[name] = np.abs(sum((part for part in beside if part is not None), own))
    return values


def displacement_warning(eccentricity: float, moved: Mapping[str, tuple[str, FloatArray]]) -> str | None:
    """Return a warning where displacements are no longer small; None elsewhere.

    `moved` has, by what moves, the field that says how it yields and the displacements, mm, not a number where there is no
    answer; the eccentricity is in mm.
    """
    told = []
    for name, (field, values) in moved.items():
        most = float(np.nanmax(values)) if np.any(np.isfinite(values)) else 0.0
        if most > SMALL_DISPLACEMENT * eccentricity:
            told.append(f"{name} by {most:.3g} mm, {most / eccentricity:.2g} eccentricities ({field})")
    if not told:
        return None
    return (
        f"yielding is no small displacement: {'; '.join(told)}; from {SMALL_DISPLACEMENT:g} eccentricities "
        f"({SMALL_DISPLACEMENT * eccentricity:.3g} mm) on forces turn by a tenth of a radian and more, and the answer is rough"
    )


def moments_left_out(contacts: Response, half_width: float) -> FloatArray:
    """Return what moments about x and y lack because normals turn along the width, by the loads times half of it, by disc.

    Gaps are linear in tilts, δ + θ z. Of a pair that tilts across its normal this turns by κ s·λ with the height: to first order
    the forces know that, and the moments lack Σ q z² times it. Shape (positions, discs); zero in the plane.
    """
    found = [np.zeros(contacts.pin_load.shape[0])] * len(contacts.parts)
    for number, part in enumerate(contacts.parts):
        carried = part.pin_load.sum(axis=1) + part.hole_load.sum(axis=1)
        for pairs in (part.leaning_pins, part.leaning_holes):
            if pairs is not None:
                load = pairs.contact.slice_load
                size = 2.0 * half_width / load.shape[-1]
                height = size * (np.arange(load.shape[-1]) - 0.5 * (load.shape[-1] - 1))
                spread = load @ (height**2 + size**2 / 12.0)
                turned = np.hypot(pairs.tilt.gradient[..., X], pairs.tilt.gradient[..., Y])
                found[number] = found[number] + (spread * turned).sum(axis=1)
        found[number] = np.divide(found[number], carried * half_width, out=np.zeros(carried.shape), where=carried > 0.0)
    return np.stack(found, axis=1)


def steep_tilt_warning(coordinates: Coordinates, full: Equilibrium, half_width: float) -> str | None:
    """Return a warning where parts tilt by more than what is linear in tilts can tell; None elsewhere and in the plane.

    Poses are not a number where there is no answer; `half_width` is that of the discs, mm.
    """
    if not coordinates.leans:
        return None
    pose = full.pose
    lean = coordinates.own * np.arange(coordinates.discs)[:, None] + np.r_[coordinates.lean_place]
    tilts = np.hypot(pose[:, lean[:, 0]], pose[:, lean[:, 1]])
    most = float(np.nanmax(tilts)) if np.any(np.isfinite(tilts)) else 0.0
    lacks = moments_left_out(full.response, half_width)
    lack = float(np.nanmax(lacks)) if np.any(np.isfinite(lacks)) else 0.0
    told = []
    if most > STEEP_TILT:
        told.append(
            f"discs tilt by up to {1e3 * most:.3g} mrad: gaps and forces are linear in tilts, and from {1e3 * STEEP_TILT:g} mrad "
            "on what is of their square is more than a thousandth of the loads"
        )
    if lack > TURNED_NORMALS:
        told.append(
            "pins stand so askew beside roots or in holes that normals turn along the width: moments that tilt a disc lack up to "
            f"{100.0 * lack:.2g} % of its loads times half the width"
        )
    return "; ".join(told) or None
