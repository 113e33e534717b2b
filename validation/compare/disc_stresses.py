"""Stress in the disc by full finite elements and by each compliance model, and the differences.

- Along the walls models are compared at their stress stations, where they are clear: farther than four half-widths from
  every loaded contact on the wall. A difference is relative to the largest stress of the reference at any such station.
- **Largest tensile stresses** of roots, bores and holes likewise, relative to the same largest stress.
- **Shear stress** below contacts is compared, relative to the reference, where a contact carries over 5 % of the largest
  load of its kind. The model's is Hertz' with what the disc carries along the wall at the contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from fem.drive.disc_stress import DiscStress
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray
from ltca.compliance.wall_stress import wall_profiles, wall_stresses
from ltca.contact.subsurface import line_contact_shear
from validation.compare.comparison import Kind, worst
from validation.compare.model_positions import answers_of

Region = Literal["flank", "bore", "holes"]
REGIONS: tuple[Region, ...] = get_args(Region)
SHEARED: tuple[Kind, ...] = ("pin", "roller_outer", "hole")


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscStressAnswer:
    """Stress in the disc at one position.

    Attributes
    ----------
    parameter, stress : tuple of array
        Places along flank, each bore and each hole wall (θ or polar angle, rad) and the stress along the wall there, MPa.
    clear : tuple of array of bool
        Which places are clear of contacts.
    largest : dict of str to array
        Largest tensile stress of each root ("flank"), each bore and each hole, MPa.
    shear : dict of str to array
        Largest shear stress in the disc below each contact, by kind, MPa; zero where it is not known.
    """

    parameter: tuple[FloatArray, ...]
    stress: tuple[FloatArray, ...]
    clear: tuple[NDArray[np.bool_], ...]
    largest: dict[Region, FloatArray]
    shear: dict[Kind, FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedStress:
    """One stress in two answers.

    Attributes
    ----------
    place : str
        Where.
    value, reference : float
        MPa.
    difference : float
        Relative, as the module says.
    """

    place: str
    value: float
    reference: float
    difference: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscStressDifference:
    """Differences of the stress in the disc at one position, model less reference.

    Attributes
    ----------
    stations : dict of str to ComparedStress
        The worst station of each region that has a clear one.
    largest : dict of str to ComparedStress
        The worst of the largest tensile stresses of each region, likewise.
    shear : dict of str to dict of int to ComparedStress
        By kind and number of the contact.
    """

    stations: dict[Region, ComparedStress]
    largest: dict[Region, ComparedStress]
    shear: dict[Kind, dict[int, ComparedStress]]


def stress_content(stress: DiscStress) -> dict[str, Any]:
    """Return the stress of a full solution as a position keeps it; None for what is no number."""

    def plain(values: FloatArray) -> list[float | None]:
        return [value if np.isfinite(value) else None for value in values.tolist()]

    return {
        "parameter": [wall.parameter.tolist() for wall in stress.walls],
        "stress": [wall.stress.tolist() for wall in stress.walls],
        "clear": [clear.tolist() for clear in stress.clear],
        "largest": {
            "flank": plain(stress.root_stress),
            "bore": plain(_bore_stresses(stress)),
            "holes": plain(stress.hole_stress),
        },
        "shear": {
            "pin": stress.pin_shear_max.tolist(),
            "roller_outer": stress.roller_shear_max_outer.tolist(),
            "hole": stress.pin_shaft_shear_max.tolist(),
        },
    }


def _bore_stresses(stress: DiscStress) -> FloatArray:
    """Return the largest clear stress of each bore, MPa."""
    if stress.bores == 1:
        return np.array([stress.bore_stress])
    walls = zip(stress.walls[1 : 1 + stress.bores], stress.clear[1 : 1 + stress.bores], strict=True)
    return np.array([np.max(wall.stress[clear]) if clear.any() else np.nan for wall, clear in walls])


def answer_of_content(content: dict[str, Any]) -> DiscStressAnswer:
    """Return the answer of what a position keeps."""

    def arrays(values: list[Any]) -> tuple[FloatArray, ...]:
        return tuple(np.array(own, dtype=float) for own in values)

    return DiscStressAnswer(
        parameter=arrays(content["parameter"]),
        stress=arrays(content["stress"]),
        clear=tuple(np.array(own, dtype=bool) for own in content["clear"]),
        largest={region: np.array(content["largest"][region], dtype=float) for region in REGIONS},
        shear={kind: np.array(content["shear"][kind], dtype=float) for kind in SHEARED},
    )


def stresses_of(analysis: LoadedAnalysis) -> list[DiscStressAnswer]:
    """Return the stress of an analysis of one disc position by position; none where its model gives no stress in the disc."""
    model, full = analysis.model.discs[0], analysis.full
    coefficients = model.coefficients
    if len(analysis.model.discs) > 1 or coefficients is None or coefficients.stress is None:
        return []
    rotation = full.pose[:, 2]
    profiles = wall_profiles(model, full.response.parts[0], analysis.pressures, rotation, refinement=1)
    found = wall_stresses(model, full.response.parts[0], analysis.pressures, rotation)
    contact: dict[Kind, FloatArray] = {
        "pin": found.pin_contact,
        "roller_outer": found.roller_contact,
        "hole": found.hole_contact,
    }
    bores, cranks = found.bore[:, None], model.geometry.placement.cranks
    if cranks > 1:  # the largest of all bores would hide the others
        walls = wall_profiles(model, full.response.parts[0], analysis.pressures, rotation)[1 : 1 + cranks]
        bores = np.stack([wall.largest() for wall in walls], axis=1)
    return [
        DiscStressAnswer(
            parameter=tuple(wall.parameter for wall in profiles),
            stress=tuple(wall.stress[row] for wall in profiles),
            clear=tuple(wall.clear[row] for wall in profiles),
            largest={"flank": found.root[row], "bore": bores[row], "holes": found.hole[row]},
            shear={
                kind: line_contact_shear(answer.kinds[kind].pressure, along[row]) for kind, along in contact.items()
            },
        )
        for row, answer in enumerate(answers_of(analysis))
    ]


def compare_stresses(model: DiscStressAnswer, reference: DiscStressAnswer) -> DiscStressDifference:
    """Return the differences of the stress in the disc of two answers to one position, model less reference.

    The model is given at its stress stations, the reference at nodes close to each other, linear between them. ValueError
    when the numbers of walls, roots or contacts differ.
    """
    if len(model.stress) != len(reference.stress) or any(
        own.shape != reference.largest[region].shape for region, own in model.largest.items()
    ):
        raise ValueError(f"{len(model.stress)} walls against {len(reference.stress)}: not the same disc")
    theirs = [
        np.where(clear, np.interp(own, places, stress, period=2.0 * np.pi), np.nan)
        for own, clear, places, stress in zip(
            model.parameter, model.clear, reference.parameter, reference.stress, strict=True
        )
    ]
    scale = float(np.nanmax(np.abs(np.concatenate(theirs))))
    bores, count = len(model.largest["bore"]), len(model.stress)
    walls: dict[Region, range] = {"flank": range(1), "bore": range(1, 1 + bores), "holes": range(1 + bores, count)}
    stations = {region: _worst_station(model, theirs, own, scale) for region, own in walls.items() if own}
    largest = {
        region: _worst_part(region, model.largest[region], reference.largest[region], scale)
        for region, own in walls.items()
        if own
    }
    return DiscStressDifference(
        stations={region: found for region, found in stations.items() if np.isfinite(found.difference)},
        largest={region: found for region, found in largest.items() if np.isfinite(found.difference)},
        shear={kind: _compare_shear(model.shear[kind], reference.shear[kind]) for kind in SHEARED},
    )


def _worst_station(model: DiscStressAnswer, theirs: list[FloatArray], walls: range, scale: float) -> ComparedStress:
    apart = np.concatenate([model.stress[number] - theirs[number] for number in walls]) / scale
    bores = len(model.largest["bore"])
    names = [
        f"{wall_name(number, bores)} at {np.degrees(place) % 360.0:.1f}°"
        for number in walls
        for place in model.parameter[number]
    ]
    place, difference = worst(apart)
    return ComparedStress(
        place=names[place],
        value=float(np.concatenate([model.stress[number] for number in walls])[place]),
        reference=float(np.concatenate([theirs[number] for number in walls])[place]),
        difference=difference,
    )


def wall_name(number: int, bores: int = 1) -> str:
    """Return the name of a wall as rows give it: flank, then each bore by its crank, then each hole.

    Examples
    --------
    >>> wall_name(1), wall_name(2), wall_name(2, bores=3), wall_name(4, bores=3)
    ('bore', 'hole 0', 'bore of crank 1', 'hole 0')
    """
    if number == 0:
        return "flank"
    return _bore_name(number - 1, bores) if number <= bores else f"hole {number - 1 - bores}"


def _bore_name(crank: int, bores: int) -> str:
    return "bore" if bores == 1 else f"bore of crank {crank}"


def _worst_part(region: Region, model: FloatArray, reference: FloatArray, scale: float) -> ComparedStress:
    place, difference = worst((model - reference) / scale)
    name = {"flank": f"root {place}", "bore": _bore_name(place, model.size), "holes": f"hole {place}"}[region]
    return ComparedStress(
        place=name, value=float(model[place]), reference=float(reference[place]), difference=difference
    )


def _compare_shear(model: FloatArray, reference: FloatArray) -> dict[int, ComparedStress]:
    return {
        number: ComparedStress(
            place="",
            value=float(model[number]),
            reference=float(reference[number]),
            difference=float(model[number] / reference[number] - 1.0),
        )
        for number in np.flatnonzero(reference > 0.0).tolist()
        if np.isfinite(model[number])
    }
