r"""Derivatives of loads, poses, angles and pressures of a balanced drive with respect to its fields.

At a balanced position the residual :math:`R(z, p)` vanishes. The unknowns z are the pose q and, where the wheel is held, the
moment that holds it; R has the forces on all members and the moment about the axis. A field p of the drive moves the balance by

.. math:: \frac{dz}{dp} = -\left(\frac{\partial R}{\partial z}\right)^{-1} \frac{\partial R}{\partial p} ,

and a result :math:`f(z, p)` by :math:`\partial f/\partial p + \partial f/\partial z \cdot dz/dp`.

The tangent used by Newton's method neglects that radii of curvature and influence coefficients change along the flank (relative
error 1e-5). It therefore serves as a preconditioner only: the directional derivative of the residual along the current dz/dp is
reduced to zero by iteration, so the result is that of the full Jacobian. Directional derivatives are fourth-order differences
beside the balanced position, with steps of a thousandth of the approaches. Their error is some 1e-8 of the change at a held
pose: 1e-7 of most derivatives, 1e-6 where the balance takes back all but a hundredth of that change. Positions at which a step
opens or closes a contact, or changes its load by more than a tenth, are differentiated again with steps of a tenth and of a
hundredth, at which round-off makes up to 1e-7 and 1e-6 more. Where the iteration does not settle, since contacts open or close on
its way, the drives beside are balanced themselves: 1e-6, and 1e-5 under loads of some N. Where a contact is about to open all the
same, the derivative is one-sided, and the differences return a value in between.

Lost motion is the difference of two output angles, under a part of the torque one way and the other, and follows a field as the
two balanced positions do (`LostMotion`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from ltca.analysis.engines import Engine, HalfSpace
from ltca.analysis.loaded_analysis import LoadedAnalysis, analysis_of
from ltca.analysis.results import case_arrays
from ltca.analysis.summary import scalar_key, scalars_of_positions
from ltca.analysis.torque_curve import LOST_MOTION
from ltca.arrays import FloatArray
from ltca.compliance.response import Start
from ltca.drive.fields import field_kind, is_element, read_field
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Bodies, Drive
from ltca.drive.ring_shape import has_ring_of_elements, ring_fingerprint
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import Equilibrium, lever_arms
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output, unbalanced_moment
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError, DriveError, Problem
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.quantities import DIMENSIONS, QUANTITIES
from ltca.reading.changes import with_fields

CHANGE = 1e-3
"""Relative change of the residual by one step: large compared with round-off of the approaches (1e-9 of it), small to the fourth
power."""
FIRST_STEP = 1e-7
"""First step of a field relative to its value, or in its unit where the value is zero."""
STEP_PARTS = (1.0, 0.1, 0.01)
"""Parts of the step that are tried, one after the other, at positions whose contacts do not keep to `LARGEST_LOAD_CHANGE`."""
LARGEST_LOAD_CHANGE = 0.1
"""Change of a contact's load over one step, relative to the load, up to which fourth-order differences have an error of 1e-6:
loads go with some δ^1.1, whose fifth derivative makes 0.017 of the fourth power of the change."""
MAX_CORRECTIONS = 12
SLOPE_TOLERANCE = 1e-9
"""Relative derivative of the residual at which the iteration stops."""
FAILED_SLOPE = 1e-6
"""Relative derivative of the residual above which the iteration has failed."""
ROUND_OFF = 1e-10
"""Change of the residual over one step, relative to the load, that counts as round-off of the inner unknowns."""
FLOATING = 1e-13
"""Stiffness, relative to the largest, below which a disc counts as unloaded; its pose stays as it is."""
NO_LOAD = 1e-9
"""Load of a contact, relative to that of the drive, up to which it counts as open: what balance leaves to it."""
SOFT = 1e-3
"""Stiffness of a coordinate, relative to the largest, below which its step does not grow: about a disc that floats are gaps."""
CENTRAL = (np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1.0, -8.0, 8.0, -1.0]) / 12.0)
FORWARD = (np.array([0.0, 1.0, 2.0, 3.0, 4.0]), np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0)
"""Steps and weights of differences of fourth order; forward ones (or backward) where a field is at its bound."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Node:
    """A drive beside the one that was balanced.

    Attributes
    ----------
    drive : Drive
        Warm.
    model : Reducer
        Its own.
    step : float
        From the field's value, in its unit.
    """

    drive: Drive
    model: Reducer
    step: float


