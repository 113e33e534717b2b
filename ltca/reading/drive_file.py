"""Reading drive files: TOML to validated drives, one for each case, with every mistake reported at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ltca.drive.members.limits import Limits, parse_limits
from ltca.drive.members.named_materials import LIKE, with_named_materials
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.mistakes import describe_mistakes
from ltca.drive.names import NAMING, names_a_file
from ltca.drive.parts import Drive
from ltca.drive.tolerances import Tolerances, find_absent, parse_tolerances
from ltca.errors import DriveError, Problem, did_you_mean, shortened
from ltca.output.terminal import shell_words
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.bearing_names import BearingNames
from ltca.reading.changes import INSTEAD
from ltca.reading.contradictions import explain_contradictions, find_cause
from ltca.reading.measured.tables import MeasuredFiles, Named, without_files
from ltca.reading.physical_checks import find_contradictions
from ltca.reading.toml_text import parse_toml, read_text, require_kind

NOMINAL_CASE = "nominal"
BESIDE_THE_DRIVE = ("tolerances", "limits")
"""Tables of a drive file that are no part of the drive."""
MOST_NAMES = 10
"""Largest number of cases named in one message."""
MANY_CASES = 300
"""Number of contradictory cases after which no more are checked."""
MOST_EXPLAINED = 3
"""Largest number of contradictions of cases whose cause is searched."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveFile:
    """A drive and its cases.

    Attributes
    ----------
    name : str
        Name of the drive.
    source : str
        File or name that it was read from.
    cases : dict of str to Drive
        One complete drive for each case, in the order of the file.
    tolerances : dict of str to Distribution
        Distributions of fields by dotted path, for studies alone.
    limits : dict of str to dict of str to Limit
        Limits of results by case and key (`ltca.drive.members.limits`).
    text : str
        Text of the file.

    Examples
    --------
    >>> file = load_drive("paper")
    >>> list(file.cases), file.cases["CS-3"].clearance.bearing
    (['CS-1', 'CS-2', 'CS-3', 'CS-4', 'CS-5', 'CS-6'], 0.03)
    """

    name: str
    source: str
    cases: dict[str, Drive]
    tolerances: Tolerances
    limits: dict[str, Limits]
    text: str

    @property
    def names_compliance(self) -> bool:
        """Whether the file itself says how bodies yield: what is written there is no default."""
        return "compliance" in parse_toml(self.text, self.source).get("analysis", {})

    def select(self, names: list[str] | None) -> dict[str, Drive]:
        """Return some of the cases, all for None.

        Raises
        ------
        DriveError
            When a name is not a case of the drive.

        Examples
        --------
        >>> list(load_drive("paper").select(["CS-3", "CS-1"]))
        ['CS-3', 'CS-1']
        """
        if not names:
            return dict(self.cases)
        unknown = [name for name in names if name not in self.cases]
        if unknown:
            known = listed(self.cases)
            raise DriveError(
                [
                    f"case {shortened(name)} is not defined; the cases are {known}{did_you_mean(name, self.cases)}"
                    for name in unknown
                ],
                self.source,
            )
        return {name: self.cases[name] for name in dict.fromkeys(names)}

    def select_warm(self, names: list[str] | None) -> dict[str, Drive]:
        """Return some of the cases at their temperatures, all for None; those without temperatures as they are.

        Raises
        ------
        DriveError
            When a name is not a case of the drive.

        Examples
        --------
        The shipped drive has no temperatures, so its parts stay as they are.

        >>> file = load_drive("paper")
        >>> file.select_warm(["CS-1"]) == file.select(["CS-1"])
        True
        """
        return {name: warm_drive(drive) for name, drive in self.select(names).items()}


def shipped_drive(name: str = "paper") -> str:
    """Return the text of a drive file that ships with the package."""
    return (resources.files("ltca") / "drives" / f"{name}.toml").read_text(encoding="utf-8")


