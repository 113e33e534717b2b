"""Loads of whole drives: printed results, sharing among pins and discs, balance of power, RV reducers."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse
from ltca.analysis.reactions import mesh_forces
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import solve_equilibrium
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive, load_drive
from validation.levels.closed_forms import power_rows
from validation.levels.printed_results import compare_printed_results
from validation.manual.case import Case, Figure, Reference, absolute_figure, relative_figure
from validation.manual.error_bars import figures_by_size
from validation.rows import Row

BALANCED = "balanced to 1e-9 of the load"
TABLES = "tables of contact laws, 1e-4 of a load"


# Król


MOMENT = 23_250.0
"""Of Król's drive about the disc, N·mm: 1550 at the input, 15 lobes."""
VARIANTS = {
    1: (2.8, 3.5, 0.7, 10.0, 5.0, 30.0, 424.0),
    2: (1.5, 2.0, 0.65, 8.0, 3.0, 20.0, 855.0),
    3: (2.9, 3.4, 0.7, 10.0, 5.0, 30.0, 419.0),
    4: (3.0, 3.3, 0.7, 10.0, 5.0, 30.0, 415.0),
}
"""e, sleeve radius, shortening, thickness, output sleeve radius, output circle radius, mm; printed flank pressure, MPa."""
KROL_FORCES = {1: 138.4, 2: 258.3, 3: 133.6, 4: 129.2}
"""Largest pin force of each variant by their code, N."""


def krol_drive(variant: int, *, rigid: bool) -> Drive:
    """Return one variant, its bearing as good as rigid or a steel one that fits."""
    e, sleeve, shortening, thickness, output, circle, _ = VARIANTS[variant]
    bore, roller, count = (21.0, 1.0, 60) if circle == 30.0 else (14.0, 1.0, 38)
    if not rigid:
        bore, roller, count = (18.0, 3.0, 14) if circle == 30.0 else (11.0, 1.8, 14)
    steel = {"youngs_modulus": 200e3, "poisson_ratio": 0.3}
    stiff = {"youngs_modulus": 1e8, "poisson_ratio": 0.3} if rigid else steel
    return build_drive({
        "crank": {"eccentricity": e},
        "pin_wheel": {"number_of_pins": 16, "pin_circle_radius": 16.0 * e / shortening, "pin_radius": sleeve},
        "disc": {"number_of_teeth": 15, "thickness": thickness},
        "crank_bearing": {
            "inner_race_radius": bore - 2.0 * roller, "outer_race_radius": bore, "number_of_rollers": count,
            "roller_radius": roller, "roller_length": thickness,
        },
        "pin_shaft": {
            "number_of_pins": 8, "pin_circle_radius": circle, "pin_radius": output, "hole_radius": output + e,
            "stiffness": 1e8 if rigid else 1e6,
        },
        # The wheel turns here and is held there: 23 250 N·mm about the disc are z_P/z_C of it at the wheel.
        "load": {"torque": MOMENT * 16.0 / 15.0, "light_torque": 250.0},
        "materials": {"disc": steel, "wheel_pin": steel, "roller": stiff, "inner_race": stiff, "shaft_pin": steel},
    })  # fmt: skip


def krol_force(variant: int) -> float:
    """Return their largest pin force F = 4 M/(z_C z_P e), N."""
    return 4.0 * MOMENT / (15.0 * 16.0 * VARIANTS[variant][0])


def _largest_lever_force(variant: int, positions: int) -> float:
    """Largest load in proportion to our levers about the disc, N."""
    geometry = ContactGeometry.of_drive(krol_drive(variant, rigid=True))
    motion = geometry.flank(position_angles(positions), np.zeros((positions, 4)))
    lever = np.maximum(motion.gradient[..., DISC_ROTATION], 0.0)
    return float(np.max(MOMENT * lever / (lever**2).sum(axis=1)[:, None]))


