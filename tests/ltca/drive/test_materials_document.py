"""The document of named materials shows the data as it is."""

from __future__ import annotations

from pathlib import Path

import ltca
from ltca.drive.members.named_materials import named_materials

DOCUMENT = Path(ltca.__file__).parents[1] / "docs" / "reference" / "materials.md"
COLUMNS = {
    "youngs_modulus": ("E, GPa", 1e-3),
    "poisson_ratio": ("ν", 1.0),
    "allowable_pressure": ("allowable pressure, MPa", 1.0),
    "yield_strength": ("yield strength, MPa", 1.0),
    "bending_fatigue_limit": ("bending fatigue limit, MPa", 1.0),
    "hardness": ("hardness, HV", 1.0),
    "hardness_depth": ("its depth, mm", 1.0),
    "density": ("density, kg/m³", 1.0),
    "thermal_expansion": ("expansion, 1e-6/K", 1e6),
}


def numbers_table():
    """Values and scatter of every material."""
    lines = ["| name | " + " | ".join(title for title, _ in COLUMNS.values()) + " |", "|---|" + "---|" * len(COLUMNS)]
    for entry in named_materials().values():
        cells = []
        for field, (_, factor) in COLUMNS.items():
            number = entry.numbers.get(field)
            told = "–"
            if number is not None:
                value, low, high = (f"{factor * each:.6g}" for each in (number.value, number.low, number.high))
                told = f"{value} ({low} … {high})" + ("" if number.confirmed else " *")
            cells.append(told)
        lines.append(f"| `{entry.name}` | " + " | ".join(cells) + " |")
    return lines


def sources_list():
    """State, aliases and sources of every material."""
    lines = []
    for entry in named_materials().values():
        lines += [f"**`{entry.name}`** ({', '.join(f'`{alias}`' for alias in entry.aliases)}): {entry.state}.", ""]
        fields: dict[str, list[str]] = {}
        for field, number in entry.numbers.items():
            told = number.source
            if number.scatter_source != number.source:
                told += f"; scatter: {number.scatter_source}"
            fields.setdefault(told, []).append(f"`{field}`")
        lines += [f"- {', '.join(names)}: {told}" for told, names in fields.items()]
        lines.append("")
    return lines


def test_the_document_shows_the_data():
    text = DOCUMENT.read_text(encoding="utf-8")
    for part in (numbers_table(), sources_list()):
        assert "\n".join(part) in text
