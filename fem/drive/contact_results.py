"""From contact unknowns to the numbers of each part: loads, peak pressures, half-widths, forces on the disc."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.body.surface import PressureZone
from fem.contact.pressure_measures import peak_of, pressure_moments
from fem.drive.contact_kinds import CONTACT_KINDS, PairKind
from fem.drive.model import ContactPair, PlacedContacts
from fem.drive.pose import PoseSolution, moment_about, pair_forces
from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class PairResult:
    """One candidate contact.

    Attributes
    ----------
    load : float
        N.
    share : float
        Load relative to the largest of its kind.
    peak_pressure : float
        MPa.
    half_width : float
        2√⟨x²⟩ of the pressure, mm.
    middle : float
        Centre of pressure along the zone, mm from its first vertex.
    largest_edge : float
        Longest element edge under pressure, mm.
    """

    load: float
    share: float
    peak_pressure: float
    half_width: float
    middle: float
    largest_edge: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactResults:
    """Contacts of a drive; arrays over all parts of a kind, zeros where open.

    Attributes
    ----------
    pin_load, roller_load, roller_load_inner, pin_shaft_load : array
        N.
    pin_pressure_mid, roller_pressure_mid_outer, roller_pressure_mid_inner, pin_shaft_pressure_mid : array
        MPa.
    pin_half_width, roller_half_width_outer, roller_half_width_inner, pin_shaft_half_width : array
        mm.
    pin_force, roller_force, shaft_pin_force : array of complex
        Forces on the disc at each contact, fixed axes, N.
    bearing_force : array of complex, shape (cranks,)
        Sum of the forces of each crank's rollers on the disc, fixed axes, N.
    equilibrium_residual : float
        Largest force left over on disc, wheel (moment divided by pin-circle radius) and rollers, N.
    details : tuple of PairResult
        One for each candidate pair.
    """

    pin_load: FloatArray
    roller_load: FloatArray
    roller_load_inner: FloatArray
    pin_shaft_load: FloatArray
    pin_pressure_mid: FloatArray
    roller_pressure_mid_outer: FloatArray
    roller_pressure_mid_inner: FloatArray
    pin_shaft_pressure_mid: FloatArray
    pin_half_width: FloatArray
    roller_half_width_outer: FloatArray
    roller_half_width_inner: FloatArray
    pin_shaft_half_width: FloatArray
    pin_force: NDArray[np.complex128]
    roller_force: NDArray[np.complex128]
    shaft_pin_force: NDArray[np.complex128]
    bearing_force: NDArray[np.complex128]
    equilibrium_residual: float
    details: tuple[PairResult, ...]

    @property
    def loaded(self) -> list[tuple[PairKind, int, float, float, float]]:
        """Kind, number, load, largest pressure and half-width of every contact that carries, by kinds."""
        arrays: dict[PairKind, list[FloatArray]] = {
            kind: [getattr(self, name) for name in (names.load, names.pressure, names.half_width)]
            for kind, names in CONTACT_KINDS.items()
        }
        return [
            (kind, index, float(load[index]), float(pressure[index]), float(half_width[index]))
            for kind, (load, pressure, half_width) in arrays.items()
            for index in np.flatnonzero(load > 0.0).tolist()
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class DeformedContacts:
    """How open a solution leaves the contacts of the disc, and where they press; arrays over all parts of a kind.

    Attributes
    ----------
    pin_gaps, roller_gaps, hole_gaps : array of float
        Smallest gap left between the deformed bodies, mm, NaN where a part has no contact zone; a roller's is the sum of
        its two.
    flank_points, bore_points, hole_points : array of complex
        Where the pressure has its centre on flank, bores and hole walls, frame of the undeformed disc, mm; NaN where there
        is none.
    """

    pin_gaps: FloatArray
    roller_gaps: FloatArray
    hole_gaps: FloatArray
    flank_points: NDArray[np.complex128]
    bore_points: NDArray[np.complex128]
    hole_points: NDArray[np.complex128]


def deformed_contacts(model: PlacedContacts, solution: PoseSolution) -> DeformedContacts:
    """Return how open a solution leaves the contacts of the disc, and where they press."""
    place = model.placement
    counts = {"pin": len(place.wheel_pin_radii), "roller": len(place.roller_radii), "hole": len(place.hole_radii)}
    gaps = {kind: np.full(count, np.nan) for kind, count in counts.items()}
    points = {kind: np.full(count, complex(np.nan, np.nan)) for kind, count in counts.items()}
    for pair, integral in zip(model.pairs, solution.integrals, strict=True):
        kind, index = pair.kind.partition("_")[0], pair.index
        left = float(np.min(solution.contact.opening[pair.unknowns] / model.measure_of(pair, integral)))
        gaps[kind][index] = left if np.isnan(gaps[kind][index]) else gaps[kind][index] + left
        if pair.kind != "roller_inner":
            points[kind][index] = _centre_of_pressure(pair.zone, model.profile_of(pair, solution.contact.pressure))
    return DeformedContacts(
        pin_gaps=gaps["pin"],
        roller_gaps=gaps["roller"],
        hole_gaps=gaps["hole"],
        flank_points=points["pin"],
        bore_points=points["roller"],
        hole_points=points["hole"],
    )


def _centre_of_pressure(zone: PressureZone, pressure: FloatArray) -> complex:
    """Return the centre of pressure on the exact boundary, mm, NaN without pressure."""
    arc = zone.arc
    total, centre, _ = pressure_moments(arc, zone.at_vertices(pressure))
    if total <= 0.0:
        return complex(np.nan, np.nan)
    vertices = np.append(zone.places[:, 0], zone.places[-1, -1])
    points, _ = zone.exact(np.atleast_1d(np.interp(centre, arc, vertices)))
    return complex(points[0])


def summarise_contacts(model: PlacedContacts, solution: PoseSolution) -> ContactResults:
    """Return the results of all contacts of a pose solution."""
    forces = pair_forces(model, list(solution.integrals), solution.contact.pressure)
    loads = np.hypot(forces[:, 0], forces[:, 1])
    place = model.placement
    counts: dict[PairKind, int] = {
        "pin": len(place.wheel_pin_radii),
        "roller_outer": len(place.roller_radii),
        "roller_inner": len(place.roller_radii),
        "hole": len(place.hole_radii),
    }
    load = {kind: np.zeros(count) for kind, count in counts.items()}
    peak = {kind: np.zeros(count) for kind, count in counts.items()}
    width = {kind: np.zeros(count) for kind, count in counts.items()}
    force = {kind: np.zeros(count, dtype=complex) for kind, count in counts.items()}
    for pair, value, acting in zip(model.pairs, loads.tolist(), forces, strict=True):
        load[pair.kind][pair.index] = value
        force[pair.kind][pair.index] = -complex(acting[0], acting[1])
    details = []
    for pair, value in zip(model.pairs, loads.tolist(), strict=True):
        detail = _detail(pair, model.profile_of(pair, solution.contact.pressure), value, float(load[pair.kind].max()))
        peak[pair.kind][pair.index], width[pair.kind][pair.index] = detail.peak_pressure, detail.half_width
        details.append(detail)
    return ContactResults(
        pin_load=load["pin"],
        roller_load=load["roller_outer"],
        roller_load_inner=load["roller_inner"],
        pin_shaft_load=load["hole"],
        pin_pressure_mid=peak["pin"],
        roller_pressure_mid_outer=peak["roller_outer"],
        roller_pressure_mid_inner=peak["roller_inner"],
        pin_shaft_pressure_mid=peak["hole"],
        pin_half_width=width["pin"],
        roller_half_width_outer=width["roller_outer"],
        roller_half_width_inner=width["roller_inner"],
        pin_shaft_half_width=width["hole"],
        pin_force=force["pin"],
        roller_force=force["roller_outer"],
        shaft_pin_force=force["hole"],
        bearing_force=force["roller_outer"].reshape(place.cranks, -1).sum(axis=1),
        equilibrium_residual=_residual(model, solution, forces),
        details=tuple(details),
    )


def _detail(pair: ContactPair, pressure: FloatArray, load: float, largest: float) -> PairResult:
    arc = pair.zone.arc
    full = pair.zone.at_vertices(pressure)
    total, centre, square = pressure_moments(arc, full)
    if total <= 0.0:
        return PairResult(load=0.0, share=0.0, peak_pressure=0.0, half_width=0.0, middle=0.0, largest_edge=0.0)
    half_width = 2.0 * float(np.sqrt(square))
    under = (full[:-1] > 0.0) | (full[1:] > 0.0)
    return PairResult(
        load=load,
        share=load / largest,
        peak_pressure=peak_of(arc, full, half_width),
        half_width=half_width,
        middle=centre,
        largest_edge=float(np.diff(arc)[under].max()),
    )


def _residual(model: PlacedContacts, solution: PoseSolution, forces: FloatArray) -> float:
    """Return the largest unbalanced force, N, from the forces alone: nothing of the solver enters."""
    disc = np.zeros(3)
    wheel, axis = solution.wheel_moment, complex(model.placement.wheel_axis)
    along: dict[int, float] = {}
    for pair, acting in zip(model.pairs, forces, strict=True):
        if pair.kind != "roller_inner":
            disc -= acting
        if pair.kind == "pin":
            wheel += moment_about(axis, acting)
        if pair.kind in ("roller_outer", "roller_inner"):
            ray = model.roller_rays[pair.index]
            along[pair.index] = along.get(pair.index, 0.0) + acting[0] * ray.real + acting[1] * ray.imag
    moment = moment_about(model.disc_pose(solution.pose).centre, disc)
    lever = float(np.abs(model.placement.wheel_pin_centres).max())
    left = [abs(disc[0]), abs(disc[1]), abs(moment) / lever, abs(wheel) / lever, *map(abs, along.values())]
    return float(max(left))
