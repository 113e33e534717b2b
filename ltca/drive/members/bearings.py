"""Bought crank bearings by name: ``crank_bearing.bearing = "K20x26x12"`` stands for numbers that ship as data, with sources.

Only bearings whose outer race is the bore of the disc can be named: needle cages (K) and cylindrical rollers with cage and inner
ring but without outer ring (RN). Others are refused with the reason.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass as plain_dataclass
from functools import cache
from importlib import resources
from math import asin, pi
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, PositiveLength
from ltca.drive.mistakes import describe_mistakes
from ltca.drive.units.quantities import COUNT, quantity
from ltca.errors import DriveError, shortened

FILE = "bearings.toml"
BEARING = "bearing"
CLEARANCE_CLASS = "clearance_class"
CLASSES = ("C2", "CN", "C3", "C4", "C5")
"""Groups of radial internal clearance (ISO 5753-1), from small to large."""
FULLEST = 0.97
"""Largest part of a full complement that a row of rollers may have: what is left is its running clearance."""
SLENDEREST = 10.0
"""Largest length by diameter of a needle (ISO 5593 calls rollers of small diameter and up to that ratio needles)."""
FLATTEST = 0.4
"""Smallest length by diameter of a roller that is guided without tilting."""
HINT = "take a needle cage (K) or cylindrical rollers without outer ring (RN), whose outer race is the bore of the disc"
WITH_OUTER_RING = {
    r"(HK|BK|HMK|HN|BN|SCE|DL|TA|TLA)\d": "a drawn cup needle bearing, whose cup would sit in the bore of the disc",
    r"(RNA|NA|RNAO|NAO|NK|NKS|NKI|NKIS|NKJ|NKJS|RNAF|NAF|PNA)\d": "a needle bearing with an outer ring of its own",
    r"(RNU|NU|NJ|NUP|NUB|NF|NFP|NCF|NJG|NNCF|NNF|NN|NNU|SL|RSL|N)\d": "a cylindrical roller bearing with its own outer ring",
    r"(NUTR|NATR|NATV|NUKR|KR|STO|RSTO)\d": "a track roller, whose thick outer ring is of its own",
    r"([16]\d|0|4)\d{2,4}": "a ball bearing: balls run in grooves of rings of their own",
    r"(7\d{3}|3[23]\d{2}$)": "an angular contact ball bearing: balls run in grooves of rings of their own",
    r"(3[0-3]\d{3})": "a tapered roller bearing with an outer ring of its own",
    r"(2[0-4]\d{3}|C\d{4})": "a self-aligning roller bearing with an outer ring of its own",
}
"""Designations of bearings that bring an outer ring into the disc, and what they are."""

Force = Annotated[float, quantity("N", gt=0.0)]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class NamedBearing:
    """A bought bearing, as the shipped file and ``[bearings."…"]`` of a drive file give it.

    Attributes
    ----------
    inner_race_diameter : float
        F_w of a needle cage, F of an inner ring: diameter that the rollers run on, mm.
    outer_race_diameter : float
        E_w or E: diameter over the rollers, nominal bore of the disc, mm.
    roller_length : float
        Effective length L_we of the rollers, mm.
    number_of_rollers : int
        Z.
    series : str
        K, RN, or what the user calls it.
    bore : float or None
        Bore of the inner ring, mm; without one the crank itself is the inner race.
    width : float or None
        Width of cage or inner ring, mm.
    dynamic_load_rating, static_load_rating : float or None
        C and C_0 of the maker, N; for comparison, lives are computed from the rollers (ISO 281).
    source : str
        Where the numbers are from.
    """

    inner_race_diameter: PositiveLength
    outer_race_diameter: PositiveLength
    roller_length: PositiveLength
    number_of_rollers: Annotated[int, Field(ge=3, le=500), COUNT]
    series: str = ""
    bore: PositiveLength | None = None
    width: PositiveLength | None = None
    dynamic_load_rating: Force | None = None
    static_load_rating: Force | None = None
    source: str = ""

    @property
    def roller_diameter(self) -> float:
        """D_we = (E − F)/2, mm."""
        return 0.5 * (self.outer_race_diameter - self.inner_race_diameter)

    @property
    def pitch_diameter(self) -> float:
        """D_pw = (E + F)/2, mm."""
        return 0.5 * (self.outer_race_diameter + self.inner_race_diameter)

    @property
    def fill(self) -> float:
        """Number of rollers by that of a full complement, π/asin(D_we/D_pw)."""
        return self.number_of_rollers * asin(self.roller_diameter / self.pitch_diameter) / pi

    @property
    def aspect_ratio(self) -> float:
        """L_we/D_we."""
        return self.roller_length / self.roller_diameter

    @property
    def fields(self) -> dict[str, float]:
        """Fields of ``[crank_bearing]`` that the bearing stands for."""
        return {
            "inner_race_radius": 0.5 * self.inner_race_diameter,
            "outer_race_radius": 0.5 * self.outer_race_diameter,
            "number_of_rollers": self.number_of_rollers,
            "roller_radius": 0.5 * self.roller_diameter,
            "roller_length": self.roller_length,
        }

    def problems(self) -> list[str]:
        """Return what the numbers cannot be together, one sentence each."""
        if self.roller_diameter <= 0.0:
            return [
                f"outer_race_diameter = {self.outer_race_diameter:g} mm: must be greater than inner_race_diameter = "
                f"{self.inner_race_diameter:g} mm"
            ]
        told = []
        if self.fill > FULLEST:
            most = int(FULLEST * self.number_of_rollers / self.fill)
            told.append(
                f"number_of_rollers = {self.number_of_rollers}: must be at most {most}, or rollers of diameter "
                f"{self.roller_diameter:g} mm have no room on a pitch circle of diameter {self.pitch_diameter:g} mm"
            )
        if not FLATTEST <= self.aspect_ratio <= SLENDEREST:
            told.append(
                f"roller_length = {self.roller_length:g} mm: must be {FLATTEST:g} to {SLENDEREST:g} times the diameter "
                f"{self.roller_diameter:g} mm of the rollers"
            )
        if self.width is not None and self.roller_length > self.width:
            told.append(f"roller_length = {self.roller_length:g} mm: must be at most {self.width:g} mm, the width")
        if self.bore is not None and self.bore >= self.inner_race_diameter:
            told.append(
                f"bore = {self.bore:g} mm: must be less than inner_race_diameter = {self.inner_race_diameter:g} mm"
            )
        return told


_ADAPTER = TypeAdapter(NamedBearing)
_LENGTH = TypeAdapter(PositiveLength)


@plain_dataclass(frozen=True, slots=True, kw_only=True)
class ClearanceClasses:
    """Radial internal clearance by class and bore (ISO 5753-1).

    Attributes
    ----------
    diameters : tuple of float
        Ends of the ranges of bores, ascending, mm.
    ranges : dict of str to tuple of (float, float)
        Least and largest clearance of every range of bores, by class, mm.
    source : str
        Where they are from.
    """

    diameters: tuple[float, ...]
    ranges: dict[str, tuple[tuple[float, float], ...]]
    source: str

    def range_of(self, name: str, diameter: float) -> tuple[float, float] | None:
        """Return least and largest clearance of a class, mm; None beyond the last range of bores."""
        ends = zip(self.diameters[1:], self.ranges[name], strict=True)
        return next((limits for end, limits in ends if diameter <= end), None)


@cache
def _data() -> tuple[dict[str, NamedBearing], ClearanceClasses]:
    import tomllib

    table = tomllib.loads((resources.files("ltca") / "drive" / "members" / FILE).read_text(encoding="utf-8"))
    sources, clearance = table["sources"], table["clearance"]
    entries = {
        name: _ADAPTER.validate_python({**entry, "source": sources[entry["source"]]})
        for name, entry in table["bearings"].items()
    }
    classes = ClearanceClasses(
        diameters=tuple(clearance["diameters"]),
        ranges={name: tuple((1e-3 * low, 1e-3 * high) for low, high in clearance[name]) for name in CLASSES},
        source=sources["clearance"],
    )
    return entries, classes


def named_bearings() -> dict[str, NamedBearing]:
    """Return the shipped bearings by name.

    Examples
    --------
    >>> named_bearings()["RN205"].outer_race_diameter
    46.5
    """
    return _data()[0]


def clearance_classes() -> ClearanceClasses:
    """Return the classes of radial internal clearance.

    Examples
    --------
    >>> clearance_classes().range_of("CN", 25.0)
    (0.02, 0.045)
    """
    return _data()[1]


def named_bearing(name: str, own: Mapping[str, NamedBearing] | None = None) -> NamedBearing:
    """Return a bearing by its designation: spaces, large and small letters and the sign of multiplication do not matter.

    Parameters
    ----------
    name : str
        ``K20x26x12``, ``RN 205``.
    own : mapping of str to NamedBearing, optional
        Entries of a drive file, which go before those shipped.

    Raises
    ------
    DriveError
        When there is none, with the nearest names, or when it brings an outer ring.
    """
    known = {**named_bearings(), **(own or {})}
    spelled = {_plain(each): entry for each, entry in known.items()}
    plain = _plain(name)
    if plain in spelled:
        return spelled[plain]
    for pattern, kind in WITH_OUTER_RING.items():
        if re.match(pattern, plain):
            raise DriveError([f"{shortened(name)}: is {kind}; {HINT}"])
    near = ", ".join(_nearest_names(plain, known))
    raise DriveError(
        [
            f'{shortened(name)}: is not known by name; the nearest are {near}; or give its numbers in [bearings."{name[:40]}"]'
        ]
    )


def _nearest_names(plain: str, known: Mapping[str, NamedBearing], count: int = 3) -> list[str]:
    """The known names nearest to one that is not: cages by their sizes, others by their letters."""
    from difflib import SequenceMatcher

    asked = re.fullmatch(r"K([0-9.]{1,6})X([0-9.]{1,6})X([0-9.]{1,6})", plain)
    try:
        sizes = [float(each) for each in asked.groups()] if asked else []
    except ValueError:
        sizes = []

    def distance(name: str) -> float:
        entry = known[name]
        if not sizes:
            return -SequenceMatcher(None, plain[:80], _plain(name)).ratio()
        width = entry.roller_length if entry.width is None else entry.width
        own = (entry.inner_race_diameter, entry.outer_race_diameter, width)
        return sum(abs(one - other) for one, other in zip(own, sizes, strict=True))

    return sorted(known, key=distance)[:count]


def _plain(name: str) -> str:
    return re.sub(r"\s+", "", name).replace("×", "x").replace("X", "x").replace(",", ".").upper()


def clearance_range(bearing: NamedBearing, clearance_class: str) -> tuple[float, float] | None:
    """Return least and largest radial internal clearance, mm; that of a cage by the diameter under its needles.

    Examples
    --------
    >>> clearance_range(named_bearings()["RN210"], "C3")
    (0.05, 0.08)
    """
    return clearance_classes().range_of(clearance_class, bearing.bore or bearing.inner_race_diameter)


def own_bearings(table: Any, problems: list[str]) -> dict[str, NamedBearing]:
    """Return the bearings of ``[bearings."…"]`` of a drive file; what is wrong with them is added to the problems."""
    if not isinstance(table, Mapping):
        problems.append('bearings: must be a table of tables, written [bearings."NAME"]')
        return {}
    found = {}
    for name, entry in table.items():
        try:
            bearing = _ADAPTER.validate_python(entry)
        except ValidationError as error:
            names = list(NamedBearing.__dataclass_fields__)
            problems += describe_mistakes(error.errors(), ("bearings", name), names)
            continue
        told = bearing.problems()
        problems += [f"bearings.{name}.{problem}" for problem in told]
        if not told:
            found[name] = bearing
    return found


def with_named_bearing(
    table: Mapping[str, Any],
    problems: list[str],
    own: Mapping[str, NamedBearing] | None = None,
    common: Any = None,
) -> dict[str, Any]:
    """Return the table of a drive with the fields of a named bearing in the place of its name.

    Fields beside the name must be those of the bearing. ``clearance_class`` becomes ``clearance.bearing``, its middle.
    Where there are problems the table is no drive: another bearing may stand in it.

    Parameters
    ----------
    table : mapping
        Nested plain tables, as in a drive file, of a drive or of one case.
    problems : list of str
        What is wrong is added.
    own : mapping of str to NamedBearing, optional
        Of `own_bearings`.
    common : object, optional
        ``crank_bearing`` of the common part as it was written, whose name and class hold in a case that gives one of them.
    """
    part = table.get("crank_bearing")
    if not isinstance(part, Mapping) or not {BEARING, CLEARANCE_CLASS} & part.keys():
        return dict(table)
    written = {**(common if isinstance(common, Mapping) else {}), **part}
    name, clearance_class = written.get(BEARING), written.get(CLEARANCE_CLASS)
    below = {key: value for key, value in part.items() if key not in (BEARING, CLEARANCE_CLASS)}
    # What is not named is no missing field besides: any bearing stands in, so that other mistakes are told too.
    unnamed = {**table, "crank_bearing": {**named_bearings()["RN205"].fields, **below}}
    if not isinstance(name, str):
        told = "must be the designation of a bearing" if name is not None else "must be given with clearance_class"
        problems.append(f"crank_bearing.bearing{'' if name is None else f' = {shortened(name)}'}: {told}")
        return unnamed
    try:
        bearing = named_bearing(name, own)
    except DriveError as error:
        problems += [f"crank_bearing.bearing = {problem}" for problem in error.problems]
        return unnamed
    problems += [
        f"crank_bearing.{field} = {shortened(below[field])}: must be left out, or {value:g}, beside "
        f"crank_bearing.bearing = {shortened(name)}"
        for field, value in bearing.fields.items()
        if field in below and _differs(below[field], value)
    ]
    found = {**table, "crank_bearing": {**bearing.fields, **below}}
    if clearance_class is not None:
        _set_clearance(found, bearing, clearance_class, CLEARANCE_CLASS in part, problems)
    return found


def _set_clearance(
    table: dict[str, Any], bearing: NamedBearing, clearance_class: Any, is_given: bool, problems: list[str]
) -> None:
    path = f"crank_bearing.clearance_class = {shortened(clearance_class)}"
    if clearance_class not in CLASSES:
        problems.append(f"{path}: must be {', '.join(CLASSES[:-1])} or {CLASSES[-1]}")
        return
    limits = clearance_range(bearing, clearance_class)
    if limits is None:
        most = clearance_classes().diameters[-1]
        problems.append(f"{path}: bores up to {most:g} mm have their classes here; give clearance.bearing")
        return
    middle, clearance = round(0.5 * sum(limits), 9), table.get("clearance", {})
    if not isinstance(clearance, Mapping):  # wrong, and told where tables are validated
        return
    if "bearing" in clearance:
        if is_given and _differs(clearance["bearing"], middle):
            problems.append(
                f"clearance.bearing = {shortened(clearance['bearing'])}: must be left out, or {middle:g} mm, beside {path} "
                f"({limits[0]:g} to {limits[1]:g} mm)"
            )
        return
    table["clearance"] = {**clearance, "bearing": middle}


def _differs(given: Any, value: float) -> bool:
    """Tell whether a number, or a text with a unit, is another; what is neither is told where fields are validated."""
    try:
        return abs(_LENGTH.validate_python(given) - value) > 1e-9
    except ValidationError:
        return False


NAMING_FIELDS = {
    "crank_bearing.bearing": (
        "text",
        "a designation (docs/reference/bearings.md)",
        'Bought bearing by its name, ``"K20x26x12"``: stands for both races, number, radius and length of the rollers. '
        'Own ones stand in ``[bearings."NAME"]``.',
    ),
    "crank_bearing.clearance_class": (
        "choice",
        ", ".join(f'"{name}"' for name in CLASSES),
        "Group of radial internal clearance (ISO 5753-1) of a named bearing: stands for ``clearance.bearing``, its middle.",
    ),
}
"""Kind, bounds and meaning of what drive files may say in the place of fields."""
