"""What a study keeps of each sample: scalars over its positions, by the names of the summary without their units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from ltca.analysis.friction.losses import Losses, losses
from ltca.analysis.summary import LOADED_FRACTION
from ltca.analysis.width import face_load_factor
from ltca.arrays import FloatArray
from ltca.compliance.response import ContactPressures, KindPressures
from ltca.drive.parts import Drive, Friction
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.reducer import Reducer, bearing_forces
from ltca.errors import DriveError, did_you_mean, shortened, told_twice
from ltca.quantities import NEED_SLICES, SCALARS

Stage = Literal["full", "light", "backlash", "play"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleBatch:
    """Solved samples, each at the same positions; rows of `full` and `light` run sample by sample.

    Attributes
    ----------
    drives : tuple of Drive
        Of the samples.
    model : Reducer
        How their bodies yield.
    full : Equilibrium
        At the torque of each drive.
    pressures : ContactPressures
        There.
    light : Equilibrium or None
        At the light torque, when a quantity needs it.
    backlash : array, shape (samples · positions,), or None
        Of the flank at the wheel, rad, when a quantity needs it.
    play : array, shape (samples · positions,), or None
        Free play of the wheel with every clearance, the input held, rad, when a quantity needs it.
    """

    drives: tuple[Drive, ...]
    model: Reducer
    full: Equilibrium
    pressures: ContactPressures
    light: Equilibrium | None
    backlash: FloatArray | None
    play: FloatArray | None = None

    @property
    def samples(self) -> int:
        """How many."""
        return len(self.drives)

    def by_sample(self, values: FloatArray) -> FloatArray:
        """Return values of all rows with the sample on axis 0 and everything else behind it in one row."""
        return np.asarray(values).reshape(self.samples, -1)

    @property
    def bearing(self) -> tuple[FloatArray, FloatArray]:
        """Radial and tangential forces of the bearings, N, shape (samples, positions, discs · cranks)."""
        push = bearing_forces(self.model, self.full.crank_angle, self.full.response)
        shape = (self.samples, push.shape[0] // self.samples, -1)
        return push.real.reshape(shape), push.imag.reshape(shape)

    def losses(self) -> Losses:
        """What friction costs, of all rows."""
        each = self.full.crank_angle.size // self.samples
        torque = np.repeat([drive.load.torque for drive in self.drives], each)
        return losses(self.model, self.drives, self.full, torque)

    def efficiency(self) -> FloatArray:
        """1 − mean loss/mean input of each sample."""
        found = self.losses()
        driving = self.by_sample(found.driving).mean(axis=1)
        through = np.where(self.by_sample(found.at_output).any(axis=1), driving, np.nan)
        return np.asarray(1.0 - self.by_sample(found.total).mean(axis=1) / through)

    def power_loss(self) -> FloatArray:
        """Mean power of all losses of each sample, W; not a number without speed."""
        found = self.losses()
        return np.asarray(self.by_sample(found.watts(found.total)).mean(axis=1))

    def _at_output(self, found: Equilibrium, torque: Sequence[float]) -> FloatArray:
        """Deviation of the output at the torque of each drive, arcsec."""
        wheel = self.by_sample(wheel_angle_of_input(self.model, found))
        each = zip(self.drives, wheel, torque, strict=True)
        return np.array([drive.output_deviation(angle, load) for drive, angle, load in each]) * ARCSEC

    def transmission_error(self) -> FloatArray:
        """Transmission error at the torque of each drive, arcsec."""
        return self._at_output(self.full, [drive.load.torque for drive in self.drives])

    def light_transmission_error(self) -> FloatArray:
        """Transmission error at the light torque, arcsec."""
        if self.light is None:
            raise ValueError("the light torque was not solved")
        return self._at_output(self.light, [drive.load.light_torque for drive in self.drives])

    def backlashes(self) -> FloatArray:
        """Backlash of the wheel, disc held, arcmin."""
        if self.backlash is None:
            raise ValueError("the backlash was not asked for")
        return self.by_sample(self.backlash) * ARCMIN

    def output_backlashes(self) -> FloatArray:
        """Free play of the output with every clearance, arcmin."""
        if self.play is None:
            raise ValueError("the free play was not asked for")
        output = np.array([abs(drive.output_per_wheel_angle) for drive in self.drives])
        return np.asarray(output[:, None] * self.by_sample(self.play) * ARCMIN)

    @property
    def cranks(self) -> int:
        """Cranks of each disc."""
        return self.model.discs[0].geometry.placement.cranks

    def face_load_factor(self, kind: KindPressures, groups: int = 1) -> FloatArray:
        """Largest face load factor of each sample, of which every disc has some groups; not a number without slices."""
        if kind.along is None:
            return np.full(self.samples, np.nan)
        factor = face_load_factor(kind.along, groups * self.discs, self.samples)
        return np.asarray(np.nanmax(self.by_sample(factor), axis=1))

    def tilts(self) -> FloatArray:
        """Tilts of all discs at all positions, rad; none without slices."""
        coordinates, pose = self.model.coordinates, self.full.pose
        if not coordinates.leans:
            return np.zeros((self.samples, 1))
        leans = [pose[:, coordinates.columns(disc)[coordinates.lean_place]] for disc in range(coordinates.discs)]
        return self.by_sample(np.stack([np.hypot(*lean.T) for lean in leans], axis=1))

    @property
    def discs(self) -> int:
        """Number of discs of every drive."""
        return len(self.model.discs)

    def loaded(self, load: FloatArray, parts: int) -> FloatArray:
        """Mean number of loaded pairs of one of as many equal parts, discs or bearings, over the parts and positions."""
        largest = self.by_sample(load).max(axis=1)
        rows = load.reshape(self.samples, -1, load.shape[1]) > LOADED_FRACTION * largest[:, None, None]
        return np.asarray(rows.sum(axis=2).mean(axis=1) / parts)


Evaluate: TypeAlias = Callable[[SampleBatch], FloatArray]
"""One scalar of every sample, shape (samples,), from the solved batch."""

EVALUATORS: dict[Stage, dict[str, Evaluate]] = {
    "full": {
        "ptp_transmission_error": lambda b: np.ptp(b.transmission_error(), axis=1),
        "mean_transmission_error": lambda b: b.transmission_error().mean(axis=1),
        "max_pin_load": lambda b: b.by_sample(b.full.response.pin_load).max(axis=1),
        "max_pin_pressure_mid": lambda b: b.by_sample(b.pressures.pins.mid).max(axis=1),
        "max_pin_pressure_max": lambda b: b.by_sample(b.pressures.pins.largest).max(axis=1),
        "max_roller_load": lambda b: b.by_sample(b.full.response.rollers.outer_load).max(axis=1),
        "max_roller_pressure_mid": lambda b: np.maximum(
            b.by_sample(b.pressures.outer.mid).max(axis=1), b.by_sample(b.pressures.inner.mid).max(axis=1)
        ),
        "max_roller_pressure_max": lambda b: np.maximum(
            b.by_sample(b.pressures.outer.largest).max(axis=1), b.by_sample(b.pressures.inner.largest).max(axis=1)
        ),
        "max_roller_pressure_mid_outer": lambda b: b.by_sample(b.pressures.outer.mid).max(axis=1),
        "max_roller_pressure_mid_inner": lambda b: b.by_sample(b.pressures.inner.mid).max(axis=1),
        "max_pin_shaft_load": lambda b: b.by_sample(b.full.response.hole_load).max(axis=1),
        "max_pin_shaft_pressure_mid": lambda b: b.by_sample(b.pressures.holes.mid).max(axis=1),
        "max_pin_shaft_pressure_max": lambda b: b.by_sample(b.pressures.holes.largest).max(axis=1),
        "max_pin_face_load_factor": lambda b: b.face_load_factor(b.pressures.pins),
        "max_roller_face_load_factor": lambda b: np.maximum(
            b.face_load_factor(b.pressures.outer, b.cranks), b.face_load_factor(b.pressures.inner, b.cranks)
        ),
        "max_pin_shaft_face_load_factor": lambda b: b.face_load_factor(b.pressures.holes),
        "max_disc_tilt": lambda b: b.tilts().max(axis=1),
        "mean_bearing_load": lambda b: np.hypot(*b.bearing).mean(axis=(1, 2)),
        "max_bearing_load": lambda b: np.hypot(*b.bearing).max(axis=(1, 2)),
        "mean_radial_bearing_load": lambda b: b.bearing[0].mean(axis=(1, 2)),
        "mean_tangential_bearing_load": lambda b: b.bearing[1].mean(axis=(1, 2)),
        "ptp_tangential_bearing_load": lambda b: np.ptp(b.bearing[1], axis=1).max(axis=1),
        "mean_loaded_pins": lambda b: b.loaded(b.full.response.pin_load, b.discs),
        "mean_loaded_rollers": lambda b: b.loaded(b.full.response.rollers.outer_load, b.discs * b.cranks),
        "mean_loaded_pin_shaft_pins": lambda b: b.loaded(b.full.response.hole_load, b.discs),
        "mean_efficiency": lambda b: b.efficiency(),
        "mean_input_torque": lambda b: b.by_sample(b.losses().input_torque).mean(axis=1),
        "power_loss": lambda b: b.power_loss(),
    },
    "light": {"ptp_transmission_error_light": lambda b: np.ptp(b.light_transmission_error(), axis=1)},
    "play": {
        "max_backlash_output": lambda b: b.output_backlashes().max(axis=1),
        "min_backlash_output": lambda b: b.output_backlashes().min(axis=1),
    },
    "backlash": {
        "mean_backlash_wheel": lambda b: b.backlashes().mean(axis=1),
        "min_backlash_wheel": lambda b: b.backlashes().min(axis=1),
    },
}
"""How the scalars of a study are evaluated, by what has to be solved for them."""


STAGES: dict[str, Stage] = {name: stage for stage, evaluators in EVALUATORS.items() for name in evaluators}
"""Every scalar of a study, by name in `ltca.quantities.SCALARS`, and what has to be solved for it."""
OF_RACES = ("max_roller_pressure_mid_outer", "max_roller_pressure_mid_inner")
"""Pressures of single races, which come when named or limited: `max_roller_pressure_mid` is the larger."""
OF_ENDS = ("max_pin_pressure_max", "max_roller_pressure_max", "max_pin_shaft_pressure_max")
"""Largest pressures anywhere along the width, which come when named or limited, and of contacts in slices always."""
DEFAULT_QUANTITIES = tuple(name for name in EVALUATORS["full"] if name not in (*OF_RACES, *OF_ENDS))
"""What the solution at the torque of the drive gives; those of other stages cost another solution and come when named."""


OF_THE_PIN_SHAFT = (
    "max_pin_shaft_load", "max_pin_shaft_pressure_mid", "max_pin_shaft_pressure_max", "max_pin_shaft_face_load_factor",
    "mean_loaded_pin_shaft_pins",
)  # fmt: skip
"""What a drive without pin shaft has not."""
OF_WIDTH = tuple(name for name in STAGES if SCALARS[name].of in NEED_SLICES)
"""What a drive without slices has not."""
OF_FRICTION = ("mean_efficiency", "mean_input_torque", "power_loss")
"""What a drive without friction has not; the last needs a speed as well."""


def quantities_for(drive: Drive, names: tuple[str, ...] | None) -> tuple[str, ...]:
    """Return the quantities of a study of a drive: names of `STAGES`, by default and for ``all`` those that it has.

    Raises `DriveError` when a name is not one of them, or the drive does not have it.
    """
    if names is not None:
        names = check_quantities(names)
    if names is None or names == tuple(STAGES):
        missing = missing_quantities(drive)
        ends = OF_ENDS if drive.contact.slices > 1 else ()
        return tuple(name for name in (names or (*DEFAULT_QUANTITIES, *ends)) if name not in missing)
    require_quantities(drive, names)
    return names


def quantities_for_all(cases: Mapping[str, Drive], names: tuple[str, ...] | None) -> tuple[str, ...]:
    """Return the quantities of a study of several cases: names of `STAGES`, by default and for ``all`` those that all have.

    Raises `DriveError` when a name is not one of them, or a case, which is named, does not have it.
    """
    found: list[tuple[str, ...]] = []
    problems: list[str] = []
    for case, drive in cases.items():
        try:
            found.append(quantities_for(drive, names))
        except DriveError as error:
            problems += [f"{problem}: case {case}" for problem in error.problems]
    if problems:
        raise DriveError(problems)
    return tuple(name for name in found[0] if all(name in others for others in found))


def require_quantities(drive: Drive, names: Iterable[str]) -> None:
    """Raise `DriveError` where a drive does not have one of the quantities."""
    missing = missing_quantities(drive)
    if absent := [name for name in names if name in missing]:
        raise DriveError([f"{name}: {drive.name} has no {missing[name]}" for name in absent])


def missing_quantities(drive: Drive) -> dict[str, str]:
    """Return the quantities that a drive has not, with what it would need for them."""
    missing = dict.fromkeys(OF_WIDTH, "slices (contact.slices)") if drive.contact.slices == 1 else {}
    missing |= dict.fromkeys(OF_THE_PIN_SHAFT, "pin shaft (pin_shaft)") if drive.pin_shaft is None else {}
    if drive.friction is None:
        missing |= dict.fromkeys(OF_FRICTION, "friction ([friction])")
    elif drive.load.speed is None:
        missing |= {"power_loss": "speed (load.speed)"}
    return missing


def evaluate(name: str, batch: SampleBatch) -> FloatArray:
    """Return a scalar of every sample, one of `STAGES`, shape (samples,)."""
    return EVALUATORS[STAGES[name]][name](batch)


def with_what_varies(drive: Drive, paths: Iterable[str]) -> Drive:
    """Return a drive of which a study varies fields, with the table of friction where coefficients of it are varied."""
    rubs = any(path.startswith("friction.") for path in paths)
    return replace(drive, friction=Friction()) if rubs and drive.friction is None else drive


def check_quantities(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names in the order of `STAGES`, ``all`` meaning every one; `DriveError` for unknown and repeated names."""
    if repeated := told_twice(names):
        raise DriveError([f"{shortened(repeated)[1:-1]}: is given twice"])
    if "all" in names:
        return tuple(STAGES)
    unknown = [name for name in names if name not in STAGES]
    if unknown:
        known = [*STAGES, "all"]
        meant = {name: did_you_mean(name, known) or f"; there are {', '.join(known)}" for name in unknown}
        raise DriveError([f"{shortened(name)[1:-1]}: is no quantity of a study{meant[name]}" for name in unknown])
    return tuple(name for name in STAGES if name in names)
