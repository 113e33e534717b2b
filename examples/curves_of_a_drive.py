"""
Curves of a drive
=================

``ltca.curves`` answers what ``cyclo curves`` does: torque curve and lost motion, orders of the transmission error, life of the
crank bearing, safety of the flank pressure.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

found = ltca.curves(ltca.load_drive("paper"), turns=4, case="CS-3", speed="1500 rpm", lost_motion="3 %")
print(found)

# %%
# Every number of the table is an attribute; ``found.content`` has all of them as in ``curves.json``.

ARCMIN, ARCSEC = 10_800.0 / np.pi, 648_000.0 / np.pi
curve, spectrum = found.curve, found.spectrum

figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.4))
left.plot(curve.output_angle[0] * ARCMIN, curve.torque / 1e3)
left.set(xlabel="deviation of the output [′]", ylabel="torque on the output [N·m]")
strongest = np.argsort(-spectrum.amplitude)[:6]
right.bar([f"{spectrum.orders[one].value:.4g}" for one in strongest], spectrum.amplitude[strongest] * ARCSEC)
right.set(xlabel="order [per turn of the crank]", ylabel="amplitude [″]")
figure.tight_layout()

# %%
# Life at the speed of the crank:

life = found.lives.shortest
print(f"{life.life:.0f} million turns are {life.hours:.0f} h at 1500 turns a minute")

# sphinx_gallery_start_ignore
assert abs(life.hours / (life.life * 1e6 / (1500.0 * 60.0)) - 1.0) < 1e-9
assert spectrum.orders[strongest[0]].value == 13.0  # the flank of 13 teeth (docs/validation/paper.md)
assert np.all(curve.backlash < curve.lost_motion)
# sphinx_gallery_end_ignore
