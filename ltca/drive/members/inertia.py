"""Given inertias of what turns with the drive, and its damping: what vibrates beside the parts that the file describes."""

from __future__ import annotations

from typing import Annotated

from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT
from ltca.drive.units.quantities import quantity

MomentOfInertia = Annotated[float, quantity("kg·m²", gt=0.0)]
Mass = Annotated[float, quantity("kg", gt=0.0)]
LARGEST_DAMPING_RATIO = 1.0
"""Critical damping, from which nothing vibrates."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Inertia:
    """Masses and moments of inertia beside those that follow from shapes and densities; they concern vibrations alone.

    Attributes
    ----------
    input : float or None
        Of all that turns with the input in front of the drive (motor, coupling, sun), about its axis, kg·m². Left out, nothing
        disturbs the speed of the input.
    output : float or None
        Of all that turns with the output beside the parts of the drive (flanges, housing, arm), about the axis of the drive,
        kg·m²; none when left out.
    output_mass : float or None
        Mass of the same, which moves where the main bearing yields, kg; none when left out.
    crank : float or None
        Of one crankshaft about its own axis, kg·m², in place of that of its eccentrics and shaft.
    crank_mass : float or None
        Mass of one crankshaft, kg, in place of that of its eccentrics and shaft; it stands on the axis, by equal parts at the
        discs.
    """

    input: MomentOfInertia | None = None
    output: MomentOfInertia | None = None
    output_mass: Mass | None = None
    crank: MomentOfInertia | None = None
    crank_mass: Mass | None = None


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Damping:
    """Damping of vibrations, the same of all modes: one of the two.

    Attributes
    ----------
    ratio : float or None
        Damping by the critical one, ζ.
    loss_factor : float or None
        η of a material or structure, energy lost in a cycle by 2π times the largest stored one; at resonance it is 2ζ.
    """

    ratio: Annotated[float, quantity("dimensionless", gt=0.0, lt=LARGEST_DAMPING_RATIO)] | None = None
    loss_factor: Annotated[float, quantity("dimensionless", gt=0.0, lt=2.0 * LARGEST_DAMPING_RATIO)] | None = None

    @property
    def ratio_at_resonance(self) -> float:
        """ζ, of a loss factor half of it; 0 where neither is given."""
        return self.ratio if self.ratio is not None else 0.5 * (self.loss_factor or 0.0)
