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
from typing import Annotated, Literal, get_args

from pydantic import Field, TypeAdapter
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, PositiveLength
from ltca.drive.members.crank import CrankBearing
from ltca.drive.members.preload import Force
from ltca.drive.units.quantities import COUNT
from ltca.errors import DriveError, shortened

FILE = "bearings.toml"
ClearanceClass = Literal["C2", "CN", "C3", "C4", "C5"]
CLASSES: tuple[str, ...] = get_args(ClearanceClass)
"""Groups of radial internal clearance (ISO 5753-1), from small to large."""
FULLEST = 0.97
"""Largest part of a full complement that a row of rollers may have: what is left is its running clearance."""
SLENDEREST = 10.0
"""Largest length by diameter of a needle (ISO 5593 calls rollers of small diameter and up to that ratio needles)."""
FLATTEST = 0.4
"""Smallest length by diameter of a roller that is guided without tilting."""
HINT = "take a needle cage (K) or cylindrical rollers without outer ring (RN), whose outer race is the bore of the disc"
MAKERS = r"^(SKF|INA|FAG|NSK|NTN|IKO|NBS|KOYO|NACHI|TIMKEN|SCHAEFFLER)[-./]?"
"""What may stand before a designation."""
SIZE = r"([0-9]{1,4}(?:\.[0-9]{1,3})?)"
CAGE = rf"K{SIZE}[X/-]{SIZE}[X/-]{SIZE}[-./]?(?:TN9?|TVP?|P|H|XL|A|B)?"
"""A needle cage: its sizes, and material or make of the cage, which change none."""
RING = r"RN-?([0-9]{3,4})[-./]?(?:EC?)?[-./]?(?:TVP[2B]?|TN9?|T2?|PHA?|P|M[ABL1]?|J[1]?)?"
"""Cylindrical rollers without outer ring: design E, as those that ship are, and the cage."""
CLASS_IN_NAME = r"[-./]?(C[2-5]|CN)$"
RACES_FIRST = 3.0
"""Weight of the diameters of races beside the width where cages are compared: the bore of the disc is made to them."""
FARTHEST = 60.0
"""Hundredths of letters that may differ between names that are suggested."""
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
        Number Z of rollers.
    series : str
        Series: K, RN, or any other.
    bore : float or None
        Bore of the inner ring, mm; without one the crank itself is the inner race.
    width : float or None
        Width of cage or inner ring, mm.
    dynamic_load_rating, static_load_rating : float or None
        Rating C (for lives) and C_0 (for static safety) of the maker, N; by ISO 281 and ISO 76 when left out.
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
    def fields(self) -> dict[str, float | None]:
        """Fields of ``[crank_bearing]`` that the bearing stands for; None for ratings that it does not give."""
        return {
            "inner_race_radius": 0.5 * self.inner_race_diameter,
            "outer_race_radius": 0.5 * self.outer_race_diameter,
            "number_of_rollers": self.number_of_rollers,
            "roller_radius": 0.5 * self.roller_diameter,
            "roller_length": self.roller_length,
            "dynamic_load_rating": self.dynamic_load_rating,
            "static_load_rating": self.static_load_rating,
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


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class BearingName:
    """Keys of ``[crank_bearing]`` that stand for fields of the drive.

    Attributes
    ----------
    bearing : str or None
        Bought bearing by its designation, ``"K20x26x12"``: stands for both races, number, radius and length of the rollers,
        and for the load ratings of the maker.
    clearance_class : {"C2", "CN", "C3", "C4", "C5"} or None
        Class of radial internal clearance (ISO 5753-1) of the bearing: stands for ``clearance.bearing``, its middle.
    """

    bearing: str | None = None
    clearance_class: ClearanceClass | None = None


_ADAPTER = TypeAdapter(NamedBearing)


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
    """Return a bearing by its designation; spaces, case and the sign of multiplication do not matter.

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
    entries = {spelled(each): entry for each, entry in known.items()}
    plain = spelled(name)
    if plain in entries:
        return entries[plain]
    bare = _bare(plain)
    if bare in entries:
        return entries[bare]
    for pattern, kind in WITH_OUTER_RING.items():
        if re.match(pattern, bare):
            raise DriveError([f"{shortened(name)}: is {kind}; {HINT}"])
    ends = re.search(CLASS_IN_NAME, bare)
    if ends and (entry := entries.get(_bare(bare[: ends.start()]))):
        meant = next(each for each, one in known.items() if one is entry)
        raise DriveError(
            [f'{shortened(name)}: holds a class of clearance; write bearing = "{meant}", clearance_class = "{ends[1]}"']
        )
    near = _nearest_names(bare, known)
    told = f"the nearest are {', '.join(near)}" if near else HINT
    raise DriveError(
        [f'{shortened(name)}: is not known by name; {told}; or give its numbers in [bearings."{name[:40]}"]']
    )


def _nearest_names(bare: str, known: Mapping[str, NamedBearing], count: int = 3) -> list[str]:
    """The known names nearest to one that is not: cages by their sizes, the races first, RN by their bores, others by their
    letters; none where nothing is near.
    """
    from difflib import SequenceMatcher

    cage, ring = re.fullmatch(CAGE, bare), re.match(r"RN[0-9]{1,2}?([0-9]{2})(?![0-9])", bare)
    sizes = [float(each) for each in cage.groups()[:3]] if cage else []

    def distance(name: str) -> float:
        entry = known[name]
        if sizes:
            width = entry.roller_length if entry.width is None else entry.width
            own = (entry.inner_race_diameter, entry.outer_race_diameter, width)
            apart = [abs(one - other) for one, other in zip(own, sizes, strict=True)]
            return RACES_FIRST * (apart[0] + apart[1]) + apart[2]
        if (
            ring and entry.bore is not None
        ):  # the last two digits of a designation are a fifth of the bore, from 20 mm on
            return abs(5.0 * int(ring[1]) - entry.bore) - SequenceMatcher(None, bare[:80], spelled(name)).ratio()
        return 100.0 * (1.0 - SequenceMatcher(None, bare[:80], spelled(name)).ratio())

    nearest = sorted(known, key=distance)[:count]
    return nearest if sizes or (nearest and distance(nearest[0]) < FARTHEST) else []


def spelled(name: str) -> str:
    """Return a designation without spaces, in capitals, with a point and X as signs of decimals and multiplication."""
    return re.sub(r"\s+|_", "", name).upper().replace("×", "X").replace("*", "X").replace(",", ".")


def _bare(plain: str) -> str:
    """A designation without its maker and without what tells of the cage alone; the sizes of a needle cage as short as can be."""
    bare = re.sub(MAKERS, "", plain)
    if found := re.fullmatch(CAGE, bare):
        return "K" + "X".join(f"{float(size):g}" for size in found.groups()[:3])
    if found := re.fullmatch(RING, bare):
        return f"RN{found[1]}"
    return bare


def clearance_range(bearing: NamedBearing, clearance_class: str) -> tuple[float, float] | None:
    """Return least and largest radial internal clearance, mm; that of a cage by the diameter under its needles.

    Examples
    --------
    >>> clearance_range(named_bearings()["RN210"], "C3")
    (0.05, 0.08)
    """
    return clearance_classes().range_of(clearance_class, bearing.bore or bearing.inner_race_diameter)


def designation_of(part: CrankBearing) -> str | None:
    """Return the name of the shipped bearing that a crank bearing is, ratings included; None for any other.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> designation_of(load_drive("paper").cases["CS-1"].crank_bearing)
    """
    for name, entry in named_bearings().items():
        if all(getattr(part, field) == value for field, value in entry.fields.items()):
            return name
    return None


NAMED_SIZES = ("inner_race_radius", "outer_race_radius", "number_of_rollers", "roller_radius", "roller_length")


def bought_size(part: CrankBearing, path: str) -> str | None:
    """Return why a study cannot vary a size of a crank bearing, whose maker rates it as it is; None where it can."""
    ratings = {name: getattr(part, name) for name in ("dynamic_load_rating", "static_load_rating")}
    given = [f"crank_bearing.{name} = {value:g} N" for name, value in ratings.items() if value is not None]
    if not given or path not in {f"crank_bearing.{name}" for name in NAMED_SIZES}:
        return None
    name = designation_of(part)
    of = "" if name is None else f" of {name}"
    return (
        f"{path}: cannot vary, the ratings{of} ({', '.join(given)}) are those of a bearing with this size; leave them and "
        "crank_bearing.bearing out, or give each bearing a [[case]]"
    )
