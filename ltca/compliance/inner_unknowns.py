"""What is unknown beside the pose: places of rollers, deformations of contacts, displacements of pins (`ltca.mechanics`)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ltca.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True)
class Inner:
    """What is unknown beside the pose, as it was found at some pose.

    Attributes
    ----------
    lean : array, shape (positions, rollers)
        Of the rollers along their rays by half the thickness of the disc, mm; zero in the plane.
    approach : array, shape (positions, components, contacts), or None
        Deformations e; None where they are the approaches themselves.
    near : tuple of array
        What the laws of each disc and kind start from nearby (`ltca.laws.sliced_contact.SlicedContact.near`); empty in the plane.
    """

    lean: FloatArray
    approach: FloatArray | None
    near: tuple[FloatArray, ...]


@dataclass(frozen=True, slots=True)
class Following:
    """How the inner unknowns follow the pose to first order.

    Attributes
    ----------
    pose : array, shape (positions, coordinates)
        Where they were found.
    place, lean : array, shape (positions, rollers)
        Of the rollers: inward from where they only touch the race, and lean by half the thickness of the disc, mm.
    approach : array, shape (positions, components, contacts), or None
        e, mm; None where it is the approach itself.
    shifts : array of complex, shape (positions, rows, pairs), or None
        u, mm.
    by_pose, approach_by_pose, shifts_by_pose : array
        Derivatives by the pose.
    columns : tuple of tuple of int
        Coordinates by which `by_pose` has the derivatives of the rollers of each disc; empty for all.
    """

    pose: FloatArray
    place: FloatArray
    lean: FloatArray
    approach: FloatArray | None
    shifts: ComplexArray | None
    by_pose: FloatArray | None
    approach_by_pose: FloatArray | None
    shifts_by_pose: ComplexArray | None
    columns: tuple[tuple[int, ...], ...] = ()

    @property
    def kept(self) -> Following:
        """The same without derivatives, for balanced positions that are kept."""
        return replace(self, by_pose=None, approach_by_pose=None, shifts_by_pose=None)

    def at(self, pose: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray | None, ComplexArray | None]:
        """Return places and leans of rollers, deformations and displacements of pins to expect at other poses."""
        place, lean, approach, shifts = self.place, self.lean, self.approach, self.shifts
        if self.by_pose is None:
            return place, lean, approach, shifts
        moved = (pose - self.pose)[:, None, :, None]
        if self.columns:
            rollers = zip(np.split(self.by_pose, len(self.columns), axis=1), self.columns, strict=True)
            change = np.concatenate([np.matmul(part, moved[:, :, own])[..., 0] for part, own in rollers], axis=1)
        else:
            change = np.matmul(self.by_pose, moved)[..., 0]
        place = place + change[..., 0]
        if change.shape[-1] > 1:
            lean = lean + change[..., 1]
        if approach is not None and self.approach_by_pose is not None:
            approach = approach + np.matmul(self.approach_by_pose, moved)[..., 0]
        if shifts is not None and self.shifts_by_pose is not None:
            shifts = shifts + np.matmul(self.shifts_by_pose, moved)[..., 0]
        return place, lean, approach, shifts