def _largest_pressure(found: LoadedAnalysis) -> float:
    return float(np.max(found.pressures.pins.mid))


def _krol() -> list[Figure]:
    figures = []
    sampled = "change from 29 to 57 positions, and tables of contact laws, 1e-4"
    for variant, printed in VARIANTS.items():
        rigid, finer = (analyse(krol_drive(variant, rigid=True), position_angles(count)) for count in (29, 57))
        steel = analyse(krol_drive(variant, rigid=False), position_angles(29))
        response = rigid.full.response
        force, finer_force = (float(np.max(found.full.response.pin_load)) for found in (rigid, finer))
        levers = [_largest_lever_force(variant, count) for count in (97, 193)]
        moment = (response.pin_load * response.flank.gradient[..., DISC_ROTATION]).sum(axis=1)
        worst = float(moment[np.argmax(np.abs(moment - MOMENT))])
        pressure = _largest_pressure(rigid)
        position, pin = np.unravel_index(int(np.argmax(rigid.pressures.pins.mid)), response.pin_load.shape)
        line_load, radius = (
            response.pin_load[position, pin] / printed[3],
            response.flank.effective_radius[position, pin],
        )
        strip = float(0.5642 * np.sqrt(line_load / radius * 200e3 / (2.0 * (1.0 - 0.09))))
        geometry = ContactGeometry.of_drive(krol_drive(variant, rigid=True))
        play = max(
            float(np.abs(backlash(geometry, position_angles(29), way)).max()) for way in (DISC_ROTATION, WHEEL_ANGLE)
        )
        change = abs(_largest_pressure(finer) / pressure - 1.0) + 1e-4
        of = f"variant {variant}"
        figures += [
            absolute_figure(
                f"their force from their formula, {of}", krol_force(variant), KROL_FORCES[variant], "N", None,
                "shows that their formula is copied right: no result of this program", numerical_error=0.0,
                numerical_origin="a formula", reference_error=0.05,
            ),
            relative_figure(
                f"largest force in proportion to our levers, {of}", levers[1], krol_force(variant), "N", 0.012,
                "they replace Σl² of sixteen pins by its mean and the largest lever by e z_C",
                numerical_error=abs(levers[1] / levers[0] - 1.0), numerical_origin="change from 97 to 193 positions",
            ),
            relative_figure(
                f"largest pin load, {of}", force, krol_force(variant), "N", 0.04,
                "a line contact gets stiffer with its load and where the flank is hollow; they share by levers alone",
                numerical_error=abs(finer_force / force - 1.0) + 1e-4, numerical_origin=sampled,
            ),
            relative_figure(
                f"moment of all pins about the disc, {of}", worst, MOMENT, "N·mm", 2e-3,
                "the bearing lets the disc go by less than a thousandth of e", numerical_error=1e-9,
                numerical_origin=BALANCED,
            ),
            relative_figure(
                f"largest flank pressure, rigid bearing, {of}", pressure, printed[-1], "MPa", 0.07,
                "1 to 3 % less force, ends of finite length that take load from mid-width, the place of the largest "
                "F/ρ; the print is "
                "2 % below its own formula", numerical_error=change, numerical_origin=sampled, reference_error=0.024,
            ),
            relative_figure(
                f"the same against their formula at our load and place, {of}", pressure, strip, "MPa", 0.045,
                "unrelieved ends of a contact of finite length take load from mid-width, 7 % of it: the root of that",
                numerical_error=1e-4, numerical_origin=TABLES,
            ),
            absolute_figure(
                f"largest backlash of disc or wheel, {of}", play, 0.0, "rad", 1e-11, "an unmodified flank: round-off",
                numerical_error=1e-12, numerical_origin="round-off",
            ),
            relative_figure(
                f"largest flank pressure, steel bearing, {of}", _largest_pressure(steel), printed[-1], "MPa", 0.08,
                "a bearing that yields presses the pins beside the load as well, which they leave out",
                numerical_error=change, numerical_origin=sampled, reference_error=0.024,
            ),
        ]  # fmt: skip
    return figures


