"""Options of a full solution as one value, made by the command or caller and passed down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.body.elasticity import PlaneState
from fem.errors import MeshError
from fem.mesh.element_size import DEFAULT_GROWTH


@dataclass(frozen=True, slots=True, kw_only=True)
class SolutionOptions:
    """Options of a full finite-element solution.

    Attributes
    ----------
    size : float
        Element edge as a multiple of the default, an eighth of each contact half-width.
    plane : {"strain", "stress"}
        Plane strain or plane stress.
    fine_walls : bool
        Whether the walls of the discs are meshed finely enough for the stress along them, whatever the size.
    growth : float
        Growth of the element edge by distance from a contact.
    halvings : int
        Uniform refinements of the meshes of that size: every edge is divided into two each time.
    layers : int
        Of solid bodies, over half of their width; 0 of plane ones.

    Raises
    ------
    MeshError
        When the size is no positive number.

    Examples
    --------
    >>> SolutionOptions(size=2.0).plane
    'strain'
    """

    size: float = 1.0
    plane: PlaneState = "strain"
    fine_walls: bool = False
    growth: float = DEFAULT_GROWTH
    halvings: int = 0
    layers: int = 0

    @property
    def refined_size(self) -> float:
        """Element edge after all halvings, as a multiple of the default."""
        return self.size / 2.0**self.halvings

    def __post_init__(self) -> None:
        if not (np.isfinite(self.size) and self.size > 0.0):
            raise MeshError(f"element size {self.size:g}: must be greater than 0 (a multiple of the default edge)")


DEFAULT_OPTIONS = SolutionOptions()
