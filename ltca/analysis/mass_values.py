"""Masses, unbalance and inertias as results hold and print them: kg, g·mm, kg·m²."""

from __future__ import annotations

from cmath import phase
from math import degrees, isnan, nan

import numpy as np

from ltca.drive.parts import Drive
from ltca.dynamics.kinetics import reflected_inertia
from ltca.dynamics.masses import CRANKS, DISCS, INERTIA, TONNE_PER_KG, DriveMasses, Unbalance, drive_masses

GRAM = 1e-3 * TONNE_PER_KG
"""A gram in t."""
NAMES = (
    "mass", "disc_mass", "disc_inertia", "static_unbalance", "couple_unbalance", "reflected_inertia_input",
    "reflected_inertia_output",
)  # fmt: skip
"""Scalars of masses, by their names in the registry."""


def mass_values(drive: Drive) -> dict[str, float]:
    """Return the scalars of masses of a drive as it was given; not a number where a density is not known."""
    masses = drive_masses(drive)
    disc, unbalance, reflected = masses.of(DISCS)[0], masses.unbalance, reflected_inertia(drive, masses)
    values = (
        masses.total / TONNE_PER_KG,
        disc.mass / TONNE_PER_KG,
        disc.about_own_axis / INERTIA,
        abs(unbalance.static) / GRAM,
        abs(unbalance.couple) / GRAM,
        nan if reflected is None else reflected.at_input / INERTIA,
        nan if reflected is None else reflected.at_output / INERTIA,
    )
    return dict(zip(NAMES, values, strict=True))


def mass_rows(drive: Drive) -> list[tuple[str, str]]:
    """Return masses, unbalance and inertias of a drive as names and texts, and the densities that are not known."""
    masses, given = drive_masses(drive), drive.inertia
    rows = []
    for group in masses.groups:
        mass, count = masses.mass_of(group), len(masses.of(group))
        name = f"mass of {group}"
        if group == CRANKS:
            count = drive.crank.number
            name += ", solid eccentrics and shafts" if given is None or given.crank_mass is None else ", given"
        if not isnan(mass):
            each = "" if count == 1 else f", {count} of {mass / count / TONNE_PER_KG:.5g} kg"
            rows.append((name, f"{mass / TONNE_PER_KG:.5g} kg{each}"))
    discs = masses.of(DISCS)
    disc, of = discs[0], " 0" if len(discs) > 1 else ""
    if not isnan(disc.mass):
        rows.append((f"volume of disc{of}", f"{disc.volume:.6g} mm³"))
        off = abs(disc.place - complex(masses.places[0].races(np.zeros(1)).middle[0]))
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


def _unbalance_rows(found: Unbalance) -> list[tuple[str, str]]:
    if np.isnan(found.discs).any():
        return []
    beside = "" if found.eccentrics else ", eccentrics left out"
    each = ", ".join(_polar(one, "g·mm") for one in found.discs.tolist())
    rows = [(f"unbalance of each disc at its phase{beside}", each)]
    if len(found.discs) > 1:
        together = f"{_polar(found.static, 'g·mm')}; couple {_polar(found.couple, 'g·mm²')}"
        rows.append(("unbalance of all discs", together))
    return rows


def _polar(value: complex, unit: str) -> str:
    """Size and phase against the crank."""
    if not value:
        return f"0 {unit}"
    angle = degrees(phase(value)) % 360.0
    return f"{abs(value) / GRAM:.5g} {unit} at {0.0 if angle > 360.0 - 1e-6 else angle:.4g}°"


def _inertia_rows(drive: Drive, masses: DriveMasses) -> list[tuple[str, str]]:
    found, rows = reflected_inertia(drive, masses), []
    if found is not None:
        for side, own, given in (
            ("input", found.at_input, found.given_input),
            ("output", found.at_output, found.given_output),
        ):
            beside = f", with the given {given / INERTIA:.5g} kg·m² beside it" if given else ""
            rows.append((f"inertia of the drive referred to the {side}", f"{own / INERTIA:.5g} kg·m²{beside}"))
    return rows
