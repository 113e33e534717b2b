"""The scalars of a summary in words: which of them a table shows, in which unit and with how many digits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ltca.equilibrium.compliance_shares import PARTS

Row = tuple[str, str, str, str]
"""Title, key of the summary, unit and how the number is printed."""

ROWS = (
    ("mean bearing load", "mean_bearing_load_N", "N", "{:.1f}"),
    ("  radial", "mean_radial_bearing_load_N", "N", "{:.1f}"),
    ("  tangential", "mean_tangential_bearing_load_N", "N", "{:.1f}"),
    ("  tangential, peak to peak", "ptp_tangential_bearing_load_N", "N", "{:.1f}"),
    ("largest bearing load", "max_bearing_load_N", "N", "{:.1f}"),
    ("largest pin load", "max_pin_load_N", "N", "{:.1f}"),
    ("largest pin pressure, mid-width", "max_pin_pressure_mid_MPa", "MPa", "{:.1f}"),
    ("  anywhere (end cell a hundredth)", "max_pin_pressure_max_MPa", "MPa", "{:.1f}"),
    ("largest roller load", "max_roller_load_N", "N", "{:.1f}"),
    ("largest roller pressure, mid-width", "max_roller_pressure_mid_MPa", "MPa", "{:.1f}"),
    ("  anywhere (end cell a hundredth)", "max_roller_pressure_max_MPa", "MPa", "{:.1f}"),
    ("largest pin-shaft load", "max_pin_shaft_load_N", "N", "{:.1f}"),
    ("largest pin-shaft pressure, mid-width", "max_pin_shaft_pressure_mid_MPa", "MPa", "{:.1f}"),
    ("  anywhere (end cell a hundredth)", "max_pin_shaft_pressure_max_MPa", "MPa", "{:.1f}"),
    ("pin-shaft loaded range", "pin_shaft_loaded_range_deg", "°", "{:.1f}"),
    ("loaded wheel pins, mean", "mean_loaded_pins", "", "{:.2f}"),
    ("loaded rollers, mean", "mean_loaded_rollers", "", "{:.2f}"),
    ("loaded pin-shaft pins, mean", "mean_loaded_pin_shaft_pins", "", "{:.2f}"),
    ("transmission error, peak to peak", "ptp_transmission_error_arcsec", "″", "{:.2f}"),
    ("  at the light torque", "ptp_transmission_error_light_arcsec", "″", "{:.2f}"),
    ("backlash at the output, all clearances, largest", "backlash_output_arcmin", "′", "{:z.2f}"),
    ("  of the flank alone, at the disc", "backlash_disc_arcmin", "′", "{:z.2f}"),
    ("  of the flank alone, at the wheel", "backlash_wheel_arcmin", "′", "{:z.2f}"),
)
RESIDUAL_PART = "residual_part"
RESIDUAL_ROWS = (
    ("largest residual", "max_equilibrium_residual_N", "N", "{:.1e}"),
    ("  as a part of the largest bearing load", RESIDUAL_PART, "", "{:.1e}"),
)
PRELOAD_ROWS = (("  part of the turn where parts overlap in every pose", "preloaded_part_of_turn", "", "{:.2f}"),)
INTERFERENCE_ROWS = (("  pins and flank overlap at rest by", "interference_mm", "mm", "{:.4f}"),)
SEAT_ROWS = (
    ("largest pressure in wheel-pin seats", "max_pin_seat_pressure_MPa", "MPa", "{:.1f}"),
    ("largest pressure in shaft-pin sleeves", "max_hole_seat_pressure_MPa", "MPa", "{:.1f}"),
    ("largest deflection of a wheel pin", "max_pin_deflection_mm", "mm", "{:.4f}"),
    ("largest deflection of a shaft pin", "max_shaft_pin_deflection_mm", "mm", "{:.4f}"),
)
FRICTION_ROWS = (
    ("efficiency, mean", "mean_efficiency", "", "{:.4f}"),
    ("  with the motion reversed", "mean_efficiency_back", "", "{:.4f}"),
    ("  moves back (1) or locks itself (0)", "moves_back", "", "{:.0f}"),
    ("torque of the cranks, mean", "mean_crank_torque_Nmm", "N·mm", "{:.1f}"),
    ("power lost", "power_loss_W", "W", "{:.3g}"),
    ("  flank on wheel pins", "power_loss_pin_W", "W", "{:.3g}"),
    ("  seats of pins and sleeves", "power_loss_seat_W", "W", "{:.3g}"),
    ("  holes on shaft pins", "power_loss_hole_W", "W", "{:.3g}"),
    ("  rolling of the crank bearings", "power_loss_roller_W", "W", "{:.3g}"),
    ("  bearings of cranks and wheel", "power_loss_support_bearing_W", "W", "{:.3g}"),
    ("  seals and oil", "power_loss_no_load_W", "W", "{:.3g}"),
    ("largest p·v at the flank", "max_pin_pv_MPa_m_s", "MPa m/s", "{:.4g}"),
    ("largest p·v at the holes", "max_pin_shaft_pv_MPa_m_s", "MPa m/s", "{:.4g}"),
)
WALL_ROWS = (
    ("largest stress along lobe roots", "max_root_stress_MPa", "MPa", "{:.1f}"),
    ("  along hole walls", "max_hole_stress_MPa", "MPa", "{:.1f}"),
    ("  along the bore", "max_bore_stress_MPa", "MPa", "{:.1f}"),
)


def rows_of(summaries: Mapping[str, Mapping[str, float | None]], *, yields: bool) -> list[Row]:
    """Return the rows of a table of summaries, those that say something.

    Parameters
    ----------
    summaries : mapping of str to mapping
        By case, each with its `RESIDUAL_PART` (`with_residual_part`).
    yields : bool
        Whether cranks or wheel yield on their supports.
    """
    walls = WALL_ROWS if all(key in case for case in summaries.values() for _, key, _, _ in WALL_ROWS) else ()
    shares = (*_share_rows(summaries), *_compliance_rows(summaries, yields))
    preload = PRELOAD_ROWS if any(row["preloaded_part_of_turn"] for row in summaries.values()) else ()
    pressed = INTERFERENCE_ROWS if any(case["interference_mm"] for case in summaries.values()) else ()
    seats = [
        row for row in (*SEAT_ROWS, *FRICTION_ROWS) if any(case.get(row[1]) is not None for case in summaries.values())
    ]
    return [*ROWS, *preload, *seats, *shares, *RESIDUAL_ROWS, *pressed, *walls]


def with_residual_part(case: Mapping[str, float | None]) -> dict[str, float | None]:
    """Return a summary with what the residual is against: very stiff supports leave round-off of tenths of a newton."""
    residual, load = case["max_equilibrium_residual_N"], case["max_bearing_load_N"]
    return {**case, RESIDUAL_PART: residual / load if residual is not None and load else None}


def _share_rows(summaries: Mapping[str, Mapping[str, float | None]]) -> Iterator[Row]:
    """Parts of the torque, of several discs."""
    discs = sum(key.startswith("mean_torque_share_disc_") for key in next(iter(summaries.values())))
    for disc in range(discs if discs > 1 else 0):
        yield f"part of the torque on disc {disc}, mean", f"mean_torque_share_disc_{disc}", "", "{:.4f}"
        yield "  largest at the positions", f"max_torque_share_disc_{disc}", "", "{:.4f}"


def _compliance_rows(summaries: Mapping[str, Mapping[str, float | None]], yields: bool) -> Iterator[Row]:
    """What yields how much, where more does than contacts of a central crank; torques of several cranks."""
    first = next(iter(summaries.values()))
    cranks = sum(key.startswith("mean_torque_crank_") for key in first)
    for crank in range(cranks if cranks > 1 else 0):
        yield f"torque of crank {crank}, mean", f"mean_torque_crank_{crank}_Nmm", "N mm", "{:.0f}"
        yield "  largest bearing load at the positions", f"max_bearing_load_crank_{crank}_N", "N", "{:.1f}"
    for crank in range(cranks):
        key = f"max_crank_deflection_crank_{crank}_mm"
        if any(key in case for case in summaries.values()):
            of = f" of crank {crank}" if cranks > 1 else " of the crank"
            yield f"largest deflection{of}", key, "mm", "{:.4f}"
    told = [part for part in PARTS if any(case[f"compliance_share_{part}"] for case in summaries.values())]
    for number, part in enumerate(told if yields or cranks > 1 else ()):
        title = "part of the compliance: " if number == 0 else "  "
        yield title + part.replace("_", " "), f"compliance_share_{part}", "", "{:.4f}"
