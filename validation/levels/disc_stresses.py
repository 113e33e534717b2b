"""Level 5, stress in the disc: by the LTCA, from its loads and the stress coefficients, against the full solution."""

from __future__ import annotations

from typing import Any

from validation.compare.compared_positions import ComparedPosition
from validation.compare.disc_stresses import REGIONS, ComparedStress, Region
from validation.compare.error_bars import NO_BARS, ErrorBars
from validation.compare.model_positions import FULL
from validation.rows import Row

WALL_LIMIT, SHEAR_LIMIT = 2e-2, 3e-2

REASONS = {
    "wall": "of the largest stress along a wall; meshes of their own, contacts farther than four half-widths, nodal "
    "stress linear between nodes",
    "shear": "Hertz' stresses of half-planes on the disc's own: a hole 60 half-widths wide bends by 1 %",
}
CAUSE = "loads of half-spaces of finite length, full FE is plane strain: informs only"
NAMES: dict[Region, str] = {"flank": "the flank", "bore": "the bore", "holes": "the hole walls"}
PARTS: dict[Region, str] = {"flank": "lobe roots", "bore": "bore", "holes": "holes"}


def disc_stress_rows(compared: ComparedPosition, bars: ErrorBars | None = None) -> list[Row]:
    """Return the rows of one position for all models that give the stress in the disc, with error bars where they are known."""
    rows: list[Row] = []
    walls: dict[Region, float] = {} if bars is None else bars.walls
    for model, difference in compared.stress.items():
        rows += [
            _row(
                compared,
                model,
                f"stress along {NAMES[region]}, worst station",
                difference.stations[region],
                "wall",
                error_bar=walls.get(region),
            )
            for region in REGIONS
            if region in difference.stations  # a disc without holes, or a wall under contacts all along
        ]
        rows += [
            _row(
                compared,
                model,
                f"largest tensile stress, {PARTS[region]}, worst",
                difference.largest[region],
                "wall",
                error_bar=walls.get(region),
            )
            for region in REGIONS
            if region in difference.largest
        ]
        for kind, contacts in difference.shear.items():
            rows += [
                _row(compared, model, "largest shear stress in the disc below a contact", found, "shear",
                     contact=compared.full.answer.contact_name(kind, number),
                     error_bar=None if bars is None else bars.kinds.get(kind, NO_BARS).shear)
                for number, found in contacts.items()
            ]  # fmt: skip
    return rows


def _row(
    compared: ComparedPosition, model: str, quantity: str, found: ComparedStress, reason: str, **place: Any
) -> Row:
    bounded = model == "fe"
    limit = WALL_LIMIT if reason == "wall" else SHEAR_LIMIT
    return Row(
        level=5,
        quantity=quantity,
        value=found.value,
        reference=found.reference,
        unit="MPa",
        difference=found.difference,
        limit=limit if bounded else None,
        reason=REASONS[reason] if bounded else CAUSE,
        case=compared.full.case,
        crank_angle=compared.full.crank_angle,
        model=model,
        against=FULL,
        **({"contact": found.place} | place),
    )
