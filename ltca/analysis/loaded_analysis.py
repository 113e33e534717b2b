"""Loaded tooth contact analysis of one drive at many crank angles: equilibrium, then pressures and bearing forces."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.engines import Engine, HalfSpace, PreparedEngine, lent_words
from ltca.analysis.friction.losses import Losses, losses
from ltca.analysis.half_space_errors import at_torque, half_space_words
from ltca.analysis.half_width_guard import (
    check_half_widths,
    displacement_warning,
    pin_deflections,
    separation_warning,
    steep_tilt_warning,
    unborne_warning,
    wide_holes_warning,
)
from ltca.analysis.run_off import few_slices_warning, run_off_warning, undivided_ends_warning
from ltca.analysis.share_causes import share_words
from ltca.arrays import ComplexArray, FloatArray, batch_layout, freeze, stack_drives, take_positions
from ltca.compliance.coefficient_files import coefficient_warnings
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import ContactPressures
from ltca.compliance.wall_stress import WallStresses, wall_stresses
from ltca.drive.hole_contact import hole_words
from ltca.drive.least_torque import torque_problem
from ltca.drive.members.named_materials import strength_warning
from ltca.drive.members.temperatures import temperature_words, warm_drive
from ltca.drive.parts import Drive, Temperature
from ltca.drive.ring_shape import deep_seats_warning
from ltca.drive.single_discs import single_discs
from ltca.drive.unit_mistakes import names_unit_mistakes, unit_mistakes_named, unit_warnings
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.units.table import range_of
from ltca.equilibrium.balance import Equilibrium, equilibrium_of_disc
from ltca.equilibrium.compliance_shares import PARTS, compliance_shares
from ltca.equilibrium.first_stage import StageMesh
from ltca.equilibrium.output_angle import crank_lag, wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.partial_balance import (
    PartlyBalanced,
    all_balanced,
    balance_what_can_be,
)
from ltca.equilibrium.reducer import Reducer, bearing_forces, disc_pressures, disc_torques
from ltca.errors import ConvergenceError, DriveError, OverloadError, Problem, shortened
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.interference import lost_play, preload_warning
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import free_play
from ltca.laws.carrier import loaded_circle

COMPLIANCE_SHARE_POSITIONS = 24
"""Number of positions at which shares of the compliance are evaluated: they change slowly over the turn."""
HELD_PLAY = 1e-6
"""Free play of the wheel times u, rad, up to which parts that overlap hold it: programmes stop at some 2e-9 of the wheel."""
MAX_BATCH_POSITIONS = 20_000
"""Most positions that are balanced as one batch: more take memory and save no time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedAnalysis:
    """Result of the analysis of one drive in one case.

    Attributes
    ----------
    drive : Drive
        What was analysed, at its temperatures.
    torque : float
        Output torque, N·mm.
    engine : Engine
        What it ran on.
    full, light : Equilibrium
        At that torque and at the light torque.
    model : Reducer
        The compliance behind both.
    pressures : ContactPressures
        Pressures and half-widths at that torque.
    bearing_radial, bearing_tangential : array, shape (positions, discs, cranks)
        Bearing force on each disc along its own eccentricity and 90° ahead, N.
    wall_stresses : tuple of WallStresses
        Stresses along the walls of each disc at that torque; empty where bodies are half-spaces and have no walls.
    balanced, balanced_light : array of bool, shape (positions,)
        Where that torque and the light torque have an answer; elsewhere numbers are none.
    back : Equilibrium or None
        At that torque with the motion reversed, poses that are no numbers where there is no answer; None without friction.
    written : Drive or None
        The drive as it was given, with its temperatures; None where it has none.
    """

    drive: Drive
    torque: float
    engine: Engine
    full: Equilibrium
    light: Equilibrium
    model: Reducer
    pressures: ContactPressures
    bearing_radial: FloatArray
    bearing_tangential: FloatArray
    wall_stresses: tuple[WallStresses, ...]
    balanced: NDArray[np.bool_]
    balanced_light: NDArray[np.bool_]
    back: Equilibrium | None = None
    written: Drive | None = None

    @property
    def as_written(self) -> Drive:
        """The drive as it was given."""
        return self.written or self.drive

    @property
    def is_complete(self) -> bool:
        """Whether every position has an answer at both torques."""
        return bool(np.all(self.balanced) and np.all(self.balanced_light))

    @property
    def discs(self) -> tuple[LoadedAnalysis, ...]:
        """What each disc takes part in, as the analysis of a drive of that disc alone.

        What each carries of the torque is in `disc_torques`.
        """
        singles = single_discs(self.drive)
        pressures = disc_pressures(self.pressures, len(singles))
        return tuple(
            replace(
                self,
                drive=single,
                full=equilibrium_of_disc(self.model, self.full, number),
                light=equilibrium_of_disc(self.model, self.light, number),
                model=Reducer(discs=(model,)),
                pressures=pressures[number],
                bearing_radial=self.bearing_radial[:, number : number + 1],
                bearing_tangential=self.bearing_tangential[:, number : number + 1],
                wall_stresses=self.wall_stresses[number : number + 1],
            )
            for number, (single, model) in enumerate(zip(singles, self.model.discs, strict=True))
        )

    @property
    def disc_torques(self) -> FloatArray:
        """Part of the external moment on the wheel that each disc carries, ccw positive, shape (positions, discs), N·mm."""
        return disc_torques(self.full.response)

    @property
    def crank_torques(self) -> FloatArray:
        """External moment that holds each crank by virtual work, ccw positive, shape (positions, cranks), N·mm.

        That of the forces alone is smaller by the cage speed times `cage_moments`. Of a central crank, which is the input,
        with what seals and oil take.
        """
        found = self.losses
        if found is not None and self.drive.crank.number == 1:
            return found.input_torque[:, None]
        return self.model.crank_moments(self.full.crank_angle, self.full.pose, self.full.response.parts)

    @property
    def cage_moments(self) -> FloatArray:
        """External moment that holds the roller cages of each crank, ccw positive, shape (positions, cranks), N·mm."""
        return self.model.cage_moments(self.full.crank_angle, self.full.pose, self.full.response.parts)

    @property
    def losses(self) -> Losses | None:
        """What friction costs; None without."""
        return None if self.back is None else losses(self.model, [self.drive], self.full, self.torque)

    @property
    def losses_back(self) -> Losses | None:
        """The same with the motion reversed."""
        friction = self.model.friction
        if self.back is None or friction is None:
            return None
        return losses(replace(self.model, friction=friction.reversed()), [self.drive], self.back, self.torque)

    @property
    def moves_back(self) -> NDArray[np.bool_]:
        """Where the load at the output turns the input without help, shape (positions,); everywhere without friction."""
        found = self.losses if self.drive.load.driven_by == "output" else self.losses_back
        if found is None:
            return np.ones(self.full.crank_angle.shape, dtype=bool)
        return np.asarray(found.at_input < 0.0)

    @property
    def crank_deflections(self) -> ComplexArray:
        """Displacement of each crank in the plane of each disc along its eccentric + i · 90° ahead, mm.

        Shape (positions, discs, cranks); without cranks where they are rigid.
        """
        pose, coordinates, parts = self.full.pose, self.model.coordinates, []
        for number, disc in enumerate(self.model.discs):
            own = pose[:, coordinates.columns(number)]
            first, last = coordinates.crank(0), coordinates.crank(coordinates.cranks)
            moved = own[:, first:last:2] + 1j * own[:, first + 1 : last : 2]
            ahead = disc.geometry.placement.eccentric_directions(self.full.crank_angle)
            parts.append(moved * ahead.conjugate() if coordinates.cranks else moved)
        return np.stack(parts, axis=1)

    @property
    def ring_displacements(self) -> ComplexArray | None:
        """Displacement of the seat of each wheel pin by the ring, radially outward + i · 90° ahead, mm, shape (positions, z_P).

        None where the ring is rigid.
        """
        moved = self.full.response.ring
        if moved is None:
            return None
        centres = self.model.discs[0].geometry.placement.wheel_pin_centres
        return np.asarray(moved * (centres / np.abs(centres)).conjugate())

    @property
    def compliance_shares(self) -> dict[str, FloatArray]:
        """Which part yields how much of the output's compliance (`ltca.equilibrium.compliance_shares`).

        At up to `COMPLIANCE_SHARE_POSITIONS` of the positions, evenly chosen; not a number where one has no answer.
        """
        positions = self.full.crank_angle.size
        rows = np.linspace(0, positions, min(positions, COMPLIANCE_SHARE_POSITIONS), endpoint=False).astype(int)
        if not np.all(self.balanced[rows]):
            return dict.fromkeys(PARTS, np.full(rows.size, np.nan))
        found = take_positions(self.full, rows)
        if self.torque == 0.0:  # what a little torque turns, from none
            found = replace(found, wheel_moment=self.light.wheel_moment[rows])
        behind = self.drive.carrier_compliance / self.drive.output_per_wheel_angle**2
        return compliance_shares(self.model, found, behind)

    @property
    def engine_words(self) -> str:
        """What to know of the engine: why half-spaces, and how far off they are, or whose coefficients it uses; else empty."""
        loaded = at_torque(self.as_written, self.torque)
        return half_space_words(self.engine, loaded) or lent_words(self.engine, self.drive)

    @property
    def torque_share(self) -> FloatArray:
        """Part of the wheel's moment that each disc carries, shape (positions, discs)."""
        if self.torque == 0.0:  # parts of nothing
            return np.full(self.disc_torques.shape, np.nan)
        return np.asarray(self.disc_torques / self.disc_torques.sum(axis=1, keepdims=True))

    @property
    def share_words(self) -> str:
        """Which parts make the discs share the torque unequally; empty where they share it equally or no part does."""
        known = self.torque_share[self.balanced]
        return share_words(self.drive, known.mean(axis=0)) if known.size else ""

    @property
    def transmission_error(self) -> FloatArray:
        """Deviation of the output at the torque of the run, ccw positive, shape (positions,), rad (Eq. 94)."""
        return np.asarray(self.drive.output_deviation(wheel_angle_of_input(self.model, self.full), self.torque))

    @property
    def transmission_error_light(self) -> FloatArray:
        """The same at the light torque, rad (Eq. 94)."""
        wheel = wheel_angle_of_input(self.model, self.light)
        return np.asarray(self.drive.output_deviation(wheel, self.drive.load.light_torque))

    @property
    def wind_up(self) -> FloatArray:
        """Angle of the output between light torque and torque, input held, shape (positions,), rad."""
        return np.abs(self.transmission_error - self.transmission_error_light)

    @property
    def stage_wind_up(self) -> FloatArray:
        """The same of the cycloid stage alone, cranks held, rad."""
        wound = self.full.pose[:, WHEEL_ANGLE] - self.light.pose[:, WHEEL_ANGLE]
        return np.asarray(np.abs(self.drive.output_deviation(wound, self.torque - self.drive.load.light_torque)))

    def stiffness_from_light(self, wound: FloatArray) -> float:
        """Return the torque from the light one on by the wind-up that it takes, where that is most, N·mm/rad.

        Not a number where nothing is wound up between the two, or no position has an answer.
        """
        known = wound[self.balanced & self.balanced_light]
        if not (known.size and np.all(known > 0.0)):
            return float("nan")
        return float(abs(self.torque - self.drive.load.light_torque) / np.max(known))

    @property
    def crank_lag(self) -> FloatArray:
        """Angle of the cranks less the one that the held input gives them, rad, shape (positions,)."""
        return crank_lag(self.model, self.full)

    @property
    def hole_words(self) -> str:
        """What to say beside the pressures of shaft pins and holes; nothing where the pins yield."""
        return hole_words(self.drive, rigid_shaft_pins=self.pressures.rigid_shaft_pins)

    @property
    def width_words(self) -> str:
        """What to say of bodies that contacts stand on: solid ones, or in slices those of the plane."""
        coefficients, slices = self.model.discs[0].coefficients, self.drive.contact.slices
        if coefficients is not None and coefficients.bodies == "solid":
            yielding = (
                "they yield under loads even along the width; contact.slices asks for loads linear along it as well"
                if slices == 1
                else "they yield under loads even and linear along the width, by an approach and a tilt of every contact"
            )
            return f"influence coefficients of the bodies are those of solids with their ends: {yielding}"
        if slices == 1 or coefficients is None:
            return ""
        return (
            "influence coefficients of the bodies are those of the plane: they yield evenly along the width under the loads of "
            "the slices, and not under their moments"
        )

    @property
    def warnings(self) -> list[str]:
        """What to know of drive and answer before they are used, one sentence each."""
        units = unit_warnings(self.as_written, self.torque)
        found = [*units, preload_warning(self.drive), self._lost_play()]
        found += [strength_warning(self.drive.materials), deep_seats_warning(self.drive)]
        found += coefficient_warnings(contacts.coefficients for contacts in self.model.discs)
        load = self.drive.load
        if not units and not load.leaves_out_light_torque and load.light_torque > self.torque > 0.0:
            found.append(
                f"load.light_torque = {load.light_torque:g} N·mm is more than the torque of {self.torque:g} N·mm "
                "that it is light against: are the two swapped, or is one in N·m?"
            )
        found.append(displacement_warning(self.drive.crank.eccentricity, self._yielding))
        found.append(steep_tilt_warning(self.model.coordinates, self.full, 0.5 * self.drive.disc.thickness))
        found += [wide_holes_warning(self.drive, self.pressures), unborne_warning(self.pressures)]
        if self.back is not None and np.any(lost := np.isnan(self.back.pose[self.balanced, 0])):
            found.append(
                f"with the motion reversed {np.count_nonzero(lost)} of {lost.size} positions have no equilibrium"
            )
        found += [
            run_off_warning(self.drive, self.pressures),
            few_slices_warning(self.drive.contact.slices, self.pressures),
            undivided_ends_warning(self.drive.contact.slices, self._solid, self.pressures),
        ]
        discs = self.discs if np.all(self.balanced) else ()
        for number, disc in enumerate(discs):
            (contacts,) = disc.model.discs
            if isinstance(contacts, HalfSpaceCompliance):
                of = "" if len(discs) == 1 else f"disc {number}: "
                told = separation_warning(contacts, disc.drive, disc.full, disc.pressures)
                found.append(None if told is None else of + told)
        return [warning for warning in found if warning is not None]

    @property
    def _solid(self) -> bool:
        """Whether the bodies are solid ones."""
        return any(one.coefficients is not None and one.coefficients.tilting is not None for one in self.model.discs)

    @property
    def _yielding(self) -> dict[str, tuple[str, FloatArray]]:
        """Displacements of what holds the contacts, mm, each with the field that says how it yields."""
        coordinates, shaft, found = self.model.coordinates, self.drive.pin_shaft, dict[str, tuple[str, FloatArray]]()
        bent = [pin_deflections(disc.drive, disc.model, disc.full) for disc in self.discs]
        for key, name in (("pin_deflection", "wheel"), ("shaft_pin_deflection", "shaft")):
            if key in bent[0]:
                field = f"pin_{name}.beam, materials.{name}_pin.youngs_modulus"
                found[f"{name} pins bend"] = field, np.stack([disc[key] for disc in bent])
        if shaft is not None and shaft.stiffness is not None:
            found["shaft pins yield"] = "pin_shaft.stiffness", self.full.response.hole_load / shaft.stiffness
        if coordinates.cranks:
            found["cranks yield"] = "crank.support", np.abs(self.crank_deflections)
        if (ring := self.ring_displacements) is not None:
            found["the ring of the wheel yields"] = "ring", np.abs(ring)
        if coordinates.wheel:
            wheel = self.full.pose[:, coordinates.wheel_place]
            field = "pin_wheel.support_stiffness" if self.drive.main_bearing is None else "main_bearing"
            found["the wheel moves"] = field, np.hypot(wheel[:, 0], wheel[:, 1])
        if self.model.flange is not None:
            x, y, turned = self.full.pose[:, coordinates.ring_place].T
            radius = loaded_circle(self.drive)
            found["the far flange moves"] = "carrier.posts", np.hypot(x, y) + radius * np.abs(turned)
        return found

    def _lost_play(self) -> str | None:
        """Which plays the warmth has taken."""
        return None if self.written is None else seizing_words(self.written)


