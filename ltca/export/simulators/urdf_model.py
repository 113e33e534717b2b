"""URDF of a reduced drive: a joint with limits and friction, and its transmission."""

from __future__ import annotations

from math import pi
from typing import Any

from ltca.export.simulators.mujoco_model import comment, flange_inertia, largest_input_torque, rotor_inertia


def urdf_text(tables: dict[str, Any]) -> str:
    """Return the URDF of the drive between a housing and its output.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name and a speed.
    """
    name, ratio, limits = tables["name"], tables["transmission_ratio"], tables["limits"]
    velocity = limits["input_speed_rpm"] * 2.0 * pi / 60.0 / abs(ratio)
    friction = tables["friction"]["at_input_turning_ccw_N_m"]
    at_rest = friction[len(friction) // 2] * abs(ratio)
    flange, from_words = flange_inertia(tables)
    head = f"{tables['drive']} {tables['case']}, fingerprint {tables['fingerprint']}, cyclo {tables['cyclo_version']}"
    return f"""<?xml version="1.0"?>
<!-- {comment(head)}
     Friction is that without load, at the output; it does not go with speed, so damping is 0. Wind-up, play, hysteresis, friction
     under load and transmission error, which URDF cannot say, are in {name}.json. The drive's own inertia with what turns with its
     input is {rotor_inertia(tables):.6g} kg m2 at the input. Inertia of the output: {comment(from_words)}. -->
<robot name="{name}">
  <link name="{name}_housing"/>
  <link name="{name}_flange">
    <inertial>
      <origin xyz="0 0 0" rpy="0 0 0"/>
      <mass value="{max(tables["inertia"]["given_output_mass_kg"] or 0.0, 0.001):.9g}"/>
      <inertia ixx="{flange:.9g}" ixy="0" ixz="0" iyy="{flange:.9g}" iyz="0" izz="{flange:.9g}"/>
    </inertial>
  </link>
  <joint name="{name}_output" type="continuous">
    <parent link="{name}_housing"/>
    <child link="{name}_flange"/>
    <origin xyz="0 0 0" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <dynamics damping="0" friction="{at_rest:.9g}"/>
    <limit effort="{limits["peak_torque_N_m"]:.9g}" velocity="{velocity:.9g}"/>
  </joint>
  <transmission name="{name}_transmission">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="{name}_output">
      <hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface>
    </joint>
    <actuator name="{name}_motor">
      <mechanicalReduction>{ratio:.12g}</mechanicalReduction>
      <motorTorqueLimit>{largest_input_torque(tables):.9g}</motorTorqueLimit>
    </actuator>
  </transmission>
</robot>
"""
