"""Generated reference pages: drive file, commands, dataset, names of results.

``conf.py`` writes them before Sphinx reads its sources; they are not in the repository. Fields are read from their definitions,
options from the parsers, variables and scalars from the registry of quantities.
"""

from __future__ import annotations

import argparse
import posixpath
import re
from collections.abc import Iterable
from pathlib import Path

LEFT_OUT = "left out"
HEADINGS = {
    "drive-file": "drive_file",
    "commands": "commands",
    "dataset": "dataset",
    "names-of-results": "quantities",
}
"""Generated pages by the headings of ``reference/index.md`` that stand for them in a checkout."""
NOTE = "<!-- Written by docs/generated_pages.py: do not edit. -->\n"


def write_pages(folder: Path) -> None:
    """Write the pages whose text has changed, so that Sphinx does not rebuild unchanged ones."""
    folder.mkdir(parents=True, exist_ok=True)
    pages = {
        "drive_file.md": drive_file_page(),
        "commands.md": commands_page(),
        "dataset.md": dataset_page(),
        "quantities.md": quantities_page(),
    }
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != NOTE + text:
            path.write_text(NOTE + text, encoding="utf-8")


def built_links(docname: str, text: str) -> str:
    """Return a page whose links to what a checkout has in the place of pages of the build lead to these.

    Headings of ``reference/index.md`` stand for generated pages, scripts of ``examples`` for pages of the gallery, so that links
    work in a checkout as well.

    Parameters
    ----------
    docname : str
        Page relative to ``docs``, without suffix.
    text : str
        Its Markdown.

    Examples
    --------
    >>> built_links("start/index", "[fields](../reference/index.md#drive-file), [plot](../../examples/own_coefficients.py)")
    '[fields](../reference/generated/drive_file.md), [plot](../gallery/own_coefficients.rst)'
    """
    folder = posixpath.dirname(docname)

    def built(match: re.Match[str]) -> str:
        target, _, heading = match[1].partition("#")
        path = posixpath.normpath(posixpath.join(folder, target)) if target else f"{docname}.md"
        if path == "reference/index.md" and heading in HEADINGS:
            page = f"reference/generated/{HEADINGS[heading]}.md"
        elif path == "../examples":
            page = "gallery/index.rst"
        elif posixpath.dirname(path) == "../examples" and path.endswith(".py"):
            page = f"gallery/{posixpath.basename(path)[:-3]}.rst"
        else:
            return match[0]
        return f"]({posixpath.relpath(page, folder or '.')})"

    return re.sub(r"\]\(([^)\s]+)\)", built, text)


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a Markdown table, with vertical bars in cells escaped."""
    titles = list(head)
    lines = [titles, ["---"] * len(titles), *rows]
    return "".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |\n" for row in lines) + "\n"


def drive_file_page() -> str:
    """Return the page of all fields of a drive file."""
    from ltca.drive.declaration import by_table, gathered, table_of
    from ltca.drive.engine_support import ENGINES, refusals

    text = """# The drive file

All fields by table, as printed by `cyclo fields`; this page is generated from the definitions. A drive file
is TOML. Plain numbers are in the unit of the field, a string carries a unit ([Quantities and units](../units.md)).
Unknown fields, values outside their bounds and geometrically impossible combinations are refused with one sentence per error.

Values for a single disc or eccentric are given in `[[disc.of]]` and `[[crank.of]]`, where `N` is its number
from 0. In addition a file may contain

- `[[case]]`: a `name` and any of the tables below, whose fields replace those of the common part,
- [`[limits]`](../../how-to/verdict.md): limits of results,
- [`[tolerances]`](../../how-to/tolerances.md): scatter of fields, used by studies only.

Engines use every field or refuse it by name. They are

