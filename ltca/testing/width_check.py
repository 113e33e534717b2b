"""Check of an equilibrium of contacts in slices by the loads of their slices, in six directions per disc.

Independent of `ltca.geometry`, `ltca.compliance`, `ltca.equilibrium`, `ltca.laws.sliced_line` and `ltca.beam`: axes are
lines in space that stand inclined, lean with their bodies and are displaced by the forces of the answer (beams and shafts by the
theorem of unit loads). At the height z of every point of a slice the section of the disc stands where its lean brings it and the
pin where its axis crosses; normal and lever arm there are those of these two sections, without any derivative of the middle. From
the answer come the pose, the line loads, and the places and leans of the rollers.

Checked are the forces along x and y and the moments about x, y and z of every disc; along z nothing presses without friction.
Then rollers in force and moment, journals, pins, the ring that ties their tips and the wheel on its bearing; and that every line
load belongs to its gap (`ltca.testing.slice_law`).

The model is linear in tilts: a gap grows by θ along the width, δ + θ z, and what presses on bodies are the derivatives of the
energy of such gaps. Sections as they stand tell more: normals turn along the width by n' z + n'' z²/2 …, of which the
derivatives of the energy have n' in the forces, Σ q (n + n' z), and n alone in the couples, Σ q z n. What sections have beyond
that, Σ q (n(z) − n − n' z) and Σ q z (n(z) − n), is summed here from n(z) itself and taken off, so that what is left is to vanish
to Newton's tolerance at any tilt; how much it is, `WidthCheck.left_out` tells: an error of the model, no imbalance. Leans
themselves are small rotations, by which sections stay circles and heights heights: the square of leans is left out on both sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.contact.free_end import FreeEnds
from ltca.drive.members.pins import PinShaft, PinWheel
from ltca.drive.parts import Drive, LengthProfile, Material
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.testing.actual_parts import ActualParts, DeviatedFlank, disc_own
from ltca.testing.bearing_springs import SidedSpring, crank_springs, wheel_rows, wheel_spring
from ltca.testing.first_stage_check import outside_on_wheel
from ltca.testing.slice_law import plane_approach, pressed_in
from ltca.testing.yielding_pins import beam_stiffness, has_ring

POINTS = 4
"""Points of a slice (Gauss)."""
FORCES = 1e-8
"""What may be left of forces, by the load of the drive, and of couples by it times half the width: ten times what Newton's method
leaves (`ltca.equilibrium.newton.TOLERANCE`), beside `ROUND_OFF` of every gap times the stiffness of its contact."""
ROUND_OFF = 1e-13
"""Of places, by the radius of the pin circle: some ten terms of a few units of round-off each (2e-16), and displacements of
beams, a hundredth of the circle at most, from matrices that lose up to four digits."""
GAPS = 5e-6
"""What may be left of an approach, by the largest of its contact: the kernels of `ltca.testing.slice_law` and of the laws are
interpolated to 1e-6 of it each, and what slices press in by differences to 1e-10 of the largest load; effective radii, of whose
error an approach takes a twentieth, are known to 1e-5, the round-off of second derivatives."""


@dataclass(frozen=True)
class Lines:
    """Straight axes near the plane of a disc: x + iy in the plane, mm, and by height, rad, shape (parts,)."""

    at: ComplexArray
    lean: ComplexArray

    def points(self, z: FloatArray) -> ComplexArray:
        """Return x + iy at heights, shape (heights, parts)."""
        return np.asarray(self.at + z[:, None] * self.lean)


@dataclass(frozen=True)
class Pressed:
    """Forces on the disc along the width of contacts.

    Attributes
    ----------
    force : array of complex, shape (parts,)
        On the disc, N.
    couple : array of complex, shape (parts,)
        Their moments about x and y: Σ z times the force at z, N·mm.
    turning : array, shape (parts,)
        Moment about z at the centre of the disc, N·mm.
    """

    force: ComplexArray
    couple: ComplexArray
    turning: FloatArray

    def __sub__(self, other: Pressed) -> Pressed:
        """What is between two sums."""
        return Pressed(self.force - other.force, self.couple - other.couple, self.turning - other.turning)


@dataclass(frozen=True)
class Taken:
    """What bodies that yield take off approaches, mm, and off tilts, rad, each of wheel pins, bores, shaft pins and races."""

    approach: tuple[FloatArray, FloatArray, FloatArray, FloatArray]
    tilt: tuple[FloatArray, FloatArray, FloatArray, FloatArray]

    def at(self, kind: int, z: FloatArray) -> FloatArray:
        """Return what is taken of one kind at heights, shape (parts, heights)."""
        return np.asarray(self.approach[kind][:, None] + np.outer(self.tilt[kind], z))


@dataclass(frozen=True)
class Left:
    """Something that should vanish, and what may be left of it."""

    what: str
    left: float
    bound: float
    unit: str

    def __str__(self) -> str:
        """Both in a line."""
        return f"{self.what}: {self.left:.3g} {self.unit} beside {self.bound:.3g} {self.unit}"


class Disc:
    """One disc of an answer: places of its parts and what presses on it.

    Parameters
    ----------
    check : WidthCheck
        The whole.
    number : int
        Number of the disc.
    """

    def __init__(self, check: WidthCheck, number: int) -> None:
        drive, pose = check.drive, check.pose
        self.check, self.drive, self.number = check, drive, number
        self.plane = float(np.asarray(drive.disc.disc_planes)[number])
        self.parts = ActualParts(drive, check.crank_angle, number)
        self.answer: Any = check.balanced.response.parts[number]
        own = pose[check.own * number : check.own * (number + 1)]
        # Displacements count from where the cranks' axes cross the plane.
        self.centre = self.parts.place + self.plane * _lean(drive.crank.inclination) + complex(own[0], own[1])
        self.turn = complex(np.exp(1j * own[2]))
        self.lean = complex(own[-2], own[-1])
        cranks = drive.crank.number
        self.displaced, self.sloped = np.zeros(cranks, dtype=complex), np.zeros(cranks, dtype=complex)
        self.twist = np.zeros(cranks)
        if drive.crank.support is not None:
            first = 3 + (3 if drive.crank.support.torsion else 2) * cranks
            self.displaced = own[3 : 3 + 2 * cranks : 2] + 1j * own[4 : 4 + 2 * cranks : 2]
            if drive.crank.support.torsion:
                self.twist = own[3 + 2 * cranks : first]
            self.sloped = own[first : first + 2 * cranks : 2] + 1j * own[first + 1 : first + 1 + 2 * cranks : 2]

    def heights(self, length: float) -> tuple[FloatArray, FloatArray]:
        """Heights of the points of the slices of a line and their weights, mm, slice after slice."""
        nodes, weights = np.polynomial.legendre.leggauss(POINTS)
        n = self.drive.contact.slices
        edges = np.linspace(-0.5 * length, 0.5 * length, n + 1)
        half = 0.5 * length / n
        middle = 0.5 * (edges[1:] + edges[:-1])
        return (middle[:, None] + half * nodes).ravel(), np.tile(half * weights, n)

    @cached_property
    def wheel_pins(self) -> Lines:
        """Axes of the wheel pins as they stand, bent."""
        wheel, check = self.drive.pin_wheel, self.check
        centres, _ = self.parts.wheel_pins
        turned = check.wheel_turn
        own = _leans(wheel.pin_errors, centres.size)
        bent, sloped = check.bent_wheel_pins[self.number]
        axis = self.parts.wheel_axis + self.plane * _lean(wheel.inclination)
        axis += check.wheel_place + self.plane * check.wheel_lean
        turning = np.exp(1j * check.pose[-1])
        return Lines(
            at=axis + centres * turning + (self.plane * own + bent) * turned,
            lean=_lean(wheel.inclination) + check.wheel_lean + (own + sloped) * turned,
        )

    @cached_property
    def shaft_pins(self) -> Lines:
        """Axes of the shaft pins as they stand, bent."""
        shaft = self.drive.pin_shaft
        assert shaft is not None
        places, _ = self.parts.shaft_pins
        lean = _lean(shaft.inclination) + _leans(shaft.pin_errors, places.size)
        bent, sloped = self.check.bent_shaft_pins[self.number]
        return Lines(at=places + self.plane * lean + bent, lean=lean + sloped)

    @cached_property
    def on_flank(self) -> tuple[tuple[Pressed, Pressed], FloatArray, FloatArray]:
        """What wheel pins press, the gaps at the points, mm, shape (pins, points), and effective radii."""
        line, length = self.answer.leaning_pins.contact.line_load[self.check.position], self.drive.disc.thickness
        load = line.reshape(line.shape[0], -1)
        z, weights = self.heights(length)
        section, (_, radii) = self._seen(self.wheel_pins, np.append(z, 0.0)), self.parts.wheel_pins
        flank = DeviatedFlank(self.drive, self.number)
        reach = 2.0 * float(np.max(np.abs(section - section[-1]))) + 1e-3 * float(radii[0])
        # Height by height: pieces of the flank about a pin are as wide as it moves.
        each = [flank.contacts(points[None], radii, reach) for points in section]
        normal = -np.stack([one[2][0] for one in each])
        there, effective, _ = each[-1]
        # Gaps grow linearly along the width in the model: the square of tilt across the normal is left out.
        seen = (self.wheel_pins.lean - self.lean) * np.conj(self.turn)
        slope = (np.conj(normal[-1]) * seen).real
        gap = there[0] + z[:, None] * slope - self.lead(z)[:, None]
        gap -= _fallen(self.drive.pin_wheel.pin_profile, z, length, self.drive.pin_wheel.pin_radius)[:, None]
        # Of the path of the centre of a pin that keeps its distance from the flank.
        flank_bend = 1.0 / effective - 1.0 / radii
        bend = flank_bend / (1.0 + flank_bend * (radii - there[0]))
        turned = -bend * 1j * normal[-1] * (np.conj(1j * normal[-1]) * seen).real
        return self._pressed(normal, load.T * weights[:, None], section, z, turned), gap.T, effective

    @cached_property
    def in_holes(self) -> tuple[tuple[Pressed, Pressed], FloatArray] | None:
        """What shaft pins press, and the gaps at the points, mm, shape (pins, points)."""
        if self.drive.pin_shaft is None:
            return None
        line = self.answer.leaning_holes.contact.line_load[self.check.position]
        load = line.reshape(line.shape[0], -1)
        z, weights = self.heights(self.drive.disc.thickness)
        holes, hole_radii = self.parts.holes
        _, radii = self.parts.shaft_pins
        errors = disc_own(self.drive, self.number, "hole_errors", self.drive.disc.hole_errors)
        inclined = _leans(errors, holes.size)
        heights = np.append(z, 0.0)
        pin = self._seen(self.shaft_pins, heights)
        apart = pin - holes - heights[:, None] * inclined
        normal, middle = apart / np.abs(apart), np.abs(apart[-1])
        seen = (self.shaft_pins.lean - self.lean) * np.conj(self.turn) - inclined
        gap = middle - (hole_radii - radii) + z[:, None] * (np.conj(normal[-1]) * seen).real
        turned = 1j * normal[-1] * (np.conj(1j * normal[-1]) * seen).real / middle
        return self._pressed(normal, load.T * weights[:, None], pin, z, turned), gap.T

    def _seen(self, lines: Lines, z: FloatArray) -> ComplexArray:
        """Points of axes at heights in the section of the disc there, shape (heights, parts)."""
        return np.asarray((lines.points(z) - self.centre - z[:, None] * self.lean) * np.conj(self.turn))

    def _pressed(
        self, normal: ComplexArray, load: FloatArray, point: ComplexArray, z: FloatArray, turned: ComplexArray
    ) -> tuple[Pressed, Pressed]:
        """Sums of loads along normals in the frame of the disc, at points there, as they are in the fixed frame.

        Normals and points are those at the heights and, last, in the middle, where normals turn by `turned` per height. Second
        comes what the sums have that is no derivative of the energy of gaps which grow linearly along the width, δ + θ z: forces
        of the square and couples of the first power of what normals turn by along it.
        """
        push, middle, arm = normal[:-1] * load, normal[-1], point[-1]
        total, tilting = load.sum(axis=0), (z[:, None] * load).sum(axis=0)
        arm_turned = (point[:-1] - arm)[-1] / z[-1]
        exact = Pressed(
            force=push.sum(axis=0) * self.turn,
            couple=(z[:, None] * push).sum(axis=0) * self.turn,
            turning=(np.conj(point[:-1]) * push).imag.sum(axis=0),
        )
        linear = Pressed(
            force=(total * middle + tilting * turned) * self.turn,
            couple=tilting * middle * self.turn,
            turning=(np.conj(arm) * (total * middle + tilting * turned) + np.conj(arm_turned) * tilting * middle).imag,
        )
        return exact, exact - linear

    def lead(self, z: FloatArray) -> FloatArray:
        """By how much the flank falls short, mm."""
        disc = self.drive.disc
        slope, crown, length, depth = (
            disc_own(self.drive, self.number, name, getattr(disc, name))
            for name in ("lead_slope", "lead_crown_drop", "lead_relief_length", "lead_relief_depth")
        )
        half = 0.5 * disc.thickness
        found = -slope * z + crown * (z / half) ** 2
        if length and depth:
            found = found + depth * (np.maximum(np.abs(z) - half + length, 0.0) / length) ** 2
        return np.asarray(found)

    @cached_property
    def of_rollers(self) -> dict[str, Any]:
        """Rollers crank after crank: gaps, forces on disc and race with their couples, and what is left of them."""
        check, drive = self.check, self.drive
        state, row = self.answer.rollers, check.position
        ray, radii = self.parts.rollers
        inner_race, bore = self.parts.races
        length, cranks = drive.roller_length, drive.crank.number
        z, _ = self.heights(length)
        found: dict[str, Any] = {"gap": [], "radius": [], "load": [], "left": [], "force": [], "couple": []}
        found["left out"] = found["crank"] = 0.0
        turning, each = 0.0, ray.size
        leaning = state.leaning
        inner_slices, outer_slices = leaning.inner.slice_load[row], leaning.outer.slice_load[row]
        for crank in range(cranks):
            own = slice(crank * each, (crank + 1) * each)
            eccentric = self.parts.eccentrics[crank] * (np.exp(1j * self.twist[crank]) - 1.0)
            race = self.parts.race_centres[crank] + eccentric + self.displaced[crank]
            race += self.plane * _lean(drive.crank.inclination)
            race_lean = self.sloped[crank] + _lean(drive.crank.inclination)
            in_bore = self.centre + self.parts.bores[crank] * self.turn
            place = inner_race + radii - state.inner_approach[row, own]
            lean = np.where(state.outer_load[row, own] > 0.0, leaning.lean[row, own], 0.0)
            arm = race + place * ray - in_bore
            normal = arm / np.abs(arm)
            pressed_inner = state.inner_approach[row, own][:, None] - np.outer(
                lean - (np.conj(ray) * race_lean).real, z
            )
            tilted = lean - (np.conj(ray) * self.lean).real
            pressed_outer = (np.abs(arm) - (bore - radii))[:, None] + np.outer(tilted, z)
            profile = drive.crank_bearing.roller_profile
            fallen = _fallen(profile, z, length, drive.crank_bearing.roller_radius)
            pressed_inner, pressed_outer = pressed_inner - fallen, pressed_outer - fallen
            # A free roller stands and leans as it likes: what is left between race and bore along its ray is open.
            moved, play = in_bore - race, bore - radii
            touching = (np.conj(ray) * moved).real + np.sqrt(play**2 - (np.conj(ray) * moved).imag ** 2)
            between = (inner_race + radii - touching)[:, None]
            between = 0.5 * (between + np.outer((np.conj(ray) * (race_lean - self.lean)).real, z)) - fallen
            if check.taken is not None:
                in_bore_taken, on_race_taken = (check.taken(self).at(kind, z)[own] for kind in (1, 3))
                pressed_inner, pressed_outer = pressed_inner - on_race_taken, pressed_outer - in_bore_taken
                between = between - 0.5 * (in_bore_taken + on_race_taken)
            free = (state.outer_load[row, own] <= 0.0)[:, None]
            found["gap"].append((np.where(free, between, pressed_inner), np.where(free, between, pressed_outer)))
            found["radius"].append((1.0 / (1.0 / radii + 1.0 / inner_race), 1.0 / (1.0 / radii - 1.0 / bore)))
            found["load"].append((inner_slices[own], outer_slices[own]))
            inner, outer = inner_slices[own].sum(axis=1), outer_slices[own].sum(axis=1)
            middle = inner - outer * (np.conj(ray) * normal).real
            found["left"].append((middle, leaning.inner.moment[row, own] - leaning.outer.moment[row, own]))
            # Rollers lean along their rays in the model, and so do the couples that belong to their gaps.
            force = (outer * normal).sum()
            couple = (leaning.outer.moment[row, own] * ray).sum()
            found["force"].append(force)
            found["couple"].append(couple)
            # By the angle of the crank the race moves and the cage turns with its rays.
            speed = inner_race / (inner_race + self.drive.crank_bearing.outer_race_radius)
            turned = 1j * self.parts.eccentrics[crank] * np.exp(1j * self.twist[crank]) + speed * 1j * place * ray
            found["crank"] += float((outer * (np.conj(normal) * turned).real).sum())
            seen = (np.conj(1j * ray) * (race_lean - self.lean)).real
            found["crank"] += float(speed * (leaning.outer.moment[row, own] * seen).sum())
            # In the bore they press along its normals.
            found["left out"] += float((np.abs(leaning.outer.moment[row, own]) * np.abs(normal - ray)).sum())
            turning += float((np.conj(self.parts.bores[crank] * self.turn) * force).imag)
        found["turning"] = turning
        return found


class WidthCheck:
    """An answer of contacts in slices at a position, and what displaces its members.

    Parameters
    ----------
    drive : Drive
        The drive with its deviations.
    model : Reducer
        Of half-spaces on tables, for the moduli of its contacts.
    balanced : Equilibrium
        The answer.
    position : int
        Number of the position.
    taken : callable, optional
        Returns what the bodies of a disc take of its contacts, as known from elsewhere; rigid ones take nothing.
    """

    def __init__(
        self,
        drive: Drive,
        model: Reducer,
        balanced: Equilibrium,
        position: int,
        taken: Callable[[Disc], Taken] | None = None,
    ) -> None:
        self.drive, self.model, self.balanced, self.position, self.taken = drive, model, balanced, position, taken
        self.pose, self.crank_angle = balanced.pose[position], float(balanced.crank_angle[position])
        support = drive.crank.support
        per_crank = 0 if support is None else (5 if support.torsion else 4)
        self.own = 5 + per_crank * drive.crank.number
        self.discs = drive.disc.number_of_discs
        at = self.own * self.discs
        self.wheel_place, self.wheel_lean = 0j, 0j
        if wheel_spring(drive) is not None:
            self.wheel_place, at = complex(self.pose[at], self.pose[at + 1]), at + 2
        if drive.wheel_tilts:
            self.wheel_lean, at = complex(self.pose[at], self.pose[at + 1]), at + 2
        self.ring = self.pose[at : at + 3] if has_ring(drive) else None
        ideal = self.crank_angle * drive.tooth_number_difference / drive.pin_wheel.number_of_pins
        self.wheel_turn = complex(np.exp(1j * (ideal + self.pose[-1])))

    @cached_property
    def each(self) -> list[Disc]:
        """The discs."""
        return [Disc(self, number) for number in range(self.discs)]

    def _on_pins(self, name: str) -> ComplexArray:
        """Forces, then couples of all discs on pins, as the answer has them, shape (2 discs, pins)."""
        parts, wheel = self.balanced.response.parts, self.drive.pin_wheel.number_of_pins
        every = np.stack(
            [part.pin_forces[self.position] for part in parts] + [part.pin_moments[self.position] for part in parts]
        )
        return every[:, :wheel] if name == "wheel" else every[:, wheel:]

    def _bent(
        self, name: str, part: PinWheel | PinShaft, material: Material
    ) -> list[tuple[ComplexArray, ComplexArray]]:
        stiffness, force = beam_stiffness(self.drive, part, material, slopes=True), self._on_pins(name)
        count = 2 * self.discs
        if stiffness is None:
            return [(np.zeros(force.shape[1], dtype=complex),) * 2 for _ in range(self.discs)]
        if name == "wheel":
            force = force * np.conj(self.wheel_turn)
        if stiffness.shape[0] > count:
            force = force - stiffness[:count, count:] @ self._tips[None]
        moved = np.linalg.solve(stiffness[:count, :count], force)
        return [(moved[disc], moved[self.discs + disc]) for disc in range(self.discs)]

    @cached_property
    def _tips(self) -> ComplexArray:
        places, _ = ActualParts(self.drive, 0.0).shaft_pins
        if self.ring is None:
            return np.zeros(places.size, dtype=complex)
        return np.asarray(self.ring[0] + 1j * self.ring[1] + 1j * self.ring[2] * places)

    @cached_property
    def bent_wheel_pins(self) -> list[tuple[ComplexArray, ComplexArray]]:
        """Displacements and slopes of the wheel pins at the discs, in the turning wheel."""
        return self._bent("wheel", self.drive.pin_wheel, self.drive.materials.wheel_pin)

    @cached_property
    def bent_shaft_pins(self) -> list[tuple[ComplexArray, ComplexArray]]:
        """Displacements and slopes of the shaft pins at the discs."""
        assert self.drive.pin_shaft is not None
        return self._bent("shaft", self.drive.pin_shaft, self.drive.materials.shaft_pin)

    def problems(self, torque: float | None) -> list[str]:
        """Return what does not hold."""
        return [str(each) for each in self.measured(torque) if not each.left <= each.bound]

    def measured(self, torque: float | None) -> list[Left]:
        """Return all that should vanish, with its bound."""
        drive, found = self.drive, list[Left]()
        half, lever = 0.5 * drive.disc.thickness, self.lever

        def told(what: str, left: float, bound: float, unit: str) -> None:
            found.append(Left(what, float(left), float(bound), unit))

        for disc in self.each:
            name = f"disc {disc.number}"
            pressed, gap, radius = disc.on_flank
            kinds = [pressed, *([] if disc.in_holes is None else [disc.in_holes[0]])]
            rollers = disc.of_rollers
            force = sum(one.force.sum() for one, _ in kinds) + sum(rollers["force"])
            couple = sum(one.couple.sum() for one, _ in kinds) + sum(rollers["couple"])
            turning = sum(one.turning.sum() for one, _ in kinds) + rollers["turning"]
            for _, steep in kinds:
                force, couple, turning = (
                    force - steep.force.sum(),
                    couple - steep.couple.sum(),
                    turning - steep.turning.sum(),
                )
            bound = self.known
            told(f"{name}: forces along x and y left", abs(force), bound, "N")
            told(f"{name}: moments about x and y left", abs(couple), bound * half, "N·mm")
            told(f"{name}: moment about z left", abs(turning), bound * lever, "N·mm")
            pushed = -np.concatenate([one.force - steep.force for one, steep in kinds])
            off = _most(pushed - disc.answer.pin_forces[self.position])
            told(f"{name}: force on a pin beside what presses on the disc", off, bound, "N")
            tilted = -np.concatenate([one.couple - steep.couple for one, steep in kinds])
            off = _most(tilted - disc.answer.pin_moments[self.position])
            told(f"{name}: moment on a pin beside what presses on the disc", off, bound * half, "N·mm")
            if self.taken is not None:
                gap = gap - self.taken(disc).at(0, disc.heights(drive.disc.thickness)[0])
            self._laws(disc, gap, radius, told, name)
            for force_left, moment_left in rollers["left"]:
                told(f"{name}: force left on a roller", _most(force_left), bound, "N")
                told(f"{name}: moment left on a roller", _most(moment_left), bound * half, "N·mm")
        self._members(told, torque)
        return found

    @property
    def left_out(self) -> tuple[float, float]:
        """What linear tilts leave out on the disc where it is most: of forces, by the loads of its pins and that of the drive,
        and of moments about x and y, by these times half the width.
        """
        forces, moments = [], []
        for disc in self.each:
            kinds = [disc.on_flank[0], *([] if disc.in_holes is None else [disc.in_holes[0]])]
            carried = self.load + sum(float(np.abs(one.force).sum()) for one, _ in kinds)
            forces.append(sum(float(np.abs(steep.force).sum()) for _, steep in kinds) / carried)
            beside = disc.of_rollers["left out"] + sum(float(np.abs(steep.couple).sum()) for _, steep in kinds)
            moments.append(beside / (0.5 * self.drive.disc.thickness * carried))
        return max(forces), max(moments)

    @property
    def lever(self) -> float:
        """Lever of a load of the drive, mm."""
        return self.drive.crank.eccentricity * float(self.drive.reduction_ratio)

    @property
    def load(self) -> float:
        """Load of the drive, T/(e z_P), N."""
        return abs(float(self.balanced.wheel_moment[self.position])) / self.lever

    @cached_property
    def known(self) -> float:
        """How well forces are known, N: Newton's method leaves some on any disc, and gaps are known to round-off."""
        row, total = self.position, 0.0
        # E* L bounds the stiffness of a line that is longer than wide; a roller has two in series.
        softer = 0.5 * min(contact_moduli(self.drive)[name] for name in ("inner", "outer")) * self.drive.roller_length
        for disc in self.each:
            answer = disc.answer
            stiffness = softer * int((answer.rollers.outer_load[row] > 0.0).sum())
            for pairs in (answer.leaning_pins, answer.leaning_holes):
                stiffness += float(pairs.contact.by_approach[row].sum())
            carried = self.load + float(answer.pin_load[row].sum() + answer.hole_load[row].sum())
            total += FORCES * carried + ROUND_OFF * self.drive.pin_wheel.pin_circle_radius * stiffness
        return total

    def _laws(self, disc: Disc, gap: FloatArray, radius: FloatArray, told: Any, name: str) -> None:
        """Whether line loads belong to gaps."""
        parts, row, drive = contact_moduli(self.drive), self.position, self.drive
        thick, long = drive.disc.thickness, drive.roller_length
        rounding = ROUND_OFF * drive.pin_wheel.pin_circle_radius
        pins, holes = disc.answer.leaning_pins.contact, disc.answer.leaning_holes.contact
        # Of loose pins and sleeves gaps are those of both sides of the seat.
        if drive.pin_wheel.seat.kind == "fixed":
            ends = self._free_ends(disc.number, "pins")
            off = _off(pins.line_load[row], pins.slice_load[row], gap, thick, parts["flank"], radius, rounding, ends)
            told(f"{name}: gap of a wheel pin beside its line load", off, GAPS, "of its approach")
        if disc.in_holes is not None and drive.pin_shaft is not None and drive.pin_shaft.seat.kind == "fixed":
            law: Any = self.model.discs[disc.number].hole_law  # type: ignore[attr-defined]
            line, there = holes.line_load[row], disc.in_holes[1]
            if self.taken is not None:
                there = there - self.taken(disc).at(2, disc.heights(thick)[0])
            if hasattr(law, "contact_modulus"):
                _, radii = disc.parts.shaft_pins
                effective = 1.0 / (1.0 / radii - 1.0 / disc.parts.holes[1])
                ends = self._free_ends(disc.number, "holes")
                off = _off(line, holes.slice_load[row], there, thick, law.contact_modulus, effective, rounding, ends)
            else:
                assert drive.pin_shaft is not None
                assert drive.pin_shaft.stiffness is not None
                given = np.maximum(there, 0.0) * drive.pin_shaft.stiffness / thick
                differs = _most(given - line.reshape(given.shape)) - rounding * drive.pin_shaft.stiffness / thick
                off = max(differs, 0.0) / max(float(line.max(initial=0.0)), 1e-30)
            told(f"{name}: line load of a shaft pin beside its gap", off, GAPS, "of the largest")
        for gaps, radii, loads in zip(*(disc.of_rollers[key] for key in ("gap", "radius", "load")), strict=True):
            for kind, where in enumerate(("on the race", "in the bore")):
                modulus = parts["inner" if kind == 0 else "outer"]
                ends = self._free_ends(disc.number, "inner" if kind == 0 else "outer")
                off = _off(None, loads[kind], gaps[kind], long, modulus, radii[kind], rounding, ends)
                told(f"{name}: load of a slice of a roller {where} beside its gap", off, GAPS, "of the largest")

    def _free_ends(self, number: int, kind: str) -> tuple[FreeEnds, ...]:
        """Of the bodies of a kind of contacts of a disc; half-spaces where the model knows no ends."""
        near: Any = getattr(self.model.discs[number], "contacts", None)
        return () if near is None else getattr(near.kinds, kind).free_ends

    def _members(self, told: Any, torque: float | None) -> None:
        """Journals, wheel, ring of tips and the torque of the output."""
        drive, planes = self.drive, np.asarray(self.drive.disc.disc_planes)
        half = 0.5 * drive.disc.thickness
        moment = float(self.balanced.wheel_moment[self.position])
        for crank in range(drive.crank.number):
            force = -np.array([disc.of_rollers["force"][crank] for disc in self.each])
            couple = -np.array([disc.of_rollers["couple"][crank] for disc in self.each])
            if drive.crank.support is None:
                continue
            stands = np.concatenate(
                [[disc.displaced[crank] for disc in self.each], [disc.sloped[crank] for disc in self.each]]
            )
            counted = np.repeat([1.0, half], self.discs)
            moved, beyond = _shaft(drive, np.concatenate((force, couple)), stands, counted, self.known)
            size = float(np.max(np.abs(counted * stands)))
            bound = FORCES * size + ROUND_OFF * drive.pin_wheel.pin_circle_radius
            told(f"crank {crank}: a bearing without load out of its clearance", beyond, bound, "mm")
            off = _most(counted * (moved - stands))
            told(f"crank {crank}: displacement or slope of a journal off", off, bound, "mm")
        outside, tilting = outside_on_wheel(drive, self.crank_angle), self._tilting_outside()
        flanks = [one - steep for one, steep in (disc.on_flank[0] for disc in self.each)]
        wheel = np.array([-one.force.sum() for one in flanks])
        couples = np.array([-one.couple.sum() for one in flanks])
        bound = self.known
        lean = (planes * wheel).sum() + couples.sum() + tilting
        held, against = self._wheel_bearing()
        if held is not None:
            told("force left on the wheel", abs(wheel.sum() + outside - held), bound, "N")
        if drive.wheel_tilts:
            arm = half + float(np.max(np.abs(planes)))
            told("moments about x and y left on the wheel", abs(lean - against), bound * arm, "N·mm")
        turning = 0.0
        for disc, pressed in zip(self.each, flanks, strict=True):
            axis = disc.parts.wheel_axis + disc.plane * (_lean(drive.pin_wheel.inclination) + self.wheel_lean)
            axis += self.wheel_place
            # About the axis of the wheel, from which that of the disc departs along the width.
            apart = np.conj(disc.lean - self.wheel_lean - _lean(drive.pin_wheel.inclination))
            turning -= float(pressed.turning.sum() + (np.conj(disc.centre - axis) * pressed.force.sum()).imag)
            turning -= float((apart * pressed.couple.sum()).imag)
        told("moment about its axis left on the wheel", abs(turning + moment), bound * self.lever, "N·mm")
        if self.ring is not None and drive.posts is None:
            self._floating_ring(told, bound)
        if torque is not None and (drive.crank.number == 1 or not drive.wheel_is_held):
            output = drive.driving_sign * torque
            left = moment + output
            if drive.wheel_is_held:
                left += sum(disc.of_rollers["crank"] for disc in self.each)
                # Forces from outside turn where they press the displaced wheel, which leans.
                left += (np.conj(self.wheel_place) * outside + np.conj(self.wheel_lean) * tilting).imag
            told("torque of the output off", abs(left), bound * self.lever, "N·mm")

    def _floating_ring(self, told: Any, bound: float) -> None:
        """Forces of the tips on the ring, which nothing else holds."""
        drive, count = self.drive, 2 * self.discs
        assert drive.pin_shaft is not None
        stiffness = beam_stiffness(drive, drive.pin_shaft, drive.materials.shaft_pin, slopes=True)
        assert stiffness is not None
        bent = np.stack([one[0] for one in self.bent_shaft_pins] + [one[1] for one in self.bent_shaft_pins])
        tips = (stiffness[count:, :count] @ bent + stiffness[count:, count:] @ self._tips[None])[0]
        places, _ = ActualParts(drive, 0.0).shaft_pins
        turning = float((np.conj(places) * tips).imag.sum())
        told("force left on the ring of the tips", abs(tips.sum()), bound, "N")
        told("moment left on the ring of the tips", abs(turning), bound * float(np.abs(places[0])), "N·mm")

    def _wheel_bearing(self) -> tuple[complex | None, complex]:
        """Force that the main bearing carries, N, and what presses its lean, N·mm."""
        drive, spring = self.drive, wheel_spring(self.drive)
        bearing = drive.main_bearing
        if spring is None:
            return None, 0j
        if bearing is not None and bearing.bearings and drive.wheel_tilts:
            force, lean = 0j, 0j
            placed = [row.plane for row in bearing.bearings if row.contact_angle]
            middle = sum(placed) / max(len(placed), 1)
            sprung = iter(wheel_rows(drive)[0])
            for row in bearing.bearings:
                centre, radial = row.plane, row.radial_stiffness or 0.0
                if row.contact_angle:
                    outward = np.sign(row.plane - middle) or -1.0
                    apart = (row.pitch_radius or 0.0) * np.tan(row.contact_angle)
                    centre += (outward if bearing.arrangement == "O" else -outward) * apart
                    radial = 0.5 * (row.axial_stiffness or 0.0) / np.tan(row.contact_angle) ** 2
                moved = self.wheel_place + centre * self.wheel_lean
                law = SidedSpring(side=0.5 * radial, pressed=np.inf)
                if row.contact_angle and (row.preload or bearing.preload) is not None:
                    pressed = next(sprung)
                    law = SidedSpring(side=0.5 * pressed.radial_stiffness, pressed=pressed.reach)
                elif bearing.clearance is not None:
                    law = SidedSpring(side=radial, pressed=-0.5 * bearing.clearance)
                push = _along(law, moved)
                force, lean = force + push, lean + centre * push
            return force, lean
        stiffness = 0.0 if bearing is None else bearing.tilt_stiffness or 0.0
        return _along(spring, self.wheel_place), stiffness * self.wheel_lean

    def _tilting_outside(self) -> complex:
        """What forces and moments from outside press the lean of the wheel with, N·mm."""
        drive, total = self.drive, 0j
        turned = np.exp(1j * self.crank_angle * drive.tooth_number_difference / drive.pin_wheel.number_of_pins)
        for entry in drive.load.external:
            pressed = entry.at.z * complex(entry.force.x, entry.force.y) + complex(entry.moment.y, -entry.moment.x)
            if drive.installation.held == "pin-wheel":
                total -= pressed * (turned if entry.frame == "housing" else 1.0)
            else:
                total += pressed * (turned if entry.frame == "output" else 1.0)
        return complex(total)


