"""Moves an arm on an exported robot joint in MuJoCo, up, down and back through the play of the drive, and draws it.

``cyclo export joint.toml --for mujoco`` writes the model. The motor follows a smooth motion of the arm that would be right with a
stiff drive; the picture shows the arm and how far it is off: transmission error, wind-up, hysteresis and play.
"""

from __future__ import annotations

import argparse
import importlib.util
import math
import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import mujoco
import numpy as np

SWING, PERIOD, TURNS = 1.2, 1.0, 1.5
"""Angle of the arm either way, rad, time of a swing there and back, s, and how many of them."""
ARM, LENGTH, LOAD = 6.0, 0.5, 8.0
"""Mass of the arm, kg, its length, m, and the mass at its end, kg."""
STIFF, DAMPED = 60.0, 0.5
"""Of the motor's control, N·m/rad and N·m·s/rad at the input."""
ARCMIN = 10800.0 / math.pi


def load_callback(folder: Path) -> Any:
    """Return the class that the export has written beside the model."""
    sys.path.insert(0, str(folder))
    spec = importlib.util.spec_from_file_location("mujoco_callback", folder / "mujoco_callback.py")
    if spec is None or spec.loader is None:
        raise SystemExit(f"{folder}: has no mujoco_callback.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.DriveCallback


def model_with_arm(path: Path) -> tuple[Any, str]:
    """Return the exported model with an arm on its flange, its axis level, and the name of the drive."""
    spec = mujoco.MjSpec.from_file(str(path))
    name = path.stem
    spec.body(f"{name}_housing").quat = [math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0]
    # A body of its own: the flange has its inertia given, and masses of shapes in it would not count.
    arm, kind = spec.body(f"{name}_flange").add_body(name="arm"), mujoco.mjtGeom
    ends, ball, wall = [0, 0, 0.08, LENGTH, 0, 0.08], [LENGTH, 0, 0.08], [0.08, 0.05, 0]
    arm.add_geom(type=kind.mjGEOM_CAPSULE, fromto=ends, size=[0.03, 0, 0], mass=ARM, rgba=[0.2, 0.4, 0.7, 1])
    arm.add_geom(type=kind.mjGEOM_SPHERE, pos=ball, size=[0.06, 0, 0], mass=LOAD, rgba=[0.8, 0.3, 0.2, 1])
    housing = spec.body(f"{name}_housing")
    housing.add_geom(type=kind.mjGEOM_CYLINDER, size=wall, mass=0, rgba=[0.6, 0.6, 0.6, 1])
    sky = {"type": mujoco.mjtTexture.mjTEXTURE_SKYBOX, "builtin": mujoco.mjtBuiltin.mjBUILTIN_FLAT}
    spec.add_texture(name="sky", **sky, width=64, height=64, rgb1=[1, 1, 1], rgb2=[1, 1, 1])
    spec.worldbody.add_light(pos=[0, -3, 2], dir=[0, 1, -0.6])
    spec.worldbody.add_camera(name="side", pos=[0.1, -1.9, 0.0], xyaxes=[1, 0, 0, 0, 0, 1])
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 360, 360
    return spec.compile(), name


def target_of(time: float) -> tuple[float, float]:
    """Angle and speed of the arm that the motor is asked for, rad and rad/s."""
    turned = 2.0 * math.pi * time / PERIOD
    return SWING * math.sin(turned), SWING * 2.0 * math.pi / PERIOD * math.cos(turned)


def main() -> None:
    """Move the arm and draw it."""
    parser = argparse.ArgumentParser(description=str(__doc__).partition("\n")[0])
    parser.add_argument("model", type=Path, help="the exported MJCF, its JSON and its callback beside it")
    parser.add_argument("--picture", type=Path, default=Path("moving_arm.png"))
    arguments = parser.parse_args()
    model, name = model_with_arm(arguments.model)
    data = mujoco.MjData(model)
    drive = load_callback(arguments.model.resolve().parent)(model, arguments.model.with_suffix(".json"))
    ratio = drive.law.ratio
    try:
        renderer = mujoco.Renderer(model, 360, 360)
    except Exception as problem:  # noqa: BLE001 - whatever the system's OpenGL raises: the motion is drawn without it
        print(f"no offscreen rendering ({type(problem).__name__}): the picture is a figure of the motion alone")
        renderer = None
    mujoco.set_mjcb_passive(drive)
    steps, pictures = round(TURNS * PERIOD / model.opt.timestep), []
    every, shots = max(steps // 600, 1), {round(steps * part) for part in (0.04, 0.165, 0.33, 0.5)}
    rows = []
    data.qvel[:] = ratio * target_of(0.0)[1], target_of(0.0)[1]
    try:
        for step in range(steps):
            angle, speed = target_of(data.time)
            error, slip = ratio * angle - data.qpos[0], ratio * speed - data.qvel[0]
            data.ctrl[0] = STIFF * error + DAMPED * slip
            mujoco.mj_step(model, data)
            held = drive.law.held
            if step % every == 0:
                rows.append((data.time, data.qpos[1], data.qpos[1] - data.qpos[0] / ratio, held))
            if step in shots and renderer is not None:
                renderer.update_scene(data, "side")
                pictures.append(renderer.render())
    finally:
        mujoco.set_mjcb_passive(None)
    time, angle, wound, torque = np.array(rows).T
    below = ["time", "time", "loop", "loop"]
    places = [[f"shot{place}" for place in range(4)], below] if pictures else [below]
    size = (10, 6 if pictures else 3.2)
    figure, axes = plt.subplot_mosaic(places, figsize=size, layout="constrained")
    for place, picture in enumerate(pictures):
        axes[f"shot{place}"].imshow(picture)
        axes[f"shot{place}"].axis("off")
    axes["time"].plot(time, np.degrees(angle), color="0.3")
    axes["time"].set(xlabel="time / s", ylabel="arm / °")
    axes["loop"].plot(torque, wound * ARCMIN, color="0.3", linewidth=0.8)
    axes["loop"].set(xlabel="torque on the output / N·m", ylabel="wind-up / ′")
    figure.savefig(arguments.picture, dpi=110)
    least, most = wound.min() * ARCMIN, wound.max() * ARCMIN
    print(f"{name}: torque {torque.min():.0f} … {torque.max():.0f} N·m, wind-up {least:.2f} … {most:.2f}′")
    print(f"picture: {arguments.picture}{', rendered offscreen' if pictures else ''}")


if __name__ == "__main__":
    main()
