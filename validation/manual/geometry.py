"""Geometry of flank, pins and crank: levers, gaps, backlash and what errors change, without any load."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.analysis.transmission_error_orders import Order, fit_orders
from ltca.arrays import FloatArray
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash, first_contact
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive, load_drive
from validation.manual.case import Case, Figure, Reference, absolute_figure, relative_figure
from validation.methods.unloaded import carrying_pins

ARCMIN = 180.0 * 60.0 / np.pi
ROUND_OFF = "round-off of sums of some 100 mm"


# Levers of an unmodified cycloid


def _levers() -> list[Figure]:
    drive = with_fields(
        load_drive("paper").cases["CS-1"], {"disc.equidistant_offset": 0.0, "disc.shifting_offset": 0.0}
    )
    geometry = ContactGeometry.of_drive(drive)
    e, z = drive.crank.eccentricity, drive.pin_wheel.number_of_pins
    angles = np.random.default_rng(1).uniform(-30.0, 30.0, 50)
    motion = geometry.flank(angles, np.zeros((50, 4)))
    contact = e * np.exp(1j * angles)[:, None] + geometry.profile.flank(motion.parameter)
    normal = geometry.profile.normal(motion.parameter)
    miss = (normal.conjugate() * (e * z * np.exp(1j * angles)[:, None] - contact)).imag

    def loaded(count: int) -> FloatArray:
        at = np.linspace(0.0, 2.0 * np.pi / 13.0, count, endpoint=False)
        lever = -geometry.flank(at, np.zeros((count, 4))).gradient[..., WHEEL_ANGLE]
        return np.where(carrying_pins(geometry, at), lever, 0.0)

    squares = (loaded(64) ** 2).sum(axis=1)
    largest = [float(np.mean(found.max(axis=1) / (found**2).sum(axis=1))) for found in (loaded(1000), loaded(2000))]
    scale = 4.0 / (e * z**2)
    return [
        absolute_figure(
            "largest distance of a contact normal from the pitch point", float(np.abs(miss).max()), 0.0, "mm", 1e-9,
            "round-off of sums of 88 mm with arguments z_P θ up to 400 rad", numerical_error=1e-10, numerical_origin=ROUND_OFF,
        ),
        relative_figure(
            "Σ l² of the loaded pins, mean over the mesh", float(squares.mean()), z * (e * z) ** 2 / 4.0, "mm²", 1e-9,
            "half of a smooth periodic sum: round-off", numerical_error=1e-10, numerical_origin=ROUND_OFF,
        ),
        absolute_figure(
            "largest load of equal springs by 4T/(e z_P²), mean over the mesh", largest[1] / scale, 0.992, "", 5e-4,
            "half a unit of the last printed digit", numerical_error=abs(largest[1] - largest[0]) / scale,
            numerical_origin="change from 1000 to 2000 crank angles", reference_error=5e-4,
        ),
    ]  # fmt: skip


# Cycloidal Studio

STUDIO_PINS, STUDIO_POINTS = 19, 8000
STUDIO_GAPS = (36.900, 35.000, 30.048, 23.972, 19.086, 17.135, 18.496, 22.196, 26.650, 29.702)
STUDIO_LEVERS = (0.0, 4.8127, 9.4941, 13.9148, 17.9482, 21.4680, 24.4501, 26.5754, 27.1840, 20.5572)
STUDIO_BACKLASH, STUDIO_LARGEST_BACKLASH = 5.2011, 5.2299


def studio_geometry() -> ContactGeometry:
    """Return the drive of Cycloidal Studio in our terms: θ is 0 in a root here, half a lobe from their θ' at a tip."""
    drive = build_drive({
        "crank": {"eccentricity": 1.5},
        "pin_wheel": {"number_of_pins": STUDIO_PINS, "pin_circle_radius": 34.0, "pin_radius": 2.5},
        "disc": {
            "number_of_teeth": 18, "thickness": 8.0, "equidistant_offset": 0.0254, "shifting_offset": 0.0,
            "profile_errors": {"orders": [18, 36], "cosine": [0.0034, -0.0081], "sine": [0.0, 0.0]},
        },
        "crank_bearing": {
            "inner_race_radius": 7.0, "outer_race_radius": 10.0, "number_of_rollers": 12, "roller_radius": 1.5,
            "roller_length": 8.0,
        },
        "pin_shaft": {
            "number_of_pins": 6, "pin_circle_radius": 19.0, "pin_radius": 2.5, "hole_radius": 4.0, "stiffness": 1e6
        },
        "load": {"torque": 50e3, "light_torque": 500.0},
    })  # fmt: skip
    return ContactGeometry.of_drive(drive)


