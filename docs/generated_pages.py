"""Reference pages that the program itself tells: the drive file, the commands, the dataset, names of results.

``conf.py`` writes them before Sphinx reads its sources; they are no part of the repository. Nothing is listed here: fields come
from their definitions, options from the parsers, variables from what writes them.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

LEFT_OUT = "left out"
NOTE = "<!-- Written by docs/generated_pages.py: do not edit. -->\n"


def write_pages(folder: Path) -> None:
    """Write every page that differs from what is there, so that builds are not repeated for nothing."""
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


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table; bars within cells are no borders."""
    titles = list(head)
    lines = [titles, ["---"] * len(titles), *rows]
    return "".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |\n" for row in lines) + "\n"


def drive_file_page() -> str:
    """Every field of a drive file."""
    from ltca.drive.declaration import by_table, gathered, table_of
    from ltca.drive.engine_support import ENGINES, refusals

    text = """# The drive file

Every field, table by table, as `cyclo fields` prints them; this page is written from the definitions themselves. A drive file
is TOML. Plain numbers are in the unit of the field, a text carries its own ([Quantities and units](../units.md)).
A field that is no field, a value out of its bounds and parts that cannot be together are refused with one sentence each.

Fields of all discs may stand in `[[disc.of]]` and `[[crank.of]]` for a single disc or eccentric, `N` being its number
from 0. Beside the drive itself a file may hold

- `[[case]]`: a `name` and any of the tables below, whose fields take the place of those of the common part,
- [`[limits]`](../../how-to/verdict.md): what results may reach,
- [`[tolerances]`](../../how-to/tolerances.md): how fields scatter, for studies alone.

Engines take every field or refuse it by name. They are

"""
    text += table(("engine", "what it is"), ENGINES.items())
    text += "A test changes each field in each engine and looks for the answer to move (`tests/contract`).\n\n"
    for name, fields in by_table(gathered()).items():
        told = table_of(name) if name else None
        text += f"## {name}\n\n" if name else "## At the head of the file\n\n"
        if told is not None:
            text += f"{told.meaning.replace('``', '`')}{' May be left out.' if told.optional else ''}\n\n"
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
    """Words as they stand in a file; nothing as a dash."""
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
    """Every command with its options and examples."""
    from importlib.metadata import entry_points

    from ltca.commands.program import GROUP, ORDER, build_parser

    installed = [entry.name for entry in entry_points(group=GROUP)]
    names = [name for name in ORDER if name in installed] + sorted(set(installed) - set(ORDER))
    modules = {entry.name: entry.load() for entry in entry_points(group=GROUP)}
    text = """# Commands

`cyclo COMMAND --help` says what stands here. Numbers of options may carry a unit (`--torque "377.3 N m"`,
[Quantities and units](../units.md)); `DRIVE` is a drive file, or `paper` for the shipped one.
Angles may be several, separated by spaces, negative ones too. Every printed table names torque, direction of the crank,
model, positions and case. Exit statuses, folders and what happens when a run is interrupted:
[Exit statuses, files and processes](../files_and_processes.md).

"""
    text += table(
        ("command", "what it does"),
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
    """Help as a cell: what looks like markup is none."""
    return text.replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


def dataset_page() -> str:
    """Every variable and coordinate of ``results.nc``, and what ``summary.json`` holds."""
    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.results import build_dataset
    from ltca.geometry.placement import position_angles
    from ltca.quantities import QUANTITIES, SCALARS, SCHEMA_VERSION
    from ltca.reading.drive_file import load_drive

    text = """# The dataset

`results.nc` of `cyclo run` is netCDF, `result.dataset` in Python is the same for one case; `pressure.nc` (`--pressure`) and
`fem.nc` (`cyclo fem`) have the same names. Dimensions stand in the order `case`, `disc`, `crank`, `position`, then `pin`,
`roller`, `hole` or `lobe`, always all that a variable has, also where they are of size 1.
Units are in the attribute `units`, what a variable is in `long_name`. Discs, cranks, pins, rollers and holes are numbered from 0,
counter-clockwise; signs and frames: [Conventions](../../theory/conventions.md).

A variable is there where the drive has it: of friction with `[friction]`, of seats with loose pins and sleeves, of walls
with `--compliance fe` and `hybrid`. What one case has and another has not is not a number there.

The attribute `schema_version`, a whole number, says which names, units and dimensions a dataset has: it grows when one of
them changes or goes, not when one is added. This is version {version}.

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
        ("attribute", "of the paper's CS-1"),
        ((f"`{name}`", _attribute(name, value)) for name, value in dataset.attrs.items()),
    )
    text += """No clock and no folder is among them: same input, same bytes. `code_hash` is that of the code, `fingerprint`
that of each case's drive, `status` is `complete`, or `partial` where a position has no answer.

## summary.json

Scalars of each case, their units at the end of their names (`_N`, `_MPa`, `_mm`, `_Nmm`, `_arcmin`, `_arcsec`, `_deg`, `_W`).
Means and peaks run over the positions, `refined_…` are extremes over the whole turn, refined between them; null is what the
engine or the positions cannot say. `#` is the number of a disc or crank.

"""
    text += table(
        ("key", "also refined", "meaning"),
        ((f"`{one.key}`", "yes" if one.refined else "", one.title) for one in SCALARS.values() if one.in_summary),
    )
    text += FEM_SUMMARY
    return text + table(
        ("key of `cyclo fem`", "the same, older", "meaning"),
        (
            (f"`{one.fem_key}`", f"`{one.older_fem_key}`", one.in_fem or one.description)
            for one in arrays
            if one.older_key
        ),
    )


FEM_SUMMARY = """
## summary.json of cyclo fem

Arrays of `fem.nc` under their names with the unit behind them, lists by disc and part. In datasets and in the summary of
`cyclo run`, `pressure_mid` is the largest pressure at mid-width, where a contact is in plane strain, and `pressure_max` the
largest anywhere along the width, its ends included. Full finite elements are plane and know the first alone. Their older keys
call it `pressure_max` and stay beside the new ones, with the same values.

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
    """Names that studies, aims and limits take."""
    from ltca.quantities import LIMITED, SCALARS
    from ltca.studies.quantities import DEFAULT_QUANTITIES, STAGES

    text = """# Names of results

`cyclo quantities` prints them; with `--drive DRIVE` it says which of them the drive has not, and the limits of its file.

## Of studies

`cyclo tolerance --quantities`, `quantities` of a [study file](../../how-to/studies.md), `cyclo optimise --minimise` and
`--subject`. Those with a star cost another solution and come when named, or with `all`.

"""
    text += table(
        ("name", "unit", "meaning"),
        (
            (f"`{name}`{_star(name, DEFAULT_QUANTITIES)}", _unit(SCALARS[name].unit), SCALARS[name].title)
            for name in STAGES
        ),
    )
    text += """## Of limits

`[limits]` of a drive file and the rows of `cyclo check` ([Limits, verdict, advice](../../how-to/verdict.md)): `max_` or `min_`
before the name.

"""
    return text + table(
        ("name", "unit", "meaning"),
        ((f"`{name}`", _unit(one.unit), one.verdict_title) for name, one in LIMITED.items()),
    )


def _star(name: str, default: Iterable[str]) -> str:
    return "" if name in default else " \\*"