# The handbook


EQUIDISTANT, SHIFTING = 0.057238, 0.047238
"""Δr_rp of the handbook's drive, and its Δr_p with our sign, mm: radial gap 0.01."""
HANDBOOK_LOADS = (189.6, 273.0, 273.2, 239.3, 177.9, 90.4)
"""Of the pins from 22.5° on every 22.5°, N."""
HANDBOOK_LARGEST = 278.5


def handbook_drive() -> Drive:
    """Return the handbook's drive: sleeved pins of radius 2.5 that bend as bars of diameter 3 over 16 mm."""
    wheel = {
        "number_of_pins": 16, "pin_circle_radius": 25.5, "pin_radius": 2.5,
        "beam": {"span": 16.0, "ends": "supported", "diameter": 3.0},
    }  # fmt: skip
    disc = {
        "number_of_teeth": 15, "thickness": 4.5, "number_of_discs": 2, "planes": [-4.0, 4.0],
        "equidistant_offset": EQUIDISTANT, "shifting_offset": SHIFTING,
    }  # fmt: skip
    bearing = {
        "inner_race_radius": 7.0, "outer_race_radius": 8.0, "number_of_rollers": 44, "roller_radius": 0.5, "roller_length": 4.5
    }  # fmt: skip
    shaft = {
        "number_of_pins": 8, "pin_circle_radius": 15.5, "pin_radius": 2.0, "hole_radius": 2.9, "stiffness": 1e7
    }  # fmt: skip
    return build_drive({
        "installation": {"held": "pin-wheel"}, "crank": {"eccentricity": 0.9}, "pin_wheel": wheel, "disc": disc,
        "crank_bearing": bearing, "pin_shaft": shaft, "load": {"torque": 2.0 * 0.55 * 25_785.0, "light_torque": 500.0},
    })  # fmt: skip


def handbook_gaps() -> tuple[FloatArray, FloatArray]:
    """Return our gaps and theirs at 16 pins after a turn of the wheel, µm.

    Theirs is zero where the lever is longest, cos φ = K1: the wheel is turned by what closes the gap there.
    """
    geometry = ContactGeometry.of_drive(single_discs(handbook_drive())[0])
    ours = -geometry.flank(np.zeros(1), np.zeros((1, 4))).approach[0]
    angle, shortening = 2.0 * np.pi * np.arange(16) / 16, 0.9 * 16 / 25.5
    root = np.sqrt(1.0 - shortening**2)
    distance = np.sqrt(1.0 + shortening**2 - 2.0 * shortening * np.cos(angle))
    lever = np.sin(angle) / distance
    moved = 1.0 - shortening * np.cos(angle) - root * np.sin(angle)
    theirs = EQUIDISTANT * (1.0 - lever) - SHIFTING * moved / distance
    turn = np.linalg.lstsq(lever[:, None], ours - theirs, rcond=None)[0][0]
    return 1e3 * (ours - turn * lever), 1e3 * theirs


