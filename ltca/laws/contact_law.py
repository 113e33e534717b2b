"""What the mechanics needs of a load–approach law, whoever provides it: a table, a grid, a finite-element fit."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from numpy.typing import ArrayLike

from ltca.arrays import FloatArray


class LoadLaw(Protocol):
    """Load of contacts pressed together."""

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return load and its derivative by the approach, N and N/mm; zeros where the approach is not positive."""
        ...


class EnergyLaw(LoadLaw, Protocol):
    """A law that knows its energy."""

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ, N·mm."""
        ...


@runtime_checkable
class ContactLaw(EnergyLaw, Protocol):
    """A law that knows its pressure at mid-width as well."""

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the largest pressure at mid-width, MPa."""
        ...

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the contact half-width at mid-width, mm."""
        ...
