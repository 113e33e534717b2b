"""JSON with everything of a reduced drive, its tables as CSV, and what they mean."""

from __future__ import annotations

from typing import Any

from ltca.drive.units.quantities import ARCMIN


def csv_texts(tables: dict[str, Any]) -> dict[str, str]:
    """Return the tables as CSV, by the ends of their names.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive.
    """
    wind_up, friction, loop = tables["wind_up"], tables["friction"], tables["hysteresis"]
    columns = {"torque_N_m": wind_up["torque_N_m"], "mean_rad": wind_up["mean_rad"]}
    columns["residual_rms_rad"] = wind_up["residual_rms_rad"]
    for one in wind_up["orders"]:
        columns[f"cos_order_{one['order']:.9g}_rad"] = one["cos_rad"]
        columns[f"sin_order_{one['order']:.9g}_rad"] = one["sin_rad"]
    names = (
        "torque_N_m", "at_input_turning_ccw_N_m", "at_input_turning_cw_N_m", "efficiency_input_driving",
        "efficiency_output_driving",
    )  # fmt: skip
    return {
        "wind_up.csv": _csv(columns),
        "friction.csv": _csv({name: friction[name] for name in names}),
        "hysteresis_factor.csv": _csv(
            {
                name: [one[name] for one in loop["factor_orders"]]
                for name in ("order", "cos_ccw", "sin_ccw", "cos_cw", "sin_cw")
            }
        ),
        "hysteresis.csv": _csv({name: column for name, column in loop.items() if name != "factor_orders"}),
    }


def _csv(columns: dict[str, list[float]]) -> str:
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(f"{value:.12g}" for value in row) for row in rows)]) + "\n"


def readme_text(tables: dict[str, Any]) -> str:
    """Return what the files of a drive hold, in which units and signs, and how good they are.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name.
    """
    name, held = tables["name"], tables["held"].replace("-", " ")
    output = "pin shaft" if tables["held"] == "pin-wheel" else "pin wheel"
    limits, spring = tables["limits"], tables["linear_spring"]
    errors = "\n".join(
        f"| {kind.replace('_', ' ')} | {100.0 * one['part_of_torque_range']:.3g} %, {ARCMIN * one['angle_rad']:.2g}′ | "
        f"{100.0 * one['mean_over_crank_angle_part_of_torque_range']:.2g} %, {ARCMIN * one['mean_over_crank_angle_rad']:.2g}′ | "
        f"{100.0 * one['scatter_over_crank_angle_part_of_torque_range']:.2g} %, "
        f"{ARCMIN * one['scatter_over_crank_angle_rad']:.2g}′ | {one['crank_angles']} | {one['points']} |"
        for kind, one in tables["fit_error"].items()
    )
    speed, damping = limits["input_speed_rpm"], tables["damping"]["at_output_N_m_s_per_rad"]
    return f"""# {name}: a reduced drive

Written by cyclo {tables["cyclo_version"]} from the drive {tables["drive"]}, case {tables["case"]}, fingerprint {tables["fingerprint"]}, engine {tables["engine"]}.

| file | contents |
|---|---|
| `{name}.json` | everything |
| `{name}_wind_up.csv` | by the torque on the output: mean wind-up over the crank angle, and cosine and sine of each order of the transmission error; the JSON file names those above the residual of the fit, the others belong to no motion of the drive alone |
| `{name}_friction.csv` | by the torque on the output: friction torque at the input that turns ccw and cw, efficiency with input and output driving |
| `{name}_hysteresis.csv` | Maxwell-slip elements, a row each, with the weight 1 + amplitude·cos(order·φ − phase) on strength and stiffness; none without friction |
| `{name}_hysteresis_factor.csv` | orders over the crank angle of the factor of their strength, for a torque on the output that turns it ccw and cw |
| `reduced_drive.py` | the law that these tables are for, numpy alone |

## Units and signs
Torques in N·m, angles in rad, inertias in kg·m², speeds in turns a minute. Everything is counter-clockwise positive, seen against the axis z, and against the held member, the {held};
the output is the {output}. The torque on the output is positive as it turns the output ccw. The transmission ratio i = {tables["transmission_ratio"]:.9g} is that of the turns of the input by those of the
output, with sign. The crank angle is {tables["crank_turns_per_input_turn"]:.9g} times the angle of the input.

## Law
- Wind-up x = output angle − input angle/i. At the torque T_j of row j of the table x_j = mean + Σ cos_order·cos(order·φ) + sin_order·sin(order·φ) with the crank angle φ. The elastic torque f is linear between
  these nodes, and beyond them. The play lies between the two least torques.
- Element on the flank s = ±1, with the load q = max(s·f, 0): z moves by g·w·stiffness·Δq and stays within ± g·w·strength·T_r·(q/T_r)^exponent with the rated torque T_r = {limits["rated_torque_N_m"]:g} N·m. g = 1 + Σ cos·cos(order·φ) +
  sin·sin(order·φ), by the flank; w = 1 + amplitude·cos(order·φ − phase). The output is held with f + Σs·z.
- The torque on the input is (f + Σs·z)/i and friction against its motion.
- Efficiency and friction are means over a turn. {tables["friction"]["speed_words"][0].upper() + tables["friction"]["speed_words"][1:]}.

## How good it is
Valid from −{limits["peak_torque_N_m"]:g} to {limits["peak_torque_N_m"]:g} N·m ({limits["peak_torque_from"]}){"" if speed is None else f" and to {speed:g} turns a minute of the input"}; {tables["valid_range"]["speed_words"]}.
Differences from the analysis, torques at its wind-up by the range of {2.0 * limits["peak_torque_N_m"]:g} N·m, angles at its torque: the largest at single crank angles; the largest along the
path of their means over the crank angles, which is what a loop at a mean crank angle is off by; the largest of their standard deviations about it:

| compared | at single crank angles | mean over crank angles | scatter over crank angles | crank angles | points |
|---|---|---|---|---|---|
{errors}

A linear spring of {spring["stiffness_N_m_per_rad"]:.6g} N·m/rad behind the mean play of {spring["play_rad"]:.4g} rad is within {100.0 * spring["part_of_torque_range"]:.3g} % of the range of the mean curve.
Damping at the output: {"not given" if damping is None else f"{damping:.6g} N·m·s/rad"} ({tables["damping"]["words"]}).
"""
