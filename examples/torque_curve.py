"""
Torque curve, lost motion, stiffness
====================================

With the crank held, the output is loaded in both directions. Backlash, lost motion and stiffness are read from the curve.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca
from ltca.analysis.torque_curve import torque_curve

drive = ltca.load_drive("paper").cases["CS-3"]
curve = torque_curve(drive, np.array([0.3]))
ARCMIN = 180.0 / np.pi * 60.0

figure, axes = plt.subplots(figsize=(6.4, 3.6))
axes.plot(curve.output_angle[0] * ARCMIN, curve.torque / 1000.0, marker=".")
axes.set(xlabel="deviation of the output [′]", ylabel="torque on the output [N·m]")
axes.grid(alpha=0.3)
figure.tight_layout()

# %%
# Lost motion is read at ±3 % of the rated torque, stiffness between half and full torque.

lost, play = curve.lost_motion[0] * ARCMIN, curve.backlash[0] * ARCMIN
stiffness = curve.stiffness[0].mean() / 1000.0 / ARCMIN
print(f"backlash {play:.2f}′, lost motion {lost:.2f}′, stiffness {stiffness:.1f} N·m/arcmin")

# sphinx_gallery_start_ignore
assert play < lost  # lost motion is the backlash plus the wind-up at a small torque
# The stiffness is the slope of the curve between half and full torque.
half, full = np.searchsorted(curve.torque, [0.5 * drive.load.torque, 0.9999 * drive.load.torque])
slope = (curve.torque[full] - curve.torque[half]) / (curve.output_angle[0, full] - curve.output_angle[0, half])
assert abs(slope / 1000.0 / ARCMIN / stiffness - 1.0) < 0.1
# sphinx_gallery_end_ignore
