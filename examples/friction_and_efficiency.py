"""
Friction, efficiency, moving back
=================================

Each joint has its coefficient. Efficiency follows either way; where it reaches zero against the load the drive locks itself.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca
from ltca.reading.changes import with_fields

drive = ltca.load_drive("paper").cases["CS-3"]
coefficients = np.array([0.0, 0.02, 0.06, 0.12])
forward, back = [], []
for mu in coefficients:
    rubbing = with_fields(drive, {"friction.pin": mu, "friction.hole": mu})
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
# Without friction nothing is lost.

print([f"{value:.3f}" for value in forward])

# sphinx_gallery_start_ignore
assert abs(forward[0] - 1.0) < 1e-9
assert all(np.diff(forward) < 0.0)
# For small losses the efficiency back is 2 - 1/efficiency forward, as of any drive whose losses are the same either way.
assert abs(back[1] - (2.0 - 1.0 / forward[1])) < 5e-3
# sphinx_gallery_end_ignore
