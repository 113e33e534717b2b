"""
Housing held, two discs
=======================

A robot joint's drive: the housing with its pins stands still, the pin shaft is the output, two discs half a turn apart share the
torque.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca
from ltca.reading.drive_file import parse_drive, shipped_drive

drive = parse_drive(shipped_drive("robot-joint")).cases["nominal"]
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
# Two equal discs without errors carry one half each. The housing bears the torques of output and input.

share = result.loaded.torque_share[0]
moment = float(data["wheel_moment"]) / 1000.0
print(f"parts of the torque {share[0]:.3f}, {share[1]:.3f}; the housing is held by {-moment:.2f} N·m")

# sphinx_gallery_start_ignore
assert abs(share[0] - 0.5) < 1e-6  # half a turn apart, 40 pins: each is the other's image
teeth, pins = drive.disc.number_of_teeth, drive.pin_wheel.number_of_pins
assert abs(-moment - 400.0 * pins / teeth) < 0.1  # without friction, in the mean
# sphinx_gallery_end_ignore