class _Position:
    """Balanced positions under one torque, and how they follow a field."""

    def __init__(self, found: Equilibrium, base: _Node, torque: Callable[[Drive], float]) -> None:
        self.found, self.torque, self.held = found, torque, base.drive.wheel_is_held
        self.lever = np.broadcast_to(lever_arms(base.model), found.pose.shape)
        self.load = float(np.abs(found.wheel_moment / self.lever[:, WHEEL_ANGLE]).max())
        self.start = Start.after(found.response)
        stiffness = self._stiffness
        self.floating = stiffness <= FLOATING * stiffness.max()
        """Coordinates that nothing holds, shape (positions, coordinates)."""
        self.inverse = self._inverse(self._tangent(base))

    def residual(self, node: _Node, pose: FloatArray, moment: FloatArray) -> FloatArray:
        """Forces and moments that are not balanced, moments by their levers, N, shape (positions, unknowns)."""
        found = self._at(node, pose, moment)
        force = found.response.force.copy()
        force[:, WHEEL_ANGLE] -= moment
        left = self._closure(node, found)
        return np.concatenate((force / self.lever, (left / self.lever[:, WHEEL_ANGLE])[:, None]), axis=1)

    def change(self, base: _Node, beside: _Node) -> float:
        """Change of the residual at the held pose by the load, from one drive to another."""
        pose, moment = self.found.pose, self.found.wheel_moment
        return (
            float(np.max(np.abs(self.residual(beside, pose, moment) - self.residual(base, pose, moment)))) / self.load
        )

    def at(self, node: _Node, direction: FloatArray, part: float) -> Equilibrium:
        """What stands a step along a direction from balance."""
        pose, moment = self._moved(direction, part)
        return self._at(node, pose, moment)

    def along(self, node: _Node, direction: FloatArray, part: float) -> FloatArray:
        """The residual a step along a direction from balance."""
        return self.residual(node, *self._moved(direction, part))

    def load_change(self, beside: Equilibrium) -> FloatArray:
        """Largest change of a contact's load relative to it, shape (positions,); infinite where one opens or closes."""
        changes = []
        for load, other in zip(_loads(self.found), _loads(beside), strict=True):
            closed = load > NO_LOAD * self.load
            kept = closed == (other > NO_LOAD * self.load)
            change = np.where(closed, np.abs(other - load), 0.0) / np.where(closed, load, 1.0)
            changes.append(np.where(kept, change, np.inf).max(axis=1, initial=0.0))
        return np.asarray(np.max(changes, axis=0))

    def _moved(self, direction: FloatArray, part: float) -> tuple[FloatArray, FloatArray]:
        return self.found.pose + part * direction[:, :-1], self.found.wheel_moment + part * direction[:, -1]

    def _at(self, node: _Node, pose: FloatArray, moment: FloatArray) -> Equilibrium:
        response = node.model.respond(self.found.crank_angle, pose, self.start)
        return replace(self.found, pose=pose, wheel_moment=moment, response=response)

    @property
    def _stiffness(self) -> FloatArray:
        """Of each coordinate, moments and rotations by their levers, N/mm, shape (positions, coordinates)."""
        return np.asarray(np.abs(np.einsum("bii->bi", self.found.response.tangent)) / self.lever**2)

    def _closure(self, node: _Node, found: Equilibrium) -> FloatArray:
        """What is left of the moments about the axis where the wheel is held; what the load makes its moment where not."""
        torque = self.torque(node.drive)
        if not self.held:
            return np.asarray(found.wheel_moment - node.drive.wheel_moment(torque))
        share = np.full(found.crank_angle.shape, node.drive.input_per_crank_moment)
        return unbalanced_moment(node.model, found, share, node.drive.driving_sign * torque)

    def _tangent(self, base: _Node) -> FloatArray:
        """Slopes of the residual by pose and moment, those of forces as the balance takes them."""
        positions, size = self.found.pose.shape
        lever = self.lever
        matrix = np.zeros((positions, size + 1, size + 1))
        matrix[:, :size, :size] = self.found.response.tangent / lever[:, :, None]
        matrix[:, WHEEL_ANGLE, size] = -1.0 / lever[:, WHEEL_ANGLE]
        matrix[:, size, size] = 1.0 / lever[:, WHEEL_ANGLE]
        if self.held:
            stiffness = self._stiffness
            stiffness = np.maximum(stiffness.max(axis=0), SOFT * stiffness.max())  # a disc that floats has none
            for column in range(size):
                step = CHANGE * self.load / float(stiffness[column]) / lever[0, column]
                ends = []
                for sense in (-1.0, 1.0):
                    pose = self.found.pose.copy()
                    pose[:, column] += sense * step
                    ends.append(self._closure(base, self._at(base, pose, self.found.wheel_moment)))
                matrix[:, size, column] = (ends[1] - ends[0]) / (2.0 * step) / lever[:, WHEEL_ANGLE]
        return matrix

    def _inverse(self, matrix: FloatArray) -> FloatArray:
        """Pseudo-inverse of the tangent, scaled so that all unknowns are lengths."""
        stiffness = np.max(np.abs(matrix[:, :-1, :-1] / self.lever[:, None, :]), axis=(1, 2))
        moment = stiffness * self.lever[:, WHEEL_ANGLE]
        scale = np.concatenate((1.0 / self.lever, moment[:, None]), axis=1)
        return np.asarray(scale[:, :, None] * np.linalg.pinv(matrix * scale[:, None, :], rcond=FLOATING))

    def beside(self, nodes: Sequence[_Node], weights: FloatArray, step: float) -> tuple[FloatArray, list[Equilibrium]]:
        """Return how the pose follows, shape (positions, coordinates), and what stands at each of the drives beside.

        A disc that floats stays as it is. Where contacts open or close on the way, as those of a disc that is taken along by what
        it touches, the tangent is not that of the step, and the drives beside are balanced.
        """
        try:
            direction = self.follow(nodes, weights, step)
        except ConvergenceError:
            found = [self._balanced(node) for node in nodes]
            slope = np.tensordot(weights, np.stack([each.pose - self.found.pose for each in found]), 1) / step
            return np.where(self.floating, 0.0, slope), found
        return direction[:, :-1], [self.at(node, direction, node.step) for node in nodes]

    def _balanced(self, node: _Node) -> Equilibrium:
        torque, angle = self.torque(node.drive), self.found.crank_angle
        return solve_at_output(node.model, [node.drive], angle, torque, self.found.pose, self.start)

    def follow(self, nodes: Sequence[_Node], weights: FloatArray, step: float) -> FloatArray:
        """Return dz/dp, shape (positions, unknowns)."""
        direction = np.zeros((self.found.pose.shape[0], self.inverse.shape[1]))
        history: list[float] = []
        for _ in range(MAX_CORRECTIONS):
            slopes = [self.along(node, direction, node.step) for node in nodes]
            left = np.tensordot(weights, np.stack(slopes), 1) / step
            history.append(float(np.max(np.abs(left))))
            if history[-1] <= SLOPE_TOLERANCE * history[0] or (len(history) > 3 and history[-1] >= 0.5 * history[-2]):
                break
            direction = direction - np.matmul(self.inverse, left[..., None])[..., 0]
        if history[-1] > max(FAILED_SLOPE * history[0], ROUND_OFF * self.load / step):
            raise ConvergenceError(
                "derivatives do not settle; slopes of the residual that are left, N by the field's unit", history
            )
        return direction


