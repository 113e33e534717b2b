"""The registry of quantities: what results hold, each declared once.

A quantity is an array of a dataset (``results.nc``, ``pressure.nc``, ``fem.nc``, ``time.nc``), or a number of a case, or both: an
array and the scalars that sum it up over positions and parts. Datasets, ``summary.json``, ``[limits]``, verdicts, studies,
tables and reference pages take names, units, dimensions and words from here; where a value is computed only its name is written.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

SCHEMA_VERSION = 1
"""Attribute ``schema_version`` of every dataset: higher by one when a name, a unit or dimensions change or go."""

DIMENSIONS = {
    "case": ("case",),
    "position": ("position",),
    "disc of the case": ("case", "disc"),
    "pin of the case": ("case", "pin"),
    "hole of the case": ("case", "disc", "hole"),
    "shaft pin of the case": ("case", "hole"),
    "roller of the case": ("case", "disc", "crank", "roller"),
    "drive": ("case", "position"),
    "disc": ("case", "disc", "position"),
    "crank": ("case", "disc", "crank", "position"),
    "crankshaft": ("case", "crank", "position"),
    "seat": ("case", "position", "pin"),
    "pin": ("case", "disc", "position", "pin"),
    "roller": ("case", "disc", "crank", "position", "roller"),
    "hole": ("case", "disc", "position", "hole"),
    "lobe": ("case", "disc", "position", "lobe"),
    "slices of a pin": ("case", "disc", "position", "pin", "slice"),
    "slices of a roller": ("case", "disc", "crank", "position", "roller", "slice"),
    "slices of a hole": ("case", "disc", "position", "hole", "slice"),
    "axes of a disc": ("case", "disc", "position", "axis"),
    "axes of a crank": ("case", "disc", "crank", "position", "axis"),
    "slice of the case": ("case", "slice"),
    "cells of a pin": ("case", "disc", "position", "pin", "pin_cell_x", "pin_cell_y"),
    "x edges of a pin": ("case", "disc", "position", "pin", "pin_bound_x"),
    "y edges of a pin": ("case", "disc", "position", "pin", "pin_bound_y"),
    "cells of a roller": ("case", "disc", "crank", "position", "roller", "roller_cell_x", "roller_cell_y"),
    "x edges of a roller": ("case", "disc", "crank", "position", "roller", "roller_bound_x"),
    "y edges of a roller": ("case", "disc", "crank", "position", "roller", "roller_bound_y"),
    "lobe number": ("lobe",),
    "wall node": ("wall_node",),
    "sample": ("sample",),
    "drive in time": ("time",),
    "disc in time": ("time", "disc"),
    "axes of a disc in time": ("time", "disc", "axis"),
    "crank in time": ("time", "disc", "crank"),
    "pin in time": ("time", "disc", "pin"),
    "roller in time": ("time", "disc", "crank", "roller"),
    "hole in time": ("time", "disc", "hole"),
    "speed": ("speed",),
    "pin at speeds": ("speed", "disc", "pin"),
    "roller at speeds": ("speed", "disc", "crank", "roller"),
    "hole at speeds": ("speed", "disc", "hole"),
    "bearing at speeds": ("speed", "disc", "crank"),
    "orders of a pin": ("speed", "disc", "pin", "pin_order"),
    "orders of a roller": ("speed", "disc", "crank", "roller", "roller_order"),
    "orders of a hole": ("speed", "disc", "hole", "hole_order"),
    "orders of a bearing": ("speed", "disc", "crank", "bearing_order"),
    "orders of a main bearing": ("speed", "main_bearing_order"),
}
"""Dimensions by what a quantity belongs to."""

AT_LEAST_0 = (0.0, None)
ANY_NUMBER = (None, None)
FROM_0_TO_1 = (0.0, 1.0)
AT_MOST_1 = (None, 1.0)

SUFFIXES = {
    "1": "", "N mm": "_Nmm", "N/mm": "_N_per_mm", "MPa m/s": "_MPa_m_s", "N mm/rad": "_Nmm_per_rad", "kg m2": "_kg_m2",
    "g mm": "_g_mm", "g mm2": "_g_mm2",
}  # fmt: skip
"""Units as they end the keys of ``summary.json``, where they are spelled otherwise."""
SIGNS = {
    "1": "", "N mm/rad": "N·mm/rad", "arcmin": "′", "arcsec": "″", "deg": "°", "N mm": "N·mm", "kg m2": "kg·m²", "g mm": "g·mm",
    "g mm2": "g·mm²",
}  # fmt: skip
"""Units as they are printed, where they are spelled otherwise."""

RESOLUTION = {"arcmin": 1e-5, "arcsec": 1e-4, "mm": 1e-9}
"""What a value of a unit means no more: a play is found to 1e-5′, an overlap below 1e-9 mm counts as none."""


@dataclass(frozen=True, slots=True)
class Scalar:
    """One number of a case.

    Attributes
    ----------
    name : str
        In the summary without its unit, in studies, and in ``[limits]`` without ``max_``. ``{}`` stands for the name of the
        quantity that it sums up, ``#`` for the number of a disc or crank.
    title : str
        In words, and how it is summed up.
    unit : str
        That of the quantity when left out.
    digits : str
        How tables print it: a format specification.
    limit : tuple of (float or None), optional
        Least and largest limit that may be set to it; left out for what is not limited.
    judged : str
        Title beside its limit, where that is another one.
    refined : bool
        Whether the summary has it over the whole turn as well, as ``refined_…``.
    in_summary : bool
        Whether ``summary.json`` has it: others are of studies, of limits or of requirements alone.
    more_is_better : bool
        Whether the worst sample of a study is that of the least value.
    by_load : bool
        Whether more torque or speed raises it, so that the largest of all entries of a duty counts; of those with a limit.
    how : str
        How it sums the array up, a key of `ltca.analysis.summary.SUMS`; the first word of its name when left out.
    of : str
        The array; filled in in `SCALARS`.
    """

    name: str
    title: str
    unit: str = ""
    digits: str = ".1f"
    limit: tuple[float | None, float | None] | None = None
    judged: str = ""
    refined: bool = False
    in_summary: bool = True
    more_is_better: bool = False
    by_load: bool = True
    how: str = ""
    of: str = ""

    @property
    def key(self) -> str:
        """Key of ``summary.json``: the name with the unit behind it."""
        return self.name + SUFFIXES.get(self.unit, f"_{self.unit}")

    @property
    def heading(self) -> str:
        """Title and unit."""
        sign = unit_sign(self.unit)
        return f"{self.title} [{sign}]" if sign else self.title

    @property
    def verdict_title(self) -> str:
        """Title beside its limit."""
        return self.judged or self.title

    @property
    def limited_name(self) -> str:
        """Name in ``[limits]`` behind ``max_`` or ``min_``."""
        return self.name.removeprefix("max_")


@dataclass(frozen=True, slots=True)
class Quantity:
    """One quantity.

    Attributes
    ----------
    name : str
        In the datasets.
    of : str
        What it belongs to, a key of `DIMENSIONS`; empty for what has scalars alone.
    unit : str
        Of the array; ``1`` for plain numbers.
    description : str
        Attribute ``long_name`` of the array.
    scalars : tuple of Scalar
        What sums it up.
    in_fem : str
        Description in ``fem.nc``, where that differs from ``results.nc``.
    older_key : str
        An older key of the array in the summary of `cyclo fem`, which stays beside the name.
    """

    name: str
    of: str
    unit: str
    description: str = ""
    scalars: tuple[Scalar, ...] = ()
    in_fem: str = ""
    older_key: str = ""

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Dimensions of the array."""
        return DIMENSIONS[self.of]

    @property
    def fem_key(self) -> str:
        """Key of the array in the summary of `cyclo fem`: the name with the unit behind it."""
        return f"{self.name}_{self.unit.replace(' ', '_')}"

    @property
    def older_fem_key(self) -> str:
        """The key there that is older than the name; the key itself where there is none."""
        return f"{self.older_key or self.name}_{self.unit.replace(' ', '_')}"

    def labelled(self, values: Any, *, in_fem: bool = False) -> tuple[tuple[str, ...], Any, dict[str, str]]:
        """Return values with dimensions and attributes, as a dataset takes them; `in_fem` as of full finite elements."""
        text = self.in_fem if in_fem and self.in_fem else self.description
        return self.dimensions, values, {"units": self.unit, "long_name": text}


