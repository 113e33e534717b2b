"""``report.html`` of a full solution: verdict, pictures and contacts of every disc, line loads of solid ones, the drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees

from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.full_solution import FullSolution
from fem.reducer.error_table import error_section
from fem.reducer.nested_meshes import NestedSolution
from fem.reducer.solution import ReducerSolution
from fem.reducer.solution_words import columns_of, contact_rows, disc_facts, drive_facts
from fem.solid_drive.width_results import width_results
from ltca.drive.members.judgement import Check
from ltca.page.study_page import Curves, Picture, Section, StudyPage
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
    """Return the page of a full solution, of plane bodies with its verdict.

    `told` describes the problem, `text` is the drive file, `loads` is the drive with its loads, and `pictures` are those of
    the stress in every disc, none where they were left out; error bars are those of solutions on `nested` meshes.
    """
    sections, sentence, state = list[Section](), "", ""
    if not solution.solid:
        sentence, state = verdict_of({case: checks})
        sections.append(Section(heading="Verdict at this position", tables=folded(verdict_tables({case: checks}))))
    sections.append(Section(heading="The drive under load", pictures=[loads]))
    if nested is not None:
        sections.append(error_section(nested))
    several = len(solution.discs) > 1
    for place, own in enumerate(pictures):
        sections.append(
            Section(heading=f"Stress and displacement{f' of disc {place}' if several else ''}", pictures=own)
        )
    for place, disc in enumerate(solution.discs):
        of, columns = f" of disc {place}" if several else "", columns_of(disc)
        rows: list[list[Cell]] = [
            [
                word(title),
                *(number(value, f"{{:{column.form}}}") for column, value in zip(columns, numbers, strict=True)),
            ]
            for _, title, numbers in contact_rows(disc)
        ]
        titles = ["contact", *(column.title for column in columns)]
        contacts = Table(name=f"contacts{place}", caption="", columns=titles, rows=rows)
        notes = [minus(f"{title[0].upper()}{title[1:]}: {words}.") for title, words in disc_facts(solution, place)]
        sections.append(Section(heading=f"Contacts{of}", notes=notes, tables=[contacts]))
        if solution.solid:
            sections.append(Section(heading=f"Along the width{of}", curves=[*_line_loads(disc)]))
    angle = f"{degrees(solution.crank_angle):.6g}° = {solution.crank_angle:.6g} rad"
    facts = [(title, minus(words)) for title, words in drive_facts(solution)]
    drive = Table(
        name="drive", caption="", columns=["", "value"], rows=texts([("crank angle", angle), *facts]), words=1
    )
    sections.append(Section(heading="The drive", tables=[drive]))
    return StudyPage(name=solution.drive.name, told=told, sentence=sentence, state=state, sections=sections, text=text)


def _line_loads(disc: FullSolution) -> Iterator[Curves]:
    """Yield the line loads of the contacts that carry, kind by kind."""
    titles: dict[PairKind, str] = {
        "pin": "wheel pins on the flank",
        "hole": "shaft pins in their holes",
        "roller_outer": "rollers in the bore",
        "roller_inner": "rollers on the race",
    }
    along = [*zip(disc.model.pairs, width_results(disc), strict=True)]
    for kind, title in titles.items():
        own = [(pair, each) for pair, each in along if pair.kind == kind and each.load > 0.0]
        if own:
            place = disc.model.placement
            lines = {CONTACT_KINDS[kind].name_of(pair.index, place): each.line_load for pair, each in own}
            heights = own[0][1].heights
            yield Curves(
                title=f"line load of {title}", unit="N/mm", axis="height above mid-width, mm", x=heights, lines=lines
            )