def load_drive(source: str | Path) -> DriveFile:
    """Read a drive from a TOML file or, by its name, one that ships with the package.

    Parameters
    ----------
    source : str or Path
        File name, or ``paper``, ``robot-joint``, ``rv`` or ``sleeved``; a file of such a name is ``./rv``.

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
    >>> load_drive("robot-joint").cases["nominal"].disc.number_of_discs
    2
    """
    if not isinstance(source, str | Path):
        raise DriveError([f"source = {shortened(source)}: must be the name of a file or of a shipped drive"])
    name = str(source)
    if name in SHIPPED_DRIVES:
        return parse_drive(shipped_drive(name), name)
    path = Path(source)
    hint = (
        f"no such file; give a TOML file or a shipped drive, {', '.join(SHIPPED_DRIVES)}{did_you_mean(name, SHIPPED_DRIVES)} "
        f"(to write a drive to start from: cyclo init {shell_words([path.name])})"
    )
    return parse_drive(read_text(path, hint), name)


def parse_drive(text: str, source: str = "drive") -> DriveFile:
    """Validate the text of a drive file; see `load_drive`."""
    table = parse_toml(text, source)
    require_kind(table, "drive", source)
    cases = table.pop("case", [])
    scatter, bounds = table.pop("tolerances", {}), table.pop("limits", {})
    table.setdefault("name", Path(source).stem)
    problems: list[str] = []
    measured = MeasuredFiles(Path(source).parent)
    # Mistakes of the common part would repeat in every case: it is validated first, alone.
    base_problems: list[str] = []
    bearings, written = BearingNames.of_table(table.pop("bearings", {}), base_problems), table.get("crank_bearing")
    table = bearings.resolved(table, base_problems)
    base = _validate(table, base_problems, measured)
    tolerances = parse_tolerances(scatter, problems, base)
    named = _named_cases(cases, problems)
    problems += [
        f"case {name}: analysis: must stand outside the cases, which are analysed alike"
        for name, overrides in named.items()
        if overrides.pop("analysis", None) is not None
    ]
    limits = parse_limits(bounds, problems)
    own = {name: parse_limits(overrides.pop("limits", {}), problems) for name, overrides in named.items()}
    if base_problems or base is None:
        raise DriveError(problems + bearings.told(base_problems), source)
    drives: dict[str, Drive] = {}
    mistakes: dict[str, list[str]] = {}
    for name, overrides in named.items():
        overrides = bearings.resolved(overrides, mistakes.setdefault(name, []), written)
        if mistakes[name]:
            continue
        # Parts that a case does not change are valid already; a measured flank deviates from the design of every case.
        changed = {key: _merged(table.get(key), value) for key, value in overrides.items()}
        if without_files(table)[1]:
            changed.setdefault("disc", table["disc"])
        drive = _validate({**_parts(base), **changed, "case": name}, mistakes[name], measured)
        if drive is not None:
            drives[name] = drive
    problems += _once(mistakes, {})
    if not named and not problems:
        drives[NOMINAL_CASE] = base
    found, left = _contradictions(base, drives)
    problems += found
    problems = problems or find_absent(tolerances, drives.values())
    if problems:
        raise DriveError(bearings.told(problems), source, f"{left} cases not checked" if left else "")
    each = {name: {**limits, **own.get(name, {})} for name in drives}
    return DriveFile(
        name=str(table["name"]), source=source, cases=drives, tolerances=tolerances, limits=each, text=text
    )


def _contradictions(base: Drive, drives: dict[str, Drive]) -> tuple[list[str], int]:
    """Contradictions of the common part and of the cases, each once, and the number of cases that were not checked."""
    common = find_contradictions(base)
    found: dict[str, list[Problem]] = {}
    wrong = 0
    for name, drive in drives.items():
        found[name] = common if drive == base else find_contradictions(drive)
        wrong += bool(found[name])
        if wrong >= MANY_CASES:
            break
    problems, mends = find_cause(base, common)
    suffering = {name for name, those in found.items() if those and mends(drives[name])}
    if suffering:  # one field of the common part causes them, whatever else differs from case to case
        everywhere = [] if suffering < set(found) else problems
        told: dict[str, list[Problem]] = {name: [] if everywhere else problems for name in suffering}
        problems = everywhere
    else:
        everywhere = [problem for problem in common if all(problem in those for those in found.values())]
        problems = problems if everywhere == common else explain_contradictions(base, everywhere)
        told = {}
    explained: dict[tuple[Problem, ...], list[Problem]] = {}
    for name, those in found.items():
        if name in told:
            continue
        own = tuple(problem for problem in those if problem not in everywhere)
        # The search for the cause of a contradiction takes a tenth of a second: the first few are enough.
        if own and own not in explained and len(explained) < MOST_EXPLAINED:
            explained[own] = explain_contradictions(drives[name], [*own])
        told[name] = explained.get(own, [*own])
    return [*problems, *_once(told, drives)], len(drives) - len(found)