def find_imbalance_in_slices(
    drive: Drive, model: Reducer, balanced: Equilibrium, position: int = 0, *, torque: float | None = None
) -> list[str]:
    """Return what does not hold of contacts in slices at a position of a solution; empty for an equilibrium.

    Arguments are those of `ltca.testing.balance_check.find_imbalance`. Friction, an elastic ring, a carrier on posts and teeth
    of a first stage are not known here, and gaps of loose pins and sleeves beside their loads are not checked.
    """
    if not np.all(np.isfinite(balanced.pose[position])):
        return ["the pose is not finite"]
    return WidthCheck(drive, model, balanced, position).problems(torque)


def contact_moduli(drive: Drive) -> dict[str, float]:
    """Return E* of the contacts, MPa."""
    parts = drive.materials

    def together(one: Material, other: Material) -> float:
        return 1.0 / sum((1.0 - each.poisson_ratio**2) / each.youngs_modulus for each in (one, other))

    return {
        "flank": together(parts.disc, drive.flank_pin),
        "inner": together(parts.inner_race, parts.roller),
        "outer": together(parts.disc, parts.roller),
    }


def _lean(inclination: Any) -> complex:
    """How an inclined axis moves with height: about x towards −y, about y towards x."""
    return complex(inclination.y, -inclination.x)


