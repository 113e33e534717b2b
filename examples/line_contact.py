"""
Load-approach law of a line contact
===================================

Load over approach of two cylinders of finite length. In plane strain the approach is undetermined; it follows from the finite
length.
"""

import matplotlib.pyplot as plt
import numpy as np

from ltca.contact.hertz import line_half_width
from ltca.laws.line_contact import LineContactLaw
from validation.hertz import strip_approach

MODULUS, RADIUS = 113_000.0, 4.0  # E* of steel on steel, MPa; effective radius, mm
approach = np.linspace(0.0, 0.012, 60)

figure, axes = plt.subplots(figsize=(6.4, 3.6))
for length in (4.0, 8.0, 16.0):
    load, _ = LineContactLaw(length, MODULUS).load_and_stiffness(approach, RADIUS)
    axes.plot(approach * 1e3, load / length, label=f"{length:g} mm long")
axes.set(xlabel="approach [µm]", ylabel="load by length [N/mm]")
axes.legend(frameon=False)
figure.tight_layout()

# %%
# Under a uniform line load the approach varies along the length (Lundberg). Its mean is an upper bound: in a real
# contact the approach is constant and load is transferred to the ends.

law = LineContactLaw(16.0, MODULUS)
load, _ = law.load_and_stiffness(0.008, RADIUS)
width = line_half_width(load / 16.0, RADIUS, MODULUS)
middle, mean = strip_approach(load / 16.0, width, 16.0, MODULUS)
print(f"8 µm; Lundberg {1e3 * float(middle):.2f} µm in the middle, mean {1e3 * float(mean):.2f} µm")

# sphinx_gallery_start_ignore
assert 0.97 * float(mean) < 0.008 < float(mean) < float(middle)
energy = float(law.energy(0.008, RADIUS))
steps = np.linspace(0.0, 0.008, 4001)
curve, _ = law.load_and_stiffness(steps, RADIUS)
assert abs(np.trapezoid(curve, steps) / energy - 1.0) < 1e-5  # the load is the derivative of the energy
# sphinx_gallery_end_ignore
