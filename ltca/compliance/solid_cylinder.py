"""What solid cylinders of finite length yield at a contact beyond plane strain.
"""

from __future__ import annotations

POISSON_RATIOS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.48)
RADIUS_BY_LENGTH = (1.0 / 32.0, 1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 1.0, 2.0)
