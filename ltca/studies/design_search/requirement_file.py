"""Requirement files (TOML): numbers in the units of drive files, texts with a unit (docs/how-to/design.md)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ltca.drive.materials import PARTS, STEEL, Materials
from ltca.drive.members.limits import Limits, parse_limits
from ltca.drive.members.named_materials import with_named_materials
from ltca.drive.members.operation import Friction, Lubricant, Temperature
from ltca.drive.members.width import FEWEST_SLICES, MOST_SLICES, Contact
from ltca.drive.mistakes import describe_mistakes
from ltca.errors import DriveError, Problem, did_you_mean, shortened
from ltca.quantities import NEED_SLICES
from ltca.reading.toml_text import parse_toml, read_text, require_kind
from ltca.studies.design_search.requirements import (
    CLEARANCES,
    FINEST_CLEARANCE,
    NO_FILE,
    REQUIRED,
    STOCK,
    Asked,
    Requirements,
    Shop,
)
from ltca.studies.design_search.sizes import problems_of_any_size
from ltca.studies.design_search.stock import Stock, build_stock, first_mistakes, stock_table
from ltca.studies.design_search.surroundings import (
    TABLES,
    without_following,
)


def load_requirements(path: Path) -> Requirements:
    """Read a requirement file (TOML); `DriveError` names every mistake: field, value, bound, unit."""
    return parse_requirements(read_text(path, NO_FILE), str(path), path.parent, path.stem)


def parse_requirements(
    text: str, source: str = "requirements", folder: Path | None = None, name: str = "design"
) -> Requirements:
    """Validate the text of a requirement file; see `load_requirements`.

    `source` is named in messages, a stock file is looked for in `folder`; `name` is that of the designs where the file has none.
    """
    table = parse_toml(text, source)
    require_kind(table, "requirements", source)
    table.setdefault("name", name)
    problems: list[str] = []
    shop = table.get("shop")
    keys = tuple(shop) if isinstance(shop, Mapping) else ()
    limits = parse_limits(table.pop("limits", {}), problems)
    material_table = table.pop("materials", {})
    assumed = assumed_materials(table, material_table)
    named = {path.removeprefix("materials."): name for path, name in assumed.items() if path != RING_MATERIAL}
    materials = _materials(
        {**material_table, **named} if isinstance(material_table, Mapping) else material_table, problems
    )
    if RING_MATERIAL in assumed:
        table["ring"] = {**table["ring"], "material": assumed[RING_MATERIAL]}
    table = without_following(with_named_materials(table, problems), problems)
    stock = _stock(table, folder or Path(), problems)
    asked: Asked | None = None
    try:
        asked = TypeAdapter(Asked).validate_python(table)
    except ValidationError as error:
        for place, known in FIELDS.items():
            # A missing field and its misspelling are told as one where they are of one table.
            own = [detail for detail in first_mistakes(error) if _table_of(detail["loc"]) == place]
            problems += map(_with_meaning, describe_mistakes(own, (), known))
    if asked is not None and materials is not None:
        problems += _contradictions(asked, materials, limits, keys)
    if problems or asked is None or stock is None or materials is None:
        raise DriveError(problems, source)
    found = Requirements(
        asked=asked, stock=stock, materials=materials, assumed_materials=assumed, limits=limits, text=text
    )
    if problems := problems_of_any_size(found):
        raise DriveError(problems, source)
    return found


FIELDS: dict[str, tuple[str, ...]] = {
    "": (*Asked.__dataclass_fields__, "materials", "limits"),
    "shop": (*Shop.__dataclass_fields__, *STOCK, "stock"),
    "friction": tuple(Friction.__dataclass_fields__),
    "temperature": tuple(Temperature.__dataclass_fields__),
    "lubricant": tuple(Lubricant.__dataclass_fields__),
    "contact": tuple(Contact.__dataclass_fields__),
    **TABLES,
}
"""Names of fields, by table."""


def _with_meaning(told: str) -> str:
    """A sentence about a missing key with what it means, its unit and an example."""
    key, _, rest = told.partition(": ")
    return f"{told}; {REQUIRED[key]}" if rest == "is missing" and key in REQUIRED else told


def _table_of(place: tuple[int | str, ...]) -> str:
    above = [str(part) for part in place[:-1] if not isinstance(part, int)]
    return next((name for end in range(len(above), 0, -1) if (name := ".".join(above[:end])) in FIELDS), "")


SURFACES, BODIES = "100Cr6", "42CrMo4"
"""Named materials of parts that requirements give none: hardened bearing steel under contact pressure, quenched and tempered
steel of parts that bend."""
RING_MATERIAL = "ring.material"


def assumed_materials(table: Mapping[str, Any], given: Any) -> dict[str, str]:
    """Return the names of the materials that requirements leave out, by path, of the parts that their drives have.

    `table` are the requirements, `given` is their ``[materials]``.
    """
    shop, carrier, ring = (table.get(name) for name in ("shop", "carrier", "ring"))
    needed = dict.fromkeys(("disc", "wheel_pin", "roller", "inner_race"), SURFACES)
    if table.get("kind") != "rv":
        needed["shaft_pin"] = SURFACES
    if isinstance(shop, Mapping) and "crank_support_stiffness" in shop:
        needed["crankshaft"] = BODIES
    if isinstance(carrier, Mapping) and "posts" in carrier:
        needed["carrier"] = BODIES
    named = given if isinstance(given, Mapping) else {}
    found = {f"materials.{part}": name for part, name in needed.items() if part not in named}
    if isinstance(ring, Mapping) and "material" not in ring:
        found[RING_MATERIAL] = BODIES
    return found


def _materials(table: Any, problems: list[str]) -> Materials | None:
    if not isinstance(table, Mapping):
        problems.append(f"materials = {shortened(table)}: must be a table")
        return None
    before = len(problems)
    problems += [
        f"materials.{shortened(part)[1:-1]}: is not a part{did_you_mean(str(part), PARTS)}"
        for part in table
        if part not in PARTS
    ]
    resolved = with_named_materials({"materials": table}, problems)["materials"]
    if len(problems) > before:
        return None
    try:
        return TypeAdapter(Materials).validate_python(resolved)
    except ValidationError as error:
        problems += describe_mistakes(error.errors(), ("materials",))
        return None


def _stock(table: dict[str, Any], folder: Path, problems: list[str]) -> Stock | None:
    """The stock: entries of ``[shop]``, then those of a stock file, or of the package."""
    shop = table.get("shop", {})
    own: dict[str, Any] = {}
    given: dict[str, Any] = {}
    source = "shop"
    if isinstance(shop, Mapping):
        table["shop"] = {key: value for key, value in shop.items() if key not in (*STOCK, "stock")}
        own = {key: shop[key] for key in STOCK if key in shop}
        path = shop.get("stock")
        if path is not None and not isinstance(path, str):
            problems.append(f"shop.stock = {shortened(path)}: must be the name of a file")
            return None
        if path is not None:
            source = path
    try:
        given = stock_table(None if source == "shop" else folder / source)
        return build_stock({**given, **own}, source)
    except DriveError as error:
        problems += error.problems
        return None


def _contradictions(asked: Asked, materials: Materials, limits: Limits, shop: tuple[str, ...]) -> list[str]:
    """What does not go together; `shop` has the keys that are given there."""
    found = []
    if asked.efficiency is not None and asked.friction is None:
        found.append(
            f"efficiency = {asked.efficiency:g}: nothing rubs; give [friction] its coefficients, or leave it out"
        )
    if asked.kind == "discs" and abs(asked.ratio - round(asked.ratio)) > asked.ratio * asked.ratio_tolerance + 1e-9:
        found.append(
            f'ratio = {asked.ratio:g}: must be a whole number with kind = "discs", or within ratio_tolerance of one '
            f"(ratio_tolerance = {asked.ratio_tolerance:g})"
        )
    if asked.kind == "discs" and asked.cranks is not None:
        found.append(
            f'cranks = {asked.cranks}: has no effect with kind = "discs", whose one crank stands in the centre'
        )
    walls = 2.0 * asked.shop.housing_wall
    if walls >= asked.outer_diameter:
        found.append(
            f"shop.housing_wall = {asked.shop.housing_wall:g} mm: must be less than half of outer_diameter = "
            f"{asked.outer_diameter:g} mm, or nothing is left inside"
        )
    if asked.ring is not None:
        if asked.shop.housing_wall == 0.0:
            found.append(
                "shop.housing_wall = 0 mm: must be greater than 0 beside [ring], which is the wall outside the wheel pins"
            )
        if asked.ring.width is not None and asked.ring.width > asked.length:
            found.append(f"ring.width = {asked.ring.width:g} mm: must be at most length = {asked.length:g} mm")
    if asked.kind == "discs" and asked.first_stage is not None:
        found.append('first_stage: must be left out with kind = "discs", whose one crank is the input itself')
    if asked.kind == "rv" and asked.first_stage is not None and asked.first_stage.plane is None:
        acts = {
            "shop.crank_support_stiffness": asked.shop.crank_support_stiffness is not None,
            "carrier.posts": asked.carrier is not None and asked.carrier.posts is not None,
            "main_bearing": asked.main_bearing is not None,
            "load.external": asked.load is not None and bool(asked.load.external),
        }
        if beside := next((name for name, given in acts.items() if given), None):
            said = f"must be given with {beside}, in mm: the forces of the teeth act there"
            found.append(Problem.of("first_stage.plane", "", said))
    if asked.kind == "rv" and asked.shop.shaft_pin_stiffness is not None:
        found.append('shop.shaft_pin_stiffness: must be left out with kind = "rv", which has no shaft pins')
    if asked.kind == "rv" and "pin_hole_clearance" in shop:
        said = 'must be left out with kind = "rv", which has no holes for shaft pins'
        found.append(Problem.of("shop.pin_hole_clearance", "", said))
    if asked.kind == "rv" and 1 in asked.numbers_of_discs:
        found.append('discs: must be 2 or 3 with kind = "rv"; one disc leaves its cranks unbalanced')
    for name in CLEARANCES:
        low, high = asked.shop.range_of(name)
        if name != "shifting_offset" and low < high and low < FINEST_CLEARANCE:
            found.append(
                f"shop.{name} = [{low:g}, {high:g}]: must start at {FINEST_CLEARANCE:g} mm, to which sizes are rounded, or more"
            )
    if asked.contact.slices == 1:
        if asked.lead_crowns[1] > 0.0:
            low, high = asked.lead_crowns
            given = f"{low:g}" if low == high else f"[{low:g}, {high:g}]"
            found.append(
                f"contact.slices = 1: must be odd, {FEWEST_SLICES} to {MOST_SLICES}, with shop.lead_crown_drop = {given} mm: "
                "nothing varies along the width of one slice"
            )
        found += [
            f"limits.{key}: nothing tilts in the plane model (contact.slices = 1)"
            for key, limit in limits.items()
            if limit.quantity in NEED_SLICES
        ]
    found += [
        f"limits.{key}: designs have no disc.axial_play"
        for key, limit in limits.items()
        if asked.contact.slices > 1 and limit.quantity == "axial_play_taken"
    ]
    wanted_lives = [key for key in limits if "bearing_life" in key or "static_safety" in key]
    for part in ("inner_race", "roller", "disc"):
        modulus = getattr(materials, part).youngs_modulus
        if not STEEL[0] <= modulus <= STEEL[1] and (asked.life is not None or wanted_lives):
            name = "life" if asked.life is not None else f"limits.{wanted_lives[0]}"
            value = f" = {asked.life:g} h" if asked.life is not None else ""
            found.append(
                f"{name}{value}: cannot be rated with materials.{part}.youngs_modulus = {modulus:g} MPa, which is no bearing "
                "steel (ISO 281); leave it out"
            )
    return found
