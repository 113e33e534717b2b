"""Rollers that pass the races of the crank bearings, position by position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ltca.analysis.life.laminae import EvenLaminae, Laminae, SolvedLaminae
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive, contact_modulus
from ltca.geometry.coordinates import DISC_ROTATION
from ltca.geometry.length_profile import generator_profile


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerPassages:
    """Which roller presses where on its races, position by position: all that lives need of an analysis.

    Attributes
    ----------
    drive : Drive
        Whose they are.
    torque : float
        At the output, N·mm.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    inner_load, outer_load : array, shape (positions, discs, rollers)
        N.
    on_inner, in_bore : array, shape (positions, discs, rollers)
        Places of the rollers in the frames of the races, rad.
    largest_force : array, shape (discs, cranks)
        Largest radial force over the positions, N.
    laminae : tuple of Laminae
        How rollers spread their loads on the inner race and in the bore; straight aligned ones where slices are given.
    inner_slices, outer_slices : array, shape (positions, discs, rollers, slices), or None
        Loads of the slices of rollers that tilt, N.
    """

    drive: Drive
    torque: float
    crank_angle: FloatArray
    inner_load: FloatArray
    outer_load: FloatArray
    on_inner: FloatArray
    in_bore: FloatArray
    largest_force: FloatArray
    laminae: tuple[Laminae, Laminae]
    inner_slices: FloatArray | None = None
    outer_slices: FloatArray | None = None


def roller_passages(analysis: LoadedAnalysis) -> RollerPassages:
    """Return which rollers press where at the positions of an analysis.

    Parameters
    ----------
    analysis : LoadedAnalysis
        All its positions balanced.

    Raises
    ------
    ValueError
        When one has no answer.
    """
    if not np.all(analysis.balanced):
        raise ValueError("life needs an answer at every position")
    angle = analysis.full.crank_angle
    rollers = [single.full.response.rollers for single in analysis.discs]
    turned = [single.full.pose[:, DISC_ROTATION, None] for single in analysis.discs]
    places = [model.geometry.placement.roller_angles(angle) for model in analysis.model.discs]
    force = np.hypot(analysis.bearing_radial, analysis.bearing_tangential)
    leaning = [each.leaning for each in rollers]
    return RollerPassages(
        drive=analysis.drive,
        torque=analysis.torque,
        crank_angle=angle,
        inner_load=np.stack([each.inner_load for each in rollers], axis=1),
        outer_load=np.stack([each.outer_load for each in rollers], axis=1),
        on_inner=np.stack([place - angle[:, None] for place in places], axis=1),
        in_bore=np.stack(
            [np.angle(each.outer_direction) - turn for each, turn in zip(rollers, turned, strict=True)], axis=1
        ),
        largest_force=force.max(axis=0),
        laminae=laminae_of(analysis),
        inner_slices=_beside([None if one is None else one.inner.slice_load for one in leaning]),
        outer_slices=_beside([None if one is None else one.outer.slice_load for one in leaning]),
    )


def _beside(discs: Sequence[FloatArray | None]) -> FloatArray | None:
    known = [each for each in discs if each is not None]
    return np.stack(known, axis=1) if known else None


def laminae_of(analysis: LoadedAnalysis) -> tuple[Laminae, Laminae]:
    """Return how the rollers of an analysis spread their loads on the inner race and in the bore.

    By the profile, where the engine has one along the length; even with edge factors in plane strain, which has none. Where
    contacts have slices, which know the profile, those of a straight roller.
    Effective radii are those of the drawing: errors of single rollers are thousandths of them.
    """
    drive = analysis.drive
    if analysis.engine.compliance == "fe":
        return EvenLaminae(), EvenLaminae()
    part, materials = drive.crank_bearing, drive.materials
    profile = None
    if drive.contact.slices == 1:
        profile = generator_profile(part.roller_profile, drive.roller_length, part.roller_radius)

    def solved(curvature: float, race_modulus: float) -> SolvedLaminae:
        return SolvedLaminae(
            profile=profile,
            length=drive.roller_length,
            effective_radius=1.0 / (1.0 / part.roller_radius + curvature),
            contact_modulus=race_modulus,
        )

    return (
        solved(1.0 / part.inner_race_radius, contact_modulus(materials.inner_race, materials.roller)),
        solved(-1.0 / drive.bore_radius, contact_modulus(materials.disc, materials.roller)),
    )