def seizing_words(written: Drive) -> str | None:
    """Return which plays of a drive, as given with its temperatures, its warmth has taken; None where it has taken none."""
    if written.temperature is None:
        return None
    gone = lost_play(warm_drive(replace(written, temperature=Temperature())), warm_drive(written))
    return f"at {temperature_words(written.temperature)} {'; '.join(gone)}" if gone else None


def analyse(
    drive: Drive,
    crank_angle: FloatArray,
    torque: float | None = None,
    engine: Engine | None = None,
    near: LoadedAnalysis | None = None,
    case: _Case | None = None,
    known: tuple[Equilibrium, Equilibrium] | None = None,
) -> LoadedAnalysis:
    """Analyse a drive.

    Parameters
    ----------
    drive : Drive
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    torque : float, optional
        Output torque, N·mm; the drive's own by default.
    engine : Engine, optional
        What to run on (`ltca.analysis.engines`); the half-space on tables by default.
    near : LoadedAnalysis, optional
        Of nearly this drive at these angles: the search starts from its poses.
    case, known : optional
        The drive with the engine built for it, and its balanced positions under torque and light torque, where these are there
        already (`analyse_cases`).

    Returns
    -------
    LoadedAnalysis
        Loads, pressures, forces, poses.

    Raises
    ------
    ConvergenceError
        When a position does not balance; ``partial`` is the analysis of those that do.
    DriveError
        When angles or torque make no sense, or the torque cannot be carried: a half-width beyond 0.3 of the
        smallest radius.

    Examples
    --------
    >>> import numpy as np
    >>> from ltca.reading.drive_file import load_drive
    >>> result = analyse(load_drive("paper").cases["CS-1"], np.array([0.5]))
    >>> print(f"{result.bearing_tangential[0, 0, 0]:.0f} N")
    6738 N
    """
    angle = check_positions(crank_angle)
    case = _prepared(drive, torque, engine) if case is None else case
    with unit_mistakes_named(drive, torque):
        prepared, light_torque = case.prepared, case.drive.load.light_torque
        if case.torque == 0.0:
            named = "load.torque" if drive.load.torque == 0.0 else "torque"
            require_preload(prepared.model.geometries, case.drive, angle, named)

        begin = _poses_near(near, prepared.model)
        balance = partial(balance_what_can_be, prepared.balance, angle)
        full = balance(case.torque, begin) if known is None else all_balanced(known[0])
        pressures = prepared.model.pressures(full.found.response)
        try:
            check_half_widths([case.drive], full.found.response, pressures, case.torque)
        except OverloadError as error:
            seized = None if case.written is None else seizing_words(case.written)
            if seized is None:
                raise
            raise OverloadError([f"temperature: {seized}; {problem}" for problem in error.problems]) from error
        start = _poses_near(near, prepared.model, light=True)
        if start is None:
            start = np.full((angle.size, full.found.pose.shape[1]), np.nan)
            start[full.balanced] = full.found.pose
        light = full
        if light_torque != case.torque:
            light = balance(light_torque, start, full.found) if known is None else all_balanced(known[1])
        back = _turned_back(prepared.model, case.drive, full, angle, case.torque)
        if light.failure is not None and light is not full:
            light.failure.add(f"load.light_torque = {light_torque:g} N·mm")
        push = bearing_forces(prepared.model, angle[full.balanced], full.found.response)
        walls = _wall_stresses(prepared.model, full.found, pressures)
        spread = full.spread((full.found, pressures, push.real, push.imag, walls))
        of_full, of_pressures, radial, tangential, of_walls = freeze(
            (replace(spread[0], crank_angle=angle), *spread[1:])
        )
        analysis = LoadedAnalysis(
            drive=case.drive,
            torque=case.torque,
            engine=case.engine,
            full=of_full,
            light=freeze(replace(light.spread(light.found), crank_angle=angle)),
            model=prepared.model,
            pressures=of_pressures,
            bearing_radial=radial,
            bearing_tangential=tangential,
            wall_stresses=of_walls,
            balanced=freeze(full.balanced),
            balanced_light=freeze(light.balanced),
            back=None if back is None else freeze(back),
            written=case.written,
        )
        for failure in (full.failure, light.failure):
            if failure is not None:
                failure.partial = analysis
                raise failure
        return analysis


