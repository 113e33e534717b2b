"""Check of an equilibrium of contacts in slices by the loads of their slices, in six directions per disc.

Independent of `ltca.geometry`, `ltca.compliance`, `ltca.equilibrium`, `ltca.laws.sliced_line` and `ltca.laws.beam`: axes are
lines in space that stand inclined, lean with their bodies and are displaced by the forces of the answer (beams and shafts by the
theorem of unit loads). At the height z of every point of a slice the section of the disc stands where its lean brings it and the
pin where its axis crosses; normal and lever arm there are those of these two sections, without any derivative of the middle. From
the answer come the pose, the line loads, and the places and leans of the rollers.

Checked are the forces along x and y and the moments about x, y and z of every disc; along z nothing presses without friction.
Then rollers in force and moment, journals, pins, the ring that ties their tips and the wheel on its bearing; and that every line
load belongs to its gap (`ltca.testing.slice_law`). Rotations are small: what is left out is their square.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
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
SHIFT = 1e-4
"""Step of the differences that give normals, by the radius of the pin: distances are round-off of 1e-15 of the circle."""
FORCES = 1e-4
"""What may be left of forces, by the load of the drive, and of couples by it times half the width: normals along the width differ
from linear ones by the square of angles of 1e-3."""
LEFT_OUT = 1e-2
"""What the model may leave out of couples, by the load of the drive times half the width."""
ROUND_OFF = 2e-13
"""Of places, by the radius of the pin circle: pieces of the flank that are followed are known to a thousand round-offs."""
GAPS = 1e-4
"""What may be left of an approach, by the largest of its contact."""
SETTLED = 1e-6
"""What may be left of displacements of beams, shafts and bearings, by the largest."""


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
        Σ z times the load at z along the normal of the middle, N·mm.
    left_out : array, shape (parts,)
        What normals along the width would add to it, N·mm.
    turning : array, shape (parts,)
        Moment about z at the centre of the disc, N·mm.
    """

    force: ComplexArray
    couple: ComplexArray
    left_out: FloatArray
    turning: FloatArray


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
    def on_flank(self) -> tuple[Pressed, FloatArray, FloatArray]:
        """What wheel pins press, the gaps at the points, mm, shape (pins, points), and effective radii."""
        line, length = self.answer.leaning_pins.contact.line_load[self.check.position], self.drive.disc.thickness
        load = line.reshape(line.shape[0], -1)
        z, weights = self.heights(length)
        section, (_, radii) = self._seen(self.wheel_pins, np.append(z, 0.0)), self.parts.wheel_pins
        step, flank = SHIFT * float(radii[0]), DeviatedFlank(self.drive, self.number)
        ways = step * np.array([0.0, 1.0, -1.0, 1j, -1j])[:, None]
        reach = 2.0 * float(np.max(np.abs(section - section[-1]))) + 1e-3 * float(radii[0])
        # Height by height: pieces of the flank about a pin are as wide as it moves.
        each = np.stack([flank.approaches(points + ways, radii, reach)[0] for points in section])
        normal: ComplexArray = np.asarray(
            (each[:, 1] - each[:, 2] + 1j * (each[:, 3] - each[:, 4])) / (2.0 * step), dtype=complex
        )
        # Gaps grow linearly along the width in the model: the square of tilt across the normal is left out.
        seen = (self.wheel_pins.lean - self.lean) * np.conj(self.turn)
        turned = step * seen / np.maximum(np.abs(seen), 1e-300)
        there, effective = flank.approaches(section[-1] + turned * np.array([[0.0], [1.0], [-1.0]]), radii, reach)
        slope = (there[1] - there[2]) / (2.0 * step) * np.abs(seen)
        gap = there[0] + z[:, None] * slope - self.lead(z)[:, None]
        gap -= _fallen(self.drive.pin_wheel.pin_profile, z, length, self.drive.pin_wheel.pin_radius)[:, None]
        return self._pressed(normal[:-1], normal[-1], load.T * weights[:, None], section[:-1], z), gap.T, effective

    @cached_property
    def in_holes(self) -> tuple[Pressed, FloatArray] | None:
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
        pin = self._seen(self.shaft_pins, z)
        apart = pin - holes - z[:, None] * inclined
        middle = (self.shaft_pins.at - self.centre) * np.conj(self.turn) - holes
        seen = (self.shaft_pins.lean - self.lean) * np.conj(self.turn) - inclined
        slope = (np.conj(middle) * seen).real / np.abs(middle)
        gap = np.abs(middle) - (hole_radii - radii) + z[:, None] * slope
        normals = apart / np.abs(apart), middle / np.abs(middle)
        return self._pressed(*normals, load.T * weights[:, None], pin, z), gap.T

    def _seen(self, lines: Lines, z: FloatArray) -> ComplexArray:
        """Points of axes at heights in the section of the disc there, shape (heights, parts)."""
        return np.asarray((lines.points(z) - self.centre - z[:, None] * self.lean) * np.conj(self.turn))

    def _pressed(
        self, normal: ComplexArray, middle: ComplexArray, load: FloatArray, point: ComplexArray, z: FloatArray
    ) -> Pressed:
        """Sums of loads along normals in the frame of the disc, at points there, as they are in the fixed frame.

        A gap that grows linearly along the width has couples along the normal of the middle: with normals along the width belongs
        the square of the tilt across them, which the model leaves out.
        """
        push = normal * load
        by_height = (z[:, None] * load).sum(axis=0)
        return Pressed(
            force=push.sum(axis=0) * self.turn,
            couple=by_height * middle * self.turn,
            left_out=np.abs((z[:, None] * push).sum(axis=0) - by_height * middle),
            turning=(np.conj(point) * push).imag.sum(axis=0),
        )

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
        inner_slices, outer_slices = (np.asarray(one[row]) for one in (state.inner_slices, state.outer_slices))
        for crank in range(cranks):
            own = slice(crank * each, (crank + 1) * each)
            eccentric = self.parts.eccentrics[crank] * (np.exp(1j * self.twist[crank]) - 1.0)
            race = self.parts.race_centres[crank] + eccentric + self.displaced[crank]
            race += self.plane * _lean(drive.crank.inclination)
            race_lean = self.sloped[crank] + _lean(drive.crank.inclination)
            in_bore = self.centre + self.parts.bores[crank] * self.turn
            place = inner_race + radii - state.inner_approach[row, own]
            lean = np.where(state.outer_load[row, own] > 0.0, state.lean[row, own], 0.0)
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
            # Free rollers stand and lean as they like: both gaps together are open.
            free, between = (state.outer_load[row, own] <= 0.0)[:, None], 0.5 * (pressed_inner + pressed_outer)
            found["gap"].append((np.where(free, between, pressed_inner), np.where(free, between, pressed_outer)))
            found["radius"].append((1.0 / (1.0 / radii + 1.0 / inner_race), 1.0 / (1.0 / radii - 1.0 / bore)))
            found["load"].append((inner_slices[own], outer_slices[own]))
            inner, outer = inner_slices[own].sum(axis=1), outer_slices[own].sum(axis=1)
            middle = inner - outer * (np.conj(ray) * normal).real
            found["left"].append((middle, state.inner_moment[row, own] - state.outer_moment[row, own]))
            # The lever of a slice is where its load stands, which the gap along it knows.
            force = (outer * normal).sum()
            couple = (state.outer_moment[row, own] * normal).sum()
            found["force"].append(force)
            found["couple"].append(couple)
            # By the angle of the crank the race moves and the cage turns with its rays.
            speed = inner_race / (inner_race + self.drive.crank_bearing.outer_race_radius)
            moved = 1j * self.parts.eccentrics[crank] * np.exp(1j * self.twist[crank]) + speed * 1j * place * ray
            found["crank"] += float((outer * (np.conj(normal) * moved).real).sum())
            seen = (np.conj(1j * ray) * (race_lean - self.lean)).real
            found["crank"] += float(speed * (state.outer_moment[row, own] * seen).sum())
            # Rollers lean along their rays, couples in the bore press along its normals.
            found["left out"] += float((np.abs(state.outer_moment[row, own]) * np.abs(normal - ray)).sum())
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
    """

    def __init__(self, drive: Drive, model: Reducer, balanced: Equilibrium, position: int) -> None:
        self.drive, self.model, self.balanced, self.position = drive, model, balanced, position
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
        moment, drive = float(self.balanced.wheel_moment[self.position]), self.drive
        lever = drive.crank.eccentricity * float(drive.reduction_ratio)
        load, half = abs(moment) / lever, 0.5 * drive.disc.thickness
        found: list[str] = []

        def told(what: str, left: float, bound: float, unit: str) -> None:
            if not left <= bound:
                found.append(f"{what}: {left:.3g} {unit} beside {bound:.3g} {unit}")

        for disc in self.each:
            name = f"disc {disc.number}"
            pressed, gap, radius = disc.on_flank
            kinds = [pressed, *([] if disc.in_holes is None else [disc.in_holes[0]])]
            rollers = disc.of_rollers
            force = sum(one.force.sum() for one in kinds) + sum(rollers["force"])
            couple = sum(one.couple.sum() for one in kinds) + sum(rollers["couple"])
            turning = sum(one.turning.sum() for one in kinds) + rollers["turning"]
            carried = sum(float(np.abs(one.force).sum()) for one in kinds) + load
            told(f"{name}: forces along x and y left", abs(force), FORCES * carried, "N")
            slanted = rollers["left out"]
            told(f"{name}: moments about x and y left", abs(couple), FORCES * carried * half + slanted, "N·mm")
            beside = sum(one.left_out.sum() for one in kinds) + slanted
            told(f"{name}: moments that the model leaves out", beside, LEFT_OUT * carried * half, "N·mm")
            told(f"{name}: moment about z left", abs(turning), FORCES * carried * lever, "N·mm")
            pushed = -np.concatenate([one.force for one in kinds])
            off = _most(pushed - disc.answer.pin_forces[self.position])
            told(f"{name}: force on a pin beside what presses on the disc", off, FORCES * carried, "N")
            self._laws(disc, gap, radius, told, name)
            for force_left, moment_left in rollers["left"]:
                told(f"{name}: force left on a roller", _most(force_left), 1e-8 * carried, "N")
                told(f"{name}: moment left on a roller", _most(moment_left), 1e-8 * carried * half, "N·mm")
        self._members(told, load, torque)
        return found

    def _laws(self, disc: Disc, gap: FloatArray, radius: FloatArray, told: Any, name: str) -> None:
        """Whether line loads belong to gaps."""
        parts, row, drive = contact_moduli(self.drive), self.position, self.drive
        thick, long = drive.disc.thickness, drive.roller_length
        rounding = ROUND_OFF * drive.pin_wheel.pin_circle_radius
        pins, holes = disc.answer.leaning_pins.contact, disc.answer.leaning_holes.contact
        off = _off(pins.line_load[row], pins.slice_load[row], gap, thick, parts["flank"], radius, rounding)
        told(f"{name}: gap of a wheel pin beside its line load", off, GAPS, "of its approach")
        if disc.in_holes is not None:
            law: Any = self.model.discs[disc.number].hole_law  # type: ignore[attr-defined]
            line, there = holes.line_load[row], disc.in_holes[1]
            if hasattr(law, "contact_modulus"):
                _, radii = disc.parts.shaft_pins
                effective = 1.0 / (1.0 / radii - 1.0 / disc.parts.holes[1])
                off = _off(line, holes.slice_load[row], there, thick, law.contact_modulus, effective, rounding)
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
                off = _off(None, loads[kind], gaps[kind], long, modulus, radii[kind], rounding)
                told(f"{name}: load of a slice of a roller {where} beside its gap", off, GAPS, "of the largest")

    def _members(self, told: Any, load: float, torque: float | None) -> None:
        """Journals, wheel, ring of tips and the torque of the output."""
        drive, planes = self.drive, np.asarray(self.drive.disc.disc_planes)
        half = 0.5 * drive.disc.thickness
        moment = float(self.balanced.wheel_moment[self.position])
        for crank in range(drive.crank.number):
            force = -np.array([disc.of_rollers["force"][crank] for disc in self.each])
            couple = -np.array([disc.of_rollers["couple"][crank] for disc in self.each])
            if drive.crank.support is None:
                continue
            moved = _shaft(drive, np.concatenate((force, couple)))
            stands = np.concatenate(
                [[disc.displaced[crank] for disc in self.each], [half * disc.sloped[crank] for disc in self.each]]
            )
            moved[self.discs :] *= half
            size = float(np.max(np.abs(stands)))
            # As the forces are known to a ten-thousandth.
            bound = 3e-4 * size + ROUND_OFF * drive.pin_wheel.pin_circle_radius
            told(f"crank {crank}: displacement or slope of a journal off", _most(np.abs(moved - stands)), bound, "mm")
        outside, tilting = outside_on_wheel(drive, self.crank_angle), self._tilting_outside()
        wheel = np.array([-disc.on_flank[0].force.sum() for disc in self.each])
        couples = np.array([-disc.on_flank[0].couple.sum() for disc in self.each])
        carried = load + sum(float(np.abs(disc.on_flank[0].force).sum()) for disc in self.each)
        lean = (planes * wheel).sum() + couples.sum() + tilting
        held, against = self._wheel_bearing()
        if held is not None:
            told("force left on the wheel", abs(wheel.sum() + outside - held), FORCES * carried, "N")
        if drive.wheel_tilts:
            arm = half + float(np.max(np.abs(planes)))
            told("moments about x and y left on the wheel", abs(lean - against), FORCES * carried * arm, "N·mm")
        turning = 0.0
        for disc in self.each:
            axis = disc.parts.wheel_axis + disc.plane * (_lean(drive.pin_wheel.inclination) + self.wheel_lean)
            axis += self.wheel_place
            pressed = disc.on_flank[0]
            turning -= float(pressed.turning.sum() + (np.conj(disc.centre - axis) * pressed.force.sum()).imag)
        lever = drive.crank.eccentricity * float(drive.reduction_ratio)
        told("moment about z left on the wheel", abs(turning + moment), FORCES * carried * lever, "N·mm")
        if self.ring is not None and drive.posts is None:
            self._floating_ring(told, carried)
        if torque is not None and (drive.crank.number == 1 or not drive.wheel_is_held):
            output = drive.driving_sign * torque
            left = moment + output
            if drive.wheel_is_held:
                left += sum(disc.of_rollers["crank"] for disc in self.each)
                left -= (np.conj(self.wheel_place) * outside).imag
            told("torque of the output off", abs(left), 1e-3 * abs(output), "N·mm")

    def _floating_ring(self, told: Any, carried: float) -> None:
        """Forces of the tips on the ring, which nothing else holds."""
        drive, count = self.drive, 2 * self.discs
        assert drive.pin_shaft is not None
        stiffness = beam_stiffness(drive, drive.pin_shaft, drive.materials.shaft_pin, slopes=True)
        assert stiffness is not None
        bent = np.stack([one[0] for one in self.bent_shaft_pins] + [one[1] for one in self.bent_shaft_pins])
        tips = (stiffness[count:, :count] @ bent + stiffness[count:, count:] @ self._tips[None])[0]
        places, _ = ActualParts(drive, 0.0).shaft_pins
        turning = float((np.conj(places) * tips).imag.sum())
        told("force left on the ring of the tips", abs(tips.sum()), FORCES * carried, "N")
        told("moment left on the ring of the tips", abs(turning), FORCES * carried * float(np.abs(places[0])), "N·mm")

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

    Arguments are those of `ltca.testing.balance_check.find_imbalance`. Friction, seats, an elastic ring, a carrier on posts and
    teeth of a first stage are not known here.
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
) -> float:
    """Largest difference of gap and what plane strain and the coupling of the slices make of the line load, by the gap.

    `rounding` is that of places, mm. Without line loads slices are compared: loads of plane strain at the gaps left.
    """
    on = slices.sum(axis=1) > 0.0
    if not on.any():
        return float(np.max(gap, initial=0.0) > rounding)
    load, gap, radius = slices[on], gap[on], np.broadcast_to(radius, on.shape)[on]
    points = np.repeat(pressed_in(load, length, modulus, radius), POINTS, axis=1)
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


def _shaft(drive: Drive, pressed: ComplexArray) -> ComplexArray:
    """Displacements, then slopes, of the journals of a crank under forces, then couples, of the discs.

    Unit loads on a beam on two bearings, each as its spring stands under what statics let it carry.
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
    bent = (moments * weight) @ moments.T / rigidity @ pressed
    for share, spring in zip((near, far), crank_springs(drive), strict=True):
        carried = complex((share * pressed).sum())
        size = abs(carried)
        if size:
            bent = bent + share * _yielded(spring, size) * carried / size
    return np.asarray(bent)


def _yielded(spring: SidedSpring, force: float) -> float:
    """Displacement of a bearing under a force, mm, by bisection."""
    low, high = 0.0, 1e3
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if spring.slopes(middle)[0] < force else (low, middle)
    return 0.5 * (low + high)
