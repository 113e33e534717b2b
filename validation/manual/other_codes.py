"""Other codes on the same problem: tamaas on rollers, CalculiX on a whole drive; their stored answers serve everywhere."""

from __future__ import annotations

from functools import partial

from validation.levels.other_code_problems import CODES
from validation.levels.other_codes import compare_answers, stored_answer
from validation.manual.case import Case, Figure, Reference


def _against(name: str, numerical_error: float, origin: str, reference_error: float) -> list[Figure]:
    rows = compare_answers(name, CODES[name].ours(), stored_answer(name), name)
    return [
        Figure.of_row(row, numerical_error=numerical_error, numerical_origin=origin, reference_error=reference_error)
        for row in rows
        if row.difference_unit == ""
    ] + [
        Figure.of_row(row, numerical_error=0.05, numerical_origin=WHEEL, reference_error=0.08)
        for row in rows
        if row.difference_unit != ""
    ]


WHEEL = "spread over meshes of 2, 3 and 4 times the default size (docs/validation/index.md)"
CASES = (
    Case(
        name="tamaas_rollers",
        title="Rollers of finite length against tamaas",
        problem="A straight roller (radius 2 mm, 11.8 mm long, 1500 N) and one with the profile of ISO 16281 (radius "
        "10 mm, 20 mm long, 40 kN) on a "
        "flat, E 210 000 MPa, ν 0.3: pressure at mid-length and approach.",
        references=(
            Reference(
                source="tamaas: uniform cells (96 × 512 and 96 × 384), FFT of Boussinesq's solution, conjugate "
                "gradients; stored answers "
                "of `validation.levels.other_code_problems`",
                uncertainty="0.15 %: finer cells halve the difference.",
            ),
        ),
        model="Tables of the LTCA (`LineContactLaw`, `ProfiledLineContactLaw`), made by graded grids.",
        run=partial(_against, "tamaas", 3e-4, "tables against refined grids (tests of both laws)", 1.5e-3),
    ),
    Case(
        name="calculix_drive",
        title="A whole drive against CalculiX on the same mesh",
        problem="The paper's CS-1 at φ_C = 0.5, plane strain, two elements for each half-width: loads of all "
        "contacts, relative to the largest of their "
        "kind, and the angle of the wheel.",
        references=(
            Reference(
                source="CalculiX 2.20, the same mesh; stored answers of `validation.levels.other_code_problems`",
                uncertainty="Penalty contact, 0.08″ of the wheel angle; loads 0.1 %.",
            ),
        ),
        model="Our finite elements with mortar contact (`fem.drive.solution.solve_drive`), size 4.",
        model_uncertainty="Both codes solve the same plane model.",
        long=True,
        run=partial(
            _against,
            "CalculiX",
            2e-3,
            "change of loads from size 4 to the default size, 0.18 % (docs/validation/index.md)",
            1e-3,
        ),
    ),
)
