"""
Friction, efficiency, self-locking
==================================

Coefficients of friction are given for every kind of joint. The efficiency is computed in both directions; the drive is
self-locking if the efficiency with the load driving reaches zero.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca

drive = ltca.load_drive("paper").cases["CS-3"]
coefficients = np.array([0.0, 0.02, 0.06, 0.12])
forward, back = [], []
for mu in coefficients:
    rubbing = drive.with_fields({"friction.pin": mu, "friction.hole": mu})
    summary = ltca.analyse(rubbing, positions=3).summary
    forward.append(summary["mean_efficiency"])
    back.append(summary["mean_efficiency_back"])

figure, axes = plt.subplots(figsize=(6.4, 3.4))
axes.plot(coefficients, forward, marker="o", label="driven by the input")
axes.plot(coefficients, back, marker="o", label="driven by the output")
axes.set(xlabel="μ at flank and holes", ylabel="efficiency, mean")
axes.legend(frameon=False)
figure.tight_layout()

# %%
# Without friction the efficiency is 1.

print([f"{value:.3f}" for value in forward])

# sphinx_gallery_start_ignore
assert abs(forward[0] - 1.0) < 1e-9
assert all(np.diff(forward) < 0.0)
# For small losses the reverse efficiency is 2 - 1/forward efficiency, as for any drive with equal losses in both directions.
assert abs(back[1] - (2.0 - 1.0 / forward[1])) < 5e-3
# sphinx_gallery_end_ignore