"""
    text += table(("engine", "meaning"), ENGINES.items())
    text += "A test changes every field in every engine and checks that the result changes (`tests/contract`).\n\n"
    for name, fields in by_table(gathered()).items():
        told = table_of(name) if name else None
        text += f"## {name}\n\n" if name else "## Top level of the file\n\n"
        if told is not None:
            text += f"{told.meaning.replace('``', '`')}{' Optional.' if told.optional else ''}\n\n"
        refused = [refusals(field.path) for field in fields]
        alike = len(fields) > 1 and all(one == refused[0] for one in refused)
        if alike and refused[0]:
            text += "".join(f"Refused by {', '.join(by)}: {why}.\n\n" for why, by in refused[0].items())
        rows = []
        for field, by in zip(fields, refused, strict=True):
            unit = field.label or {"quantity": "number", "count": "whole number"}.get(field.kind, field.kind)
            meaning = field.meaning.replace("``", "`")
            if not alike:
                meaning += "".join(f" Refused by {', '.join(engines)}: {why}." for why, engines in by.items())
            rows.append(
                (
                    f"`{field.name}`",
                    f"list, {unit}" if field.is_array else unit,
                    _ticks(field.default),
                    _signs(_ticks(field.bounds)),
                    meaning,
                )
            )
        text += table(("field", "unit", "default", "bounds", "meaning"), rows)
    return text


def _ticks(text: str) -> str:
    """Return a default or bound as it is written in a file; a dash if there is none."""
    if text in ("", LEFT_OUT):
        return "–"
    return f"`{text}`" if text.startswith('"') else text


def _signs(bounds: str) -> str:
    for words, sign in (
        ("greater than", ">"),
        ("at least", "≥"),
        ("less than", "<"),
        ("at most", "≤"),
        (" and ", ", "),
    ):
        bounds = bounds.replace(words, sign)
    return bounds


def commands_page() -> str:
    """Return the page of all commands with their options and examples."""
    from importlib.metadata import entry_points

    from ltca.commands.program import GROUP, ORDER, build_parser

    installed = [entry.name for entry in entry_points(group=GROUP)]
    names = [name for name in ORDER if name in installed] + sorted(set(installed) - set(ORDER))
    modules = {entry.name: entry.load() for entry in entry_points(group=GROUP)}
    text = """# Commands

This page has the contents of `cyclo COMMAND --help`. Numerical options may carry a unit (`--torque "377.3 N m"`,
[Quantities and units](../units.md)); `DRIVE` is a drive file, or the name of a shipped drive (`paper`, `robot-joint`, `rv`,
`sleeved`).
Several angles are separated by spaces and may be negative. Every printed table names torque, direction of the crank,
model, positions and case. Exit statuses, output folders and interrupted runs:
[Exit statuses, files and processes](../files_and_processes.md).

"""
    text += table(
        ("command", "purpose"),
        ((f"[`cyclo {name}`](#cyclo-{name})", _cell(modules[name].SUMMARY)) for name in names),
    )
    for name in names:
        parser = build_parser(name)
        actions = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
        command = actions.choices[name]
        summary = modules[name].SUMMARY
        usage = " ".join(command.format_usage().removeprefix("usage: ").split())
        text += f"## cyclo {name}\n\n{summary[:1].upper()}{summary[1:]}.\n\n```text\n{_broken(usage)}\n```\n\n"
        rows = []
        for action in command._actions:
            if isinstance(action, argparse._HelpAction):
                continue
            value = action.metavar or ("" if action.nargs == 0 else "|".join(map(str, action.choices or ())))
            shown = ", ".join(action.option_strings) or str(action.metavar or action.dest)
            told = (action.help or "") % {"default": action.default, "prog": command.prog}
            rows.append((f"`{shown}{f' {value}' if value and action.option_strings else ''}`", _cell(told)))
        text += table(("argument", "meaning"), rows)
        text += "".join(
            f"{told[:1].upper()}{told[1:]}:\n\n```sh\n{line}\n```\n\n" for line, told in modules[name].EXAMPLES
        )
    return text


def _broken(usage: str) -> str:
    from textwrap import fill

    return fill(usage, 100, subsequent_indent="    ", break_on_hyphens=False, break_long_words=False)


def _cell(text: str) -> str:
    """Return help text as a table cell, with markup escaped."""
    return text.replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


def dataset_page() -> str:
    """Return the page of all variables and coordinates of ``results.nc`` and all keys of ``summary.json``."""
    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.results import build_dataset
    from ltca.geometry.placement import position_angles
    from ltca.quantities import QUANTITIES, SCALARS, SCHEMA_VERSION
    from ltca.reading.drive_file import load_drive

    text = """# The dataset

`results.nc` of `cyclo run` is a netCDF file; `result.dataset` in Python has the same contents for one case. `pressure.nc`
(`--pressure`) and `fem.nc` (`cyclo fem`) use the same names. Dimensions are in the order `case`, `disc`, `crank`, `position`,
then `pin`, `roller`, `hole` or `lobe`; dimensions of size 1 are kept. In Python `crank_angle` is an index beside `position`
(`.sel(crank_angle=0.5, method="nearest")`); of a file `.set_xindex("crank_angle")` makes it one.
The attribute `units` has the unit of a variable, `long_name` its meaning. Discs, cranks, pins, rollers and holes are
numbered from 0, counter-clockwise; signs and frames: [Conventions](../../theory/conventions.md).

