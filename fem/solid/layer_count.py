"""How many layers half of a solid body may have, the same for its coefficients and for full contact."""

from __future__ import annotations

from fem.errors import MeshError

FEWEST_LAYERS = 2
"""One shows no end of its own, and the error of coefficients is estimated with one layer fewer."""
MOST_LAYERS = 40
"""Beyond what any machine has memory for, which is told before anything is meshed."""


def require_layers(layers: int) -> None:
    """Raise MeshError for a number of layers over half of a width that is out of bounds."""
    if not FEWEST_LAYERS <= layers <= MOST_LAYERS:
        raise MeshError(
            f"layers = {layers}: must be at least {FEWEST_LAYERS} and at most {MOST_LAYERS}, over half of the width"
        )