def _leans(errors: Any, count: int) -> ComplexArray:
    x, y = (np.array(each) if each else np.zeros(count) for each in (errors.inclination_x, errors.inclination_y))
    return np.asarray(y - 1j * x)


def _fallen(profile: LengthProfile, z: FloatArray, length: float, radius: float) -> FloatArray:
    """By how much a pin or roller falls short along its length, mm."""
    half = 0.5 * length
    found = profile.crown_drop * (z / half) ** 2
    if profile.logarithmic_factor:
        found = found - 0.0007 * radius * profile.logarithmic_factor * np.log(1.0 - (z / half) ** 2)
    if profile.end_relief_length and profile.end_relief_depth:
        beyond = np.maximum(np.abs(z) - half + profile.end_relief_length, 0.0)
        found = found + profile.end_relief_depth * (beyond / profile.end_relief_length) ** 2
    return np.asarray(found)


def _most(values: Any) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def _along(spring: SidedSpring, moved: complex) -> complex:
    """Force of a bearing at a displacement, N."""
    size = abs(moved)
    return spring.slopes(size)[0] * moved / size if size else 0j


def _off(
    line: FloatArray | None,
    slices: FloatArray,
    gap: FloatArray,
    length: float,
    modulus: float,
    radius: FloatArray,
    rounding: float,
    free_ends: tuple[FreeEnds, ...] = (),
) -> float:
    """Largest difference of gap and what plane strain and the coupling of the slices make of the line load, by the gap.

    `rounding` is that of places, mm: what it makes of a gap or, times E* L, of a load, which bounds the stiffness of a line, is
    no difference. Without line loads slices are compared: loads of plane strain at the gaps left. Contacts that the answer has
    open are wrong where they overlap by more than round-off.
    """
    on = slices.sum(axis=1) > 0.0
    if not on.any():
        return float(np.max(gap, initial=0.0) > rounding)
    load, gap, radius = slices[on], gap[on], np.broadcast_to(radius, on.shape)[on]
    points = np.repeat(pressed_in(load, length, modulus, radius, free_ends), POINTS, axis=1)
    largest = gap.max(axis=1)
    local = gap - points
    if line is None:
        carried = _line_load(local, length, modulus, radius[:, None])
        weights = np.polynomial.legendre.leggauss(POINTS)[1] * 0.5 * length / load.shape[1]
        got = (carried.reshape(*load.shape, POINTS) * weights).sum(axis=-1)
        off = np.maximum(np.abs(got - load).max(axis=1) - modulus * length * rounding, 0.0)
        return float(np.max(off / load.max(axis=1)))
    known = line[on].reshape(local.shape)
    carries = known > 0.0
    needed = plane_approach(np.where(carries, known, 1.0), length, modulus, radius[:, None])
    off = np.where(carries, np.abs(needed - local), np.maximum(local, 0.0))
    return float(np.max(np.maximum(off.max(axis=1) - rounding, 0.0) / largest))