def _loads(found: Equilibrium) -> tuple[FloatArray, ...]:
    """Loads of all contacts, kind by kind, shape (positions, pairs)."""
    response = found.response
    return response.pin_load, response.hole_load, response.rollers.outer_load, response.rollers.inner_load


def derivatives(analysis: LoadedAnalysis, fields: Iterable[str]) -> xr.Dataset:
    """Return how what an analysis answers follows fields of its drive.

    Parameters
    ----------
    analysis : LoadedAnalysis
        With an answer at every position.
    fields : iterable of str
        Real fields by their paths, or elements of arrays.

    Returns
    -------
    xarray.Dataset
        As `ltca.derivatives` describes it, without the dimension of the case.

    Raises
    ------
    DriveError
        For what is no real field of this drive, and for one that reshapes a body whose influence coefficients are given.
    ConvergenceError
        When positions have no answer, or no derivative.
    """
    if not analysis.is_complete:
        raise ConvergenceError("derivatives are those of balanced positions, and some of these have no answer")
    paths = [fields] if isinstance(fields, str) else list(fields)
    if not paths:
        raise DriveError(["fields: must be at least one"])
    if analysis.engine.options["contacts"] == "grids":
        raise DriveError(["method direct: has no derivatives, since cells of its grids open one by one; take tables"])
    engine = analysis.engine.with_coefficients(analysis.drive)
    balanced = _BalancedAnalysis(analysis, engine)
    each = [_Field(balanced, path).slopes() for path in paths]
    variables: dict[str, Any] = {}
    for name in each[0]:
        stacked, dims, told = np.stack([slopes[name] for slopes in each]), tuple[str, ...](), dict[str, str]()
        if name == "pose":
            dims, told = ("position", "coordinate"), {"long_name": "pose by the members' coordinates, mm and rad"}
        elif name in QUANTITIES and stacked.ndim > 1:
            quantity = QUANTITIES[name]
            dims = DIMENSIONS[quantity.of][1:]
            told = {"long_name": quantity.description, "units_of_quantity": quantity.unit}
        variables[name] = (("field", *dims), stacked, told)
    crank_angle = ("position", analysis.full.crank_angle, {"units": "rad", "long_name": "crank angle φ_C, held"})
    units = [_unit_of(path) for path in paths]
    return xr.Dataset(variables, coords={"field": paths, "unit": ("field", units), "crank_angle": crank_angle})