def _handbook() -> list[Figure]:
    ours, theirs = handbook_gaps()
    figures = [
        absolute_figure(
            f"gap at pin {pin} after a turn of the wheel", float(ours[pin]), float(theirs[pin]), "µm", 0.2,
            "second order of the offsets, ΔR²/2ρ", numerical_error=1e-6, numerical_origin="round-off of sums of some 100 mm",
        )
        for pin in range(16)
    ]  # fmt: skip
    rigid = {"materials.roller.youngs_modulus": 1e8, "materials.inner_race.youngs_modulus": 1e8}
    for name, changed, apart, reason in (
        (
            "bearing as good as rigid", rigid, 0.03,
            "the handbook takes approach in proportion to load, leaves out shear and spreads the load over half the span",
        ),
        (
            "steel bearing", {}, 0.10,
            "the disc gives way to its resultant, and load moves to pins that it approaches: no bearing yields in the "
            "handbook",
        ),
    ):  # fmt: skip
        load = analyse(with_fields(handbook_drive(), changed), np.zeros(1)).discs[0].full.response.pin_load[0]
        figures += [
            relative_figure(
                f"load of pin {pin}, {name}", float(load[pin]), printed, "N", apart, reason,
                numerical_error=1e-4, numerical_origin=TABLES, reference_error=0.05 / printed,
            )
            for pin, printed in enumerate(HANDBOOK_LOADS, start=1)
        ]  # fmt: skip
        if changed:
            figures.append(
                absolute_figure(
                    f"number of loaded pins, {name}", float(np.count_nonzero(load)), 6.0, "", 0.0, "a whole number",
                    numerical_error=0.0, numerical_origin="counted",
                )
            )  # fmt: skip
        figures.append(
            relative_figure(
                f"largest load, {name}", float(load.max()), HANDBOOK_LARGEST, "N", apart, reason,
                numerical_error=1e-4, numerical_origin=TABLES, reference_error=0.05 / HANDBOOK_LARGEST,
            )
        )  # fmt: skip
    return figures


# The paper's table


READING = {"%": 1.4, "°": 0.5, '"': 0.05, "'": 0.5, "times": 0.5}
"""Reading error of the print by unit: differences of two curves, each read to 1 %, ranges, and last digits."""
RESOLUTION = {"%": 0.02, "°": 1.0, '"': 0.05, "'": 1e-6, "times": 0.02, "pins": 1.0 / 360.0}
"""Least numerical error by unit: tables of contact laws, 1e-4 of a load and of a wind-up of 470″, and positions 1° apart."""


def reading_error(row: Row) -> float:
    """Return the error of a printed reference, in its unit: curves are read to 1 %, closed forms are exact."""
    if row.reference is None or "T/u" in row.reason or "T/(u e)" in row.reason:
        return 0.0
    return READING.get(row.unit, 0.01 * abs(row.reference))


def _paper_table() -> list[Figure]:
    return figures_by_size(
        compare_printed_results,
        (180, 360),
        "180, 360 positions over a turn; at least 1e-4 of a load or wind-up, of tables, and 1°, of positions",
        least_error=lambda row: RESOLUTION.get(row.unit, 1e-4 * abs(row.value)),
        reference_error=reading_error,
    )


# Power balance


def _power() -> list[Figure]:
    figures: list[Figure] = []
    for name, case in (("paper", "CS-1"), ("paper", "CS-6"), ("rv", "nominal")):
        drive = load_drive(name).cases[case]
        found = figures_by_size(partial(power_rows, drive), (60, 120), "60, 120 positions over a turn")
        figures += [replace(figure, quantity=f"{figure.quantity}, {name} {case}") for figure in found]
    return figures


# Torque shares


