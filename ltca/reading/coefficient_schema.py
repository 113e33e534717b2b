"""Schema of a file of influence coefficients, of this or another code.

A file of another finite-element code needs neither the attributes about our derivation nor the data that serve only to check
it (wider patches, resultants); everything in it must have the form of ``docs/theory/coefficients.md``.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.parts import Drive, Materials
from ltca.errors import CycloError, DamagedFileError
from ltca.geometry.boundary_stations import uniform_parameter

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

# Dimensions of the variables that are used; a scalar has none.
NEEDED: dict[str, tuple[str, ...]] = {
    "station_boundary": ("station",),
    "station_parameter": ("station",),
    "station_x": ("station",),
    "station_y": ("station",),
    "station_normal_x": ("station",),
    "station_normal_y": ("station",),
    "station_half_width": ("station",),
    "disc_approach": ("station", "station_loaded"),
    "pin_approach": (),
    "pin_half_width": (),
    "roller_approach": ("roller_end", "roller_end_loaded"),
    "roller_half_width": ("roller_end",),
    "race_angle": ("race_angle",),
    "race_approach": ("race_angle",),
    "race_half_width": (),
}
# Those of solid bodies besides: under loads linear along the width.
NEEDED_OF_SOLIDS: dict[str, tuple[str, ...]] = {
    "disc_tilt_approach": ("station", "station_loaded"),
    "pin_tilt_approach": (),
    "roller_tilt_approach": ("roller_end", "roller_end_loaded"),
    "race_tilt_approach": ("race_angle",),
}
# Dimensions of optional variables, in groups that come together.
OPTIONAL: tuple[dict[str, tuple[str, ...]], ...] = (
    {"disc_resultant": ("motion", "station")},
    {"wide_station": ("wide",), "wide_half_width": ("wide",), "wide_approach": ("wide",)},
    {"pin_wide_approach": ()},
    {"roller_wide_approach": ()},
    {"race_wide_approach": ()},
    {
        "disc_stress": ("stress_station", "station_loaded"),
        "stress_station_boundary": ("stress_station",),
        "stress_station_parameter": ("stress_station",),
    },
)
# Of solid bodies besides.
OPTIONAL_OF_SOLIDS: tuple[dict[str, tuple[str, ...]], ...] = (
    {"layer_height": ("layer",)},
    {"disc_tilt_resultant": ("tilt", "station")},
    {"wide_tilt_approach": ("wide",), "wide_approach": ("wide",)},
    {"pin_wide_tilt_approach": (), "pin_wide_approach": ()},
    {"roller_wide_tilt_approach": (), "roller_wide_approach": ()},
    {"race_wide_tilt_approach": (), "race_wide_approach": ()},
)
# Bodies of a file, and their names in the materials of a drive.
PARTS = {"disc": "disc", "pin": "wheel_pin", "roller": "roller", "race": "inner_race"}
CONSTANTS = ("youngs_modulus", "poisson_ratio")
# Dimensions whose entries may be labelled, by consecutive numbers or by these words; entries are used in their order.
LABELS: dict[str, tuple[str, ...]] = {
    "station": (),
    "station_loaded": (),
    "stress_station": (),
    "motion": ("x", "y", "rotation"),
    "tilt": ("x", "y"),
    "roller_end": ("inner", "outer"),
    "roller_end_loaded": ("inner", "outer"),
}
# Attributes that repeat numbers of `shape`, which identifies the bodies (`ltca.drive.parts.Drive.body_shape`).
REPEATED = {
    "thickness": "disc.thickness",
    "roller_radius": "crank_bearing.roller_radius",
    "roller_length": "crank_bearing.roller_length",
    "core_radius": "pin_wheel.core_radius",
    "race_bore_radius": "crank_bearing.race_bore_radius",
} | {f"{body}_{constant}": f"materials.{part}.{constant}" for body, part in PARTS.items() for constant in CONSTANTS}
# Numbers that a shape holds only where they are not the defaults.
HAVE_DEFAULTS = ("pin_wheel.core_radius", "crank_bearing.race_bore_radius")
CLEARANCES = ("bearing_clearance", "pin_hole_clearance")
POSITIVE_ATTRIBUTES = ("thickness", "roller_radius", *(f"{body}_youngs_modulus" for body in PARTS))
STATEMENTS = (
    "symmetry",
    "rigid_residual",
    "convergence_estimate",
    "convergence_estimate_tilt",
    "convergence_stress",
    "interpolation_error",
    "interpolation_error_tilt",
)
POISSON_RATIOS = tuple(f"{body}_poisson_ratio" for body in PARTS)
# Interpolation takes six stations; with fewer on a boundary some would count twice.
FEWEST_STATIONS = 6
# Kepler's equation is inverted to round-off up to it; stations at the tips are 66 times as far apart as in the roots.
MAX_CLUSTERING = 0.97
# Relative rounding of numbers that stand in a file twice.
REPEATED_TOLERANCE = 1e-9
# Tolerance for uniform parameters and unit normals: the rounding of seven digits.
UNIFORM = 1e-6


def require_schema(dataset: Labelled, source: str) -> None:
    """Refuse a dataset that is not a set of influence coefficients: DamagedFileError with everything that is missing or
    malformed.

    `source` is the name of the file, for the message.
    """
    problems = [*_missing(dataset)] or [*_misshapen(dataset)] or [*_implausible(dataset)]
    if problems:
        raise DamagedFileError(
            f"{source}: is no file of influence coefficients (docs/theory/coefficients.md): {'; '.join(problems)}"
        )


def is_solid(dataset: Labelled) -> bool:
    """Tell whether a file is of solid bodies, with coefficients for the tilt of contacts as well."""
    return _number(dataset.attrs.get("dimensions", 2)) == 3.0


def _needed(dataset: Labelled) -> dict[str, tuple[str, ...]]:
    return NEEDED | NEEDED_OF_SOLIDS if is_solid(dataset) else NEEDED


def _groups(dataset: Labelled) -> tuple[dict[str, tuple[str, ...]], ...]:
    return OPTIONAL + OPTIONAL_OF_SOLIDS if is_solid(dataset) else OPTIONAL


def _missing(dataset: Labelled) -> Iterator[str]:
    variables = [name for name in _needed(dataset) if name not in dataset.variables]
    for group in OPTIONAL:
        if any(name in dataset.variables for name in group):
            variables += [name for name in group if name not in dataset.variables]
    for group in OPTIONAL_OF_SOLIDS if is_solid(dataset) else ():
        first = next(iter(group))
        if first in dataset.variables:
            variables += [name for name in group if name not in dataset.variables]
    if variables:
        yield f"it lacks {', '.join(variables)}"
    attributes = [
        name
        for name in (
            "shape",
            "clearances_left_out",
            *CLEARANCES,
            "plane",
            *POSITIVE_ATTRIBUTES,
            *POISSON_RATIOS,
            *(("roller_length",) if is_solid(dataset) else ()),
        )
        if name not in dataset.attrs
    ]
    if attributes:
        yield f"it lacks the attributes {', '.join(attributes)}"


def _misshapen(dataset: Labelled) -> Iterator[str]:
    for group in (_needed(dataset), *_groups(dataset)):
        for name, dimensions in group.items():
            if name not in dataset.variables:
                continue
            variable = dataset[name]
            if variable.dims != dimensions:
                yield f"{name} has the dimensions ({', '.join(map(str, variable.dims))}): must be ({', '.join(dimensions)})"
            elif variable.values.dtype.kind not in "iuf":
                yield f"{name} holds no numbers"
            elif not np.all(np.isfinite(variable.values)):
                yield f"{name} holds values that are no finite numbers"
    for rows, columns in (("station", "station_loaded"), ("roller_end", "roller_end_loaded")):
        if dataset.sizes.get(rows) != dataset.sizes.get(columns):
            yield f"{rows} and {columns} differ in length: {dataset.sizes.get(rows)} and {dataset.sizes.get(columns)}"
    for name, words in LABELS.items():
        if name in dataset.variables and not _in_order(dataset, name):
            told = f", or {', '.join(words)}" if words else ""
            yield f"{name} must number its entries 0, 1, 2, …{told}: they are used in their order"
    if dataset.sizes.get("motion", 3) != 3:
        yield f"motion has length {dataset.sizes['motion']}: must be 3 (x, y, rotation)"
    if dataset.sizes.get("tilt", 2) != 2:
        yield f"tilt has length {dataset.sizes['tilt']}: must be 2 (x, y)"
    if dataset.sizes.get("roller_end", 2) != 2:
        yield f"roller_end has length {dataset.sizes['roller_end']}: must be 2 (inner, outer)"


def _in_order(dataset: Labelled, name: str) -> bool:
    """Tell whether the labels along a dimension are in the order in which entries are used."""
    labels = dataset[name].values
    if labels.dtype.kind in "iuf":
        return labels.ndim == 1 and bool(np.array_equal(labels, labels[:1] + np.arange(labels.size)))
    said = tuple(
        label.decode("utf-8", "replace") if isinstance(label, bytes) else str(label) for label in labels.tolist()
    )
    return said == LABELS[name]


def _implausible(dataset: Labelled) -> Iterator[str]:
    plane, dimensions = dataset.attrs["plane"], dataset.attrs.get("dimensions", 2)
    if _number(dimensions) not in (2.0, 3.0):
        yield f"dimensions = {dimensions}: must be 2 (left out) or 3"
    elif is_solid(dataset) and plane != "solid":
        yield f"plane = {plane}: must be solid with dimensions = 3"
    elif not is_solid(dataset) and plane not in ("strain", "stress"):
        yield f"plane = {plane}: must be strain or stress"
    if not is_solid(dataset):
        for name in (*NEEDED_OF_SOLIDS, *(next(iter(group)) for group in OPTIONAL_OF_SOLIDS)):
            if name in dataset.variables:
                yield f"{name} has no meaning without dimensions = 3"
    for name in (*POSITIVE_ATTRIBUTES, *(("roller_length",) if is_solid(dataset) else ())):
        if not _number(dataset.attrs[name]) > 0.0:
            yield f"{name} = {dataset.attrs[name]}: must be greater than 0"
    if not 0.0 <= flank_clustering(dataset) < MAX_CLUSTERING:
        yield f"flank_clustering = {dataset.attrs['flank_clustering']}: must be at least 0 and less than {MAX_CLUSTERING:g}"
        return
    for name in POISSON_RATIOS:
        if not 0.0 <= _number(dataset.attrs[name]) < 0.5:
            yield f"{name} = {dataset.attrs[name]}: must be at least 0 and less than 0.5"
    yield from _contradictions(dataset)
    for name in STATEMENTS:
        if name in dataset.attrs and not _number(dataset.attrs[name]) >= 0.0:
            yield f"{name} = {dataset.attrs[name]}: must be a number, at least 0"
    for name in ("station_half_width", "pin_half_width", "roller_half_width", "race_half_width"):
        if not np.all(dataset[name].values > 0.0):
            yield f"{name} must be greater than 0"
    yield from _misplaced(dataset)


def flank_clustering(dataset: Labelled) -> float:
    """Return how much closer the stations of the flank stand in its roots, a of `ltca.geometry.boundary_stations`; 0 where a
    file does not say, whose stations are uniform.
    """
    return _number(dataset.attrs.get("flank_clustering", 0.0))


def uniform_parameters(dataset: Labelled, kind: str, boundary: int) -> FloatArray:
    """Return the parameters of one boundary in which its stations (`kind`: station, stress_station) are uniform, rad."""
    parameter = dataset[f"{kind}_parameter"].values[dataset[f"{kind}_boundary"].values == boundary]
    teeth = round(shape_of(dataset).get("disc.number_of_teeth", 1.0))
    return uniform_parameter(parameter, teeth, 0.0 if boundary else flank_clustering(dataset))


def elastic_constants(materials: Materials) -> dict[str, float]:
    """Return the attributes with Young's modulus, MPa, and Poisson's ratio of each body."""
    return {
        f"{body}_{constant}": getattr(getattr(materials, part), constant)
        for body, part in PARTS.items()
        for constant in CONSTANTS
    }


def shape_of(dataset: Labelled) -> dict[str, float]:
    """Return the numbers that determine the bodies of a file; none when the attribute `shape` cannot be read."""
    try:
        return {str(name): float(value) for name, value in json.loads(str(dataset.attrs["shape"])).items()}
    except (KeyError, ValueError, TypeError, AttributeError, RecursionError):
        return {}


def shape_differences(theirs: dict[str, float], own: dict[str, float]) -> dict[str, tuple[str, str]]:
    """Return the numbers in which two shapes (`ltca.drive.parts.Drive.body_shape`) differ, theirs and ours as texts.

    "none" stands where a shape is without the number, "the default" where it then has one.

    Examples
    --------
    >>> shape_differences({"crank.number": 3.0, "bore_radius": 7.0}, {"bore_radius": 7.0})
    {'crank.number': ('3', 'none')}
    """

    def told(shape: dict[str, float], name: str) -> str:
        return f"{shape[name]:g}" if name in shape else "the default" if name in HAVE_DEFAULTS else "none"

    names = [name for name in own | theirs if own.get(name) != theirs.get(name)]
    return {name: (told(theirs, name), told(own, name)) for name in names}


def require_same_supports(source: str, dataset: Labelled, drive: Drive) -> None:
    """Refuse a file that says it held pins or race otherwise than the drive does; a file need not say it."""
    wheel, bearing = drive.pin_wheel, drive.crank_bearing
    for name, field, own in (
        ("core_radius", "pin_wheel.core_radius", wheel.held_core_radius),
        ("race_bore_radius", "crank_bearing.race_bore_radius", bearing.held_bore_radius),
    ):
        if name not in dataset.attrs:
            continue
        there = _number(dataset.attrs[name])
        if not abs(there - own) <= REPEATED_TOLERANCE * own:
            raise CycloError(
                f"{source}: belongs to {field} = {there:g} mm, not to the {own:g} mm of {drive.name}: give the drive that "
                f"{field}, or derive its own (cyclo derive)"
            )


def _contradictions(dataset: Labelled) -> Iterator[str]:
    shape = shape_of(dataset)
    if not shape:
        yield "shape must be a JSON object of numbers (Drive.body_shape)"
    for name in ("clearances_left_out", *CLEARANCES):
        if not _number(dataset.attrs[name]) >= 0.0:
            yield f"{name} = {dataset.attrs[name]}: must be a number, at least 0"
    for name, path in REPEATED.items():
        if name not in dataset.attrs:
            continue  # optional, or missing, which was said
        own = _number(dataset.attrs[name])
        if path not in shape and name == "roller_length" and is_solid(dataset):
            yield f"shape lacks {path}, the roller_length of solid bodies"
        if path in shape and not abs(own - shape[path]) <= REPEATED_TOLERANCE * abs(shape[path]):
            yield f"{name} = {own:g}: must be {shape[path]:g} as in shape"


def _misplaced(dataset: Labelled) -> Iterator[str]:
    boundary = dataset["station_boundary"].values
    numbers = np.unique(boundary)
    if np.any(np.diff(boundary) < 0) or not np.array_equal(numbers, np.arange(len(numbers))) or len(numbers) < 3:
        yield "station_boundary must be 0 (flank), 1 (bore; 1 … s of s cranks), then holes, in this order"
        return
    if is_solid(dataset) and "layer_height" in dataset.variables:
        heights = dataset["layer_height"].values
        end = 0.5 * float(dataset.attrs["thickness"])
        if (
            heights.size < 2
            or heights[0] != 0.0
            or np.any(np.diff(heights) <= 0.0)
            or abs(heights[-1] - end) > UNIFORM * end
        ):
            yield f"layer_height must ascend from 0 to half of the thickness, {end:g} mm"
    places = [("race_angle", dataset["race_angle"].values)]
    for kind in ("station", "stress_station"):
        if f"{kind}_boundary" in dataset.variables:
            own = dataset[f"{kind}_boundary"].values
            if not np.array_equal(np.unique(own), numbers) or np.any(np.diff(own) < 0):
                yield f"{kind}_boundary must have the boundaries of station_boundary, in their order"
                return
            places += [
                (f"{kind}_parameter of boundary {k}", uniform_parameters(dataset, kind, k)) for k in numbers.tolist()
            ]
    for name, values in places:
        count = len(values)
        if count < FEWEST_STATIONS:
            yield f"{name} has {count} values: must be at least {FEWEST_STATIONS}"
        elif np.max(np.abs(values - 2.0 * np.pi * np.arange(count) / count)) > UNIFORM:
            yield f"{name} must be uniform over one turn and begin with 0 (rad){_clustered(dataset, name)}"
    length = np.hypot(dataset["station_normal_x"].values, dataset["station_normal_y"].values)
    if np.max(np.abs(length - 1.0)) > UNIFORM:
        yield "station_normal_x and station_normal_y must be of unit length"
    if "wide_station" in dataset.variables:
        wide = dataset["wide_station"].values
        if wide.size == 0 or wide.dtype.kind == "f" or wide.min() < 0 or wide.max() >= dataset.sizes["station"]:
            yield "wide_station must hold numbers of stations"


def _clustered(dataset: Labelled, name: str) -> str:
    """Return in which parameter the flank of a file is uniform, for a message; nothing where that is the file's own."""
    clustering = flank_clustering(dataset)
    return f" in t of θ = t − {clustering:g}/z sin(z t)" if clustering and name.endswith("boundary 0") else ""


def _number(value: object) -> float:
    """Return an attribute as a number, NaN where it is not one."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return float("nan")