def _scalar(unit: str, scalar: Scalar) -> Quantity:
    """A number of the case that sums no array up."""
    return Quantity(scalar.name, "", unit, scalars=(scalar,))


def _checked(name: str, unit: str, title: str) -> Quantity:
    """A value of the verdict that the summary has not."""
    return _scalar(unit, Scalar(name, title, limit=AT_LEAST_0, in_summary=False))


def _of_design(name: str, unit: str, title: str, limit: tuple[float | None, float | None] = AT_LEAST_0) -> Quantity:
    """A value of the verdict that no entry of a duty raises: of the shape, or of the whole duty."""
    return _scalar(unit, Scalar(name, title, limit=limit, in_summary=False, by_load=False))


def _asked(name: str, unit: str, title: str) -> Quantity:
    """A value of a design that a requirement bounds."""
    return _scalar(unit, Scalar(name, title, in_summary=False))


def _seat(name: str, part: str, load: str) -> tuple[Quantity, ...]:
    """Load, arc and pressure of the seats of one kind of pins."""
    return (
        Quantity(f"{name}_load", name.partition("_")[0], "N", load),
        Quantity(f"{name}_arc", name.partition("_")[0], "rad", "angle of the arc under pressure there"),
        Quantity(
            f"{name}_pressure_max", name.partition("_")[0], "MPa", "largest pressure there",
            (Scalar(f"max_{name}_pressure", f"largest pressure in {part}", limit=AT_LEAST_0, judged=f"pressure in {part}"),),
        ),
    )  # fmt: skip


def _loss(kind: str, words: str) -> Quantity:
    """Energy and power that one kind of friction takes."""
    return Quantity(
        f"loss_{kind}", "drive", "N mm", f"energy lost by radian of the crank: {words}",
        (
            Scalar("mean_{}", f"energy lost by radian of the crank, mean: {words}"),
            Scalar(f"power_loss_{kind}", f"power lost: {words}", "W", ".3g"),
        ),
    )  # fmt: skip


def _pv(name: str, of: str, description: str, place: str) -> Quantity:
    """Pressure times slip speed."""
    limited = Scalar("max_{}", f"largest p·v {place}", digits=".4g", limit=AT_LEAST_0, judged=f"p·v {place}")
    return Quantity(name, of, "MPa m/s", description, (limited,))


def _wall(name: str, of: str, along: str, short: str) -> Quantity:
    """Stress along a wall of the disc."""
    limited = Scalar(
        "max_{}", f"largest stress along {short}", how="largest known", limit=AT_LEAST_0, judged=f"stress along {short}"
    )
    return Quantity(name, of, "MPa", f"largest tensile stress along {along}, clear of contacts", (limited,))


def _peak(title: str, judged: str = "") -> Scalar:
    """The largest of what `[limits]` may bound, refined over the turn."""
    return Scalar("max_{}", title, limit=AT_LEAST_0, judged=judged, refined=True)


def _amount(title: str) -> Scalar:
    """The largest amount of a force of either sense."""
    return Scalar("max_{}", f"{title}, largest", how="largest amount")


def _bend(title: str, judged: str) -> Scalar:
    """The largest deflection of pins."""
    return Scalar("max_{}", title, digits=".4f", limit=AT_LEAST_0, judged=judged)


def _anywhere(title: str, judged: str) -> tuple[Scalar, ...]:
    """The largest pressure, the ends of the contact included."""
    told = f"largest {title} anywhere (end cell a hundredth)"
    return (Scalar("max_{}", told, limit=AT_LEAST_0, judged=f"{judged} anywhere along the width", refined=True),)


def _along(part: str, of: str, name: str, sides: tuple[tuple[str, str, str], ...]) -> tuple[Quantity, ...]:
    """What contacts of one kind in slices have along their width, by the sides of a pair."""
    found: tuple[Quantity, ...] = ()
    largest = (Scalar(f"max_{part}_line_load", f"largest line load of a {name}", "N/mm"),)
    for line, pressure, pair in sides:
        place = f"height above mid-width at which the pressure of {pair} is largest"
        each = f"largest pressure over the profile of {pair} in each slice"
        load = f"line load of {pair}, mean over each slice"
        within = "with what line loads vary by within slices"
        found += (
            Quantity(f"{part}_line_load{line}", f"slices of a {of}", "N/mm", load, () if line else largest),
            Quantity(f"{part}_moment{line}", of, "N mm", f"Σ q z of {pair} about its middle, {within}"),
            Quantity(f"{part}_pressure_along_width{pressure}", f"slices of a {of}", "MPa", each),
            Quantity(f"{part}_pressure_max_place{pressure}", of, "mm", place),
        )
    told = (
        f"face load factor K_Hβ of a {name}: largest mean line load over a ninth of the length (of fewer slices, over one) by "
        "that over the length, without the bulge of ends; not a number where the joint carries less than a tenth of the largest "
        "load that any of its kind does at any position"
    )
    limited = Scalar(
        "max_{}", f"face load factor K_Hβ of a {name}", digits=".3f", how="largest known", limit=AT_LEAST_0
    )
    return (*found, Quantity(f"{part}_face_load_factor", "crank" if of == "roller" else "disc", "1", told, (limited,)))


