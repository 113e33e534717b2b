r"""Loads of all contact pairs at a pose when the pairs feel each other through the bodies (`fe` and `hybrid`).

Every approach is the sum of the contact's own law and what the loads on the bodies add,

.. math:: \delta_i(q) = w_i(F_i) + \sum_j C_{ij} F_j ,

with the law of the near field w (`ltca.compliance.near_field`: half-spaces with the lengths and profiles of the parts
for `hybrid`, plane strain with a datum for `fe`) and the body part C of `ltca.compliance.coefficients`, in which pins
and race are as thick as the disc and rollers as long as they are. The unknowns at a pose are the near-field
approaches ε: F = f(ε) is zero where ε is negative, so that no contact has to be switched on or off, and Newton's
method solves

.. math:: R(\epsilon) = \epsilon + C f(\epsilon) - \delta(q) = 0 .

Of a roller the outer contact is the unknown. Its inner contact carries F_i = F_o (n_o·n) and yields with the race,
the roller and the inner contacts of the other rollers; the place of the roller on its ray follows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ltca.compliance.beyond_near_field import OwnParts
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.near_field import NearField, NearFieldLaws
from ltca.compliance.pressures import pressures_of_law
from ltca.compliance.response import ContactPressures, KindPressures, Response, Start, resultant
from ltca.compliance.rollers import RollerState
from ltca.contact.tracked_grid import ContactKind
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.pairs import ContactGeometry, FlankMotion, PairMotion
from ltca.laws.contact_law import ContactLaw, LoadLaw
from ltca.laws.series import SeriesLaw, SpringLaw, approach_at_load

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

ITERATIONS = 60
CHUNK = 128
"""Positions solved at once: the matrices of more would fall out of the cache."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledCompliance:
    """Compliance of contacts coupled through the bodies.

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    coefficients : InfluenceCoefficients
        Body parts, rollers as long as they are.
    near_field : NearFieldLaws
        Laws of the near fields.
    hole_law : LoadLaw
        Spring of the shaft pin, with the hole wall's near field in series if it counts.
    outer_radius, inner_radius : array, shape (n_BR,)
        Effective radii of the rollers' contacts, mm.
    hole_radius : array, shape (z_PS,)
        Effective radii of shaft pins and holes, mm.
    own : OwnParts
        What each contact's own body parts add to the diagonal of C.
    """

    geometry: ContactGeometry
    coefficients: InfluenceCoefficients
    near_field: NearFieldLaws
    hole_law: LoadLaw
    outer_radius: FloatArray
    inner_radius: FloatArray
    hole_radius: FloatArray
    own: OwnParts

    @classmethod
    def of_drive(
        cls,
        drive: Drive,
        coefficients: InfluenceCoefficients,
        near_field: NearField,
        *,
        hole_near_field: bool = True,
    ) -> CoupledCompliance:
        """Return the coupled model of a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        coefficients : InfluenceCoefficients
            Of this drive.
        near_field : {"plane-strain", "half-space"}
            Plane strain, or half-spaces of finite length with the profiles of rollers and pins.
        hole_near_field : bool
            Whether the hole wall yields like a Hertz contact with a rigid pin.

        Raises
        ------
        DriveError
            When the coefficients are those of other bodies, or plane strain cannot say what the drive has.
        """
        if coefficients.fingerprint != drive.shape_fingerprint():
            raise DriveError(
                [
                    f"influence coefficients of the shape {coefficients.fingerprint}: must be those of {drive.name}, shape "
                    f"{drive.shape_fingerprint()}"
                ]
            )
        geometry = ContactGeometry.of_drive(drive)
        place = geometry.placement
        laws = NearFieldLaws.of_drive(drive, near_field, rigid_shaft_pins=hole_near_field)
        body = coefficients.placed_in(drive).with_roller_length(drive.crank_bearing.roller_length)
        spring = SpringLaw(stiffness=drive.pin_shaft.stiffness)
        return cls(
            geometry=geometry,
            coefficients=body,
            near_field=laws,
            hole_law=SeriesLaw(spring=spring, contact=laws.hole) if hole_near_field else spring,
            outer_radius=place.outer_effective_radii,
            inner_radius=place.inner_effective_radii,
            hole_radius=place.hole_effective_radii,
            own=OwnParts.of_drive(drive, geometry, body, near_field, laws.datum),
        )

    @property
    def discs(self) -> tuple[CoupledCompliance, ...]:
        """The model itself: it is that of one disc."""
        return (self,)

    def respond(self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None) -> Response:
        """Return the contact forces at the poses of a batch of positions; see `ltca.compliance.half_space`.

        Raises
        ------
        ConvergenceError
            When the near-field approaches of a position do not settle.
        """
        flank = self.geometry.flank(crank_angle, pose, None if start is None else start.parameter)
        holes = self.geometry.holes(crank_angle, pose)
        parts = [
            self._solve(
                _Batch(self, crank_angle[rows], pose[rows], _take(flank, rows), _take(holes, rows)), start, rows
            )
            for rows in np.array_split(np.arange(crank_angle.size), max(1, -(-crank_angle.size // CHUNK)))
        ]
        joined: Response = _join(parts)
        return joined

    def _solve(self, batch: _Batch, start: Start | None, rows: NDArray[np.intp]) -> Response:
        guess = batch.geometric.copy()
        # Half of a rigid overlap is a fair share of the near field.
        guess = np.where(guess > 0.0, 0.5 * guess, guess)
        if start is not None:
            for row, warm in enumerate(start.warm_start[rows]):
                if warm is not None:
                    guess[row] = warm
        return batch.response(batch.solve(guess))

    def pressures(self, response: Response) -> ContactPressures:
        """Return pressures and half-widths from the near fields."""
        laws, near = self.near_field, np.stack(list(response.warm_start))
        pins, rollers = response.pin_load.shape[1], self.outer_radius.size
        inner, _ = approach_at_load(laws.inner, response.rollers.inner_load, self.inner_radius)
        hole, _ = approach_at_load(laws.hole, response.hole_load, self.hole_radius)

        def read(law: ContactLaw, kind: ContactKind, approach: FloatArray, radius: FloatArray) -> KindPressures:
            return pressures_of_law(law, kind if laws.has_ends else None, approach, radius)

        return ContactPressures(
            pins=read(laws.pin, laws.kinds.pins, near[:, :pins], response.flank.effective_radius),
            outer=read(laws.outer, laws.kinds.outer, near[:, pins : pins + rollers], self.outer_radius),
            inner=read(laws.inner, laws.kinds.inner, inner, self.inner_radius),
            holes=read(laws.hole, laws.kinds.holes, hole, self.hole_radius),
            rigid_shaft_pins=laws.rigid_shaft_pins,
        )


class _Batch:
    """The coupled problem of some positions at given poses."""

    def __init__(
        self,
        model: CoupledCompliance,
        crank_angle: FloatArray,
        pose: FloatArray,
        flank: FlankMotion,
        holes: PairMotion,
    ) -> None:
        self.model, self.flank, self.holes = model, flank, holes
        geometry, place, c = model.geometry, model.geometry.placement, model.coefficients
        self.pins, self.rollers = flank.approach.shape[1], place.roller_radii.size
        self.displacement = (pose[:, 0] + 1j * pose[:, 1])[:, None]
        self.rays = geometry.rollers(crank_angle)
        self.place_rollers(np.zeros((pose.shape[0], self.rollers)))
        turn = pose[:, 2, None]
        play = place.shaft_pin_centres - (place.race_centre(crank_angle)[:, None] + self.displacement)
        play = play - place.hole_centres * np.exp(1j * turn)
        self.body = c.disc_matrix(
            flank.parameter,
            np.angle(self.outward) - turn,
            np.angle(play) - turn,
            geometry.profile.flank(flank.parameter),
            float(place.bore_radius),
        )
        own = np.concatenate(
            [
                np.full(self.pins, model.own.pin),
                np.full(self.rollers, model.own.outer),
                np.full(play.shape[1], model.own.hole),
            ]
        )
        self.body += np.diag(own)
        self.race = c.race_matrix(np.angle(self.rays.direction), float(place.inner_race_radius))
        self.race += np.diag(np.full(self.rollers, model.own.inner))
        self.outer = slice(self.pins, self.pins + self.rollers)

    def place_rollers(self, inner_approach: FloatArray) -> None:
        """Put the rollers where their inner contacts are pressed together by an amount, mm."""
        arm = (self.rays.outermost - inner_approach) * self.rays.direction - self.displacement
        self.length = np.abs(arm)
        self.outward = arm / self.length
        self.cosine = (self.outward * self.rays.direction.conjugate()).real

    @property
    def geometric(self) -> FloatArray:
        """Overlap of the undeformed bodies at the present places of the rollers, shape (positions, contacts)."""
        return np.concatenate([self.flank.approach, self.length - self.rays.bore_play, self.holes.approach], axis=1)

    def loads(self, near: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return loads and stiffnesses of the near fields."""
        m = self.model
        parts = (
            m.near_field.pin.load_and_stiffness(near[:, : self.pins], self.flank.effective_radius),
            m.near_field.outer.load_and_stiffness(near[:, self.outer], m.outer_radius),
            m.hole_law.load_and_stiffness(near[:, self.outer.stop :], m.hole_radius),
        )
        load, stiffness = (np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True))
        return load, stiffness

    def evaluate(self, near: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residual R(ε) and the body matrix with the inner contacts of the rollers in it."""
        m = self.model
        self.load, self.stiffness = self.loads(near)
        outer_load = self.load[:, self.outer]
        cross = m.coefficients.roller[0, 1]
        for _ in range(2):  # the direction of the outer load hardly turns with the roller's place
            self.inner_load = outer_load * self.cosine
            self.inner_near, self.inner_compliance = approach_at_load(
                m.near_field.inner, self.inner_load, m.inner_radius
            )
            inner = self.inner_near + np.einsum("bij,bj->bi", self.race, self.inner_load) + cross * outer_load
            self.place_rollers(inner)
        self.inner_approach = inner
        c = self.cosine
        seen = self.race + np.einsum("bi,ij->bij", self.inner_compliance, np.eye(self.rollers))
        matrix = self.body.copy()
        matrix[:, self.outer, self.outer] += c[:, :, None] * seen * c[:, None, :]
        matrix[:, self.outer, self.outer] += 2.0 * cross * np.einsum("bi,ij->bij", c, np.eye(self.rollers))
        yielding = np.einsum("bij,bj->bi", self.body, self.load)
        yielding[:, self.outer] += cross * self.inner_load
        return near + yielding - self.geometric, matrix

    def solve(self, near: FloatArray) -> FloatArray:
        """Return the near-field approaches at which every contact's approach is accounted for."""
        residual, matrix = self.evaluate(near)
        size = np.max(np.abs(residual), axis=1)
        history: list[float] = []
        for _ in range(ITERATIONS):
            history.append(float(np.max(size, initial=0.0)))
            if history[-1] < 1e-13:
                return near
            jacobian = np.eye(near.shape[1]) + matrix * self.stiffness[:, None, :]
            step = np.linalg.solve(jacobian, residual[..., None])[..., 0]
            fraction = np.ones(near.shape[0])
            for _ in range(12):
                trial = near - fraction[:, None] * step
                residual, matrix = self.evaluate(trial)
                found = np.max(np.abs(residual), axis=1)
                worse = (found > size) & (found > 1e-12)
                if not worse.any():
                    break
                fraction = np.where(worse, 0.5 * fraction, fraction)
            near, size = trial, found
            if len(history) > 5 and history[-1] < 1e-11 and float(np.max(size)) >= 0.5 * history[-1]:
                return near  # round-off of radii of 100 mm
        raise ConvergenceError("near-field approaches do not settle; largest residual in mm", history)

    def response(self, near: FloatArray) -> Response:
        """Return forces and tangent at the solution."""
        _, matrix = self.evaluate(near)
        load, pins, outer = self.load, self.pins, self.outer
        # dF = k (1 + C k)⁻¹ dδ: symmetric, and zero in rows and columns of open contacts.
        root = np.sqrt(self.stiffness)
        inside = np.eye(near.shape[1]) + root[:, :, None] * matrix * root[:, None, :]
        coupled = root[:, :, None] * np.linalg.inv(inside) * root[:, None, :]
        gradient = np.zeros((*near.shape, 4))
        gradient[:, :pins] = self.flank.gradient
        gradient[:, outer, 0], gradient[:, outer, 1] = -self.outward.real, -self.outward.imag
        gradient[:, outer.stop :] = self.holes.gradient
        tangent = gradient.swapaxes(1, 2) @ coupled @ gradient
        tangent += np.einsum("bi,bijk->bjk", load[:, :pins], self.flank.curvature)
        tangent += np.einsum("bi,bijk->bjk", load[:, outer.stop :], self.holes.curvature)
        sideways = 1j * self.outward
        across = np.stack((sideways.real, sideways.imag), axis=-1)
        bend = load[:, outer] / self.length
        tangent[:, :2, :2] += np.einsum("bi,bij,bik->bjk", bend, across, across)
        # A pair's approach: the overlap less what the other pairs' loads take of it. Negative is open.
        diagonal = np.einsum("bii->bi", self.body)
        approach = near + diagonal * load
        inner_self = np.einsum("bii->bi", self.race)
        resting = np.abs(self.rays.outermost * self.rays.direction - self.displacement) - self.rays.bore_play
        free = load[:, outer] <= 0.0
        rollers = RollerState(
            share=np.full(free.shape, 0.5),
            inner_approach=np.where(free, 0.0, self.inner_near + inner_self * self.inner_load),
            outer_approach=np.where(free, np.minimum(resting, approach[:, outer]), approach[:, outer]),
            inner_load=self.inner_load,
            outer_load=load[:, outer],
            outer_direction=self.outward,
            tangent=np.zeros((*free.shape, 2, 2)),
        )
        flank = replace(self.flank, approach=approach[:, :pins])
        holes = replace(self.holes, approach=approach[:, outer.stop :])
        warm_start = np.empty(near.shape[0], dtype=object)
        warm_start[:] = list(near)
        return Response(
            force=resultant(flank, load[:, :pins], holes, load[:, outer.stop :], rollers),
            tangent=tangent,
            flank=flank,
            holes=holes,
            rollers=rollers,
            pin_load=load[:, :pins],
            hole_load=load[:, outer.stop :],
            warm_start=warm_start,
        )


Motion = TypeVar("Motion", FlankMotion, PairMotion)


def _take(motion: Motion, rows: NDArray[np.intp]) -> Motion:
    return replace(motion, **{item.name: getattr(motion, item.name)[rows] for item in fields(motion)})


def _join(parts: Sequence[Any]) -> Any:
    """Join arrays, or dataclasses of arrays, along the positions."""
    if len(parts) == 1:
        return parts[0]
    if isinstance(parts[0], np.ndarray):
        return np.concatenate(parts)
    return type(parts[0])(
        **{item.name: _join([getattr(part, item.name) for part in parts]) for item in fields(parts[0])}
    )
