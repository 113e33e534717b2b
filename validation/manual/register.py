"""All cases of the manual, by what they are about; solid cases have their own list."""

from __future__ import annotations

from ltca.errors import DriveError, did_you_mean, shortened
from validation.manual import (
    beams,
    bearings,
    contact,
    elasticity,
    geometry,
    loads,
    losses,
    other_codes,
    seats,
    solid_bodies,
    solid_pairs,
    width,
)
from validation.manual.case import Case

PLANE: dict[str, tuple[Case, ...]] = {
    "Contact": contact.CASES,
    "Conforming seats": seats.CASES,
    "Contacts along their width": width.CASES,
    "Elasticity": elasticity.CASES,
    "Beams and rings": beams.CASES,
    "Geometry": geometry.CASES,
    "Loads of drives": loads.CASES,
    "Roller bearings": bearings.CASES,
    "Friction": losses.CASES,
    "Other codes": other_codes.CASES,
}
"""Cases of the plane and of half-spaces by their heading in the index."""

SOLID: dict[str, tuple[Case, ...]] = {
    "Solid bodies": solid_bodies.CASES,
    "Contact of solid bodies": solid_pairs.CASES,
}
"""Cases of solid bodies (`Case.bodies` is "solid") by their heading in the index."""

HEADINGS: dict[str, tuple[Case, ...]] = {**PLANE, **SOLID}


def all_cases() -> dict[str, Case]:
    """Return all cases by name, in the order of the manual."""
    return {case.name: case for cases in HEADINGS.values() for case in cases}


def chosen_cases(names: list[str]) -> tuple[Case, ...]:
    """Return the cases of these names in the order of the manual, all without names; DriveError for others and for repeats.

    Examples
    --------
    >>> [case.title for case in chosen_cases(["lame_ring"])]
    ["Lamé's ring under inner pressure"]
    """
    known = all_cases()
    listed = ", ".join(known)
    problems = [
        f"--manual {shortened(name)[1:-1]}: is no case of the manual{did_you_mean(name, known)}; cases are {listed}"
        for name in dict.fromkeys(names)
        if name not in known
    ]
    problems += [f"--manual {name}: is given twice" for name in known if names.count(name) > 1]
    if problems:
        raise DriveError(problems)
    return tuple(case for name, case in known.items() if not names or name in names)