def studio_crank_angle(psi: FloatArray) -> FloatArray:
    """Return φ_C at their crank angles.

    With the wheel held ψ puts the disc's centre at −e (cos ψ, sin ψ), so ψ + π = φ_C (1 − 1/19).
    """
    return (psi + np.pi) * STUDIO_PINS / 18.0


def gaps_and_levers_at_points(
    geometry: ContactGeometry, crank_angle: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return gaps (mm) and levers about the disc (mm) from the nearest of so many points of our flank, one of them at a tip.

    This is their search. Only points of the flank are ours; both arrays have the shape (positions, pins).
    """
    points = geometry.profile.flank(2.0 * np.pi * np.arange(count) / count + np.pi / 18.0)
    gaps, levers = [], []
    for angle in crank_angle:
        pins = geometry.placement.wheel_pin_centres * np.exp(1j * angle / STUDIO_PINS) - 1.5 * np.exp(1j * angle)
        nearest = points[[int(np.argmin(np.abs(points - pin))) for pin in pins]]
        gaps.append(np.abs(pins - nearest) - 2.5)
        levers.append((nearest.conj() * (pins - nearest) / np.abs(pins - nearest)).imag)
    return np.array(gaps), np.array(levers)


def small_turns(gap: FloatArray, lever: FloatArray) -> FloatArray:
    """Return the free turn of the disc both ways where gaps close in proportion, arc minutes, shape (positions,)."""
    ways = [np.min(np.where(way * lever > 1e-6, gap, np.inf) / np.abs(lever), axis=-1) for way in (1.0, -1.0)]
    return np.asarray((ways[0] + ways[1]) * ARCMIN)


def _studio() -> list[Figure]:
    geometry = studio_geometry()
    # 48 angles of the crank over a period, as theirs; the first is ψ = 0.
    angle = studio_crank_angle(np.linspace(0.0, 2.0 * np.pi / 18.0, 48, endpoint=False))
    gaps, levers = gaps_and_levers_at_points(geometry, angle, STUDIO_POINTS)
    found = geometry.flank(angle, np.zeros((48, 4)))
    exact_gaps, exact_levers = -found.approach, found.gradient[..., DISC_ROTATION]
    mirrored = [(number, pin) for number in range(10) for pin in sorted({number, -number % STUDIO_PINS})]
    figures = [
        _printed(f"gap at pin {pin}", 1e3 * gaps[0, pin], STUDIO_GAPS[number], "µm", 1e-3) for number, pin in mirrored
    ]
    figures += [
        _printed(f"lever of pin {pin} about the disc", abs(levers[0, pin]), STUDIO_LEVERS[number], "mm", 1e-4)
        for number, pin in mirrored
    ]
    turns, largest = small_turns(gaps, levers), small_turns(exact_gaps, exact_levers)
    figures += [
        _printed("backlash of the disc at ψ = 0", turns[0], STUDIO_BACKLASH, "′", 1e-4),
        _printed("largest backlash of the disc", turns.max(), STUDIO_LARGEST_BACKLASH, "′", 1e-4),
        absolute_figure(
            "largest amount by which the flank is nearer than its points", 1e3 * float((gaps - exact_gaps).max()), 0.0, "µm", 0.1,
            "half a step between points is 0.016 mm at the tips: s²/2 (1/r_P + 1/r), flank of 2 mm and more",
            numerical_error=1e-6, numerical_origin=ROUND_OFF,
        ),
        relative_figure(
            "largest backlash of the disc, from the flank itself", largest.max(), STUDIO_LARGEST_BACKLASH, "′", 1e-2,
            "levers of points are off by up to a hundredth", numerical_error=1e-9, numerical_origin=ROUND_OFF,
            reference_error=1e-5,
        ),
        relative_figure(
            "largest backlash of the disc, turned until pins touch",
            float(backlash(geometry, angle, DISC_ROTATION).max()) * ARCMIN,
            float(largest.max()), "′", 2.5e-3,
            "turned by 0.76 mrad pins also slide 0.02 mm along a flank that bends with 5 mm and more: 0.04 µm of 18 µm",
            numerical_error=1e-8, numerical_origin="tolerance of the search for first contact",
        ),
        relative_figure(
            "largest backlash at the wheel", float(backlash(geometry, angle, WHEEL_ANGLE).max()) * ARCMIN,
            STUDIO_LARGEST_BACKLASH * 18.0 / 19.0, "′", 1e-2, "levers of points, as above", numerical_error=1e-8,
            numerical_origin="tolerance of the search for first contact", reference_error=1e-5,
        ),
    ]  # fmt: skip
    return figures


def _printed(quantity: str, value: float, printed: float, unit: str, last: float) -> Figure:
    """A figure that must agree with a printed one to one unit of its last digit."""
    return absolute_figure(
        quantity, float(value), printed, unit, last, "one unit of the last printed digit",
        numerical_error=1e-6 * last, numerical_origin=ROUND_OFF, reference_error=0.5 * last,
    )  # fmt: skip


# Four errors of a pin

FOUR_BAR_PINS = 15
FOUR_BAR_ERRORS: dict[str, dict[str, Any]] = {
    "pin circle +0.025 mm": {"pin_wheel": {"pin_errors": {"radial": [0.025] * FOUR_BAR_PINS}}},
    "pin radius +0.011 mm": {"pin_wheel": {"pin_errors": {"diameter": [0.022] * FOUR_BAR_PINS}}},
    "eccentricity +0.008 mm": {"crank": {"eccentricity_error": 0.008}},
}
FOUR_BAR = {
    -60.0: (69.7255, 74.7059, (20.4598, 0.01681), (-11.0, -0.00904), (0.7078, 0.00058)),
    -90.0: (60.6330, 64.9639, (21.6546, 0.02046), (-11.0, -0.01039), (3.9978, 0.00378)),
    -120.0: (43.8671, 47.0005, (23.3089, 0.03044), (-11.0, -0.01437), (6.2343, 0.00814)),
}
"""By the direction of the disc's centre, °: levers about disc and wheel, mm; of each error the change of the gap, µm, and the
turn of the disc, °."""


def gap_and_levers_of_four_bar(error: str, direction: float) -> tuple[float, float, float]:
    """Return the gap of pin 0 without load, mm, and the levers of its normal about disc and wheel, mm.

    `error` is a key of `FOUR_BAR_ERRORS` or "" for none, `direction` that of the disc's centre from the wheel's axis, °.
    """
    plain: dict[str, Any] = {
        "crank": {"eccentricity": 5.0},
        "pin_wheel": {"number_of_pins": FOUR_BAR_PINS, "pin_circle_radius": 130.0, "pin_radius": 18.0},
        "disc": {"number_of_teeth": 14, "thickness": 20.0},
        "crank_bearing": {
            "inner_race_radius": 26.0, "outer_race_radius": 38.0, "number_of_rollers": 14, "roller_radius": 6.0,
            "roller_length": 20.0,
        },
        "pin_shaft": {
            "number_of_pins": 8, "pin_circle_radius": 72.0, "pin_radius": 10.0, "hole_radius": 15.0, "stiffness": 1e6
        },
        "load": {"torque": 500e3, "light_torque": 5e3},
    }  # fmt: skip
    table = {section: entries | FOUR_BAR_ERRORS.get(error, {}).get(section, {}) for section, entries in plain.items()}
    geometry = ContactGeometry.of_drive(build_drive(table))
    # In the frame of the pin shaft the direction φ is a crank at φ_C = φ z_P/z_C.
    found = geometry.flank(np.array([np.radians(direction) * FOUR_BAR_PINS / 14.0]), np.zeros((1, 4)))
    disc, wheel = found.gradient[0, 0, [DISC_ROTATION, WHEEL_ANGLE]]
    return float(-found.approach[0, 0]), float(disc), float(wheel)


def _four_bar() -> list[Figure]:
    second = (
        "half a unit of the last digit, and the second order, which the reference leaves out: an error moves the pin "
        "by up to 0.02 mm "
        "along a trochoid that bends with 30 mm and more, 0.02²/60 mm = 0.007 µm; of the turn 6e-6°"
    )
    figures = []
    for direction, (disc, wheel, *printed) in FOUR_BAR.items():
        gap, lever, other = gap_and_levers_of_four_bar("", direction)
        at = f"at −{-direction:g}°"
        figures += [
            absolute_figure(
                f"gap without errors {at}", 1e3 * gap, 0.0, "µm", 1e-6, "an unmodified flank: round-off of 130 mm",
                numerical_error=1e-7, numerical_origin=ROUND_OFF,
            ),
            _printed(f"lever about the disc {at}", abs(lever), disc, "mm", 1e-4),
            _printed(f"lever about the wheel {at}", abs(other), wheel, "mm", 1e-4),
        ]  # fmt: skip
        for error, (change, turn) in zip(FOUR_BAR_ERRORS, printed, strict=True):
            gap, *_ = gap_and_levers_of_four_bar(error, direction)
            figures += [
                absolute_figure(
                    f"change of the gap by {error}, {at}", 1e3 * gap, change, "µm", 7e-3, second,
                    numerical_error=1e-7, numerical_origin=ROUND_OFF, reference_error=5e-5,
                ),
                absolute_figure(
                    f"turn of the disc by {error}, {at}", float(np.degrees(gap / abs(lever))), turn, "°", 1.1e-5, second,
                    numerical_error=1e-10, numerical_origin=ROUND_OFF, reference_error=5e-6,
                ),
            ]  # fmt: skip
    return figures


# The paper's flank


def _by_fitted_offsets(coordinate: int) -> float:
    """What half a unit of the last digit of both fitted offsets makes of the mean backlash, arc minutes."""
    drive, angles = load_drive("paper").cases["CS-1"], 2.0 * np.pi * np.arange(90) / 90

    def mean(**offsets: float) -> float:
        changed = with_fields(drive, {f"disc.{name}": value for name, value in offsets.items()})
        return float(backlash(ContactGeometry.of_drive(changed), angles, coordinate).mean()) * ARCMIN

    plain = mean()
    return float(np.hypot(mean(equidistant_offset=0.155) - plain, mean(shifting_offset=0.095) - plain))


def _paper_flank() -> list[Figure]:
    geometry = ContactGeometry.of_drive(load_drive("paper").cases["CS-1"])
    angles = 2.0 * np.pi * np.arange(720) / 720
    gap = -geometry.flank(angles, np.zeros((720, 4))).approach
    disc, wheel = (backlash(geometry, angles, coordinate) * ARCMIN for coordinate in (DISC_ROTATION, WHEEL_ANGLE))
    # Steepest flank: Δr_P − ΔR_C cos ψ with sin ψ = e z_P/R_C.
    steepest = 0.15 - 0.09 * np.sqrt(1.0 - (56.0 / 88.0) ** 2)
    sampled = "change from 360 to 720 crank angles"
    read = "read in issue and notes as an interval; a backlash averaged otherwise or halved would miss it"
    return [
        absolute_figure(
            "smallest gap, Δr_P − ΔR_C at tip and root", 1e3 * float(gap.min()), 60.0, "µm", 0.01,
            "no pin stands exactly at a tip or root of 720 angles",
            numerical_error=max(1e3 * abs(float(gap.min() - gap[::2].min())), 1e-9),
            numerical_origin=sampled,
        ),
        absolute_figure(
            "largest gap, Δr_P − ΔR_C cos ψ on the flank", 1e3 * float(gap.max()), 1e3 * float(steepest), "µm", 0.4,
            "second order of the offsets, ΔR_C²/(2 · 10 mm)", numerical_error=1e3 * abs(float(gap.max() - gap[::2].max())),
            numerical_origin=sampled,
        ),
        absolute_figure(
            "mean backlash of the disc about its held centre", float(disc.mean()), 10.7, "′", 0.1, read,
            numerical_error=abs(float(disc.mean() - disc[::2].mean())), numerical_origin=sampled, reference_error=0.1,
            input_error=_by_fitted_offsets(DISC_ROTATION),
        ),
        absolute_figure(
            "mean backlash at the wheel", float(wheel.mean()), 9.95, "′", 0.15, read,
            numerical_error=abs(float(wheel.mean() - wheel[::2].mean())), numerical_origin=sampled, reference_error=0.15,
            input_error=_by_fitted_offsets(WHEEL_ANGLE),
        ),
        relative_figure(
            "backlash of the disc by that of the wheel", float(disc.mean() / wheel.mean()), 14.0 / 13.0, "", 2e-3,
            "levers e z_C and e z_P of the same gaps; second order in the turn of 3 mrad",
            numerical_error=1e-7, numerical_origin="tolerance of the search for first contact",
        ),
        absolute_figure(
            "radius at the roots, R_C + ΔR_C − e − r_P − Δr_P", geometry.profile.root_radius, 88.09 - 4.0 - 6.65, "mm", 1e-9,
            "round-off", numerical_error=1e-12, numerical_origin=ROUND_OFF,
        ),
        absolute_figure(
            "radius at the tips, R_C + ΔR_C + e − r_P − Δr_P", geometry.profile.tip_radius, 88.09 + 4.0 - 6.65, "mm", 1e-9,
            "round-off", numerical_error=1e-12, numerical_origin=ROUND_OFF,
        ),
    ]  # fmt: skip


# Runout of the flank

RUNOUT, RUNOUT_ANGLE = 0.002, 0.8
"""Amount, mm, and angle, rad, of the runout."""


def runout_error(positions: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what a runout adds to the rigid wheel angle, the same in closed form where one pin touches before and after, and
    the slant tan β of the touching normal, shape (positions,); differences of pins that change are not a number.
    """
    drive = load_drive("paper").cases["CS-1"]
    runout = with_fields(drive, {"disc.runout.amount": RUNOUT, "disc.runout.angle": RUNOUT_ANGLE})
    angles = np.linspace(0.0, 2.0 * np.pi, positions, endpoint=False)
    geometry = ContactGeometry.of_drive(drive)
    plain, pins = first_contact(geometry, angles, WHEEL_ANGLE, -1)
    moved, same = first_contact(ContactGeometry.of_drive(runout), angles, WHEEL_ANGLE, -1)
    pose = np.zeros((positions, 4))
    pose[:, WHEEL_ANGLE] = plain
    gradient = geometry.flank(angles, pose).gradient[np.arange(positions), pins]
    normal = (gradient[:, 0] + 1j * gradient[:, 1]) * np.exp(-1j * angles)
    slant = normal.real / normal.imag
    reach = RUNOUT / (4.0 * 14.0)
    closed = reach * (np.sin(RUNOUT_ANGLE - angles) + slant * np.cos(RUNOUT_ANGLE - angles))
    return moved - plain, np.where(pins == same, closed, np.nan), slant


def _runout() -> list[Figure]:
    reach, sizes = RUNOUT / (4.0 * 14.0), (260, 520)
    amplitudes, others, expected = [], [], []
    for positions in sizes:
        error, closed, slant = runout_error(positions)
        angles = np.linspace(0.0, 2.0 * np.pi, positions, endpoint=False)
        orders = tuple(Order(float(value), str(value)) for value in (1, 2, 3, 5, 11, 12, 13, 14, 15, 26))
        spectrum = fit_orders(angles, error, orders)
        expected.append(reach * abs(1.0 + 1j * float(np.mean(slant))))
        amplitudes.append(spectrum.of(1))
        others.append(max(spectrum.of(order) for order in (2, 3, 5, 11, 15)) / expected[-1])
    worst = int(np.nanargmax(np.abs(error - closed)))
    origin = "change from 260 to 520 crank angles"
    return [
        absolute_figure(
            "wheel angle by runout where one pin touches, worst angle", 1e6 * float(error[worst]), 1e6 * float(closed[worst]),
            "µrad", 3e-3 * 1e6 * reach, "second order in the runout, and the backlash's turn of the lever",
            numerical_error=1e-5, numerical_origin="tolerance of the search for first contact",
        ),
        relative_figure(
            "order 1 of the transmission error, ρ/(e u) |1 + i mean tan β|", 1e6 * amplitudes[1], 1e6 * expected[1], "µrad", 1e-2,
            "where another pin takes over is a few per cent of a tooth", numerical_error=abs(amplitudes[1] / amplitudes[0] - 1.0),
            numerical_origin=origin,
        ),
        absolute_figure(
            "largest of the orders 2, 3, 5, 11, 15 by order 1", others[1], 0.0, "", 0.02,
            "as above: teeth leave only sidebands z_C ± 1",
            numerical_error=abs(others[1] - others[0]), numerical_origin=origin,
        ),
    ]  # fmt: skip


CASES = (
    Case(
        name="cycloid_levers",
        title="Levers of an unmodified cycloid",
        problem="The paper's drive (14 pins on 88 mm, 13 lobes, e 4 mm) without offsets: contact normals, levers "
        "about the wheel's axis, and the "
        "load sharing of equal linear springs with the disc's centre held.",
        references=(
            Reference(
                source="Conjugate profiles: contact normals pass the pitch point, e z_P from the wheel's axis on the "
                "eccentric's side; with it "
                "∮ (p R sin β)²/(R² + p² − 2pR cos β) dβ/2π = p²/2, so Σ l² = z_P (e z_P)²/4 in the mean",
                uncertainty="None: closed forms.",
            ),
            Reference(
                source="Largest load 0.992 · 4T/(e z_P²), three digits, from the sum over 14 pins",
                uncertainty="Half a unit of the last digit, 5e-4.",
            ),
        ),
        model="`ltca.geometry.pairs.ContactGeometry`.",
        run=_levers,
    ),
    Case(
        name="cycloidal_studio",
        title="Cycloidal Studio: 19 pins and a harmonic flank",
        problem="18 lobes, 19 pins of radius 2.5 mm on 34 mm, e 1.5 mm; the flank is moved along its normal by "
        "−0.0254 − 0.0034 cos 18θ' − 0.0081 cos 36θ' mm: gaps and levers of all pins with the disc's centre on the "
        "eccentric, and the backlash "
        "of the disc with crank and wheel held.",
        references=(
            Reference(
                source="SHKinsem/cycloidal-studio (MIT), commit 52a00d1, optimizer/model.py, re-run: search over 8000 "
                "points of the flank",
                uncertainty="Printed to 0.001 µm, 0.0001 mm and 0.0001′. The nearest of 8000 points is up to 0.1 µm "
                "farther than the flank and "
                "its normal off by up to 1 %, the same in rows that search points of our flank.",
            ),
        ),
        model="Shapes and places of `ltca`; rows of printed digits search 8000 points of our flank as they do, the "
        "last four rows are "
        "those of `ltca.geometry` with the flank itself. Here θ = 0 is a root: equidistant offset 0.0254, harmonics "
        "+0.0034 and −0.0081; "
        "ψ = 0 is φ_C = 19π/18.",
        run=_studio,
    ),
    Case(
        name="four_errors_of_a_pin",
        title="Four errors of a pin",
        problem="15 pins of radius 18 mm on 130 mm, 14 lobes, e 5 mm; the pin at 0° with the disc's centre at −60, "
        "−90, −120°: change of the "
        "normal gap by errors of pin circle, pin radius and eccentricity, one at a time, and the turn of the disc "
        "that restores contact.",
        references=(
            Reference(
                source="Four-bar linkage from its instant centre, re-run: levers to 0.1 µm, gaps to 0.1 nm, turns to 1e-5°",
                uncertainty="Half a unit of the last digit; of the first order in the errors.",
            ),
        ),
        model="`pin_errors.radial`, half of `pin_errors.diameter`, `crank.eccentricity_error` of a drive file; gaps "
        "are exact.",
        model_uncertainty="The reference is linear in the errors: up to 0.007 µm.",
        run=_four_bar,
    ),
    Case(
        name="paper_flank",
        title="The paper's flank: gaps and backlash",
        problem="14 pins of radius 6.5 mm on 88 mm, e 4 mm, offsets Δr_P 0.15 and ΔR_C 0.09 mm: gaps of the unloaded "
        "drive and its backlash.",
        references=(
            Reference(
                source="*Contact characteristics of cycloid planetary gear drives considering backlashes and "
                "clearances*, section 4.1: about "
                "10 arc minutes of backlash; offsets fitted to it, 10.6 to 10.8′ at the disc and 9.8 to 10.1′ at the wheel",
                uncertainty="Half the width of these intervals.",
            ),
            Reference(
                source="Closed forms of gaps and radii, first order in the offsets", uncertainty="Second order, 0.4 µm."
            ),
        ),
        model="`ltca.geometry.first_contact.backlash` and `ltca.geometry.flank`.",
        input_uncertainty="The offsets are not printed but fitted to the printed backlash: half of their last digit, 5 µm.",
        run=_paper_flank,
    ),
    Case(
        name="runout_order",
        title="Runout of a flank is one order of the transmission error",
        problem="The paper's drive (CS-1) without load, its flank off the bore by 2 µm: rigid wheel angle over a turn "
        "and its orders.",
        references=(
            Reference(
                source="Closed form: δφ = ρ/(e u) (sin(α − φ) + tan β cos(α − φ)), β the slant of the touching "
                "normal; β repeats with the "
                "teeth, so order 1 has the amplitude ρ/(e u) |1 + i mean tan β|",
                uncertainty="First order in the runout.",
            ),
        ),
        model="`ltca.geometry.first_contact`, `ltca.analysis.transmission_error_orders`.",
        run=_runout,
    ),
)
