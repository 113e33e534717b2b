"""
Torques side by side
====================

One drive at three torques, in one dataset. Quantities with a unit may be texts; cases are chosen by name, positions by crank
angle.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

drive = ltca.load_drive("robot-joint").cases["nominal"]
torques = ("40 N·m", "200 N·m", "400 N·m")
data = ltca.concat({torque: ltca.analyse(drive, positions=80, torque=torque) for torque in torques})
print(data["torque"].values)

# %%
# Loads of the wheel pins at one crank angle. At light torque clearances leave fewer pins in contact.

at = data["pin_load"].sel(crank_angle=np.radians(30.0), method="nearest").isel(disc=0)

figure, axes = plt.subplots(figsize=(7.0, 3.4))
for torque in torques:
    axes.plot(at["pin"], at.sel(case=torque), marker=".", label=torque)
axes.set(xlabel="wheel pin", ylabel=f"load at {np.degrees(float(at['crank_angle'])):.1f}° [N]")
axes.legend(frameon=False)
figure.tight_layout()

# %%
# The work of the contacts is that of the torque: in the mean the bearings carry ten times as much at ten times the torque.

mean = data["bearing_tangential"].sum(["disc", "crank"]).mean("position")
ratio = float(mean.sel(case="400 N·m") / mean.sel(case="40 N·m"))
print(f"mean tangential bearing load: {ratio:.3f} times as large")

# sphinx_gallery_start_ignore
assert abs(ratio - 10.0) < 0.02  # 80 positions, two per tooth pitch
assert (at.sel(case="40 N·m") > 0).sum() <= (at.sel(case="400 N·m") > 0).sum()
# sphinx_gallery_end_ignore