def _torque_share() -> list[Figure]:
    two = with_fields(load_drive("paper").cases["CS-3"], {"disc.number_of_discs": 2})
    angle, half = np.array([0.7]), 0.5 * two.wheel_moment()

    def wheel_angle(drive: Drive, moment: float) -> float:
        model = HalfSpace().prepare(drive).model
        return float(solve_equilibrium(model, angle, moment).pose[0, WHEEL_ANGLE])

    clean = single_discs(two)[0]
    stiffness = 0.02 * half / (wheel_angle(clean, 1.01 * half) - wheel_angle(clean, 0.99 * half))
    figures = [
        absolute_figure(
            "share of disc 0, two equal discs", float(analyse(two, angle).torque_share[0, 0]), 0.5, "", 1e-8,
            "symmetry: half a turn apart with even numbers of pins and holes", numerical_error=1e-9, numerical_origin=BALANCED,
        )
    ]  # fmt: skip
    for name, field in (
        ("runout of disc 0 of 0.2 µm", "disc.of.0.runout.amount"),
        ("phase error of eccentric 0 of 0.2 mrad", "crank.of.0.phase_error"),
        ("eccentricity error of eccentric 0 of 0.2 µm", "crank.of.0.eccentricity_error"),
    ):
        found, expected = [], []
        for size in (1e-4, 2e-4):
            wrong = with_fields(two, {field: size})
            found.append(float(analyse(wrong, angle).torque_share[0, 0]) - 0.5)
            alone = [wheel_angle(one, half) for one in single_discs(wrong)]
            expected.append(stiffness * (alone[1] - alone[0]) / (4.0 * half))
        figures.append(
            relative_figure(
                f"share of disc 0 less a half, {name}", found[1], expected[1], "", 0.02,
                "springs hold in the limit of small errors: 0.2 µm against a wind-up of 10 µm is a few per cent of "
                "second order",
                numerical_error=1e-8 / abs(expected[1]), numerical_origin=BALANCED,
                reference_error=abs(expected[1] - 2.0 * expected[0]) / abs(expected[1]),
            )
        )  # fmt: skip
    return figures


# RV


def _rv() -> list[Figure]:
    rv = load_drive("rv").cases["nominal"]
    ratio = 1.0 + 2.0 * 40.0
    coarse, found = (analyse(rv, position_angles(count)) for count in (12, 24))
    torque = rv.load.torque
    mean, before = (float(np.mean(one.full.wheel_moment)) / torque for one in (found, coarse))
    error = found.transmission_error + (ratio - 1.0) / ratio * found.full.pose[:, WHEEL_ANGLE]
    cranks = found.model.crank_moments(found.full.crank_angle, found.full.pose, found.full.response.parts).sum(axis=1)
    # The pinions of the cranks, z₂ = i₁ z₁, give the sun their moments over i₁, turning the other way.
    balance = (found.full.wheel_moment - cranks / 2.0 + torque) / torque
    in_carrier = replace(rv, installation=replace(rv.installation, first_stage_ratio=None))
    carried = analyse(in_carrier, np.array([0.31, 1.7, 4.4]))
    of_carrier = carried.transmission_error + carried.full.pose[:, WHEEL_ANGLE]
    moments = -carried.full.wheel_moment / torque
    return [
        absolute_figure(
            "transmission ratio −z_P with the cranks turned in the carrier", in_carrier.transmission_ratio, -40.0, "", 0.0,
            "whole numbers", numerical_error=0.0, numerical_origin="whole numbers",
        ),
        relative_figure(
            "moment on the wheel by output torque then, worst position",
            float(moments[np.argmax(np.abs(moments - 1.0))]), 1.0, "", 1e-8,
            "balanced to 1e-9 of a load", numerical_error=1e-9, numerical_origin=BALANCED,
        ),
        absolute_figure(
            "transmission error + w then, worst position", float(of_carrier[np.argmax(np.abs(of_carrier))]), 0.0, "rad", 1e-15,
            "kinematics: round-off of 1e-4 rad", numerical_error=1e-16, numerical_origin="round-off",
        ),
        absolute_figure(
            "transmission ratio 1 + i₁ z_P", rv.transmission_ratio, ratio, "", 0.0, "whole numbers", numerical_error=0.0,
            numerical_origin="whole numbers",
        ),
        relative_figure(
            "mean moment on the wheel by output torque", -mean, (ratio - 1.0) / ratio, "", 2e-4,
            "power balance in the mean: 24 positions are no whole period of rollers and cage",
            numerical_error=abs(mean / before - 1.0), numerical_origin="change from 12 to 24 positions",
        ),
        absolute_figure(
            "transmission error + w (i − 1)/i, worst position", float(error[np.argmax(np.abs(error))]), 0.0, "rad", 1e-15,
            "kinematics: round-off of 1e-4 rad", numerical_error=1e-16, numerical_origin="round-off",
        ),
        absolute_figure(
            "balance of moments by the teeth of cranks and sun, worst position", float(balance[np.argmax(np.abs(balance))]), 0.0,
            "of the torque", 1e-8, "balanced to 1e-9 of a load", numerical_error=1e-9, numerical_origin=BALANCED,
        ),
    ]  # fmt: skip