def _unit_of(path: str) -> str:
    """Unit of a real field or of an element of one; nothing of what is no quantity."""
    parent, _, last = path.rpartition(".")
    kind = field_kind(parent) if is_element(last) and field_kind(parent) is not None else field_kind(path)
    return "" if kind is None else kind.unit


class _Balanced(ABC):
    """A drive, and what was balanced of it under each of its torques."""

    written: Drive
    """As it was given."""
    drive: Drive
    """Warm."""
    engine: Engine
    base: _Node
    own_torque: float | None
    """The torque, where it is not that of the drive, N·mm."""
    states: list[_Position]

    @abstractmethod
    def read(self, node: _Node, found: Sequence[Equilibrium]) -> dict[str, Any]:
        """Values of a drive by what is balanced of it, by name."""

    def model(self, drive: Drive) -> Reducer:
        """What balances a drive."""
        return self.engine.prepare(drive).model

    def node(self, drive: Drive, step: float) -> _Node:
        """A drive beside."""
        return _Node(drive=drive, model=self.model(drive), step=step)

    def sides(self, nodes: list[_Node]) -> Sequence[list[_Node]]:
        """The drives beside, for each state as it is balanced."""
        return [nodes for _ in self.states]


class _BalancedAnalysis(_Balanced):
    """An analysis: the torque of the run, the light one, and the motion turned back where something rubs."""

    def __init__(self, analysis: LoadedAnalysis, engine: Engine) -> None:
        self.written, self.drive, self.engine = analysis.as_written, analysis.drive, engine
        self.own_torque = None if analysis.torque == analysis.drive.load.torque else analysis.torque
        self.base = self.node(analysis.drive, 0.0)
        self.states = [
            _Position(analysis.full, self.base, self.torque),
            _Position(analysis.light, self.base, lambda drive: drive.load.light_torque),
        ]
        if analysis.back is not None:
            self.states.append(_Position(analysis.back, _reversed(self.base), self.torque))

    def torque(self, drive: Drive) -> float:
        """Torque of the run on a drive beside."""
        return drive.load.torque if self.own_torque is None else self.own_torque

    def sides(self, nodes: list[_Node]) -> Sequence[list[_Node]]:
        turned_back = [[_reversed(node) for node in nodes]] if len(self.states) > 2 else []
        return [nodes, nodes, *turned_back]

    def read(self, node: _Node, found: Sequence[Equilibrium]) -> dict[str, Any]:
        analysis = analysis_of(node.drive, self.torque(node.drive), self.engine, node.model, *found)
        arrays = case_arrays(analysis)
        return arrays | {scalar_key(name): value for name, value in scalars_of_positions(analysis, arrays).items()}


