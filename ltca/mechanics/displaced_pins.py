"""Contacts on pins that beams and the ring of the wheel displace."""

from __future__ import annotations

import weakref
from itertools import product
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.pair_motion import dot
from ltca.geometry.rotation import unit
from ltca.mechanics.places import Indices


class PinMembers:
    """Wheel pins and shaft pins of all discs under their contacts; wheel pins are displaced in the frame of the turning wheel."""

    def __init__(self, at: Any) -> None:
        # Not a circle of references: what a search has evaluated goes as soon as nobody asks for it.
        self.at, system = weakref.proxy(at), at.system
        place, pins = system.geometries[0].placement, system.pins
        turned = unit(place.wheel_rotation(at.angle) + at.pose[:, WHEEL_ANGLE]).conjugate()[:, None]
        self.normal, self.pressing, self.leaning, self.turning, self.along = [], [], [], [], []
        self._chosen()
        for disc, each in enumerate(at.discs):
            frame = np.where(np.arange(pins + system.holes) < pins, turned, 1.0)

            def seen(first: FloatArray, second: FloatArray, frame: ComplexArray = frame) -> ComplexArray:
                both = np.concatenate((first, second), axis=1)[..., DISC_PLACE]
                return np.asarray(-(both[..., 0] + 1j * both[..., 1]) * frame)  # as the disc moves the other way

            normal = seen(each.flank.gradient, each.holes.gradient)
            along = seen(each.flank.along, each.holes.along)
            pressing = normal + at.rubs[disc] * along if at.rubs else normal
            self.along.append(along)
            self.normal.append(normal)
            self.pressing.append(pressing)
            self.leaning.append(normal + at.rubs_leaning[disc] * along if at.rubs else normal)
            if each.tilts is not None:
                self.turning.append(at.half * seen(each.tilts[0].gradient, each.tilts[1].gradient))

    def forces(self, load: FloatArray, aside: FloatArray | None = None, *, changes: bool = False) -> ComplexArray:
        """Return Lᵀ f of loads, or of `changes` of loads without friction that sticks, shape (positions, rows, pairs), and of
        forces `aside` of the normals, shape (positions, components, discs, pairs).
        """
        system, forces, moments = self.at.system, [], []
        for disc, kinds in enumerate(system.of_kind):
            pressed = np.concatenate((load[..., kinds[0]], load[..., kinds[2]]), axis=-1)
            force = pressed[:, 0] * self.pressing[disc]
            if self.turning:
                force = force + pressed[:, 1] * self.turning[disc]
                moment = pressed[:, 1] * self.leaning[disc]
                moments.append(moment if aside is None else moment + aside[:, 1, disc] * self.along[disc])
            if aside is not None:
                force = force + aside[:, 0, disc] * self.along[disc]
            if self.at.sticking and not changes:
                force = force + self.at.sticking[disc][2] * self.along[disc]
            forces.append(force)
        return np.stack(forces + moments, axis=1)

    def approaches(self, shifts: ComplexArray) -> FloatArray:
        """Return N u of all contacts, shape (positions, components, contacts)."""
        system = self.at.system
        found = np.zeros((shifts.shape[0], system.components, system.contacts))
        for disc, (pins, _, holes, _) in enumerate(system.of_kind):
            each = [dot(self.normal[disc], shifts[:, disc])]
            if self.turning:
                each.append(
                    dot(self.turning[disc], shifts[:, disc]) + dot(self.normal[disc], shifts[:, system.discs + disc])
                )
            for component, values in enumerate(each):
                found[:, component, pins], found[:, component, holes] = np.split(values, (system.pins,), axis=1)
        return found

    def unsettled(self, shifts: ComplexArray) -> ComplexArray:
        """Return u + S Lᵀ f, how far pins stand from where the loads press them, mm."""
        self._left: ComplexArray = np.asarray(shifts + self.at.system.model.pins.under(self.forces(self.at.load)))
        return self._left

    def slips(self) -> FloatArray:
        """Return the remaining slips of pins along the chosen contacts, mm, in the order of `turned_loads`."""
        found, at, system = [], self.at, self.at.system
        for disc, (along, own) in enumerate(zip(self.along, at.chosen, strict=True)):
            some = np.concatenate((own[0], system.pins + own[2]), axis=1)
            each = [dot(along, self._left[:, disc])]
            if self.turning:
                each.append(dot(along, self._left[:, system.discs + disc]))
            found.append(np.stack([one[at.row, some] for one in each], axis=1))
        return np.concatenate(found, axis=2)

    def _chosen(self) -> None:
        """Find the contacts on pins among the chosen ones, their pins and discs."""
        at, system = self.at, self.at.system
        places, pairs, discs = [], [], []
        for disc in range(system.discs):
            for kind, first in ((0, 0), (2, system.pins)):
                own = at.at[disc][kind]
                places.append(np.arange(own.start, own.stop))
                pairs.append(first + at.chosen[disc][kind])
                discs.append(np.full(own.stop - own.start, disc))
        self.place, self.pair, self.disc = np.concatenate(places), np.concatenate(pairs, axis=1), np.concatenate(discs)
        self.count = self.place.size

    def of_all(self, values: FloatArray) -> FloatArray:
        """Values of the chosen contacts on pins, shape (positions, components, entries, columns), by disc and pair."""
        rows, components, _, columns = values.shape
        discs, pairs = self.at.system.discs, self.at.system.pins + self.at.system.holes
        found = np.zeros((rows, components, discs, pairs, columns))
        found[self.at.row, :, self.disc, self.pair] = values.swapaxes(1, 2)
        return found

    def turned_loads(self, size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return stiffnesses F κ (in slices M κ between place and lean) of loads against pins that move along their contacts,
        slips by the pose, and loads times the angle by which the wheel turns against the disc.

        Shapes are (1 or 3, positions, entries) and twice (positions, components, entries, coordinates).
        """
        at, system = self.at, self.at.system
        rows, each = at.pose.shape[0], []
        slip, turn = np.zeros((2, rows, system.components, self.count, size))
        last = 0
        for disc, own in enumerate(system.columns):
            of_disc = at.discs[disc]
            for kind, motion, sign in ((0, of_disc.flank, -1.0), (2, of_disc.holes, 1.0)):
                some, first = at.chosen[disc][kind], last
                last += some.shape[1]
                bend = sign * motion.bending[at.row, some]
                load = at.load[:, :, system.of_kind[disc][kind]]
                parts = [bend * load[:, component][at.row, some] for component in range(system.components)]
                each.append(np.stack([*parts, np.zeros(bend.shape)]) if system.components > 1 else np.stack(parts))
                if kind == 0:
                    for component, part in enumerate(load.swapaxes(0, 1)):
                        turning = turn[:, component, first:last]
                        turning[..., own[DISC_ROTATION]] -= part[at.row, some]
                        turning[..., own[WHEEL_ANGLE]] += part[at.row, some]
                        if at.by_crank:  # the wheel turns with the crank
                            turning[..., -1] += part[at.row, some] / of_disc.geometry.placement.reduction_ratio
                along = motion.along[at.row, some]
                by_place = slip[:, 0]
                by_place[:, first:last, own] = along
                if at.by_crank:
                    by_place[:, first:last, -1] = np.matmul(along, of_disc.nominal)[..., 0]
                if system.components > 1:
                    by_lean = slip[:, 1]
                    by_lean[:, first:last, own[system.one.lean_place]] = at._thick * along[..., DISC_PLACE]
                    if kind == 0 and system.one.wheel_leans:
                        by_lean[:, first:last, own[system.one.wheel_lean_place]] = -at._thick * along[..., DISC_PLACE]
        return np.concatenate(each, axis=2), slip, turn

    def add_flexibility(self, whole: FloatArray) -> None:
        """Add N S Lᵀ to W, in place: of the chosen contacts, or of those on pins alone, then of their slips (`turned_loads`)."""
        at, system = self.at, self.at.system
        held = system.model.pins
        assert held is not None
        row = at.row
        pair = np.concatenate((self.pair, self.pair), axis=1)
        place = np.arange(2 * self.count)
        if system.coupled:
            place = np.concatenate((self.place, at.count + np.arange(self.count)))

        def chosen(values: list[ComplexArray], along: list[ComplexArray]) -> ComplexArray:
            first, second = (np.stack(each, axis=1)[row, self.disc, self.pair] for each in (values, along))
            return np.concatenate((first, second), axis=1)

        none = np.zeros(pair.shape, dtype=complex)
        normal, pressing = chosen(self.normal, self.along), chosen(self.pressing, self.along)
        # By component and kind of displacement: shifts, and leans in slices.
        by: list[list[ComplexArray]] = [[normal]]
        onto: list[list[ComplexArray]] = [[pressing]]
        if self.turning:
            turning = chosen(self.turning, [np.zeros_like(one) for one in self.turning])
            by, onto = [[normal, none], [turning, normal]], [[pressing, none], [turning, pressing]]
        if held.beams.any():
            self._add_beams(whole, place, by, onto)
        if held.ring is None:
            return
        first, second = place[:, None], place[None, :]
        seats = held.ring.shape[-2]
        on_wheel = pair < seats
        seat = np.minimum(pair, seats - 1)
        behind = (row[..., None],) if held.ring.ndim > 4 else ()
        for a, mine in enumerate(by):
            for b, theirs in enumerate(onto):
                total = np.zeros((*pair.shape, pair.shape[1]))
                for x, left in enumerate((mine[0].real, mine[0].imag)):
                    for y, right in enumerate((theirs[0].real, theirs[0].imag)):
                        moved = held.ring[(*behind, seat[:, :, None], x, seat[:, None, :], y)]
                        total += moved * (left * on_wheel)[:, :, None] * (right * on_wheel)[:, None, :]
                whole[:, a, first, b, second] += total

    def _add_beams(
        self, whole: FloatArray, place: Indices, by: list[list[ComplexArray]], onto: list[list[ComplexArray]]
    ) -> None:
        """Add the approaches of contacts on a pin by loads on the same pin, through its beam."""
        discs, beams, count = self.at.system.discs, self.at.system.model.pins.beams, self.count
        number = np.full((self.at.angle.size, discs, beams.shape[-3]), -1)
        number[self.at.row, self.disc, self.pair] = np.arange(count)
        for disc in range(discs):
            partner = number[self.at.row, disc, self.pair]
            row, mine = np.nonzero(partner >= 0)
            other, pin = partner[row, mine], self.pair[row, mine]
            behind = (row,) if beams.ndim > 3 else ()
            for i, j in np.ndindex(len(by[0]), len(by[0])):
                beam = beams[(*behind, pin, self.disc[mine] + i * discs, disc + j * discs)]
                if not beam.any():
                    continue
                for (a, left), (b, right) in product(enumerate(by), enumerate(onto)):
                    for first, second in product((mine, count + mine), (other, count + other)):
                        moved = beam * dot(left[i][row, first], right[j][row, second])
                        whole[row, a, place[first], b, place[second]] += moved


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a linear system position by position; ConvergenceError where loads that turn make one singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    except np.linalg.LinAlgError:
        raise ConvergenceError("contacts at a pose hold nothing: their linear system is singular") from None
