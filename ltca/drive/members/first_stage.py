"""The first stage: a sun between the cranks and a planet on each of them."""

from __future__ import annotations

from cmath import rect
from dataclasses import field
from math import atan2, cos, hypot, pi, sqrt, tan
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, Angle, Errors, NonNegativeLength, PositiveLength, SignedLength
from ltca.drive.units.quantities import COUNT, grows, quantity

Teeth = Annotated[int, Field(ge=5, le=1000), COUNT]


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class SunRunout:
    """Centre of the teeth of the sun against the axis of the input (the runout F_r of ISO 1328-2 is twice the amount).

    Attributes
    ----------
    amount : float
        Distance of the two, mm; a negative one points the other way.
    angle : float
        Direction from the axis to the centre of the teeth at crank angle zero, rad.
    """

    amount: SignedLength = 0.0
    angle: Angle = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class PlanetRunout:
    """Centres of the teeth of the planets against the axes of their cranks, by crank; an empty tuple means zero for all.

    Attributes
    ----------
    amount : tuple of float
        Distance of the two, mm; a negative one points the other way.
    angle : tuple of float
        Direction from the axis to the centre of the teeth at crank angle zero, in the frame of the crank, rad: planets with equal
        angles stand alike on their cranks.
    """

    amount: Errors = ()
    angle: tuple[Angle, ...] = ()

    def places(self, cranks: int) -> tuple[complex, ...]:
        """Return the centres of the teeth from the axes of the cranks at crank angle zero, mm."""
        amounts, angles = self.amount or (0.0,) * cranks, self.angle or (0.0,) * cranks
        return tuple(rect(1.0, angle) * amount for amount, angle in zip(amounts, angles, strict=True))


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class FirstStage:
    """Involute stage of a sun, which is the input, and of a planet on every one of several cranks.

    Attributes
    ----------
    sun_teeth : int
        Number of teeth z₁ of the sun.
    planet_teeth : int
        Number of teeth z₂ of each planet; z₂/z₁ is ``installation.first_stage_ratio``.
    module : float or None
        Normal module, mm; left out, the pitch circles of sun and planet are the reference circles of their teeth.
    pressure_angle : float
        Normal pressure angle at the reference circle, rad.
    helix_angle : float
        Helix angle at the reference circle, rad; positive where the planet is right-handed.
    backlash : float
        Circumferential backlash of sun and planet at their pitch circles, mm; at 20 °C: it opens where the carrier, with the
        distance of the axes, grows more than the teeth do with the crankshaft.
    mesh_stiffness : float or None
        Stiffness of one mesh along the line of action in the transverse plane (c_γ b of ISO 6336-1), N/mm; rigid when left out.
    plane : float or None
        Axial place of the middle of the planets on the axis of ``disc.planes``, mm; needed where their forces have an arm: with
        bearings of the cranks, or with a main bearing that carries them. Equal to ``crank.support.spline_plane`` of cranks that
        twist from there.
    sun_runout : SunRunout
        Eccentricity of the teeth of the sun.
    planet_runout : PlanetRunout
        Eccentricities of the teeth of the planets; the backlash must leave room for them and for that of the sun.
    """

    sun_teeth: Teeth
    planet_teeth: Teeth
    module: Annotated[PositiveLength | None, grows("eccentric")] = None
    pressure_angle: Annotated[float, quantity("rad", gt=0.0, lt=0.25 * pi)] = pi / 9.0
    helix_angle: Annotated[float, quantity("rad", gt=-0.25 * pi, lt=0.25 * pi)] = 0.0
    backlash: Annotated[NonNegativeLength, grows("eccentric")] = 0.0
    mesh_stiffness: Annotated[float, quantity("N/mm", gt=0.0)] | None = None
    plane: Annotated[SignedLength | None, grows("planes")] = None
    sun_runout: Annotated[SunRunout, grows("eccentric")] = field(default_factory=SunRunout)
    planet_runout: Annotated[PlanetRunout, grows("eccentric")] = field(default_factory=PlanetRunout)

    @property
    def ratio(self) -> float:
        """z₂/z₁: turns of the sun for one of a planet, both against the carrier, which turn in opposite senses."""
        return self.planet_teeth / self.sun_teeth

    @property
    def transverse_pressure_angle(self) -> float:
        """Pressure angle of the reference circle in the transverse plane, rad: tan α_t = tan α_n/cos β."""
        return atan2(tan(self.pressure_angle), cos(self.helix_angle))

    def reference_distance(self) -> float | None:
        """Return the distance of the axes at which pitch circles are reference circles, mm; None without a module."""
        teeth = self.sun_teeth + self.planet_teeth
        return None if self.module is None else 0.5 * self.module * teeth / cos(self.helix_angle)

    @property
    def runs_out(self) -> bool:
        """Whether teeth stand off their axes."""
        return bool(self.sun_runout.amount) or any(self.planet_runout.amount)

    def closed_by_runout(self, distance: float) -> float:
        """Return the most that eccentricities of sun and planets take of the circumferential backlash, mm, axes at a distance.

        Two eccentricities that point at each other close the mesh by their sum, and the backlash by 2 tan α_wt of it.
        """
        most = abs(self.sun_runout.amount) + max(map(abs, self.planet_runout.amount), default=0.0)
        return 2.0 * self.mesh(distance).separating * most

    def mesh(self, distance: float) -> Mesh:
        """Return the mesh of sun and planet at the distance of their axes, mm.

        ValueError where their teeth do not reach each other.
        """
        alpha, reference = self.transverse_pressure_angle, self.reference_distance() or distance
        cosine = cos(alpha) * reference / distance
        if cosine > 1.0:
            raise ValueError("base circles stand apart by more than the distance of the axes")
        return Mesh(
            pitch_radius=distance * self.planet_teeth / (self.sun_teeth + self.planet_teeth),
            separating=tan(alpha) if self.module is None else sqrt(1.0 - cosine * cosine) / cosine,
            axial=tan(self.helix_angle) * distance / reference,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh:
    """Mesh of sun and planet at the distance of their axes.

    Attributes
    ----------
    pitch_radius : float
        Radius r_w of the pitch circle of the planet, mm.
    separating : float
        Radial by tangential force: tan α_wt, which is tan α_n/cos β where pitch circles are reference circles.
    axial : float
        Axial by tangential force: tan β_w, which is tan β there; positive where the planet is right-handed.
    """

    pitch_radius: float
    separating: float
    axial: float

    @property
    def base_radius(self) -> float:
        """Radius of the base circle of the planet, r_w cos α_wt, mm."""
        return self.pitch_radius / hypot(1.0, self.separating)

    def backlash_angle(self, backlash: float) -> float:
        """Return the angle by which the planet is free to turn, rad, by a circumferential backlash at the pitch circle, mm."""
        return backlash / self.pitch_radius

    @property
    def working_angle(self) -> float:
        """Working pressure angle α_wt, rad."""
        return atan2(self.separating, 1.0)