def _first_stage() -> list[Figure]:
    rv = load_drive("rv").cases["nominal"]
    drive = with_fields(
        rv,
        {
            "first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.plane": -30.0,
            "first_stage.pressure_angle": "20 deg", "first_stage.helix_angle": "10 deg", "first_stage.backlash": 0.03,
            "first_stage.mesh_stiffness": 3e5,
        },
    )  # fmt: skip
    found = analyse(drive, np.array([0.31]))
    forces, moments = mesh_forces(found), found.crank_torques[0]
    assert forces is not None
    tangential = 2.0 * moments / 56.0
    alpha, beta = np.radians(20.0), np.radians(10.0)
    figures = []
    for crank in range(3):
        for name, value, reference in (
            ("tangential", forces.tangential[0, crank], tangential[crank]),
            ("radial", forces.radial[0, crank], tangential[crank] * np.tan(alpha) / np.cos(beta)),
            ("axial", forces.axial[0, crank], -tangential[crank] * np.tan(beta)),
        ):
            figures.append(
                relative_figure(
                    f"{name} force of the teeth on crank {crank}", float(value), float(reference), "N", 1e-9,
                    "the same formula in other hands: round-off", numerical_error=1e-12, numerical_origin="round-off",
                )
            )  # fmt: skip
    return figures


