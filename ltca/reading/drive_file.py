"""Reading drive files: TOML to validated drives, one for each case, with every mistake reported at once."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ltca.drive.mistakes import describe_mistake
from ltca.drive.parts import Drive
from ltca.drive.tolerances import Tolerances, parse_tolerances
from ltca.errors import DriveError
from ltca.reading.physical_checks import find_contradictions

NOMINAL_CASE = "nominal"


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveFile:
    """A drive and its cases.

    Attributes
    ----------
    name : str
        Name of the drive.
    source : str
        Where it was read from.
    cases : dict of str to Drive
        One complete drive for each case, in the order of the file.
    tolerances : dict of str to Distribution
        How fields scatter, by dotted path; for studies alone.
    text : str
        What was read.
    """

    name: str
    source: str
    cases: dict[str, Drive]
    tolerances: Tolerances
    text: str

    def select(self, names: list[str] | None) -> dict[str, Drive]:
        """Return some of the cases, all for None.

        Raises
        ------
        DriveError
            When a name is not a case of the drive.
        """
        if not names:
            return dict(self.cases)
        unknown = [name for name in names if name not in self.cases]
        if unknown:
            raise DriveError(
                [f"case {name!r} is not defined; the cases are {', '.join(self.cases)}" for name in unknown],
                self.source,
            )
        return {name: self.cases[name] for name in dict.fromkeys(names)}


def shipped_drive(name: str = "paper") -> str:
    """Return the text of a drive file that ships with the package."""
    return (resources.files("ltca") / "drives" / f"{name}.toml").read_text(encoding="utf-8")


def load_drive(source: str | Path) -> DriveFile:
    """Read a drive from a TOML file or, by the name ``paper``, from the package.

    Parameters
    ----------
    source : str or Path
        File name, or ``paper``.

    Returns
    -------
    DriveFile
        The validated cases.

    Raises
    ------
    DriveError
        When the file cannot be read or the drive is wrong; all mistakes together.

    Examples
    --------
    >>> load_drive("paper").cases["CS-3"].clearance.bearing
    0.03
    """
    if str(source) == "paper":
        return parse_drive(shipped_drive(), "paper")
    path = Path(source)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise DriveError(
            [f"no such file; give a TOML file or 'paper' ('cyclo init {path.name}' writes a copy to start from)"],
            str(source),
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise DriveError([f"cannot be read: {error}"], str(source)) from error
    return parse_drive(text, str(source))


def parse_drive(text: str, source: str = "drive") -> DriveFile:
    """Validate the text of a drive file; see `load_drive`."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DriveError([f"is not valid TOML: {error}"], source) from error
    cases = table.pop("case", [])
    scatter = table.pop("tolerances", {})
    table.setdefault("name", Path(source).stem)
    problems: list[str] = []
    tolerances = parse_tolerances(scatter, problems)
    named = _named_cases(cases, problems)
    drives: dict[str, Drive] = {}
    # Mistakes of the common part come back in every case: the base is validated alone, first.
    base_problems: list[str] = []
    if isinstance(table["name"], str) and not _names_a_file(table["name"]):
        base_problems.append(f"name = {table['name']!r}: must be a text that can name a folder, without / and \\")
    base = _validate(table, base_problems)
    if base_problems:
        raise DriveError(problems + base_problems, source)
    contradictions: dict[str, list[str]] = {}
    for name, overrides in named.items():
        case_problems: list[str] = []
        drive = _validate(_merge(table, overrides), case_problems)
        problems += [f"case {name}: {problem}" for problem in case_problems]
        if drive is not None:
            drives[name] = drive
            contradictions[name] = find_contradictions(drive)
    if not named and base is not None:
        drives[NOMINAL_CASE] = base
        contradictions[NOMINAL_CASE] = find_contradictions(base)
    # A contradiction of the common part that no case mends is said once.
    common = [] if base is None else find_contradictions(base)
    common = [problem for problem in common if all(problem in found for found in contradictions.values())]
    problems += common
    for name, found in contradictions.items():
        problems += [f"case {name}: {problem}" for problem in found if problem not in common]
    if problems:
        raise DriveError(problems, source)
    return DriveFile(name=str(table["name"]), source=source, cases=drives, tolerances=tolerances, text=text)


def _named_cases(cases: Any, problems: list[str]) -> dict[str, dict[str, Any]]:
    if not isinstance(cases, list) or not all(isinstance(case, dict) for case in cases):
        problems.append("case: must be an array of tables, written [[case]]")
        return {}
    named: dict[str, dict[str, Any]] = {}
    for number, case in enumerate(cases):
        name = case.get("name")
        if not isinstance(name, str):
            problems.append(f"case {number}: name is missing or no text; every [[case]] needs one")
        elif not _names_a_file(name):
            problems.append(f"case {number}: name = {name!r}: must be a text that can name a file, without / and \\")
        elif name in named:
            problems.append(f"case {name}: name is used twice; must be unique")
        else:
            named[name] = {key: value for key, value in case.items() if key != "name"}
    return named


def _names_a_file(name: str) -> bool:
    """Results go to files and folders of these names."""
    return bool(name.strip(" .")) and not any(sign in name for sign in "/\\\0")


def _merge(base: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in overrides.items():
        below = merged.get(key)
        merged[key] = _merge(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
    return merged


_ADAPTER = TypeAdapter(Drive)


def build_drive(table: dict[str, Any]) -> Drive:
    """Return the drive of nested plain tables (as in a drive file without cases), fully checked.

    Tolerances are no part of a drive and are passed over.

    Raises
    ------
    DriveError
        With every mistake.
    """
    problems: list[str] = []
    drive = _validate({name: value for name, value in table.items() if name != "tolerances"}, problems)
    if drive is not None:
        problems += find_contradictions(drive)
    if problems or drive is None:
        raise DriveError(problems)
    return drive


def _validate(table: dict[str, Any], problems: list[str]) -> Drive | None:
    disc = table.get("disc")
    if isinstance(disc, dict) and "torque_share" not in disc:
        discs = disc.get("number_of_discs", 1)
        if isinstance(discs, int) and discs >= 1:
            table = {**table, "disc": {**disc, "torque_share": 1.0 / discs}}
    try:
        return _ADAPTER.validate_python(table)
    except ValidationError as error:
        problems += [describe_mistake(detail) for detail in error.errors()]
        return None
