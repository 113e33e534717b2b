"""``report.html`` of a full solution: verdict, pictures and contacts of every disc, the drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.drive.full_solution import FullSolution
from fem.reducer.error_table import error_section
from fem.reducer.nested_meshes import NestedSolution
from fem.reducer.solution import ReducerSolution
from ltca.drive.members.judgement import Check
from ltca.drive.units.quantities import ARCSEC
from ltca.page.study_page import Picture, Section, StudyPage
from ltca.page.tables import Cell, Table, folded, minus, number, texts, word
from ltca.page.verdict_tables import verdict_of, verdict_tables


def solution_page(
    solution: ReducerSolution,
    checks: Sequence[Check],
    case: str,
    told: str,
    text: str,
    loads: Picture,
    pictures: Sequence[Sequence[Picture]] = (),
    nested: NestedSolution | None = None,
) -> StudyPage:
    """Return the page of a full solution with its verdict.

    `told` describes the problem, `text` is the drive file, `loads` is the drive with its loads, and `pictures` are those of
    the stress in every disc, none where they were left out; error bars are those of solutions on `nested` meshes.
    """
    sentence, state = verdict_of({case: checks})
    sections = [Section(heading="Verdict at this position", tables=folded(verdict_tables({case: checks})))]
    sections.append(Section(heading="The drive under load", pictures=[loads]))
    if nested is not None:
        sections.append(error_section(nested))
    several = len(solution.discs) > 1
    for place, own in enumerate(pictures):
        sections.append(
            Section(heading=f"Stress and displacement{f' of disc {place}' if several else ''}", pictures=own)
        )
    for place, disc in enumerate(solution.discs):
        of = f" of disc {place}" if several else ""
        columns = ["contact", "load, N", "largest pressure, MPa", "half-width, µm"]
        contacts = Table(name=f"contacts{place}", caption="", columns=columns, rows=[*_contacts(disc)])
        cranks = disc.bearing_components.tolist()
        notes = [
            minus(
                f"Bearing force on the disc{f' at crank {crank}' if len(cranks) > 1 else ''}: radial {radial:.1f} N, "
                f"tangential {tangential:.1f} N."
            )
            for crank, (radial, tangential) in enumerate(cranks)
        ]
        if several:
            notes.append(f"It carries {100.0 * float(solution.torque_share[place]):.2f} % of the torque.")
        sections.append(Section(heading=f"Contacts{of}", notes=notes, tables=[contacts]))
    rows = [
        ("crank angle", f"{degrees(solution.crank_angle):.6g}° = {solution.crank_angle:.6g} rad"),
        ("wheel angle", f"{solution.wheel_angle * ARCSEC:.6g}″ = {solution.wheel_angle:.6g} rad"),
        ("moment on the wheel", f"{solution.wheel_moment / 1e3:.6g} N·m"),
        ("largest unbalanced force", f"{solution.equilibrium_residual:.1e} N"),
        ("unknowns", f"{solution.unknowns}"),
    ]
    drive = Table(name="drive", caption="", columns=["", "value"], rows=texts(rows), words=1)
    sections.append(Section(heading="The drive", tables=[drive]))
    return StudyPage(name=solution.drive.name, told=told, sentence=sentence, state=state, sections=sections, text=text)


def _contacts(solution: FullSolution) -> Iterator[list[Cell]]:
    """Yield a row for each loaded contact."""
    for kind, index, load, peak, width in solution.contacts.loaded:
        yield [
            word(CONTACT_KINDS[kind].title_of(index, solution.model.placement)),
            number(load, "{:.1f}"),
            number(peak, "{:.1f}"),
            number(1e3 * width, "{:.1f}"),
        ]
