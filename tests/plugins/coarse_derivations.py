"""Influence coefficients in seconds: the coarsest meshes that pass their checks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ltca.compliance import coefficient_files

_fine = coefficient_files.derivation


def coarse_derivation(name: str = coefficient_files.DERIVATION) -> Callable[..., Any]:
    """Return what derives coefficients, in the place of `ltca.compliance.coefficient_files.derivation`."""
    if name != coefficient_files.DERIVATION:
        return _fine(name)
    from fem.coefficients.dataset import derive_coefficients

    def derive(drive: Any, *, bodies: str = "plane", **words: Any) -> Any:
        if bodies == "solid":
            return derive_coefficients(drive, stations=0.25, size=2.0, bodies="solid", **words)
        return derive_coefficients(drive, stations=0.25, size=1.5, **words)

    return derive