class LostMotion(_Balanced):
    """Lost motion without friction, from two balanced torques, and how it follows fields of the drive.

    The input is held, the output is loaded by a part of the rated torque one way and the other, as
    `ltca.analysis.torque_curve.torque_curve` reads it of a drive without friction. The middle of a loop of friction lies
    some 1e-4 of the lost motion beside it. `value` is the lost motion, rad, shape (angles,).

    Parameters
    ----------
    drive : Drive
        As it was given.
    crank_angle : array, shape (angles,)
        φ_C, rad.
    engine : Engine, optional
        How bodies yield; half-spaces by default.
    part : float
        Part of the rated torque.

    Raises
    ------
    ConvergenceError
        When a position does not balance.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> found = LostMotion(load_drive("paper").cases["CS-3"], np.array([0.1]))
    >>> slope = found.slope("disc.shifting_offset")
    >>> print(f"{found.value[0] * 1e3:.3f} mrad, {slope[0] * 1e3:.2f} µrad by 1 µm")
    3.673 mrad, -30.17 µrad by 1 µm
    """

    def __init__(
        self, drive: Drive, crank_angle: FloatArray, engine: Engine | None = None, part: float = LOST_MOTION
    ) -> None:
        self.written = drive
        self.drive = warm_drive(drive.require_torque("lost motion, which is read at a part of it"))
        self.engine = (HalfSpace() if engine is None else engine).with_coefficients(self.drive)
        self.own_torque, self.part = None, part
        self.base = self.node(self.drive, 0.0)
        angles = np.atleast_1d(np.asarray(crank_angle, dtype=float))
        both = [
            solve_at_output(self.base.model, [self.drive], angles, self._torque(self.drive, way)) for way in (1, -1)
        ]
        self.states = [
            _Position(found, self.base, self._towards(way)) for found, way in zip(both, (1, -1), strict=True)
        ]
        self.value: FloatArray = self.read(self.base, both)["angle_between"]

    def slope(self, path: str) -> FloatArray:
        """Return the derivative of the lost motion by a real field, rad by its unit, shape (angles,).

        Raises
        ------
        DriveError
            For what is no real field of this drive, and for one that reshapes a body whose influence coefficients are given.
        ConvergenceError
            When drives beside this one have no answer.
        """
        return np.asarray(_Field(self, path).slopes()["angle_between"])

    def model(self, drive: Drive) -> Reducer:
        """What balances a drive: without friction."""
        return replace(self.engine.prepare(drive).model, friction=None)

    def read(self, node: _Node, found: Sequence[Equilibrium]) -> dict[str, Any]:
        """The angle of the output between both torques."""
        angles = [
            node.drive.output_deviation(wheel_angle_of_input(node.model, each), self._torque(node.drive, way))
            for each, way in zip(found, (1, -1), strict=True)
        ]
        return {"angle_between": node.drive.load_sign * (angles[0] - angles[1])}

    def _torque(self, drive: Drive, way: int) -> float:
        return way * self.part * drive.load.torque

    def _towards(self, way: int) -> Callable[[Drive], float]:
        return lambda drive: self._torque(drive, way)