CASES = (
    Case(
        name="paper_table",
        title="The paper's drive: six cases of clearance",
        problem="The paper's drive with six combinations of bearing and pin-hole clearance at 377.3 N·m: loads, "
        "pressures, ranges of contact and "
        "transmission error over a turn.",
        references=(
            Reference(
                source="*Contact characteristics of cycloid planetary gear drives considering backlashes and "
                "clearances*, Figs. 23 to 35 and "
                "Table 2; T/(u e) and (T − T/u)/R_PS",
                uncertainty="Curves are read from the print to about 1 %, differences of curves to 1.4 %, ranges to 0.5°.",
            ),
        ),
        model="LTCA with half-space compliance (`validation.levels.printed_results`), 360 positions.",
        input_uncertainty="Offsets of the flank are fitted to the printed backlash; materials are assumed to be steel "
        "(E 206 000 MPa).",
        model_uncertainty="The print plots the transmission error at 10 N·m; its absolute values at full torque "
        "inform only "
        "(docs/validation/paper.md).",
        run=_paper_table,
        long=True,
    ),
    Case(
        name="krol",
        title="Król's drive: an unmodified flank without clearance",
        problem="15 lobes, 16 sleeves on the wheel, four variants of size; 23 250 N·mm about the disc, E 200 000 MPa: "
        "largest load and pressure "
        "of a wheel sleeve.",
        references=(
            Reference(
                source="Król, Wikło, Olejarczyk, Kołodziejczyk, Zieja, *Mechanisms and Machine Science* 73 (2019) "
                "1039–1048, code DOI "
                "10.5281/zenodo.2166718 (re-run): F = 4 M/(z_C z_P e), σ = 0.5642 √(F/h (1/ρ + 1/q) E/(2(1 − ν²)))",
                uncertainty="Forces to 0.05 N; printed pressures are up to 2.4 % below those of their own code.",
            ),
        ),
        model="LTCA with half-space compliance, the pin shaft held, the crank bearing as good as rigid (their model "
        "has none) and one of "
        "steel that fits.",
        input_uncertainty="The crank bearing is not printed. Holes exceed sleeve and eccentricity by up to 0.5 mm, "
        "here they fit: an "
        "unmodified flank shares its load alike whatever the disc turns.",
        model_uncertainty="They share the load by levers alone and take a plane strip for the pressure. Output "
        "sleeves are not "
        "compared: what cos α is in their force does not follow from what is printed.",
        run=_krol,
    ),
    Case(
        name="handbook",
        title="The handbook method: sleeved pins that bend",
        problem="16 pins, 15 lobes, radial gap 0.01 mm by Δr_P 0.057238 and ΔR_C 0.047238 mm; 14.18 N·m on one disc: "
        "gaps and loads of the pins.",
        references=(
            Reference(
                source="Li Lixing, Guan Tianmin (Chinese handbook method), also patent CN105404737A, re-run; gaps "
                "Δr_rp (1 − sin φ/S) + "
                "Δr_p (1 − K₁ cos φ − √(1 − K₁²) sin φ)/S",
                uncertainty="Loads to 0.05 N; gaps of first order in the offsets.",
            ),
        ),
        model="LTCA with half-space compliance and `pin_wheel.beam`, pin wheel held; the bearing as good as rigid, "
        "and of steel.",
        input_uncertainty="Bearing and pin shaft are not printed.",
        model_uncertainty="The handbook turns a rigid disc about its centre and takes approach in proportion to load.",
        run=_handbook,
    ),
    Case(
        name="power_balance",
        title="Balance of power: mean tangential bearing load",
        problem="Over a turn the bearing of a disc carries T/(u e) across the eccentric in the mean, whatever the "
        "clearances; of several cranks "
        "the sum.",
        references=(
            Reference(
                source="Virtual work over a whole turn",
                uncertainty="Exact over whole periods of rollers and cage; one turn leaves 0.005 % for the paper's drive.",
            ),
        ),
        model="LTCA with half-space compliance: paper's CS-1 and CS-6, the shipped RV reducer.",
        run=_power,
    ),
    Case(
        name="torque_share",
        title="Torque share of two discs with small errors",
        problem="The paper's drive (CS-3) with two discs; one of them has an error: how the torque divides at φ_C = 0.7.",
        references=(
            Reference(
                source="Two springs: T₀ − T₁ = K (w₁ − w₀), w the wheel angle of each disc alone at half the torque, "
                "K its stiffness there",
                uncertainty="Of first order in the error; the figure's reference error is the change of the springs' "
                "answer from half the error.",
            ),
        ),
        model="LTCA with half-space compliance of both discs on one wheel.",
        run=_torque_share,
    ),
    Case(
        name="rv_reducer",
        title="RV reducer: ratio, moments, transmission error",
        problem="The shipped RV reducer (three cranks, i₁ = 2, 40 pins): ratio, moment on the wheel, transmission "
        "error, balance of the sun; and with its cranks turned in "
        "the carrier.",
        references=(
            Reference(
                source="Kinematics and power: i = 1 + i₁ z_P, |T_wheel| = T_out (i − 1)/i in the mean, TE = −w (i − "
                "1)/i; with the cranks turned "
                "in the carrier i = −z_P, |T_wheel| = T_out at every position, TE = −w",
                uncertainty="None.",
            ),
        ),
        model="LTCA with half-space compliance, 24 positions.",
        run=_rv,
    ),
    Case(
        name="first_stage_teeth",
        title="Forces of the first stage's teeth",
        problem="Planets of 40 teeth on a sun of 20 in a circle of 42 mm, α 20°, β 10°: tangential, radial and axial "
        "force on every crank.",
        references=(
            Reference(
                source="F_t = 2T/d, F_r = F_t tan α_n/cos β, F_a = −F_t tan β, d = 56 mm (ISO 21771)",
                uncertainty="None.",
            ),
        ),
        model="LTCA of the shipped RV reducer with `[first_stage]`; the moments of the cranks are those found.",
        run=_first_stage,
    ),
)
