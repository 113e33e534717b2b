"""Level 5, without full solutions: relations between the compliance models, and the effect of the body in plane stress."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from ltca.analysis.engines import Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.arrays import FloatArray
from ltca.compliance.coefficients import BodyPlaces, InfluenceCoefficients
from ltca.compliance.coupled import CoupledCompliance
from ltca.compliance.near_field import NearField
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.testing.closed_form_bodies import without_coupling
from validation.compare.comparison import compare_positions
from validation.compare.model_positions import answers_of
from validation.rows import Row, positive_row

WIDTHS = (1.0, 4.0, 16.0)


def compare_models(
    drive: Drive,
    case: str,
    crank_angles: FloatArray,
    coefficients: InfluenceCoefficients,
    plane_stress: InfluenceCoefficients,
) -> list[Row]:
    """Return rows on the models alone; the coefficients are those of the body in plane strain and in plane stress."""
    return [
        *_uncoupled(drive, case, crank_angles),
        *_wide(drive, case, crank_angles, coefficients),
        *_plane_stress(drive, case, crank_angles, coefficients, plane_stress),
    ]


def _uncoupled(drive: Drive, case: str, crank_angles: FloatArray) -> list[Row]:
    """Return the row on the hybrid without body part and without near field of the holes, which is the half-space model."""
    half = analyse(drive, crank_angles)
    hybrid = analyse(drive, crank_angles, engine=Hybrid(coefficients=without_coupling(drive), hole_near_field=False))
    first, second = half.full.response, hybrid.full.response
    pairs = (
        (first.pin_load, second.pin_load),
        (first.rollers.outer_load, second.rollers.outer_load),
        (first.hole_load, second.hole_load),
    )
    worst = max(float(np.max(np.abs(a - b)) / np.max(a)) for a, b in pairs if a.size)
    return [
        Row(
            level=5,
            quantity="largest load difference of hybrid without body part from half-space",
            value=worst,
            reference=0.0,
            unit="",
            difference=worst,
            limit=1e-8,
            reason="the same laws by two routes; both balance to 1e-9 of the load or better",
            case=case,
            model="hybrid, C = 0",
            against="half-space",
        )
    ]


def widen(drive: Drive, coefficients: InfluenceCoefficients, width: float) -> tuple[Drive, InfluenceCoefficients]:
    """Return a drive `width` times as thick under the same load by width, and its coefficients.

    In plane strain every coefficient is inversely proportional to the thickness, so nothing has to be derived.
    """
    bearing, shaft, load = drive.crank_bearing, drive.pin_shaft, drive.load
    wide = replace(
        drive,
        disc=replace(drive.disc, thickness=width * drive.disc.thickness),
        crank_bearing=replace(bearing, roller_length=width * drive.roller_length),
        pin_shaft=shaft
        if shaft is None or shaft.stiffness is None
        else replace(shaft, stiffness=width * shaft.stiffness),
        load=replace(load, torque=width * load.torque, light_torque=width * load.light_torque),
    )
    scaled = replace(
        coefficients,
        fingerprint=wide.shape_fingerprint(),
        thickness=width * coefficients.thickness,
        disc=coefficients.disc / width,
        pin=coefficients.pin / width,
        roller=coefficients.roller / width,
        race=coefficients.race / width,
        disc_logarithm=coefficients.disc_logarithm / width,
        pin_logarithm=coefficients.pin_logarithm / width,
        roller_logarithm=coefficients.roller_logarithm / width,
        race_logarithm=coefficients.race_logarithm / width,
    )
    return wide, scaled


def pair_approaches(
    drive: Drive,
    coefficients: InfluenceCoefficients,
    near_field: NearField,
    crank_angle: float,
    load: FloatArray,
) -> FloatArray:
    """Return the approach of wheel pins and flank under their loads, without the loads of other contacts, mm.

    It is the sum of near field and body part of each contact, which does not depend on the datum between the two.
    """
    model = CoupledCompliance.of_drive(drive, coefficients, near_field)
    angle = np.array([crank_angle])
    flank = model.geometry.flank(angle, np.zeros((1, 4)))
    place = model.geometry.placement
    nothing = np.zeros((1, 0))
    places = BodyPlaces.on_walls(
        flank.parameter,
        model.geometry.profile.flank(flank.parameter),
        nothing,
        drive.bore_radius,
        nothing,
        place.cranks,
    )
    body = np.diag(coefficients.disc_matrix(places)[0]) + model.bodies[0].alone[0]
    near, _ = model.contacts.pin_law.approach_at_load(load, flank.effective_radius[0])
    return np.asarray(near + body * load)


def _wide(drive: Drive, case: str, crank_angles: FloatArray, coefficients: InfluenceCoefficients) -> list[Row]:
    """Return the rows on wider drives: half-spaces of finite length tend to plane strain like 1/ln width."""
    angle = float(crank_angles[0])
    fe = analyse(drive, crank_angles[:1], engine=PlaneStrain(coefficients=coefficients))
    load = fe.full.response.pin_load[0]
    loaded = np.flatnonzero(load > 0.05 * load.max())
    gaps = []
    for width in WIDTHS:
        wide, scaled = widen(drive, coefficients, width)
        plane = pair_approaches(wide, scaled, "plane-strain", angle, width * load)[loaded]
        finite = pair_approaches(wide, scaled, "half-space", angle, width * load)[loaded]
        gaps.append(finite / plane - 1.0)
    worst = [float(gap[np.argmax(np.abs(gap))]) for gap in gaps]
    rows = [
        Row(
            level=5,
            quantity=f"approach of wheel pin and flank, width × {width:g}, worst pin",
            value=gap,
            reference=0.0,
            unit="",
            difference=gap,
            limit=6e-3 if width == WIDTHS[-1] else None,
            reason="relative; half-spaces of finite length tend to plane strain like 1/ln width: 0.6 % at sixteen times",
            case=case,
            crank_angle=angle,
            model="hybrid",
            against="fe",
        )
        for width, gap in zip(WIDTHS, worst, strict=True)
    ]
    falls = min(abs(first) - abs(second) for first, second in pairwise(worst))
    rows.append(
        positive_row(
            5, "smallest fall of that difference from width to width", falls, "", "it tends to zero",
            case=case, crank_angle=angle, model="hybrid", against="fe",
        )
    )  # fmt: skip
    return rows


def _plane_stress(
    drive: Drive,
    case: str,
    crank_angles: FloatArray,
    coefficients: InfluenceCoefficients,
    plane_stress: InfluenceCoefficients,
) -> list[Row]:
    strain, stress = (
        answers_of(analyse(drive, crank_angles, engine=PlaneStrain(coefficients=own)))
        for own in (coefficients, plane_stress)
    )
    rows = []
    cause = "a thin disc with narrow walls lies between plane strain and plane stress (about 10 % softer): informs only"
    for angle, first, second in zip(crank_angles.tolist(), strain, stress, strict=True):
        apart = compare_positions(second, first)
        kind, number, load = apart.worst_load
        place = {"case": case, "crank_angle": angle, "model": "fe, body in plane stress", "against": "fe"}
        rows += [
            Row(
                level=5,
                quantity="load, worst contact",
                value=float(second.kinds[kind].load[number]),
                reference=float(first.kinds[kind].load[number]),
                unit="N",
                difference=load,
                limit=None,
                reason=cause,
                contact=f"{kind.replace('_', ' ')} {number}"
                if drive.crank.number == 1
                else apart.contact_name(kind, number),
                **place,
            ),
            Row(
                level=5,
                quantity="wheel angle",
                value=second.wheel_angle * ARCSEC,
                reference=first.wheel_angle * ARCSEC,
                unit='"',
                difference=apart.wheel_angle,
                difference_unit='"',
                limit=None,
                reason=cause,
                **place,
            ),
        ]
    return rows
