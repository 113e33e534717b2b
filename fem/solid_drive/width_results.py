"""From the pressures of a solution to loads, moments, pressures along the width and tilts of the disc."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.contact.coupling import PairIntegrals
from fem.contact.pressure_measures import peak_of, pressure_moments
from fem.drive.fields import fit_rigid_motion
from fem.drive.model import ContactPair
from fem.drive.pose import PoseSolution
from fem.solid_drive.solid_model import SolidModel
from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class WidthResult:
    """One candidate contact along its width, over both halves; zeros where it is open.

    Attributes
    ----------
    heights : array, shape (n,)
        Vertices of the pressure, mm from mid-width.
    pressure : array, shape (arc, n)
        At all vertices, the ends of the arc included, MPa.
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
    pressure: FloatArray
    line_load: FloatArray
    largest: FloatArray
    load: float
    moment: float

    @property
    def load_factor(self) -> float:
        """K_Hβ, largest line load by the mean one; NaN of an open contact."""
        length = float(self.heights[-1] - self.heights[0])
        return float(self.line_load.max()) * length / self.load if self.load > 0.0 else float("nan")


def width_results(model: SolidModel, state: PoseSolution) -> tuple[WidthResult, ...]:
    """Return what every candidate pair has along its width."""
    return tuple(
        _along_width(model, pair, integral, state.contact.pressure)
        for pair, integral in zip(model.pairs, state.integrals, strict=True)
    )


def _along_width(model: SolidModel, pair: ContactPair, integral: PairIntegrals, pressures: FloatArray) -> WidthResult:
    grid, own = model.grids[pair.kind], model.pressures_of(pair, pressures)
    heights = grid.heights
    if grid.even:
        heights, own = np.concatenate([-heights[:0:-1], heights]), np.concatenate([own[:, :0:-1], own], axis=1)
    arc = pair.zone.arc
    full = np.vstack([np.zeros(own.shape[1]), own, np.zeros(own.shape[1])])
    fx, fy, _ = model.force_of(pair, integral, pressures)
    force = complex(fx, fy)
    load = abs(force)
    couple = model.couple_of(pair, integral, pressures)
    return WidthResult(
        heights=heights,
        pressure=full,
        line_load=integral.measure @ own,
        largest=np.array([_largest(arc, column) for column in full.T]),
        load=load,
        moment=float((couple * np.conj(force)).real / load) if load > 0.0 else 0.0,
    )


def _largest(arc: FloatArray, pressure: FloatArray) -> float:
    total, _, square = pressure_moments(arc, pressure)
    return peak_of(arc, pressure, 2.0 * float(np.sqrt(square))) if total > 0.0 and square > 0.0 else 0.0


def disc_lean(model: SolidModel, state: PoseSolution) -> complex:
    """Return the lean of the disc as its volume mean, dx/dz + i dy/dz in the fixed frame, rad; 0 where nothing tilts."""
    if model.widths.even:
        return 0j
    first = 4 + len(model.rollers)
    about_x, about_y = state.contact.motion[first : first + 2]
    return complex(about_y, -about_x)


def roller_leans(model: SolidModel, state: PoseSolution) -> FloatArray:
    """Return the lean of every candidate roller along its ray, rad."""
    if model.widths.even:
        return np.zeros(len(model.rollers))
    return np.asarray(state.contact.motion[6 + len(model.rollers) :])


def bore_lean(model: SolidModel, state: PoseSolution) -> complex:
    """Return the lean of the disc fitted to the wall of its bore, dx/dz + i dy/dz in the fixed frame, rad."""
    if model.widths.even:
        return 0j
    turn = np.exp(1j * state.pose.disc_rotation)
    return disc_lean(model, state) + complex(_on_bore(model, state.contact.pressure, tilting=True)[0] * turn)


def bore_motion(model: SolidModel, state: PoseSolution) -> tuple[complex, float]:
    """Return displacement (fixed axes, mm) and rotation (rad) of the disc fitted to the wall of its bore, mean of the width."""
    shift, rotation = _on_bore(model, state.contact.pressure, tilting=False)
    pose = state.pose
    return pose.disc_displacement + shift * np.exp(1j * pose.disc_rotation), pose.disc_rotation + rotation


def _on_bore(model: SolidModel, pressure: FloatArray, *, tilting: bool) -> tuple[complex, float]:
    """Rigid motion of the section that fits what the wall of the bore moves by, as a mean along the width or by height.

    By height is (12/t³) ∫ u z dz, what a linear load measures.
    """
    parity = "antisymmetric" if tilting else "symmetric"
    own = next(each for each in model.disc.classes if each.body.layers.parity == parity)
    layers, body = own.body.layers, model.meshes.disc
    along = layers.moments(layers.unit_load)[layers.free_in_plane]
    u = own.displacement(pressure[: model.on_disc])
    chain = np.concatenate([body.boundary_nodes(bore.name) for bore in model.shapes.disc.bores])
    nodes, places = np.unique(chain), body.places
    moved = sum(factor * (u[own.body.unknowns_of(nodes, axis)] @ along) for axis, factor in ((0, 1.0), (1, 1j)))
    weight = np.zeros(len(places))
    length = np.abs(places[chain[:, 2]] - places[chain[:, 0]])
    for column, share in ((0, 1.0), (1, 4.0), (2, 1.0)):
        np.add.at(weight, chain[:, column], share * length / 6.0)
    return fit_rigid_motion(places[nodes], np.asarray(moved), weight[nodes])