_ALONG_WIDTH = (
    *_along("pin", "pin", "wheel pin", (("", "", "wheel pin and flank"),)),
    *_along(
        "roller", "roller", "roller", (("", "_outer", "roller and bore"), ("_inner", "_inner", "roller and inner race"))
    ),
    *_along("pin_shaft", "hole", "shaft pin", (("", "", "shaft pin and hole"),)),
    Quantity(
        "disc_tilt",
        "axes of a disc",
        "rad",
        "small rotation of the disc about x and y of the fixed frame",
        (Scalar("max_{}", "tilt of a disc, largest", digits=".3g", how="largest length", limit=AT_LEAST_0),),
    ),
    Quantity(
        "crank_bearing_moment",
        "axes of a crank",
        "N mm",
        "moment of the crank bearing on the disc about x and y through the middle of the disc",
        (Scalar("max_{}", "moment of a crank bearing, largest", digits=".4g", how="largest length"),),
    ),
    _checked("axial_play_taken", "1", "part of the axial play of a disc that its tilt takes at the rim"),
)
"""Of contacts in slices along their width."""


def _spectrum(force: str, of: str, by: str, words: str) -> tuple[Quantity, ...]:
    """Orders of the forces of one kind over speed, of ``dynamics.nc``."""
    orders, where = f"orders of a {by}", "at rest where the speed is 0, else in motion"
    return (
        Quantity(f"{force}_over_speed", of, "N", f"mean over the walked turns of the {words}, {where}"),
        Quantity(f"{force}_order_amplitude", orders, "N", f"amplitude by order of the {words}, {where}"),
        Quantity(
            f"{force}_order_phase",
            orders,
            "rad",
            f"phase by order of the {words}: amplitude · cos(order · φ_C − phase)",
        ),
        Quantity(f"{force}_order_rest", of, "N", f"root mean square of what its orders leave of the {words}, {where}"),
    )


_TIP_RING = (
    "displacement of the ring that ties the tips of the shaft pins, or of the far flange of the carrier; not of [ring], the "
    "ring of the wheel (ring_displacement_radial)"
)