def _line_load(approach: FloatArray, length: float, modulus: float, radius: FloatArray) -> FloatArray:
    """Line loads of plane strain by bisection of their logarithm, N/mm."""
    pressed = approach > 1e-15
    aim = np.where(pressed, approach, 1e-6)
    low, high = np.full(approach.shape, -40.0), np.full(approach.shape, 20.0)
    # Up to where the approach rises with the load.
    top = np.log(np.pi * modulus * (8.0 * length) ** 2 / (4.0 * radius)) - 1.5
    high = np.minimum(high, np.broadcast_to(top, high.shape))
    for _ in range(70):
        middle = 0.5 * (low + high)
        above = plane_approach(np.exp(middle), length, modulus, radius) > aim
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return np.where(pressed, np.exp(0.5 * (low + high)), 0.0)


def _shaft(
    drive: Drive, pressed: ComplexArray, stands: ComplexArray, counted: FloatArray, known: float
) -> tuple[ComplexArray, float]:
    """Displacements, then slopes, of the journals of a crank under forces, then couples, of the discs.

    Unit loads on a beam on two bearings, each as its spring stands under what statics let it carry. One that carries no more
    than how well forces are `known`, N, stands anywhere in its clearance, and the journals tell where: the line through the
    bearings that comes nearest to where the crank `stands`, slopes `counted` by their lever. Second comes how far such a bearing
    is beyond its clearance, mm.
    """
    support = drive.crank.support
    assert support is not None
    (start, end), planes = support.positions, np.asarray(drive.disc.disc_planes)
    span, at = end - start, np.concatenate((planes, planes))
    of_couple = np.arange(at.size) >= planes.size
    far = np.where(of_couple, 1.0 / span, (at - start) / span)
    near = np.where(of_couple, -1.0 / span, 1.0 - far)
    marks = np.unique(np.concatenate(([start, end], planes)))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = 0.5 * np.diff(marks)[:, None]
    z = (0.5 * (marks[1:] + marks[:-1])[:, None] + half * nodes).ravel()
    weight = (half * weights).ravel()
    own = np.where(of_couple[:, None], -1.0 * (z > at[:, None]), np.maximum(z - at[:, None], 0.0))
    moments = own - near[:, None] * np.maximum(z - start, 0.0) - far[:, None] * np.maximum(z - end, 0.0)
    rigidity = drive.materials.crankshaft.youngs_modulus * np.pi * support.diameter**4 / 64.0
    moved = (moments * weight) @ moments.T / rigidity @ pressed
    free, reach = list[FloatArray](), list[float]()
    for share, spring in zip((near, far), crank_springs(drive), strict=True):
        carried = complex((share * pressed).sum())
        size = abs(carried)
        if size <= known and spring.pressed < 0.0:
            free.append(share)
            reach.append(-spring.pressed)
        elif size:
            moved = moved + share * _yielded(spring, size) * carried / size
    if not free:
        return np.asarray(moved), 0.0
    shares = np.stack(free, axis=1)
    places = np.linalg.lstsq(counted[:, None] * shares, counted * (stands - moved))[0]
    return np.asarray(moved + shares @ places), max(0.0, float(np.max(np.abs(places) - reach)))


def _yielded(spring: SidedSpring, force: float) -> float:
    """Displacement of a bearing under a force, mm, by bisection."""
    low, high = 0.0, 1e3
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if spring.slopes(middle)[0] < force else (low, middle)
    return 0.5 * (low + high)
