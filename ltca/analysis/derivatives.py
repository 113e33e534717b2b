r"""How loads, poses, angles and pressures of a balanced drive follow its fields, without balancing it again.

At a balanced position the residual :math:`R(z, p)` is nought: of the forces on all members, z being their pose q, and, where the
wheel is held, of the moments about the axis, z having the moment that holds it, too. With a field p of the drive the balance goes

.. math:: \frac{dz}{dp} = -\left(\frac{\partial R}{\partial z}\right)^{-1} \frac{\partial R}{\partial p} ,

and whatever is read from pose and drive, :math:`f(z, p)`, goes :math:`\partial f/\partial p + \partial f/\partial z \cdot dz/dp`.

The tangent of the balance leaves out that radii of curvature and influence coefficients change along the flank, some 1e-5 of it.
So it only proposes dz/dp; what the residual itself does along that direction corrects the proposal until nothing is left: the
answer is that of the whole Jacobian. Slopes along a direction are differences of fourth order of residuals and results evaluated
beside the balanced position, with parameters of one thousandth of the approaches: round-off and what they leave out are below
1e-7. Where a contact is just about to open a derivative has two sides, and these differences a value between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ltca.analysis.engines import Engine
from ltca.analysis.loaded_analysis import LoadedAnalysis, analysis_of
from ltca.analysis.results import build_dataset
from ltca.compliance.response import Start
from ltca.drive.fields import field_kind, is_element, read_field
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import Equilibrium, lever_arms
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.output_torque import input_moment
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.reading.changes import with_fields

FloatArray = NDArray[np.float64]

CHANGE = 1e-3
"""By what part of the largest force a step changes a residual: large against round-off of approaches (1e-9 of it), and its fourth
power small."""
FIRST_STEP = 1e-7
"""First step of a field, as a part of its value or of one of its unit where it is zero."""
CORRECTIONS = 12
SETTLED = 1e-9
"""Slope of the residual that is left, as a part of what the field alone makes."""
ROUND_OFF = 1e-13
"""Change of a residual over a step that counts as none, as a part of the load."""
CENTRAL = (np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1.0, -8.0, 8.0, -1.0]) / 12.0)
FORWARD = (np.array([0.0, 1.0, 2.0, 3.0, 4.0]), np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0)
"""Steps and weights of differences of fourth order; forward ones (or backward) where a field is at its bound."""
UNITS_OF_REAL_FIELDS = ("",)
"""Unit of what is no quantity: counts and names."""


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

    def __init__(self, found: Equilibrium, drive: Drive, model: Reducer, torque: Callable[[Drive], float]) -> None:
        self.found, self.torque, self.held = found, torque, drive.wheel_is_held
        self.lever = np.broadcast_to(lever_arms(model), found.pose.shape)
        self.start = Start.after(found.response)
        self.jacobian = self._tangent(drive, model)

    def residual(self, node: _Node, pose: FloatArray, moment: FloatArray) -> FloatArray:
        """Forces and moments that are not balanced, moments by their levers, N, shape (positions, unknowns)."""
        found = self._at(node, pose, moment)
        force = found.response.force.copy()
        force[:, WHEEL_ANGLE] -= moment
        left = self._closure(node, found)
        return np.concatenate((force / self.lever, (left / self.lever[:, WHEEL_ANGLE])[:, None]), axis=1)

    def at(self, node: _Node, direction: FloatArray, part: float) -> Equilibrium:
        """What stands a step along a direction from balance."""
        pose, moment = self._moved(direction, part)
        return self._at(node, pose, moment)

    def along(self, node: _Node, direction: FloatArray, part: float) -> FloatArray:
        """The residual a step along a direction from balance."""
        return self.residual(node, *self._moved(direction, part))

    def _moved(self, direction: FloatArray, part: float) -> tuple[FloatArray, FloatArray]:
        return self.found.pose + part * direction[:, :-1], self.found.wheel_moment + part * direction[:, -1]

    def _at(self, node: _Node, pose: FloatArray, moment: FloatArray) -> Equilibrium:
        response = node.model.respond(self.found.crank_angle, pose, self.start)
        return replace(self.found, pose=pose, wheel_moment=moment, response=response)

    def _closure(self, node: _Node, found: Equilibrium) -> FloatArray:
        """What is left of the moments about the axis where the wheel is held; what the load makes its moment where not."""
        torque = self.torque(node.drive)
        if not self.held:
            return np.asarray(found.wheel_moment - node.drive.wheel_moment(torque))
        share = np.full(found.crank_angle.shape, node.drive.input_per_crank_moment)
        moment = input_moment(node.model, found.crank_angle, found.pose, found.response, share)
        return np.asarray(found.wheel_moment + moment + node.drive.driving_sign * torque)

    def _tangent(self, drive: Drive, model: Reducer) -> FloatArray:
        """Slopes of the residual by pose and moment, those of forces as the balance takes them."""
        positions, size = self.found.pose.shape
        node, lever = _Node(drive=drive, model=model, step=0.0), self.lever
        matrix = np.zeros((positions, size + 1, size + 1))
        matrix[:, :size, :size] = self.found.response.tangent / lever[:, :, None]
        matrix[:, WHEEL_ANGLE, size] = -1.0 / lever[:, WHEEL_ANGLE]
        matrix[:, size, size] = 1.0 / lever[:, WHEEL_ANGLE]
        if self.held:
            stiffness = np.abs(np.einsum("bii->bi", self.found.response.tangent)).max(axis=0)
            load = np.abs(self.found.wheel_moment).max() / lever[0, WHEEL_ANGLE]
            for column in range(size):
                step = CHANGE * load * lever[0, column] / max(float(stiffness[column]), 1e-300)
                ends = []
                for sense in (-1.0, 1.0):
                    pose = self.found.pose.copy()
                    pose[:, column] += sense * step
                    ends.append(self._closure(node, self._at(node, pose, self.found.wheel_moment)))
                matrix[:, size, column] = (ends[1] - ends[0]) / (2.0 * step) / lever[:, WHEEL_ANGLE]
        return matrix

    def follow(self, nodes: Sequence[_Node], weights: FloatArray, step: float) -> FloatArray:
        """Return dz/dp, shape (positions, unknowns)."""
        direction = np.zeros((self.found.pose.shape[0], self.jacobian.shape[1]))
        nothing = ROUND_OFF * float(np.abs(self.found.wheel_moment / self.lever[:, WHEEL_ANGLE]).max()) / step
        history: list[float] = []
        for _ in range(CORRECTIONS):
            slopes = [self.along(node, direction, node.step) for node in nodes]
            left = np.tensordot(weights, np.stack(slopes), 1) / step
            history.append(float(np.max(np.abs(left))))
            if history[-1] <= max(SETTLED * history[0], nothing) or (
                len(history) > 3 and history[-1] >= 0.5 * history[-2]
            ):
                break
            direction = direction - np.linalg.solve(self.jacobian, left[..., None])[..., 0]
        if history[-1] > max(1e-5 * history[0], nothing):
            raise ConvergenceError(
                "derivatives do not settle; slopes of the residual that are left, N by the field's unit", history
            )
        return direction


def derivatives(analysis: LoadedAnalysis, fields: Iterable[str]) -> xr.Dataset:
    """Return how what an analysis answers follows fields of its drive.

    Parameters
    ----------
    analysis : LoadedAnalysis
        With an answer at every position.
    fields : iterable of str
        Real fields by their paths, ``disc.shifting_offset``, ``crank.eccentricity``, ``load.torque``, or elements of arrays,
        ``pin_wheel.pin_errors.radial.3``.

    Returns
    -------
    xarray.Dataset
        The variables of the dataset of a run, each with the dimension ``field`` before its own and per unit of the field
        (coordinate ``unit``), and ``pose``, by members' coordinates.

    Raises
    ------
    DriveError
        For what is no real field of this drive, and, by its name, for one that reshapes a body whose influence coefficients
        are given.
    ConvergenceError
        When positions have no answer, or no derivative.
    """
    if not analysis.is_complete:
        raise ConvergenceError("derivatives are those of balanced positions, and some of these have no answer")
    paths = list(fields)
    if not paths:
        raise DriveError(["fields: must be at least one"])
    engine = analysis.engine.with_coefficients(analysis.drive)
    found = [_Field(analysis, engine, path).derivative() for path in paths]
    units = [_kind_of(path) for path in paths]
    dataset = xr.concat(found, dim=xr.DataArray(paths, dims="field", name="field"))
    return dataset.assign_coords(unit=("field", units))


def _kind_of(path: str) -> str:
    """Unit of a field or of an element of one."""
    parent, _, last = path.rpartition(".")
    kind = field_kind(parent) if is_element(last) and field_kind(parent) is not None else field_kind(path)
    return "" if kind is None else kind.unit


class _Field:
    """One field of an analysis and the drives beside it."""

    def __init__(self, analysis: LoadedAnalysis, engine: Engine, path: str) -> None:
        self.analysis, self.engine, self.path = analysis, engine, path
        value = read_field(analysis.as_written, path)
        kind = _kind_of(path)
        if isinstance(value, bool) or not isinstance(value, float | int) or kind == "":
            raise DriveError(
                [
                    f"{path}: is no real number, of which there are derivatives (an element of an array has its number behind it)"
                ]
            )
        self.value = float(value)
        self.own_torque = analysis.torque == analysis.drive.load.torque
        if path == "load.torque" and not self.own_torque:
            raise DriveError([f"{path}: the analysis has a torque of its own, {analysis.torque:g} N·mm"])
        self.shapes = [single.shape_fingerprint() for single in single_discs(analysis.drive)]

    def node(self, step: float) -> _Node:
        """The drive with the field a step beside."""
        drive = warm_drive(with_fields(self.analysis.as_written, {self.path: self.value + step}, check=False))
        if self.engine.options["compliance"] != "half-space":
            shapes = [single.shape_fingerprint() for single in single_discs(drive)]
            if shapes != self.shapes:
                raise DriveError(
                    [f"{self.path}: reshapes a body, and the influence coefficients are those of the body as it is"]
                )
        return _Node(drive=drive, model=self.engine.prepare(drive).model, step=step)

    def nodes(self) -> tuple[list[_Node], FloatArray, float]:
        """The drives beside, the weights of their differences, and the step."""
        step = FIRST_STEP * (abs(self.value) or 1.0)
        one = self._either(step)
        base = _Node(drive=self.analysis.drive, model=self.engine.prepare(self.analysis.drive).model, step=0.0)
        position = self.positions(base)[0]
        still = np.zeros((position.found.pose.shape[0], position.found.pose.shape[1] + 1))
        load = float(np.abs(position.found.wheel_moment).max() / position.lever[0, WHEEL_ANGLE])
        change = float(np.max(np.abs(position.along(one, still, 0.0) - position.along(base, still, 0.0)))) / load
        step *= float(np.clip(CHANGE / change, 1e-3, 1e4)) if change > 0.0 else 1.0
        for (places, weights), sense in ((CENTRAL, 1.0), (FORWARD, 1.0), (FORWARD, -1.0)):
            try:
                return [self.node(sense * step * place) for place in places.tolist()], sense * weights, step
            except DriveError as error:
                failure = error
                if "reshapes" in str(error):
                    raise
        raise failure

    def _either(self, step: float) -> _Node:
        try:
            return self.node(step)
        except DriveError as error:
            if "reshapes" in str(error):
                raise
            return self.node(-step)

    def positions(self, base: _Node) -> list[_Position]:
        """What was balanced: at the torque, at the light torque, and the motion reversed."""
        analysis = self.analysis

        def torque(drive: Drive) -> float:
            return drive.load.torque if self.own_torque else analysis.torque

        return [
            _Position(analysis.full, base.drive, base.model, torque),
            _Position(analysis.light, base.drive, base.model, lambda drive: drive.load.light_torque),
        ]

    def derivative(self) -> xr.Dataset:
        """The derivative of the dataset."""
        analysis = self.analysis
        nodes, weights, step = self.nodes()
        base = _Node(drive=analysis.drive, model=self.engine.prepare(analysis.drive).model, step=0.0)
        positions = self.positions(base)
        directions = [position.follow(nodes, weights, step) for position in positions]
        back = _turned_back(analysis, base, nodes, weights, step)
        total: xr.Dataset | None = None
        pose = np.zeros(0)
        for node, weight in zip(nodes, weights.tolist(), strict=True):
            full, light = (
                position.at(node, direction, node.step)
                for position, direction in zip(positions, directions, strict=True)
            )
            turned = None if back is None else back[0].at(_reversed(node), back[1], node.step)
            beside = analysis_of(
                node.drive, positions[0].torque(node.drive), self.engine, node.model, full, light, turned
            )
            dataset = build_dataset(node.drive.name, {node.drive.case: beside})
            real = dataset[[name for name, values in dataset.data_vars.items() if values.dtype.kind == "f"]]
            scaled = real.drop_vars([name for name in real.coords if name not in real.dims]) * (weight / step)
            total = scaled if total is None else total + scaled
        pose = directions[0][:, :-1]
        assert total is not None
        for name, values in total.data_vars.items():
            values.attrs = dict(dataset[name].attrs)
        return total.assign(pose=(("position", "coordinate"), pose)).assign_coords(crank_angle=dataset["crank_angle"])


def _reversed(node: _Node) -> _Node:
    friction = node.model.friction
    assert isinstance(friction, TurningFriction)
    return replace(node, model=replace(node.model, friction=friction.reversed()))


def _turned_back(
    analysis: LoadedAnalysis, base: _Node, nodes: Sequence[_Node], weights: FloatArray, step: float
) -> tuple[_Position, FloatArray] | None:
    """How the positions with the motion reversed follow a field; None without friction."""
    if analysis.back is None:
        return None
    position = _Position(analysis.back, base.drive, _reversed(base).model, lambda drive: drive.load.torque)
    return position, position.follow([_reversed(node) for node in nodes], weights, step)