_DECLARED = (
    # shape and assembly
    _of_design("carried_torque", "1", "part of the torque that is carried", FROM_0_TO_1),
    _of_design("undercut_margin", "mm", "undercut: pin radius to spare", ANY_NUMBER),
    _of_design("wall", "mm", "thinnest wall", ANY_NUMBER),
    _of_design("pin_hollow_margin", "mm", "hollow of the flank against the pin", ANY_NUMBER),
    _of_design("roller_gap", "mm", "gap between rollers", ANY_NUMBER),
    _scalar("mm", Scalar("interference", "assembly: overlap at rest", digits=".4f", limit=AT_LEAST_0, by_load=False)),
    _scalar(
        "arcmin",
        Scalar("backlash_disc", "backlash of the flank alone, at the disc", digits="z.2f", limit=AT_LEAST_0, by_load=False),
    ),
    Quantity(
        "backlash_wheel", "", "arcmin",
        scalars=(
            Scalar(
                "{}", "backlash of the flank alone, at the wheel", digits="z.2f", limit=AT_LEAST_0, by_load=False
            ),
            Scalar("mean_{}", "backlash of the flank alone, at the wheel, mean", in_summary=False),
            Scalar("min_{}", "backlash of the flank alone, at the wheel, least", in_summary=False),
        ),
    ),
    Quantity(
        "backlash_output", "", "arcmin",
        scalars=(
            Scalar(
                "{}", "backlash at the output, all clearances, largest sampled", digits="z.2f", limit=AT_LEAST_0,
                judged="backlash at the output, all clearances", by_load=False,
            ),
            Scalar("max_{}", "backlash at the output, all clearances, largest sampled", in_summary=False),
            Scalar("min_{}", "backlash at the output, all clearances, least sampled", digits="z.2f"),
        ),
    ),
    _scalar("1", Scalar("preloaded_part_of_turn", "part of the turn where parts overlap in every pose", digits=".2f")),
    _of_design("play_at_temperature", "mm", "least play at temperature", ANY_NUMBER),
    # contacts
    Quantity("pin_load", "pin", "N", "load of wheel pin and flank", (_peak("largest load of a wheel pin"),)),
    Quantity(
        "roller_load", "roller", "N", "load of roller and bore (outer side)", (_peak("largest load of a roller"),),
        older_key="roller_load_outer",
    ),
    Quantity("roller_load_inner", "roller", "N", "load of roller and inner race"),
    Quantity("pin_shaft_load", "hole", "N", "load of shaft pin and hole", (_peak("largest load of a shaft pin"),)),
    Quantity("pin_approach", "pin", "mm", "approach of wheel pin and flank, negative when open"),
    Quantity("roller_approach_outer", "roller", "mm", "approach of roller and bore, negative when open"),
    Quantity("roller_approach_inner", "roller", "mm", "approach of roller and inner race"),
    Quantity("pin_shaft_approach", "hole", "mm", "approach of shaft pin and hole, negative when open"),
    Quantity(
        "pin_pressure_mid", "pin", "MPa", "largest pressure of wheel pin and flank at mid-width",
        (_peak("largest flank pressure at mid-width", "flank pressure"),),
        in_fem="largest pressure of wheel pin and flank", older_key="pin_pressure_max",
    ),
    Quantity("roller_pressure_mid", "", "MPa", scalars=(_peak("largest roller pressure at mid-width", "roller pressure"),)),
    Quantity(
        "roller_pressure_mid_outer", "roller", "MPa", "largest pressure of roller and bore at mid-width",
        (Scalar("max_{}", "roller pressure in the bore", limit=AT_LEAST_0, in_summary=False),),
        in_fem="largest pressure of roller and bore", older_key="roller_pressure_max_outer",
    ),
    Quantity(
        "roller_pressure_mid_inner", "roller", "MPa", "largest pressure of roller and inner race at mid-width",
        (Scalar("max_{}", "roller pressure on the inner race", limit=AT_LEAST_0, in_summary=False),),
        in_fem="largest pressure of roller and race", older_key="roller_pressure_max_inner",
    ),
    Quantity(
        "pin_pressure_max", "pin", "MPa", "largest pressure of wheel pin and flank anywhere, end cell in attrs",
        _anywhere("flank pressure", "flank pressure"),
    ),
    Quantity("roller_pressure_max", "", "MPa", scalars=_anywhere("roller pressure", "roller pressure")),
    Quantity(
        "roller_pressure_max_outer", "roller", "MPa", "largest pressure of roller and bore anywhere, end cell in attrs",
        (
            Scalar(
                "max_{}", "roller pressure in the bore anywhere along the width", limit=AT_LEAST_0, in_summary=False
            ),
        ),
    ),
    Quantity(
        "roller_pressure_max_inner", "roller", "MPa",
        "largest pressure of roller and inner race anywhere, end cell in attrs",
        (
            Scalar(
                "max_{}", "roller pressure on the inner race anywhere along the width", limit=AT_LEAST_0, in_summary=False
            ),
        ),
    ),
    Quantity(
        "pin_shaft_pressure_mid", "hole", "MPa", "largest pressure of shaft pin and hole at mid-width",
        (_peak("largest pressure of a shaft pin at mid-width", "hole pressure"),),
        in_fem="largest pressure of shaft pin and hole", older_key="pin_shaft_pressure_max",
    ),
    Quantity(
        "pin_shaft_pressure_max", "hole", "MPa", "largest pressure of shaft pin and hole anywhere, end cell in attrs",
        _anywhere("pressure of a shaft pin", "hole pressure"),
    ),
    _scalar("mm", Scalar("pin_end_cell", "length of the end cell of the largest flank pressure anywhere")),
    _scalar("mm", Scalar("roller_end_cell", "length of the end cell of the largest roller pressure anywhere")),
    _scalar("mm", Scalar("pin_shaft_end_cell", "length of the end cell of the largest pressure of a shaft pin anywhere")),
    Quantity(
        "pin_half_width", "pin", "mm", "contact half-width of wheel pin and flank at mid-width",
        in_fem="half-width 2√⟨x²⟩ of wheel pin and flank",
    ),
    Quantity(
        "roller_half_width_outer", "roller", "mm", "contact half-width of roller and bore at mid-width",
        in_fem="half-width of roller and bore",
    ),
    Quantity(
        "roller_half_width_inner", "roller", "mm", "contact half-width of roller and inner race at mid-width",
        in_fem="half-width of roller and race",
    ),
    Quantity(
        "pin_shaft_half_width", "hole", "mm", "contact half-width of shaft pin and hole at mid-width",
        in_fem="half-width of shaft pin and hole",
    ),
    Quantity("pin_contact_parameter", "pin", "rad", "place of the contact on the flank, parameter of Eq. 1, in [0, 2π)"),
    _scalar("deg", Scalar("pin_shaft_loaded_range", "range of the crank angle in which a shaft pin is loaded")),
    _scalar(
        "1",
        Scalar(
            "mean_loaded_pins", "loaded wheel pins, mean", digits=".2f", limit=AT_LEAST_0,
            judged="contact ratio: loaded wheel pins, mean", by_load=False,
        ),
    ),
    _scalar("1", Scalar("mean_loaded_rollers", "loaded rollers, mean", digits=".2f")),
    _scalar("1", Scalar("mean_loaded_pin_shaft_pins", "loaded shaft pins, mean", digits=".2f")),
    *_ALONG_WIDTH,
    # crank bearings
    Quantity(
        "bearing_load", "", "N",
        scalars=(
            Scalar("mean_{}", "bearing load, mean"), _peak("bearing load, largest", "largest load of a crank bearing"),
        ),
    ),
    Quantity(
        "bearing_radial", "crank", "N", "bearing force on the disc along the eccentricity",
        (Scalar("mean_radial_bearing_load", "radial bearing load, mean"),),
    ),
    Quantity(
        "bearing_tangential", "crank", "N", "bearing force on the disc, 90° ahead of the eccentricity",
        (
            Scalar("mean_tangential_bearing_load", "tangential bearing load, mean"),
            Scalar("ptp_tangential_bearing_load", "tangential bearing load, peak to peak", refined=True),
        ),
    ),
    _scalar("N", Scalar("max_bearing_load_crank_#", "bearing load of crank #, largest")),
    _of_design("bearing_life_hours", "h", "life of the crank bearings in hours"),
    _of_design("bearing_life_modified_hours", "h", "life of the crank bearings by a_ISO in hours"),
    _of_design("bearing_life_million_turns", "1", "life of the crank bearings, million turns"),
    _of_design("static_safety_S0", "1", "static safety S0 of the crank bearings"),
    # seats, pins that bend
    *_seat("pin_seat", "wheel-pin seats", "load of the wheel pin in its slot, or of the sleeve on the wheel pin"),
    Quantity(
        "pin_deflection", "pin", "mm", "displacement of the bent wheel pin at the disc, under the forces of all discs",
        (_bend("largest deflection of a wheel pin", "deflection of wheel pins"),),
    ),
    *_seat("hole_seat", "shaft-pin sleeves", "load of the sleeve on the shaft pin"),
    Quantity(
        "shaft_pin_deflection", "hole", "mm", "displacement of the bent shaft pin at the disc, under the forces of all discs",
        (_bend("largest deflection of a shaft pin", "deflection of shaft pins"),),
    ),
    _checked("wheel_pin_bending_stress", "MPa", "bending of wheel pins, largest (static)"),
    _checked("wheel_pin_bending_amplitude", "MPa", "bending of wheel pins, fatigue"),
    _checked("wheel_pin_shear_stress", "MPa", "shear of wheel pins, largest (static)"),
    _checked("shaft_pin_bending_stress", "MPa", "bending of shaft pins, largest (static)"),
    _checked("shaft_pin_bending_amplitude", "MPa", "bending of shaft pins, fatigue"),
    _checked("shaft_pin_shear_stress", "MPa", "shear of shaft pins, largest (static)"),
    # supports
    Quantity("ring_x", "drive", "mm", _TIP_RING),
    Quantity("ring_y", "drive", "mm", _TIP_RING),
    Quantity("ring_rotation", "drive", "rad", "rotation of that ring or flange, not of [ring]; ccw positive"),
    Quantity(
        "crank_torque", "crankshaft", "N mm",
        "external moment that holds the crank by virtual work, ∂U/∂φ_C: that of the forces on it plus cage_speed times "
        "cage_moment, and what rubs there; ccw positive",
        (
            Scalar("mean_{}", "torque of the cranks, mean"),
            Scalar("mean_torque_crank_#", "torque of crank #, mean", digits=".0f"),
            Scalar("max_torque_crank_#", "torque of crank #, largest amount", digits=".0f"),
        ),
    ),
    Quantity(
        "cage_moment", "crankshaft", "N mm",
        "external moment that holds the roller cages of the crank, a part of the balance of all forces; ccw positive",
    ),
    Quantity(
        "crank_deflection_radial", "crank", "mm", "crank at the disc, along its eccentricity; tilt left out"
    ),
    Quantity("crank_deflection_tangential", "crank", "mm", "crank at the disc, 90° ahead of its eccentricity"),
    Quantity("crank_twist", "crank", "rad", "eccentric ahead of the splined planet, by torsion of the crank; ccw positive"),
    _scalar("mm", Scalar("max_crank_deflection_crank_#", "deflection of crank #, largest", digits=".4f")),
    Quantity(
        "ring_displacement_radial", "seat", "mm",
        "displacement of the seat of the wheel pin by the elastic ring of the wheel, outward; of a free ring beyond the rigid "
        "motion that fits all seats best",
        (Scalar("max_{}", "largest outward displacement of the ring of the wheel", digits=".4f"),),
    ),
    Quantity("ring_displacement_tangential", "seat", "mm", "the same, 90° ahead"),
    Quantity(
        "crank_support_load_first", "crankshaft", "N", "load of the first bearing of the crank in the carrier",
        (_amount("load of the first bearing of a crank in the carrier"),),
    ),
    Quantity(
        "crank_support_load_second", "crankshaft", "N", "load of the second bearing of the crank in the carrier",
        (_amount("load of the second bearing of a crank in the carrier"),),
    ),
    Quantity(
        "first_stage_tangential_force", "crankshaft", "N",
        "force of the sun on the planet along its pitch circle, positive where it turns the crank ccw",
        (_amount("tangential force on a planet"),),
    ),
    Quantity(
        "first_stage_radial_force", "crankshaft", "N", "force of the sun on the planet, away from the sun",
        (_amount("radial force on a planet"),),
    ),
    Quantity(
        "first_stage_axial_force", "crankshaft", "N", "force of the sun on the planet along the axis",
        (_amount("axial force on a planet"),),
    ),
    Quantity("first_stage_lag", "drive", "rad", "angle of the cranks less the one that the held input gives them, ccw positive"),
    Quantity("main_bearing_x", "drive", "N", "force of the main bearing on the output, frame of the housing"),
    Quantity("main_bearing_y", "drive", "N", "force of the main bearing on the output, frame of the housing"),
    Quantity("main_bearing_z", "drive", "N", "force of the main bearing on the output along the axis"),
    Quantity(
        "main_bearing_moment_x", "drive", "N mm", "moment of the main bearing on the output about the zero of disc.planes"
    ),
    Quantity(
        "main_bearing_moment_y", "drive", "N mm", "moment of the main bearing on the output about the zero of disc.planes"
    ),
    Quantity(
        "main_bearing_axial_displacement", "drive", "mm", "displacement of the output along the axis on its main bearing",
        (Scalar("max_{}", "displacement of the output along the axis, largest", how="largest amount", digits=".4f"),),
    ),
    _scalar("N", Scalar("max_main_bearing_radial", "radial load of the main bearing, largest")),
    _scalar("N", Scalar("max_main_bearing_axial", "axial load of the main bearing, largest")),
    _scalar("N mm", Scalar("max_main_bearing_moment", "tilting moment of the main bearing, largest", digits=".0f")),
    Quantity("wheel_x", "drive", "mm", "displacement of the wheel on its bearing in the fixed frame"),
    Quantity("wheel_y", "drive", "mm", "displacement of the wheel on its bearing in the fixed frame"),
    Quantity("wheel_tilt_x", "drive", "rad", "small rotation of the wheel on its bearing about x of the fixed frame"),
    Quantity("wheel_tilt_y", "drive", "rad", "small rotation of the wheel on its bearing about y of the fixed frame"),
    _checked("bearing_deflection", "mm", "deflection of the crank bearings"),
    _checked("bearing_deflection_by_clearance", "1", "deflection of crank bearings by their radial clearance"),
    _checked("crank_deflection", "mm", "deflection of cranks"),
    _checked("crank_deflection_by_clearance", "1", "deflection of cranks by the bearings' radial clearance"),
    _checked("wheel_deflection", "mm", "deflection of the wheel on its bearing"),
    _checked("wheel_deflection_by_clearance", "1", "deflection of the wheel by the crank bearings' radial clearance"),
    # torque and motion
    _scalar(
        "N mm/rad",
        Scalar("cycloid_stage_stiffness", "stiffness of the cycloid stage from the light torque on, least", digits=".4g"),
    ),
    _scalar(
        "N mm/rad",
        Scalar("reducer_stiffness", "stiffness of what is described from the light torque on, least", digits=".4g"),
    ),
    Quantity(
        "disc_torque", "disc", "N mm", "part of the external moment on the wheel that the disc carries, ccw positive",
        in_fem="part of that moment that the disc carries",
    ),
    _scalar("1", Scalar("mean_torque_share_disc_#", "part of the torque on disc #, mean", digits=".4f")),
    _scalar("1", Scalar("max_torque_share_disc_#", "part of the torque on disc #, largest", digits=".4f")),
    Quantity(
        "wheel_moment", "drive", "N mm", "external moment on the wheel at the torque of the run, ccw positive",
        in_fem="external moment on the wheel, ccw positive",
    ),
    Quantity(
        "wheel_angle", "drive", "rad", "deviation of the wheel from φ_C/u at the torque of the run, ccw positive",
        in_fem="deviation of the wheel from φ_C/u, ccw positive",
    ),
    Quantity("wheel_angle_light", "drive", "rad", "the same at the light torque"),
    Quantity(
        "transmission_error", "drive", "rad", "deviation of the output at the torque of the run, ccw positive",
        (
            Scalar(
                "ptp_{}", "transmission error, peak to peak", "arcsec", ".2f", limit=AT_LEAST_0, refined=True,
                by_load=False,
            ),
            Scalar("mean_{}", "transmission error, mean", "arcsec", in_summary=False),
        ),
        in_fem="deviation of the output, ccw positive",
    ),
    Quantity(
        "transmission_error_light", "drive", "rad", "the same at the light torque",
        (Scalar("ptp_{}", "transmission error at the light torque, peak to peak", "arcsec", ".2f", refined=True),),
    ),
    Quantity("disc_radial", "disc", "mm", "disc centre from inner-race centre along the eccentricity"),
    Quantity("disc_tangential", "disc", "mm", "disc centre from inner-race centre, 90° ahead of the eccentricity"),
    Quantity(
        "disc_rotation", "disc", "rad", "rotation of the disc, ccw positive",
        in_fem="rotation of the disc, fitted to its bores, ccw positive",
    ),
    *(
        _scalar("1", Scalar(f"compliance_share_{part}", f"part of the compliance: {part.replace('_', ' ')}", digits=".4f"))
        for part in ("pins", "ring", "crank_bearings", "shaft_pins", "cranks", "wheel_bearing", "carrier", "geometry")
    ),
    # masses
    _scalar("kg", Scalar("mass", "mass of what the file describes", digits=".5g")),
    _scalar("kg", Scalar("disc_mass", "mass of disc 0", digits=".5g")),
    _scalar("kg m2", Scalar("disc_inertia", "inertia of disc 0 about its centre of mass", digits=".5g")),
    _scalar("g mm", Scalar("static_unbalance", "unbalance of all discs with what turns with their eccentrics", digits=".4g")),
    _scalar("g mm2", Scalar("couple_unbalance", "its couple about the zero of disc.planes", digits=".4g")),
    _scalar("kg m2", Scalar("reflected_inertia_input", "inertia of the drive referred to the input", digits=".5g")),
    _scalar("kg m2", Scalar("reflected_inertia_output", "inertia of the drive referred to the output", digits=".5g")),
    # the solution
    Quantity(
        "equilibrium_residual", "drive", "N", "largest unbalanced force, moments by their lever arms",
        (Scalar("max_{}", "largest residual", digits=".1e"),), in_fem="largest unbalanced force",
    ),
    _scalar("1", Scalar("residual_part", "residual as a part of the largest bearing load", digits=".1e", in_summary=False)),
    Quantity("iterations", "drive", "1", "Newton iterations at the torque of the run"),
    Quantity("status", "drive", "1", "0: balanced at the torque of the run, 1: no equilibrium found"),
    Quantity("status_light", "drive", "1", "the same at the light torque"),
    _scalar("1", Scalar("positions", "positions of the crank", digits=".0f")),
    _scalar("1", Scalar("positions_per_mesh_period", "positions in the passage of a tooth")),
    _scalar(
        "1",
        Scalar(
            "distinct_mesh_phases", "different places in a mesh period", digits=".0f", limit=AT_LEAST_0, by_load=False
        ),
    ),
    _checked("half_width_ratio", "1", "half-width by radius"),
    _checked("contact_strain", "1", "strain of the flank contact, p/E"),
    # friction
    Quantity("pin_friction_force", "pin", "N", "friction force of flank and wheel pin, its size"),
    Quantity("pin_slip", "pin", "mm", "slip of the flank on the pin by radian of the crank; 0 where the pin rolls there"),
    Quantity("pin_slip_speed", "pin", "mm/s", "the same at the speed of the drive"),
    Quantity("pin_friction_power", "pin", "W", "power that the wheel pin takes, at flank and seat"),
    _pv("pin_pv", "pin", "pressure at mid-width times slip speed at the flank", "at the flank"),
    Quantity("pin_seat_slip", "pin", "mm", "slip of the wheel pin in its slot, or of its sleeve, by radian of the crank"),
    Quantity("pin_seat_slip_speed", "pin", "mm/s", "the same at the speed of the drive"),
    _pv("pin_seat_pv", "pin", "largest pressure times slip speed in the seat", "in wheel-pin seats"),
    Quantity("pin_shaft_friction_force", "hole", "N", "friction force of hole and shaft pin, its size"),
    Quantity(
        "pin_shaft_slip", "hole", "mm", "slip of the hole on the shaft pin by radian of the crank; 0 where it rolls there"
    ),
    Quantity("pin_shaft_slip_speed", "hole", "mm/s", "the same at the speed of the drive"),
    Quantity("pin_shaft_friction_power", "hole", "W", "power that the shaft pin takes, at hole and seat"),
    _pv("pin_shaft_pv", "hole", "pressure at mid-width times slip speed at the hole", "at the holes"),
    Quantity("hole_seat_slip", "hole", "mm", "slip of the sleeve on the shaft pin by radian of the crank"),
    Quantity("hole_seat_slip_speed", "hole", "mm/s", "the same at the speed of the drive"),
    _pv("hole_seat_pv", "hole", "largest pressure times slip speed in the seat", "in shaft-pin sleeves"),
    _loss("pin", "flank on wheel pins"),
    _loss("seat", "pins and sleeves in their seats"),
    _loss("hole", "holes on shaft pins"),
    _loss("roller", "rolling resistance of the crank bearings"),
    _loss("support_bearing", "bearings of cranks and wheel"),
    _loss("no_load", "seals and oil at the input"),
    Quantity(
        "power_loss", "drive", "W", "power of all losses",
        (Scalar("{}", "power lost, mean", digits=".3g", how="mean", limit=AT_LEAST_0, judged="power lost"),),
    ),
    Quantity(
        "input_torque", "drive", "N mm", "external moment of the input, seals and oil included, ccw positive",
        (Scalar("mean_{}", "torque of the input, mean"),),
    ),
    _scalar("N mm", Scalar("drag_torque", "torque that friction takes at the input, nothing at the output", digits=".4g")),
    Quantity(
        "input_torque_back", "drive", "N mm", "the same with the motion reversed",
        (Scalar("mean_{}", "torque of the input, motion reversed, mean"),),
    ),
    Quantity(
        "efficiency", "drive", "1", "1 − loss/input",
        (
            Scalar(
                "mean_{}", "efficiency, mean", digits=".4f", limit=FROM_0_TO_1, more_is_better=True, by_load=False
            ),
            Scalar("min_{}", "efficiency, least", digits=".4f"),
        ),
    ),
    Quantity(
        "efficiency_back", "drive", "1", "the same with the motion reversed",
        (Scalar("mean_{}", "efficiency, motion reversed", digits=".4f", limit=AT_MOST_1, by_load=False),),
    ),
    Quantity(
        "moves_back", "drive", "1", "1: the load at the output turns the input without help, 0: it does not",
        (
            Scalar(
                "{}", "moves back (1) or locks itself (0)", digits=".0f", how="min", limit=FROM_0_TO_1,
                judged="moves back", by_load=False,
            ),
        ),
    ),
    # stress in the disc
    _wall("root_stress", "lobe", "the flank about each lobe root", "lobe roots"),
    _wall("bore_stress", "disc", "the bore", "bores"),
    _wall("hole_stress", "hole", "the wall of each hole", "holes (ligaments)"),
    Quantity(
        "pin_shear_max", "pin", "MPa", "largest shear stress in the disc below wheel pins, its own stress included",
        in_fem="largest shear stress in the disc below wheel pins",
    ),
    Quantity(
        "roller_shear_max_outer", "roller", "MPa", "largest shear stress in the disc below rollers, likewise",
        in_fem="largest shear stress in the disc below rollers",
    ),
    Quantity(
        "pin_shaft_shear_max", "hole", "MPa", "largest shear stress in the disc below shaft pins, likewise",
        in_fem="largest shear stress in the disc below shaft pins",
    ),
    _checked("disc_shear", "MPa", "shear below the surface of the disc"),
    _checked("shear_depth", "mm", "depth of the shear below the widest contact"),
    _checked("core_shear", "MPa", "shear in the core of the disc, below its case"),
    # pressure over the contacts
    *(
        Quantity(f"{part}_{key}{side}", of.format(part), unit, description)
        for part, side in (("pin", ""), ("roller", "_outer"), ("roller", "_inner"))
        for key, of, unit, description in (
            ("pressure", "cells of a {}", "MPa", "mean pressure of the cells"),
            ("x_edge", "x edges of a {}", "mm", "cell edges along the profile, from the contact point"),
            ("y_edge", "y edges of a {}", "mm", "cell edges along the width, from mid-width"),
            ("field_load", "{}", "N", "pressure summed over the patch"),
            ("max_shear", "{}", "MPa", "largest shear stress below mid-width"),
            ("max_shear_depth", "{}", "mm", "depth below the surface of the largest shear stress"),
        )
    ),
    # vibrations: orders of single forces
    *_spectrum("pin_load", "pin at speeds", "pin", "load of each wheel pin"),
    *_spectrum("roller_load", "roller at speeds", "roller", "load of each roller in the bore"),
    *_spectrum("pin_shaft_load", "hole at speeds", "hole", "load of each pin of the pin shaft"),
    *_spectrum("bearing_radial", "bearing at speeds", "bearing", "force of each crank bearing on its disc, radial"),
    *_spectrum("bearing_tangential", "bearing at speeds", "bearing", "force of each crank bearing on its disc, tangential"),
    *_spectrum("main_bearing_x", "speed", "main bearing", "force of the main bearing along x"),
    *_spectrum("main_bearing_y", "speed", "main bearing", "force of the main bearing along y"),
    # full finite elements alone
    Quantity("disc_x", "disc", "mm", "disc from its nominal place, fixed axes, fitted to its bores"),
    Quantity("disc_y", "disc", "mm", "disc from its nominal place, fixed axes, fitted to its bores"),
    Quantity("disc_area_x", "disc", "mm", "disc from its nominal place, mean over the area"),
    Quantity("disc_area_y", "disc", "mm", "disc from its nominal place, mean over the area"),
    Quantity("disc_area_rotation", "disc", "rad", "rotation of the disc, mean over the area"),
    Quantity("pressure_contact", "sample", "1", "kind of the contact of each sample"),
    Quantity("pressure_disc", "sample", "1", "number of its disc"),
    Quantity("pressure_part", "sample", "1", "number of its pin, roller (crank after crank) or hole"),
    Quantity("pressure_place", "sample", "mm", "arc length from the centre of pressure"),
    Quantity("pressure", "sample", "MPa", "mean contact pressure under the shape function of each vertex"),
    Quantity("lobe", "lobe number", "1", "lobe of the flank"),
    Quantity("wall_disc", "wall node", "1", "number of the disc"),
    Quantity("wall_boundary", "wall node", "1", "0 flank, 1 bore, 2 + k hole k"),
    Quantity("wall_parameter", "wall node", "rad", "θ of Eq. 1, or polar angle"),
    Quantity("wall_stress", "wall node", "MPa", "stress along the wall, tension positive"),
    Quantity("wall_clear", "wall node", "1", "1 beyond four half-widths of contacts"),
    # coordinates
    Quantity("crank_angle", "position", "rad", "crank angle φ_C, held"),
    Quantity("pin_x", "pin of the case", "mm", "wheel pin, in the frame of the wheel"),
    Quantity("pin_y", "pin of the case", "mm", "wheel pin, in the frame of the wheel"),
    Quantity("hole_x", "hole of the case", "mm", "hole, in the frame of the disc"),
    Quantity("hole_y", "hole of the case", "mm", "hole, in the frame of the disc"),
    Quantity("shaft_pin_x", "shaft pin of the case", "mm", "shaft pin, in the fixed frame"),
    Quantity("shaft_pin_y", "shaft pin of the case", "mm", "shaft pin, in the fixed frame"),
    Quantity(
        "roller_angle", "roller of the case", "rad", "angle of the roller in the cage, which stands at cage_speed · φ_C"
    ),
    Quantity("disc_phase", "disc of the case", "rad", "phase of the disc's eccentric against the crank angle"),
    Quantity("disc_plane", "disc of the case", "mm", "axial place of the disc's middle"),
    Quantity("z_pin", "slice of the case", "mm", "height of the slice of wheel pin and flank above the middle of the disc"),
    Quantity("z_roller", "slice of the case", "mm", "height of the slice of a roller above its middle"),
    Quantity("z_hole", "slice of the case", "mm", "height of the slice of shaft pin and hole above the middle of the disc"),
    Quantity("cage_speed", "case", "1", "cage angle by crank angle"),
    Quantity(
        "torque", "case", "N mm", "output torque of the run", (Scalar("{}", "output torque", in_summary=False),),
        in_fem="output torque of the solution",
    ),
    Quantity("light_torque", "case", "N mm", "light output torque"),
    Quantity("driving_sign", "case", "1", "+1: the crank drives ccw, −1: cw"),
    # what requirements of a design bound
    _asked("outer_diameter", "mm", "outer diameter"),
    _asked("length", "mm", "length"),
    _asked("stiffness", "N mm/rad", "torsional stiffness of the reducer as described"),
    _asked("lost_motion", "arcmin", "lost motion"),
    _asked("disc_share", "1", "torque of the least loaded disc by an even share"),
    _asked("pin_gap", "mm", "gap between wheel pins"),
    _asked("cage_room", "mm", "room for the cage between rollers"),
    _asked("race", "mm", "wall of the eccentric about its shaft"),
    _asked("roller_room", "mm", "thickness of the disc beyond the length of its rollers"),
    _asked("bearing_proportion", "mm", "pitch radius of the crank bearing beyond the least for its rollers"),
    _asked("pin_size", "mm", "radius of the wheel pins beyond the least on their circle"),
    _asked("pin_slenderness", "mm", "length to which wheel pins come, beyond that of the stack"),
    _asked("flank_clearance", "mm", "least gap of the flank by its offsets"),
    _asked("ring_seat", "mm", "depth of the seats of the wheel pins in the ring beyond the least that leads them"),
    _asked("equidistant_offset", "mm", "equidistant offset of the flank"),
    _asked("bearing_clearance", "mm", "clearance of the crank bearing"),
    _asked("pin_hole_clearance", "mm", "clearance of the holes"),
)  # fmt: skip