def _once(mistakes: Mapping[str, Sequence[str]], drives: dict[str, Drive]) -> list[str]:
    """Mistakes of cases, each once with the names of its cases."""
    owners: dict[str, list[str]] = {}
    for name, problems in mistakes.items():
        for problem in problems:
            owners.setdefault(problem, []).append(name)
    alone = list(drives) == [NOMINAL_CASE]
    return [
        problem if alone else f"case{'' if len(names) == 1 else 's'} {listed(names)}: {problem}"
        for problem, names in owners.items()
    ]


def listed(names: Iterable[str]) -> str:
    """Return names separated by commas, the first few of many."""
    names = [*names]
    shown = ", ".join(names[:MOST_NAMES])
    return shown if len(names) <= MOST_NAMES else f"{shown} and {len(names) - MOST_NAMES} more"


def _named_cases(cases: Any, problems: list[str]) -> dict[str, dict[str, Any]]:
    if not isinstance(cases, list) or not all(isinstance(case, dict) for case in cases):
        problems.append("case: must be an array of tables, written [[case]]")
        return {}
    named: dict[str, dict[str, Any]] = {}
    for number, case in enumerate(cases):
        name = case.get("name")
        if not isinstance(name, str):
            problems.append(f"case {number}: name is missing or no text; every [[case]] needs one")
        elif not names_a_file(name):
            problems.append(f"case {number}: name = {shortened(name)}: {NAMING}")
        elif name in named:
            problems.append(f"case {name}: name is used twice; must be unique")
        elif "case" in case:
            problems.append(f"case {name}: case: must be left out; `name` is what a case is called")
        else:
            named[name] = {key: value for key, value in case.items() if key != "name"}
    return named


def _parts(drive: Drive) -> dict[str, Any]:
    return {item.name: getattr(drive, item.name) for item in fields(drive)}


def _merged(below: Any, value: Any) -> Any:
    if isinstance(value, dict) and LIKE in value:
        return value  # a named material replaces all of it
    if isinstance(below, str) and isinstance(value, dict):
        return {LIKE: below, **value}  # properties that differ from the named material
    if (
        not isinstance(below, dict)
        or not isinstance(value, dict)
        or below.get("kind") != value.get("kind", below.get("kind"))
    ):
        return value  # a seat of another kind replaces all of it
    kept = {key: over for key, over in below.items() if INSTEAD.get(key) not in value}
    return {**kept, **{key: _merged(below.get(key), over) for key, over in value.items()}}


_ADAPTER = TypeAdapter(Drive)


def build_drive(table: dict[str, Any]) -> Drive:
    """Return the fully checked drive of nested plain tables, as in a drive file without cases; DriveError with every
    mistake.

    Tolerances and limits are no part of a drive and are ignored.
    """
    problems: list[str] = []
    bearings = BearingNames.of_table(table.get("bearings", {}), problems)
    plain = {name: value for name, value in table.items() if name not in (*BESIDE_THE_DRIVE, "bearings")}
    drive = _validate(bearings.resolved(plain, problems), problems)
    if drive is not None and not problems:
        problems += explain_contradictions(drive, find_contradictions(drive))
    if problems or drive is None:
        raise DriveError(bearings.told(problems))
    return drive


def _validate(table: dict[str, Any], problems: list[str], measured: MeasuredFiles | None = None) -> Drive | None:
    unnamed: list[str] = []
    table = with_named_materials(table, unnamed)
    problems += unnamed
    named: Named = {}
    if measured is not None:
        table, named = without_files(table)
    try:
        drive = _ADAPTER.validate_python(table)
    except ValidationError as error:
        problems += describe_mistakes(error.errors())
        return None
    if named and not unnamed and measured is not None:
        wrong: list[str] = []
        drive = measured.with_measured(drive, named, wrong)
        problems += wrong
        return None if wrong else drive
    return None if unnamed else drive
