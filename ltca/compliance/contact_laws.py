"""Laws of all contacts of a disc, whatever bodies lie behind them."""

from __future__ import annotations

from typing import Any, NamedTuple

from ltca.arrays import FloatArray
from ltca.geometry.pair_motion import FlankMotion


class ContactLaws(NamedTuple):
    """Laws of the contacts of a disc: wheel pins, rollers in bores, shaft pins, rollers on races; and effective radii, mm,
    of those that have one of their own.
    """

    laws: tuple[Any, Any, Any, Any]
    outer_radius: FloatArray
    hole_radius: FloatArray
    inner_radius: FloatArray

    def placed(self, flank: FlankMotion) -> tuple[Any, Any, Any, Any]:
        """Return the laws with the wheel pins where they are on the flank: tabulated laws are the same everywhere."""
        return self.laws
