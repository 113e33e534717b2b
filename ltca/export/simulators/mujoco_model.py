"""MJCF of a reduced drive: joints of input and output, a fixed tendon as the spring with play between them, a motor."""

from __future__ import annotations

import re
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

STEPS_PER_RADIAN = 5.0
"""Time steps by radian of the fastest vibration of drive and flange: the step of an explicit integrator, ten times below its limit."""


def comment(text: str) -> str:
    """Return a text for a comment of XML, in which no two hyphens may stand together.

    Examples
    --------
    >>> comment("a---b & c")
    'a- - -b &amp; c'
    """
    return re.sub("-(?=-)", "- ", escape(text))


def flange_inertia(tables: dict[str, Any]) -> tuple[float, str]:
    """Return the inertia of the output in a model of the drive alone, kg·m², and in words where it is from."""
    inertia = tables["inertia"]
    if inertia["given_output_kg_m2"]:
        return float(inertia["given_output_kg_m2"]), "inertia.output of the drive file"
    return float(
        inertia["at_output_kg_m2"]
    ), "a stand-in as large as the inertia of the drive; give that of your flange"


def time_step(tables: dict[str, Any]) -> float:
    """Return a time step for an explicit integrator, s, one digit."""
    loop = tables["hysteresis"]
    most = [one * (1.0 + part) for one, part in zip(loop["stiffness"], loop["weight_amplitude"], strict=True)]
    stiffness = tables["linear_spring"]["stiffness_N_m_per_rad"] * (1.0 + sum(most))
    rotor = rotor_inertia(tables) * tables["transmission_ratio"] ** 2
    fastest = np.sqrt(stiffness * (1.0 / flange_inertia(tables)[0] + 1.0 / rotor))
    step = 1.0 / (STEPS_PER_RADIAN * fastest)
    unit = 10.0 ** np.floor(np.log10(step))
    return float(np.floor(step / unit) * unit)


def rotor_inertia(tables: dict[str, Any]) -> float:
    """Return what turns with the input, the drive itself included, kg·m²."""
    return float(tables["inertia"]["at_input_kg_m2"] + tables["inertia"]["given_input_kg_m2"])


def largest_input_torque(tables: dict[str, Any]) -> float:
    """Return the torque of the input that the peak torque of the output asks for, friction included, N·m."""
    friction, peak = tables["friction"], tables["limits"]["peak_torque_N_m"]
    ends = [friction[f"at_input_turning_{way}_N_m"][place] for way in ("ccw", "cw") for place in (0, -1)]
    return float(peak / abs(tables["transmission_ratio"]) + max(ends))


def mjcf_text(tables: dict[str, Any]) -> str:
    """Return a complete MJCF model of the drive on a fixed housing; arms are attached to the body of its output.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name.
    """
    name, spring, ratio = tables["name"], tables["linear_spring"], tables["transmission_ratio"]
    low, high = spring["stops_rad"]
    flange, from_words = flange_inertia(tables)
    friction = tables["friction"]["at_input_turning_ccw_N_m"]
    at_rest, damping = friction[len(friction) // 2], tables["damping"]["at_output_N_m_s_per_rad"]
    effort = largest_input_torque(tables)
    worst = tables["fit_error"]["worst"]
    # As stiff as the step allows: by default friction yields in 0.02 s, and a held input creeps.
    held = f' solreffriction="{2.0 * time_step(tables):g} 1" solimpfriction="0.99 0.99 0.001"'
    loss = f' frictionloss="{at_rest:.9g}"{held}' if at_rest else ""
    damped = f' damping="{damping:.9g}"' if damping else ""
    head = f"{tables['drive']} {tables['case']}, fingerprint {tables['fingerprint']}, cyclo {tables['cyclo_version']}"
    return f"""<!-- {comment(head)}
     The tendon is a linear spring behind the mean play: within {100.0 * spring["part_of_torque_range"]:.2g} % of the torque range
     of the mean curve, valid up to {tables["limits"]["peak_torque_N_m"]:g} N m. mujoco_callback.py with {name}.json replaces it by
     the curve with transmission error, hysteresis and friction by the load, within {100.0 * worst["part_of_torque_range"]:.2g} %.
     Angles are rad, ccw positive; the length of the tendon is the wind-up, output angle - input angle/({ratio:g}).
     Damping: {comment(tables["damping"]["words"])}. Inertia of the output: {comment(from_words)}. -->
<mujoco model="{name}">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{time_step(tables):g}"/>
  <worldbody>
    <body name="{name}_housing">
      <body name="{name}_rotor">
        <!-- the armature holds the inertia of motor and drive; the body only has to have some -->
        <inertial pos="0 0 0" mass="0.001" diaginertia="1e-9 1e-9 1e-9"/>
        <joint name="{name}_input" type="hinge" axis="0 0 1" armature="{rotor_inertia(tables):.9g}"{loss}/>
      </body>
      <body name="{name}_flange">
        <!-- attach the arm here -->
        <inertial pos="0 0 0" mass="{max(tables["inertia"]["given_output_mass_kg"] or 0.0, 0.001):.9g}" diaginertia="{flange:.9g} {flange:.9g} {flange:.9g}"/>
        <joint name="{name}_output" type="hinge" axis="0 0 1"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="{name}_wind_up" stiffness="{spring["stiffness_N_m_per_rad"]:.9g}" springlength="{low:.9g} {high:.9g}"{damped}>
      <joint joint="{name}_output" coef="1"/>
      <joint joint="{name}_input" coef="{-1.0 / ratio:.12g}"/>
    </fixed>
  </tendon>
  <actuator>
    <motor name="{name}_motor" joint="{name}_input" gear="1" ctrlrange="{-effort:.9g} {effort:.9g}"/>
  </actuator>
</mujoco>
"""
