"""Files and words of a disc of solid bodies: ``summary.json``, ``fem.nc``, table and page.

Names, units and dimensions are those of ``fem.nc`` of the plane and of ``results.nc``; pressures are listed vertex by vertex,
over the arc and the width of every contact that carries.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.model import ContactPair
from fem.reducer.solution_files import ARRAYS
from fem.solid_drive.solved_disc import SolidSolution
from fem.solid_drive.width_results import WidthResult, bore_motion, roller_leans
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCSEC
from ltca.geometry.placement import place_coordinates
from ltca.output.files import whole_file, write_json
from ltca.output.labelled import LabelledDataset
from ltca.output.netcdf import write_netcdf
from ltca.output.provenance import code_hash, code_version
from ltca.page.study_page import Curves, Section, StudyPage
from ltca.page.tables import Cell, Table, minus, number, texts, word
from ltca.quantities import QUANTITIES, SCHEMA_VERSION
from ltca.reading.writing import drive_text

FILES = ("fem.nc", "summary.json")
LARGEST: dict[PairKind, str] = {
    "pin": "pin_pressure_max",
    "roller_outer": "roller_pressure_max_outer",
    "roller_inner": "roller_pressure_max_inner",
    "hole": "pin_shaft_pressure_max",
}
"""Names of the largest pressure anywhere along the width, by kinds of contacts."""


def carrying(solution: SolidSolution) -> Iterator[tuple[ContactPair, WidthResult, float, float]]:
    """Yield every contact that carries: pair, along the width, pressure (MPa) and half-width (mm) at mid-width."""
    for pair, along, detail in zip(solution.model.pairs, solution.along_width, solution.contacts.details, strict=True):
        if along.load > 0.0:
            yield pair, along, detail.peak_pressure, detail.half_width


def numbers_of(solution: SolidSolution) -> dict[str, Any]:
    """Return the results by their names in `ltca.quantities`."""
    model, pose, contacts = solution.model, solution.pose, solution.contacts
    shift, rotation = bore_motion(model, solution.state)
    radial, tangential = solution.bearing_components
    lean, couple = solution.bore_lean, solution.bearing_couple
    found: dict[str, Any] = {name: getattr(contacts, name) for name in ARRAYS}
    for kind, name in LARGEST.items():
        largest = np.zeros(getattr(contacts, CONTACT_KINDS[kind].load).size)
        for pair, along in zip(model.pairs, solution.along_width, strict=True):
            if pair.kind == kind:
                largest[pair.index] = along.largest.max()
        found[name] = largest
    return found | {
        "wheel_angle": pose.wheel_angle,
        "transmission_error": solution.transmission_error,
        "wheel_moment": solution.state.wheel_moment,
        "disc_torque": solution.state.wheel_moment,
        "disc_x": shift.real,
        "disc_y": shift.imag,
        "disc_rotation": rotation,
        "disc_area_x": pose.disc_x,
        "disc_area_y": pose.disc_y,
        "disc_area_rotation": pose.disc_rotation,
        # As rotations about x and y.
        "disc_tilt": [-lean.imag, lean.real],
        "crank_bearing_moment": [-couple.imag, couple.real],
        "bearing_radial": radial,
        "bearing_tangential": tangential,
        "equilibrium_residual": contacts.equilibrium_residual,
    }


def summarise_solid(solution: SolidSolution) -> dict[str, Any]:
    """Return the content of ``summary.json``: numbers, and lists of full length by part, zeros included."""
    content: dict[str, Any] = {QUANTITIES["crank_angle"].fem_key: solution.model.crank_angle}
    for name, value in numbers_of(solution).items():
        content[QUANTITIES[name].fem_key] = np.asarray(value, dtype=float).tolist()
    names = [CONTACT_KINDS[pair.kind].name_of(pair.index, solution.model.placement) for pair in solution.model.pairs]
    content["contacts"] = {
        name: {"load_N": own.load, "moment_N_mm": own.moment, "face_load_factor": own.load_factor}
        for name, own in zip(names, solution.along_width, strict=True)
        if own.load > 0.0
    }
    # In the plane of ray and axis; 0 of rollers that are no candidates.
    leans = np.zeros(solution.model.placement.roller_radii.size)
    leans[list(solution.model.rollers)] = roller_leans(solution.model, solution.state)
    return content | {
        "bodies": "solid",
        "roller_lean_rad": leans.tolist(),
        "disc_volume_tilt_rad": [-solution.disc_lean.imag, solution.disc_lean.real],
        "strain_energy_N_mm": solution.strain_energy,
        "pose_iterations": solution.state.iterations,
        "dof": solution.model.solid_unknowns,
        "size": solution.options.size,
        "layers": solution.options.layers,
        "held": solution.drive.installation.held,
        "fingerprint": solution.drive.fingerprint(),
        "seconds": solution.seconds["total"],
        "seconds_by_stage": {stage: value for stage, value in solution.seconds.items() if stage != "total"},
    }


def label_solid(solution: SolidSolution, case: str) -> LabelledDataset:
    """Return the solution as a labelled dataset, with the pressure of every contact that carries over arc and width."""
    model, sizes = solution.model, {"case": 1, "disc": 1, "crank": 1, "position": 1, "axis": 2}
    data: dict[str, Any] = {}
    for name, value in numbers_of(solution).items():
        quantity = QUANTITIES[name]
        shape = [sizes.get(dimension, -1) for dimension in quantity.dimensions]
        data[name] = quantity.labelled(np.asarray(value, dtype=float).reshape(shape), in_fem=True)
    heights, listed = _pressures(solution)
    data |= {name: QUANTITIES[name].labelled(values) for name, values in listed.items()}
    told = {"units": "mm", "long_name": "height above mid-width"}
    data["pressure_height"] = QUANTITIES["pressure_place"].dimensions, heights, told
    coordinates = place_coordinates({case: solution.drive}, [[model.placement]], np.atleast_1d(model.crank_angle)) | {
        "torque": QUANTITIES["torque"].labelled([solution.torque], in_fem=True)
    }
    attributes = {
        "Conventions": "CF-1.11",
        "schema_version": SCHEMA_VERSION,
        "title": f"full finite-element solution of {solution.drive.name} with solid bodies",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca", "fem"),
        "drive": solution.drive.name,
        "drive_file": drive_text(solution.drive),
        "fingerprint": solution.drive.fingerprint(),
        "held": solution.drive.installation.held,
        "model": "finite elements, solid bodies",
        "elastic_shaft_pins": int(bool(model.meshes.shaft_pins)),
        "size": solution.options.size,
        "layers": solution.options.layers,
        "unknowns": model.solid_unknowns,
    }
    return LabelledDataset.build(data, coordinates, attributes)


def _pressures(solution: SolidSolution) -> tuple[FloatArray, dict[str, Any]]:
    """Heights of all vertices of the contacts that carry, mm; and their pressures, with their places on the arc."""
    kinds, parts, places, heights, values = [], [], [], [], []
    middles = {
        id(pair): detail.middle for pair, detail in zip(solution.model.pairs, solution.contacts.details, strict=True)
    }
    for pair, along, _, _ in carrying(solution):
        arc, count = pair.zone.arc - middles[id(pair)], along.pressure.size
        kinds.append(np.full(count, pair.kind))
        parts.append(np.full(count, pair.index))
        places.append(np.repeat(arc, along.heights.size))
        heights.append(np.tile(along.heights, arc.size))
        values.append(along.pressure.ravel())
    number = sum(each.size for each in values)
    return np.concatenate(heights), {
        "pressure_contact": np.concatenate(kinds).astype(str),
        "pressure_disc": np.zeros(number, dtype=int),
        "pressure_part": np.concatenate(parts),
        "pressure_place": np.concatenate(places),
        "pressure": np.concatenate(values),
    }


def write_solid(solution: SolidSolution, case: str, folder: Path) -> None:
    """Write the files of a solution into a folder, each when it is complete."""
    with whole_file(folder / "fem.nc") as part:
        write_netcdf(label_solid(solution, case), part)
    write_json(folder / "summary.json", summarise_solid(solution))


def tabulate_solid(solution: SolidSolution) -> Iterator[str]:
    """Yield the table that is printed, line by line."""
    yield (
        f"{'contact':<18}{'load, N':>10}{'moment, N·mm':>14}{'K_Hβ':>8}{'mid, MPa':>10}{'most, MPa':>11}"
        f"{'half-width, µm':>16}"
    )
    for pair, along, peak, width in carrying(solution):
        name = CONTACT_KINDS[pair.kind].name_of(pair.index, solution.model.placement)
        yield (
            f"{name:<18}{along.load:>10.1f}{along.moment:>14.1f}{along.load_factor:>8.3f}{peak:>10.1f}"
            f"{along.largest.max():>11.1f}{1e3 * width:>16.1f}"
        )
    for title, value in _facts(solution):
        yield f"{title} {value}"


def _facts(solution: SolidSolution) -> Iterator[tuple[str, str]]:
    """Titles and words of what a solution has besides its contacts."""
    radial, tangential = solution.bearing_components
    couple, lean, volume = solution.bearing_couple, solution.bore_lean, solution.disc_lean
    yield "bearing force on the disc:", f"radial {radial:.1f} N, tangential {tangential:.1f} N"
    if solution.model.widths.even:
        yield "along the width:", "all is even, nothing tilts"
    else:
        yield "bearing moment on the disc:", f"about x {-couple.imag:.1f} N·mm, about y {couple.real:.1f} N·mm"
        yield "tilt of the disc at its bore:", f"about x {-lean.imag:.6g} rad, about y {lean.real:.6g} rad"
        yield "tilt of the disc, volume mean:", f"about x {-volume.imag:.6g} rad, about y {volume.real:.6g} rad"
        if (play := solution.drive.disc.axial_play) is not None:
            taken = 2.0 * abs(lean) * solution.model.shapes.disc.flank.profile.tip_radius / play
            yield "axial play taken at the rim:", f"{100.0 * taken:.3g} % of {play:g} mm"
    yield "moment on the wheel:", f"{solution.state.wheel_moment / 1e3:.6g} N·m"
    angle = solution.pose.wheel_angle
    yield "wheel angle:", f"{angle:.6g} rad = {angle * ARCSEC:.6g}″"
    yield "strain energy:", f"{solution.strain_energy:.6g} N·mm"
    yield "largest unbalanced force:", f"{solution.contacts.equilibrium_residual:.1e} N"
    options = solution.options
    yield (
        "meshes:",
        f"{8.0 / options.size:.3g} elements for a half-width, {options.layers} layers over half of the width",
    )
    yield "unknowns:", f"{solution.model.solid_unknowns:,}"


def page_of_solid(solution: SolidSolution, case: str, told: str, text: str) -> StudyPage:
    """Return the page of a solution: contacts, line loads along the width, the drive."""
    columns = [
        "contact",
        "load, N",
        "moment, N·mm",
        "K_Hβ",
        "pressure at mid-width, MPa",
        "largest, MPa",
        "half-width, µm",
    ]
    rows: list[list[Cell]] = []
    lines: dict[str, tuple[FloatArray, dict[str, FloatArray]]] = {}
    for pair, along, peak, width in carrying(solution):
        kind = CONTACT_KINDS[pair.kind]
        cells = [(along.load, "{:.1f}"), (along.moment, "{:.1f}"), (along.load_factor, "{:.3f}"), (peak, "{:.1f}")]
        cells += [(float(along.largest.max()), "{:.1f}"), (1e3 * width, "{:.1f}")]
        title = kind.title_of(pair.index, solution.model.placement)
        rows.append([word(title), *(number(value, form) for value, form in cells)])
        group = {"pin": "wheel pins on the flank", "hole": "shaft pins in their holes"}.get(pair.kind)
        group = group or ("rollers in the bore" if pair.kind == "roller_outer" else "rollers on the race")
        name = kind.name_of(pair.index, solution.model.placement)
        lines.setdefault(group, (along.heights, {}))[1][name] = along.line_load
    curves = [
        Curves(title=f"line load of {group}", unit="N/mm", axis="height above mid-width, mm", x=heights, lines=own)
        for group, (heights, own) in lines.items()
    ]
    facts = [("crank angle", f"{degrees(solution.model.crank_angle):.6g}°")]
    facts += [(title.rstrip(":"), minus(value)) for title, value in _facts(solution)]
    sections = [
        Section(heading="Contacts", tables=[Table(name="contacts", caption="", columns=columns, rows=rows)]),
        Section(heading="Along the width", curves=curves),
        Section(
            heading="The drive",
            tables=[Table(name="drive", caption="", columns=["", "value"], rows=texts(facts), words=1)],
        ),
    ]
    return StudyPage(name=solution.drive.name, told=told, sections=sections, text=text)
