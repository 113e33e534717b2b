"""
Conforming contact of a pin in a bore
=====================================

A pin in a bore of nearly equal radius touches over a wide arc. Hertz theory assumes a narrow contact; its error is significant
even at moderate loads.
"""

import matplotlib.pyplot as plt
import numpy as np

from ltca.contact.hertz import line_peak_pressure
from ltca.drive.materials import Material, contact_modulus
from ltca.laws.conforming import ConformingLaw

steel = Material()
pin, bore, length = 4.0, 4.004, 12.0
law = ConformingLaw.of_bodies(pin=steel, bore=steel, pin_radius=pin, bore_radius=bore, length=length, datum_radius=6.0)
load = np.geomspace(10.0, 20_000.0, 60)
arc = np.degrees(law.half_angle(load, bore - pin))
peak = law.largest_pressure(load, bore - pin)
hertz = line_peak_pressure(load / length, pin * bore / (bore - pin), contact_modulus(steel, steel))

figure, (left, right) = plt.subplots(1, 2, figsize=(8.2, 3.2))
left.semilogx(load, arc)
left.set(xlabel="load [N]", ylabel="half the arc of contact [°]")
right.loglog(load, peak, label="conforming")
right.loglog(load, hertz, "--", label="Hertz")
right.set(xlabel="load [N]", ylabel="largest pressure [MPa]")
right.legend(frameon=False)
figure.tight_layout()

# %%
# Peak pressure at 1150 N over a length of 12 mm:

at = float(law.largest_pressure(1150.0, bore - pin))
off = float(line_peak_pressure(1150.0 / length, pin * bore / (bore - pin), contact_modulus(steel, steel))) / at - 1.0
print(f"{at:.2f} MPa, error of Hertz theory {100.0 * off:+.1f} %")

# sphinx_gallery_start_ignore
assert abs(at / 32.37 - 1.0) < 1e-3  # finite elements, docs/theory/seats.md
assert abs(off + 0.093) < 1e-3
# sphinx_gallery_end_ignore
