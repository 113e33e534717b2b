"""From the pressures of a solution to loads, moments, pressures along the width and tilts of the disc."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.contact.coupling import PairIntegrals
from fem.contact.pressure_measures import peak_of, pressure_moments, vertex_means
from fem.drive.full_solution import FullSolution
from fem.drive.model import ContactPair
from fem.drive.pose import PoseSolution
from fem.solid_drive.solid_model import SolidModel
from ltca.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class WidthResult:
    """One candidate contact along its width, over both halves; zeros where it is open.

    Attributes
    ----------
    heights : array, shape (n,)
        Vertices of the pressure, mm from mid-width.
    line_load : array, shape (n,)
        ∫ p ds at the heights, N/mm.
    largest : array, shape (n,)
        Largest pressure over the arc at each height (`fem.contact.pressure_measures.peak_of`), MPa.
    load : float
        N.
    moment : float
        ∫ z dF along the force, N·mm: positive where the upper half carries more.
    """

    heights: FloatArray
    line_load: FloatArray
    largest: FloatArray
    load: float
    moment: float

    @property
    def load_factor(self) -> float:
        """K_Hβ, largest line load by the mean one; NaN of an open contact."""
        length = float(self.heights[-1] - self.heights[0])
        return float(self.line_load.max()) * length / self.load if self.load > 0.0 else float("nan")


def solid_model(disc: FullSolution) -> SolidModel:
    """Return the model of solid bodies of a solution."""
    assert isinstance(disc.model, SolidModel), "results along the width are those of solid bodies"
    return disc.model


def width_results(disc: FullSolution) -> tuple[WidthResult, ...]:
    """Return what every candidate pair of solid bodies has along its width."""
    return along_width(solid_model(disc), disc.state)


def along_width(model: SolidModel, state: PoseSolution) -> tuple[WidthResult, ...]:
    """Return what every candidate pair has along its width."""
    return tuple(
        _along_width(model, pair, integral, state.contact.pressure)
        for pair, integral in zip(model.pairs, state.integrals, strict=True)
    )


def pressures_over(disc: FullSolution, pair: ContactPair) -> tuple[FloatArray, FloatArray]:
    """Return the heights of a pair, mm, 0 in the plane, and its pressures over arc and height, ends included, (arc, heights)."""
    pressure = disc.state.contact.pressure
    if isinstance(disc.model, SolidModel):
        return _over_both_halves(disc.model, pair, pressure)
    arc = pair.zone.arc
    return np.zeros(1), vertex_means(arc, pair.zone.at_vertices(pressure[pair.unknowns]))[:, None]


def _over_both_halves(model: SolidModel, pair: ContactPair, pressures: FloatArray) -> tuple[FloatArray, FloatArray]:
    grid, own = model.grids[pair.kind], model.pressures_of(pair, pressures)
    heights = grid.heights
    if grid.even:
        heights, own = np.concatenate([-heights[:0:-1], heights]), np.concatenate([own[:, :0:-1], own], axis=1)
    return heights, np.vstack([np.zeros(own.shape[1]), own, np.zeros(own.shape[1])])


def _along_width(model: SolidModel, pair: ContactPair, integral: PairIntegrals, pressures: FloatArray) -> WidthResult:
    heights, full = _over_both_halves(model, pair, pressures)
    fx, fy, _ = model.force_of(pair, integral, pressures)
    force = complex(fx, fy)
    load = abs(force)
    couple = model.couple_of(pair, integral, pressures)
    return WidthResult(
        heights=heights,
        line_load=integral.measure @ full[1:-1],
        largest=np.array([_largest(pair.zone.arc, column) for column in full.T]),
        load=load,
        moment=float((couple * np.conj(force)).real / load) if load > 0.0 else 0.0,
    )


def _largest(arc: FloatArray, pressure: FloatArray) -> float:
    total, _, square = pressure_moments(arc, pressure)
    return peak_of(arc, pressure, 2.0 * float(np.sqrt(square))) if total > 0.0 and square > 0.0 else 0.0


def bearing_couples(disc: FullSolution) -> ComplexArray:
    """Return ∫ z dF of the rollers of each crank on the disc, N·mm: its moment about x and y is −imaginary and real part."""
    model, pressure = solid_model(disc), disc.state.contact.pressure
    found = np.zeros(model.placement.cranks, dtype=complex)
    for pair, integral in zip(model.pairs, disc.state.integrals, strict=True):
        if pair.kind == "roller_outer":
            found[model.crank_of(pair.index)] -= model.couple_of(pair, integral, pressure)
    return found


def disc_lean(disc: FullSolution) -> complex:
    """Return the lean of the disc as its volume mean, dx/dz + i dy/dz in the fixed frame, rad; 0 where nothing tilts."""
    model = solid_model(disc)
    if model.widths.even:
        return 0j
    first = 4 + len(model.rollers)
    about_x, about_y = disc.state.contact.motion[first : first + 2]
    return complex(about_y, -about_x)


def roller_leans(disc: FullSolution) -> FloatArray:
    """Return the lean of every roller in the plane of its ray and the axis, rad; 0 of those that are no candidates."""
    model = solid_model(disc)
    found = np.zeros(model.placement.roller_radii.size)
    if not model.widths.even:
        found[list(model.rollers)] = disc.state.contact.motion[6 + len(model.rollers) :]
    return found


def bore_lean(disc: FullSolution) -> complex:
    """Return the lean of the disc fitted to the wall of its bores, dx/dz + i dy/dz in the fixed frame, rad."""
    model, state = solid_model(disc), disc.state
    if model.widths.even:
        return 0j
    x, y, _ = model.disc.probed[-3:] @ state.contact.pressure[: model.on_disc]
    return disc_lean(disc) + complex(x, y) * complex(np.exp(1j * state.pose.disc_rotation))