QUANTITIES = {quantity.name: quantity for quantity in _DECLARED}
"""Every quantity by name, arrays in the order of the datasets."""
_IN_TIME = (
    Quantity("time", "drive in time", "s", "time"),
    Quantity("crank_angle", "drive in time", "rad", "crank angle against the pin shaft"),
    Quantity("wheel_angle", "drive in time", "rad", "deviation of the wheel from φ_C/u"),
    Quantity("transmission_error", "drive in time", "rad", "transmission error at the output"),
    Quantity("input_speed", "drive in time", "rpm", "speed of the input, ccw positive"),
    Quantity("input_torque", "drive in time", "N mm", "external torque at the input, ccw positive"),
    Quantity("output_torque", "drive in time", "N mm", "external torque at the output, ccw positive"),
    Quantity("disc_displacement_x", "disc in time", "mm", "displacement of the disc along x"),
    Quantity("disc_displacement_y", "disc in time", "mm", "displacement of the disc along y"),
    Quantity("disc_rotation", "disc in time", "rad", "rotation of the disc"),
    Quantity(
        "disc_tilt",
        "axes of a disc in time",
        "rad",
        "small rotation of the disc about x and y of the frame of the pin shaft, of contacts in slices",
    ),
    Quantity("pin_load", "pin in time", "N", "load of each wheel pin"),
    Quantity("roller_load", "roller in time", "N", "load of each roller in the bore"),
    Quantity("pin_shaft_load", "hole in time", "N", "load of each pin of the pin shaft"),
    Quantity("bearing_load", "crank in time", "N", "force of each crank bearing"),
    Quantity("kinetic_energy", "drive in time", "N mm", "kinetic energy"),
    Quantity("stored_energy", "drive in time", "N mm", "energy stored in contacts and supports"),
    Quantity("curvature_work", "drive in time", "N mm", "work of changing radii of curvature"),
    Quantity("station_work", "drive in time", "N mm", "work of contacts that move over the bodies"),
    Quantity("teeth_work", "drive in time", "N mm", "work of teeth of a first stage by what planets carry unevenly"),
    Quantity("input_work", "drive in time", "N mm", "work done at the input"),
    Quantity(
        "output_work", "drive in time", "N mm", "work done by the output on its load, forces from outside among it"
    ),
    Quantity("damping_work", "drive in time", "N mm", "work lost in damping"),
    Quantity("friction_work", "drive in time", "N mm", "work lost in friction, seals and oil among it"),
)
IN_TIME = {quantity.name: quantity for quantity in _IN_TIME}
"""Arrays of a run in time by name, whose dimensions are others than those of the same names along positions."""
NEED_SLICES = frozenset(quantity.name for quantity in _ALONG_WIDTH)
"""Quantities that only contacts in slices have."""
SCALARS = {
    scalar.name: scalar
    for quantity in _DECLARED
    for each in quantity.scalars
    for scalar in (
        replace(each, name=each.name.format(quantity.name), unit=each.unit or quantity.unit, of=quantity.name),
    )
}
"""Every scalar by name."""
LIMITED = {scalar.limited_name: scalar for scalar in SCALARS.values() if scalar.limit is not None}
"""What ``[limits]`` may bound, by its name there."""
REFINED = {name: scalar for name, scalar in SCALARS.items() if scalar.refined}
"""Extremes that are refined over the whole turn."""


