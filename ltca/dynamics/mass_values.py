"""Masses, unbalance and inertias as results hold and print them: kg, g·mm, kg·m²."""

from __future__ import annotations

from cmath import phase
from math import degrees, isnan, nan

import numpy as np

from ltca.drive.parts import Drive
from ltca.dynamics.kinetics import reflected_inertia
from ltca.dynamics.masses import CRANKS, DISCS, INERTIA, TONNE_PER_KG, DriveMasses, Unbalance, drive_masses

GRAM = 1e-3 * TONNE_PER_KG
"""t of a gram."""
BALANCED = 1e-9
"""Part of the unbalance of all discs, taken one by one, below which what is left of them is round-off."""
NAMES = (
    "mass", "disc_mass", "disc_inertia", "static_unbalance", "couple_unbalance", "reflected_inertia_input",
    "reflected_inertia_output",
)  # fmt: skip
"""Scalars of masses, by their names in the registry."""


def mass_values(drive: Drive) -> dict[str, float]:
    """Return the scalars of masses by their names in the registry; not a number where a density is not known.

    Parameters
    ----------
    drive : Drive
        As it was given.
    """
    masses = drive_masses(drive)
    disc, reflected = masses.of(DISCS)[0], reflected_inertia(drive, masses)
    static, couple = _left(masses.unbalance)
    return {
        "mass": masses.total / TONNE_PER_KG,
        "disc_mass": disc.mass / TONNE_PER_KG,
        "disc_inertia": disc.about_own_axis / INERTIA,
        "static_unbalance": abs(static) / GRAM,
        "couple_unbalance": abs(couple) / GRAM,
        "reflected_inertia_input": nan if reflected is None else reflected.at_input / INERTIA,
        "reflected_inertia_output": nan if reflected is None else reflected.at_output / INERTIA,
    }


def _left(found: Unbalance) -> tuple[complex, complex]:
    """Static unbalance and couple, nothing where they are round-off."""
    whole = float(abs(found.discs).sum())
    reach = float(abs(found.discs) @ abs(found.planes))
    static, couple = found.static, found.couple
    return (
        0j if abs(static) <= BALANCED * whole else static,
        0j if abs(couple) <= BALANCED * max(reach, whole) else couple,
    )


def mass_rows(drive: Drive) -> list[tuple[str, str]]:
    """Return masses, unbalance and inertias as names and texts; what a density is missing for is told.

    Parameters
    ----------
    drive : Drive
        As it was given.
    """
    masses = drive_masses(drive)
    given = drive.inertia is not None and drive.inertia.crank_mass is not None
    cranks = ", given" if given else ", solid eccentrics and shafts"
    rows = [
        (f"mass of {group}{cranks if group == CRANKS else ''}", _mass_words(masses, group))
        for group in masses.groups
        if not isnan(masses.mass_of(group))
    ]
    discs = masses.of(DISCS)
    disc, of = discs[0], " 0" if len(discs) > 1 else ""
    if not isnan(disc.mass):
        rows.append((f"volume of disc{of}", f"{disc.volume:.6g} mm³"))
        off = abs(disc.place - complex(masses.places[0].race_centre(np.zeros(1))[0]))
        about = f"{disc.about_own_axis / INERTIA:.5g} kg·m²{f', {off:.4g} mm off' if off > 1e-9 else ''}"
        rows.append((f"inertia of disc{of} about its centre of mass", about))
    if not isnan(crank := masses.crank_inertia):
        rows.append(("inertia of a crank about its axis", f"{crank / INERTIA:.5g} kg·m²"))
    if not isnan(masses.total):
        rows.append(("mass of what the file describes", f"{masses.total / TONNE_PER_KG:.5g} kg"))
    rows += _unbalance_rows(masses.unbalance) + _inertia_rows(drive, masses)
    if missing := masses.without_density:
        rows.append(("masses left out, densities not given", ", ".join(missing)))
    return rows


def _mass_words(masses: DriveMasses, group: str) -> str:
    mass, parts = masses.mass_of(group), masses.of(group)
    count = masses.drive.crank.number if group == CRANKS else len(parts)
    each = "" if count == 1 else f", {count} of {mass / count / TONNE_PER_KG:.5g} kg"
    return f"{mass / TONNE_PER_KG:.5g} kg{each}"


def _unbalance_rows(found: Unbalance) -> list[tuple[str, str]]:
    if np.isnan(found.discs).any():
        return []
    static, couple = _left(found)
    beside = "" if found.eccentrics else ", eccentrics left out"
    each = ", ".join(_polar(one, "g·mm") for one in found.discs.tolist())
    rows = [(f"unbalance of each disc at its phase{beside}", each)]
    if len(found.discs) > 1:
        rows.append(("unbalance of all discs", f"{_polar(static, 'g·mm')}; couple {_polar(couple, 'g·mm²')}"))
    return rows


def _polar(value: complex, unit: str) -> str:
    """Size and phase against the crank."""
    if not value:
        return f"0 {unit}"
    angle = degrees(phase(value)) % 360.0
    return f"{abs(value) / GRAM:.5g} {unit} at {0.0 if angle > 360.0 - 1e-6 else angle:.4g}°"


def _inertia_rows(drive: Drive, masses: DriveMasses) -> list[tuple[str, str]]:
    found = reflected_inertia(drive, masses)
    if found is None:
        return []
    rows = []
    for side, own, given in (
        ("input", found.at_input, found.given_input),
        ("output", found.at_output, found.given_output),
    ):
        beside = f", with the given {given / INERTIA:.5g} kg·m² beside it" if given else ""
        rows.append((f"inertia of the drive referred to the {side}", f"{own / INERTIA:.5g} kg·m²{beside}"))
    return rows
