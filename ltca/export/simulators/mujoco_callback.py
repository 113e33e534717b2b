"""What MuJoCo cannot say of a reduced cycloidal drive: curved wind-up, hysteresis, transmission error, friction by the load.

Written beside the MJCF of ``cyclo export DRIVE --for mujoco``; it needs numpy and mujoco, no plugin:

>>> model = mujoco.MjModel.from_xml_path("robot-joint_nominal.xml")  # doctest: +SKIP
>>> drive = DriveCallback(model, "robot-joint_nominal.json")         # doctest: +SKIP
>>> mujoco.set_mjcb_passive(drive)                                   # doctest: +SKIP

Several drives share the one callback of MuJoCo: ``set_mjcb_passive(lambda model, data: [one(model, data) for one in drives])``.
Set the callback after all models are loaded: MuJoCo calls it for models it compiles, too.
The spring of the tendon and its play are switched off in the model that is given, and the friction of the input follows the load.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ltca.analysis.reduced_model.reduced_drive import ReducedDrive

LEAST_SPEED = 1e-3
"""Speed of the input, rad/s, below which its friction is that of the load that would drive it."""


class DriveCallback:
    """Passive forces of one drive in a model.

    Parameters
    ----------
    model : mujoco.MjModel
        With the joints and the tendon of the exported MJCF; the spring of its tendon is switched off.
    tables : str, Path or dict
        The exported JSON file, or its content.
    prefix : str, optional
        In front of the names in the MJCF, which is attached under it.
    """

    def __init__(self, model: Any, tables: str | Path | dict[str, Any], prefix: str = "") -> None:
        content = tables if isinstance(tables, dict) else json.loads(Path(tables).read_text(encoding="utf-8"))
        name = prefix + str(content["name"])
        self.law = ReducedDrive(content)
        self.input = int(model.joint(f"{name}_input").qposadr[0])
        self.output = int(model.joint(f"{name}_output").qposadr[0])
        self.input_dof = int(model.joint(f"{name}_input").dofadr[0])
        self.output_dof = int(model.joint(f"{name}_output").dofadr[0])
        model.tendon_stiffness[model.tendon(f"{name}_wind_up").id] = 0.0
        self.time = float("nan")

    def __call__(self, model: Any, data: Any) -> None:
        """Add the torques at the state of `data`; the state of the drive goes on when its time does.

        Parameters
        ----------
        model : mujoco.MjModel
            The model.
        data : mujoco.MjData
            Its state.
        """
        law, at, to = self.law, float(data.qpos[self.input]), float(data.qpos[self.output])
        if data.time < self.time:  # the simulation was begun anew
            law.reset()
        if data.time != self.time:
            torque, self.time = law.move(at, to), float(data.time)
        else:
            torque = law.torque_of(at, to)
        data.qfrc_passive[self.output_dof] -= torque
        data.qfrc_passive[self.input_dof] += torque / law.ratio
        speed = float(data.qvel[self.input_dof])
        sense = speed if abs(speed) > LEAST_SPEED else torque / law.ratio
        model.dof_frictionloss[self.input_dof] = law.friction_at(law.elastic, sense)