def scalar_named(name: str) -> Scalar:
    """Return a scalar, also one of a numbered disc or crank.

    Parameters
    ----------
    name : str
        With the number in its place.

    Examples
    --------
    >>> scalar_named("max_bearing_load_crank_2").title
    'bearing load of crank 2, largest'
    """
    if name in SCALARS:
        return SCALARS[name]
    number = name.rpartition("_")[2]
    found = SCALARS[f"{name.removesuffix(number)}#"]
    return replace(found, name=name, title=found.title.replace("#", number))


def printed(value: float, form: str, unit: str = "") -> str:
    """Return a number as summaries, tables and verdicts print it: nothing is 0, without a sign.

    Parameters
    ----------
    value : float
        In the unit.
    form : str
        Format with braces.
    unit : str
        What is below its `RESOLUTION` is nothing.

    Examples
    --------
    >>> printed(-1.16e-11, "{:.5g}", "arcmin"), printed(-0.3, "{:.0f}"), printed(-1.16e-11, "{:.3g}", "N")
    ('0', '0', '-1.16e-11')
    """
    text = form.format(0.0 if abs(value) < RESOLUTION.get(unit, 0.0) else value)
    return text if text.strip("+-0.") else text.lstrip("+-")


def unit_sign(unit: str) -> str:
    """Return a unit as it is printed, empty for plain numbers.

    Parameters
    ----------
    unit : str
        Of a quantity.

    Examples
    --------
    >>> unit_sign("arcsec"), unit_sign("MPa")
    ('″', 'MPa')
    """
    return SIGNS.get(unit, unit)
