"""Which scalars of a summary a table shows, in which order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ltca.equilibrium.compliance_shares import PARTS
from ltca.quantities import Scalar, scalar_named

ROWS = (
    "mean_bearing_load", "mean_radial_bearing_load", "mean_tangential_bearing_load", "ptp_tangential_bearing_load",
    "max_bearing_load", "max_pin_load", "max_pin_pressure_mid", "max_pin_pressure_max", "max_roller_load",
    "max_roller_pressure_mid", "max_roller_pressure_max", "max_pin_shaft_load", "max_pin_shaft_pressure_mid",
    "max_pin_shaft_pressure_max", "pin_shaft_loaded_range", "mean_loaded_pins", "mean_loaded_rollers",
    "mean_loaded_pin_shaft_pins", "ptp_transmission_error", "ptp_transmission_error_light", "backlash_output",
    "backlash_disc", "backlash_wheel",
)  # fmt: skip
SEAT_ROWS = (
    "max_pin_seat_pressure", "max_hole_seat_pressure", "max_pin_deflection", "max_shaft_pin_deflection",
    "max_ring_displacement_radial",
)  # fmt: skip
WIDTH_ROWS = (
    *(f"max_{part}_{kind}" for kind in ("line_load", "face_load_factor") for part in ("pin", "roller", "pin_shaft")),
    "max_disc_tilt", "max_crank_bearing_moment",
)  # fmt: skip
REACTION_ROWS = (
    "max_crank_support_load_first", "max_crank_support_load_second", "max_first_stage_tangential_force",
    "max_first_stage_radial_force", "max_first_stage_axial_force", "max_main_bearing_radial", "max_main_bearing_axial",
    "max_main_bearing_moment", "max_main_bearing_axial_displacement", "cycloid_stage_stiffness", "reducer_stiffness",
)  # fmt: skip
FRICTION_ROWS = (
    "mean_efficiency", "mean_efficiency_back", "moves_back", "mean_crank_torque", "drag_torque", "power_loss", "power_loss_pin",
    "power_loss_seat", "power_loss_hole", "power_loss_roller", "power_loss_support_bearing", "power_loss_no_load",
    "max_pin_pv", "max_pin_shaft_pv",
)  # fmt: skip
WALL_ROWS = ("max_root_stress", "max_hole_stress", "max_bore_stress")

Summaries = Mapping[str, Mapping[str, float | None]]
"""Summaries by case."""


def rows_of(summaries: Summaries, *, yields: bool) -> list[Scalar]:
    """Return the rows of a table of summaries that say something; `yields` tells whether cranks or wheel yield on supports."""
    found = [
        scalar_named(name)
        for name in (*ROWS, "preloaded_part_of_turn", *WIDTH_ROWS, *SEAT_ROWS, *REACTION_ROWS, *FRICTION_ROWS)
    ]
    needed = ("preloaded_part_of_turn", "interference")
    found += [*_share_rows(summaries), *_compliance_rows(summaries, yields)]
    found += [scalar_named(name) for name in ("max_equilibrium_residual", "residual_part", "interference", *WALL_ROWS)]
    shafts = any(case.get(scalar_named("max_pin_shaft_load").key) is not None for case in summaries.values())
    return [
        row
        for row in found
        if (row.name in ROWS and (shafts or "pin_shaft" not in row.name))
        or any(
            case.get(row.key) if row.name in needed else case.get(row.key) is not None for case in summaries.values()
        )
    ]


def with_residual_part(case: Mapping[str, float | None]) -> dict[str, float | None]:
    """Return a summary with what the residual is against: very stiff supports leave round-off of tenths of a newton."""
    residual, load = case["max_equilibrium_residual_N"], case["max_bearing_load_N"]
    return {**case, "residual_part": residual / load if residual is not None and load else None}


def _share_rows(summaries: Summaries) -> Iterator[Scalar]:
    """Parts of the torque, of several discs."""
    discs = sum(key.startswith("mean_torque_share_disc_") for key in next(iter(summaries.values())))
    for disc in range(discs if discs > 1 else 0):
        yield scalar_named(f"mean_torque_share_disc_{disc}")
        yield scalar_named(f"max_torque_share_disc_{disc}")


def _compliance_rows(summaries: Summaries, yields: bool) -> Iterator[Scalar]:
    """What yields how much, where more does than contacts of a central crank; torques of several cranks."""
    cranks = sum(key.startswith("mean_torque_crank_") for key in next(iter(summaries.values())))
    for crank in range(cranks if cranks > 1 else 0):
        yield scalar_named(f"mean_torque_crank_{crank}")
        yield scalar_named(f"max_bearing_load_crank_{crank}")
    yield from (scalar_named(f"max_crank_deflection_crank_{crank}") for crank in range(cranks))
    for part in PARTS if yields or cranks > 1 else ():
        row = scalar_named(f"compliance_share_{part}")
        if any(case[row.key] for case in summaries.values()):
            yield row
