"""
Manufacturing scatter
=====================

Two hundred drives with random errors from the tolerances of the file. ``cyclo tolerance`` does the same for thousands, ranks
the deviations and stores the worst sample.
"""

import matplotlib.pyplot as plt
import numpy as np

import ltca
from ltca.studies.batch_analysis import BatchSettings, analyse_samples

file = ltca.load_drive("paper")
drive = file.cases["CS-6"]
random = np.random.default_rng(1)
radial = file.tolerances["pin_wheel.pin_errors.radial"]

samples = []
for _ in range(200):
    errors = radial.quantile(random.random(drive.pin_wheel.number_of_pins))
    samples.append(drive.with_fields({"pin_wheel.pin_errors.radial": tuple(errors.tolist())}))
settings = BatchSettings(
    crank_angle=2.0 * np.pi * np.arange(8) / 8, quantities=("max_pin_load", "max_pin_pressure_mid")
)
load = analyse_samples(samples, settings).values[:, 0]
nominal = analyse_samples([drive], settings).values[0, 0]

figure, axes = plt.subplots(figsize=(6.4, 3.4))
axes.hist(load, bins=20, color="#4c72b0")
axes.axvline(nominal, color="black", linewidth=1.0, label="as drawn")
axes.set(xlabel="largest load of a wheel pin [N]", ylabel="drives")
axes.legend(frameon=False)
figure.tight_layout()

# %%
# Radial errors of the wheel pins only:

print(f"nominal {nominal:.0f} N; mean {load.mean():.0f} N, 99 % below {np.quantile(load, 0.99):.0f} N")

# sphinx_gallery_start_ignore
# Normal distribution with C_pk 1 and mean 0: the standard deviation is a third of the tolerance.
drawn = np.array([sample.pin_wheel.pin_errors.radial for sample in samples])
assert abs(drawn.std() / (radial.tolerance / 3.0) - 1.0) < 0.05
assert nominal < load.mean() < 1.2 * nominal
# sphinx_gallery_end_ignore
