"""The numbers behind the moving drive of a run: poses, loads and pressures of every contact, from the dataset of the run."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCSEC

if TYPE_CHECKING:
    import xarray as xr

    from ltca.output.labelled import Labelled, LabelledArray

MOST_VALUES = 1_500_000
"""Numbers on a page, some two megabytes: of runs with more, every second position is shown, or every third."""
CONTACTS = {
    "pin": ("pin_load", "pin_pressure_mid", "pin_half_width"),
    "outer": ("roller_load", "roller_pressure_mid_outer", "roller_half_width_outer"),
    "inner": ("roller_load_inner", "roller_pressure_mid_inner", "roller_half_width_inner"),
    "hole": ("pin_shaft_load", "pin_shaft_pressure_mid", "pin_shaft_half_width"),
}
"""Load, pressure and half-width in ``results.nc``, by kind of contact."""


ALONG_WIDTH = {
    "pin": ("pin_line_load", "pin_pressure_along_width", "pin_pressure_max"),
    "outer": ("roller_line_load", "roller_pressure_along_width_outer", "roller_pressure_max_outer"),
    "hole": ("pin_shaft_line_load", "pin_shaft_pressure_along_width", "pin_shaft_pressure_max"),
}
"""Line load and pressure along the width of contacts in slices, and their largest pressure with that at the ends, by kind."""


def shown_positions(dataset: Labelled) -> NDArray[np.intp]:
    """Return which positions of a run a page shows: all of them, or evenly chosen ones of many."""
    sizes = dataset.sizes
    each = 2 * (4 * sizes["pin"] + 6 * sizes["crank"] * sizes["roller"]) + 2 * 3 * sizes["hole"] + 30
    contacts = sizes["pin"] + sizes["crank"] * sizes["roller"] + sizes["hole"]
    each += 2 * contacts * sizes["slice"] if "slice" in sizes else 0
    values = each * sizes["disc"] * sizes["position"] * sizes["case"]
    return np.arange(0, sizes["position"], ceil(values / MOST_VALUES))


def run_arrays(dataset: Labelled, light: Labelled | None, rows: NDArray[np.intp]) -> dict[str, FloatArray]:
    """Return the arrays of a page of a run, positions last.

    ``angle``, rad; by number of the case, torque and name, as ``0/full/pin/load``: loads in N, pressures at mid-width in MPa,
    half-widths in mm of shape (discs, contacts, positions), the parameter of each contact on the flank, rad; ``radial`` and
    ``tangential`` of each disc, mm, its ``rotation``, rad, the ``wheel`` angle, rad, and the transmission error ``te`` in
    arc seconds; further curves of the whole drive (`_curves`). Of contacts in slices, at the torque of the run, ``pin/line`` and
    ``pin/along``, N/mm and MPa, of shape (discs, contacts, slices, positions), ``pin/most``, MPa, ends included, and the
    ``tilt`` of each disc, rad. The dataset is
    `ltca.analysis.results.labelled_results`, or ``results.nc`` read back, `light` the same at the light torque: without it that
    torque has its transmission error alone.
    `rows` are the positions that are shown (`shown_positions`).
    """
    arrays: dict[str, FloatArray] = {"angle": dataset["crank_angle"].values}
    for number in range(dataset.sizes["case"]):
        case = dataset.isel(case=number)
        found = {f"full/{name}": values for name, values in (_state(case) | width_arrays(case)).items()}
        if light is None:
            found["light/te"] = case["transmission_error_light"].values * ARCSEC
        else:
            found |= {f"light/{name}": values for name, values in _state(light.isel(case=number)).items()}
        arrays |= {f"{number}/{name}": values for name, values in (found | _curves(case)).items()}
    return {name: np.ascontiguousarray(values[..., rows]) for name, values in arrays.items()}


def contact_arrays(case: Labelled) -> dict[str, FloatArray]:
    """Return load, pressure and half-width of a case by kind, as ``pin/load``, of shape (discs, contacts, positions)."""
    return {
        f"{kind}/{quantity}": by_contact(case[name])
        for kind, names in CONTACTS.items()
        for quantity, name in zip(("load", "pressure", "width"), names, strict=True)
    }


def by_contact(values: LabelledArray | xr.DataArray) -> FloatArray:
    """Return values of contacts with shape (discs, contacts, positions); rollers come crank after crank."""
    (last,) = (name for name in ("pin", "roller", "hole") if name in values.dims)
    order = [name for name in ("disc", "crank", last, "position") if name in values.dims]
    found = np.asarray(values.transpose(*order).values)
    return found.reshape(found.shape[0], int(np.prod(found.shape[1:-1])), found.shape[-1])


def width_arrays(case: Labelled) -> dict[str, FloatArray]:
    """Return what contacts in slices carry along their width and the tilts of the discs; nothing in the plane."""
    if "disc_tilt" not in case:
        return {}
    found = {"tilt": np.asarray(case["disc_tilt"].transpose("disc", "axis", "position").values)}
    for kind, (line, along, most) in ALONG_WIDTH.items():
        found[f"{kind}/most"] = by_contact(case[most])
        for quantity, name in (("line", line), ("along", along)):
            values = case[name]
            (last,) = (each for each in ("pin", "roller", "hole") if each in values.dims)
            order = [each for each in ("disc", "crank", last, "slice", "position") if each in values.dims]
            each = np.asarray(values.transpose(*order).values)
            found[f"{kind}/{quantity}"] = each.reshape(each.shape[0], -1, *each.shape[-2:])
    return found


def ring_arrays(case: Labelled) -> dict[str, FloatArray]:
    """Return the displacements of the seats of the wheel pins by an elastic ring, mm, shape (pins, positions); none of a rigid.

    ``ring/radial`` outward, ``ring/tangential`` 90° ahead, both in the turning wheel.
    """
    names = {f"ring/{way}": f"ring_displacement_{way}" for way in ("radial", "tangential")}
    if not all(name in case and np.isfinite(case[name].values).any() for name in names.values()):
        return {}
    return {key: np.asarray(case[name].transpose("pin", "position").values) for key, name in names.items()}


def _state(case: Labelled) -> dict[str, FloatArray]:
    """Contacts and poses of a case at one torque."""
    return (
        contact_arrays(case)
        | ring_arrays(case)
        | {
            "pin/parameter": by_contact(case["pin_contact_parameter"]),
            "radial": case["disc_radial"].values,
            "tangential": case["disc_tangential"].values,
            "rotation": case["disc_rotation"].values,
            "wheel": case["wheel_angle"].values,
            "te": case["transmission_error"].values * ARCSEC,
        }
    )


def bearing_curves(case: Labelled) -> dict[str, FloatArray]:
    """Return the bearing forces of a case, N, shape (discs, cranks, positions)."""
    return {
        name: case[f"bearing_{name}"].transpose("disc", "crank", "position").values for name in ("radial", "tangential")
    }


def _curves(case: Labelled) -> dict[str, FloatArray]:
    """Curves of the whole drive at the torque of the run: bearing forces by disc and crank, N, torques, N·m, losses."""
    curves = bearing_curves(case)
    if case.sizes["disc"] > 1:
        torque = case["disc_torque"].values
        curves["share"] = torque / torque.sum(axis=0)
    if case.sizes["crank"] > 1:
        curves["crank"] = case["crank_torque"].values / 1000.0
    if has_friction(case):
        curves["efficiency"] = case["efficiency"].values
        for name, values in case.data_vars.items():
            if str(name).startswith("loss_") and np.any(values.values):
                curves[f"loss/{str(name).removeprefix('loss_')}"] = values.values
    return curves


def has_friction(case: Labelled) -> bool:
    """Tell whether a case has friction: beside cases that have it, others have values that are not a number."""
    return "efficiency" in case and bool(np.isfinite(case["efficiency"].values).any())
