"""Names of contacts in slices, loaded when a drive has them: the plane model should not wait for some ten modules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ltca.laws.separate_slices import SeparateSlices
    from ltca.laws.sliced_contact import EXACT, ROUGH, Exactness, SlicedContact, slice_heights, slice_means
    from ltca.laws.sliced_line import SlicedLine
    from ltca.laws.sliced_seat import SlicedSeat, back_line
    from ltca.laws.width_pressure import estimate_along_width

_HOMES = {
    "ltca.laws.separate_slices": ("SeparateSlices",),
    "ltca.laws.sliced_contact": ("EXACT", "ROUGH", "Exactness", "SlicedContact", "slice_heights", "slice_means"),
    "ltca.laws.sliced_line": ("SlicedLine",),
    "ltca.laws.sliced_seat": ("SlicedSeat", "back_line"),
    "ltca.laws.width_pressure": ("estimate_along_width",),
}

__all__ = [
    "EXACT", "ROUGH", "Exactness", "SeparateSlices", "SlicedContact", "SlicedLine", "SlicedSeat", "back_line",
    "estimate_along_width", "slice_heights", "slice_means",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Load a name and keep it."""
    from importlib import import_module

    for module, names in _HOMES.items():
        if name in names:
            value = globals()[name] = getattr(import_module(module), name)
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