class _Field:
    """One field of a balanced drive and the drives beside it."""

    def __init__(self, balanced: _Balanced, path: str) -> None:
        self.balanced, self.path = balanced, path
        value = read_field(balanced.written, path)
        if isinstance(value, bool) or not isinstance(value, float | int) or _unit_of(path) == "":
            raise DriveError([Problem.of(path, "", f"must be a real number, or an element of an array ({path}.0)")])
        self.value = float(value)
        if path == "load.torque" and balanced.own_torque is not None:
            said = f"the analysis has a torque of its own, {balanced.own_torque:g} N·mm"
            raise DriveError([Problem.of(path, "", said)])
        if balanced.engine.options["compliance"] != "half-space" and self._reshapes():
            said = "reshapes a body, whose influence coefficients are those of the body as it is"
            raise DriveError([Problem.of(path, "", said)])
        if has_ring_of_elements(balanced.drive) and self._reshapes_ring():
            said = 'reshapes the ring of finite elements, which stays as it is; use ring.model = "beam"'
            raise DriveError([Problem.of(path, "", said)])

    def slopes(self) -> dict[str, Any]:
        """Slopes of pose, arrays and scalars, by name; every position has those of the longest step that its contacts keep to.

        Scalars, which are of all positions, have those of the shortest.
        """
        found, left = dict[str, Any](), np.ones(self.balanced.states[0].found.crank_angle.shape, dtype=bool)
        for part in STEP_PARTS:
            fresh, change = self._slopes(part)
            for name, values in fresh.items():
                dimensions = DIMENSIONS[QUANTITIES[name].of][1:] if name in QUANTITIES else ("position",)
                if name in found and np.ndim(values) and "position" in dimensions:
                    rows = left.reshape(-1, *[1] * (np.ndim(values) - 1 - dimensions.index("position")))
                    found[name] = np.where(rows, values, found[name])
                else:
                    found[name] = values
            left &= ~(change <= LARGEST_LOAD_CHANGE)
            if not left.any():
                break
        return found

    def _slopes(self, part: float) -> tuple[dict[str, Any], FloatArray]:
        """Slopes by a part of the step, and the largest change of a contact's load over it, shape (positions,)."""
        states = self.balanced.states
        nodes, weights, step = self._nodes(part)
        sides = self.balanced.sides(nodes)
        poses, found_beside = zip(
            *(state.beside(side, weights, step) for state, side in zip(states, sides, strict=True)), strict=True
        )
        found: dict[str, Any] = {"pose": poses[0]}
        change = np.zeros(poses[0].shape[:1])
        for number, (node, weight) in enumerate(zip(nodes, (weights / step).tolist(), strict=True)):
            beside = [each[number] for each in found_beside]
            steps = max(abs(node.step) / step, 1.0)
            for state, other in zip(states, beside, strict=True):
                change = np.maximum(change, state.load_change(other) / steps)
            for name, values in self.balanced.read(node, beside).items():
                if np.asarray(values).dtype.kind == "f":
                    found[name] = found.get(name, 0.0) + weight * np.asarray(values)
        return found, change

    def _reshapes(self) -> bool:
        """Whether the field is one of the shape of a body."""
        bodies = self.balanced.engine.bodies
        own = _shapes(self.balanced.drive, bodies)
        return any(_shapes(drive, bodies) != own for drive in self._drives((self._first_step,)))

    def _reshapes_ring(self) -> bool:
        """Whether the field is one of the shape of the ring."""
        own = ring_fingerprint(self.balanced.drive)
        return any(ring_fingerprint(drive) != own for drive in self._drives((self._first_step,)))

    @property
    def _first_step(self) -> float:
        return FIRST_STEP * (abs(self.value) or 1.0)

    def _drives(self, steps: Iterable[float]) -> list[Drive]:
        """Drives with the field some steps beside, or as many on the other side of it where these cannot be."""
        try:
            return [self._drive(step) for step in steps]
        except DriveError:
            return [self._drive(-step) for step in steps]

    def _drive(self, step: float) -> Drive:
        return warm_drive(with_fields(self.balanced.written, {self.path: self.value + step}, check=False))

    def _nodes(self, part: float) -> tuple[list[_Node], FloatArray, float]:
        """The drives beside by a part of the step, the weights of their differences, and that part."""
        base, step = self.balanced.base, self._first_step
        beside = self.balanced.node(self._drives((step,))[0], step)
        changes = (state.change(base, beside) for state in self.balanced.states)
        change = next(
            (change for change in changes if change > 0.0), 0.0
        )  # fields of the light torque change one alone
        step *= part * float(np.clip(CHANGE / change, 1e-3, 1e4)) if change > 0.0 else part
        for (places, weights), sense in ((CENTRAL, 1.0), (FORWARD, 1.0), (FORWARD, -1.0)):
            steps = (sense * step * places).tolist()
            try:
                drives = [self._drive(away) for away in steps]
            except DriveError as error:
                failure = error
                continue
            return (
                [self.balanced.node(drive, away) for drive, away in zip(drives, steps, strict=True)],
                sense * weights,
                step,
            )
        raise failure


def _shapes(drive: Drive, bodies: Bodies) -> list[str]:
    return [single.shape_fingerprint(bodies) for single in single_discs(drive)]


def _reversed(node: _Node) -> _Node:
    """A drive whose motion is turned back."""
    friction = node.model.friction
    if friction is None:
        raise AssertionError("motion is turned back where something rubs")
    return replace(node, model=replace(node.model, friction=friction.reversed()))
