"""
Fixed housing, two discs
========================

The drive of a robot joint: the housing with the wheel pins is fixed, the pin shaft is the output, and two discs at 180° share the
torque.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

drive = ltca.load_drive("robot-joint").cases["nominal"]
result = ltca.analyse(drive, crank_angle=[0.5])
data = result.dataset.isel(case=0, position=0)

figure, axes = plt.subplots(figsize=(5.4, 5.4), subplot_kw={"projection": "polar"})
places = np.arctan2(data["pin_y"], data["pin_x"])
for disc, colour in ((0, "#4c72b0"), (1, "#dd8452")):
    axes.bar(places, data["pin_load"].isel(disc=disc), width=0.12, color=colour, alpha=0.75, label=f"disc {disc}")
axes.set_title("load of the wheel pins [N]", fontsize=10)
axes.legend(loc="lower left", bbox_to_anchor=(-0.08, -0.08), frameon=False)
figure.tight_layout()

# %%
# Two identical discs without errors carry equal shares. The moment on the housing is the sum of output and input torque.

share = result.loaded.torque_share[0]
moment = float(data["wheel_moment"]) / 1000.0
print(f"torque shares {share[0]:.3f}, {share[1]:.3f}; moment on the housing {-moment:.2f} N·m")

# sphinx_gallery_start_ignore
assert abs(share[0] - 0.5) < 1e-6  # at 180° with 40 pins, by symmetry
teeth, pins = drive.disc.number_of_teeth, drive.pin_wheel.number_of_pins
assert abs(-moment - 400.0 * pins / teeth) < 0.1  # without friction, in the mean
# sphinx_gallery_end_ignore