Variables exist if they apply to the drive: those of friction with `[friction]`, of seats with loose pins and sleeves, of walls
with `--compliance fe` and `hybrid`. Variables that exist in only some of the cases are NaN in the others.

The attribute `schema_version`, an integer, identifies names, units and dimensions of a dataset. It increases when one of
them is changed or removed, not when one is added. The present version is {version}.

## Arrays and coordinates

"""
    text = text.replace("{version}", str(SCHEMA_VERSION))
    arrays = [quantity for quantity in QUANTITIES.values() if quantity.of]
    text += table(
        ("array", "dimensions", "unit", "meaning"),
        (
            (f"`{one.name}`", ", ".join(one.dimensions), _unit(one.unit), _meanings(one.description, one.in_fem))
            for one in arrays
        ),
    )
    drive = load_drive("paper").cases["CS-1"]
    analysis = analyse(drive, position_angles(2))
    dataset = build_dataset("paper", {"CS-1": analysis})
    text += "## Attributes\n\n" + table(
        ("attribute", "value for the paper's CS-1"),
        ((f"`{name}`", _attribute(name, value)) for name, value in dataset.attrs.items()),
    )
    text += """Times and paths are not stored, so that the same input gives the same bytes. `code_hash` is the hash of the code,
`fingerprint` that of the drives of the cases, and `status` is `complete`, or `partial` if a position has no solution.

## summary.json

Scalars of every case, with the unit at the end of the name (`_N`, `_MPa`, `_mm`, `_Nmm`, `_arcmin`, `_arcsec`, `_deg`, `_W`).
Means and peaks are taken over the positions, `refined_…` are extremes over the whole turn, refined between positions; null means
that engine or positions do not provide the value. `#` is the number of a disc or crank.

"""
    text += table(
        ("key", "also refined", "meaning"),
        ((f"`{one.key}`", "yes" if one.refined else "", one.title) for one in SCALARS.values() if one.in_summary),
    )
    text += FEM_SUMMARY
    return text + table(
        ("key of `cyclo fem`", "older key", "meaning"),
        (
            (f"`{one.fem_key}`", f"`{one.older_fem_key}`", one.in_fem or one.description)
            for one in arrays
            if one.older_key
        ),
    )


FEM_SUMMARY = """
## summary.json of cyclo fem

Arrays of `fem.nc`, with the unit appended to the name, as lists by disc and part. In datasets and in the summary of
`cyclo run`, `pressure_mid` is the largest pressure at mid-width, where a contact is in plane strain, and `pressure_max` the
largest along the width, including its ends. Full finite elements are plane and have only the first. Their older keys
name it `pressure_max` and are kept beside the new ones, with the same values.

"""


def _meanings(description: str, in_fem: str) -> str:
    return f"{description}; in `fem.nc`: {in_fem}" if in_fem else description


def _unit(unit: str) -> str:
    from ltca.quantities import unit_sign

    return unit_sign(unit) or "–"


def _attribute(name: str, value: object) -> str:
    if name == "drive_file":
        return "text of the drive file"
    if name in ("fingerprint", "code_hash", "version", "source"):
        return "…"
    return f"`{value}`"


def quantities_page() -> str:
    """Return the page of the quantities of studies, optimisation and limits."""
    from ltca.quantities import LIMITED, SCALARS
    from ltca.studies.quantities import DEFAULT_QUANTITIES, STAGES

    text = """# Names of results

`cyclo quantities` prints these names; with `--drive DRIVE` it also prints which quantities do not exist for the drive,
and the limits of its file.

## Quantities of studies

`cyclo tolerance --quantities`, `quantities` of a [study file](../../how-to/studies.md), `cyclo optimise --minimise` and
`--subject`. Quantities with a star require an additional solution and are computed only if named, or with `all`.

"""
    text += table(
        ("name", "unit", "meaning"),
        (
            (f"`{name}`{_star(name, DEFAULT_QUANTITIES)}", _unit(SCALARS[name].unit), SCALARS[name].title)
            for name in STAGES
        ),
    )
    text += """## Quantities of limits

`[limits]` of a drive file and the rows of `cyclo check` ([Limits, verdict, advice](../../how-to/verdict.md)): `max_` or `min_`
before the name.

"""
    return text + table(
        ("name", "unit", "meaning"),
        ((f"`{name}`", _unit(one.unit), one.verdict_title) for name, one in LIMITED.items()),
    )


def _star(name: str, default: Iterable[str]) -> str:
    return "" if name in default else " \\*"