def analyse_cases(
    cases: Mapping[str, Drive],
    crank_angle: FloatArray,
    torque: float | None = None,
    engine: Engine | None = None,
    near: LoadedAnalysis | None = None,
) -> Iterator[tuple[str, LoadedAnalysis | ConvergenceError]]:
    """Analyse several drives as `analyse` does, those whose models agree in one batch.

    Parameters
    ----------
    cases : mapping of str to Drive
        Drives by name.
    crank_angle, torque, engine
        As for `analyse`.
    near : LoadedAnalysis, optional
        Of nearly these drives at these angles: the search starts from its poses.

    Yields
    ------
    str, LoadedAnalysis or ConvergenceError
        Name and analysis of each in their order; the error, with its ``partial``, where a position does not balance.

    Raises
    ------
    DriveError
        As `analyse` does.
    """
    angle, names = check_positions(crank_angle), list(cases)
    many = max(1, MAX_BATCH_POSITIONS // angle.size)
    for part in (names[first : first + many] for first in range(0, len(names), many)):
        prepared = [_prepared(cases[name], torque, engine) for name in part]
        for name, case, known in zip(part, prepared, _balanced_together(prepared, angle, near), strict=True):
            try:
                yield name, analyse(cases[name], angle, torque, engine, near, case, known)
            except ConvergenceError as error:
                yield name, error


@dataclass(frozen=True, slots=True, kw_only=True)
class _Case:
    """A drive at its temperatures, and as it was given where it has any, with its torque and the engine built for it."""

    drive: Drive
    written: Drive | None
    torque: float
    engine: Engine
    prepared: PreparedEngine


@names_unit_mistakes
def _prepared(drive: Drive, torque: float | None, engine: Engine | None) -> _Case:
    checked, used = check_torque(drive, torque), HalfSpace() if engine is None else engine
    warm = warm_drive(drive)
    written = None if drive.temperature is None else drive
    return _Case(drive=warm, written=written, torque=checked, engine=used, prepared=used.prepare(warm))


def _poses_near(near: LoadedAnalysis | None, model: Reducer, *, light: bool = False) -> FloatArray | None:
    """Poses of an analysis to start others from; None where the model has other coordinates, or one pose is not known."""
    if near is None or near.full.pose.shape[1] != model.coordinates.size:
        return None
    found, balanced = (near.light, near.balanced_light) if light else (near.full, near.balanced)
    return found.pose if np.all(balanced) else None


def _balanced_together(
    cases: Sequence[_Case], angle: FloatArray, near: LoadedAnalysis | None = None
) -> list[tuple[Equilibrium, Equilibrium] | None]:
    """Balance cases as rows of one batch at their torques and light torques; None for those to be balanced alone."""
    found: list[tuple[Equilibrium, Equilibrium] | None] = [None] * len(cases)
    groups: dict[Hashable, list[int]] = {}
    for number, case in enumerate(cases):
        if case.prepared.batches:
            groups.setdefault(batch_layout(case.prepared.model), []).append(number)
    for members in (group for group in groups.values() if len(group) > 1):
        drives = [cases[number].drive for number in members]
        model = stack_drives([cases[number].prepared.model for number in members], angle.size)
        angles = np.tile(angle, len(members))
        torques = np.repeat([cases[number].torque for number in members], angle.size)
        light = np.repeat([drive.load.light_torque for drive in drives], angle.size)
        start = _poses_near(near, model)
        try:
            states = solve_at_output(
                model, drives, angles, torques, None if start is None else np.tile(start, (len(members), 1))
            )
            lights = (
                states if np.array_equal(light, torques) else solve_at_output(model, drives, angles, light, states.pose)
            )
        except (ConvergenceError, DriveError):  # one by one they tell which and why
            continue
        for place, number in enumerate(members):
            rows = np.arange(place * angle.size, (place + 1) * angle.size)
            found[number] = take_positions(states, rows), take_positions(lights, rows)
    return found


def analysis_of(
    drive: Drive,
    torque: float,
    engine: Engine,
    model: Reducer,
    full: Equilibrium,
    light: Equilibrium,
    back: Equilibrium | None = None,
) -> LoadedAnalysis:
    """Return the analysis of a warm drive whose contacts are known at all positions, under all torques."""
    pressures, push = model.pressures(full.response), bearing_forces(model, full.crank_angle, full.response)
    everywhere = np.ones(full.crank_angle.shape, dtype=bool)
    return LoadedAnalysis(
        drive=drive,
        torque=torque,
        engine=engine,
        full=full,
        light=light,
        model=model,
        pressures=pressures,
        bearing_radial=push.real,
        bearing_tangential=push.imag,
        wall_stresses=_wall_stresses(model, full, pressures),
        balanced=everywhere,
        balanced_light=everywhere,
        back=back,
    )


def _turned_back(
    model: Reducer, drive: Drive, full: PartlyBalanced, angle: FloatArray, torque: float
) -> Equilibrium | None:
    """The positions of a drive with friction, its motion reversed."""
    friction = model.friction
    if friction is None:
        return None
    other, near = replace(model, friction=friction.reversed()), full.found
    found = balance_what_can_be(partial(solve_at_output, other, [drive]), near.crank_angle, torque, near.pose, near)
    of_these: Equilibrium = replace(found.spread(found.found), crank_angle=near.crank_angle)
    return replace(full.spread(of_these), crank_angle=angle)


def _wall_stresses(model: Reducer, full: Equilibrium, pressures: ContactPressures) -> tuple[WallStresses, ...]:
    count = len(model.discs)
    parts = zip(model.discs, full.response.parts, disc_pressures(pressures, count), strict=True)
    return tuple(
        wall_stresses(disc, response, own, full.pose[:, model.coordinates.columns(number)[DISC_ROTATION]])
        for number, (disc, response, own) in enumerate(parts)
        if disc.coefficients is not None
    )


def require_preload(
    discs: Sequence[ContactGeometry], drive: Drive, crank_angle: FloatArray, named: str = "load.torque"
) -> None:
    """Refuse positions at which nothing holds the discs without a torque, which field or argument `named` has left out.

    Where the output has a free play, or parts only just touch, no force says where discs and wheel stand. Where parts overlap in
    every pose and hold the wheel, they balance each other. Teeth of a first stage with backlash leave the output free beside the
    tightest discs: the moments of the cranks are round-off then, and tell no side.

    Raises
    ------
    DriveError
        Naming the torque and the play.
    """
    found = free_play(discs, crank_angle)
    stage = StageMesh.of_drive(drive)
    play = found.play if stage is None else found.play + stage.play(crank_angle)
    loose = np.flatnonzero(~(found.preloaded & (play * drive.reduction_ratio < HELD_PLAY)))
    if not loose.size:
        return
    row = loose[int(np.argmax(play[loose]))]
    played = abs(drive.output_per_wheel_angle) * float(play[row]) * ARCMIN
    told = f"has a free play of {played:.3g}′" if played > 0.0 else "is held by parts that only just touch"
    said = (
        f"must be greater than 0: without a torque the output {told} at crank angle {crank_angle[row]:.6g} rad "
        f"({loose.size} of {crank_angle.size} positions), and nothing says where discs and wheel stand; drives whose parts "
        "hold each other everywhere, such as with pins that are too thick, are answered"
    )
    raise DriveError([Problem.of(named, "= 0 N·mm", said, bound=("greater than", 0.0))])


def check_positions(crank_angle: FloatArray) -> FloatArray:
    """Return crank angles as a new array of one axis, rad.

    Raises
    ------
    DriveError
        When there is none, or one is no finite number.
    """
    try:
        given = np.array(crank_angle, ndmin=1)
    except (TypeError, ValueError) as error:
        raise DriveError([f"crank_angle = {shortened(crank_angle)}: must be numbers in rad"]) from error
    if given.size and given.dtype.kind not in "iuf":
        raise DriveError([f"crank_angle = {shortened(crank_angle)}: must be numbers in rad"])
    angle = given.astype(float)
    if angle.ndim != 1 or angle.size == 0:
        raise DriveError([f"crank_angle has the shape {angle.shape}: must be one row of at least one angle in rad"])
    if not np.all(np.isfinite(angle)):
        raise DriveError([f"crank_angle holds {angle[~np.isfinite(angle)][0]:g}: must be finite, in rad"])
    largest = range_of("rad")[1]
    if np.max(np.abs(angle)) > largest:
        raise DriveError([f"crank_angle holds {np.max(np.abs(angle)):g}: must be at most {largest:g} rad in size"])
    return angle


def check_torque(drive: Drive, torque: float | None) -> float:
    """Return the output torque asked for, the drive's own for None, N·mm.

    Raises
    ------
    DriveError
        When it is not a finite number of at least zero, or too small to be balanced.
    """
    if torque is None:
        return drive.load.torque
    if isinstance(torque, bool) or not isinstance(torque, int | float | np.number):
        raise DriveError([f"torque = {torque!r}: must be a number in N·mm"])
    smallest, largest = range_of("N*mm")
    try:
        number = float(torque)
    except OverflowError:
        number = np.inf
    if not (np.isfinite(number) and number >= 0.0):
        raise DriveError([f"torque = {number:g}: must be finite and at least 0 N·mm (load.direction turns it)"])
    if number and not smallest <= number <= largest:
        raise DriveError([f"torque = {number:g}: must be from {smallest:g} to {largest:g} N·mm"])
    if problems := [*torque_problem(drive, "torque", number, zero=True)]:
        raise DriveError(problems)
    return number
